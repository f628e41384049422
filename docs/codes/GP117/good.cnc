G21 G17 G90 G94 G40 G49 G54
sub deeper
  G91 G0 Z-1
  G90
endsub
#1 = 0
while [#1 < 3]
  gosub deeper
  #1 = [#1 + 1]
endwhile
M30
