"""Reflections: which zero they are about, both of two readings, and jobs that are mirrored by mistake (3.9 to 3.13).

Places are worked out by hand: with an offset o and a word w, the offset's zero gives o - w, the machine's -(o + w).
"""

from __future__ import annotations

import dataclasses

import pytest
from passes.interpret.mcuwin.mcuwin_programs import labels, machine, moves, run

from gproof.ir.finding import Findings
from gproof.ir.machine import Axis, AxisKind
from gproof.ir.setup import ZERO, Interval
from gproof.ir.trace import Trace, chunks
from gproof.ir.verdict import Verdict
from gproof.passes.checks.limits.soft_limits import Limits


def ends(trace: Trace, row: int, axis: int = 0) -> tuple[float, float]:
    """Where a moving row may end, by what the trace says of its unknowns."""
    rows = [(s, n) for s in trace.sections for n in range(len(s.rows)) if s.rows["op"][n] < 10]
    section, n = rows[row]
    low = high = float(section.rows["to"][n][axis])
    for symbol, count in trace.frames[int(section.rows["frame"][n])][axis]:
        known = trace.symbols[symbol]
        low, high = low + min(known.low * count, known.high * count), high + max(known.low * count, known.high * count)
    return low, high


@pytest.mark.parametrize(
    ("lines", "places"),
    [
        (["G92 X20", "G22", "G00 X10"], [(-30, 10)]),
        (["G92 X20", "G22", "G00 X-10"], [(-10, 30)]),
        (["G92 X-20", "G22", "G00 X10"], [(-30, 10)]),
        (["G54", "G22", "G00 X5", "G00 X6"], [(-15, 5), (-16, 4)]),
        # A factor of 2: 20 + 2 * 5, or 2 * (20 + 5).
        (["G92 X20", "G22", "G39 X2", "G00 X5"], [(30, 50)]),
        # Distances from there count the same way in both.
        (["G92 X20", "G22", "G00 X10", "G91 G00 X5"], [(-30, 10), (-35, 5)]),
        # Off again, and without an offset: exact.
        (["G92 X20", "G22", "G00 X10", "G24", "G00 X10"], [(-30, 10), (30, 30)]),
        (["G22", "G00 X10"], [(-10, -10)]),
        (["G92 Y20", "G22", "G00 X10"], [(-10, -10)]),
    ],
)
def test_both_zeros_are_followed(lines: list[str], places: list[tuple[float, float]]) -> None:
    trace, findings = run(["G90", *lines, "G24"])
    assert labels(findings) == []
    assert [ends(trace, n) for n in range(len(places))] == places


def test_arcs_keep_their_shape() -> None:
    trace, findings = run(["G90 G92 X20 Y7", "G23", "G01 X10 Y0 F100", "G02 X20 Y0 I5 J0", "G24"])
    assert labels(findings) == []
    assert moves(trace)[-1][0] == "ARC"
    assert ends(trace, 1) == (-40, 0)


def test_an_offset_that_nobody_knows_stays_open() -> None:
    setup = dataclasses.replace(ZERO, default_offset=None, active_work=None)
    assert "GP276" in labels(run(["G90 G22", "G00 X5", "G24"], setup=setup)[1])


@pytest.mark.parametrize(
    ("low", "high", "verdict"),
    [(-50, 50, Verdict.SAFE), (-50, 0, Verdict.UNKNOWN), (-20, 50, Verdict.UNKNOWN), (20, 50, Verdict.UNSAFE)],
)
def test_limits_hold_for_both(low: float, high: float, verdict: Verdict) -> None:
    """From X25 to 10 or to -30."""
    axes = [Axis(name=n, kind=AxisKind.LINEAR, lower=-200.0, upper=200.0) for n in "yz"]
    on = dataclasses.replace(machine(), axes=(Axis(name="x", kind=AxisKind.LINEAR, lower=low, upper=high), *axes))
    start = {"x": Interval(-20.0 if high == 0 else 25.0, -20.0 if high == 0 else 25.0)}
    setup = dataclasses.replace(ZERO, start=start)
    trace, _ = run(["G90 G92 X20", "G22", "G00 X10", "G24"], setup=setup, on=on)
    check = Limits(on, setup, Findings())
    for chunk in chunks(trace):
        check.feed(chunk)
    assert check.finish().verdict is verdict


@pytest.mark.parametrize(
    ("lines", "expected"),
    [
        (["G90 G21", "G00 X1"], ["GP169"]),
        (["G21", "G90", "G00 X1", "G00 Y5"], ["GP169"]),
        (["G22", "G00 X1"], ["GP169"]),
        (["G23", "G00 X1"], ["GP169"]),
        # Meant: after a move, switched off, or with a factor of its own.
        (["G00 X1", "G21", "G00 Y1"], []),
        (["G21", "G00 Y1", "G24"], []),
        (["G21", "G39 Y-2", "G00 Y1"], []),
        (["G21", "G24", "G00 Y1"], []),
        (["G21"], []),
    ],
)
def test_a_job_that_is_mirrored_as_a_whole_is_reported(lines: list[str], expected: list[str]) -> None:
    assert labels(run(lines)[1]) == expected


def test_it_is_reported_at_the_code_and_once() -> None:
    _, findings = run(["G21", ("if", "IN5 == 1", ["G00 X9"]), "G00 X1"])
    assert [f.message.split()[0] for f in findings.kept if f.code.number == 169] == ["G21"]
