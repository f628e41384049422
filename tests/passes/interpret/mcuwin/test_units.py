"""G00, G92 and qualifiers count in the axis's own unit (manual 3.1), which the machine's file states for each axis."""

from __future__ import annotations

import dataclasses

from passes.interpret.mcuwin.mcuwin_programs import labels, machine, moves, program, run

from gproof.driver.running import begin
from gproof.ir.dialects.mcuwin.settings import USUAL
from gproof.ir.finding import Findings
from gproof.ir.machine import Machine
from gproof.ir.setup import ZERO


def inch_x() -> Machine:
    """X counts in inches, the others say nothing."""
    plain = machine()
    axes = (dataclasses.replace(plain.axes[0], position_unit=25.4), *plain.axes[1:])
    return dataclasses.replace(plain, axes=axes)


def test_rapids_count_in_the_unit_of_each_axis() -> None:
    trace, findings = run(["G00 X1 Y1", "G01 X2 Y2 F100", "G91", "G00 X1"], on=inch_x())
    assert moves(trace) == [("TRAVERSE", 25.4, 1, 0), ("FEED", 2, 2, 0), ("TRAVERSE", 27.4, 2, 0)]
    assert labels(findings) == []


def test_offsets_of_an_axis_in_another_unit_than_that_of_interpolation_are_not_known() -> None:
    _, findings = run(["G92 X1", "G00 X1"], on=inch_x())
    assert labels(findings)[0] == "GP276"
    trace, findings = run(["G70", "G92 X1", "G00 X1"], on=inch_x())
    assert moves(trace) == [("TRAVERSE", 50.8, 0, 0)]
    assert labels(findings) == []


def test_limits_too() -> None:
    assert labels(run(["G99 X1"], on=inch_x())[1]) == ["GP302"]
    assert labels(run(["G70", "G99 X1"], on=inch_x())[1]) == []


def test_what_no_file_states_is_an_assumption_of_the_report() -> None:
    for unstated in (tuple(USUAL), ()):
        ex = begin(program(["G00 X1", "M30"]), ZERO, machine(unstated=unstated), Findings())
        for _ in ex.chunks():
            pass
        assert set(USUAL.values()) & set(ex.assumed) == {USUAL[key] for key in unstated if key != "tool_file"}
