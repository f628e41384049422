; Flange of 10 mm sheet, plasma: hole of 60, outside 160, each with a lead-in. The sheet's top is 80 below Z zero.
G21 G17 G90 G94 G40 G49 G80 G54
G10 L2 P1 X400 Y300 Z-80
M23 Q128                       ; arc voltage that height control aims at
F2400
G0 Z40

G0 X10 Y0                      ; the hole
G0 Z6
M54 P1                         ; torch on
G4 P0.8                        ; pierce
G1 Z1.5
M20                            ; expect: GP280
G1 X30
G3 X30 Y0 I-30 J0
M55 P1
M21                            ; expect: GP280
G0 Z40

G0 X95 Y0                      ; outside
G0 Z6
M54 P1
G4 P0.8
G1 Z1.5
M20                            ; expect: GP280
G1 X80
G2 X80 Y0 I-80 J0
M55 P1
M21                            ; expect: GP280
G0 Z40
G0 X0 Y0
M30
