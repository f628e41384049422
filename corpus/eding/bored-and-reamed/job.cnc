(BEARING BLOCK: DEEP HOLES, REAMING, BORING)
(one tool after the other would be normal; here the cutter stays in)
(because the job was cut into pieces by the shop; this is the piece after drilling 7.8)
(zero: centre of the block, top)
N10 G21 G17 G90 G94 G40 G49 G80 G54
N20 S700 M3
N30 M8
N40 G0 Z30
N50 G0 X-30 Y-20
N60 G0 Z10
N70 F120
(chip breaking, short retract by Q)
N80 G98 G73 X-30 Y-20 Z-28 R3 Q6
N90 X30
N100 Y20
N110 X-30
N120 G80
(ream 8 H7: in and out at the feed)
N130 F90
N140 G99 G85 X-30 Y-20 Z-24 R3
N150 X30
N160 Y20
N170 G98 X-30
N180 G80
(bore with a dwell at the bottom, out at the feed)
N190 F60
N200 G99 G89 X0 Y-15 Z-18 R3 P0.5
N210 G98 Y15
N220 G80
(bore, spindle stops before the tool leaves)
N230 G98 G86 X0 Y0 Z-18 R3 P1
N240 G80
N250 G0 Z30 M9
N260 M5
N270 G0 X0 Y0
N280 M30
