G21 G17 G90 G94 G40 G49 G54
#120 = 1
F100
G0 Z5
if [#121 > 0]                  ; nobody knows #121: both ways are followed
  G[#120] X10
endif
M30
