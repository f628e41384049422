G21
G0 Z5
G20 F10                        ; expect: GP240
G1 X1
G21
M30
