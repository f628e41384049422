; POCKET 64 x 40 x 12 WITH SUBS IN INCREMENTAL MODE
; aluminium, 8 mm end mill, 3 mm a level, 5 mm between the lanes
; zero: lower left inside corner of the pocket, top

sub lane_pair                 ; to the right, up, to the left, up; leaves G91 on
  g91
  g1 x56 f1400
  g1 y5
  g1 x-56
  g1 y5
endsub

sub one_level                 ; starts and ends in the lower left corner, at depth
  gosub lane_pair
  gosub lane_pair
  gosub lane_pair
  g1 x56                      ; the lane at y34, then 2 up for the last one
  g1 y2
  g1 x-56
  g90
  g1 x4 y4                    ; along the left wall back to the corner
endsub

sub wall_pass                 ; one finishing turn, corners R1 bigger than the tool
  g90
  g1 x34 y6 f600
  g3 x36 y4 i2 j0             ; roll on to the lower wall
  g1 x59
  g3 x60 y5 i0 j1
  g1 y35
  g3 x59 y36 i-1 j0
  g1 x5
  g3 x4 y35 i0 j-1
  g1 y5
  g3 x5 y4 i1 j0
  g1 x36
  g3 x38 y6 i0 j2             ; roll off
endsub

g21 g17 g90 g94 g40 g49 g54
s12000 m3
m7
g0 z10
g0 x4 y4
g0 z1
#1 = 0
while [#1 > -12]
  #1 = [#1 - 3]
  msg "level "#1
  g1 z#1 f200
  gosub one_level
endwhile
g1 z-11.9 f200
gosub wall_pass
g90
g0 z10
m9
m5
g0 x0 y0
m30
