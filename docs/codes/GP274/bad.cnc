G21 G17 G90 G94 G40 G49 G54
S1000 M3
G0 Z5
M91                            ; expect: GP274
M90
M30
