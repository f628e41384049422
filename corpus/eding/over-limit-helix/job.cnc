(CORNER PILLAR SOCKET: BORE 70, HELIX DOWN 4 A TURN)
(socket centre X565 Y60; the path radius is 30 with a 10 mm cutter, the table ends at X590)
G21 G17 G90 G94 G40 G49 G80 G54
S16000 M3
G0 Z10
(a small socket first: all right)
G0 X480 Y60
G0 Z1
G1 X490 F900
G3 X490 Y60 Z-3 I-10 J0
G3 X490 Y60 Z-7 I-10 J0
G3 X490 Y60 I-10 J0
G0 Z10
(the big one, start and end of each turn at the side that is inside)
G0 X565 Y60
G0 Z1
G1 X535 F900
G3 X535 Y60 Z-3 I30 J0         ; expect: GP301
G0 Z10
M5
G0 X0 Y0
M30
