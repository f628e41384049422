G21 G17 G90 G94 G40 G49 G54
G53 G0 Z-20
G53 G0 X580 Y330
TCAGuard off
G53 G0 Y380                    ; expect: GP312
G53 G0 Y330                    ; allow: GP312
TCAGuard on
M30
