G21 G17 G90 G94 G40 G49 G54
; around three sides of the column
F600
G53 G0 Z0
G0 X50 Y50
G1 Z-20
G1 X450
G1 Y300                           ; expect: GP337
G1 X50
G53 G0 Z0
M30
