"""Canned cycles against rows worked out by hand from the Eding CNC manual 3.4.21."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest
from passes.interpret.core.programs import HEAD, Row, codes_of, run_whole, shown

from gproof.ir.machine import NO_MACHINE, Controller, Spindle
from gproof.ir.setup import NOTHING
from gproof.ir.trace import Wait

AT = "G0 X1 Y2 Z3\n"


def rows(folder: Path, text: str, after: int) -> list[Row]:
    trace, findings = run_whole(folder, text)
    assert set(codes_of(findings)) <= {"GP265"}
    return shown(trace, after_line=after)


def test_first_example_of_the_manual(tmp_path: Path) -> None:
    """3.4.21.2: from 1 2 3, G90 G81 G98 X4 Y5 Z1.5 R2.8."""
    assert rows(tmp_path, HEAD + AT + "F100\nG90 G81 G98 X4 Y5 Z1.5 R2.8\nG80\n", 3) == [
        ("go", 4, 5, 3),
        ("go", 4, 5, 2.8),
        ("feed", 4, 5, 1.5, 100),
        ("go", 4, 5, 3),
    ]


def test_second_example_of_the_manual(tmp_path: Path) -> None:
    """3.4.21.2: from 1 2 3, G91 G81 G98 X4 Y5 Z-0.6 R1.8 L3."""
    expected: list[Row] = [("go", 1, 2, 4.8)]
    for x, y in ((5, 7), (9, 12), (13, 17)):
        expected += [("go", x, y, 4.8), ("feed", x, y, 4.2, 100), ("go", x, y, 4.8)]
    assert rows(tmp_path, HEAD + AT + "F100\nG91 G81 G98 X4 Y5 Z-0.6 R1.8 L3\nG80\n", 3) == expected


PLANES = {"G17": "XYZ", "G18": "XZY", "G19": "YZX"}


def turned(plane: str, expected: list[Row]) -> list[Row]:
    """Rows of the XY plane with their axes renamed: the cycle is analogous in every plane (3.4.21)."""
    place = ["XYZ".index(letter) for letter in PLANES[plane]]
    out: list[Row] = []
    for name, *numbers in expected:
        if name in ("go", "feed", "sync"):
            at = [0.0, 0.0, 0.0]
            for k in range(3):
                at[place[k]] = numbers[k]  # type: ignore[call-overload]
            out.append((name, *at, *numbers[3:]))
        else:
            out.append((name, *numbers))
    return out


def renamed(plane: str, line: str) -> str:
    """A line of the XY plane with its axis letters, and I J K, renamed."""
    letters = dict(zip("XYZ", PLANES[plane], strict=True))
    beside = dict(zip("IJK", ("IJK"["XYZ".index(letter)] for letter in PLANES[plane]), strict=True))
    return "".join((letters | beside).get(character, character) for character in line)


CYCLES: dict[str, tuple[str, list[Row]]] = {
    "G81": ("G81 X4 Y5 Z1 R2", [("go", 4, 5, 3), ("go", 4, 5, 2), ("feed", 4, 5, 1, 100), ("go", 4, 5, 3)]),
    "G82": (
        "G82 X4 Y5 Z1 R2 P0.5",
        [("go", 4, 5, 3), ("go", 4, 5, 2), ("feed", 4, 5, 1, 100), ("dwell", 0.5), ("go", 4, 5, 3)],
    ),
    "G85": ("G85 X4 Y5 Z1 R2", [("go", 4, 5, 3), ("go", 4, 5, 2), ("feed", 4, 5, 1, 100), ("feed", 4, 5, 3, 100)]),
    "G89": (
        "G89 X4 Y5 Z1 R2 P0.5",
        [("go", 4, 5, 3), ("go", 4, 5, 2), ("feed", 4, 5, 1, 100), ("dwell", 0.5), ("feed", 4, 5, 3, 100)],
    ),
    "G86": (
        "G86 X4 Y5 Z1 R2 P0.5",
        [
            ("go", 4, 5, 3), ("go", 4, 5, 2), ("feed", 4, 5, 1, 100), ("dwell", 0.5), ("spindle", 0),
            ("go", 4, 5, 3), ("spindle", 600),
        ],
    ),
    # a peck of 2.5 twice, then what is left; back to 0.254 above the bottom
    "G83": (
        "G83 X4 Y5 Z-4 R2 Q2.5",
        [
            ("go", 4, 5, 3), ("go", 4, 5, 2), ("feed", 4, 5, -0.5, 100), ("go", 4, 5, 3), ("go", 4, 5, -0.246),
            ("feed", 4, 5, -3, 100), ("go", 4, 5, 3), ("go", 4, 5, -2.746), ("feed", 4, 5, -4, 100), ("go", 4, 5, 3),
        ],
    ),
    "G73": (
        "G73 X4 Y5 Z-4 R2 Q2.5",
        [
            ("go", 4, 5, 3), ("go", 4, 5, 2), ("feed", 4, 5, -0.5, 100), ("go", 4, 5, 2), ("go", 4, 5, -0.246),
            ("feed", 4, 5, -3, 100), ("go", 4, 5, -0.5), ("go", 4, 5, -2.746), ("feed", 4, 5, -4, 100),
            ("go", 4, 5, 3),
        ],
    ),
    # 3.4.21.6: M3 S600 and F1 give 600 a minute, in and out, the spindle reversed between
    "G84": (
        "G84 X4 Y5 Z1 R2 F1",
        [
            ("go", 4, 5, 3), ("go", 4, 5, 2), ("sync", 4, 5, 1, 600), ("spindle", -600), ("sync", 4, 5, 3, 600),
            ("spindle", 600),
        ],
    ),
    # 3.4.21.10, its steps in their order
    "G87": (
        "G87 X4 Y5 Z-4 R2 I-3 J1 K-2",
        [
            ("go", 4, 5, 3), ("go", 4, 5, 2), ("go", 1, 6, 2), ("spindle", 0), ("orient",), ("go", 1, 6, -4),
            ("go", 4, 5, -4), ("spindle", 600), ("feed", 4, 5, -2, 100), ("feed", 4, 5, -4, 100), ("spindle", 0),
            ("orient",), ("go", 1, 6, -4), ("go", 1, 6, 3), ("go", 4, 5, 3), ("spindle", 600),
        ],
    ),
}  # fmt: skip


@pytest.mark.parametrize("plane", PLANES)
@pytest.mark.parametrize("cycle", CYCLES)
def test_cycle_in_each_plane(tmp_path: Path, cycle: str, plane: str) -> None:
    line, expected = CYCLES[cycle]
    text = HEAD + f"{plane} S600 M3 F100\n" + renamed(plane, "G0 X1 Y2 Z3") + "\n"
    assert rows(tmp_path, text + renamed(plane, line) + "\nG80 M5\n", 3) == [*turned(plane, expected), ("spindle", 0)]


@pytest.mark.parametrize("cycle", CYCLES)
def test_incremental_is_the_same_cycle(tmp_path: Path, cycle: str) -> None:
    """From 1 2 3: X and Y by +3, R by -1, Z from R, K of G87 from Z (3.4.21, 3.4.21.10)."""
    line, expected = CYCLES[cycle]
    words = line.split()
    depth = float(words[3][1:])
    change = {"X4": "X3", "Y5": "Y3", words[3]: f"Z{depth - 2:g}", "R2": "R-1", "K-2": "K2"}
    text = HEAD + "S600 M3 F100\n" + AT + "G91 " + " ".join(change.get(word, word) for word in words) + "\nG80 M5\n"
    assert rows(tmp_path, text, 3) == [*expected, ("spindle", 0)]


@pytest.mark.parametrize("cycle", CYCLES)
def test_inches(tmp_path: Path, cycle: str) -> None:
    """Every length of the line is 25.4 times as long; what G83 backs off is 0.01 inch as ever."""
    line, _ = CYCLES[cycle]
    metric = line
    for word in line.split():
        if word[0] in "XYZRQIJKF":
            metric = metric.replace(word, f"{word[0]}{float(word[1:]) * 25.4:g}")
    inch = rows(tmp_path, HEAD + "G20 S600 M3\nF10\n" + AT + line + "\nG80 M5\n", 4)
    same = HEAD + "S600 M3\nF254\nG0 X25.4 Y50.8 Z76.2\n" + metric + "\nG80 M5\n"
    assert inch == rows(tmp_path, same, 4)


@pytest.mark.parametrize("cycle", CYCLES)
def test_return_level_r(tmp_path: Path, cycle: str) -> None:
    """G99: where the cycle would come out to the old level, 3, it comes out to R, 2 (3.4.26)."""
    line, expected = CYCLES[cycle]
    low = [row if k == 0 or row[3:4] != (3,) else (*row[:3], 2, *row[4:]) for k, row in enumerate(expected)]
    assert rows(tmp_path, HEAD + "S600 M3 F100\n" + AT + "G99 " + line + "\nG80 M5\n", 3) == [*low, ("spindle", 0)]


@pytest.mark.parametrize("cycle", CYCLES)
def test_from_below_r_it_rises_first(tmp_path: Path, cycle: str) -> None:
    """3.4.21.1: once, at the beginning; the old level is below R then, so R is the clear level (3.4.26)."""
    line, expected = CYCLES[cycle]
    text = HEAD + "S600 M3 F100\nG0 X1 Y2 Z-9\n" + line + "\nG80 M5\n"
    low = [row if row[3:4] != (3,) else (*row[:3], 2, *row[4:]) for row in expected]
    found = rows(tmp_path, text, 3)
    assert found[:2] == [("go", 1, 2, 2), ("go", 4, 5, 2)]
    assert found[2:] == [*low[2:], ("spindle", 0)]


@pytest.mark.parametrize("cycle", CYCLES)
def test_repeats(tmp_path: Path, cycle: str) -> None:
    """In incremental mode each go-around is X and Y farther, R and Z stay; L is not sticky (3.4.21)."""
    line, expected = CYCLES[cycle]
    depth = float(line.split()[3][1:])
    change = {"X4": "X3", "Y5": "Y3", line.split()[3]: f"Z{depth - 2:g}", "R2": "R-1", "K-2": "K2"}
    words = " ".join(change.get(word, word) for word in line.split())
    low = [row if row[3:4] != (3,) else (*row[:3], 2, *row[4:]) for row in expected[2:]]
    text = HEAD + "S600 M3 F100\n" + AT + f"G91 G99 {words} L3\nG80 M5\n"
    wanted: list[Row] = [("go", 4, 5, 3), ("go", 4, 5, 2), *low]
    for k in (1, 2):
        wanted.append(("go", 4 + 3 * k, 5 + 3 * k, 2))
        wanted += [
            (row[0], row[1] + 3 * k, row[2] + 3 * k, *row[3:]) if row[0] in ("go", "feed", "sync") else row  # type: ignore[operator]
            for row in low
        ]
    assert rows(tmp_path, text, 3) == [*wanted, ("spindle", 0)]


@pytest.mark.parametrize("cycle", CYCLES)
def test_words_stay_for_the_next_hole(tmp_path: Path, cycle: str) -> None:
    line, expected = CYCLES[cycle]
    text = HEAD + "S600 M3 F100\n" + AT + f"{line}\nX14\nG80 M5\n"
    second = [(row[0], row[1] + 10, *row[2:]) if row[0] in ("go", "feed", "sync") else row for row in expected]  # type: ignore[operator]
    found = rows(tmp_path, text, 3)
    assert found == [*expected, *second, ("spindle", 0)]


def test_tapping_left_hand(tmp_path: Path) -> None:
    assert rows(tmp_path, HEAD + "S600 M4\n" + AT + "G74 X4 Y5 Z1 R2 F1\nG80 M5\n", 3) == [
        ("go", 4, 5, 3),
        ("go", 4, 5, 2),
        ("sync", 4, 5, 1, 600),
        ("spindle", 600),
        ("sync", 4, 5, 3, 600),
        ("spindle", -600),
        ("spindle", 0),
    ]


@pytest.mark.parametrize("mode", ["G94", "G95"])
def test_feed_of_a_tap_is_per_revolution_in_every_mode(tmp_path: Path, mode: str) -> None:
    found = rows(tmp_path, HEAD + f"{mode} S200 M3\n" + AT + "G84 X4 Y5 Z1 R2 F1.25\nG80 M5\n", 3)
    assert ("sync", 4, 5, 1, 250) in found


def test_manual_retraction(tmp_path: Path) -> None:
    """G88: the section ends, and where the operator leaves Z is not known until a line names it."""
    text = HEAD + "S600 M3 F100\n" + AT + "G88 X4 Y5 Z1 R2 P0.5\nG80\nG0 Z10\nX0\nM5\n"
    trace, findings = run_whole(tmp_path, text)
    assert codes_of(findings) == []
    assert [[edge.wait for edge in section.edges] for section in trace.sections] == [[Wait.OPERATOR], [Wait.END]]
    before, after = trace.sections
    assert shown(dataclasses.replace(trace, sections=[before]), after_line=3) == [
        ("go", 4, 5, 3), ("go", 4, 5, 2), ("feed", 4, 5, 1, 100), ("dwell", 0.5), ("spindle", 0), ("stop",),
    ]  # fmt: skip
    frames = [trace.frames[k] for k in after.rows["frame"].tolist()]
    assert frames[0][2] == (("?", 1),) and frames[0][:2] == ((), ())
    assert trace.frames[after.start_frame][2] == (("?", 1),)
    assert frames[1] == ((),) * 6
    assert shown(dataclasses.replace(trace, sections=[after])) == [
        ("spindle", 600), ("go", 4, 5, 10), ("go", 0, 5, 10), ("spindle", 0),
    ]  # fmt: skip


def test_a_second_hole_behind_a_manual_retraction_is_unknown(tmp_path: Path) -> None:
    _, findings = run_whole(tmp_path, HEAD + "S600 M3 F100\n" + AT + "G88 X4 Y5 Z1 R2 P0.5\nX14\nG80 M5\n")
    assert codes_of(findings) == ["GP304"]


NAMES = ["G73", "G74", "G81", "G82", "G83", "G84", "G85", "G86", "G87", "G88", "G89"]
MORE = {
    "G73": "Q1", "G83": "Q1", "G82": "P1", "G86": "P1", "G88": "P1", "G89": "P1", "G87": "I1 J1 K-1",
}  # fmt: skip


def mistake(folder: Path, name: str, line: str, before: str = "") -> list[str]:
    way = "M4" if name == "G74" else "M3"
    _, findings = run_whole(folder, f"{HEAD}S500 {way} F1\nG0 Z5\n{before}{line}\nG80 M5\n")
    return [code for code in codes_of(findings) if code != "GP265"]


@pytest.mark.parametrize("name", NAMES)
def test_every_error_of_every_cycle(tmp_path: Path, name: str) -> None:
    more = MORE.get(name, "")
    assert mistake(tmp_path, name, f"{name} X1 Y1 Z-2 R2 {more}") == []
    assert mistake(tmp_path, name, f"{name} R2 {more}") == ["GP215"]  # X, Y and Z are all missing
    assert mistake(tmp_path, name, f"{name} X1 Y1 R2 {more}") == ["GP216"]  # the depth is missing
    assert mistake(tmp_path, name, f"G18 {name} X1 Z1 R2 {more}") == ["GP216"]
    assert mistake(tmp_path, name, f"G19 {name} Y1 Z1 R2 {more}") == ["GP216"]
    assert mistake(tmp_path, name, f"{name} X1 Y1 Z-2 {more}") == ["GP223"]  # R is missing
    assert mistake(tmp_path, name, f"{name} X1 Y1 Z3 R2 {more}") == ["GP217"]  # R below Z
    assert mistake(tmp_path, name, f"G18 {name} X1 Y3 R2 {more}") == ["GP217"]
    assert mistake(tmp_path, name, f"G19 {name} X3 Y1 R2 {more}") == ["GP217"]
    for repeats in ("0", "-1", "1.5"):
        assert mistake(tmp_path, name, f"{name} X1 Y1 Z-2 R2 {more} L{repeats}") == ["GP219"]
    assert mistake(tmp_path, name, f"{name} X1 Y1 Z-2 R2 A5 {more}") == ["GP220"]  # rotational motion
    assert mistake(tmp_path, name, f"{name} X1 Y1 Z-2 R2 A0 {more}") == []
    assert mistake(tmp_path, name, f"G93 {name} X1 Y1 Z-2 R2 F5 {more}") == ["GP221"]  # inverse time
    assert mistake(tmp_path, name, f"{name} X1 Y1 Z-2 R2 {more} D3") == ["GP121"]
    if more.startswith("P"):
        assert mistake(tmp_path, name, f"{name} X1 Y1 Z-2 R2 P-1") == ["GP218"]
        assert mistake(tmp_path, name, f"{name} X1 Y1 Z-2 R2") == ["GP242"]
    if more.startswith("Q"):
        for peck in ("", "Q0", "Q-1"):
            assert mistake(tmp_path, name, f"{name} X1 Y1 Z-2 R2 {peck}") == ["GP222"]
    if name == "G87":
        assert mistake(tmp_path, name, "G87 X1 Y1 Z-2 R2 I1 K-1") == ["GP275"]
        assert mistake(tmp_path, name, "G87 X1 Y1 Z-2 R2 I1 J1 K-3") == ["GP267"]
        assert mistake(tmp_path, name, "G87 X1 Y1 Z-2 R2 I1 J1 K3") == ["GP267"]


DIAMETERS = dataclasses.replace(NO_MACHINE, controller=Controller(diameter_programming=True))


@pytest.mark.parametrize(("plane", "axis"), [("G17", "Z"), ("G18", "Y")])
def test_back_boring_with_diameters(tmp_path: Path, plane: str, axis: str) -> None:
    """Beside the hole along X: a diameter or a radius; not beside it, or along the other axis: as ever (3.4.21.10)."""
    other, top = ("Y", "J0 K-2") if plane == "G17" else ("Z", "J-2 K0")
    head = f"{HEAD}{plane} S600 M3 F100\nG0 X2 {other}2 {axis}3\n"
    line = f"G87 X8 {other}5 {axis}-4 R2"
    _, findings = run_whole(tmp_path, f"{head}{line} I1 {top}\nG80 M5\n", machine=DIAMETERS)
    assert "GP113" in codes_of(findings)
    here, findings = run_whole(tmp_path, f"{head}{line} I0 {top}\nG80 M5\n", machine=DIAMETERS)
    assert codes_of(findings) == ["GP265"]
    radii = line.replace("X8", "X4")
    there, _ = run_whole(tmp_path, f"{head.replace('X2', 'X1')}{radii} I0 {top}\nG80 M5\n")
    assert shown(here, after_line=3) == shown(there, after_line=3)


def test_a_spindle_that_stops_in_an_orientation(tmp_path: Path) -> None:
    """No warning where the machine file says that it can (step 3 of 3.4.21.10)."""
    text = f"{HEAD}S600 M3 F100\n{AT}G87 X4 Y5 Z-4 R2 I1 J0 K-2\nG80 M5\n"
    for able, told in ((True, []), (False, ["GP265"])):
        machine = dataclasses.replace(NO_MACHINE, spindles=(Spindle(number=0, oriented_stop=able),))
        assert codes_of(run_whole(tmp_path, text, machine=machine)[1]) == told


def test_back_boring_on_the_hole_s_axis_under_a_rotation(tmp_path: Path) -> None:
    turned = f"{HEAD}S600 M3 F100\nG68 R90 X0 Y0\n{AT}G87 X4 Y5 Z-4 R2 I0 J0 K-2\nG80 M5\n"
    trace, findings = run_whole(tmp_path, turned)
    assert codes_of(findings) == ["GP265"]
    assert [row for row in shown(trace, after_line=4) if row[0] == "feed"] == [
        ("feed", -5, 4, -2, 100),
        ("feed", -5, 4, -4, 100),
    ]
    _, findings = run_whole(tmp_path, turned.replace("I0", "I1"))
    assert codes_of(findings) == ["GP276"]


@pytest.mark.parametrize("name", ["G74", "G84", "G86", "G87", "G88"])
def test_the_spindle_must_turn(tmp_path: Path, name: str) -> None:
    line = f"{name} X1 Y1 Z-2 R2 {MORE.get(name, '')}"
    assert mistake(tmp_path, name, line, before="M5\n") == ["GP244"]
    _, findings = run_whole(tmp_path, f"{HEAD}S500 F1\nG0 Z5\n{line}\nG80\n", setup=NOTHING)
    assert codes_of(findings) == ["GP266"]


@pytest.mark.parametrize("before", ["G80", "G3 X1 Y1 R9", "G81 X0 Y0 Z-1 R2"])
@pytest.mark.parametrize("name", ["G74", "G84", "G86", "G87", "G88"])
def test_holes_after_a_cycle_that_may_not_run_are_no_mistakes(tmp_path: Path, name: str, before: str) -> None:
    """Where the spindle may turn, words alone go on with the cycle, whatever was in force before it (3.4.21)."""
    line = f"{name} X1 Y1 Z-2 R2 {MORE.get(name, '')}"
    text = f"{HEAD}S500 F1\nG0 Z5\n{before}\n{line}\nX4 Y2\n{name} X5\nY3\nG80\n"
    _, findings = run_whole(tmp_path, text, setup=NOTHING)
    assert {"GP266"} <= set(codes_of(findings)) <= {"GP266", "GP304", "GP405"}  # of places behind it


def test_a_tap_against_its_hand(tmp_path: Path) -> None:
    assert mistake(tmp_path, "G84", "G84 X1 Y1 Z-2 R2", before="M4\n") == ["GP264"]
    assert mistake(tmp_path, "G74", "G74 X1 Y1 Z-2 R2", before="M3\n") == ["GP264"]


def test_a_tap_that_the_axis_can_not_follow(tmp_path: Path) -> None:
    axes = tuple(dataclasses.replace(axis, max_velocity=10.0) for axis in NO_MACHINE.axes)
    text = HEAD + "S601 M3\nG0 Z5\nG84 X1 Y1 Z-2 R2 F1\nG80 M5\n"
    _, findings = run_whole(tmp_path, text, machine=dataclasses.replace(NO_MACHINE, axes=axes))
    assert codes_of(findings) == ["GP510"]


def test_taps_without_a_feed(tmp_path: Path) -> None:
    _, findings = run_whole(tmp_path, HEAD + "S500 M3\nG0 Z5\nG84 X1 Y1 Z-2 R2\nG80 M5\n")
    assert codes_of(findings) == ["GP204"]
