G21 G17 G90 G94 G40 G49 G54
F600
home z
T2 M6                    ; expect: GP341
M30
