"""Jobs of the corpus for other controllers: the page is what comes out, and what is proven agrees at known zeros."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.campaigns import share
from support.known_zeros import at_known_zero
from support.translations import DIALECTS, PAGE, CorpusJob, machine_for, row, safe_jobs, targets_of, translated

from gproof.driver.dialects import DIALECTS as LANGUAGES
from gproof.driver.dialects import load_machine
from gproof.frontend.common.frontend import Reading
from gproof.ir.finding import Findings
from gproof.ir.setup import Setup
from gproof.ir.trace import Op, Trace
from gproof.ir.verdict import Verdict

JOBS = safe_jobs()


@pytest.mark.parametrize("job", share(JOBS, 12), ids=str)
def test_the_page_has_what_comes_out(job: CorpusJob) -> None:
    assert row(job) in PAGE.read_text(encoding="utf-8").splitlines(), "PYTHONPATH=tests python -m support.translations"


def test_every_job_has_a_row() -> None:
    rows = [line for line in PAGE.read_text(encoding="utf-8").splitlines() if line.startswith("| ")]
    assert len(rows) == len(JOBS) + 1


PAIRS = {1: (0, 1), 2: (2, 0), 3: (1, 2)}
"""Columns of the axes of a plane, so that counter-clockwise is from the first to the second."""


def arc(start: np.ndarray, end: np.ndarray, center: np.ndarray, turns: int, pair: tuple[int, int]) -> float:
    """The length of an arc or a helix."""
    u, v = pair
    begin, stop = (math.atan2(at[v] - center[v], at[u] - center[u]) for at in (start, end))
    sweep = (stop - begin) * (1 if turns > 0 else -1) % (2 * math.pi)
    sweep = (sweep if sweep > 1e-9 else 2 * math.pi) + (abs(turns) - 1) * 2 * math.pi
    rise = next(end[k] - start[k] for k in range(3) if k not in pair)
    return math.hypot(sweep * math.hypot(start[u] - center[u], start[v] - center[v]), rise)


def figures(trace: Trace) -> tuple[np.ndarray, float]:
    """Where a run ends and how far it goes: no code of the comparison."""
    length, last = 0.0, None
    for section in trace.sections:
        at = np.array(section.start[:3])
        rows = section.rows
        for n, op in enumerate(rows["op"].tolist()):
            to = rows["to"][n][:3]
            if op == Op.ARC:
                length += arc(at, to, rows["center"][n], int(rows["turns"][n]), PAIRS[int(rows["plane"][n])])
            elif op < Op.DWELL:
                length += float(np.linalg.norm(to - at))
            at = to if op < Op.DWELL else at
        last = at
    assert last is not None
    return last, length


@pytest.mark.parametrize("job", share(JOBS, 12), ids=str)
def test_what_is_proven_agrees_at_three_known_zeros(job: CorpusJob, tmp_path: Path) -> None:
    """Both programs are run by the interpreter alone."""
    for to in targets_of(job.dialect):
        if to not in DIALECTS:
            continue
        done = translated(job, to)
        if done.verdict is not Verdict.SAFE:
            continue
        session = done.session
        assert session.program is not None
        written = tmp_path / f"{to}-job{done.target.style.extension}"
        for name, text in done.files.items():
            (tmp_path / name if name else written).write_bytes(text)
        file = machine_for(job.machine, to)
        loaded, _ = load_machine(file, Findings())
        assert loaded is not None
        program, machine = LANGUAGES[to].frontend.load_program(
            Reading(job=written, findings=Findings(), machine=loaded, machine_file=file, read=[file])
        )
        assert program is not None
        for seed in range(3):
            stated: dict[str, Any] = {"lengths": done.lengths, "only": done.only}
            end, length = figures(
                at_known_zero(session.program, session.machine, session.setup, session, seed, **stated)
            )
            other_end, other_length = figures(at_known_zero(program, machine, Setup(), session, seed, **stated))
            assert np.allclose(end, other_end, atol=1e-3), (to, seed, end, other_end)
            assert abs(length - other_length) <= 1e-4 * max(length, 1.0) + 1e-2, (to, seed, length, other_length)
