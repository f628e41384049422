G21 G17 G90 G94 G40 G49 G54
F300
G0 Z5
G1 X#120                       ; expect: GP225
M30
