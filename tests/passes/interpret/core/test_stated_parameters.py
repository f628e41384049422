"""Numbered parameters that a setup states (manual 3.1.1): their live value, until the machine makes another one."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest
from passes.interpret.core.programs import HEAD, codes_of, run_whole, shown

from gproof.ir.machine import NO_MACHINE, Tool
from gproof.ir.setup import NOTHING, ZERO, Interval

STATED = dataclasses.replace(
    NOTHING,
    parameters={5061: 3.0, 5067: 1.0, 5230: 0.0, 5391: 2.5, 5394: 24000.0},
    parameter_ranges={5068: Interval(0.0, 0.0), 5069: Interval(2.0, 9.0), 5392: Interval(-1.0, 1.0)},
)


@pytest.mark.parametrize(
    ("number", "value"), [(5061, 3.0), (5067, 1.0), (5068, 0.0), (5230, 0.0), (5391, 2.5), (5394, 24000.0)]
)
def test_a_stated_value_is_read(tmp_path: Path, number: int, value: float) -> None:
    trace, findings = run_whole(tmp_path, f"{HEAD}G53 G0 X#{number}\nM30\n", setup=STATED)
    assert codes_of(findings) == []
    assert [row[1] for row in shown(trace) if row[0] == "go"] == [value]


@pytest.mark.parametrize(("number", "ends"), [(5069, (2, 9)), (5392, (-1, 1))])
def test_stated_bounds_are_bounds(tmp_path: Path, number: int, ends: tuple[float, float]) -> None:
    trace, findings = run_whole(tmp_path, f"{HEAD}G53 G0 X#{number}\nM30\n", setup=STATED)
    assert codes_of(findings) == []
    assert [(s.low, s.high) for s in trace.symbols.values()] == [ends]


@pytest.mark.parametrize("number", [5062, 5068, 5069, 5230, 5391, 5394])
def test_what_nobody_stated_is_unknown(tmp_path: Path, number: int) -> None:
    trace, _ = run_whole(tmp_path, f"{HEAD}G53 G0 X#{number}\nM30\n", setup=NOTHING)
    assert trace.frames[int(trace.sections[-1].rows["frame"][-1])][0] != ()


def test_a_probe_takes_the_place_of_what_was_left(tmp_path: Path) -> None:
    setup = dataclasses.replace(ZERO, parameters={5061: 300.0, 5067: 1.0})
    trace, _ = run_whole(tmp_path, HEAD + "F50\nG0 X#5061\nG38.2 X310\nG0 X#5061\nM30\n", setup=setup)
    assert [row[1] for row in shown(trace) if row[0] == "go"][:1] == [300.0]
    assert [(s.low, s.high) for s in trace.symbols.values()][-1] != (300.0, 300.0)
    assert trace.symbols


def test_bounds_of_the_tool_table_are_not_passed_over(tmp_path: Path) -> None:
    """A diameter between 5 and 7 is not the machine file's 6, nor an X offset between 0 and 1 none at all."""
    machine = dataclasses.replace(NO_MACHINE, tools=(Tool(number=1, diameter=6.0),))
    ranges = {5501: Interval(5.0, 7.0), 5601: Interval(0.0, 1.0)}
    setup = dataclasses.replace(ZERO, parameter_ranges=ranges)
    _, findings = run_whole(tmp_path, HEAD + "G0 X0\nG41 D1\nG1 X20 F100\nG40\nM30\n", machine=machine, setup=setup)
    assert "GP255" in codes_of(findings)
    trace, _ = run_whole(tmp_path, HEAD + "T1 G43 H1\nG0 X5\nM30\n", machine=machine, setup=setup)
    assert trace.frames[int(trace.sections[-1].rows["frame"][-2])][0] != ()


def test_a_stated_range_is_stated(tmp_path: Path) -> None:
    """Read, it is no variable that nobody set (GP234); where one number is needed, that is what is said (GP225)."""
    setup = dataclasses.replace(ZERO, parameter_ranges={110: Interval(2.0, 6.0)})
    trace, findings = run_whole(tmp_path, f"{HEAD}#1 = #110\nG0 X#1 Y[#110 + 1]\nM30\n", setup=setup)
    assert codes_of(findings) == []
    assert [(round(s.low, 9), round(s.high, 9)) for s in trace.symbols.values()] == [(2.0, 6.0), (3.0, 7.0)]
    _, findings = run_whole(tmp_path, f"{HEAD}G1 X5 F#110\nM30\n", setup=setup)
    said = [f.message for f in findings.kept if f.code.label == "GP225"]
    assert not any("nobody stated" in message for message in said)
    _, findings = run_whole(tmp_path, f"{HEAD}M54 P#110\nM30\n", setup=setup)
    assert [f.message for f in findings.kept if f.code.label == "GP225"] == [
        "P depends on #110, whose limits are known but not its value"
    ]
    _, findings = run_whole(tmp_path, f"{HEAD}M54 P#111\nM30\n", setup=NOTHING)
    assert codes_of(findings) == ["GP234", "GP225"]
    assert "#111, whose value is unknown" in findings.kept[-1].message
