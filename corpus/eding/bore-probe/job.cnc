; Find the middle of a cast bore, nominal 40 mm at X80 Y60, and turn a seat of 50 mm around it
G21 G17 G90 G94 G40 G49 G54
#101 = 80                 ; nominal middle
#102 = 60
#103 = [40 / 2 - 1 + 3]   ; way of the probe: bore less its ball, and 3 mm more
T9 M6
G43
G0 Z10
G0 X#101 Y#102
G0 Z-4
F60
G38.2 X[#101 + #103]
if [#5067 <> 1]
  errmsg "no wall at +X"
endif
#111 = #5061
G0 X#101
G38.2 X[#101 - #103]
if [#5067 <> 1]
  errmsg "no wall at -X"
endif
#121 = [[#111 + #5061] / 2]
G0 X#121
G38.2 Y[#102 + #103]
if [#5067 <> 1]
  errmsg "no wall at +Y"
endif
#112 = #5062
G0 X#121 Y#102
G38.2 Y[#102 - #103]
if [#5067 <> 1]
  errmsg "no wall at -Y"
endif
#122 = [[#112 + #5062] / 2]
G0 X#121 Y#122
G92 X0 Y0                 ; the middle is the zero now
G0 Z20
T5 M6
G43
S8000 M3
G0 X21 Y0                 ; tool of 8 mm: seat of 50 mm
G0 Z2
G1 Z-1.5 F150
G3 X21 Y0 I-21 F600
G1 Z-3 F150
G3 X21 Y0 I-21 F600
G1 X15
G0 Z20
G0 X0 Y0
G92.1
M5
M30
