G21 G17 G90 G94 G40 G49 G54
G0 X[20 + ]                    ; expect: GP107
M30
