G21 G17 G90 G94 G40 G49 G54
G0 X20 Y20
M81
M80
G0 X40                         ; expect: GP281
M30
