G21 G17 G90 G94 G40 G49 G54
G0 X10
M30
G0 X50                         ; expect: GP123
M30
