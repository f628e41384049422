G21 G17 G90 G94 G40 G49 G54
#130 = 0
msg "holes so far: "#130
M30
