G21 G17 G90 G94 G40 G49 G54
#1 = 1
if [#1 == 1]
  G0 X10
endif
M30
