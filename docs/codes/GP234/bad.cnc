G21 G17 G90 G94 G40 G49 G54
msg "holes so far: "#130      ; expect: GP234
M30
