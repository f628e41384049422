(SPACER, WRITTEN AT THE MACHINE)
(the feed word is missing: on a machine that was just switched on there is none)
G21 G17 G90 G94 G40 G49 G80 G54
S12000 M3
G0 Z5
G0 X10 Y10
G0 Z1
G1 Z-2                         ; expect: GP204
M5
M30
