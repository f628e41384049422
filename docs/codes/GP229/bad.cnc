G21 G17 G90 G94 G40 G49 G54
#1 = 3.5
M[#1]                          ; expect: GP229
M30
