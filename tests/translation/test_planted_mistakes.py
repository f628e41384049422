"""Mistakes planted in the neutral job of the traps: what is still called proven does what the page says.

A mistake may be harmless: a lost G54 at the start, the point of a rotation that only distances follow. So the
judge is the trace worked out by hand, not a list: proven, and another motion, is what must never be.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from support.traps import AXES, MACHINE, READ, Case, cases, machine_files, placed
from translation.planted import MISTAKES, planted
from translation.test_traps import setup_of, worded
from translation.test_traps_translated import EXTENSIONS, NOT_COMPARED, fits, simple

from gproof.driver import translation
from gproof.driver.running import begin
from gproof.driver.session import open_session
from gproof.ir.finding import Findings
from gproof.ir.verdict import Verdict

from hand.compare import rows_of  # isort: skip

MOST = 4
"""Cases that a mistake is planted in, spread over those that it touches."""


@pytest.fixture(scope="module")
def shop(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The machines."""
    folder = tmp_path_factory.mktemp("planted")
    for dialect in READ:
        (folder / dialect).mkdir()
        for name, data in machine_files(dialect).items():
            (folder / dialect / name).write_bytes(data)
    return folder


@pytest.fixture(scope="module")
def jobs(shop: Path) -> dict[str, tuple[Case, Path, Path, object]]:
    """Each case that has a neutral job: the case, its program, its machine, the job."""
    found: dict[str, tuple[Case, Path, Path, object]] = {}
    for case in cases():
        place = shop / case.name
        place.mkdir(parents=True)
        program, machine = case.written(case.source, place, alone=True)
        session = open_session(program, machine=machine, setup=None, dialect=case.dialect(case.source))
        if session.program is not None and case.name not in NOT_COMPARED:
            found[case.name] = case, program, machine, translation.raised(session)
    return found


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_refused_or_harmless(
    name: str, jobs: dict[str, tuple[Case, Path, Path, object]], shop: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    touched = [
        (case, program, machine, wrong)
        for case, program, machine, job in jobs.values()
        if (wrong := planted(job, MISTAKES[name])) != job
    ]
    refused = 0
    for case, program, machine, wrong in touched[:: max(1, len(touched) // MOST)]:
        monkeypatch.setattr(translation, "raised", lambda session, wrong=wrong: wrong)
        for to in sorted(READ - {case.dialect(case.source)}):
            machine_to = shop / to / MACHINE[to]
            wanted = translation.Wanted(
                job=program, to=to, machine=machine, machine_to=machine_to, dialect=case.dialect(case.source)
            )
            done = translation.translate(wanted)
            if done.verdict is not Verdict.SAFE or not done.files:
                refused += 1
                continue
            place = shop / f"{name}-{to}" / case.name
            place.mkdir(parents=True)
            written = place / f"written{EXTENSIONS[to]}"
            for inner, text in done.files.items():
                (place / inner if inner else written).write_bytes(text)
            session = open_session(written, machine=machine_to, setup="zero", dialect=to)
            assert session.program is not None
            for setup in case.setups():
                run = begin(session.program, setup_of(setup, to), session.machine, Findings())
                start = dict(zip(AXES, setup["start"], strict=True))
                rows = worded(rows_of(run, session.machine, (), written), start, to)
                wanted_rows = [placed(r, setup) for r in case.rows(case.source) if fits(r, setup) and r["op"] != "left"]
                assert simple(rows, setup) == simple(wanted_rows, setup), (name, case.name, to)
    assert refused


def test_a_lost_zero_of_an_axis_that_rests_is_refused(
    jobs: dict[str, tuple[Case, Path, Path, object]], shop: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No move shows it, only the next job: which axes are compared at the end must not come from the neutral job."""
    _, program, machine, job = jobs["zeros/zero-of-an-axis-that-rests"]
    wrong = planted(job, MISTAKES["frame-lost"])
    monkeypatch.setattr(translation, "raised", lambda session: wrong)
    machine_to = shop / "wincnc" / MACHINE["wincnc"]
    wanted = translation.Wanted(job=program, to="wincnc", machine=machine, machine_to=machine_to, dialect="eding")
    assert translation.translate(wanted).verdict is Verdict.UNSAFE
