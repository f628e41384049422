; Lid of a switch box: engraved scale, then four slots; every tool is measured by change_tool
G21 G17 G90 G94 G40 G49 G54
T1 M6
S16000 M3
G0 X20 Y20
G0 Z5
#1 = 0
while [#1 < 9]
  G0 X[20 + 10 * #1] Y20
  G1 Z-0.3 F200
  G1 Y26 F700
  G0 Z2
  #1 = [#1 + 1]
endwhile
G0 Z5
T1 M6
S16000 M3
G0 X20 Y40
G1 Z-0.3 F200
G1 X100 F700
G0 Z5
T2 M6
S18000 M3
#1 = 0
while [#1 < 4]
  G0 X[30 + 20 * #1] Y60
  G0 Z2
  G1 Z-4 F150
  G1 Y90 F500
  G0 Z5
  #1 = [#1 + 1]
endwhile
M5
M30
