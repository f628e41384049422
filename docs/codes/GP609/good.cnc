G21 G17 G90 G94 G40 G49 G54
G0 X10
(gproof: allow GP243: the plate is turned over)
M0
G0 X20
M30
