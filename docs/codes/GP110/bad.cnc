G21 G17 G90 G94 G54
G0 G1 X10 F200                 ; expect: GP110
M30
