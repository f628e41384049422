"""Jobs of the corpus for other controllers: how each is translated, and the page that lists what came of it."""

from __future__ import annotations

import contextlib
import tempfile
from functools import cache
from pathlib import Path

from corpus.expectations import expectation, jobs
from support.goldens import ROOT
from support.traps import machine_files

from gproof.driver.errors import UsageError
from gproof.driver.session import open_session
from gproof.driver.targets import TARGETS
from gproof.driver.translation import Translation, Wanted, raised, translate
from gproof.driver.translation_map import proposed
from gproof.ir.verdict import Verdict

DIALECTS = ("eding", "wincnc", "mcuwin")
PAGE = ROOT / "docs" / "translation-corpus.md"
NOT_WRITTEN = {"GP703": "refused", "GP704": "not the same", "GP705": "open"}


@cache
def safe_jobs() -> tuple[tuple[str, Path], ...]:
    """(dialect, job) of every job that `gproof check` calls SAFE."""
    return tuple(
        (dialect, job) for dialect in DIALECTS for job in jobs(dialect) if expectation(job)["verdict"] == "SAFE"
    )


def targets_of(dialect: str) -> list[str]:
    """The controllers that a job goes to."""
    return [name for name in TARGETS if name != dialect]


SHOP = {
    "CNC.MAC": "M3=M11C2\nM4=M11C1\nM5=M98 REST.MAC\nM6=M98 CHANGE.MAC\nM7=M11C4\nM8=M11C3\nM9=M98 DRY.MAC\n",
    "REST.MAC": "M12C1\nM12C2\n",
    "DRY.MAC": "M12C3\nM12C4\n",
    "CHANGE.MAC": "G53 Z0\nG4 [put it in]\nL101 T{t}\n",
}
"""A shop with WinCNC that has what the jobs use: the spindle both ways, mist and flood, a tool change by hand."""


@cache
def _machines() -> Path:
    """A folder with a machine of each controller that needs files of its own."""
    folder = Path(tempfile.mkdtemp())
    for dialect in DIALECTS:
        (folder / dialect).mkdir()
        for name, data in machine_files(dialect).items():
            (folder / dialect / name).write_bytes(data)
    for name, commands in SHOP.items():
        (folder / "wincnc" / name).write_text(commands)
    return folder


def machine_for(dialect: str, to: str) -> Path | None:
    """The machine file of the target; None: that of the source, whose axes and travel are the same."""
    folder = _machines() / to
    if to not in DIALECTS or to == "eding":
        return None
    return next(path for path in sorted(folder.iterdir()) if path.name in {"machine.toml", "WINCNC.INI", "McuWIN.ini"})


def translated(dialect: str, job: Path, to: str) -> Translation:
    """A job with the map that gproof proposes for it."""
    told = expectation(job)
    setup = told.get("setup")
    session = open_session(job, machine=Path(told["machine"]), setup=setup, dialect=dialect)
    given = None
    with contextlib.suppress(UsageError):
        given = proposed(raised(session), TARGETS[to].target())
    return translate(
        Wanted(
            job=job, to=to, machine=Path(told["machine"]), setup=setup, dialect=dialect, given=given,
            machine_to=machine_for(dialect, to),
        )
    )  # fmt: skip


def outcome(done: Translation) -> str:
    """In a cell of the page: ``proven``, or what keeps it from being so."""
    if done.verdict is Verdict.SAFE:
        return "proven"
    first = done.findings.kept[0]
    word = NOT_WRITTEN.get(first.code.label, first.code.label)
    what = first.message.partition(" cannot be translated")[0] if word == "refused" else ""
    return f"{word}: {what}".rstrip(": ").replace("|", "\\|")


def row(dialect: str, job: Path) -> str:
    """The row of a job."""
    name = job.parent.name if dialect == "eding" else f"{job.parents[1].name}/{job.stem}"
    cells = [outcome(translated(dialect, job, to)) if to != dialect else "–" for to in TARGETS]
    return f"| {dialect}: {name} | {' | '.join(cells)} |"


def page() -> str:
    """The whole page."""
    rows = [row(dialect, job) for dialect, job in safe_jobs()]
    cells = [cell.strip() for one in rows for cell in one.split("|")[2:-1] if cell.strip() != "–"]
    proven = sum(cell == "proven" for cell in cells)
    refused = sum(cell.startswith("refused") for cell in cells)
    head = f"""# Jobs of the corpus, translated

Every job of the [corpus](../corpus/README.md) that is SAFE, for each of the other controllers
([translation.md](translation.md)), with the map that gproof proposes. `PYTHONPATH=tests python -m support.translations`
writes this page; a share of its rows is checked in every run of the tests, all of them in `make soak`.

Of {len(cells)} translations {proven} are proven, {refused} are refused by a construct that is named, and
{len(cells) - proven - refused} are open or not the same; then nothing is written.

| job | {" | ".join(TARGETS)} |
|---|{"---|" * len(TARGETS)}
"""
    return head + "\n".join(rows) + "\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
