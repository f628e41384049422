G21 G17 G90 G94 G40 G49 G54
F300
G0 X10 Y10
G2 X10 Y10 I5 J0               ; a full circle about X15 Y10
M30
