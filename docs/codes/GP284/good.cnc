G21 G17 G90 G94 G40 G49 G54
S500 M3
G0 X0 Y0 Z5
G51 X2 Y2 I0 J0
G33 Z-5 K1                     ; along Z nothing is scaled
G0 Z5
G50
G33 X20 Z-5 K1
M5
M30
