G21 G17 G90 G94 G40 G49 G54
S500 M3                        ; expect: GP271
G0 Z5
M5
M30
