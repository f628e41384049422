G21 G17 G90 G94 G40 G49 G54
G92                            ; expect: GP212
M30
