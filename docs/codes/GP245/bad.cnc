G21 G17 G90 G94 G54 G40 G49
#1 = 12
if [#1 > 10]
errmsg "at most ten holes"         ; expect: GP245
endif
G0 X10
M30
