"""Jobs of the corpus for other controllers: how each is translated, and the page that lists what came of it."""

from __future__ import annotations

import contextlib
import tempfile
from dataclasses import dataclass
from functools import cache, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from corpus.expectations import expectation, jobs
from support.goldens import ROOT
from support.target_machines import machine_like

if TYPE_CHECKING:
    from gproof.driver.translation import Translation

DIALECTS = ("eding", "wincnc", "mcuwin")
OTHERS = ("linuxcnc", "grbl")
PAGE = ROOT / "docs" / "translation-corpus.md"
NOT_WRITTEN = {"GP703": "refused", "GP704": "not the same", "GP705": "open"}


@dataclass(frozen=True)
class CorpusJob:
    """A job that `gproof check` calls SAFE. setup: a file, ``zero`` or None."""

    name: str
    dialect: str
    job: Path
    machine: Path
    setup: str | None

    def __str__(self) -> str:
        return self.name


@cache
def safe_jobs() -> tuple[CorpusJob, ...]:
    """All of them, those of Eding CNC by their folders, others by shop and name."""
    return tuple(
        _job(dialect, job) for dialect in DIALECTS for job in jobs(dialect) if expectation(job)["verdict"] == "SAFE"
    )


def _job(dialect: str, job: Path) -> CorpusJob:
    told = expectation(job)
    name = job.parent.name if dialect == "eding" else f"{job.parents[1].name}/{job.stem}"
    return CorpusJob(name, dialect, job, Path(told["machine"]), told.get("setup"))


def targets_of(dialect: str) -> list[str]:
    """The controllers that a job goes to."""
    return [name for name in (*DIALECTS, *OTHERS) if name != dialect]


@cache
def machine_for(machine: Path, to: str) -> Path:
    """The machine file of the target: a machine like the source's."""
    return machine_like(machine, to, Path(tempfile.mkdtemp()))


@lru_cache(maxsize=32)
def translated(job: CorpusJob, to: str, *, exact: bool = False) -> Translation:
    """A job with the map that gproof proposes for it, on a machine like its own."""
    from gproof.driver.errors import UsageError
    from gproof.driver.session import open_session
    from gproof.driver.targets import TARGETS
    from gproof.driver.translation import Wanted, raised, translate
    from gproof.driver.translation_map import proposed

    session = open_session(job.job, machine=job.machine, setup=job.setup, dialect=job.dialect)
    given = None
    with contextlib.suppress(UsageError):
        given = proposed(raised(session), TARGETS[to].target())
    return translate(
        Wanted(
            job=job.job, to=to, machine=job.machine, setup=job.setup, dialect=job.dialect, exact=exact, given=given,
            machine_to=machine_for(job.machine, to),
        )
    )  # fmt: skip


def outcome(done: Translation) -> str:
    """In a cell of the page: ``proven``, or what keeps it from being so."""
    if done.verdict.value == "SAFE":
        return "proven"
    first = done.findings.kept[0]
    word = NOT_WRITTEN.get(first.code.label, first.code.label)
    what = first.message.partition(" cannot be translated")[0] if word == "refused" else ""
    return f"{word}: {what}".rstrip(": ").replace("|", "\\|")


def row(job: CorpusJob) -> str:
    """The row of a job."""
    cells = [outcome(translated(job, to)) if to != job.dialect else "–" for to in (*DIALECTS, *OTHERS)]
    return f"| {job.dialect}: {job.name} | {' | '.join(cells)} |"


def page() -> str:
    """The whole page."""
    rows = [row(job) for job in safe_jobs()]
    cells = [cell.strip() for one in rows for cell in one.split("|")[2:-1] if cell.strip() != "–"]
    proven = sum(cell == "proven" for cell in cells)
    refused = sum(cell.startswith("refused") for cell in cells)
    head = f"""# Jobs of the corpus, translated

Every job of the [corpus](../corpus/README.md) that is SAFE, for each of the other controllers
([translation.md](translation.md)), with the map that gproof proposes. `PYTHONPATH=tests python -m support.translations`
writes this page; a share of its rows is checked in every run of the tests, all of them in `make soak`.

Of {len(cells)} translations {proven} are proven, {refused} are refused by a construct that is named, and
{len(cells) - proven - refused} are open or not the same; then nothing is written.

| job | {" | ".join((*DIALECTS, *OTHERS))} |
|---|{"---|" * len((*DIALECTS, *OTHERS))}
"""
    return head + "\n".join(rows) + "\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
