(FRONT PLATE LABEL 120 X 60 FROM FOIL, CORNERS R8, A ROUND WINDOW, A NOTCH)
(Z 4 is clear of the foil: at corners of more than 20 degrees the knife is lifted by 4 and turned)
G21 G17 G90 G94 G40 G49 G80 G54
F1800
G0 Z4
tanknife on
(round window: the knife turns with the arc, once around)
G0 X60 Y20
G1 Z-0.4
G3 X60 Y20 I0 J10
G0 Z4
(notch with sharp corners)
G0 X100 Y20
G1 Z-0.4
G1 X110
G1 Y30
G1 X100
G1 Y20
G0 Z4
(outline, corners rounded)
G0 X8 Y0
G1 Z-0.4
G1 X112
G3 X120 Y8 I0 J8
G1 Y52
G3 X112 Y60 I-8 J0
G1 X8
G3 X0 Y52 I0 J-8
G1 Y8
G3 X8 Y0 I8 J0
G0 Z4
tanknife off
G0 X0 Y0
M30
