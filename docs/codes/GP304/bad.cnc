G21 G17 G90 G94 G54
G0 Z5                          ; allow: GP304
G91
G0 X50                         ; expect: GP304
G90
M30
