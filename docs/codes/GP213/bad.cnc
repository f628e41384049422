G21 G17 G90 G94 G40 G49 G54
S-8000 M3                      ; expect: GP213
M5
M30
