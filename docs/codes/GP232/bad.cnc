G21 G17 G90 G94 G40 G49 G54
G0 Z5
if [#120 > 0]                  ; expect: GP232
  G0 X10
endif
M30
