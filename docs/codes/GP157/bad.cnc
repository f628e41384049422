G21 G17 G90 G94 G40 G49 G54
#101 = 5                         ; expect: GP157
#102 = 20
G0 X#102
M30
