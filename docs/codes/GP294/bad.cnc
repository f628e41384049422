G21 G17 G90 G94 G40 G49 G54
G0 Z5 A0
F50
G38.2 A0                             ; expect: GP294
M30
