; Frame groove and four pads on a clamped plate; lower left corner of the plate is zero
; T3: end mill 6 mm. Clamps in the middle of the long sides, the higher one 14 above the plate
G21 G17 G90 G94 G40 G49 G54
G53 G0 Z0
T3 M6
G43 H3
S12000 M3
G0 X15 Y11.2
Z20
G0 Z2
G1 Z-2 F200
X64 F900
G2 X67 Y11.2 I1.5               ; up to the clamp and round: 3 mm are the tool's
G1 X93
X145
Y88.9
X104
G2 X56 I-24 J41.1               ; below the rear clamp, between its toes nothing is cut
G1 X15
Y11.2
G0 Z20
G0 X80 Y50                      ; over both clamps at 20
Y130
Y-30
G0 X80 Y50
Z2
G1 Z-1 F200
G2 X80 Y50 I10 F600
G0 Z20
M5
G49
G53 G0 Z0
G53 G0 X45 Y380
M30
