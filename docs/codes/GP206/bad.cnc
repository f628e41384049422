G21 G17 G90 G94 G40 G49 G54
G4 P-1                         ; expect: GP206
M30
