G21 G17 G90 G94 G40 G49 G54
#1 = 0
while [#1 < 10]
  G4 P0
  #1 = [#1 + 1]
endwhile
M30
