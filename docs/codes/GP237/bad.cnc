G21 G17 G90 G94 G40 G49 G54
G43                            ; expect: GP237
G0 Z5                          ; allow: GP237 GP304
G49                            ; allow: GP304
M30
