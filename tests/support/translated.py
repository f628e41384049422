"""Jobs of the corpus, and what ``gproof translate`` makes of them."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from support.bundles import ROOT

if TYPE_CHECKING:
    from gproof.driver.translation import Translation

CORPUS = ROOT / "corpus"
MACHINES = ("machine.toml", "WINCNC.INI", "McuWIN.ini")


@dataclass(frozen=True)
class CorpusJob:
    """A job that is SAFE on its own machine. setup: a file, ``zero`` or None."""

    name: str
    dialect: str
    job: Path
    machine: Path | None
    setup: str | None

    def __str__(self) -> str:
        return self.name


def eding_jobs() -> list[CorpusJob]:
    """Those of ``corpus/eding``, a folder each."""
    root = CORPUS / "eding"
    found = []
    for name, said in _expected(root):
        places = root / name, root

        def file(wanted: str | None, places: tuple[Path, ...] = places) -> Path | None:
            return next((folder / wanted for folder in places if wanted and (folder / wanted).is_file()), None)

        setup = said.get("setup")
        stated = setup if setup == "zero" else file(setup)
        found.append(
            CorpusJob(name, "eding", root / name / "job.cnc", file(said.get("machine")), stated and str(stated))
        )  # fmt: skip
    return found


def shop_jobs(dialect: str) -> list[CorpusJob]:
    """Those of the shops of ``corpus/wincnc`` or ``corpus/mcuwin``."""
    found = []
    for shop in sorted(path for path in (CORPUS / dialect).iterdir() if path.is_dir()):
        for name, said in _expected(shop):
            jobs = [path for path in (shop / "jobs").iterdir() if name in (path.name, path.stem)]
            machine = said.get("machine") or next((m for m in MACHINES if (shop / m).exists()), None)
            setup = said.get("setup") or ("setup.toml" if (shop / "setup.toml").exists() else None)
            if jobs and machine:
                stated = setup if setup in (None, "zero") else str(shop / setup)
                found.append(CorpusJob(f"{shop.name}/{name}", dialect, jobs[0], shop / machine, stated))
    return found


def _expected(folder: Path) -> Iterator[tuple[str, dict[str, str]]]:
    said = tomllib.loads((folder / "expect.toml").read_text())
    yield from ((name, one) for name, one in said.items() if isinstance(one, dict) and one.get("verdict") == "SAFE")


@cache
def translated(job: CorpusJob, to: str, *, exact: bool = False) -> Translation:
    """The job for another controller, with the map that gproof proposes, on a machine like its own."""
    from gproof.driver.session import open_session
    from gproof.driver.targets import TARGETS
    from gproof.driver.translation import Wanted, raised, translate
    from gproof.driver.translation_map import proposed

    session = open_session(job.job, machine=job.machine, setup=job.setup, dialect=job.dialect)
    given = proposed(raised(session), TARGETS[to].target())
    return translate(
        Wanted(
            job=job.job, to=to, machine=job.machine, setup=job.setup, dialect=job.dialect, exact=exact, given=given
        )
    )  # fmt: skip
