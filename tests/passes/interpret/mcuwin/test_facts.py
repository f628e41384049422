"""Facts of setup files on a McuWIN machine: each reaches the answer, or makes it UNKNOWN (2.7, 3.19, 3.26, 4.11, 11).

Places are worked out by hand: G54 is 10 20 30 in the machine's table of ``din_programs``.
"""

from __future__ import annotations

import dataclasses
from typing import Any

import pytest
from passes.interpret.mcuwin.mcuwin_programs import labels, machine, moves, run

from gproof.ir.machine import Machine
from gproof.ir.setup import ZERO, CylinderMap, HeightMap, InForce, Interval, Setup

OPEN = dataclasses.replace(ZERO, default_offset=None, active_work=None, g92={})
LIMITED = dataclasses.replace(machine(), axes=machine().axes[:3])


def exactly(value: float) -> Interval:
    return Interval(value, value)


def setup(base: Setup = ZERO, **facts: Any) -> Setup:
    return dataclasses.replace(base, **facts)


@pytest.mark.parametrize(
    "facts",
    [
        {"transform": InForce(angle=30.0)},
        {"transform": InForce(factor_x=2.0, factor_y=2.0)},
        {"transform": InForce(factor_x=1.0, factor_y=-1.0)},
        {"heads": {(1, "x"): exactly(100.0)}},
        {"heads": {(1, "x"): Interval(-1.0, 0.0)}},
        {"cylinder": CylinderMap(radius=10.0)},
        {"height_map": HeightMap(x=0, y=0, size=9, heights=((0, 1), (0, 1)))},
        {"tool_lengths": {1: exactly(30.0)}},
        {"tool_lengths": {0: exactly(30.0)}},
        {"measures": {"z": exactly(-30.0)}},
        {"work": {(6, "x"): exactly(5.0)}},
        {"active_work": 6},
        {"inputs": {5: 1.0}},
        {"parameters": {2000: 5.0}},
        {"parameters": {1601: 1.5}},
        {"parameters": {1601: 2.0**31}},
        {"parameter_ranges": {1601: Interval(0.5, 3.0)}},
        {"active_work": 1, "g92": {"x": exactly(11.0)}},
        {"active_work": 3, "g92": {"x": exactly(11.0)}, "work": {(3, "x"): Interval(0.0, 10.9)}},
    ],
    ids=str,
)
def test_what_this_controller_does_not_have_is_unknown(facts: dict[str, Any]) -> None:
    assert "GP630" in labels(run(["G00 X1"], setup=setup(**facts))[1])


@pytest.mark.parametrize(
    "facts",
    [
        {"transform": InForce()},
        {"transform": InForce(angle=360.0, factor_x=1.0, factor_y=1.0)},
        {"heads": {(1, "x"): exactly(0.0)}},
        {"tool_lengths": {1: exactly(0.0)}},
        {"inputs": {105: 1.0}},
        {"parameters": {601: 1.5, 1601: 2.0}},
        {"active_work": 1, "g92": {"x": exactly(10.0)}},
        {"active_work": 3, "g92": {"x": exactly(11.0)}},
        {"homed": ("x", "y", "z", "a", "b", "c")},
    ],
    ids=str,
)
def test_what_is_neutral_or_known_here_is_accepted(facts: dict[str, Any]) -> None:
    assert labels(run(["G00 X1"], setup=setup(**facts))[1]) == []


def test_of_the_machine_file_too() -> None:
    for change in ({"diameter_programming": True}, {"absolute_arc_centers": True}, {"turning": True}):
        on = machine()
        other: Machine = dataclasses.replace(on, controller=dataclasses.replace(on.controller, **change))
        assert "GP630" in labels(run(["G00 X1"], on=other)[1])
    assert "GP630" in labels(run(["G00 X1"], on=machine(foreign=("controls",)))[1])


def test_a_record_of_the_setup_is_before_that_of_the_machine_file() -> None:
    stated = setup(work={(1, "x"): exactly(100.0)})
    assert moves(run(["G90 G54", "G00 X1 Y1"], setup=stated)[0]) == [("TRAVERSE", 101, 21, 0)]


def test_the_record_that_is_in_force_at_the_start() -> None:
    """G92 in G91 adds to it (3.26); what [g92] states of an axis is before it."""
    stated = setup(OPEN, active_work=1)
    assert moves(run(["G90 G00 X1 Y1"], setup=stated)[0]) == [("TRAVERSE", 11, 21, 0)]
    assert moves(run(["G91 G92 X5", "G90 G00 X1"], setup=stated)[0]) == [("TRAVERSE", 16, 0, 0)]
    assert moves(run(["G90 G00 X1 Y1"], setup=setup(stated, g92={"x": exactly(10.0)}))[0]) == [("TRAVERSE", 11, 21, 0)]


@pytest.mark.parametrize(("line", "expected"), [
    ("M26 301", []), ("M27 300", []), ("M26 401", ["GP113"]), ("M27 900", ["GP113"]), ("M26 402", ["GP113"]),
])  # fmt: skip
def test_outputs_of_channels_that_the_axes_do_not_show(line: str, expected: list[str]) -> None:
    assert labels(run([line], on=LIMITED)[1]) == expected


def test_channels_of_the_board() -> None:
    for channels, expected in ((5, []), (4, ["GP296"])):
        on = dataclasses.replace(machine(channels=channels), axes=machine().axes[:3])
        assert labels(run(["M26 502", "M27 500"], on=on)[1]) == expected * 2
