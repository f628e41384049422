G21 G17 G90 G94 G54 G40 G49
MCAGuard off
G53 G0 X602                          ; expect: GP307
G53 G0 X10
MCAGuard on
M30
