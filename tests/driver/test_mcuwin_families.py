"""Families of small McuWIN programs: what each states reaches the verdict, or makes it UNKNOWN.

The answers were worked out from the manual of V 2.5.3.133 (sections at each family) before anything ran. The machine
has X from -150 to 150, Y from -100 to 100, Z from -60 to 20, stands at 0, and has the zero offsets of ``RECORDS``.
Places are those of the ends of moves, in machine coordinates. ``|`` parts lines.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from support.command import in_this_process

RECORDS = ((-80, -50, 0), (20, -50, 0), (-80, 10, 0), (20, 10, 0), (0, 0, -5))
MACHINE = (
    'schema = "gproof-machine/1"\nunits = "mm"\nname = "small"\n'
    + "".join(
        f'[axes.{name}]\nmin = {low}.0\nmax = {high}.0\nposition_unit = "mm"\n'
        for name, low, high in (("x", -150, 150), ("y", -100, 100), ("z", -60, 20))
    )
    + '[din]\ncase_sensitive = false\nposition_unit = "mm"\ntime_unit = "min"\nabsolute_centers = false\n'
    + f'interpolation_axes = "XYZ"\nzero_offsets = {[list(map(float, row)) for row in RECORDS]}\n'
    + 'pre_include = ""\npost_include = ""\nshortest_path = false\ntool_file = ""\nerror_compensation = false\n'
    + '[din.task0]\nM0 = "stop"\nM3 = "spindle_cw"\nM4 = "spindle_ccw"\nM5 = "spindle_off"\nM8 = "coolant_on"\n'
    + 'M9 = "coolant_off"\nM213 = "spindle_ccw"\nM30 = "end"\nM2 = "end"\nS = "spindle_speed"\nT = "tool_select"\n'
)
SETUP = (
    'schema = "gproof-setup/1"\nhomed = ["x", "y", "z"]\nstart = {x = 0.0, y = 0.0, z = 0.0}\n'
    "g92 = {x = 0.0, y = 0.0, z = 0.0}\n"
)
Box = dict[str, tuple[float, float]]
SAFE, UNSAFE, UNKNOWN = "SAFE", "UNSAFE", "UNKNOWN"


def answer(body: str, folder: Path) -> tuple[str, Box, str]:
    """(verdict, ends of moves by axis, report) of a program."""
    (folder / "machine.toml").write_text(MACHINE)
    (folder / "setup.toml").write_text(SETUP)
    lines = [line.strip() for line in body.split("|")]
    (folder / "job.src").write_text("\n".join(["%JOB", "G90 G71 F200", *lines, "M30", "%", ""]))
    words = ["check", "job.src", "--machine", "machine.toml", "--setup", "setup.toml", "--format", "json"]
    done = in_this_process(words, folder)
    report = json.loads(done.out)
    box = {one["axis"]: (one["low"], one["high"]) for one in report["summary"]["box"] if not one["relative_to"]}
    return report["verdict"], box, done.out


def x(low: float, high: float | None = None) -> Box:
    return {"x": (low, low if high is None else high)}


# 3.18, 3.19, 3.26, 3.33, 3.34: a place is the offset in force plus the word.
OFFSETS = [
    *(
        (f"G5{4 + n} | G00 X6 Y6 Z6", SAFE, {a: (o + 6, o + 6) for a, o in zip("xyz", row, strict=True)})
        for n, row in enumerate(RECORDS)
    ),
    ("G92 X10 | G54 | G00 X0 Z1", SAFE, {"x": (-80, -80), "z": (1, 1)}),
    ("G92 X10 Y5 | G53 | G00 X1 Y1", SAFE, {"x": (1, 1), "y": (1, 1)}),
    ("G60 X Y | G92 Z5 | G53 | G00 Z1", SAFE, {"z": (6, 6)}),
    ("G60 X Y | G58 | G00 Z1 X1", SAFE, {"z": (1, 1), "x": (1, 1)}),
    ("G91 | G92 X10 | G92 X10 | G90 | G00 X0", SAFE, x(20)),
    ("G92 X10 | G92 X10 | G90 | G00 X0", SAFE, x(10)),
    ("G92 X10 | X20 | G00 X0", SAFE, x(20)),
    ("G92 X50 | G153 | G53 | G154 | G00 X1", SAFE, x(51)),
    ("G92 X50 | G153 | G53 | G00 X(CD50)", SAFE, x(50)),
    ("CD50 := 10 | CD51 := 0 | CD52 := 0 | G154 | G00 X1", SAFE, x(11)),
    ("CD50 := 10 | G154 | G00 Y1", UNKNOWN, {}),
    ("G92 X100 | G00 X60", UNSAFE, x(160)),
    ("G54 | G00 X240", UNSAFE, x(160)),
    ("G54 | G00 X230", SAFE, x(150)),
    ("G54 | G91 | G00 X10 | G90", SAFE, x(10)),
    ("G91 | G53 | G00 X5", UNKNOWN, {}),
    ("G55 G92 X5 | G00 X0", UNKNOWN, {}),
]
# 3.9 to 3.13: Y, X, both; the factor is that of reflected axes; with an offset about one of two zeros.
REFLECTIONS = [
    ("G00 Z1 | G21 | G00 X10 Y10", SAFE, {"x": (0, 10), "y": (-10, 0)}),
    ("G00 Z1 | G22 | G00 X10 Y10", SAFE, {"x": (-10, 0), "y": (0, 10)}),
    ("G00 Z1 | G23 | G00 X10 Y10", SAFE, {"x": (-10, 0), "y": (-10, 0)}),
    ("G23 | G24 | G00 X10 Y10", SAFE, {"x": (10, 10), "y": (10, 10)}),
    ("G22 | G21 | G00 X10 Y10 | G24", SAFE, {"x": (-10, -10), "y": (-10, -10)}),
    ("G22 | G39 X-3 | G00 X10 | G24", SAFE, x(-30)),
    ("G22 | G39 X-3 | G39 | G00 X10 | G24", SAFE, x(-10)),
    ("G39 X5 | G00 X10", SAFE, x(10)),
    ("G22 | G39 X20 | G00 X10 | G24", UNSAFE, x(200)),
    ("G22 | G39 X0 | G00 X10 | G24", UNSAFE, {}),
    ("G22 | G39 X-2 | G24 | G22 | G00 X10 | G24", UNKNOWN, {}),
    ("G22 | G91 | G00 X10 | G90 | G24", SAFE, x(-10)),
    ("G92 X20 | G22 | G00 X10 | G24", SAFE, x(-30, 10)),
    ("G92 X100 | G22 | G00 X60 | G24", UNKNOWN, {}),
    ("G92 X100 | G22 | G00 X-60 | G24", UNKNOWN, {}),
    ("G92 X100 | G22 | G00 X260 | G24", UNSAFE, {}),
    ("G21 G22 | G00 X10 | G24", UNKNOWN, {}),
]
# 3.3, 3.4, 3.35, 3.36: centres are distances, after G161 places in G90.
ARCS = [
    ("G02 X20 Y0 I10 J0", SAFE, {"x": (0, 20), "y": (0, 10)}),
    ("G03 X20 Y0 I10 J0", SAFE, {"x": (0, 20), "y": (-10, 0)}),
    ("G03 I10 J0", SAFE, {"x": (0, 20), "y": (-10, 10)}),
    ("G161 | G00 X10 | G02 X30 Y0 I20 J0", SAFE, {"x": (10, 30), "y": (0, 10)}),
    ("G161 | G00 X10 | G02 X30 Y0 I10 J0", UNSAFE, {}),
    ("G161 | G162 | G00 X10 | G02 X30 Y0 I10 J0", SAFE, {"x": (10, 30), "y": (0, 10)}),
    ("G161 | G00 X10 | G91 | G02 X20 Y0 I10 J0 | G90", SAFE, {"x": (10, 30), "y": (0, 10)}),
    ("G161 | G54 | G00 X10 Y0 | G02 X30 Y0 I20 J0", SAFE, {"x": (-70, -50), "y": (-50, -40)}),
    ("G02 X20 Y0 I10 K0", UNSAFE, {}),
    ("G02 X20 Y0 I9 J0", UNSAFE, {}),
    ("G02 X20 Y0", UNSAFE, {}),
    ("G00 Y95 | G02 X20 Y95 I10 J0", UNSAFE, {"x": (0, 20), "y": (95, 105)}),
    ("G18 | G02 X20 Z0 I10 K0", UNKNOWN, {}),
    ("G151 | G01 X10 | G150", UNKNOWN, {}),
]
# 3.29, 3.30, 13.1.1.7: limits that the program sets hold from then on, in machine coordinates.
LIMITS = [
    *(
        (f"{code} {axis}{limit} | G00 {axis}{to}", verdict, {})
        for axis in "XYZ"
        for code, limit, to, verdict in (
            ("G98", -8, -8, SAFE),
            ("G98", -8, -9, UNSAFE),
            ("G99", 8, 8, SAFE),
            ("G99", 8, 9, UNSAFE),
            ("G98", 1, 5, UNSAFE),
            ("G99", -1, -5, UNSAFE),
        )
    ),
    ("G98 X-10 | G99 X10 | G92 X100 | G00 X-95", SAFE, x(5)),
    ("G98 X-10 | G99 X10 | G92 X100 | G00 X5", UNSAFE, x(105)),
    ("G98 X-200 | G00 X-160", UNKNOWN, {}),
    ("G99 X10 | G99 X150 | G00 X100", SAFE, x(100)),
    ("G70 | G99 X10 | G00 X5", UNKNOWN, {}),
    ("G91 | G99 X10 | G90 | G00 X5", UNKNOWN, {}),
]
# 4.20, 11, 5.2, 14: below 600 the variables are the controller's, but the offsets of G153 and the error bits CI48.
VARIABLES = [
    *(
        (f"{name} := 5 | G00 X1", UNKNOWN, {})
        for name in (
            "CI0",
            "CI2",
            "CI10",
            "CI30",
            "CI47",
            "CI49",
            "CI59",
            "CI67",
            "CI599",
            "CD0",
            "CD49",
            "CD60",
            "CD67",
            "CD599",
        )
    ),
    *((f"{name} := 5 | G00 X1", SAFE, x(1)) for name in ("CI48", "CD50", "CD59", "CI600", "CD600", "CI699", "CD699")),
    ("CI600 := 5 | CI2 := CI600 | G00 X1", UNKNOWN, {}),
    ("$for CI5 := 1 to 3 do begin | G91 G00 X1 | $end", UNKNOWN, {}),
    ("G00 X(CI2)", UNKNOWN, {}),
    ("CI600 := 3 | M901 600 | CI600 := 9 | M902 600 | G00 X(CI600)", SAFE, x(3)),
    ("CD605 := 3.5 | M903 605 | CD605 := 9 | M904 605 | G00 X(CD605)", SAFE, x(3.5)),
    ("M902 600 | G00 X(CI600)", UNKNOWN, {}),
    ("M902 5 | G00 X1", UNSAFE, {}),
]
# 3.20, 10, 12: qualifiers of axes, and system variables, that a program writes: limits, velocities, places.
QUALIFIERS = [
    (f"${axis}.{name} := 5; | G00 X1 Y1", UNKNOWN, {})
    for axis in "XY" for name in ("jvl", "jac", "sll", "slr", "zerooffset", "tp", "rp", "digob", "mcp")
] + [("$IPOLMODE := 3; | G01 X1", UNKNOWN, {}), ("X.jvl := 5 | G00 X1", UNKNOWN, {})]  # fmt: skip
# 4.11, 4.12, 4.14: the first digit is the axis channel.
OUTPUTS = [
    *((f"{code} {axis}02 | G00 X1", SAFE if axis <= 3 else UNKNOWN, x(1)) for code in ("M26", "M27")
      for axis in range(1, 10)),
    ("M26 99 | G00 X1", UNSAFE, {}), ("M26 1000 | G00 X1", UNSAFE, {}), ("M26 | G00 X1", UNSAFE, {}),
    ("M80 X 4 | G00 X1", SAFE, x(1)), ("M80 C 4 | G00 X1", UNSAFE, {}), ("M80 X -1 | G00 X1", UNSAFE, {}),
]  # fmt: skip
# 3, 4: which of two codes of one kind counts, no section says.
PAIRS = [
    (f"{pair} | G00 X1", UNKNOWN, {})
    for pair in ("M03 M04", "M04 M03", "M03 M05", "M08 M09", "M03 M213", "M213 M05", "G90 G91", "G70 G71", "G17 G18",
                 "G54 G55", "G53 G54", "G161 G162", "G22 G23", "G150 G151", "G96 G97", "M00 M30")
] + [("M03 M08 | G00 X1", SAFE, x(1)), ("G90 G17 G40 G54 | G00 X1", SAFE, x(-79))]  # fmt: skip
# 3, 4, 13.1.1.1: codes of other controllers.
FOREIGN = [
    (f"{code} | G00 X1", UNSAFE, {})
    for code in ("G20", "G28", "G43", "G49", "G59", "G80", "G81", "G94.1", "G95", "G98.5", "G93", "M07", "M19", "M60",
                 "M99", "M7", "G61", "G64")
]  # fmt: skip
# 4.10, 4.15, 4.16, 7, 8, 11: what runs, how often.
FLOW = [
    ("M98 L5 O3 | G00 X20 | M02 | L5 | G91 | G00 X10 | M17", SAFE, x(10, 50)),
    ("M98 L5 O2 | M02 | L5 | G91 | G00 X80 | M17", UNSAFE, x(80, 160)),
    ("M96 L9 | G00 X200 | L9 | G00 X10", SAFE, x(10)),
    ("CI600 := 7 div 2 | G00 X(CI600)", SAFE, x(3)),
    ("CI600 := -7 div 2 | G00 X(CI600)", SAFE, x(-3)),
    ("CD600 := 7 / 2 | G00 X(CD600)", SAFE, x(3.5)),
    ("$for CI600 := 1 to 3 do begin | G91 G00 X10 | $end", SAFE, x(10, 30)),
    ("$for CI600 := 3 downto 1 do begin | G00 X(CI600 * 10) | $end", SAFE, x(10, 30)),
    ("$for CI600 := 3 to 1 do begin | G00 X500 | $end | G00 X1", SAFE, x(1)),
    ("CI600 := 0 | $repeat begin | CI600 := CI600 + 1 | $end until (CI600 > 3) | G00 X(CI600)", SAFE, x(4)),
    ("$if (X.digib.5) then begin | G00 X10 | $end else begin | G00 X20 | $end", SAFE, x(10, 20)),
    ("$if (X.digib.5) then begin | G00 X10 | $end else begin | G00 X200 | $end", UNSAFE, x(10, 200)),
    ("M30 | G00 X500", SAFE, {}),
    ("M02 | G00 X500", SAFE, {}),
    ("G04 5 | X10", UNSAFE, {}),
    ("G00 X10 | M08 | X20", SAFE, x(10, 20)),
    ("G00 X10 | G90 | X20", UNKNOWN, {}),
    ("G00 X(X.tp + 10) | X(X.tp + 10)", SAFE, x(10, 20)),
    ("G00 X(X.rp + 10)", UNKNOWN, {}),
]
# 3.1, 3.21, 5.3: G00 has the axes' own unit, and a feed of 0 stops the program.
FEEDS = [
    ("G70 | G00 X1", SAFE, x(1)),
    ("G70 F10 | G01 X1", SAFE, x(25.4)),
    ("G70 F10 | G01 X6", UNSAFE, x(152.4)),
    ("G70 | G01 X1", UNSAFE, {}),
    ("F-5 G01 X1", UNSAFE, {}),
    ("F0 | G01 X1", UNKNOWN, {}),
    ("F0 | G00 X1", SAFE, x(1)),
    ("G93 | G01 X1", UNSAFE, {}),
    ("G60 X Y | G01 Z5", UNSAFE, {}),
    ("G60 X Y | G00 Z5", SAFE, {"z": (5, 5)}),
    ("G01 A5", UNSAFE, {}),
    ("T1 | G41 | G01 X10", UNSAFE, {}),
    ("M100 | G00 X1", UNKNOWN, {}),
    ("G74 | G00 X1", UNKNOWN, {}),
    ("G210 | G00 X1", UNSAFE, {}),
]
FAMILIES = {
    "offsets": OFFSETS, "reflections": REFLECTIONS, "arcs": ARCS, "limits": LIMITS, "variables": VARIABLES,
    "qualifiers": QUALIFIERS, "outputs": OUTPUTS, "pairs": PAIRS, "foreign": FOREIGN, "flow": FLOW, "feeds": FEEDS,
}  # fmt: skip
PROGRAMS = [(family, *row) for family, rows in FAMILIES.items() for row in rows]


@pytest.mark.parametrize(
    ("body", "verdict", "box"), [row[1:] for row in PROGRAMS], ids=[f"{row[0]}: {row[1]}" for row in PROGRAMS]
)
def test_what_is_stated_reaches_the_verdict(body: str, verdict: str, box: Box, tmp_path: Path) -> None:
    found, ends, report = answer(body, tmp_path)
    assert found == verdict, report
    for axis, (low, high) in box.items():
        assert ends[axis] == pytest.approx((low, high), abs=1e-6), report
