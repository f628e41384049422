G21 G17 G90 G94 G54
F300
G2 X20 Y0 R12                  ; expect: GP405
M30
