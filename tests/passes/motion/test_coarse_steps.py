"""Slow feeds at coarse resolutions: the first step comes long after the motion began, and is no excess of feed."""

from __future__ import annotations

from fractions import Fraction

import pytest
from passes.motion.traces import Path, machine, validate

from gproof.ir.finding import Findings
from gproof.ir.setup import NOTHING
from gproof.ir.verdict import Verdict
from gproof.passes.motion.plan import plan
from gproof.passes.motion.step import step


@pytest.mark.parametrize("steps", [Fraction(40, 3), Fraction(10), Fraction(100)])
@pytest.mark.parametrize("feed", [20.0, 60.0, 300.0])
def test_slow_circles_and_lines_are_no_excess_of_feed(steps: Fraction, feed: float) -> None:
    the_machine = machine(steps=steps)
    for path in (
        Path(y=0.5).arc(feed, -1, (1, 0.5), y=0.5),
        Path().feed(feed, x=1.0).dwell(0.5).feed(feed, x=0.0, y=0.3),
        Path(x=3.0).arc(feed, 1, (0, 0), x=-3.0).dwell(0.1).arc(feed, 1, (0, 0), x=3.0),
    ):
        trace = path.done()
        findings = Findings()
        planned = plan(trace, the_machine, findings)
        assert planned is not None, findings.kept
        stream = step(trace, planned, the_machine, findings)
        assert stream is not None, findings.kept
        report = validate(stream, trace, the_machine, NOTHING)
        wrong = [f for f in report.findings if f.code.number not in (801, 808, 810)]
        assert wrong == [], [f.message for f in wrong]
        assert report.verdict is Verdict.SAFE or report.findings
