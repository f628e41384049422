(SECOND PART OF A PAIR: THE SAME PROGRAM, THE OTHER FIXTURE)
(G54 is fine; G55 was measured at X470, and the part is 160 long)
sub part
  G0 X5 Y5
  G0 Z2
  G1 Z-3 F400
  G1 X120 F1500
  G1 Y60
  G1 X5
  G1 Y5
  G0 Z5
endsub
sub tongue
  G0 X120 Y30
  G0 Z2
  G1 Z-3 F400
  G1 X150 F1500                ; expect: GP301
endsub
G21 G17 G90 G94 G40 G49 G80
S15000 M3
G54
G0 Z5
gosub part
G55
G0 Z5
gosub part
gosub tongue
M5
M30
