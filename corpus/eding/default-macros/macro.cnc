; Macros of the router, from the set that came with the controller, adapted to this shop
; #4510 #4511  X and Y of the tool setter, machine coordinates
; #4512        machine Z above everything
; #4513        machine Z at which the bare spindle nose would touch the setter
; #4514        machine Z where measuring starts, #4515 where it gives up
; #4516        feed of a measurement
; #4517        thickness of the zero plate
; #4520 #4521  where tools are changed
sub user_1                      ; button: zero Z with the plate
  dlgmsg "Zero Z" "Thickness of the plate" 4517
  if [#5398 == 1]
    m5
    g91
    g38.2 z-20 f[#4516]
    g90
    if [#5067 == 1]
      g0 z#5063
      g92 z[#4517]
      g91
      g0 z10
      g90
      logmsg "plate %.3f " #4517 %.3f
    else
      errmsg "No contact"
    endif
  endif
endsub

sub user_2                      ; button: measure the tool that is in
  if [#5008 == 0]
    errmsg "No tool in the spindle"
  endif
  gosub measure
endsub

sub user_3
  gosub 3d_corner
endsub

sub 3d_corner                   ; button: corner of the work with the 3D finder
  dlgmsg "Corner" "Distance to go" 4530 "Radius of the ball" 4531
  if [#5398 == 1]
    f[#4516]
    g91
    g38.2 x[#4530]
    g90
    #4532 = [#5061 + #4531]
    g91
    g38.2 y[#4530]
    g90
    msg "corner at " #4532 %.3f " " [#5062 + #4531] %.3f
  endif
endsub

sub user_8                      ; button: table of the tools on the screen (newer versions only)
  #110 = 1
  while [#110 < 16]
    GetToolInfo num #110
    logmsg "tool %d " #110 %d
    #110 = [#110 + 1]
  endwhile
endsub

sub user_9                      ; button: vacuum pump over the bus (newer versions only)
  ModbusWrite 1 40001 1
  g4 p2
endsub

sub home_all
  home z
  home x
  home y
endsub

sub to_change_place
  m5
  m9
  g49
  g53 g0 z[#4512]
  g53 g0 x[#4520] y[#4521]
endsub

sub measure
  g53 g0 z[#4512]
  g53 g0 x[#4510] y[#4511]
  g53 g0 z[#4514]
  f[#4516]
  g53 g38.2 z[#4515]
  if [#5067 <> 1]
    errmsg "The setter was not touched"
  endif
  #[5400 + #5008] = [#5053 - #4513]
  g53 g0 z[#4512]
  logmsg "tool %d is %.3f mm long " #5008 %d " " [#5053 - #4513] %.3f
  g43
endsub

sub change_tool
  if [[#5008 == #5011] and [#5011 <> 0]]
    msg "Tool "#5008" is in the spindle already"
  else
    gosub to_change_place
    m6 t[#5011]
    if [#5011 > 0]
      gosub measure
    endif
  endif
  g1
endsub
