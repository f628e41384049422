G21 G17 G90 G94 G40 G49 G54
G0 X10 Y10
G1 F300                        ; expect: GP201
X20
M30
