; STENCIL, LASER ON THE SPINDLE OUTPUT, AIR ASSIST ON AUX1
; S is the power, M3 and M5 switch the beam; every hole is pierced first
; zero: lower left corner of the sheet; focus set by hand, Z stays where it is
#401 = 0.35                     ; piercing time, seconds
#402 = 0.08                     ; settle time after a rapid

sub pierce
  g4 p#402
  s900 m3
  g4 p#401
  s450
endsub

sub beam_off
  m5
  g4 p0.05
endsub

sub dot                         ; a round hole about the present place, radius #410
  #411 = #5001
  #412 = #5002
  g0 x[#411 + #410] y#412
  gosub pierce
  g3 x[#411 + #410] y#412 i[0 - #410] j0 f600
  gosub beam_off
  g0 x#411 y#412
endsub

g21 g17 g90 g94 g40 g54
g61
m54 p1                          ; air on
g4 p1
; a row of dots, growing
#420 = 0
while [#420 < 10]
  #410 = [1 + 0.25 * #420]
  g0 x[15 + 12 * #420] y15
  gosub dot
  #420 = [#420 + 1]
endwhile
; a grid of pin holes: no motion while the beam is on
#430 = 0
while [#430 < 5]
  #431 = 0
  while [#431 < 8]
    g0 x[20 + 14 * #431] y[35 + 6 * #430]
    g4 p#402
    s250 m3
    g4 p0.15
    m5
    #431 = [#431 + 1]
  endwhile
  #430 = [#430 + 1]
endwhile
; outline
g0 x5 y5
gosub pierce
g1 x135 f900
g3 x140 y10 i0 j5
g1 y65
g3 x135 y70 i-5 j0
g1 x5
g3 x0 y65 i0 j-5
g1 y10
g3 x5 y5 i5 j0
gosub beam_off
g4 p2                           ; air a little longer, against the smoke
m55 p1
g0 x0 y0
m30
