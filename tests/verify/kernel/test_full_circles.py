"""Full circles end to end, wherever they start: a signed zero must not make one vanish or double."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from gproof.driver.pipeline import lower
from gproof.driver.session import Running, open_session
from gproof.ir.verdict import Verdict
from gproof.verify.stream import validate

MACHINE = """
schema = "gproof-machine/1"
name = "circles"
units = "mm"
[axes.x]
kind = "linear"
steps_per_unit = 100
min = -50.0
max = 50.0
max_velocity = 100.0
max_acceleration = 500.0
[axes.y]
kind = "linear"
steps_per_unit = 100
min = -50.0
max = 50.0
max_velocity = 100.0
max_acceleration = 500.0
[axes.z]
kind = "linear"
steps_per_unit = 100
min = -50.0
max = 50.0
max_velocity = 100.0
max_acceleration = 500.0
[controller]
dialect = "eding"
"""


@pytest.mark.parametrize("code", ["G2", "G3"])
@pytest.mark.parametrize(
    ("start", "end", "center"),
    [
        ("X10 Y-0.0", "X10 Y0", "I-10"),
        ("X-10 Y-0.0", "X-10 Y0", "I10"),
        ("X-10 Y0", "X-10 Y-0.0", "I10"),
        ("X-0.0 Y10", "X0 Y10", "J-10"),
        ("X0 Y-10", "X-0.0 Y-10", "J10"),
    ],
)
def test_a_full_circle_turns_once(tmp_path: Path, code: str, start: str, end: str, center: str) -> None:
    machine, job = tmp_path / "machine.toml", tmp_path / "job.cnc"
    machine.write_text(MACHINE)
    job.write_text(f"G21 G17 G90 G94 G54 G40 G49 G80 G61\nG0 {start}\n{code} {end} {center} F600\nM30\n")
    session = open_session(job, machine=machine, setup="zero", dialect=None)
    lowered = lower(session, Running(1000), "stream")
    assert lowered.stream is not None
    report = validate(lowered.stream, lowered.trace, session.machine, session.setup)
    assert report.verdict is Verdict.SAFE, report.findings
    # There and back twice the diameter on each axis, and the way to the start.
    assert [m.steps_per_unit for m in lowered.stream.motors][:2] == [Fraction(100)] * 2
    steps = [int(r["count"].sum()) for r in lowered.stream.sections[0].runs]
    assert sum(steps[:2]) == 2 * 4 * 1000 + 1000
