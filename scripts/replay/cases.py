"""The programs that are compared, each with the machine and setup that its own tests judge it with.

All of ``corpus/``, ``docs/codes``, ``tests/hand`` and ``tests/differential``: jobs, and the files that jobs call too
(each is a program by itself). Imports nothing of gproof: both revisions get the same cases.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))

from corpus.expectations import expected  # noqa: E402
from support.bundles import BUILT, unpacked  # noqa: E402

from corpus import pages  # noqa: E402  (tests/ is on the path only now)

SUFFIXES = {"eding": (".cnc",), "wincnc": (".tap", ".nc", ".mac"), "mcuwin": (".src", ".din", ".inc")}
MACHINES = {"eding": ("machine.toml", "cnc.ini"), "wincnc": ("WINCNC.INI",), "mcuwin": ("machine.toml",)}
COMMON = ("--dialect", "--max-blocks", "--max-branches", "--call")
"""Options that every command takes; others are the check's own."""


@dataclass(frozen=True)
class Case:
    """One program with what it is judged with.

    name: unique, as the report says it; options: for every command; check: more for ``check``.
    """

    name: str
    dialect: str
    program: Path
    machine: Path | None
    setup: str | None
    options: tuple[str, ...] = field(default=())
    check: tuple[str, ...] = field(default=())

    def words(self) -> list[str]:
        """Program, machine, setup and options of a command line."""
        words = [str(self.program)]
        if self.machine is not None:
            words += ["--machine", str(self.machine)]
        if self.setup is not None:
            words += ["--setup", self.setup]
        return words + list(self.options)


def all_cases() -> list[Case]:
    """Every program once, or once for each of its pages' runs; sorted by name."""
    found = [*of_corpus(), *of_pages(), *of_hand(), *of_differential()]
    assert len({case.name for case in found}) == len(found), "two cases of one name"
    return sorted(found, key=lambda case: case.name)


def dialect_of(program: Path) -> str | None:
    """The language that a file's suffix says; None: it is no program."""
    for dialect, suffixes in SUFFIXES.items():
        if program.suffix.lower() in suffixes:
            return dialect
    return None


def _name(program: Path) -> str:
    """Its path in the tree, or in the folders that pages stand for."""
    root = BUILT / program.relative_to(BUILT).parts[0] if program.is_relative_to(BUILT) else ROOT
    return program.relative_to(root).as_posix()


def _stated(folder: Path, setup: str) -> str:
    return setup if setup == "zero" else str(folder / setup)


def of_corpus() -> Iterator[Case]:
    """Jobs as their table says; files that jobs call with the machine of their shop, homed at zero."""
    for program in sorted((ROOT / "corpus").rglob("*")):
        dialect = dialect_of(program)
        if dialect is None:
            continue
        options = ("--dialect", dialect)
        told = expected(program)
        if told is None:
            yield Case(_name(program), dialect, program, _machine_above(program, dialect), "zero", options)
        else:
            yield Case(_name(program), dialect, program, Path(told["machine"]), told.get("setup"), options)


def _machine_above(program: Path, dialect: str) -> Path | None:
    for folder in program.parents:
        if folder == ROOT:
            return None
        for name in MACHINES[dialect]:
            if (folder / name).is_file():
                return folder / name
    return None


def of_pages() -> Iterator[Case]:
    """The bad and the good run of each page and controller (tests/corpus/pages.py)."""
    for folder in pages.FOLDERS:
        for dialect in pages.dialects(folder):
            for side in ("bad", "good"):
                run = pages.settings(folder, dialect, side)
                options, check = _divided(run["options"])
                setup = None if run["setup"] == "none" else _stated(folder, run["setup"])
                name = f"docs/codes/{folder.name}/{side} ({dialect})"
                yield Case(name, dialect, folder / run["program"], folder / run["machine"], setup, options, check)


def _divided(options: list[str]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Those that every command takes, and those of the check."""
    common: list[str] = []
    others: list[str] = []
    for word, value in pairwise([*options, ""]):
        if word in COMMON:
            common += [word, value]
        elif word == "--also":
            others += [word, value]
    return tuple(common), tuple(others)


def of_hand() -> Iterator[Case]:
    """Programs worked out by hand from the manuals, on their shop's machine, homed at zero."""
    for dialect in ("wincnc", "mcuwin"):
        for program in sorted((unpacked("tests/hand") / dialect).rglob("*")):
            if dialect_of(program) == dialect:
                machine = _machine_above(program, dialect)
                yield Case(_name(program), dialect, program, machine, "zero", ("--dialect", dialect))


def of_differential() -> Iterator[Case]:
    """Programs that are held against LinuxCNC's interpreter, those that it refuses too."""
    folder = unpacked("tests/differential")
    for program in sorted(folder.rglob("*.ngc")):
        yield Case(_name(program), "eding", program, folder / "machine.toml", "zero", ("--dialect", "eding"))
