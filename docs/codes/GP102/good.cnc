G21 G17 G90 G94 G40 G49 G54
G0 X10.25 Y2 0                 ; a blank in a number is allowed: Y20
M30
