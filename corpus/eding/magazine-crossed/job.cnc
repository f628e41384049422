(CABINET DOOR 540 x 340, HINGE BORES AT BOTH ENDS)
(the tool magazine stands in the rear right corner of the machine,)
(X520 to 600, Y340 to 400, up to Z-40)
G21 G17 G90 G94 G40 G49 G80 G54
S16000 M3
G0 X540 Y40                    (at the top)
G0 Z-70
G1 Z-80 F400
G2 X540 Y60 I0 J10 F900
G2 X540 Y40 I0 J-10
G0 Z-70
G0 X580 Y330
G1 Z-80 F400
G1 X570 F900
G0 Z-70
(straight over to the other hinge: both ends are outside of the magazine, the way is not)
G0 X500 Y390                   ; expect: GP310
G1 Z-80 F400
G1 X490 F900
G0 Z0
M5
G0 X0 Y0
M30
