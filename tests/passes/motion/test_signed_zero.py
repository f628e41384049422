"""A full circle that starts at minus zero: its angles come out as -pi and pi, and it turns once all the same."""

from __future__ import annotations

import pytest
from passes.motion.traces import Path, machine, validate

from gproof.ir.finding import Findings
from gproof.ir.setup import NOTHING
from gproof.ir.verdict import Verdict
from gproof.passes.motion.plan import plan
from gproof.passes.motion.step import step


@pytest.mark.parametrize("turns", [1, -1])
def test_circle_from_minus_zero(turns: int) -> None:
    trace = Path().arc(600.0, turns, (1, 0), y=0.0).done()
    section = trace.sections[0]
    section.start = (0.0, -0.0, *section.start[2:])
    findings = Findings()
    planned = plan(trace, machine(), findings)
    assert planned is not None, findings.kept
    stream = step(trace, planned, machine(), findings)
    assert stream is not None, findings.kept
    report = validate(stream, trace, machine(), NOTHING)
    assert report.verdict is Verdict.SAFE, [f.message for f in report.findings]
