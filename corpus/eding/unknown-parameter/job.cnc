; PCB OUTLINE, DEPTH FROM THE PROBING MACRO
; #4120 is kept by the controller: thickness of the board, measured this morning
; here nobody says what it is, so nobody can say how deep the cutter goes
g21 g17 g90 g94 g40 g49 g80 g54
s20000 m3
g0 z5
g0 x5 y5
g0 z1
g1 z[0 - #4120 - 0.1] f200     ; expect: GP225
m5
m30
