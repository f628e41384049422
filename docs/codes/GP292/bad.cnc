G21 G17 G90 G94 G40 G49 G54
G0 Z5
G93
G38.2 Z-5 F2                             ; expect: GP292
M30
