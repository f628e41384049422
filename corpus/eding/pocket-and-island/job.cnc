(COVER 140 x 100: POCKET 110 x 70 WITH A ROUND ISLAND, DRAWING SIZES, CUTTER COMPENSATION BY THE CONTROLLER)
(zero: lower left corner, top of the plate; T1 end mill 8, T2 finishing mill 6; the pocket is cleared already)
G21 G17 G90 G94 G40 G49 G80 G54
G64 P0.02
T1 M6
S12000 M3 M8
G0 Z20
(== wall of the pocket from inside: counter-clockwise, the cutter on its left ==)
#1 = 0                         (depth)
while [#1 < 6]
  #1 = [#1 + 3]
  G0 X45 Y65
  G1 Z[-#1] F300
  G41                          (no D: the tool in the spindle)
  G1 X30 F900                  (entry 1: longer than the cutter radius)
  G3 X15 Y50 R15               (entry 2: larger than the cutter, onto the left wall)
  G1 Y23
  G3 X23 Y15 R8
  G1 X117
  G3 X125 Y23 R8
  G1 Y77
  G3 X117 Y85 R8
  G1 X23
  G3 X15 Y77 R8
  G1 Y45
  G40
  G1 X24                       (off the wall)
  G0 Z5
endwhile
(== island of radius 12 around X70 Y50: clockwise, the cutter on its left again; in steps, then T2 in one ==)
sub island
  G0 X62 Y30
  G1 Z[-#1] F300
  G41
  G1 X58 Y42 F800              (entry: from the side of the island, onto its tangent)
  G1 Y50
  G2 X58 Y50 I12
  G2 X70 Y62 R12               (on for a quarter)
  G40
  G0 Z5
endsub
#1 = 3
gosub island
#1 = 6
gosub island
M9
T2 M6
S14000 M3 M8
gosub island
G0 Z20
M9
M5
M30
