G21 G17 G90 G94 G54
G0 Z5
G95
G1 X20 F0.2                    ; expect: GP239
G94
M30
