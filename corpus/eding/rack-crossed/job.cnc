; Cover plate, second side: the way to the parking place was shortened
G21 G17 G90 G94 G40 G49 G54
T3 M6
S12000 M3
G0 X20 Y20
G0 Z5
G1 Z-2 F200
G1 X180 F1500
Y100
X20
Y20
G0 Z5
M5
G53 G0 X440 Y360
G53 G0 X590 Y330                        ; expect: GP310
M30
