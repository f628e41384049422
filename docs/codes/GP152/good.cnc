G21 G17 G90 G94 G40 G49 G54
gosub step
M30
sub step
G0 X10
endsub
