G21 G17 G90 G94 G54
G0 X10 Y10                     ; expect: GP311
M30
