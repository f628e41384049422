G21 G17 G90 G94 G40 G49 G54
G0 X700 (gproof: allow GP301: the stop is further out)  ; expect: GP301 GP610
G0 X20
M30
