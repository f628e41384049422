G21 G17 G90 G94 G40 G49 G54
G0 X10
M30
sub groove                       ; expect: GP155
G0 X20
endsub
