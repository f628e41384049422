G21 G17 G90 G94 G40 G49 G54
G0 X10 Y20
; a long remark
; goes on several lines
M30
