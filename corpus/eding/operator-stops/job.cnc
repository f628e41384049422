; GUITAR BRIDGE, ROSEWOOD: STOPS FOR THE OPERATOR AND TOOL CHANGES BY HAND
; tool lengths are in the tool table, G43 H takes them from there
; work zero Z is set with the bare spindle nose on the wood
; T1 end mill 6   T2 ball nose 3   T3 drill 3   T5 V-bit
N10 g21 g17 g90 g94 g40 g49 g80 g54
N20 g53 g0 z0
N30 msg "clamp the blank, dust hood down"
N40 m0
N50 t1 m6
N60 g43 h1
N70 s18000 m3
N80 g0 x20 y15
N90 z10
N100 z1
N110 g1 z-4 f500                ; outline in one level, tabs at both ends
N120 x150 f1800
N130 g3 x165 y30 i0 j15
N140 g3 x150 y45 i-15 j0
N150 g1 x20
N160 g3 x5 y30 i0 j-15
N170 g3 x20 y15 i15 j0
N180 g0 z10
N190 m5
N200 g49
N210 g53 g0 z0
N220 m1                         ; measure the width (only with optional stop on)
N230 t2 m6
N240 g43 h2
N250 s20000 m3
N260 g0 x40 y38                 ; saddle slot at a slight angle
N270 z1
N280 g1 z-2.5 f300
N290 x120 y33 f1200
N300 g1 z-5 f300
N310 x40 y38 f1200
N320 g0 z10
N330 m5
N340 g49
N350 g53 g0 z0
N360 t3 m6
N370 g43 h3
N380 s12000 m3
N390 g0 x45 y24
N400 z10
N410 f350
N420 g98 g83 x45 y24 z-9 r1 q2.5
N430 x56
N440 x67
N450 x78
N460 x89
N470 x100
N480 g80
N490 m5
N500 g49
N510 g53 g0 z0
N520 msg "blow out the holes"
N530 m0
N540 t5 m6
N550 g43 h5
N560 s16000 m3
N570 g0 x45 y24
N580 z5
N590 f300
N600 g99 g82 x45 y24 z-0.8 r1 p0.1
N610 x56
N620 x67
N630 x78
N640 x89
N650 g98 x100
N660 g80
N670 m5
N680 g49
N690 g53 g0 z0
N700 g53 g0 x0 y0
N710 m30
