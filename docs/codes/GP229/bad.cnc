G21 G17 G90 G94 G54
#[7 / 2] = 5                   ; expect: GP229
M30
