G21 G17 G90 G94 G40 G49 G54
if [3 > 5]                       ; expect: GP158
  G0 X10
endif
M30
