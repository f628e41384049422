; measuring routines of a shop: surface grid, corner, hole, tool
sub surface_grid
  if [#4200 == 0]
    #4200 = 12 ; columns
    #4201 = 8  ; rows
    #4202 = 25 ; safe
    #4203 = -5 ; deepest
    #4204 = 10 ; pitch
    #4205 = 150 ; feed
  endif
  #120 = 0
  #121 = 0
  #122 = 0
  #123 = 0
  #125 = 0
  #126 = 1000
  #127 = -1000
  #4200 = 12
  #4201 = 8
  #4202 = 25
  #4203 = -5
  #4204 = 10
  #4205 = 150
  if [1 == 1]
    if [[#4200 < 1] or [#4201 < 1]]
      errmsg "at least one point"
    endif
    if [#4204 <= 0]
      errmsg "pitch must be positive"
    endif
    g21 g90 g17
    g0 z[#4202]
    g0 x0 y0
    #121 = 0
    while [#121 < #4201]
      if [#125 == 0]
        #120 = 0
        while [#120 < #4200]
          g0 z[#4202]
          g0 x[#120 * #4204] y[#121 * #4204]
          #160 = 0
          #161 = 0
          while [[#160 < 3] and [#161 == 0]]
            g38.2 f[#4205] z[#4203]
            #161 = #5067
            if [#161 == 0]
              g0 z[#4202]
              #4203 = [#4203 - 1]
            endif
            #160 = [#160 + 1]
          endwhile
          if [#161 == 1]
            #122 = [#122 + 1]
            #128 = #5063
            #[1000 + #121 * 12 + #120] = #5063
            if [#128 < #126]
              #126 = #128
            endif
            if [#128 > #127]
              #127 = #128
            endif
            msg "point "[#120 + 1]" "[#121 + 1]" z="#128
          else
            #123 = [#123 + 1]
            msg "missed "[#120 + 1]" "[#121 + 1]
          endif
          #120 = [#120 + 1]
        endwhile
        #125 = 1
      else
        #120 = [#4200 - 1]
        while [#120 >= 0]
          g0 z[#4202]
          g0 x[#120 * #4204] y[#121 * #4204]
          #160 = 0
          #161 = 0
          while [[#160 < 3] and [#161 == 0]]
            g38.2 f[#4205] z[#4203]
            #161 = #5067
            if [#161 == 0]
              g0 z[#4202]
              #4203 = [#4203 - 1]
            endif
            #160 = [#160 + 1]
          endwhile
          if [#161 == 1]
            #122 = [#122 + 1]
            #128 = #5063
            #[1000 + #121 * 12 + #120] = #5063
            if [#128 < #126]
              #126 = #128
            endif
            if [#128 > #127]
              #127 = #128
            endif
          else
            #123 = [#123 + 1]
          endif
          #120 = [#120 - 1]
        endwhile
        #125 = 0
      endif
      #121 = [#121 + 1]
    endwhile
    g0 z[#4202]
    if [#123 > 0]
      warnmsg "missed points: "#123
    endif
    msg "flat within "[#127 - #126]
  endif
endsub

sub find_corner
  #130 = 15
  #131 = 100
  dlgmsg "corner" "travel" 130 "feed" 131 "which (1-4)" 132 "tip" 133
  if [#5398 == 1]
    if [[#132 < 1] or [#132 > 4]]
      errmsg "corner must be 1 to 4"
    endif
    #134 = 1
    #135 = 1
    if [[#132 == 2] or [#132 == 3]]
      #134 = -1
    endif
    if [[#132 == 3] or [#132 == 4]]
      #135 = -1
    endif
    g91
    g38.2 x[#134 * #130] f[#131]
    if [#5067 == 1]
      g0 x[0 - #134 * 2]
      g38.2 x[#134 * 3] f[#131 / 4]
      if [#5067 == 1]
        #136 = [#5061 + #134 * #133 / 2]
        g0 x[0 - #134 * 3]
      else
        errmsg "second touch in x missed"
      endif
    else
      errmsg "nothing in x"
    endif
    g38.2 y[#135 * #130] f[#131]
    if [#5067 == 1]
      g0 y[0 - #135 * 2]
      g38.2 y[#135 * 3] f[#131 / 4]
      if [#5067 == 1]
        #137 = [#5062 + #135 * #133 / 2]
        g0 y[0 - #135 * 3]
      else
        errmsg "second touch in y missed"
      endif
    else
      errmsg "nothing in y"
    endif
    g90
    g92 x[#5001 - #136] y[#5002 - #137]
    msg "corner at "#136" "#137
  endif
endsub

sub find_hole
  #140 = 1
  while [#140 <= 3]
    #141 = #5001
    #142 = #5002
    g38.2 x[#141 + 20] f100
    if [#5067 == 1]
      #143 = #5061
    endif
    g0 x[#141]
    g38.2 x[#141 - 20] f100
    if [#5067 == 1]
      #144 = #5061
    endif
    g0 x[[#143 + #144] / 2]
    g38.2 y[#142 + 20] f100
    if [#5067 == 1]
      #145 = #5062
    endif
    g0 y[#142]
    g38.2 y[#142 - 20] f100
    if [#5067 == 1]
      #146 = #5062
    endif
    g0 y[[#145 + #146] / 2]
    #140 = [#140 + 1]
  endwhile
endsub

sub measure_tool
  if [[#4300 == 0] and [#4301 == 0]]
    errmsg "calibrate first"
  else
    g0 g53 z[#4302]
    dlgmsg "tool" "number" 150 "about long" 151 "diameter" 152
    if [#5398 == 1]
      if [[#150 < 1] or [#150 > 99]]
        errmsg "tool 1 to 99"
      endif
      g0 g53 x[#4300] y[#4301]
      g0 g53 z[#4303 + #151 + 10]
      #153 = 0
      #154 = 0
      while [#153 < 3]
        g91
        g38.2 z-20 f60
        if [#5067 == 1]
          #155 = [#5053 - #4303]
          if [[#153 > 0] and [[#155 - #154] > 0.02]]
            warnmsg "readings differ"
          endif
          #154 = #155
          g0 z2
        else
          g90
          g0 g53 z[#4302]
          errmsg "no contact"
        endif
        g90
        #153 = [#153 + 1]
      endwhile
      #[5400 + #150] = #154
      #[5500 + #150] = #152
      g0 g53 z[#4302]
      msg "tool "#150" length "#154
    endif
  endif
endsub
