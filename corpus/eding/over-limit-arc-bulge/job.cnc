(TABLE TOP WITH A ROUND END)
(the straight sides end at X500, the machine at X600)
(both ends of the big arc are well inside; its middle is not)
G21 G17 G90 G94 G40 G49 G80 G54
S18000 M3
G0 Z10
G0 X40 Y60
G0 Z2
G1 Z-6 F500
G1 X500 F2500
G3 X500 Y300 I0 J120           ; expect: GP301
G1 X40
G1 Y60
G0 Z10
M5
G0 X0 Y0
M30
