G21 G17 G90 G94 G40 G49 G54
G0 X10 (drive to the first hole)
G0 X20 ; and to the second
M30
