G21 G17 G90 G94 G40 G49 G54
G0 Z5
G1 X20 F-300                   ; expect: GP241
M30
