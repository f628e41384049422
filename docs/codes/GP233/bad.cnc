G21 G17 G90 G94 G40 G49 G54
#1 = 0
#2 = 0
while [#1 < 10]                ; expect: GP233
  #2 = [#2 + 1]                ; allow: GP233
  #1 = [5 / #2]                ; allow: GP233
endwhile                       ; allow: GP233
M30
