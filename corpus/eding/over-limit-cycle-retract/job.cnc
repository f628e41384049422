(DOWEL HOLES IN A TALL BLOCK)
(block top is 60 above the machine table zero, the spindle can go up to Z90)
G21 G17 G90 G94 G40 G49 G80 G54
S5000 M3
F200
G0 Z80
G0 X20 Y20
G98 G81 X20 Y20 Z40 R63
X50
X80
(the R word should have been 63: a slip of the finger)
G81 X80 Y60 Z40 R93            ; expect: GP301
G80
M5
M30
