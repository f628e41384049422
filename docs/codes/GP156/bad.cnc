G21 G17 G90 G94 G40 G49 G54
#1 = 5
if [#1 > 3]
  #2 = 10
endif
G0 X#2                           ; expect: GP156
M30
