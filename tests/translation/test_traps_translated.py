"""gproof's own translations of the traps: what it calls proven does what the pages say, under both zeros.

The rows of the pages come from the manuals, so this is independent of the translator and of the validator. That a job
is refused or not proven is no matter here.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from support.traps import AXES, DIALECTS, MACHINE, READ, Case, cases, machine_files, placed
from translation.test_traps import TOLERANCE, setup_of, worded

from gproof.driver.running import begin
from gproof.driver.session import open_session
from gproof.driver.translation import Wanted, translate
from gproof.ir.finding import Findings
from gproof.ir.verdict import Verdict

from hand.compare import rows_of  # isort: skip

EXTENSIONS = {dialect: extension for extension, dialect in DIALECTS.items()}
MOTION = {"traverse", "feed", "arc", "dwell"}
NOT_COMPARED = {
    "arcs/plane-xz": "chords of an arc are other rows",
    "machine/m6-with-a-macro": "each machine's own macro changes the tool, which is printed",
}
"""Cases whose rows of motion may differ from those of the page, and why."""
PAIRS = [
    (case, to) for case in cases() for to in sorted(READ - {case.dialect(case.source)}) if case.name not in NOT_COMPARED
]


@pytest.fixture(scope="module")
def shop(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Machines, and what was translated."""
    folder = tmp_path_factory.mktemp("translated")
    for dialect in READ:
        (folder / dialect).mkdir()
        for name, data in machine_files(dialect).items():
            (folder / dialect / name).write_bytes(data)
    return folder


@pytest.mark.parametrize("case, to", PAIRS, ids=lambda one: one.name if isinstance(one, Case) else one)
def test_what_is_proven_does_what_the_page_says(case: Case, to: str, shop: Path) -> None:
    place = shop / case.name / to
    place.mkdir(parents=True)
    job, machine = case.written(case.source, place, alone=True)
    machine_to = shop / to / MACHINE[to]
    done = translate(Wanted(job=job, to=to, machine=machine, machine_to=machine_to, dialect=case.dialect(case.source)))
    if done.verdict is not Verdict.SAFE or not done.files:
        return
    written = place / f"written{EXTENSIONS[to]}"
    for name, text in done.files.items():
        (place / name if name else written).write_bytes(text)
    session = open_session(written, machine=machine_to, setup="zero", dialect=to)
    assert session.program is not None
    for setup in case.setups():
        run = begin(session.program, setup_of(setup, to), session.machine, Findings())
        rows = worded(rows_of(run, session.machine, (), written), dict(zip(AXES, setup["start"], strict=True)), to)
        wanted = [placed(row, setup) for row in case.rows(case.source) if fits(row, setup) and row["op"] != "left"]
        assert simple(rows, setup) == simple(wanted, setup)


def fits(row: dict[str, Any], setup: dict[str, Any]) -> bool:
    """Whether a row is there in a setup."""
    return all(setup.get(key) == value for key, value in row.get("when", {}).items())


def simple(rows: list[dict[str, Any]], setup: dict[str, Any]) -> list[tuple[Any, ...]]:
    """Moves and dwells as tuples; rapids of one direction in a row are one."""
    found: list[tuple[Any, ...]] = []
    at = list(setup["start"])
    for row in rows:
        if row["op"] == "stop" or (row["op"] == "dwell" and "seconds" not in row):
            found.append(("wait",))
        elif row["op"] == "dwell":
            found.append(("dwell", round(row["seconds"], 6)))
        elif row["op"] in MOTION:
            to = row["to"]
            here = tuple(_rounded(value) for value in to)
            if row["op"] == "traverse" and found and found[-1][0] == "traverse" and _onward(found[-1], at, to):
                found[-1] = ("traverse", here, found[-1][2])
            else:
                more = (tuple(map(_rounded, row["center"])), row["turns"]) if row["op"] == "arc" else (tuple(at),)
                found.append((row["op"], here, *more))
            at = list(to)
    return [one[:2] if one[0] in ("traverse", "feed") else one for one in found]


def _rounded(value: float) -> float:
    return round(value / TOLERANCE / 10) * TOLERANCE * 10


def _onward(before: tuple[Any, ...], at: list[float], to: list[float]) -> bool:
    """Whether a rapid goes on in the direction of the one before it."""
    ways = [[b - a for a, b in zip(before[2], at, strict=True)], [b - a for a, b in zip(at, to, strict=True)]]
    axes = [[n for n, way in enumerate(one) if abs(way) > TOLERANCE] for one in ways]
    return len(axes[0]) == 1 and axes[0] == axes[1] and ways[0][axes[0][0]] * ways[1][axes[0][0]] > 0
