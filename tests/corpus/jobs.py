"""Where a job of the corpus has its machine and its setup, and the job as a stream that the validator has accepted.

Names are ``eding/drilled-plate``, ``wincnc/plasma/flange`` and ``mcuwin/engraver/wave``.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from corpus.expectations import CORPUS, SUFFIX, expectation, jobs

from gproof.backend.job import CertifiedJob
from gproof.driver.pipeline import Lowered, lower
from gproof.driver.session import Running, Session, open_session
from gproof.ir.machine import Machine
from gproof.ir.verdict import Verdict
from gproof.verify.stream import validate


def job_of(name: str) -> tuple[Path, dict]:
    """The program, and what ``expect.toml`` says of it."""
    dialect, shop, *job = name.split("/")
    inside = f"jobs/{job[0]}{SUFFIX[dialect]}" if job else "job.cnc"
    program = CORPUS / dialect / shop / inside
    return program, expectation(program)


def all_jobs(verdict: str = "SAFE") -> list[str]:
    """Names of the jobs that are expected to end so."""
    names = [f"eding/{path.parent.name}" for path in jobs("eding")]
    for dialect in ("wincnc", "mcuwin"):
        names += [f"{dialect}/{path.parents[1].name}/{path.stem}" for path in jobs(dialect)]
    return sorted(name for name in names if job_of(name)[1]["verdict"] == verdict)


def lowered(name: str, other: Callable[[Machine], Machine] = lambda same: same) -> tuple[Session, Lowered]:
    """A job's session and stages, as far as it gets; other: the machine, changed."""
    program, expected = job_of(name)
    session = open_session(
        program,
        machine=Path(expected["machine"]),
        setup=expected.get("setup", "zero"),
        dialect=name.split("/", maxsplit=1)[0],
    )
    session.machine = other(session.machine)
    return session, lower(session, Running(1_000_000), "stream")


def compiled(name: str) -> CertifiedJob | None:
    """None: there is no stream that the validator accepts (offsets that nobody stated, say)."""
    session, stages = lowered(name)
    if stages.stream is None:
        return None
    if validate(stages.stream, stages.trace, session.machine, session.setup).verdict is not Verdict.SAFE:
        return None
    return CertifiedJob(
        name=name.rsplit("/", maxsplit=1)[-1],
        certificate="00" * 32,
        trace=stages.trace,
        machine=session.machine,
        setup=session.setup,
        stream=stages.stream,
    )
