; The inverter says at input 1 that the speed is reached
sub m3
  M3 S#19
  M56 P1 L1 Q20
  if [#5399 == 0]
    M5
    errmsg "The spindle does not come to its speed"
  endif
endsub

; Vacuum on: P valve, Q seconds to wait, or 1 when left out
sub m110
  M54 P[#16]
  if [#17 < 0]
    G4 P1
  else
    G4 P#17
  endif
  M56 P3
  if [#5399 == 0]
    errmsg "No vacuum"
  endif
endsub

sub m111
  M55 P[#16]
  G4 P0.5
endsub
