; By hand, then measured: the setter stands at X30 Y380; #4100 is where the bare spindle nose would touch it
sub change_tool
  M5
  G49
  G53 G0 Z0
  G53 G0 X300 Y20
  M6 T[#5011]
  if [#5011 > 0]
    G53 G0 X30 Y380
    G53 G0 Z-20
    F120
    G53 G38.2 Z-125
    if [#5067 <> 1]
      errmsg "The setter was not touched"
    endif
    #[5400 + #5011] = [#5053 - #4100]
    G53 G0 Z0
    msg "Tool "#5011" is "#[5400 + #5011]" mm long"
    G43
  endif
endsub
