(SIGN BOARD 500 x 60 WITH A TEST CUT THAT THE OPERATOR CAN SWITCH OFF)
(block delete ON: no test cut; the lines with a stroke are skipped)
(the test piece is clamped left of the table edge, only on the big machine;)
(on this one X-40 is out of reach, so block delete must be on)
G21 G17 G90 G94 G40 G49 G80 G54
S16000 M3
G0 Z10
/G0 X-40 Y10
/G1 Z-1 F300
/G1 Y50 F1500
/G0 Z10
G0 X20 Y30
G0 Z2
G1 Z-2 F300
(wave of half circles, pitch 40)
G2 X60 Y30 I20 J0 F1500
G3 X100 Y30 I20 J0
G2 X140 Y30 I20 J0
G3 X180 Y30 I20 J0
G2 X220 Y30 I20 J0
G3 X260 Y30 I20 J0
G2 X300 Y30 I20 J0
G3 X340 Y30 I20 J0
G2 X380 Y30 I20 J0
G3 X420 Y30 I20 J0
G2 X460 Y30 I20 J0
G0 Z10
(two level lines)
G0 X20 Y7
G1 Z-1 F300
X480 F1800
G0 Z2
Y53
G1 Z-1 F300
X20 F1800
G0 Z10
M5
G0 X0 Y0
M30
