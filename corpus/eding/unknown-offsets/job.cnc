(HOUSE NUMBER 27, CHECKED BEFORE THE WORK ZERO IS KNOWN)
(plate 180 x 120, zero: centre of the plate, top)
(there is no setup file: the answer says where the zero may be put)
G21 G17 G90 G94 G40 G49 G80 G54
S18000 M3
G0 Z8
G0 X-70 Y30
G0 Z1
(figure two)
G1 Z-2 F400
G2 X-10 Y30 I30 J0 F1600
G1 X-70 Y-40
G1 X-10
G0 Z8
(figure seven)
G0 X15 Y50
G0 Z1
G1 Z-2 F400
G1 X70 F1600
G1 X35 Y-40
G0 Z8
(frame with round corners)
G0 X-80 Y-60
G0 Z1
G1 Z-1 F400
G1 X80 F2000
G3 X90 Y-50 I0 J10
G1 Y50
G3 X80 Y60 I-10 J0
G1 X-80
G3 X-90 Y50 I0 J-10
G1 Y-50
G3 X-80 Y-60 I10 J0
G0 Z8
M5
M30
