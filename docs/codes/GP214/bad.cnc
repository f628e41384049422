G21 G17 G90 G94 G40 G49 G54
T-1                            ; expect: GP214
M30
