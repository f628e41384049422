G21 G17 G90 G94 G40 G49 G54
M56 P1 L3 Q5                             ; expect: GP297
M30
