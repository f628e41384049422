sub user_1                        ; expect: GP340
  G53 G0 Z0
endsub
