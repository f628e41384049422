"""Places, arcs, feeds, dwells and events of programs without waits."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest
from verify.translation.support import STRAIGHT, Shop

from gproof.ir.verdict import Verdict

JOB = """\
G21 G90 G17
M3 S1000
M8
G0 X10 Y10
G0 Z5
G1 Z-1 F100
G2 X20 Y20 I10 J0 F200
G4 P0.5
M54 P1
G1 X40
G1 Y40 F300
M55 P1
G0 Z10
M5
M9
M30
"""
CHORDS = dataclasses.replace(STRAIGHT, chord_mm=0.05)


@pytest.fixture(scope="module")
def shop(tmp_path_factory: pytest.TempPathFactory) -> Shop:
    return Shop(Path(tmp_path_factory.mktemp("shop")))


SAME = {
    "itself": ("", ""),
    "inches": ("G21 G90 G17\n", "G90 G17\n"),  # G21 is where the manual starts (2.1.6)
    "a longer way to say it": ("G1 X40\n", "G91 G1 X20\nG90\n"),
    "one line in two": ("G1 X40\n", "G1 X30\nX40\n"),
    "two arcs": ("G2 X20 Y20 I10 J0 F200\n", "G2 X12.928932188134524 Y17.071067811865476 I10 J0 F200\n"
                 "X20 Y20 I7.071067811865476 J-7.071067811865476\n"),
    "radius": ("I10 J0", "R10"),
    "spindle again": ("G1 X40\n", "M3 S1000\nG1 X40\n"),
    "two dwells": ("G4 P0.5\n", "G4 P0.2\nG4 P0.3\n"),
    "no move": ("G1 X40\n", "G1 X20\nG1 X40\n"),
    "a text": ("G1 X40\n", "(msg, half way)\nG1 X40\n"),
    "a subprogram": ("G1 X40\n", "gosub side\n"),
}  # fmt: skip
SIDE = "sub side\n G1 X40\nendsub\n"


@pytest.mark.parametrize("name", SAME)
def test_the_same_in_other_words(shop: Shop, name: str) -> None:
    old, new = SAME[name]
    assert not old or old in JOB
    answer = shop.compared(JOB, (SIDE if "gosub" in new else "") + JOB.replace(old, new, 1))
    assert answer.verdict is Verdict.SAFE, answer
    assert answer.drift[0] < 1e-9


WRONG = {
    "place": ("G1 X40\n", "G1 X40.001\n"),
    "place (sign)": ("G0 Z10\n", "G0 Z-10\n"),
    "kind": ("G1 X40\n", "G0 X40\n"),
    "sense": ("G2 X20", "G3 X20"),
    "sense (centre)": ("I10 J0", "I0 J10"),
    "feed": ("F300", "F301"),
    "dwell": ("G4 P0.5", "G4 P0.4"),
    "dwell lost": ("G4 P0.5\n", ""),
    "coolant lost": ("M8\n", ""),
    "spindle": ("M3 S1000", "M3 S900"),
    "spindle (direction)": ("M3 S1000", "M4 S1000"),
    "output": ("M54 P1", "M54 P2"),
    "output lost": ("M55 P1\n", ""),
    "event moved": ("M54 P1\nG1 X40\n", "G1 X40\nM54 P1\n"),
    "move lost": ("G0 Z10\n", ""),
    "path_mode": ("G1 X40\n", "G64 P0.1\nG1 X40\n"),
    "output added": ("G4 P0.5\nM54 P1\n", "M54 P1\nG4 P0.5\n"),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_wrong_is_named(shop: Shop, name: str) -> None:
    old, new = WRONG[name]
    assert old in JOB
    answer = shop.compared(JOB, JOB.replace(old, new, 1))
    assert answer.verdict is Verdict.UNSAFE, answer
    assert answer.differences[0].kind == name.partition(" (")[0]
    line = JOB[: JOB.index(old)].count("\n") + 1
    source = answer.differences[0].source
    assert source is not None and abs(source[1] - line) <= 2, (answer, line)


def test_leave_to_join_short_moves_may_be_left_out(shop: Shop) -> None:
    """Q and R of G61 and G64 (Eding CNC 3.4.16): who goes to every place is within them, not the reverse."""
    free, strict = (JOB.replace("G1 X40\n", f"G64 P0.1{more}\nG1 X40\nG61\n") for more in (" Q0.05 R3", ""))
    left_out = dataclasses.replace(STRAIGHT, filter_left_out=True)
    assert shop.compared(free, strict).verdict is Verdict.UNSAFE
    answer = shop.compared(free, strict, left_out)
    assert answer.verdict is Verdict.SAFE and any("are not joined" in text for text in answer.assumptions)
    assert shop.compared(strict, free, left_out).verdict is Verdict.UNSAFE
    assert shop.compared(free, strict.replace("P0.1", "P0.2"), left_out).verdict is Verdict.UNSAFE


def arc(count: int) -> str:
    """A quarter of radius 10 about X20 Y10 as chords, the arc of JOB, by the circle's own formula."""
    from math import cos, pi, radians, sin

    points = [pi - radians(90.0) * n / count for n in range(1, count + 1)]
    return "G1 F200 " + "".join(f"X{20 + 10 * cos(a):.6f} Y{10 + 10 * sin(a):.6f}\n" for a in points)


def test_an_arc_as_chords(shop: Shop) -> None:
    """10 mm radius, 0.05 mm: 1 - cos(h / 2) = 0.005, h = 11.46 degrees: eight chords fit, seven do not."""
    old = "G2 X20 Y20 I10 J0 F200\n"
    assert shop.compared(JOB, JOB.replace(old, arc(8)), CHORDS).verdict is Verdict.SAFE
    assert shop.compared(JOB, JOB.replace(old, arc(7)), CHORDS).verdict is Verdict.UNSAFE
    assert shop.compared(JOB.replace(old, arc(8)), JOB, CHORDS).verdict is Verdict.SAFE
    assert shop.compared(JOB, JOB.replace(old, arc(8))).verdict is Verdict.UNSAFE


@pytest.mark.parametrize(
    "end, other, is_proven",
    [
        ("M30\n", "M5\nM9\nM30\n", True),
        ("M5\nM30\n", "M9\nM30\n", True),
        ("M30\n", "M5\nM9\nM2\n", True),
        ("M2\n", "M9\nM2\n", False),
        ("M2\n", "M5\nM2\n", False),
        ("G0 X9\nM30\n", "M9\nG0 X9\nM30\n", False),
        ("M30\n", "M8\nM30\n", False),
        ("M30\n", "M8\nM2\n", False),
        ("M30\n", "M54 P1\nM9\nM30\n", False),
        ("M8\nM30\n", "M8\nM9\nM2\n", True),
        ("M8\nM30\n", "M8\nM2\n", False),
        ("M3\nM30\n", "M3\nM2\n", False),
    ],
)
def test_an_end_that_switches_spindle_and_coolant_off(shop: Shop, end: str, other: str, is_proven: bool) -> None:
    """M30 of Eding CNC does, M2 does not (3.5.1); at the stop before, the operator may have switched them on."""
    head = "G21 G90 G17\nS100\nG0 X1\nM0\nG0 X5\n"
    answer = shop.compared(head + end, head + other)
    assert (answer.verdict is Verdict.SAFE) == is_proven, answer
