G21 G17 G90 G94 G40 G49 G54
G0 X10 Y20                     ; expect: GP106 a very long remark that nobody will read on the small screen of the controller a very long remark that nobody will read on the small screen of the controller a very long remark that nobody will read on the small screen of the controller 
M30
