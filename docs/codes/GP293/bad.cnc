G21 G17 G90 G94 G40 G49 G54
G0 Z5 A0
F50
G38.2 Z-5 A10                             ; expect: GP293
M30
