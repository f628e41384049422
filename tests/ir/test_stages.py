"""Every stage of real jobs prints and parses back to the same value, and holds its own invariants."""

from __future__ import annotations

from pathlib import Path

import pytest
from corpus.expectations import expectation

from gproof.cli.dump import loaded
from gproof.driver.pipeline import lower
from gproof.driver.session import Running, open_session
from gproof.ir.text import parse_ir, print_ir

CORPUS = Path(__file__).parents[2] / "corpus" / "eding"
JOBS = ["thread-milling", "parametric-bolt-circle", "nested-contours", "operator-stops"]


@pytest.mark.parametrize("name", JOBS)
def test_stages_of_a_job_round_trip(name: str) -> None:
    job = CORPUS / name / "job.cnc"
    session = open_session(job, machine=Path(expectation(job)["machine"]), setup="zero", dialect=None)
    assert session.program is not None
    lowered = lower(session, Running(10**6), "stream")
    assert lowered.plan is not None and lowered.stream is not None
    program = loaded(session.program)
    for value in (program, lowered.trace, lowered.plan, lowered.stream, session.machine, session.setup):
        again = parse_ir(print_ir(value))
        assert again == value
        if hasattr(again, "verify"):
            again.verify()
