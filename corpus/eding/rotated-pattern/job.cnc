; Cover 200 x 200: a ring of six kidney slots, the same slot turned by G68, and two badges, one half the size (G51).
; Zero is the middle of the cover, on its top.
G21 G17 G90 G94 G40 G49 G80 G69 G50
G10 L2 P1 X300 Y200 Z-60       ; where the cover is clamped
G54

sub kidney                     ; a slot of 12 mm on the circle of radius 70, from -15 to 15 degrees
  G0 X69.615 Y-18.653
  G0 Z2
  G1 Z-3 F200
  G3 X69.615 Y18.653 R72.07 F900
  G0 Z5
endsub

sub badge                      ; a rounded square with a cross, 24 x 24
  G0 X-9 Y-12
  G0 Z2
  G1 Z-0.4 F200
  G1 X9 F1200
  G3 X12 Y-9 I0 J3
  G1 Y9
  G3 X9 Y12 I-3 J0
  G1 X-9
  G3 X-12 Y9 I0 J-3
  G1 Y-9
  G3 X-9 Y-12 I3 J0
  G0 Z2
  G91                          ; increments are turned and scaled too
  G0 X9 Y4
  G90
  G1 Z-0.4 F200
  G1 Y8 F1200
  G0 Z2
  G0 X-8 Y0
  G1 Z-0.4 F200
  G1 X8 F1200
  G0 Z5
endsub

S16000 M3
G0 Z5
#1 = 0
while [#1 < 6]
  G68 R[#1 * 60] X0 Y0
  gosub kidney
  #1 = [#1 + 1]
endwhile
G69

G68 R45 X0 Y0                  ; the large badge stands on its corner
gosub badge
G69

G10 L2 P2 X300 Y260 Z-60       ; the small one above it, about its own zero
G55
G68 R12.5 X0 Y0
G51 P0.5 I0 J0
gosub badge
G50
G69
G54

M5
G0 X0 Y0
M30
