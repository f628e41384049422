G21 G17 G90 G94 G40 G49 G54
G0 X10 Y10
G1 X20                         ; expect: GP204
M30
