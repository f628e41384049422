sub corner
  G0 X10 Y10
endsub

sub user_1                     ; no job calls it: a button does
  G0 X10 Y[#1 + ]
  gosub corners
endsub
