; INTERNAL THREAD M24 x 2, ONE-POINT THREAD MILL, CLIMB MILLING FROM BELOW
; bore 22.0 is there already, 20 deep; thread 14 deep
; tool T4: cutting diameter 16.0, so the tool centre runs on radius 4.0
; zero: centre of the bore, top face
#201 = 4.0      ; radius of the path at full depth
#202 = 2.0      ; pitch
#203 = 7        ; turns
#204 = -15      ; Z where the first turn starts

sub thread_pass               ; #210 = radius of this pass
  g0 x0 y0
  g0 z2
  g0 z#204
  ; roll in: half a circle from the centre to the wall, half a pitch up
  #211 = [#210 / 2]
  g3 x#210 y0 z[#204 + #202 / 2] i#211 j0 f300
  #212 = 0
  #213 = [#204 + #202 / 2]
  while [#212 < #203]
    #213 = [#213 + #202]
    g3 x#210 y0 z#213 i[0 - #210] j0 f420
    #212 = [#212 + 1]
  endwhile
  ; roll out: half a circle back to the centre
  g3 x0 y0 z[#213 + #202 / 2] i[0 - #211] j0
  g0 z5
endsub

g21 g17 g90 g94 g40 g49 g80 g54
s3500 m3
m7
g0 z20
msg "first pass, 0.4 left on the radius"
#210 = [#201 - 0.4]
gosub thread_pass
msg "second pass"
#210 = [#201 - 0.1]
gosub thread_pass
msg "finish, twice against the spring of the tool"
#210 = #201
gosub thread_pass
gosub thread_pass
m9
m5
g0 z20
m30
