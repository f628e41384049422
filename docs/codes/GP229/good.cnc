G21 G17 G90 G94 G54
#[round[7 / 2]] = 5
M30
