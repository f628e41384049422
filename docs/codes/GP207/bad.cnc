G21 G17 G90 G94 G40 G49 G54
G4                             ; expect: GP207
M30
