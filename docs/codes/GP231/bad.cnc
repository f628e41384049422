G21 G17 G90 G94 G40 G49 G54
#1 = [0.1 + 0.2]
if [#1 == 0.3]                 ; expect: GP231
  G0 X10
endif
M30
