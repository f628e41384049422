G21 G17 G90 G94 G54 G40 G49
#1 = 8
if [#1 > 10]
errmsg "at most ten holes"
endif
G0 X10
M30
