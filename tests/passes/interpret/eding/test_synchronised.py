"""G33 and G33.1 against rows worked out by hand from the Eding CNC manual 3.4.9."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest
from passes.interpret.core.programs import HEAD, codes_of, run_whole, shown

from gproof.ir.machine import NO_MACHINE
from gproof.ir.setup import NOTHING

SLOW = dataclasses.replace(
    NO_MACHINE, axes=tuple(dataclasses.replace(axis, max_velocity=10.0) for axis in NO_MACHINE.axes)
)
"""600 mm/min on every axis."""


def test_g33_is_one_move_of_pitch_times_speed(tmp_path: Path) -> None:
    trace, findings = run_whole(tmp_path, HEAD + "S500 M3\nG0 Z5\nG33 Z-10 K1.5\nM30\n")
    assert shown(trace, after_line=3) == [("sync", 0, 0, -10, 750), ("spindle", 0)]
    assert codes_of(findings) == []


def test_k_is_the_distance_along_the_path(tmp_path: Path) -> None:
    # 3-4-5: 10 mm of path, 2 mm a revolution of 120 rpm, incremental
    trace, _ = run_whole(tmp_path, HEAD + "S120 M4\nG91\nG33 X6 Z-8 K2\nM30\n")
    assert shown(trace, after_line=3) == [("sync", 6, 0, -8, 240), ("spindle", 0)]


def test_inches(tmp_path: Path) -> None:
    trace, _ = run_whole(tmp_path, HEAD + "G20\nS100 M3\nG33 Z-1 K0.05\nM30\n")
    assert shown(trace, after_line=3) == [("sync", 0, 0, -25.4, 127), ("spindle", 0)]


def test_the_feed_mode_has_no_say(tmp_path: Path) -> None:
    for mode in ("G93", "G95"):
        trace, findings = run_whole(tmp_path, HEAD + f"{mode}\nS100 M3\nG33 Z-1 K1\nM30\n")
        assert ("sync", 0, 0, -1, 100) in shown(trace)
        assert codes_of(findings) == []


def test_g33_1_reverses_and_comes_back(tmp_path: Path) -> None:
    trace, findings = run_whole(tmp_path, HEAD + "S500 M3\nG0 X1 Y2 Z5\nG33.1 Z-10 K1.5\nG1 X2 F100\nM30\n")
    assert shown(trace, after_line=3) == [
        ("sync", 1, 2, -10, 750),
        ("spindle", -500),
        ("sync", 1, 2, 5, 750),
        ("spindle", 500),
        ("feed", 2, 2, 5, 100),
        ("spindle", 0),
    ]
    assert codes_of(findings) == []


@pytest.mark.parametrize(
    ("line", "code"),
    [
        ("S500 M3\nG33 K1.5", "GP201"),  # all axis words are omitted
        ("S500 M3\nG33.1 K1.5", "GP201"),
        ("S500 M5\nG33 Z-10 K1.5", "GP244"),  # the spindle is not turning
        ("S0 M3\nG33 Z-10 K1.5", "GP244"),  # 3.5.2: with S0 it will not start turning
        ("S500 M5\nG33.1 Z-10 K1.5", "GP244"),
        ("S500 M3\nG33 Z-10", "GP275"),  # 3.4: what is not called optional is required
        ("S500 M3\nG33 Z-10 K0", "GP275"),
        ("S500 M3\nG33 Z-10 K-1", "GP275"),
        ("S500 M3\nG33 Z-10 A5 K1", "GP121"),
        ("S500 M3\nG33 Z-10 K1 L2", "GP121"),
        ("S500 M3\nG53 G33 Z-10 K1", "GP210"),
        ("S500 M3\nG1 G33 Z-10 K1 F5", "GP110"),
        ("S601 M3\nG33 Z-10 K1", "GP510"),  # beyond the machine's velocity
        ("S601 M3\nG33.1 Z-10 K1", "GP510"),
    ],
)
def test_errors(tmp_path: Path, line: str, code: str) -> None:
    _, findings = run_whole(tmp_path, f"{HEAD}{line}\nM30\n", machine=SLOW)
    assert codes_of(findings)[:1] == [code]


def test_a_rotation_turns_the_way_and_keeps_the_pitch(tmp_path: Path) -> None:
    """6 and 8 about the zero by a quarter turn: -8 and 6; 2 mm a revolution of 120 rpm along 10 mm, out and back."""
    text = HEAD + "S120 M3\nG68 R90 X0 Y0\nG33.1 X6 Y8 K2\nG69\nM30\n"
    trace, findings = run_whole(tmp_path, text)
    rows = shown(trace, after_line=3)
    assert rows == [
        ("sync", -8, 6, 0, 240),
        ("spindle", -120),
        ("sync", 0, 0, 0, 240),
        ("spindle", 120),
        ("spindle", 0),
    ]
    assert codes_of(findings) == []


@pytest.mark.parametrize("point", ["X-1 Y-1", "X-1 Y1"])
def test_a_mirror_keeps_the_pitch(tmp_path: Path, point: str) -> None:
    trace, findings = run_whole(tmp_path, HEAD + f"S120 M3\nG51 {point} I0 J0\nG33 X6 Z-8 K2\nM30\n")
    assert shown(trace, after_line=3) == [("sync", -6, 0, -8, 240), ("spindle", 0)]
    assert codes_of(findings) == []


@pytest.mark.parametrize("code", ["G33", "G33.1"])
def test_under_a_scale_the_way_is_known_and_the_pitch_is_not(tmp_path: Path, code: str) -> None:
    trace, findings = run_whole(tmp_path, HEAD + f"S120 M3\nG51 X2 Y2 I0 J0\n{code} X6 Z-8 K2\nG1 X1 F100\nM30\n")
    rows = [row for row in shown(trace, after_line=3) if row[0] != "spindle"]
    back = [("sync", 0, 0, 0, None)] if code == "G33.1" else []
    assert rows == [("sync", 12, 0, -8, None), *back, ("feed", 2, 0, 0 if back else -8, 100)]
    assert codes_of(findings) == ["GP284"]
    # Z is not scaled, and neither is what lies along it
    trace, findings = run_whole(tmp_path, HEAD + f"S120 M3\nG51 X2 Y2 I0 J0\n{code} Z-8 K2\nM30\n")
    assert shown(trace, after_line=3)[0] == ("sync", 0, 0, -8, 240)
    assert codes_of(findings) == []


def test_velocity_is_judged_axis_by_axis(tmp_path: Path) -> None:
    # 750 mm/min along 3-4-5: 450 and 600, just what the axes can do
    _, findings = run_whole(tmp_path, HEAD + "S750 M3\nG33 X3 Z4 K1\nM30\n", machine=SLOW)
    assert codes_of(findings) == []
    _, findings = run_whole(tmp_path, HEAD + "S751 M3\nG33 X3 Z4 K1\nM30\n", machine=SLOW)
    assert codes_of(findings) == ["GP510"]
    assert "600.8 mm/min of Z" in findings.kept[0].message


def test_without_machine_velocities_nothing_is_judged(tmp_path: Path) -> None:
    _, findings = run_whole(tmp_path, HEAD + "S99999 M3\nG33 X3 Z4 K10\nM30\n")
    assert codes_of(findings) == []


def test_unknown_spindle_state_is_unknown(tmp_path: Path) -> None:
    _, findings = run_whole(tmp_path, HEAD + "S500\nG33 Z-10 K1.5\nM30\n", setup=NOTHING)
    assert codes_of(findings) == ["GP266"]


def test_unknown_speed_leaves_the_feed_open(tmp_path: Path) -> None:
    trace, findings = run_whole(tmp_path, HEAD + "M3\nG33 Z-10 K1.5\nM30\n", setup=NOTHING)
    assert ("sync", 0, 0, -10, None) in shown(trace)
    assert codes_of(findings) == ["GP239"]


def test_axis_words_alone_behind_g33_are_unknown(tmp_path: Path) -> None:
    _, findings = run_whole(tmp_path, HEAD + "S500 M3\nG33 Z-10 K1.5\nZ-20\nG0 X5\nM30\n")
    assert codes_of(findings) == ["GP113", "GP304"]
