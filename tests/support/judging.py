"""A job judged inside this process, the way `gproof check` composes it, so that thousands of runs take seconds."""

from __future__ import annotations

from pathlib import Path

from gproof.driver.judge import Judgement, judge
from gproof.driver.session import Running, open_session
from gproof.ir.verdict import PropertyResult

UNBOUNDED = 10**9


def judged(job: Path, machine: Path | None, setup: str | None, *, budget: int = UNBOUNDED) -> Judgement:
    """The judgement of a job in a file; ``setup`` is a path, ``zero`` or None."""
    session = open_session(job, machine=machine, setup=setup, dialect="eding")
    return judge(session, running=Running(budget))


def answer(judgement: Judgement, name: str) -> PropertyResult:
    """The result of one property."""
    return next(result for result in judgement.properties if result.name == name)
