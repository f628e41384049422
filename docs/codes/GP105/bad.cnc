G21 G17 G90 G94 G54
N123456 G0 X10                 ; expect: GP105
M30
