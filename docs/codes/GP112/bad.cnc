G21 G17 G90 G94 G40 G49 G54
G27 X10                        ; expect: GP112
M30
