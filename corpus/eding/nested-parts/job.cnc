; Door signs, 3 x 2 on a sheet: the dialog for nesting is filled from here
%mx=3
%my=2
%dx=95
%dy=45
G21 G17 G90 G94 G40 G49 G54
S18000 M3
G0 Z5
G0 X10 Y5
G1 Z-1 F300
G1 X80 F1500
G3 X85 Y10 R5
G1 Y30
G3 X80 Y35 R5
G1 X10
G3 X5 Y30 R5
G1 Y10
G3 X10 Y5 R5
G0 Z5
M60
M30
