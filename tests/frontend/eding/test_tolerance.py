"""Lines as people's files have them: each means the same as the plain form beside it.

What is written on the left is the habit of macro files and CAM output for this controller: tabs, words glued together,
any case, comments behind everything, quotes of every kind in comments. The right side is the form that the other tests
stand on.
"""

from __future__ import annotations

import dataclasses
from typing import Any

import pytest
from frontend.eding.programs import without_places
from support.each import each

from gproof.frontend.eding.parse import parse_line


def meaning(line: str) -> Any:
    """The statements of a line without places and comments."""
    return without_comments(without_places(list(parse_line(line.encode(), "job.cnc", 3))))


def without_comments(node: Any) -> Any:
    if isinstance(node, tuple):
        return tuple(without_comments(item) for item in node)
    if not dataclasses.is_dataclass(node) or isinstance(node, type):
        return node
    changes = {f.name: without_comments(getattr(node, f.name)) for f in dataclasses.fields(node)}
    if "comment" in changes:
        changes["comment"] = ""
    return dataclasses.replace(node, **changes)


SAME = [
    # blanks, tabs, case
    ("\tg0\tx1\ty#2", "g0 x1 y#2"),
    ("G0 X1 Y#2   \t ", "g0 x1 y#2"),
    ("   G1X#1Y#2F#3", "g1 x#1 y#2 f#3"),
    ("g1 x- #1 y + #2", "g1 x-#1 y+#2"),
    ("G1 X[ 1 + 2 ] Y [ 3 ]", "g1 x[1+2] y[3]"),
    ("G 1 X [ #1 ]", "g1 x[#1]"),
    ("X[#1*COS[#2]]Y[#1*Sin[#2]]", "x[#1*cos[#2]] y[#1*sin[#2]]"),
    ("g1xsin[30]y cos [60]", "g1 xsin[30] ycos[60]"),
    ("# 1 = 5", "#1=5"),
    ("#1=5#2=6", "#1=5 #2=6"),
    ("#100 = - 12.5", "#100=-12.5"),
    ("#1=1.#2=.5", "#1=1.0 #2=0.5"),
    ("#1=#2", "#1 = #2"),
    ("#3=[#1 MOD 2]", "#3=[#1mod2]"),
    ("#3=[1 BAND #2]", "#3=[1 band #2]"),
    ("#3=[ #1<<2 ]", "#3=[#1 << 2]"),
    ("#1=ATAN[ -1 ]/[ -1 ]", "#1=atan[-1]/[-1]"),
    ("x[#1 - -1]", "x[#1--1]"),
    ("x[#1 -1]", "x[#1-1]"),
    ("X##2", "x#[#2]"),
    # words glued together and with values of every kind
    ("m6t[#5011]", "m6 t#5011"),
    ("M6 T #5011", "m6 t[#5011]"),
    ("G53G01Z45f100X#1", "g53 g1 z45 f100 x#1"),
    ("g53g0x[#5131]y#5132", "g53 g0 x#5131 y#5132"),
    ("G53 G0 Z[#5113-1.0]", "g53 g0 z[#5113 - 1]"),
    ("M54E2Q[#1*10]", "m54 e2 q[#1 * 10]"),
    ("m56p3l2q#4", "m56 p3 l2 q#4"),
    ("g38.2z[#4103]f#4105", "g38.2 z#4103 f#4105"),
    ("G4P[#1]", "g4 p#1"),
    ("G43H#5008", "g43 h#5008"),
    ("G10L20P1X0Y[#5071]", "g10 l20 p1 x0 y#5071"),
    ("m100s[#1]p2", "m100 s#1 p2"),
    ("M3S[#1*1000]M8", "m3 s[#1*1000] m8"),
    ("#[5400+#5016]=[#5053-#4999]", "#[5400 + #5016] = [#5053 - #4999]"),
    # line numbers and comments anywhere a comment may stand
    ("N10 (comment) G0 X#1", "g0 x#1"),
    ("N0100#100=12.5(slot width)", "#100=12.5"),
    ("n 1 0 x#1", "x#1"),
    ("/ N30 g1 x#1", "/g1 x#1"),
    ("( indented ) x#1 ", "x#1"),
    ("(a)(b)x#1(c)y2(d);e", "x#1 y2"),
    ("g1 x#1 ;to the left", "g1 x#1"),
    ("g1 x#1;;;* * *", "g1 x#1"),
    ("m3 s#19;The real one", "m3 s#19"),
    ("#1=5 (a) #2=[6] ; b", "#1=5 #2=[6]"),
    ("g1 x#1 (it's 5\" wide, “so” «called» `tick` ’n’ „low“ ‚x‘)", "g1 x#1"),
    ("#1=5;it's \"half open and (so is this", "#1=5"),
    ("#1=5 (only one \" here)", "#1=5"),
    ("#1=5 ; “ and ” and ” again, )", "#1=5"),
    ("(é µ ° ½) x#1", "x#1"),
    ("#15 = 0 ; Werkzeug prüfen", "#15=0"),
    # flow control
    ("if[#1==2]", "if [#1 == 2]"),
    ("If [#1 == 2] Then", "if [#1 == 2]"),
    ("if [#1>0]then;do it", "if [#1 > 0]"),
    ("IF [#5397 == 0] then ;not rendering", "if [#5397 == 0]"),
    ("If [ [#5011] <> [#5008] ] ", "if [[#5011] <> [#5008]]"),
    ("\tIF [[#1 > 2] and [#2 < 3]] (both)", "if [[#1 > 2] and [#2 < 3]]"),
    ("if [NOT[#5067]]", "if [not[#5067]]"),
    ("if [#1== - 1]", "if [#1 == -1]"),
    ("N5 if [#1]", "if [#1]"),
    ("(first) if [#1]", "if [#1]"),
    ("ELSE (otherwise)", "else"),
    ("Else ; it's not", "else"),
    ("else;x", "else"),
    ("ENDIF;done", "endif"),
    ("END\tIF", "endif"),
    ("  EndIf   ", "endif"),
    ("While[#1<=360];turn", "while [#1 <= 360]"),
    ("WHILE [1]", "while [1]"),
    ("end  while", "endwhile"),
    ("EndWhile (loop)", "endwhile"),
    ("SUB change_tool ;* called by m6", "sub change_tool"),
    ("sub\tuser_1 (button 1)", "sub user_1"),
    ("Sub M100;mine", "sub m100"),
    ("End sub", "endsub"),
    ("endsub;---------", "endsub"),
    ("ENDSUB (end)", "endsub"),
    ("gosub PickTool ;take it", "gosub picktool"),
    ("GoSub PickTool(c)", "gosub picktool"),
    ("gosub\t\tdrop_tool  ", "gosub drop_tool"),
    ("N7 GOSUB drop_tool", "gosub drop_tool"),
    # messages
    ('Msg"Done"', 'msg "Done"'),
    ('msg "length "#[5400 + #5016]', 'msg "length " #[5400+#5016]'),
    ('msg "X="#5001"mm"', 'msg "X=" #5001 "mm"'),
    ('MSG "X=" #5001 " Y="#5002 ', 'msg "X="#5001" Y="#5002'),
    ('msg "tool "[#5008]" of "[#1+1];c', 'msg "tool " #5008 " of " [#1 + 1]'),
    ('msg“AUX3=ON”', 'msg "AUX3=ON"'),
    ("Msg ”AUX3=ON”(c)", 'msg "AUX3=ON"'),
    ('msg "it\'s (really) 100% done; ok" ; (c', 'msg "it\'s (really) 100% done; ok"'),
    ('WarnMsg "insert tool "#5011", press RUN"', 'warnmsg "insert tool " #5011 ", press RUN"'),
    ('ErrMsg "no tool!" ; stop', 'errmsg "no tool!"'),
    ('errmsg"tool > 6"', 'errmsg "tool > 6"'),
    ('LogMsg "z="#5053', 'logmsg "z=" #5053'),
    ('LogFile "probe.txt" 0', "logfile probe.txt 0"),
    ('dlgmsg "Size?" par1 100 par2 101', 'dlgmsg "Size?" "par1" 100 "par2" 101'),
    ('DlgMsg"Size?"  width 100;ask', 'dlgmsg "Size?" "width" 100'),
    ('DLGMSG “Sure?”', 'dlgmsg "Sure?"'),
    # commands
    ("TCAGuard off ;guard off", "tcaguard off"),
    ("mcaguard\tON", "mcaguard on"),
    ("HomeIsEstop  On;safe", "homeisestop on"),
    ("HOME Z;up first", "home z"),
    ("\thomeTandem X", "hometandem x"),
    ("tanknife  ON   -90 ;bent", "tanknife on -90"),
    ("ZHCINIT [#4104][#4100][#4101]", "zhcinit #4104 #4100 #4101"),
    ("zhcAddPoint ;measured", "zhcaddpoint"),
    ("%MX = 200 ;material", "%mx=200.0"),
]  # fmt: skip


@each("written,plain", SAME)
def test_a_line_as_people_write_it_means_its_plain_form(written: str, plain: str) -> None:
    assert meaning(written) == meaning(plain)
    assert meaning(written)


@each("written,plain", [row for row in SAME if row[0].isascii()])
def test_neither_case_nor_blanks_at_the_ends_matter(written: str, plain: str) -> None:
    folded = written if '"' in written or "log" in written.lower() else written.upper()
    assert meaning(f" \t{folded}\t ") == meaning(plain)


@pytest.mark.parametrize(
    "line", ["", " \t ", ";* banner *", "()", "( )", "(a)(b) ; c", "N10", "N10 ;c", "/", "/N5 (c)"]
)
def test_lines_that_mean_nothing(line: str) -> None:
    assert meaning(line) == ()
