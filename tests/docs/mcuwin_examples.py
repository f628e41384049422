"""The shortest program that uses each thing that the manuals of McuWIN name, and the machine it runs on.

Source: the sections that ``mcuwin_2.5.3.133.txt`` lists. ``HEAD`` and ``END`` stand around each of them.
"""

from __future__ import annotations

from dataclasses import dataclass, field

MACHINE = """\
schema = "gproof-machine/1"
units = "mm"

[axes.x]
min = -300
max = 300
home_place = 0
position_unit = "mm"

[axes.y]
min = -200
max = 200
home_place = 0
position_unit = "mm"

[axes.z]
min = -100
max = 100
home_place = 0
position_unit = "mm"

[axes.c]
min = -720
max = 720
home_place = 0
position_unit = "deg"

[din]
case_sensitive = false
position_unit = "mm"
time_unit = "min"
absolute_centers = true
interpolation_axes = "XYZ"
zero_offsets = [[10, 10, 0, 0], [20, 10, 0, 0], [30, 10, 0, 0], [40, 10, 0, 0], [50, 10, 0, 0]]

[din.task0]
M0 = "stop"
M2 = "end"
M3 = "spindle_cw"
M4 = "spindle_ccw"
M5 = "spindle_off"
M6 = "tool_change"
M8 = "coolant_on"
M9 = "coolant_off"
M30 = "end"
M100 = "nothing"
G74 = "home"
S = "spindle_speed"
T = "tool_select"
D = "nothing"
G200 = "nothing"
M200 = "nothing"
"""
TOOLS = "[ToolsXY]\nR1=2,0\nL1=0,0\n[ToolsYZ]\nR1=2,0\nL1=0,0\n[ToolsZX]\nR1=2,0\nL1=0,0\n"
SETUP = """\
schema = "gproof-setup/1"
units = "mm"
homed = ["x", "y", "z", "c"]
start = {x = 0.0, y = 0.0, z = 0.0, c = 0.0}
"""

HEAD = "%EXAMPLE\nG53\nG90\nG94\nG162\nG00 X10 Y10 Z5\n"
END = "M30\n%\n"


@dataclass(frozen=True)
class Example:
    """body: between head and END; before: the first %; after: the last one; files: that it includes."""

    body: str
    before: str = ""
    after: str = ""
    files: dict[str, str] = field(default_factory=dict)
    head: str = HEAD

    @property
    def text(self) -> str:
        """The whole job."""
        body = self.body + "\n" if self.body else ""
        return f"{self.before}{self.head}{body}{END}{self.after}"


_E = Example
_ROUND = "G01 X30 F500\nG03 X40 Y20 I0 J10"
_LIFT = "%7\nG91\nG00 Z2\nG90\nM17\n%\n"
_DECLARED = "$DINEND\nvar\n  depth : double;\n  pass : integer;\n{$DINSTART}\n"
_CONTOUR = "G01 X40 Y20 F500\nG01 X60 Y20\nG40\nG01 X80 Y10"

EXAMPLES: dict[str, Example] = {
    "G00": _E("G00 X20"),
    "G01": _E("G01 X20 F500"),
    "G02": _E("G01 X30 F500\nG02 X40 Y0 I0 J-10"),
    "G03": _E(_ROUND),
    "G04": _E("G04 1.5"),
    "G17": _E(f"G17\n{_ROUND}"),
    "G18": _E("G18\nG01 X30 F500\nG03 X40 Z15 I10 K0"),
    "G19": _E("G19\nG01 Y30 F500\nG03 Y40 Z15 J0 K10"),
    "G21": _E("G21\nG01 Y20 F500\nG24"),
    "G22": _E("G22\nG01 X20 F500\nG24"),
    "G23": _E("G23\nG01 X20 Y20 F500\nG24"),
    "G24": _E("G22\nG24\nG01 X20 F500"),
    "G39": _E("G22\nG39 X2\nG01 X20 F500\nG39\nG24"),
    "G40": _E("G40\nG01 X20 F500"),
    "G41": _E(f"T1\nG41\n{_CONTOUR}"),
    "G42": _E(f"T1\nG42\n{_CONTOUR}"),
    "G51": _E("G51 C40\nG01 C20 F500", head=HEAD.replace("G53", "G60 X Y Z C\nG53")),
    "G53": _E("G53\nG01 X20 F500"),
    "G54": _E("G54\nG01 X20 F500"),
    "G55": _E("G55\nG01 X20 F500"),
    "G56": _E("G56\nG01 X20 F500"),
    "G57": _E("G57\nG01 X20 F500"),
    "G58": _E("G58\nG01 X20 F500"),
    "G60": _E("G01 X20 F500", head=HEAD.replace("G53", "G60 X Y\nG53")),
    "G70": _E("G70\nG01 X1 F20"),
    "G71": _E("G71\nG01 X20 F500"),
    "G74": _E("G74\nG01 X20 F500"),
    "G90": _E("G90\nG01 X20 F500"),
    "G91": _E("G91\nG01 X20 F500"),
    "G92": _E("G92 X10\nG01 X20 F500"),
    "G93": _E("G93\nG01 X20 F2"),
    "G94": _E("G94\nG01 X20 F500"),
    "G96": _E("G96\nG01 X20 F500"),
    "G97": _E("G97\nG01 X20 F500"),
    "G98": _E("G98 X-50\nG01 X20 F500"),
    "G99": _E("G99 X50\nG01 X20 F500"),
    "G150": _E("G150\nG01 X20 F500"),
    "G151": _E("G151\nG01 X20 F500\nG01 X30 Y20\nG150"),
    "G153": _E("G92 X10\nG153\nCD600 := CD50\nG01 X(CD600) F500"),
    "G154": _E("G92 X10\nG153\nG92 X20\nG154\nG01 X20 F500"),
    "G161": _E("G161\nG01 X30 F500\nG03 X40 Y20 I30 J20"),
    "G162": _E(f"G162\n{_ROUND}"),
    "M00": _E("M00"),
    "M01": _E("M01"),
    "M02": _E("M02"),
    "M03": _E("S1000\nM03"),
    "M04": _E("S1000\nM04"),
    "M05": _E("M05"),
    "M06": _E("M06"),
    "M08": _E("M08"),
    "M09": _E("M09"),
    "M17": _E("M98 L7", after=_LIFT),
    "M26": _E("M26 102"),
    "M27": _E("M27 100"),
    "M30": _E(""),
    "M80": _E("M80 X 4"),
    "M96": _E("M96 L5\nG00 X20\nL5"),
    "M98": _E("M98 L7", after=_LIFT),
    "M100": _E("M100"),
    "M150": _E("M150"),
    "M901": _E("CI600 := 3\nM901 600"),
    "M902": _E("CI600 := 3\nM901 600\nM902 600\nG01 X(CI600) F500"),
    "M903": _E("CD600 := 3.5\nM903 600"),
    "M904": _E("CD600 := 3.5\nM903 600\nM904 600\nG01 X(CD600) F500"),
    "M910": _E("M910"),
    "M911": _E("M911"),
    "G200": _E("G200"),
    "M200": _E("M200"),
    "G59": _E("G59"),
    "N": _E("N0100 G01 X20 F500"),
    "L": _E("L5"),
    "O": _E("M98 L7 O3", after=_LIFT),
    "I": _E(_ROUND),
    "J": _E(_ROUND),
    "F": _E("G01 X20 F500"),
    "S": _E("S1000"),
    "T": _E("T1"),
    "D": _E("D1"),
    "%": _E("M98 L7", after=_LIFT),
    "()": _E("G01 X20 F500 (towards the edge)"),
    "'": _E("G01 X20 F500 ' towards the edge"),
    "(())": _E("G01 X20 F500 (towards (the) edge)"),
    "//": _E("$wt(100); // settles"),
    "{}": _E("$wt(100); { settles }"),
    "$if": _E("CI600 := 1\n$if (CI600 < 2) then begin\nG01 X20 F500\n$end"),
    "$end else": _E("CI600 := 1\n$if (CI600 < 2) then begin\nG01 X20 F500\n$end else begin\nG01 X30 F500\n$end"),
    "$end else if": _E(
        "CI600 := 1\n$if (CI600 < 1) then begin\nG01 X20 F500\n$end else if (CI600 < 2) begin\nG01 X30 F500\n$end"
    ),
    "$while": _E("CI600 := 0\n$while (CI600 < 3) do begin\nCI600 := CI600 + 1\n$end;"),
    "$repeat": _E("CI600 := 0\n$repeat begin\nCI600 := CI600 + 1\n$end until (CI600 > 3);"),
    "$for to": _E("$for CI600 := 1 to 3 do begin\nG01 X(10 * CI600) F500\n$end;"),
    "$for downto": _E("$for CI600 := 3 downto 1 do begin\nG01 X(10 * CI600) F500\n$end;"),
    "$I": _E("", after="$I LIFT.SRC\n", files={"LIFT.SRC": _LIFT}),
    "$DINEND": _E("$DINEND\nCI600 := 3;\n{$DINSTART}\nG01 X(CI600) F500"),
    "{$DINSTART}": _E("$DINEND\nCI600 := 3;\n{$DINSTART}\nG01 X(CI600) F500"),
    "$": _E("$CI600 := 3;\nG01 X(CI600) F500"),
    "var": _E("depth := 2.5\nG01 Z(depth) F500", before=_DECLARED),
    "const": _E("G01 Z(depth) F500", before="$DINEND\nconst\n  depth = 2.5;\n{$DINSTART}\n"),
    "label": _E("G01 X20 F500", before="$DINEND\nlabel\n  again;\n{$DINSTART}\n"),
    "procedure": _E(
        "$deeper(2);\nG01 Z(depth) F500",
        before="$DINEND\nvar\n  depth : double;\nprocedure deeper(by : integer);\nbegin\n  depth := 0 - by;\nend;\n"
        "{$DINSTART}\n",
    ),
    ":=": _E("CD600 := 2.5\nG01 X(CD600) F500"),
    "WRITE": _E('WRITE "at work"'),
    "WRITELN": _E('CI600 := 3\nWRITELN "parts: " CI600'),
    "wt": _E("$wt(500);"),
    "sin": _E("G01 X(20 + 5 * sin(0.5)) F500"),
    "BOOLEAN": _E("CI600 := 1\n$if BOOLEAN (CI600) then begin\nG01 X20 F500\n$end"),
    "+": _E("CD600 := 2 + 3\nG01 X(CD600) F500"),
    "-": _E("CD600 := 2 - 3\nG01 X(-CD600) F500"),
    "*": _E("CD600 := 2 * 3\nG01 X2*CD600 F500"),
    "/": _E("CD600 := 7 / 2\nG01 X(CD600) F500"),
    "<": _E("CI600 := 1\n$if (CI600 < 2) then begin\nG01 X20 F500\n$end"),
    "CD<n>": _E("CD620 := 2.5\nG01 X(CD620) F500"),
    "CI<n>": _E("CI620 := 3\nG01 X(CI620) F500"),
    "CD0": _E("G01 X(CD0) F500"),
    "CI2": _E("G01 X(CI2) F500"),
    "CI10": _E("G01 X(CI10) F500"),
    "CI30": _E("G01 X(CI30) F500"),
    "CI48": _E("G01 X(CI48) F500"),
    "CI59": _E("G01 X(CI59) F500"),
    "CI67": _E("G01 X(CI67) F500"),
    "CD50": _E("G153\nG01 X(CD50) F500"),
    "CD60": _E("G01 X(CD60) F500"),
    ".tp": _E("G01 X(X.tp + 5) F500"),
    ".rp": _E("G01 X(X.rp + 5) F500"),
    ".digib": _E("$if (X.digib.5) then begin\nG01 X20 F500\n$end"),
    ".zerooffset": _E("$CD600 := X.ZEROOFFSET;\nG01 X(CD600) F500"),
    "IPOLMODE": _E("$IPOLMODE := 3;\nG01 X20 F500"),
    "SwitchOffChecks": _E("$SwitchOffChecks := 1;\nG01 X20 F500"),
    "MyTaskNr": _E("$CI600 := MyTaskNr;\nG01 X(CI600) F500"),
    "AXSEL": _E("$CI600 := AXSEL;\nG01 X(CI600) F500"),
    "NUMPARAMS": _E("$CI600 := NUMPARAMS;\nG01 X(CI600) F500"),
}

OPEN: dict[str, tuple[tuple[str, Example], ...]] = {
    "G41": (("sharp corners, inside corners without room", _E("T1\nG41\nG01 X40 Y20 F500\nG01 X60\nG01 X40")),),
    "G42": (("sharp corners, inside corners without room", _E("T1\nG42\nG01 X40 Y20 F500\nG01 X60\nG01 X40")),),
    "G01": (("words after G91 without a code", _E("G01 X20 F500\nG91\nX10")),),
    "G18": (("I in place of K", _E("G18\nG01 X30 F500\nG03 X40 Z15 I10 J0")),),
    "G22": (("again after G24 with factors set before", _E("G22\nG39 X2\nG24\nG22\nG01 X20 F500")),),
    "G53": (("after G91", _E("G91\nG53\nG01 X20 F500")),),
    "G200": (("not in `[din.task0]`", _E("G201\nG01 X20 F500")),),
    "M200": (("not in `[din.task0]`", _E("M201\nG01 X20 F500")),),
    "M902": (("what an earlier job has kept", _E("M902 601\nG01 X(CI601) F500")),),
    "M904": (("what an earlier job has kept", _E("M904 601\nG01 X(CD601) F500")),),
}
"""Uses of something supported of which the manual leaves open what they do."""
