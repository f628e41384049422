"""The spindle against the Eding CNC manual 3.4.24, 3.4.25, 3.5.2, 3.5.8 and 3.6.2."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import pytest
from passes.interpret.core.programs import HEAD, LATHE, Row, codes_of, run_whole, shown

from gproof.ir.machine import NO_MACHINE, Controller, Machine, Spindle
from gproof.ir.setup import NOTHING
from gproof.ir.trace import Op, State, Trace
from gproof.passes.motion.plan import plan


def rows(folder: Path, text: str) -> list[Row]:
    trace, findings = run_whole(folder, text)
    assert codes_of(findings) == []
    return shown(trace, after_line=1)


def states(trace: Trace) -> list[State]:
    """Of each move."""
    return [
        trace.states[k]
        for section in trace.sections
        for op, k in zip(section.rows["op"].tolist(), section.rows["state"].tolist(), strict=True)
        if op < Op.DWELL
    ]


def test_s_while_it_rests_and_while_it_turns(tmp_path: Path) -> None:
    # 3.5.2: M3 with S0 does not turn until S is above zero; to start a turning spindle, to stop a resting one is OK
    text = HEAD + "M5\nS0 M3\nS300\nM3\nM4\nS400\nM5\nM5\n"
    assert rows(tmp_path, text) == [
        ("spindle", 0), ("spindle", 0), ("spindle", 300), ("spindle", 300), ("spindle", -300), ("spindle", -400),
        ("spindle", 0), ("spindle", 0),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("codes", "expected"),
    [
        # 3.5.8: M3 is speed and direction output on, M4 speed on and direction off, M5 both off
        ("M86", [-500]),
        ("M84\nM86", [500]),
        ("M84 M86", [500]),
        ("M86 M84", [500]),
        ("M85 M86", [-500]),
        ("M86\nM84\nM85\nM87", [-500, 500, -500, 0]),
        ("M3\nM87\nM86", [500, 0, 500]),
        ("M4\nM87\nM86", [-500, 0, -500]),
        ("M3\nM85", [500, -500]),
        ("M84\nM5\nM86", [0, -500]),
        ("M3 M86", [500, 500]),
    ],
)
def test_outputs_are_what_m3_to_m5_do(tmp_path: Path, codes: str, expected: list[float]) -> None:
    found = rows(tmp_path, f"{HEAD}S500 M5\n{codes}\nM5\n")
    assert found == [("spindle", 0), *(("spindle", rpm) for rpm in expected), ("spindle", 0)]


def test_which_way_is_unknown_before_anything_said_so(tmp_path: Path) -> None:
    _, findings = run_whole(tmp_path, HEAD + "S500\nM86\nG4 P1\n", setup=NOTHING)
    assert codes_of(findings) == ["GP113"]
    trace, findings = run_whole(tmp_path, HEAD + "S500\nM84\nM86\nM5\n", setup=NOTHING)
    assert codes_of(findings) == []
    assert ("spindle", 500) in shown(trace)


def test_negative_speed(tmp_path: Path) -> None:
    for line in ("S-1", "G96 S-1 D100", "G97 S-1"):
        _, findings = run_whole(tmp_path, f"{HEAD}{line}\nM30\n")
        assert codes_of(findings) == ["GP213"]


# 3.4.25


def test_constant_surface_speed_leaves_the_revolutions_open(tmp_path: Path) -> None:
    trace, findings = run_whole(tmp_path, LATHE + "G96 S150 D1000 M3\nG0 X100\nG1 X50 F200\nG97 S400\nG1 X40\nM5\n")
    assert codes_of(findings) == []
    assert shown(trace, after_line=1) == [
        ("spindle", None), ("go", 100, 0, 0), ("feed", 50, 0, 0, 200), ("spindle", 400), ("feed", 40, 0, 0, 200),
        ("spindle", 0),
    ]  # fmt: skip
    found = states(trace)
    assert [state.surface_speed for state in found] == [150, 150, 0]
    assert [state.spindle_limit for state in found[:2]] == [1000, 1000] and math.isnan(found[2].spindle_limit)
    assert math.isnan(found[0].spindle) and found[2].spindle == 400


def test_feet_a_minute_in_inch_mode(tmp_path: Path) -> None:
    trace, _ = run_whole(tmp_path, LATHE + "G20\nG96 S500 D1000 M3\nG0 X1\nS100\nG0 X2\nM5\n")
    assert [state.surface_speed for state in states(trace)] == [152.4, 30.48]


def test_feed_per_revolution_under_g96_is_not_known(tmp_path: Path) -> None:
    trace, findings = run_whole(tmp_path, LATHE + "G96 S150 D1000 M3\nG95\nG1 X50 F0.2\nM5\n")
    assert ("feed", 50, 0, 0, None) in shown(trace)
    assert codes_of(findings) == ["GP239"]


def test_a_synchronised_move_under_g96_is_not_known(tmp_path: Path) -> None:
    trace, findings = run_whole(tmp_path, LATHE + "G96 S150 D1000 M3\nG33 Z-10 K1\nM5\n")
    assert ("sync", 0, 0, -10, None) in shown(trace)
    assert codes_of(findings) == ["GP239"]


@pytest.mark.parametrize(
    ("line", "code"),
    [
        ("G96 D1000", "GP275"),
        ("G96 S150", "GP268"),
        ("G96 S150 D0", "GP269"),
        ("G96 S150 D-1", "GP269"),
        ("G96 G97 S150", "GP110"),
        ("G97 S150 D100", "GP121"),
    ],
)
def test_words_of_g96(tmp_path: Path, line: str, code: str) -> None:
    _, findings = run_whole(tmp_path, f"{LATHE}{line}\nM30\n")
    assert codes_of(findings) == [code]


def test_g97_without_s_leaves_the_speed_open(tmp_path: Path) -> None:
    trace, findings = run_whole(tmp_path, LATHE + "G96 S150 D1000 M3\nG97\nG95 G1 X5 F1\nM5\n")
    assert ("feed", 5, 0, 0, None) in shown(trace)
    assert codes_of(findings) == ["GP239"]
    assert rows(tmp_path, LATHE + "G97\nS200 M3\nG97\nM5\n")[-2:] == [("spindle", 200), ("spindle", 0)]


# 2.1.11


RANGE = dataclasses.replace(NO_MACHINE, spindles=(Spindle(number=0, min_rpm=1000, max_rpm=24000),))


@pytest.mark.parametrize(("speed", "code"), [(999, ["GP271"]), (1000, []), (24000, []), (24001, ["GP271"]), (0, [])])
def test_speeds_that_the_spindle_can_not_do(tmp_path: Path, speed: int, code: list[str]) -> None:
    _, findings = run_whole(tmp_path, f"{HEAD}S{speed} M3\nM5\n", machine=RANGE)
    assert codes_of(findings) == code


def test_a_feed_that_follows_such_a_speed_is_not_known(tmp_path: Path) -> None:
    for line in ("G95 G1 X5 F1", "G33 X5 K1"):
        machine: Machine = RANGE
        trace, findings = run_whole(tmp_path, f"{HEAD}S500 M3\n{line}\nM5\n", machine=machine)
        assert [row[4] for row in shown(trace) if row[0] in ("feed", "sync")] == [None]
        assert codes_of(findings) == ["GP271", "GP239"]


RAMPS = dataclasses.replace(
    NO_MACHINE, controller=Controller(spindle_ramp_time=1.0),
    spindles=(Spindle(number=0, ramp_time=1.5), Spindle(number=1, ramp_time=4.0), Spindle(number=2, ramp_time=0.5)),
)  # fmt: skip
"""The plan waits 1 s at each row that starts or reverses (docs/plan.md); what a head needs beyond it is a dwell."""


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("S500 M3\n", [("spindle", 500), ("dwell", 0.5)]),
        ("S500 M3\nM3\nS900\n", [("spindle", 500), ("dwell", 0.5), ("spindle", 500), ("spindle", 900)]),
        ("S500 M3\nM5\nM3\n", [("spindle", 500), ("dwell", 0.5), ("spindle", 0), ("spindle", 500), ("dwell", 0.5)]),
        ("S500 M3\nM4\n", [("spindle", 500), ("dwell", 0.5), ("spindle", -500), ("dwell", 0.5)]),
        # the plan waits at M3, and no second time
        ("S0 M3\nS500\n", [("spindle", 0), ("spindle", 500), ("dwell", 1.5)]),
        ("S500 M84\nM86\n", [("spindle", 500), ("dwell", 0.5)]),
        ("M91\nS500 M3\n", [("HEAD",), ("spindle", 500), ("dwell", 3)]),
        ("M92\nS500 M3\n", [("HEAD",), ("spindle", 500)]),
        # 3.4.9: reversed for the way back and again behind it
        (
            "S600 M3\nG33.1 Z-1 K1\n",
            [
                ("spindle", 600), ("dwell", 0.5), ("sync", 0, 0, -1, 600), ("spindle", -600), ("dwell", 0.5),
                ("sync", 0, 0, 0, 600), ("spindle", 600), ("dwell", 0.5),
            ],
        ),
    ],
)  # fmt: skip
def test_the_wait_for_the_spindle(tmp_path: Path, text: str, expected: list[Row]) -> None:
    """2.1.11: the software waits between switching on the spindle and going on; the wait of each head is its own."""
    trace, findings = run_whole(tmp_path, HEAD + text, machine=RAMPS)
    assert codes_of(findings) == []
    found = [row if row[0] != "head" else ("HEAD",) for row in shown(trace, after_line=1)]
    assert found == expected
    # without times of their own the heads wait as the machine does
    plain = dataclasses.replace(RAMPS, spindles=())
    dwells = [row for row in shown(run_whole(tmp_path, HEAD + text, machine=plain)[0]) if row[0] == "dwell"]
    assert dwells == ([("dwell", 1)] if text.startswith("S0") else [])


@pytest.mark.parametrize(("text", "seconds"), [("S500 M3\n", 1.5), ("M91\nS500 M3\n", 4), ("S0 M3\nS500\nM5\n", 2.5)])
def test_the_plan_waits_as_long(tmp_path: Path, text: str, seconds: float) -> None:
    trace, findings = run_whole(tmp_path, HEAD + text + "M2\n", machine=RAMPS)
    made = plan(trace, RAMPS, findings)
    assert made is not None
    assert sum(section.rows["duration"].sum() for section in made.sections) == pytest.approx(seconds)
