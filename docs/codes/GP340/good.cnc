sub user_1
  G53 G0 Z0
endsub
G21 G17 G90 G94 G40 G49 G54
gosub user_1
M30
