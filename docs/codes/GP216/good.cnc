G21 G17 G90 G94 G40 G49 G54
F200
G0 Z5
G81 X10 Y10 Z-5 R2
X20                            ; Z and R are remembered
G80
M30
