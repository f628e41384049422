(FIVE T-SLOT STOPS FROM ONE BAR, ZERO SHIFTED WITH G92)
(bar 240 x 30 x 15 in the vice, zero: left front corner, top)
(end mill 10; every stop is 45 long, the next one starts 48 further)
(G92 shifts add up; G92.1 takes them all away at the end)

sub one_stop
  (slot 10 wide along Y, twice 4 deep)
  G0 X22.5 Y-7
  G0 Z1
  G1 Z-4 F250
  G1 Y37 F900
  G1 Z-8 F250
  G1 Y-7 F900
  G0 Z3
  (step at the left side, 3 wide, 5 deep)
  G0 X-2 Y-7
  G1 Z-5 F250
  G1 Y37 F900
  G0 Z3
endsub

G21 G17 G90 G94 G40 G49 G80 G54
G92.1
S10000 M3
M8
G0 Z20
G0 X0 Y0
gosub one_stop
G0 X48 Y0
G92 X0 Y0               (second stop: here is zero now)
gosub one_stop
G0 X48 Y0
G92 X0 Y0               (third)
gosub one_stop
G0 X48 Y0
G92 X0 Y0               (fourth)
gosub one_stop
G0 X48 Y0
G92 X0 Y0               (fifth)
gosub one_stop
(cut 0.5 deeper into the last one: Z shifted, tried again without touching the vice)
G0 X22.5 Y-7
G0 Z5
G92 Z5.5
G1 Z-8 F250             (this is Z-8.5 of the bar)
G1 Y37 F900
G0 Z10
G92.1                   (bar zero again)
G0 Z20 M9
M5
G0 X0 Y0
M30
