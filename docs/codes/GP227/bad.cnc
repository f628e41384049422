G21 G17 G90 G94 G40 G49 G54
#5001 = 10                     ; expect: GP227
M30
