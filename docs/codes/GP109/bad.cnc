G21 G17 G90 G94 G54
G0 X10 Y20 X30                 ; expect: GP109
M30
