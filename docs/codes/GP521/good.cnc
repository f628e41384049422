G21 G17 G90 G94 G40 G49 G54
G0 Z-3
G0 X20 Y20 (the first point: nothing is added)
G0 X30 Y25
G1 Z-5 F200
M30
