G21 G17 G90 G94 G40 G49 G54
G43 H100                       ; expect: GP236
G49
M30
