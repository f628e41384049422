G21 G17 G90 G94 G40 G49 G54
G0 X10 (first hole (upper left)) ; expect: GP104
M30
