G21 G17 G90 G94 G40 G49 G54
sub corner
  G0 X10 Y10
endsub
gosub corners                  ; expect: GP115
M30
