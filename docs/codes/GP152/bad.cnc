G21 G17 G90 G94 G40 G49 G54
O100 sub                         ; expect: GP101 GP152
G0 X10
O100 endsub                      ; expect: GP101
O100 call                        ; expect: GP101
M30
