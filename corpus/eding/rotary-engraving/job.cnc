; RING ENGRAVING ON THE A AXIS, INVERSE TIME FEED
; ring: outer diameter 22, 8 wide; X runs along the ring, A turns it
; zero: X at the left edge, Y and Z in the centre of rotation
; tool tip on the surface is therefore Z11
; with G93 the F word is one over the minutes the move may take

sub wave                        ; one wave around the ring, 12 moves of 30 degrees
  #301 = 0
  while [#301 < 12]
    #301 = [#301 + 1]
    #302 = [4 + 2.2 * sin[#301 * 60]]
    ; arc length per move: 11 mm radius * 30 degrees = 5.76; plus the X part; F400
    #303 = [5.76 * 5.76 + 2.2 * 2.2]
    #304 = [400 / sqrt[#303]]
    g1 x#302 a[#301 * 30 + #305] f#304
  endwhile
endsub

g21 g17 g90 g94 g40 g49 g80 g54
s22000 m3
g0 z25
g0 x4 y0 a0
g0 z11.5
g1 z10.9 f100                   ; still G94: millimetres a minute
g93
#305 = 0
gosub wave
; second turn, a little deeper, the table keeps turning the same way
g1 z10.85 f120
#305 = 360
gosub wave
; borders: one turn each, half a minute a turn would be F2
g94 f300
g0 z12
g0 x0.8
g1 z10.9 f100
g93
g1 a1080 f4
g94 f300
g0 z12
g0 x7.2
g1 z10.9 f100
g93
g1 a1440 f4
g94 f300
g0 z25
m5
; unwind
g0 a0
m30
