"""Jobs of the corpus to another controller and back: the same path, and not much longer."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support.campaigns import share
from support.known_zeros import at_known_zero
from support.translations import DIALECTS, CorpusJob, machine_for, safe_jobs, targets_of, translated

from gproof.driver.session import open_session
from gproof.driver.targets import TARGETS
from gproof.driver.translation import Translation, Wanted, raised, translate
from gproof.driver.translation_map import proposed
from gproof.ir.setup import Setup
from gproof.ir.trace import Op, Trace
from gproof.ir.verdict import Verdict

LONGER = 1.2
EXACT = 1e-6
NEAR = 2.1 * 0.5e-4
"""mm: half the last digit, once for each way; two for the rounding of sums."""
PROGRAMS = (".cnc", ".ngc", ".tap", ".mac", ".src", ".inc")
LOST = ("cycle", "grid", "routine", "choice", "while", "count_loop", "variable", "expression", "arc_", "frame_")
"""Features whose loss makes a program longer: it has no loops on the way, or its holes are moves."""


def there_and_back(job: CorpusJob, to: str, folder: Path, *, exact: bool = False) -> tuple[Translation, Translation]:
    """Both translations; the second one is not proven where the first is not."""
    there = translated(job, to, exact=exact)
    if there.verdict is not Verdict.SAFE:
        return there, there
    written = folder / f"{job.job.stem}{there.target.style.extension}"
    for name, text in there.files.items():
        (folder / name if name else written).write_bytes(text)
    machine = machine_for(job.machine, to)
    given = proposed(
        raised(open_session(written, machine=machine, setup=None, dialect=to)), TARGETS[job.dialect].target()
    )
    back = Wanted(
        job=written, to=job.dialect, machine=machine, machine_to=job.machine, dialect=to, given=given, exact=exact
    )
    return there, translate(back)


def places(trace: Trace) -> np.ndarray:
    """Ends of moves that move, one after the other."""
    found = []
    for section in trace.sections:
        rows = section.rows
        found += [np.array(section.start[:3]), *rows["to"][rows["op"] < Op.DWELL][:, :3]]
    path = np.array(found)
    path = path[np.r_[True, np.abs(np.diff(path, axis=0)).max(axis=1) > NEAR]]
    # A cycle lifts in one move what is two moves elsewhere: what lies straight between its neighbours is left out.
    ways = np.diff(path, axis=0)
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    return path[np.r_[True, (ways[:-1] * ways[1:]).sum(axis=1) < 1.0 - 1e-12, True]]


def size(files: dict[str, bytes]) -> int:
    """Characters of the lines, without blanks and comments."""
    return sum(len("".join(line.split())) for text in files.values() for line in text.decode("latin-1").splitlines())


@pytest.mark.parametrize(
    ("job", "exact"), share([(job, exact) for job in safe_jobs() for exact in (False, True)], 24), ids=str
)
def test_there_and_back(job: CorpusJob, exact: bool, tmp_path: Path, record_property: pytest.RecordProperty) -> None:
    for to in (name for name in targets_of(job.dialect) if name in DIALECTS):
        (tmp_path / to).mkdir()
        there, back = there_and_back(job, to, tmp_path / to, exact=exact)
        if back.verdict is not Verdict.SAFE or there is back:
            continue
        session = there.session
        assert session.program is not None
        again = tmp_path / to / f"again{back.target.style.extension}"
        for name, text in back.files.items():
            (tmp_path / to / name if name else again).write_bytes(text)
        program = open_session(again, machine=job.machine, setup=None, dialect=job.dialect).program
        assert program is not None
        first = places(
            at_known_zero(session.program, session.machine, session.setup, session, 1, lengths=there.lengths)
        )
        last = places(at_known_zero(program, session.machine, Setup(), session, 1, first=there.only))
        lost = {one.feature for done in (there, back) for one in done.lowered if one.feature.startswith(LOST)}
        if not any(one.pattern == "arc -> chords" for one in there.lowered):
            assert first.shape == last.shape, (to, first.shape, last.shape)
            if there.lengths:
                # They are in the zero of the controller on the way: all but machine places is higher by one length.
                apart = first[:, 2] - last[:, 2]
                last[:, 2] += np.where(np.abs(apart) > NEAR, apart[np.abs(apart).argmax()], 0.0)
            record_property(
                "figures", f"{job} {to}{' exact' if exact else ''}: drift {np.abs(first - last).max():.2g} mm"
            )
            assert np.abs(first - last).max() <= (EXACT if exact else NEAR), to
        if not lost and not exact:
            files = [one for one in session.program.files if Path(one.name).suffix.lower() in PROGRAMS]
            own = {one.name: bytes(one.data) for one in files if Path(one.name).name != "CNC.MAC"}
            assert size(back.files) <= LONGER * size(own), (to, size(own), size(back.files))
