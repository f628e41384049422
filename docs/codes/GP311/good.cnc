G21 G17 G90 G94 G40 G49 G54
; the same on a smaller part, with known offsets
F600
G0 Z5
G0 X0 Y330
G1 Z-2
G1 Y0
G1 X480
G0 Z5
M30
