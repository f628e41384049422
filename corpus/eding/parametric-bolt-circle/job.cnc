; FLANGE, BOLT CIRCLE WITH VARIABLES
; change the six numbers below and press redraw
#101 = 40      ; radius of the bolt circle, mm
#102 = 8       ; number of holes
#103 = 22.5    ; angle of the first hole, degrees
#104 = 75      ; centre X
#105 = 60      ; centre Y
#106 = -9      ; depth of the holes
#107 = 3       ; safe height above the flange
#108 = 240     ; drilling feed mm/min

sub drill_here
  g0 x#112 y#113
  g0 z[#107 / 3]
  g1 z[#106 / 2] f#108
  g0 z#107                  ; clear the chips
  g0 z[#106 / 2 + 0.5]
  g1 z#106
  g4 p0.3
  g0 z#107
endsub

sub bolt_circle
  #110 = 0
  while [#110 < #102]
    #111 = [#103 + #110 * 360 / #102]
    #112 = [#104 + #101 * cos[#111]]
    #113 = [#105 + #101 * sin[#111]]
    #110 = [#110 + 1]
    msg "hole "#110" of "#102", angle "#111
    gosub drill_here
  endwhile
endsub

sub centre_bore               ; spiral out with a 6 mm end mill, no drill needed
  #120 = 2                    ; radius of the tool path
  g0 x#104 y#105
  g1 z[#106] f120
  while [#120 <= 10]
    g1 x[#104 + #120] f600
    g3 x[#104 + #120] y#105 i[0 - #120] j0
    #120 = [#120 + 2]
  endwhile
  g1 x#104
  g0 z#107
endsub

g21 g17 g90 g94 g54
if [#102 < 3]
  msg "a bolt circle with fewer than three holes?"
  m0
else
  msg "bolt circle of "#102" holes, diameter "[2 * #101]
endif
s8000 m3
m8
g0 z#107
gosub bolt_circle
if [#101 > 30]                ; there is only room for the bore on large flanges
  gosub centre_bore
endif
m9
m5
g0 z20
g0 x0 y0
msg "done"
m30
