(Generated from bracket.dxf)
G21 (Unit in mm)
G90 (Absolute distance mode)
G64 P0.01 (Exact Path 0.001 tol.)
G17
G40 (Cancel diameter comp.)
G49 (Cancel length comp.)
T5 M6
M8 (Coolant on)
S16000 M3

(*** LAYER: OUTLINE ***)

(* SHAPE Nr: 0 *)
G0 X   10.000 Y   10.000
G0 Z    3.000
F  150
G1 Z   -2.000
F  400
G1 X  110.000 Y   10.000
G3 X  120.000 Y   20.000 I    0.000 J   10.000
G1 X  120.000 Y   60.000
G3 X  110.000 Y   70.000 I  -10.000 J    0.000
G1 X   10.000 Y   70.000
G1 X   10.000 Y   10.000
F  150
G1 Z    3.000
G0 Z   15.000

(* SHAPE Nr: 1 *)
G0 X   35.000 Y   40.000
G0 Z    3.000
F  150
G1 Z   -2.000
F  400
G2 X   35.000 Y   40.000 I   -5.000 J    0.000
F  150
G1 Z    3.000
G0 Z   15.000
M9 (Coolant off)
M5 (Spindle off)
G0 X    0.000 Y    0.000
M30 (Program end)
