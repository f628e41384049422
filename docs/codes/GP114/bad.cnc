G21 G17 G90 G94 G40 G49 G54
#1 = 0
G0 X10
#1 = [#1 + 1]
endwhile                       ; expect: GP114
M30
