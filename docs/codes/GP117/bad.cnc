G21 G17 G90 G94 G40 G49 G54
sub deeper
  G91 G0 Z-1
  gosub deeper                 ; expect: GP117
endsub
gosub deeper                   ; allow: GP117
G90
M30
