(COASTER, POSTED WITH THE WRONG POST-PROCESSOR)
(the numbers are millimetres, but the header says inch)
G20 G17 G90 G94 G40 G49 G80 G54
S18000 M3
G0 Z2
G0 X4 Y4
G1 Z-0.5 F20
G1 X90 F60                     ; expect: GP301
M5
M30
