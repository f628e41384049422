G21 G17 G90 G94 G40 G49 G54
G0 Z5
#1 = 0
while [#1 == 0] ; expect: GP506
G0 X10
G0 X20
endwhile
M30
