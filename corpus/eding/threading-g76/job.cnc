(BOLT M16 X 2 - THREAD 24 LONG, BAR 20)
(zero: centre line, face of the bar; X is the radius)
N10 G21 G18 G90 G94 G40 G49 G80 G54
N20 G0 X14 Z8
(face: the surface speed stays, at the centre 2000 a minute at most)
N30 G96 S120 D2000 M3
N40 M8
N50 G0 Z0
N60 G1 X-0.4 F80
N70 G0 Z2
N80 G0 X14
N90 G97 S900
(turn 20 down to 16 in two cuts, feed by the revolution)
N100 G95
N110 G0 X9
N120 G1 Z-32 F0.2
N130 X10.5
N140 G0 Z2
N150 X8
N160 G1 Z-32 F0.15
N170 X10.5
N180 G0 Z2
(relief at the end of the thread)
N190 G0 X11 Z-27
N200 S500
N210 G1 X6.6 F0.05
N220 G4 P0.5
N230 G1 X11 F0.3
(thread: peak at 8, depth 1.227, starts three pitches before the face)
(the cycle goes up to 0.927 outside its drive line at X10)
N240 G94
N250 G0 X10 Z6
N260 G76 P2 Z-26 I-2 J0.3 K1.227 R2 Q29.5 H2 E2.4 L2
N270 G0 X14
N280 M9
N290 M5
N300 G0 Z8
N310 M30
