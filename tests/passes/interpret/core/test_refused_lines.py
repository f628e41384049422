"""A line that was refused moves the axes without a row: what follows starts where it sent them, not before it."""

from __future__ import annotations

from pathlib import Path

import pytest
from metamorphic.jobs import Job, run

from gproof.ir.verdict import Verdict

HEAD = "G21 G90 G17 G40 G49 G80 G94 G98 G69 G50 G54 F100\n"
LIMITS = {"x": (-45.0, 5.0), "y": (-10.0, 10.0), "z": (-100.0, 100.0), "a": (-1.0, 1.0)}
TURN = "G91\nG2 X-10 Y0 I-5\nG3 X10 Y0 I5\nG90\n"
"""Half a turn to X-40 and back, where X is -30: arcs of 5, at most 5 away from Y0."""


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("G81 X-30 R5 Z-5\nG80", "GP304"),  # the height before the cycle rests on an unknown offset
        ("G1 X-30 D5", "GP121"),
        ("G1 X-30 F-1", "GP241"),
        ("G0 X-30 Z#4000\nG80\nG82 X-30 R#4000 Z-5 P1\nG80", "GP225"),
    ],
)
def test_an_arc_behind_it_has_its_own_radius(line: str, told: str, tmp_path: Path) -> None:
    start = {"x": 0.0, "y": 0.0, "z": None, "a": 0.0}
    job = Job(f"{HEAD}{line}\n{TURN}M2\n", LIMITS, start=start)  # type: ignore[arg-type]
    judged = run(tmp_path, job)
    labels = {f.code.label for f in judged.judgement.findings.kept}
    assert told in labels, judged.told()
    assert not labels & {"GP401", "GP301", "GP303"}, judged.told()
    assert judged.answer("limits") is not Verdict.UNSAFE


def test_a_refused_cycle_ends_nobody_knows_where(tmp_path: Path) -> None:
    # G98 would go back to a height that is not known: nothing below tells how far Z then goes.
    start = {"x": 0.0, "y": 0.0, "z": None, "a": 0.0}
    job = Job(f"{HEAD}G81 X-30 R5 Z-90\nG80\nG91 G1 Z-20\nG90\nM2\n", LIMITS, start=start)  # type: ignore[arg-type]
    judged = run(tmp_path, job)
    assert judged.answer("limits") is Verdict.UNKNOWN, judged.told()
    assert judged.verdict is Verdict.UNKNOWN, judged.told()
