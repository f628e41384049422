G21 G17 G90 G94 G40 G49 G54
G0 Z5
M50 P80                        ; expect: GP270
G1 X20 F200
M30
