G21 G17 G90 G94 G40 G49 G54
G0 X10.2.5 Y20                 ; expect: GP102
M30
