"""How much of gproof has to be trusted when a stream is proved again, counted in a fresh process.

The process is handed Trace, StepStream and Drives, and loads what proves and what these are made of. ``CODE`` is how
many lines of code these modules may have at most, executed or not: a function that no right stream enters counts too.
The same files have ``LINES`` lines at most with docstrings, comments and blank ones; it was 5,935 of these, and later
7,229, when what proves was not apart from what it says and from all that is known of a machine.

With numba its loader comes to that, and numba itself, which is why there is ``--pure``. The jobs have what a right
stream can have: arcs, events, many sections, slaves, backlash, pitch tables, a height map, a cylinder.
"""

from __future__ import annotations

import ast
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from passes.motion.traces import Path as Traced
from passes.motion.traces import ended
from passes.motion.traces import machine as plain
from support.goldens import ROOT
from verify.jobs import JOBS
from verify.reference_stepper import machine, step, stream_of
from verify.trusted_base import Proved, count

from gproof.ir.drives import Drives
from gproof.ir.machine import Machine, Slave
from gproof.ir.machine_drives import drives_of
from gproof.ir.setup import NOTHING, Setup
from gproof.ir.stream import StepStream
from gproof.ir.trace import Trace
from gproof.ir.verdict import Verdict
from gproof.verify.explain import stream_words, walk_words
from gproof.verify.explain.stream_report import BOUNDS
from gproof.verify.kernel.proof import PROPERTIES
from gproof.verify.kernel.prove import prove
from gproof.verify.stream import validate
from passes.geometry import test_backlash as backlash
from passes.motion import test_cylinder as cylinder
from passes.motion import test_height_compensation as maps
from verify.kernel import test_motor_map as pitch

CODE, LINES = 3300, 4450
LOADER = 350
"""Lines of code that come to that with numba."""

READS = {"columns", "stream", "trace", "drives", "verdict", "record", "kernel", "kernel_declared", "end_state"}
"""What the kernel is made of in ir/: the stages, Drives, verdicts, and how records and kernels are declared."""

Job = tuple[StepStream, Trace, Machine, Setup]


@pytest.fixture(scope="module")
def jobs() -> list[Job]:
    on = machine()
    made: list[Job] = [
        (stream_of(step(job, on), on), job.trace(), on, NOTHING) for job in (JOBS[n]() for n in ("arcs", "events"))
    ]
    loose, there_and_back = backlash.loose(x=0.05), Traced(x=10).feed(600, x=9.6).end_section().feed(600, x=9.7).done()
    made.append((backlash.lowered(there_and_back, loose)[1], ended(there_and_back), loose, NOTHING))
    bent = pitch.with_x(pitch=pitch.MANUAL, slaves=(Slave(),))
    along = Traced().feed(6000, x=0.5).feed(6000, x=0.1).whole()
    made.append((pitch.lowered(along, bent), along, bent, NOTHING))
    path = Traced(x=1, y=1).state(following=maps.ON).feed(600, x=1.5, y=1.2).arc(600, 1, (1.6, 1.2), x=1.7, y=1.2)
    hill, over = maps.using(maps.SADDLE), path.feed(600, z=0.1).done()
    made.append((maps.lowered(over, hill, plain()), ended(over), plain(), hill))
    round_it = Traced(y=1).feed(600, y=2, x=0.5).done()
    made.append((cylinder.lowered(round_it, plain())[1], ended(round_it), plain(), cylinder.ON_CUP))
    return made


def proved(jobs: list[Job], folder: Path, *, pure: bool) -> Proved:
    given: list[tuple[StepStream, Trace, Drives]] = [(s, t, drives_of(on, setup)) for s, t, on, setup in jobs]
    found = count(given, folder, pure=pure)
    assert found.verdicts == ("SAFE",) * len(jobs)
    return found


@pytest.fixture(scope="module")
def pure(jobs: list[Job], tmp_path_factory: pytest.TempPathFactory) -> Proved:
    """In plain Python; one process for all tests that count."""
    return proved(jobs, tmp_path_factory.mktemp("pure"), pure=True)


def test_the_trusted_base_is_small(pure: Proved) -> None:
    found, total = pure, pure.total()
    assert total.code <= CODE and total.all <= LINES, "\n".join(f"{n} {k}" for k, n in found.lines.items())
    assert total.executed > CODE / 2, "most of it is what these jobs need"
    outside = {name for name in found.lines if not name.startswith("gproof.verify.kernel")}
    assert outside == {"gproof.ir", "gproof.verify", *(f"gproof.ir.{name}" for name in READS)}
    assert not {"numba", "llvmlite"} & found.modules


def test_with_numba_its_loader_comes_to_that(
    jobs: list[Job], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:  # fmt: skip
    monkeypatch.setenv("GPROOF_KERNELS", "numba")
    found = proved(jobs[:1], tmp_path, pure=False)
    assert "numba" in found.modules
    assert found.total().code <= CODE + LOADER


def test_pages_say_the_figures(pure: Proved) -> None:
    """Those of docs/verification.md are not more than a hundred lines off."""
    total = pure.total()
    page = (ROOT / "docs" / "verification.md").read_text(encoding="utf-8")
    said = re.search(r"about ([\d,]+) lines of\s+code in files of ([\d,]+) lines", page)
    assert said is not None
    assert [
        abs(int(one.replace(",", "")) - real) < 100
        for one, real in zip(said.groups(), (total.code, total.all), strict=True)
    ]


def answers(job: Job, **options: Any) -> list[object]:
    report = validate(*job, **options)
    return [report.findings, report.counts, report.properties, report.steps]


def test_plain_python_says_the_same(jobs: list[Job]) -> None:
    """Of right streams, and of those whose first motor makes a step less."""
    for job in jobs:
        assert answers(job, pure=True) == answers(job)
        runs = job[0].sections[0].runs
        longest = max(range(len(runs)), key=lambda m: len(runs[m]))
        section = job[0].sections[0]
        section.runs = tuple(r.slice(0, len(r) - 1) if m == longest else r for m, r in enumerate(runs))
        assert answers(job, pure=True) == answers(job)
        assert answers(job)[1]
        section.runs = runs


def test_words_change_no_verdict(jobs: list[Job]) -> None:
    """Of the whole; one of two properties has a step that is off the path."""
    assert tuple(BOUNDS) == PROPERTIES
    for stream, trace, on, setup in jobs:
        for motor, table in enumerate(stream.sections[0].runs):
            if len(table):
                table["direction"][len(table) // 2] *= -1
                proof, report = prove(stream, trace, drives_of(on, setup)), validate(stream, trace, on, setup)
                assert proof.verdict is report.verdict is Verdict.UNSAFE, motor
                own = {name for name in PROPERTIES if proof.verdict_of(name) is not Verdict.SAFE}
                assert {p.name for p in report.properties if p.verdict is not Verdict.SAFE} == own
                table["direction"][len(table) // 2] *= -1


def test_progress_is_told_often_in_plain_python(jobs: list[Job]) -> None:
    """A slice of the compiled walk would take a minute."""
    heard: list[int] = []
    steps = validate(*jobs[0], pure=True, beat=heard.append).steps
    assert heard[-1] == steps
    assert len(heard) > 1 and max(np.diff([0, *heard])) <= 1 << 12


def kinds_given() -> set[str]:
    """Every kind that the kernel gives, from its source."""
    found: set[str] = set()
    for file in sorted((ROOT / "verify" / "kernel").glob("*.py")):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                found |= set(re.findall(r"^[a-z]+\.[a-z-]+$", node.value))
    return found


def test_there_is_a_sentence_for_each_kind_and_no_more() -> None:
    tables = (
        stream_words.FORM, stream_words.GRAPH, stream_words.ROWS, stream_words.EVENTS, stream_words.BETWEEN,
        stream_words.REMARKS, walk_words.WALK,
    )  # fmt: skip
    assert kinds_given() == {*(kind for table in tables for kind in table), "walk.left", "open.travel"}
