G21 G17 G90 G94 G40 G49 G54
N12345 G0 X10
N10 G0 X20                     ; repeated or smaller numbers are allowed
M30
