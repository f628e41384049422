(COVER PLATE: SEATS FOR SCREW HEADS FROM BELOW, ONE BORE BY HAND)
(zero: corner, top; the plate is 16 thick on spacers of 20)
N10 G21 G17 G90 G94 G40 G49 G80 G54
N20 G0 Z30
N30 S1600 M3
N40 M8
N50 F160
N60 G0 X20 Y20
N70 G0 Z10
N80 G98 G81 X20 Y20 Z-19 R2
N90 X60
N100 Y60
N110 X20
N120 G80
N130 M5 M9
N140 G0 Z40
(boring bar with its edge on top; it passes the hole 3.2 beside the middle)
N150 M0
N160 S420 M3
N170 F25
N180 G0 X20 Y20
N190 G0 Z10
N200 G98 G87 X20 Y20 Z-24 R4 I-3.2 J0 K-12
N210 X60
N220 Y60
N230 X20
N240 G80
(the middle bore: stops at the bottom, the operator draws the bar out)
N250 G0 X40 Y40
N260 F20
N270 G88 X40 Y40 Z-14 R4 P1.5
N280 G80
(where Z is now only the operator knows: up first, in machine coordinates)
N290 G53 G0 Z60
N300 M5
N310 G0 X0 Y0
N320 M30
