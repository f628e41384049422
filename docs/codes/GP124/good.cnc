G21 G17 G90 G94 G40 G49 G54
sub laengs
  G0 X50
endsub
gosub laengs
M30
