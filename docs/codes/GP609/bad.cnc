G21 G17 G90 G94 G40 G49 G54
G0 X10
(gproof: allow GP243: the plate is turned over)  ; expect: GP609
G4 P0.5
G0 X20
M30
