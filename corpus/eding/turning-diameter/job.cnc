(KNOB ON A BAR OF 45, TURNED BY DIAMETERS: X100 IS 50 MM FROM THE CENTRE LINE)
(zero: centre line, front face of the knob)
G21 G18 G90 G94 G40 G49 G80 G54
S1000 M3
G0 X100 Z30
(== roughing to 44, 43, 42: increments are diameters too ==)
G0 X45 Z2
F120
sub step
  G91
  G0 X-1
  G1 Z-34
  G0 X2
  G0 Z34
  G0 X-2
  G90
endsub
gosub step
gosub step
gosub step
(== contour: ball of radius 10, neck, fillet; I and R are radii ==)
G0 X0 Z2
G1 Z0 F80
G3 X20 Z-10 I0 K-10            (front half of the ball: 20 across)
G1 Z-16
G2 X30 Z-21 R5                 (fillet of 5: 10 more across)
G1 X34
G1 X40 Z-24                    (chamfer of 3)
G1 Z-32
G1 X48
(== part off to 2 across ==)
G0 Z-35
G1 X2 F40
G0 X50
M5
G53 G0 X120                    ; 60 mm of the cross slide: 2 before its end
G53 G0 Z50
M30
