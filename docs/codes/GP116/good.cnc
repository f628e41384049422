G21 G17 G90 G94 G40 G49 G54
sub corner_a
  G0 X10 Y10
endsub
sub corner_b
  G0 X20 Y20
endsub
gosub corner_a
gosub corner_b
M30
