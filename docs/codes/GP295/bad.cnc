G21 G17 G90 G94 G40 G49 G54
home z                             ; expect: GP295
G53 G0 Z0
M30
