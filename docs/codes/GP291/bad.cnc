G21 G17 G90 G94 G40 G49 G54
G0 Z5
F50
G38.2 Z4.9                             ; expect: GP291
M30
