(STEPPED PIN, TURNED WITH NOSE COMPENSATION; X IS A RADIUS)
(zero: centre line, front face; tool in front: arcs and sides as seen from below, X+ to the right, Z+ upwards)
G21 G18 G90 G94 G40 G49 G80 G54
T1 M6
S1200 M3 M8
G0 X40 Z20
(== roughing, uncompensated ==)
G0 X33
G1 Z-48 F150
G0 X36 Z2
G0 X25
G1 Z-19
G0 X36 Z2
(== finishing: the contour in drawing sizes, T1 with nose radius 0.8, points towards X- Z- ==)
G0 X-4 Z10
G41
G1 X-4 Z3 F80
G3 X-1 Z0 I3 K0                (onto the face)
G1 X18                         (the face)
G2 X20 Z-2 R2                  (edge, rounded)
G1 Z-17
G3 X23 Z-20 R3                 (fillet)
G1 X27
G1 X30 Z-23                    (chamfer)
G1 Z-46
G40
G1 X36
G0 X45 Z20
(== a groove of radius 6 with the round tool, radius 2.5 ==)
T2 M6
S900 M3
G0 X45
G0 Z-20
G41
G1 X36 F60
G3 X30 Z-26 R6                 (onto the outside)
G1 Z-29
G3 Z-41 R7.5
G1 Z-44
G40
G0 X45
G0 Z20
M9
M5
M30
