; Engraved scale: each tool is measured on the setter when it comes into the spindle
G21 G17 G90 G94 G40 G49 G54
T1 M6
S16000 M3
G0 X10 Y10
G0 Z5
G1 Z-0.4 F200
G1 X210 F900
G0 Z5
M5
T2 M6
S20000 M3
#1 = 0
while [#1 <= 200]
  G0 X[10 + #1] Y10
  G0 Z1
  G1 Z-0.3 F200
  G1 Y16 F700
  G0 Z1
  #1 = [#1 + 5]
endwhile
G0 Z5
M5
M30
