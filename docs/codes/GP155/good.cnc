G21 G17 G90 G94 G40 G49 G54
G0 X10
gosub groove
M30
sub groove
G0 X20
endsub
