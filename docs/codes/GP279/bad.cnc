G21 G17 G90 G94 G40 G49 G54
M26 P1
G0 X20 Y20
G0 A90                         ; expect: GP279
M27 P1
M30
