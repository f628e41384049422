(ISOLATION MILLING, BOARD 80 X 60, HEIGHT COMPENSATION IS ON)
(drilled through at Z-3.7 of the board: machine Z -11.9 and 0.071 less at the lowest corner, the limit is -12)
G21 G17 G90 G94 G40 G49 G80 G54
S24000 M3
G0 Z2
F300
G0 X0 Y0 (first measured point: the height there is 0)
(tracks)
G0 X5 Y5
G1 Z-0.08
G1 X35
G1 X45 Y15
G1 Y40
G3 X40 Y45 I-5 J0
G1 X10
G0 Z2
G0 X60 Y10
G1 Z-0.08
G2 X60 Y10 I6 J0
G0 Z2
(holes)
G81 G99 R1 Z-3.7 F120 X5 Y5
X10 Y45
X60 Y10
G80
G0 Z20
M5
M30
