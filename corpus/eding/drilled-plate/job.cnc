(DRILLED PLATE 160 x 100 x 10, EN AW-5083)
(drawing 4711-02, rev. B)
(work zero G54: lower left corner, top of plate; the plate lies in the dowelled frame,)
(so its place on the table is known: N25 sets it, Z with the bare spindle nose)
(on two parallels, free below the bores)
( T1  spot drill    90 deg, 6 mm)
( T2  drill         5.0 mm)
( T3  end mill      6.0 mm, 2 flutes)
(clamps on the long sides at X80: cross them at Z15 only;)
(for the contour they come off, see N690)

N10 G21 G17 G90 G94 G40 G49 G80 G54
N20 G61
N25 G10 L2 P1 X120 Y90 Z-132.5
N30 G53 G0 Z0           (spindle up before anything else)

(---- spot all ten holes ----)
N100 T1 M6
N110 S9000 M3
N120 G43 H1
N130 M8
N140 G0 X12 Y12
N150 Z15
N160 F240
N170 G99 G82 X12 Y12 Z-1.5 R2 P0.2
N180 X148
N190 Y88
N200 X12
N210 X105 Y50           (bolt circle, radius 25 about X80 Y50)
N220 X92.5 Y71.6506
N230 X67.5
N240 X55 Y50
N250 X67.5 Y28.3494
N260 G98 X92.5
N270 G80 M9
N280 M5
N290 G49
N300 G53 G0 Z0

(---- drill 5.0 ----)
N400 T2 M6
N410 S6500 M3
N420 G43 H2
N430 M7
N440 G0 X12 Y12
N450 Z15
N460 F360
(corner bores go through: peck, back to Z15 over the clamps)
N470 G98 G83 X12 Y12 Z-12 R2 Q4
N480 X148
N490 Y88
N500 X12
(bolt circle: blind, 8 deep, stay low)
N510 G99 G81 X105 Y50 Z-8 R2
N520 X92.5 Y71.6506
N530 X67.5
N540 X55 Y50
N550 X67.5 Y28.3494
N560 G98 X92.5
N570 G80 M9
N580 M5
N590 G49
N600 G53 G0 Z0

(---- outer contour, corner radius 8, climb milling ----)
(tool centre runs 3 mm outside: X-3 to 163, Y-3 to 103)
N690 (MSG, screws into the corner bores, clamps off)
N700 T3 M6
N710 S16000 M3
N720 G43 H3
N730 M8
N740 G0 X-13 Y40
N750 Z15
(first pass, Z-3.5)
N760 G0 Z2
N770 G1 Z-3.5 F400
N780 G3 X-3 Y50 I0 J10 F1500    (roll in)
N790 G1 Y92
N800 G2 X8 Y103 I11 J0
N810 G1 X152
N820 G2 X163 Y92 I0 J-11
N830 G1 Y8
N840 G2 X152 Y-3 I-11 J0
N850 G1 X8
N860 G2 X-3 Y8 I0 J11
N870 G1 Y50
N880 G3 X-13 Y60 I-10 J0        (roll out)
N890 G0 Z2
N900 X-13 Y40
(second pass, Z-7)
N910 G1 Z-7 F400
N920 G3 X-3 Y50 I0 J10 F1500
N930 G1 Y92
N940 G2 X8 Y103 I11 J0
N950 G1 X152
N960 G2 X163 Y92 I0 J-11
N970 G1 Y8
N980 G2 X152 Y-3 I-11 J0
N990 G1 X8
N1000 G2 X-3 Y8 I0 J11
N1010 G1 Y50
N1020 G3 X-13 Y60 I-10 J0
N1030 G0 Z2
N1040 X-13 Y40
(last pass, Z-10.5, slower for the edge)
N1050 G1 Z-10.5 F400
N1060 G3 X-3 Y50 I0 J10 F1200
N1070 G1 Y92
N1080 G2 X8 Y103 I11 J0
N1090 G1 X152
N1100 G2 X163 Y92 I0 J-11
N1110 G1 Y8
N1120 G2 X152 Y-3 I-11 J0
N1130 G1 X8
N1140 G2 X-3 Y8 I0 J11
N1150 G1 Y50
N1160 G3 X-13 Y60 I-10 J0
N1170 G0 Z15 M9
N1180 M5
N1190 G49
N1200 G53 G0 Z0
N1210 G53 G0 X0 Y0      (park at the left front, plate free)
N1220 M30
