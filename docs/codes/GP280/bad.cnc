G21 G17 G90 G94 G40 G49 G54
G0 X20 Y20 Z5
M20                            ; expect: GP280
F2000
G1 X60
M21                            ; expect: GP280
M30
