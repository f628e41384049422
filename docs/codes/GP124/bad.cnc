G21 G17 G90 G94 G40 G49 G54
sub längs                      ; expect: GP124
  G0 X50
endsub
gosub längs                    ; allow: GP124 GP115
M30
