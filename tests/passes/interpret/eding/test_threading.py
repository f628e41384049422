"""G76 against passes worked out by hand from the Eding CNC manual 3.4.19 (and the RS274/NGC cycle it shares)."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import pytest
from passes.interpret.core.programs import LATHE, OFFSET, POSITION, Row, codes_of, run_whole, shown

from gproof.ir.machine import NO_MACHINE
from gproof.ir.setup import NOTHING

START = LATHE + "S500 M3\nG0 X20 Z20\n"


def plain_pass(depth: float, *, full: float, peak: float, inward: int) -> list[Row]:
    """Over the drive line at X20 from Z20 to Z10, pitch 1 at 500 rpm, no taper: back, in, along, out."""
    outside, bottom = 20 - inward * (full - depth), 20 + inward * (peak + depth)
    rows = [("go", outside, 0, 20), ("go", bottom, 0, 20), ("sync", bottom, 0, 10, 500), ("go", outside, 0, 10)]
    return [tuple(round(v, 6) if isinstance(v, float) else v for v in row) for row in rows]


def test_the_example_of_the_manual(tmp_path: Path) -> None:
    """Z20 to Z10, outside diameter 15, inside 14, ten passes: at X 14.9, 14.8 ... 14.0."""
    trace, findings = run_whole(tmp_path, START + "G76 P1.0 Z10 I15 J0.1 K1.0\nM30\n", machine=POSITION)
    rows = shown(trace, after_line=3)
    assert [row[1] for row in rows if row[0] == "sync"] == [round(15 - 0.1 * n, 6) for n in range(1, 11)]
    expected = [row for n in range(1, 11) for row in plain_pass(0.1 * n, full=1, peak=5, inward=-1)]
    assert rows == [*expected, ("spindle", 0)]
    assert codes_of(findings) == []


def test_constant_area_over_an_external_thread(tmp_path: Path) -> None:
    # R2: J x sqrt(n); 0.5 x sqrt(4) = 1 is the full depth
    trace, _ = run_whole(tmp_path, START + "G76 P1 Z10 I-5 J0.5 K1 R2\nM30\n", machine=OFFSET)
    expected = [row for n in (1, 2, 3, 4) for row in plain_pass(0.5 * math.sqrt(n), full=1, peak=5, inward=-1)]
    assert shown(trace, after_line=3) == [*expected, ("spindle", 0)]


def test_an_internal_thread_and_spring_passes(tmp_path: Path) -> None:
    trace, _ = run_whole(tmp_path, START + "G76 P1 Z10 I2 J0.4 K1 R1 H2\nM30\n", machine=OFFSET)
    expected = [row for depth in (0.4, 0.8, 1, 1, 1) for row in plain_pass(depth, full=1, peak=2, inward=1)]
    assert shown(trace, after_line=3) == [*expected, ("spindle", 0)]


def test_incremental_z_and_other_offsets(tmp_path: Path) -> None:
    there, _ = run_whole(tmp_path, START + "G76 P1 Z10 I-5 J1 K1\nM30\n", machine=OFFSET)
    text = LATHE + "S500 M3\nG10 L2 P1 X5 Z7\nG0 X15 Z13\nG91 G76 P1 Z-10 I-5 J1 K1\nM30\n"
    moved, _ = run_whole(tmp_path, text, machine=OFFSET)
    assert shown(moved, after_line=4) == shown(there, after_line=3)
    # I as a position counts from the program's zero
    text = text.replace("I-5", "I10")
    moved, _ = run_whole(tmp_path, text, machine=POSITION)
    assert shown(moved, after_line=4) == shown(there, after_line=3)


def test_compound_slide_shifts_each_pass(tmp_path: Path) -> None:
    """45 degrees: as far along as deep; the last pass ends at Z, the first begins J along."""
    trace, _ = run_whole(tmp_path, START + "G76 P1 Z10 I-5 J0.5 K1 Q45\nM30\n", machine=OFFSET)
    assert shown(trace, after_line=3) == [
        ("go", 20.5, 0, 19.5),
        ("go", 14.5, 0, 19.5),
        ("sync", 14.5, 0, 10.5, 500),
        ("go", 20.5, 0, 10.5),
        ("go", 20, 0, 19),
        ("go", 14, 0, 19),
        ("sync", 14, 0, 10, 500),
        ("go", 20, 0, 10),
        ("spindle", 0),
    ]


@pytest.mark.parametrize("ends", [0, 1, 2, 3])
def test_tapers(tmp_path: Path, ends: int) -> None:
    """E1 for K1 is 45 degrees: along it the path is sqrt(2) longer, and so the feed, for the same pitch along Z."""
    trace, _ = run_whole(tmp_path, START + f"G76 P1 Z10 I-5 J1 K1 E1 L{ends}\nM30\n", machine=OFFSET)
    fast = round(500 * math.sqrt(2), 6)
    entry = [("sync", 15, 0, 20, fast), ("sync", 14, 0, 19, fast)] if ends & 1 else [("go", 14, 0, 20)]
    leave = [("sync", 14, 0, 11, 500), ("sync", 15, 0, 10, fast)] if ends & 2 else [("sync", 14, 0, 10, 500)]
    assert shown(trace, after_line=3) == [("go", 20, 0, 20), *entry, *leave, ("go", 20, 0, 10), ("spindle", 0)]


def test_towards_positive_z(tmp_path: Path) -> None:
    trace, _ = run_whole(tmp_path, START + "G76 P1 Z30 I-5 J0.5 K1 Q45 E2 L3\nM30\n", machine=OFFSET)
    first = shown(trace, after_line=3)[:6]
    slope = round(500 * math.hypot(2, 1) / 2, 6)
    assert first == [
        ("go", 20.5, 0, 20.5),
        ("sync", 15.5, 0, 20.5, slope),
        ("sync", 14.5, 0, 22.5, slope),
        ("sync", 14.5, 0, 27.5, 500),
        ("sync", 15.5, 0, 29.5, slope),
        ("go", 20.5, 0, 29.5),
    ]


def test_inches(tmp_path: Path) -> None:
    text = LATHE + "G20\nS100 M3\nG0 X1 Z1\nG76 P0.05 Z0.5 I-0.1 J0.02 K0.02\nM30\n"
    trace, _ = run_whole(tmp_path, text, machine=OFFSET)
    rows = shown(trace, after_line=4)
    assert rows[2] == ("sync", round(0.88 * 25.4, 6), 0, 12.7, 127)


def test_two_readings_of_i_are_unknown(tmp_path: Path) -> None:
    for word, places in (("I15", ("X15 ", "X35 ")), ("I-5", ("X-5 ", "X15 "))):
        _, findings = run_whole(tmp_path, START + f"G76 P1 Z10 {word} J1 K1\nM30\n")
        assert codes_of(findings) == ["GP263"]
        assert all(place in findings.kept[0].message for place in places)


WORDS = "P1 Z10 I-5 J0.25 K1"


@pytest.mark.parametrize(
    ("line", "code"),
    [
        ("G17 G76 " + WORDS, "GP261"),  # the active plane is not the ZX plane
        ("G19 G76 " + WORDS, "GP261"),
        (f"G76 {WORDS} X3", "GP262"),  # other axis words
        (f"G76 {WORDS} Y3", "GP262"),
        (f"G76 {WORDS} A3", "GP262"),
        (f"G76 {WORDS} R0.9", "GP262"),  # the degression is less than 1.0
        ("G76 Z10 I-5 J0.25 K1", "GP275"),  # all the required words are not specified
        ("G76 P1 I-5 J0.25 K1", "GP275"),
        ("G76 P1 Z10 J0.25 K1", "GP275"),
        ("G76 P1 Z10 I-5 K1", "GP275"),
        ("G76 P1 Z10 I-5 J0.25", "GP275"),
        ("G76", "GP275"),
        ("G76 P-1 Z10 I-5 J0.25 K1", "GP262"),  # P, J, K or H is negative
        ("G76 P1 Z10 I-5 J-0.25 K1", "GP262"),
        ("G76 P1 Z10 I-5 J0.25 K-1", "GP262"),
        (f"G76 {WORDS} H-1", "GP262"),
        (f"G76 {WORDS} E5.01 L1", "GP262"),  # E is greater than half the drive line length
        # beyond the list: what could not be cut
        ("G76 P0 Z10 I-5 J0.25 K1", "GP262"),
        ("G76 P1 Z10 I-5 J0 K1", "GP262"),
        ("G76 P1 Z10 I-5 J0.25 K0", "GP262"),
        ("G76 P1 Z10 I-5 J1.25 K1", "GP262"),
        ("G76 P1 Z10 I0 J0.25 K1", "GP262"),
        ("G76 P1 Z20 I-5 J0.25 K1", "GP262"),
        (f"G76 {WORDS} H1.5", "GP262"),
        (f"G76 {WORDS} L4 E1", "GP262"),
        (f"G76 {WORDS} E-1 L1", "GP262"),
        (f"G76 {WORDS} Q85", "GP262"),
        (f"G76 {WORDS} E5 L3", "GP262"),
        (f"G76 {WORDS} D3", "GP121"),
        ("M5 G76 " + WORDS, "GP244"),
        ("G53 G76 " + WORDS, "GP210"),
        ("G76 P1 Z10 I-5 J0.0000001 K1", "GP113"),
        (f"G76 {WORDS} Q-10", "GP113"),
    ],
)
def test_errors(tmp_path: Path, line: str, code: str) -> None:
    trace, findings = run_whole(tmp_path, f"{START}{line}\nM30\n", machine=OFFSET)
    assert codes_of(findings) == [code]
    # A word that nothing uses is found behind the motion, as on any line.
    assert any(row[0] == "sync" for row in shown(trace)) == (code == "GP121")


def test_e_of_half_the_drive_line_is_allowed(tmp_path: Path) -> None:
    _, findings = run_whole(tmp_path, START + f"G76 {WORDS} E5 L1\nM30\n", machine=OFFSET)
    assert codes_of(findings) == []


@pytest.mark.parametrize("word", ["I0", "I-15", "I20"])
def test_a_diameter_must_be_positive_and_off_the_drive_line(tmp_path: Path, word: str) -> None:
    _, findings = run_whole(tmp_path, START + f"G76 P1 Z10 {word} J1 K1\nM30\n", machine=POSITION)
    assert codes_of(findings) == ["GP262"]


def test_the_line_stays_active_but_needs_its_words(tmp_path: Path) -> None:
    _, findings = run_whole(tmp_path, START + f"G76 {WORDS}\nZ5\nM30\n", machine=OFFSET)
    assert codes_of(findings) == ["GP275"]


def test_an_axis_that_can_not_follow(tmp_path: Path) -> None:
    axes = tuple(dataclasses.replace(axis, max_velocity=8.0) for axis in NO_MACHINE.axes)
    _, findings = run_whole(tmp_path, START + f"G76 {WORDS}\nM30\n", machine=dataclasses.replace(OFFSET, axes=axes))
    assert codes_of(findings) == ["GP510"]


@pytest.mark.parametrize("turn", ["G68 R90 X0 Y0", "G68 R180 X0 Y0", "G51 P2 I0 J0", "G51 X-1 Y1 I0 J0"])
def test_its_depth_under_a_rotation_or_a_scale_is_open(tmp_path: Path, turn: str) -> None:
    text = START.replace("G18", "G17") + f"{turn}\nG18 G76 {WORDS}\nM30\n"
    _, findings = run_whole(tmp_path, text, machine=OFFSET)
    assert codes_of(findings) == ["GP276"]


def test_unknown_start_and_words(tmp_path: Path) -> None:
    text = LATHE + f"S500 M3\nG76 {WORDS}\nM30\n"
    _, findings = run_whole(tmp_path, text, machine=OFFSET, setup=NOTHING)
    assert codes_of(findings) == ["GP225"]
    _, findings = run_whole(tmp_path, START + "G76 P#7 Z10 I-5 J1 K1\nM30\n", machine=OFFSET, setup=NOTHING)
    assert "GP225" in codes_of(findings)
