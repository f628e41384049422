G21 G17 G90 G94 G40 G49 G54
sub corner
  G0 X10 Y10
endsub
sub corner                     ; expect: GP116
  G0 X20 Y20
endsub
gosub corner                   ; allow: GP116
M30
