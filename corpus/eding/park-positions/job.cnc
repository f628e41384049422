(TWO SIDES OF A HINGE, PARK POSITIONS BETWEEN THEM)
(G28: spindle up, table to the front, for turning the part)
(G30: above the brush, for cleaning the cutter)
(both positions were stored on the variable page, work zero with the edge finder)
N10 G21 G17 G90 G94 G40 G49 G80 G54
N20 G28                         (park before we start)
N30 S15000 M3
N40 G0 X10 Y10
N50 G0 Z5
N60 G1 Z-2 F300
N70 X70 F1100
N80 G3 X80 Y20 I0 J10
N90 G1 Y40
N100 G3 X70 Y50 I-10 J0
N110 G1 X10
N120 G0 Z5
N130 M5
N140 G30 Z30                    (clear the part first, then to the brush)
N150 G4 P3
N160 G28 Z40
N170 M0 (turn the part over, press start)
N180 S15000 M3
N190 G0 X10 Y60
N200 Z5
N210 G1 Z-1.5 F300
N220 X80 F1100
N230 Y70
N240 X10
N250 Y60
N260 G0 Z5
N270 M5
N280 G28
N290 M30
