; Six places along X, 18 mm apart, the first at X508 Y370; a holder stands at Z-90.
; AUX1 opens the collet, AUX2 the lid of the rack.
sub put_back
  G53 G0 X[490 + 18 * #5008] Y370
  G53 G0 Z-60
  G53 G1 Z-90 F400
  M54 P1
  G4 P0.4
  G53 G1 Z-60 F800
  M55 P1
  G53 G0 Z0
endsub

sub take
  G53 G0 X[490 + 18 * #5011] Y370
  M54 P1
  G53 G0 Z-60
  G53 G1 Z-90 F400
  M55 P1
  G4 P0.4
  G53 G1 Z-60 F800
  G53 G0 Z0
endsub

sub change_tool
  if [[#5011 < 0] or [#5011 > 6]]
    errmsg "There are six places, not "#5011
  endif
  if [#5011 == #5008]
    msg "Tool "#5011" is in the spindle already"
  else
    M5
    M9
    tcaguard off
    G53 G0 Z0
    M54 P2
    if [#5008 > 0]
      gosub put_back
    endif
    if [#5011 > 0]
      gosub take
    endif
    M55 P2
    G53 G0 Y320
    tcaguard on
    M6 T[#5011]
    if [#5011 > 0]
      G43
    else
      G49
    endif
  endif
endsub
