G21 G17 G90 G94 G40 G49 G54
G0 Z5
G[#120] X10                    ; expect: GP232
M30
