; TOOL IS FETCHED FROM THE MAGAZINE BY THE JOB ITSELF
; old machine without change_tool: the fork of T2 stands at machine X575 Y380
; the tool-change area is guarded, so the guard is switched off on purpose
g21 g17 g90 g94 g40 g49 g80 g54
g53 g0 z0
m5
tcaguard off
g53 g0 x575 y320               ; in front of the magazine
g53 g0 z-110
g53 g1 y380 f600               ; into the fork
m54 p1                         ; collet open
g4 p1
g53 g1 z-60 f600               ; spindle up, the holder stays
g53 g1 z-110 f300              ; and down on it again: pick
m55 p1
g4 p1
g53 g1 y320 f600               ; out of the fork
g53 g0 z0
tcaguard on
; the work itself: a groove
s15000 m3
g0 x30 y30
g0 z5
g1 z-3 f300
g1 x150 f1200
g1 y90
g0 z5
m5
g53 g0 z0
g53 g0 x0 y0
m30
