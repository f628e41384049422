(NAME PLATE, EDITED AT THE MACHINE IN A HURRY)
N10 G21 G17 G90 G94
N20 G40 G49 G80 G54
N30 S18000 M3
N40 G0 Z5
N50 G0 X10 Y10
N60 G1 Z-1 F300
N70 G1 X40..5 F1200            ; expect: GP102
N80 G1 X50 Y                   ; expect: GP108
N90 G1 X60 Y10 X61             ; expect: GP109
N100 G0 G1 X70                 ; expect: GP110
N110 G27 X80                   ; expect: GP112
N120 G1 X[20 + ]               ; expect: GP107
N130 (end of the first word (see sketch) ; expect: GP104
N140 (rapid to the second word ; expect: GP103
N1500000 G0 Z5                 ; expect: GP105
N160 gosub second_word         ; expect: GP115
N170 G0 Z5
N180 M5
N190 M30
