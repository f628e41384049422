(SHELF SIDE 580 x 280: GROOVES FOR THE BOARDS)
(zero: lower left corner of the panel; machine X reaches 560 from there)
G21 G17 G90 G94 G40 G49 G80 G54
S16000 M3
G0 Z12
G0 X15 Y40
G0 Z2
G1 Z-5 F600
G1 X545 F3000
G0 Z2
G0 Y140
G1 Z-5 F600
G1 X15 F3000
G0 Z2
G0 Y240
G1 Z-5 F600
(the last groove was meant to run out of the panel)
G1 X585 F3000                  ; expect: GP301
M5
M30
