G21 G17 G90 G94 G40 G49 G54
#1 = 3.00004                   ; close enough to 3
S6000
M[#1]
M5
M30
