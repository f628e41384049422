G21 G17 G90 G94 G40 G49 G54
#1 = 3
if [#1 > 5]
  G0 X10
endif
M30
