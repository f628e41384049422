; NINE PARTS IN NINE FIXTURES, 3 x 3, PITCH 110 x 85
; the fixture plate sits on its dowels: the offsets are in the program
; part: washer plate 60 x 50, two holes and a window

sub part
  g0 x15 y25
  g99 g81 x15 y25 z-6 r2 f300
  x45
  g80
  g0 z4
  g0 x30 y20
  g0 z1
  g1 z-3 f200
  g1 y30 f800
  g1 x33
  g2 x36 y27 i0 j-3
  g1 y23
  g2 x33 y20 i-3 j0
  g1 x30
  g0 z10
endsub

g21 g17 g90 g94 g40 g49 g80
g10 l2 p1 x20 y15 z0
g10 l2 p2 x130 y15 z0
g10 l2 p3 x240 y15 z0
g10 l2 p4 x20 y100 z0
g10 l2 p5 x130 y100 z0
g10 l2 p6 x240 y100 z0
g10 l2 p7 x20 y185 z0.5       ; the back row lies on a 0.5 shim
g10 l2 p8 x130 y185 z0.5
g10 l2 p9 x240 y185 z0.5
s9000 m3
m7
g54
g0 z25
gosub part
g55
gosub part
g56
gosub part
g57
gosub part
g58
gosub part
g59
gosub part
g59.1
gosub part
g59.2
gosub part
g59.3
gosub part
g0 z25
m9
m5
; show the operator the middle fixture for the check: its corner gets zero from where the tool is
g58
g0 x0 y0
g10 l20 p1 x0 y0
g54
g0 x5 y5                      ; 5 / 5 from the corner of the middle fixture
g0 x0 y0
m30
