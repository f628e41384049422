G21 G17 G90 G94 G40 G49 G54
G0 X20 Y20
F400
G40                            ; switching it off is always possible
G1 X30
G1 Y60
G0 Z5
M30
