(NESTED CONTOURS, ARCS AND HELICES IN ALL THREE PLANES)
(test piece 120 x 80 x 20, tooling board, ball nose 8)
(work zero: lower left corner, top of board; no offsets needed)
(machine zero is the fixture corner, so G54 is all zero here)

N10 G21 G17 G90 G94 G40 G49 G80 G54
N20 G64 P0.05
N30 S14000 M3
N40 G4 P2                       (spindle run-up)
N50 G0 Z20

(==== XY plane: three contours, one inside the other ====)
N100 G0 X60 Y8
N110 Z3
N120 G1 Z0 F600
N130 G3 X60 Y8 Z-2 I0 J32 F1800 (helix: one turn down to Z-2, radius 32)
N140 G3 X60 Y8 I0 J32           (the same circle flat)
N150 G1 Z-4 F300
N160 G3 X60 Y72 I0 J32 F1800    (half)
N170 G3 X60 Y8 I0 J-32          (and half)
N180 G0 Z3
(middle contour: oval slot, 36 between the centres)
N200 G0 X42 Y26
N210 G1 Z-2 F300
N220 G1 X78 F1800
N230 G3 X78 Y54 I0 J14
N240 G1 X42
N250 G3 X42 Y26 I0 J-14
N260 G0 Z3
(inner contour: rounded square 20 x 20, radius form)
N300 G0 X50 Y40
N310 G1 Z-2 F300
N320 Y46 F1800
N330 G2 X54 Y50 R4
N340 G1 X66
N350 G2 X70 Y46 R4
N360 G1 Y34
N370 G2 X66 Y30 R4
N380 G1 X54
N390 G2 X50 Y34 R4
N400 G1 Y40
(long way round: 270 degrees, negative R)
N410 G1 X56 F1800
N420 G2 X60 Y36 R-4
N430 G0 Z10

(==== XZ plane: grooves across, bottom radius 20 ====)
(G2 dips: it is clockwise for someone who looks from +Y)
N500 G18
N510 G0 X100 Y10
N520 Z2
N530 G1 Z0 F600
N540 G2 X112 Z0 I6 K8 F1200     (shallow: centre above the surface)
N550 G1 Y14
N560 G3 X100 Z0 I-6 K8          (and back)
N570 G1 Y18
(helix along Y: half turn over the top of a bead, 4 mm further each time)
N580 G3 X112 Y22 Z0 I6 K0
N590 G2 X100 Y26 Z0 I-6 K0
N600 G0 Z12

(==== YZ plane: trough along Y ====)
(G3 dips: it is counter-clockwise for someone who looks from +X)
N700 G19
N710 G0 X8 Y20
N720 Z2
N730 G1 Z0 F600
N740 G3 Y60 Z0 J20 K15 F1200    (radius 25, 10 deep)
N750 G1 X12
N760 G2 Y20 Z0 J-20 K15
N770 G1 X16
(helix along X: full turn on a screw with its axis in X, radius 5, above the board)
N780 G1 Z6
N790 G2 X20 Y20 Z6 J0 K5
N800 G3 X16 Y20 Z6 J0 K5
N810 G0 Z30

N900 G17
N910 M5
N920 G0 X0 Y0
N930 M30
