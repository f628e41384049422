G21 G17 G90 G94 G40 G49 G54
; around two sides of a part nearly as big as the table
F600
G0 Z5
G0 X0 Y380
G1 Z-2
G1 Y0
G1 X580
G0 Z5
M30
