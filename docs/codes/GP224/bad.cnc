G21 G17 G90 G94 G40 G49 G54
G0 Z5
G0 G92 X0 Y0                   ; expect: GP224
M30
