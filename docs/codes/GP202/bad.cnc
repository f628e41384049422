G21 G17 G90 G94 G40 G49 G54
G0 Z5
G80
X20 Y20                        ; expect: GP202
M30
