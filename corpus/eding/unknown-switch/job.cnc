; DRAWER FRONTS, LEFT OR RIGHT HAND
; #4001 is set on the variable page: 1 for left hand
; nobody says what it is here: both ways are followed, and both fit
g21 g17 g90 g94 g40 g49 g80 g54
s16000 m3
g0 z8
; gproof: allow GP234: the variable page holds it, and both hands fit
if [#4001 == 1]
  g0 x30 y40
else
  g0 x230 y40
endif
g0 z1
g1 z-6 f300
g0 z8
m5
m30
