(STEPPED PIN, TURNED WITH NOSE COMPENSATION; X IS A DIAMETER)
(zero: centre line, front face; tool in front of the work: arcs and sides as drawn with X+ to the right, Z+ upwards)
G21 G18 G90 G94 G40 G49 G80 G54
T1 M6
S1200 M3 M8
G0 X80 Z20
(== roughing, uncompensated ==)
G0 X66
G1 Z-48 F150
G0 X72 Z2
G0 X50
G1 Z-19
G0 X72 Z2
(== finishing: the contour in drawing sizes, T1 with nose radius 0.8, points towards X- Z- ==)
G0 X-8 Z10
G41
G1 X-8 Z3 F80
G3 X-2 Z0 I3 K0                (onto the face)
G1 X36                         (the face)
G2 X40 Z-2 R2                  (edge, rounded)
G1 Z-17
G3 X46 Z-20 R3                 (fillet)
G1 X54
G1 X60 Z-23                    (chamfer)
G1 Z-46
G40
G1 X72
G0 X90 Z20
(== a groove of radius 6 with the round tool, radius 2.5 ==)
T2 M6
S900 M3
G0 X90
G0 Z-20
G41
G1 X72 F60
G3 X60 Z-26 R6                 (onto the outside)
G1 Z-29
G3 Z-41 R7.5
G1 Z-44
G40
G0 X90
G0 Z20
M9
M5
M30
