"""Jobs for LinuxCNC: proven or refused, and LinuxCNC's own interpreter makes the same moves of them.

The peer is Debian's interpreter (``tests/differential/rs274_peer.py``); it runs the printed text, with all digits, on
the machine of the job, and its moves are those of the source's Trace.
"""

from __future__ import annotations

import dataclasses
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from differential import rs274_peer
from support.campaigns import SOAK, share
from support.translations import CorpusJob, safe_jobs, translated

from gproof.driver.running import execute
from gproof.driver.session import Session, open_session
from gproof.ir.finding import Findings
from gproof.ir.setup import ZERO
from gproof.ir.trace import Op, Trace
from gproof.ir.verdict import Verdict

TOLERANCE = 1e-4
"""mm and degrees."""
JOBS = safe_jobs()

REFUSED = {
    "a cycle or a move that only this controller has", "asks the operator", "a command of this controller",
    "variable that the controller sets", "variable #", "Y mapped onto A", "height compensation",
    "cutter compensation", "tapping", "rotation of coordinates",
    "mirrored coordinates", "constant surface speed", "input that is read into a variable",
    "state of an input in an expression", "drilling cycle with repeats", "drilling cycle with a clearance of its own",
    "something that only this controller has", "words of one axis move another one", "question to the operator",
    "a place that only the controller knows", "work zero moved", "work zero brought back", "work zero at a machine",
    "F of arcs", "reference run", "jump to a label", "a software limit that the program sets", "TMX in braces",
    "Task 0 does something", "X.TP", "a place of X under a reflection", "variables that the controller keeps",
    "the axes move to the same place of the other workspace",
    "under a rotation, scaling or mirror",
    "words of a rotary axis are lengths", "an expression in two units", "scaling of coordinates",
}  # fmt: skip
"""Constructs of sources that LinuxCNC cannot have, or that have no neutral form: a refusal names one of them."""


@pytest.mark.parametrize("job", share(JOBS, 10), ids=str)
def test_a_job_is_proven_or_refused_by_name(job: CorpusJob) -> None:
    done = translated(job, "linuxcnc")
    said = [f"{finding.code.label} {finding.message}" for finding in done.findings.kept]
    if done.verdict is Verdict.SAFE:
        assert done.files
        return
    assert done.verdict is Verdict.UNKNOWN, said
    assert any(one.startswith("GP703") and any(name in one for name in REFUSED) for one in said), said


# ---- the peer


def source_moves(session: Session) -> list[tuple[str, tuple[float, ...]]]:
    """The moves of a job on its machine at zero, each with where it ends and, of an arc, its centre and sense."""
    assert session.program is not None
    overrides = dataclasses.replace(session.program, overrides={})
    delete = bool(session.setup.block_delete)
    setup = dataclasses.replace(ZERO, block_delete=delete)
    return moves_of(execute(overrides, setup, session.machine, Findings(), block_delete=delete))


def moves_of(trace: Trace) -> list[tuple[str, tuple[float, ...]]]:
    """Along the first way through a Trace."""
    found: list[tuple[str, tuple[float, ...]]] = []
    number, seen = 0, set[int]()
    before = np.array(trace.sections[0].start)
    while number >= 0 and number not in seen:
        seen.add(number)
        section = trace.sections[number]
        for row in range(len(section.rows)):
            op = Op(int(section.rows["op"][row]))
            to = section.rows["to"][row]
            if op >= 10 or (op is not Op.ARC and np.abs(to - before).max() < 1e-9):
                continue
            frame = trace.frames[int(section.rows["frame"][row])]
            assert not any(frame), "a place that is unknown"
            extra: tuple[float, ...] = ()
            if op is Op.ARC:
                axes = {1: (0, 1), 2: (0, 2), 3: (1, 2)}[int(section.rows["plane"][row])]
                center = section.rows["center"][row]
                extra = (*(float(center[axis]) for axis in axes), float(section.rows["turns"][row]))
            found.append((op.name.lower(), (*to.tolist(), *extra)))
            before = to
        number = section.edges[0].target if section.edges else -1
    return found


def peer_moves(text: bytes, session: Session, folder: Path) -> list[tuple[str, tuple[float, ...]]]:
    """What LinuxCNC's interpreter makes of a text, by its Python module."""
    program = folder / "job.ngc"
    program.write_bytes(text)
    lengths = {tool.number: (tool.length or 0.0, tool.diameter or 0.0) for tool in session.machine.tools}
    tools = {number: lengths.get(number, (0.0, 0.0)) for number in range(1, max([*lengths, 1]) + 1)}
    job = rs274_peer._job(folder, 0, program, rs274_peer.Situation(tools=tools))
    answer = rs274_peer._listen(folder, [job])[0]
    assert answer["error"] is None, f"line {answer['error_line']}: {answer['error']}"
    machine = rs274_peer._Machine([0, *sorted(tools)])
    for name, line, arguments in answer["calls"]:
        machine.take(name, line, arguments)
    return [move for row in machine.rows if (move := peer_move(row)) is not None]


def peer_move(row: dict[str, Any]) -> tuple[str, tuple[float, ...]] | None:
    """A row of the peer as a move."""
    if row["op"] not in ("traverse", "feed", "arc", "probe"):
        return None
    extra = (*row["center"], float(row["turns"])) if row["op"] == "arc" else ()
    return row["op"], (*(row["to"][axis] for axis in rs274_peer.AXES), *extra)


def without_rests(moves: list[tuple[str, tuple[float, ...]]]) -> list[tuple[str, tuple[float, ...]]]:
    """The peer's moves without those of no length."""
    found = []
    before: tuple[float, ...] = (0.0,) * 6
    for op, numbers in moves:
        if op == "arc" or any(not abs(a - b) < 1e-9 for a, b in zip(numbers[:6], before, strict=True)):
            found.append((op, numbers))
        before = numbers[:6]
    return found


PEER_CANNOT = {
    "an M6 while a tool length is in force moves Z in the module (rs274_peer.py says so)": {"tool-setter"},
}
"""Jobs that are left out of the comparison with the peer, by reason."""


def _for_the_peer() -> list[CorpusJob]:
    out = {name for names in PEER_CANNOT.values() for name in names}
    return [job for job in JOBS if job.dialect == "eding" and job.name not in out]


@pytest.mark.parametrize("job", share(_for_the_peer(), 8), ids=str)
def test_linuxcnc_makes_the_same_moves(job: CorpusJob, peer: None) -> None:
    done = translated(job, "linuxcnc", exact=True)
    if done.verdict is not Verdict.SAFE:
        # Which constructs those are, another test says; what is written and not proven has no place here.
        assert {one.code.label for one in done.findings.kept} <= {"GP703"}
        return
    session = open_session(job.job, machine=job.machine, setup=job.setup, dialect=job.dialect)
    with tempfile.TemporaryDirectory() as folder:
        theirs = without_rests(peer_moves(done.files[""], session, Path(folder)))
    same_moves(source_moves(session), theirs)


def same_moves(ours: list[tuple[str, tuple[float, ...]]], theirs: list[tuple[str, tuple[float, ...]]]) -> None:
    """All moves are the same within the tolerance."""
    for n, ((op, numbers), (other, said)) in enumerate(zip(ours, theirs, strict=False)):
        assert op == other, f"move {n}: {op} {numbers} and {other} {said}"
        assert numbers == pytest.approx(said, abs=TOLERANCE), f"move {n}: {op}"
    assert len(ours) == len(theirs)


assert SOAK or len(share(JOBS, 10)) < len(JOBS)
