G21 G17 G90 G94 G40 G49 G54
#1 = 0
while [#1 < 10]                ; expect: GP233
  G4 P0                        ; allow: GP233
  #2 = [#1 + 1]                ; allow: GP233
endwhile                       ; allow: GP233
M30
