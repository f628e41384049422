G21 G17 G90 G94 G40 G49 G54
G0 Z-5
tanknife on ; expect: GP323
M30
