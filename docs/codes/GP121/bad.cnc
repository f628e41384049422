G21 G17 G90 G94 G40 G49 G54
F400
G1 X20 L3                      ; expect: GP121
M30
