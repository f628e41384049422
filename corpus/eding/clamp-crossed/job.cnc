; The plate of the clamped job, posted again without the clamps: rapids stay at 5
G21 G17 G90 G94 G40 G49 G54
G53 G0 Z0
T3 M6
G43 H3
S12000 M3
G0 X20 Y30
Z5
G1 Z-2 F200
X140 F900
G0 Z5
X40 Y20
G1 Z-1 F200
G3 X120 I40 J30 F900            ; expect: GP336
G0 Z5
G0 X150 Y96
G0 X10                          ; expect: GP336
M5
G49
G53 G0 Z0
M30
