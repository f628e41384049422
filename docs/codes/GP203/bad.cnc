G21 G17 G90 G94 G40 G49 G54
F300
G0 X0 Y0
G2 X20 Y0                      ; expect: GP203
M30
