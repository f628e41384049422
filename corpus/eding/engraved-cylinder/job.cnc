(BAND OF DIAMONDS AROUND A CUP, FLAT DRAWING 120 X 30, Y GOES AROUND)
(A turns from 0 to 114.6 + 229.2 = 343.8 degrees: 120 / 20 rad)
G21 G17 G90 G94 G40 G49 G80 G54
S18000 M3
G0 Z5
F600
#1 = 0
while [#1 < 6]
  G0 X0 Y[#1 * 20]
  G1 Z-0.3
  G1 X15 Y[#1 * 20 + 10]
  G1 X0 Y[#1 * 20 + 20]
  G0 Z5
  G0 X30 Y[#1 * 20]
  G1 Z-0.3
  G1 X15 Y[#1 * 20 + 10]
  G1 X30 Y[#1 * 20 + 20]
  G0 Z5
  #1 = [#1 + 1]
endwhile
(rings at both ends)
G0 X-2 Y0
G1 Z-0.3
G1 Y120
G0 Z5
G0 X32
G1 Z-0.3
G1 Y0
G0 Z5
M5
M30
