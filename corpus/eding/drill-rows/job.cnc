(PERFORATED PANEL, ROWS OF HOLES WITH G91 AND L)
(200 x 90, acrylic, drill 3.2 for plastics; zero: lower left corner, top)
G21 G17 G90 G94 G40 G49 G80 G54
S4000 M3
M7
F300
G0 Z20
(row 1: 12 holes, pitch 15; the first one is at X15)
G0 X0 Y15
G0 Z6
G91 G98 G81 X15 Z-8 R-4 L12     (R plane 4 below Z6, bottom 8 below that)
G80 G90
(row 2, staggered: 11 holes)
G0 X7.5 Y35
G91 G99 G81 X15 Z-8 R-4 L11     (stays low between the holes)
G80 G90
G0 Z6
(row 3)
G0 X0 Y55
G91 G98 G82 X15 Z-8 R-4 P0.15 L12
G80 G90
(diagonal: 8 holes going up and right)
G0 X20 Y62
G91 G98 G83 X20 Y2 Z-8 R-4 Q3 L8
G80 G90
(the same hole twice: once more through the last one, to clean it)
G98 G81 X180 Y78 Z-6 R2 L2
G80
G0 Z20 M9
M5
G0 X0 Y0
M30
