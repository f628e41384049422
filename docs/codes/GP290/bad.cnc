G21 G17 G90 G94 G40 G49 G54
sub m120
  M8
endsub
F200
M120 G1 X10                             ; expect: GP290
M30
