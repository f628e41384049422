; FACING THE SPOIL BOARD, 760 x 480
; surfacing cutter 40 mm, lanes 32 apart
#501 = 20                      ; first lane, Y
#502 = 32                      ; step
#503 = 480                     ; last lane not beyond this
#504 = -0.4                    ; depth
#505 = 0                       ; 0: to the right, 1: to the left
g21 g17 g90 g94 g40 g49 g80 g54
g64 p0.1
s14000 m3
g4 p5
g0 z15
g0 x10 y#501
g1 z#504 f800
while [#501 <= #503]
  g1 y#501 f6000
  if [#505 == 0]
    g1 x770
    #505 = 1
  else
    g1 x10
    #505 = 0
  endif
  #501 = [#501 + #502]
endwhile
g0 z15
m5
g0 x0 y0
msg "board is flat, last lane at Y"[#501 - #502]
m30
