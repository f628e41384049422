G21 G17 G90 G94 G40 G49 G54
G0 Z5
M97 P1                         ; expect: GP272
M30
