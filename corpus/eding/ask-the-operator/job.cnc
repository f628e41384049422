; Round disc of any size: the operator gives its diameter and thickness
G21 G17 G90 G94 G40 G49 G54
#100 = 60
#101 = 3
dlgmsg "Disc" "Diameter" 100 "Thickness" 101
if [#5398 == -1]
  msg "Nothing was cut"
  M30
endif
#1 = [#100 / 2 + 3]       ; tool of 6 mm
S15000 M3
G0 Z10
G0 X[150 - #1] Y100
G0 Z2
#2 = 0
while [#2 < #101]
  #2 = [#2 + 1]
  G1 Z[0 - #2] F200
  G1 X[150 - #1] Y[100 + #1] F900
  G1 X[150 + #1]
  G1 Y[100 - #1]
  G1 X[150 - #1]
  G1 Y100
endwhile
G0 Z10
M5
M30
