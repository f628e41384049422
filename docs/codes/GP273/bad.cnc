G21 G17 G90 G94 G40 G49 G54
G0 Z5
M91                            ; expect: GP273
G0 X10
M90
M30
