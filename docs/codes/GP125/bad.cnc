%mx=300                        ; expect: GP125
%my=200                        ; expect: GP125
G21 G17 G90 G94 G40 G49 G54
G0 X10
G0 X20
M30
