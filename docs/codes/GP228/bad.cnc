G21 G17 G90 G94 G40 G49 G54
#1 = 0
#2 = [10 / #1]                 ; expect: GP228
M30
