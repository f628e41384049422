G21 G17 G90 G94 G40 G49 G54
home b                             ; expect: GP296
M30
