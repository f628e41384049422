G21 G17 G90 G94 G40 G49 G54
#6000 = 5                      ; expect: GP226
M30
