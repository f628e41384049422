(LINEAR SCALE 300 MM, A LINE EVERY 25 MM)
(the machine has a pitch table on X: its motor stands up to 0.055 beside the scale, far from the limits)
G21 G17 G90 G94 G40 G49 G80 G54
S20000 M3
F600
G0 Z5
G0 X0 Y0
G91
#1 = 0
while [#1 < 12]
  G1 Z-5.2
  G1 Y8
  G0 Z5.2
  G0 X25 Y-8
  #1 = [#1 + 1]
endwhile
G90
M5
G0 X0 Y0
M30
