G21 G17 G90 G94 G40 G49 G54
F300
G0 Z5
#1 = [60 / #4001]
if [#1 > 20]
  msg "short"
endif
G1 X20
M30
