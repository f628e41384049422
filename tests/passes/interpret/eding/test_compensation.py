"""Cutter radius compensation against the manual's figures, and against geometry that the module does not share.

Eding CNC manual 4.01: 3.4.11, chapter 5.
"""

from __future__ import annotations

import dataclasses
import itertools
import math
import random
from pathlib import Path

import numpy as np
import pytest
from passes.interpret.eding.compensated_jobs import HEAD, MILL, Move, Point, Stretch, contour, moves, run
from support.campaigns import seeds

from gproof.ir.machine import Spindle
from gproof.ir.setup import NOTHING
from gproof.ir.trace import Op

Expected = list[tuple[str, float, float]]

# Table A-1, figure A-2: the edge of the material, a cutter of diameter 1 left of it. The entry: a right triangle with
# the hypotenuse from (1, 5) to (1, 4), so 60 degrees at (1, 4).
EDGE = """
G1 X1 Y5
G41 D2 G1 Y4
G3 X2 Y3 I1
G2 X3 Y2 J-1
G1 Y-1
G2 X2 Y-2 I-1
G1 X-2
G2 X-2.6 Y-0.2 J1
G1 X1.4 Y2.8
G2 X2 Y3 I0.6 J-0.8
G40
M2
"""
EDGE_PATH: Expected = [
    ("feed", 1, 5), ("feed", 1 + math.sqrt(3) / 4, 4.25), ("cw", 1.5, 4), ("ccw", 2, 3.5), ("cw", 3.5, 2),
    ("feed", 3.5, -1), ("cw", 2, -2.5), ("feed", -2, -2.5), ("cw", -2.9, 0.2), ("feed", 1.1, 3.2), ("cw", 2, 3.5),
]  # fmt: skip
EDGE_CENTERS = [(1, 4), (2, 4), (2, 2), (2, -1), (-2, -1), (2, 2)]

# Table A-2, figure A-4: the path of the nominal tool, and one that is smaller by 0.4: right of it although G41.
NOMINAL = """
G1 X1.5 Y5
G41 D3 G1 Y4
G3 X2 Y3.5 I0.5
G2 X3.5 Y2 J-1.5
G1 Y-1
G2 X2 Y-2.5 I-1.5
G1 X-2
G2 X-2.9 Y0.2 J1.5
G1 X1.1 Y3.2
G2 X2 Y3.5 I0.9 J-1.2
G40
M2
"""
NOMINAL_PATH: Expected = [
    ("feed", 1.5, 5), ("feed", 1.5 - 0.2 * math.sqrt(0.96), 4.04), ("ccw", 1.3, 4), ("ccw", 2, 3.3), ("cw", 3.3, 2),
    ("feed", 3.3, -1), ("cw", 2, -2.3), ("feed", -2, -2.3), ("cw", -2.78, 0.04), ("feed", 1.22, 3.04), ("cw", 2, 3.3),
]  # fmt: skip
NOMINAL_CENTERS = [(1.5, 4), (2, 4), (2, 2), (2, -1), (-2, -1), (2, 2)]


def kind(move: Move) -> str:
    if move.op is not Op.ARC:
        return move.op.name.lower()
    return "ccw" if move.turns > 0 else "cw"


@pytest.mark.parametrize(
    ("text", "path", "centers"),
    [(EDGE, EDGE_PATH, EDGE_CENTERS), (NOMINAL, NOMINAL_PATH, NOMINAL_CENTERS)],
    ids=["table A-1", "table A-2"],
)
def test_the_manuals_programs(text: str, path: Expected, centers: list[Point], tmp_path: Path) -> None:
    trace, told, _ = run(tmp_path, HEAD + text)
    assert told == []
    got = moves(trace)
    assert [kind(m) for m in got] == [p[0] for p in path]
    assert np.allclose([m.end for m in got], [p[1:] for p in path], atol=1e-12)
    assert np.allclose([m.center for m in got if m.center], centers, atol=1e-12)


def test_rows_keep_their_programmed_origin(tmp_path: Path) -> None:
    """Every row names its line and the programmed point it belongs to; an inserted arc the corner itself."""
    trace, _, _ = run(tmp_path, HEAD + EDGE)
    got = [m for m in moves(trace) if m.compensation]
    assert {m.compensation for m in got} == {1}
    assert [m.line for m in got] == [4, 5, 5, 6, 7, 8, 9, 10, 11, 12]
    corners = [(1, 4), (1, 4), (2, 3), (3, 2), (3, -1), (2, -2), (-2, -2), (-2.6, -0.2), (1.4, 2.8), (2, 3)]
    assert np.allclose([m.programmed for m in got], corners, atol=1e-12)
    assert np.allclose([math.dist(m.end, m.programmed) for m in got], 0.5)


def program(stretches: list[Stretch], side: int, *, incremental: bool = False, tool: str = "D1") -> str:
    """A contour in G90 or in G91, and a first move from behind its start, where the tool is not (5.2)."""
    first = stretches[0]
    u = [(b - a) / math.dist(first.begin, first.end) for a, b in zip(first.begin, first.end, strict=True)]
    x = first.begin[0] - 20 * u[0] + 12 * side * u[1]
    y = first.begin[1] - 20 * u[1] - 12 * side * u[0]
    text = f"{HEAD}G0 X{x:.9f} Y{y:.9f}\nG4{1 if side > 0 else 2} {tool}\n"
    text += f"G1 X{stretches[0].begin[0]:.9f} Y{stretches[0].begin[1]:.9f}\n"
    if incremental:
        text += "G91\n"
    for stretch in stretches:
        text += stretch.text(stretch.begin if incremental else None)
    return text + "G90 G40\nM2\n"


def behind_entry(path: list[Move], first: int) -> list[Move]:
    """The rows of the contour itself; first: its first line."""
    return [m for m in path if m.line >= first and m.compensation]


def check_contour(path: list[Move], stretches: list[Stretch], side: int, radius: float) -> None:
    """Every point of the path touches the contour from its side: as far away as the radius, from nearest part."""
    assert path
    for move in path:
        for point in move.points():
            near = [s.distance(point) for s in stretches]
            distance = min(d for d, _ in near)
            assert abs(distance - radius) < 1e-6, (move, point, distance)
            touched = [left for d, left in near if d - distance < 1e-7 and left]
            assert all(left * side > 0 for left in touched), (move, point)
    for one, other in itertools.pairwise(path):
        assert one.end == other.begin


@pytest.mark.parametrize("side", [1, -1], ids=["left", "right"])
@pytest.mark.parametrize("sharp", [False, True], ids=["rounded", "sharp"])
@pytest.mark.parametrize("seed", seeds(16, 40))
def test_the_tool_touches_random_contours_all_along(seed: int, side: int, sharp: bool, tmp_path: Path) -> None:
    stretches = contour(random.Random(seed), side, 3.0, sharp)
    text = program(stretches, side)
    trace, told, _ = run(tmp_path, text)
    assert told == [], text
    path = behind_entry(moves(trace), 5)
    check_contour(path, stretches, side, 3.0)
    # Nothing left out: where it begins and ends, it touches the ends of the contour.
    assert abs(math.dist(path[-1].end, stretches[-1].end) - 3.0) < 1e-9
    assert abs(math.dist(path[0].begin, stretches[0].begin) - 3.0) < 1e-9


@pytest.mark.parametrize("seed", seeds(8, 20))
def test_incremental_and_absolute_programs_agree(seed: int, tmp_path: Path) -> None:
    """G91 counts from the programmed point, not from the tool."""
    side = 1 if seed % 2 else -1
    stretches = contour(random.Random(1000 + seed), side, 3.0, sharp=seed % 3 == 0)
    one, _, _ = run(tmp_path, program(stretches, side))
    other, _, _ = run(tmp_path, program(stretches, side, incremental=True))
    first, second = moves(one), moves(other)
    assert len(first) == len(second)
    assert np.allclose([m.end for m in first], [m.end for m in second], atol=1e-7)


@pytest.mark.parametrize("seed", seeds(8, 20))
def test_the_mirrored_contour_has_the_mirrored_path(seed: int, tmp_path: Path) -> None:
    side = 1 if seed % 2 else -1
    stretches = contour(random.Random(2000 + seed), side, 3.0, sharp=seed % 3 == 0)
    one, _, _ = run(tmp_path, program(stretches, side))
    other, _, _ = run(tmp_path, program([s.mirrored() for s in stretches], -side))
    first, second = moves(one), moves(other)
    assert [m.turns for m in first] == [-m.turns for m in second]
    assert np.allclose([m.end for m in first], [(-m.end[0], m.end[1]) for m in second], atol=1e-8)


@pytest.mark.parametrize("seed", seeds(8, 20))
def test_the_way_back_on_the_other_side_is_the_same_way(seed: int, tmp_path: Path) -> None:
    side = 1 if seed % 2 else -1
    stretches = contour(random.Random(3000 + seed), side, 3.0, sharp=False)
    back = [s.reversed() for s in reversed(stretches)]
    end = back[0].begin
    one, _, _ = run(tmp_path, program(stretches, side))
    other, _, _ = run(tmp_path, program(back, -side))
    there = [m for m in behind_entry(moves(one), 5) if math.dist(m.programmed, stretches[0].begin) > 1e-6]
    again = [m for m in behind_entry(moves(other), 5) if math.dist(m.programmed, end) > 1e-6]
    assert [m.turns for m in there] == [-m.turns for m in reversed(again)]
    assert np.allclose([m.end for m in there], [m.begin for m in reversed(again)], atol=1e-7)


def test_radius_zero_is_the_programmed_path(tmp_path: Path) -> None:
    """3.4.11: D0; and a tool whose diameter is 0 (5.3). Neither corners nor arcs nor nearness are errors then."""
    text = "G0 X0 Y0\n{}\nG1 X0.1\nG1 X10\nG1 Y10\nG2 X12 Y12 R2\nG3 X12 Y12 I1\nG0 Y0 Z3\nG91 G1 X1\nG90 G40\nM2\n"
    plain, _, _ = run(tmp_path, HEAD + text.format("G40"))
    for code in ("G41 D0", "G42 D0", "G41 D5", "G42.1 D0"):
        trace, told, _ = run(tmp_path, HEAD + text.format(code))
        assert told == []
        assert [(m.op, m.to, m.center, m.turns) for m in moves(trace)] == [
            (m.op, m.to, m.center, m.turns) for m in moves(plain)
        ]


def test_a_full_circle_within_a_contour(tmp_path: Path) -> None:
    """An entry tangent to the circle: around it once, and back to where it began."""
    for side, sense, radius in ((1, "G3", 7.0), (-1, "G3", 13.0), (1, "G2", 13.0), (-1, "G2", 7.0)):
        text = f"G0 X-20 Y-10\nG4{1 if side > 0 else 2} D1\nG1 X-10\nG1 X0\n"
        text += f"{sense} X0 Y-10 J{10 if sense == 'G3' else -10}\nG1 X20\nG40\nM2\n"
        trace, told, _ = run(tmp_path, HEAD + text)
        assert told == []
        circle = next(m for m in moves(trace) if m.line == 6 and abs(m.sweep()) > 6)
        assert math.isclose(abs(circle.sweep()), 2 * math.pi, abs_tol=1e-9)
        assert circle.center is not None
        assert math.isclose(math.dist(circle.begin, circle.center), radius, abs_tol=1e-9)
        assert math.dist(circle.begin, circle.end) < 1e-9


@pytest.mark.parametrize("tilt", [-1e-11, 1e-11, -0.009, -0.004, -1e-9, 0.0, 1e-9, 0.004, 0.009])
@pytest.mark.parametrize("side", [1, -1])
def test_a_circle_after_a_bend_within_the_tolerance_is_one_circle(tilt: float, side: int, tmp_path: Path) -> None:
    """A tool slightly ahead of or behind the start of the circle goes around once, never twice and never nearly not."""
    text = f"G0 X-60 Y{-20 * math.tan(tilt) - 3 * side:.9f}\nG4{1 if side > 0 else 2} D1\n"
    text += f"G1 X-20 Y{-20 * math.tan(tilt):.9f}\nG1 X0 Y0\nG3 X0 Y0 J40\nG40\nM2\n"
    trace, told, _ = run(tmp_path, HEAD + text)
    assert told == []
    arcs = [m for m in moves(trace) if m.line == 6]
    assert abs(sum(m.sweep() for m in arcs if m.turns > 0) - 2 * math.pi) < 0.02
    assert all(abs(m.sweep()) < 0.02 for m in arcs[:-1])
    if abs(tilt) < 1e-10:
        assert arcs[-1].begin == arcs[-1].end
        assert arcs[-1].turns == 1


def test_heights_and_rotary_axes_go_along(tmp_path: Path) -> None:
    """5.1: Z and rotary motion may accompany any move; an inserted arc stays at its height."""
    text = "G0 X-10 Y0 Z5\nG41 D1\nG1 X0 Z4\nG1 X20 Z3 A10\nG1 Y-20 Z2 A20\nG2 X-10 Y-50 R30 Z1\nG1 Z0\nG40\nM2\n"
    trace, told, _ = run(tmp_path, HEAD + text)
    assert told == []
    got = moves(trace)
    assert [(kind(m), m.to[2], m.to[3]) for m in got[1:]] == [
        ("feed", 4, 0), ("cw", 4, 0), ("feed", 3, 10), ("cw", 3, 10), ("feed", 2, 20), ("cw", 1, 20), ("feed", 0, 20),
    ]  # fmt: skip
    assert got[-1].begin == got[-1].end
    # The centre of an arc is as high as its start (docs/trace.md).
    rows = trace.sections[0].rows
    arcs = np.flatnonzero(rows["op"] == Op.ARC)
    assert rows["center"][arcs][:, 2].tolist() == rows["to"][arcs - 1][:, 2].tolist()


def test_inverse_time_counts_the_whole_move(tmp_path: Path) -> None:
    """5.1: G93 is allowed; a move and the arc before it take the stated time together."""
    text = "G0 X-10 Y0\nG41 D1\nG93\nG1 X0 F2\nG1 X20 F2\nG1 Y-20 F2\nG40\nM2\n"
    trace, _, _ = run(tmp_path, HEAD + text)
    corner = [m for m in moves(trace) if m.line == 7]
    assert [kind(m) for m in corner] == ["cw", "feed"]
    assert np.allclose([m.feed for m in corner], 2 * (3 * math.pi / 2 + 20))


def test_the_radius_stays_until_the_contour_ends(tmp_path: Path) -> None:
    """5.4: a tool change within a contour changes no radius; the next contour has the new one."""
    text = "M6 T1\nG0 X-20 Y0\nG41\nG1 X0\nM6 T2\nG1 X20\nG40\nG0 X-20 Y0\nG41\nG1 X0\nG1 X20\nG40\nM2\n"
    trace, told, _ = run(tmp_path, HEAD + text)
    assert told == []
    ends = {m.line: m.end for m in moves(trace)}
    assert np.allclose([ends[7], ends[12]], [(20, 3), (20, 0.5)])


def test_behind_a_contour_the_program_is_where_the_tool_is(tmp_path: Path) -> None:
    """5.4: no exit move; axes left out, and G91, count from the tool behind G40."""
    text = "G0 X-20 Y0\nG41 D1\nG1 X0\nG1 X20\nG40\nG0 Z9\nG1 X30\nG91 Y1\nG90\nM2\n"
    trace, _, _ = run(tmp_path, HEAD + text)
    assert np.allclose([m.to[:3] for m in moves(trace)[-4:]], [(20, 3, 0), (20, 3, 9), (30, 3, 9), (30, 4, 9)])


def test_an_arc_to_begin_with(tmp_path: Path) -> None:
    """5.4, figure A-7: about the centre, through the programmed end, tangent to the tool at the start."""
    # Left, counter-clockwise, so inside: the tool runs on a circle of 10 - 3 about (0, 0).
    text = "G0 X7 Y0\nG41 D1\nG3 X0 Y10 I-7\nG40\nM2\n"
    trace, told, _ = run(tmp_path, HEAD + text)
    assert told == []
    entry = moves(trace)[-1]
    assert (entry.center, entry.turns) == ((0.0, 0.0), 1)
    assert np.allclose(entry.end, (0, 7))
    # Right, so outside; by its radius: the centre is 13 from the tool and 10 from the end.
    text = "G0 X13 Y0\nG42 D1\nG3 X0 Y10 R10\nG40\nM2\n"
    trace, told, _ = run(tmp_path, HEAD + text)
    assert told == []
    entry = moves(trace)[-1]
    assert entry.center is not None
    assert math.isclose(math.dist(entry.center, (13, 0)), 13)
    assert math.isclose(math.dist(entry.center, (0, 10)), 10)
    assert math.isclose(math.dist(entry.end, (0, 10)), 3)
    # The long way: the other centre with these distances, not (0, 0).
    trace, told, _ = run(tmp_path, HEAD + text.replace("R10", "R-10"))
    assert told == []
    long = moves(trace)[-1]
    assert long.center is not None
    assert entry.center == pytest.approx((0, 0), abs=1e-9)
    assert math.dist(long.center, (0, 0)) > 1
    assert math.isclose(math.dist(long.center, (13, 0)), 13)
    assert math.isclose(math.dist(long.center, (0, 10)), 10)
    assert abs(long.sweep()) > math.pi


def test_a_traverse_goes_around_corners_too(tmp_path: Path) -> None:
    """5.4: an arc is inserted at a convex corner, whatever moves; with the feed in force, if there is one."""
    text = "G21 G17 G90 G94 G54 G40\nG0 X-20 Y0\nG41 D1\nG0 X0\nG0 X20\nG0 Y-20\nG40\nM2\n"
    trace, told, _ = run(tmp_path, text)
    assert told == []
    got = moves(trace)
    assert [kind(m) for m in got] == ["traverse", "traverse", "cw", "traverse", "cw", "traverse"]
    assert all(math.isnan(m.feed) for m in got if m.op is Op.ARC)


# 5.4, by number; (13) and (17) are GP109 and GP110, (12) GP121. ON leads to (60, 20), the tool left of +X.
ON = "G0 X0 Y0\nG41 D1\nG1 X20 Y20\nG1 X60\n"
ERRORS = {
    "1 coordinate system": (ON + "G55\n", "GP246:6"),
    "1 the same system": (ON + "G54\n", "GP246:6"),
    "1 G92": (ON + "G92 Z0\n", "GP246:6"),
    "1 G92.1": (ON + "G92.1\n", "GP246:6"),
    "1 G92.2": (ON + "G92.2\n", "GP246:6"),
    "1 G92.3": (ON + "G92.3\n", "GP246:6"),
    "1 G10 of the active system": (ON + "G10 L2 P1 X1\n", "GP246:6"),
    "1 G10 L20 of the active system": (ON + "G10 L20 P1 X1\n", "GP246:6"),
    "1 tool offset in X": (ON + "G43.1 I1\n", "GP246:6"),
    "2 inches": (ON + "G20\n", "GP247:6"),
    "2 the same units": (ON + "G21\n", "GP247:6"),
    "3 probing": (ON + "G38.2 Z-5\n", "GP248:6"),
    "4 YZ": ("G19\nG41 D1\nG17\n", "GP249:3"),
    "5 the other side": (ON + "G42 D1\n", "GP250:6"),
    "5 again": (ON + "G41 D1\n", "GP250:6"),
    "5 again, diameter": (ON + "G41.1 D3\n", "GP250:6"),
    "6 G28": (ON + "G28\n", "GP251:6"),
    "6 G30 by way of a point": (ON + "G30 X100\n", "GP251:6"),
    "7 G53": (ON + "G53 G1 X10\n", "GP211:6"),
    "8 XZ": (ON + "G18\n", "GP252:6"),
    "9 YZ while on": (ON + "G19\n", "GP252:6"),
    "10 corner": (ON + "G1 Y50\n", "GP410:6"),
    "10 steep corner": (ON + "G1 X30 Y40\n", "GP410:6"),
    "10 hardly a corner": (ON + "G1 X160 Y21.1\n", "GP410:6"),
    "10 corner into an arc": (ON + "G2 X70 Y30 R10\n", "GP410:6"),
    "11 too near": ("G0 X0 Y0\nG41 D1\nG1 X3\n", "GP411:4"),
    "11 only down": ("G0 X0 Y0\nG41 D1\nG1 Z-3\n", "GP411:4"),
    "11 too near for an arc": ("G0 X0 Y0\nG41 D1\nG3 X2 R10\n", "GP411:4"),
    "12 D alone": ("D1\n", "GP121:2"),
    "12 D beside G40": (ON + "G40 D1\n", "GP121:6"),
    "13 two D": ("G41 D1 D2\n", "GP109:2"),
    "14 negative": ("G41 D-1\n", "GP253:2"),
    "15 too big": ("G41 D100\n", "GP254:2"),
    "broken D": ("G41 D1.5\n", "GP229:2"),
    "no diameter": ("G41.1\n", "GP108:2"),
    "16 arc equal to the tool": (ON + "G3 X63 Y23 R3\n", "GP412:6"),
    "16 arc smaller": (ON + "G3 X62 Y22 J2\n", "GP412:6"),
    "16 arc smaller at its start only": (ON + "G3 X63.001 Y22.9995 J2.9995\n", "GP412:6"),
    "16 first arc smaller": ("G0 X0 Y0\nG41 D1\nG3 X3.5 R2\n", "GP412:4"),
    "17 two codes": ("G41 G42 D1\n", "GP110:2"),
    "first arc off": ("G0 X0 Y0\nG41 D1\nG3 X20 Y0 I10\n", "GP413:4"),
    "first arc out of reach": ("G0 X0 Y0\nG41 D1\nG3 X50 R10\n", "GP413:4"),
    "arc off its circle": (ON + "G3 X70 Y30 J10.1\n", "GP401:6"),
    "cycle": (ON + "G81 X100 Y100 Z-5 R2\nG80\n", "GP238:6"),
    "diameter nobody stated": ("G0 X0 Y0\nG41 D4\nG1 X20\nG1 X30\nG2 X40 Y0 R5\n", "GP255:3"),
    "tool nobody stated": ("G0 X0 Y0\nG41 D9\nG1 X20\n", "GP255:3"),
}


@pytest.mark.parametrize("name", ERRORS)
def test_errors_of_the_manual(name: str, tmp_path: Path) -> None:
    """Exactly this error, on its line, and what follows causes no other."""
    text, expected = ERRORS[name]
    _, told, _ = run(tmp_path, HEAD + text + "G40\nG0 X200 Y200\nG1 X210\nM2\n")
    assert told == [expected]


def test_messages_say_how_much(tmp_path: Path) -> None:
    """Numbers worked out by hand: a corner of 45 degrees, 3 mm tool, 2 mm arc, 2.5 mm away."""
    for text, numbers in (
        (ON + "G1 X70 Y30\n", ("45.00", "3.000")),
        (ON + "G3 X62 Y22 J2\n", ("2.000", "3.000")),
        ("G0 X0 Y0\nG41 D1\nG1 X2.5\n", ("2.500", "3.000")),
        ("G0 X0 Y0\nG41 D1\nG3 X20 Y0 I10\n", ("10.000", "7.000")),
    ):
        _, _, findings = run(tmp_path, HEAD + text + "M2\n")
        message = next(f.message for f in findings.kept if f.code.label.startswith("GP41"))
        assert all(number in message for number in numbers), message


@pytest.mark.parametrize("text", ["G10 L2 P2 X1\n", "G17\n", "G43 H1\n", "G49\n", "G4 P1\n", "M8\n", "G61\n", "G91\n"])
def test_what_is_allowed_within_a_contour(text: str, tmp_path: Path) -> None:
    assert MILL.tool(1) is not None
    _, told, _ = run(tmp_path, HEAD + ON + text + "G90 G1 X80\nG40\nM2\n")
    assert told == []


# -- what nobody stated


def test_unknown_offsets_do_not_matter(tmp_path: Path) -> None:
    """The path rests on differences: with unknown offsets it is the same, plus these."""
    known, _, _ = run(tmp_path, HEAD + EDGE)
    trace, told, _ = run(tmp_path, HEAD + EDGE.replace("X1 Y5", "X1 Y5 Z0"), NOTHING)
    assert told == []
    assert np.allclose([m.end for m in moves(trace)], [m.end for m in moves(known)])
    frames = {trace.frames[int(f)][:2] for s in trace.sections for f in s.rows["frame"][s.rows["op"] < Op.DWELL]}
    assert frames == {((("g92.x", 1), ("work.1.x", 1)), (("g92.y", 1), ("work.1.y", 1)))}


def test_a_first_move_from_an_unknown_place_is_unknown_the_contour_behind_is_not(tmp_path: Path) -> None:
    """5.4: where the first move ends depends on where it comes from; the second ends beside its own end."""
    trace, told, _ = run(tmp_path, HEAD + "G41 D1\nG1 X0 Y0\nG1 X20\nG1 Y-20\nG40\nM2\n", NOTHING)
    assert told == ["GP256:3"]
    rows = trace.sections[0].rows
    moved = np.flatnonzero(rows["op"] < Op.DWELL)
    unknown = [trace.frames[int(f)][0] == (("?", 1),) for f in rows["frame"][moved]]
    assert unknown == [True, False, False, False]
    assert np.allclose([m.end for m in moves(trace)][1:], [(20, 3), (23, 0), (23, -20)])


@pytest.mark.parametrize("code", ["G41 D4", "G42 D9", "G41 D#500", "G41.1 D#500", "G41"])
def test_an_unknown_radius_makes_the_whole_contour_unknown(code: str, tmp_path: Path) -> None:
    """Also what stands behind G40, until both axes are given again."""
    text = f"G0 X0 Y0 Z0\n{code}\nG1 X10\nG3 X20 Y10 R10\nG1 Z-1\nG2 X30 Y20 I10\nG40\nG1 X50\nG1 Y50\nM2\n"
    trace, told, _ = run(tmp_path, HEAD + text, NOTHING)
    assert told == ["GP255:3"]
    rows = trace.sections[0].rows
    moved = np.flatnonzero(rows["op"] < Op.DWELL)
    frames = [trace.frames[int(f)] for f in rows["frame"][moved]]
    assert [f[0] == (("?", 1),) for f in frames] == [False, True, True, True, True, False, False]
    assert [f[1] == (("?", 1),) for f in frames] == [False, True, True, True, True, True, False]
    assert not any(f[2] == (("?", 1),) for f in frames)


def test_a_diameter_that_the_program_writes_counts(tmp_path: Path) -> None:
    """3.4.12: #5501 ... are the diameters of the tools; a contour that is under way keeps its radius."""
    text = "G0 X-20 Y0\n#5501 = 4\nG41 D1\nG1 X0\n#5501 = 10\nG1 X20\nG40\nM2\n"
    trace, told, _ = run(tmp_path, HEAD + text)
    assert told == []
    assert np.allclose(moves(trace)[-1].end, (20, 2))


def test_no_tool_in_the_spindle_is_a_warning(tmp_path: Path) -> None:
    _, told, findings = run(tmp_path, HEAD + "G0 X0 Y0\nG41\nG1 X10\nG40\nM2\n")
    assert told == []
    assert "GP258" in [f.code.label for f in findings.kept]


def test_a_line_that_is_refused_is_passed_over(tmp_path: Path) -> None:
    """Nobody knows where the contour goes on; the next lines say nothing more. Behind G40 places are known again."""
    text = ON + "G1 X80 P5\nG91 G1 X20\nG90\nG1 Y0\nG40\nG1 X103 Y0\nM2\n"
    trace, told, _ = run(tmp_path, HEAD + text)
    assert told == ["GP121:6"]
    assert np.allclose(moves(trace)[-1].end, (103, 0))
    assert trace.frames[int(trace.sections[-1].rows["frame"][-1])][:2] == ((), ())


def test_inches(tmp_path: Path) -> None:
    """D of G41.1 is in program units, a diameter of the table in mm."""
    text = "G20 F20\nG0 X-2 Y0\n{}\nG1 X0\nG1 X1\nG40\nM2\n"
    for code, radius in (("G41.1 D0.5", 6.35), ("G41 D1", 3.0)):
        trace, told, _ = run(tmp_path, "G21 G17 G90 G94 G54 G40\n" + text.format(code))
        assert told == []
        assert np.allclose(moves(trace)[-1].end, (25.4, radius))


def test_a_branch_keeps_its_contour(tmp_path: Path) -> None:
    """Both outcomes of an unknown condition go on with the compensation they began with."""
    text = "G0 X-20 Y0 Z0\nG41 D1\nG1 X0\nif [#500 > 1]\nG1 X20\nG40\nelse\nG1 X30\nendif\nG1 Y-50\nG40\nM2\n"
    trace, told, _ = run(tmp_path, HEAD + text, NOTHING)
    assert not [code for code in told if not code.startswith("GP232")]
    ends = {(round(s.rows["to"][-1][0], 6), round(s.rows["to"][-1][1], 6)) for s in trace.sections if len(s.rows)}
    assert (20.0, -50.0) in ends
    assert (33.0, -50.0) in ends


def rough(rng: random.Random) -> list[Stretch]:
    """Lines and arcs of any direction and size, nothing smooth about them; whole circles among them."""
    at = (0.0, 0.0)
    out = []
    for _ in range(rng.randint(2, 8)):
        angle, size = rng.uniform(0, 2 * math.pi), rng.choice((0.001, 0.1, 2.0, 10.0, 50.0)) * rng.uniform(0.5, 2)
        end = (at[0] + size * math.cos(angle), at[1] + size * math.sin(angle))
        sense = rng.choice((0, 0, 1, -1))
        if not sense:
            out.append(Stretch(at, end))
        elif rng.random() < 0.2:
            out.append(Stretch(at, at, end, sense))
            continue
        else:
            bulge = rng.uniform(-3, 3) * size
            middle = ((at[0] + end[0]) / 2, (at[1] + end[1]) / 2)
            center = (middle[0] - bulge * math.sin(angle), middle[1] + bulge * math.cos(angle))
            out.append(Stretch(at, end, center, sense))
        at = end
    return out


@pytest.mark.parametrize("seed", seeds(80, 200))
def test_rough_contours_are_refused_or_followed(seed: int, tmp_path: Path) -> None:
    """What is not refused touches its own stretch or the corner before it all along; arcs keep their turns."""
    rng = random.Random(seed)
    side = rng.choice((1, -1))
    stretches = rough(rng)
    text = f"{HEAD}G0 X{rng.uniform(-50, 50):.6f} Y{rng.uniform(-50, 50):.6f}\nG4{1 if side > 0 else 2} D1\nG1 X0 Y0\n"
    text += "".join(s.text() for s in stretches) + "G40\nM2\n"
    trace, told, _ = run(tmp_path, text)
    assert all(code[:5] in ("GP410", "GP411", "GP412") for code in told), text
    refused = {int(code[6:]) for code in told}
    at = None
    for move in moves(trace):
        assert at is None or move.begin == at
        at = move.end
        number = move.line - 5
        if not 0 <= number < len(stretches) or refused & {move.line, move.line - 1}:
            continue
        own = stretches[number]
        if move.center and math.dist(move.center, own.begin) < 1e-6 and math.dist(move.programmed, own.begin) < 1e-6:
            assert all(abs(math.dist(point, own.begin) - 3.0) < 1e-6 for point in move.points())
            continue
        # A bend of up to 0.01 is passed without an arc: off by half its square, and by 0.001 on arcs.
        allowed = 3 * 0.5e-4 + (0.001 if own.sense else 0.0) + 1e-6
        assert all(abs(own.away(point) - 3.0) < allowed for point in move.points()), (text, move)
        if own.sense:
            meant = 2 * math.pi if own.begin == own.end else _swept(own)
            swept = abs(move.sweep()) if move.center else 0.0
            assert abs(swept - meant) * min(math.dist(move.end, own.center), 3.0) < 0.01 * 3.0 + 1e-6, (text, move)


def _swept(arc: Stretch) -> float:
    a = math.atan2(arc.begin[1] - arc.center[1], arc.begin[0] - arc.center[0])
    b = math.atan2(arc.end[1] - arc.center[1], arc.end[0] - arc.center[0])
    return (b - a) * arc.sense % (2 * math.pi)


def test_the_position_parameters_show_the_contour(tmp_path: Path) -> None:
    """X#5001 Y#5002 is no motion along the contour; behind G40 they show where the tool is."""
    text = "G0 X-20 Y0\nG41 D1\nG1 X0\nG1 X20\n#1=#5001 #2=#5002\nG40\nG0 X#1 Y#2\nG0 X#5001 Z#5002\nM2\n"
    trace, told, _ = run(tmp_path, HEAD + text)
    assert told == []
    assert np.allclose([m.to[:3] for m in moves(trace)[-2:]], [(20, 0, 0), (20, 0, 0)])


@pytest.mark.parametrize("line", ["home x", "G33 X30 K1", "G33 Z-5 K1", "G76 Z-5 P1 I-1 J1 K1"])
def test_motion_apart_from_the_contour_is_never_taken_for_a_part_of_it(line: str, tmp_path: Path) -> None:
    """Homing, threading, and whatever comes later: not known, never a row beside the contour that counts as known."""
    text = f"M3 S100\nG0 X-20 Y0\nG41 D1\nG1 X0\nG1 X20\n{line}\nG91 G1 X20\nG90\nG40\nM2\n"
    _, told, _ = run(tmp_path, HEAD + text)
    assert {"GP238", "GP256"} & {code.split(":")[0] for code in told}


@pytest.mark.parametrize("seed", seeds(8, 20))
def test_a_rotated_contour_has_the_rotated_path(seed: int, tmp_path: Path) -> None:
    """3.4.18: G68 turns what is programmed, the tool's path with it; also in G91 and with words left out."""
    rng = random.Random(4000 + seed)
    side, angle = rng.choice((1, -1)), rng.choice((90.0, 180.0, -90.0, rng.uniform(-180, 180)))
    stretches = contour(rng, side, 3.0, sharp=seed % 3 == 0)
    text = program(stretches, side, incremental=seed % 2 == 0).replace("G40\nM2", "X500\nG40\nM2")
    plain, before, _ = run(tmp_path, text)
    turned, told, _ = run(tmp_path, text.replace(HEAD, f"{HEAD}G68 X7 Y-4 R{angle:.9f}\n"))
    # The last line may be refused, but then in both.
    assert [code[:5] for code in told] == [code[:5] for code in before]
    first, second = moves(plain), moves(turned)
    assert [m.turns for m in first] == [m.turns for m in second]
    cos, sin = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    wanted = [
        (7 + (x - 7) * cos - (y + 4) * sin, -4 + (x - 7) * sin + (y + 4) * cos) for x, y in (m.end for m in first)
    ]
    assert np.allclose(wanted, [m.end for m in second], atol=1e-6)


def test_a_first_arc_with_an_unknown_radius_is_no_error(tmp_path: Path) -> None:
    """Whether R reaches depends on the radius of the tool."""
    _, told, _ = run(tmp_path, HEAD + "G0 X0 Y0\nG42 D4\nG3 X20.5 Y0 R10\nG40\nM2\n")
    assert told == ["GP255:3"]


def test_another_head_can_not_follow_the_contour(tmp_path: Path) -> None:
    """3.5.6: its offset is added to every position, and (5.4: 1) none may change."""
    on = dataclasses.replace(MILL, spindles=(Spindle(number=1, offset=(40.0, 0.0, 0.0)),))
    _, told, _ = run(tmp_path, HEAD + ON + "M91\nG40\nM2\n", on=on)
    assert "GP246:6" in told


@pytest.mark.parametrize(("bend", "codes"), [(-0.008, []), (0.008, ["GP410:7"])])
def test_a_bend_into_an_arc_hardly_larger_than_the_tool(bend: float, codes: list[str], tmp_path: Path) -> None:
    """Within 0.01, but the arc of the tool's centre (radius 0.005) would be missed by 0.02: a corner after all."""
    start = (-10 * math.cos(bend), 10 * math.sin(bend))
    text = f"G0 X{3 * start[0]:.9f} Y{3 * start[1] - 3:.9f}\nG41 D1\nG1 X{start[0]:.9f} Y{start[1]:.9f}\nG1 X0 Y0\n"
    text += "G4 P1\nG3 X3.005 Y3.005 J3.005\nG40\nM2\n"
    trace, told, _ = run(tmp_path, HEAD + text)
    assert told == codes
    inner = [m for m in moves(trace) if m.line == 7][-1]
    assert inner.center is not None
    assert math.isclose(math.dist(inner.begin, inner.center), 0.005, abs_tol=1e-6)


def test_an_arc_that_the_tool_has_passed_already_is_no_circle(tmp_path: Path) -> None:
    """A bend of 0.009 towards the tool puts it 0.027 ahead; the arc is 0.017 long: a step back, never a turn around."""
    turn, swept = 0.009, 0.001
    center = (-20 * math.sin(turn), 20 * math.cos(turn))
    end = (center[0] + 20 * math.sin(turn + swept), center[1] - 20 * math.cos(turn + swept))
    text = f"G0 X-50 Y-3\nG41 D1\nG1 X-20 Y0\nG1 X0\nG3 X{end[0]:.9f} Y{end[1]:.9f} "
    text += f"I{center[0]:.9f} J{center[1]:.9f}\nG40\nM2\n"
    trace, told, _ = run(tmp_path, HEAD + text)
    assert told == []
    (last,) = [m for m in moves(trace) if m.line == 6]
    assert max(math.dist(p, last.begin) for p in last.points()) < 0.02
    assert math.isclose(math.dist(last.end, end), 3.0, abs_tol=1e-6)


def test_a_traverse_under_inverse_time_has_a_corner_of_unknown_feed(tmp_path: Path) -> None:
    """G0 has no F of its own: what an F before says is no time of this line."""
    text = "G0 X-20 Y0\nG41 D1\nG93\nG1 X0 F2\nG1 X20 F2\nG0 Y-20\nG40\nM2\n"
    trace, _, _ = run(tmp_path, HEAD + text)
    (corner,) = [m for m in moves(trace) if m.line == 7 and m.op is Op.ARC]
    assert math.isnan(corner.feed)


def test_a_plunge_does_not_bring_a_lost_tool_onto_the_contour(tmp_path: Path) -> None:
    """Behind a refused line, and behind an unknown first move: the next line in the plane decides, without an error."""
    _, told, _ = run(tmp_path, HEAD + ON + "G1 X80 P5\nG1 Z-1\nG1 Y0\nG1 X0\nG40\nM2\n")
    assert told == ["GP121:6"]
    trace, told, _ = run(tmp_path, HEAD + "G41 D1\nG1 X0 Y0\nG1 Z-1\nG1 X20\nG1 Y-20\nG40\nM2\n", NOTHING)
    assert told == ["GP256:3"]
    rows = trace.sections[0].rows
    unknown = [trace.frames[int(f)][0] == (("?", 1),) for f in rows["frame"][rows["op"] < Op.DWELL]]
    assert unknown == [True, True, False, False, False]


@pytest.mark.parametrize(("back", "codes"), [(-0.1, []), (0.0, []), (0.1, []), (1.0, ["GP410:6"])])
def test_a_way_back_beside_the_way_there(back: float, codes: list[str], tmp_path: Path) -> None:
    """Around the end of a line; also by a little more than half a circle, within the 0.01 of a bend that is none."""
    text = f"G0 X-20 Y-10\nG41 D1\nG1 X0 Y0\nG1 X50\nG1 X0 Y{back}\nG40\nM2\n"
    trace, told, _ = run(tmp_path, HEAD + text)
    assert told == codes
    around = [m for m in moves(trace) if m.line == 6 and m.op is Op.ARC]
    assert len(around) == (0 if codes else 1)
    assert all(math.isclose(abs(m.sweep()), math.pi + math.atan2(back, 50), abs_tol=1e-9) for m in around)
