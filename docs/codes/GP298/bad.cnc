G21 G17 G90 G94 G40 G49 G54
G43 H1
#5401 = 40                    ; expect: GP298
G0 Z20                         ; expect: GP304
M30
