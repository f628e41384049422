G21 G17 G90 G94 G40 G49 G54
G10 L1 P1 X50                  ; expect: GP209
M30
