"""The pairs of ``tests/translation/traps``: pages read as cases, rows of a trace put into the places of a setup.

Imports nothing of gproof: the rows come from the manuals. ``translation/traps/README.md`` says what a case holds.
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

from support.bundles import ROOT, Section, sections

FOLDER = ROOT / "tests" / "translation" / "traps"
DIALECTS = {".tap": "wincnc", ".cnc": "eding", ".din": "mcuwin", ".ngc": "linuxcnc", ".nc": "grbl"}
"""Controllers by the extension of their programs."""
READ = {"wincnc", "eding", "mcuwin"}
"""Those whose programs gproof reads."""
MACHINE = {"wincnc": "WINCNC.INI", "eding": "machine.toml", "mcuwin": "machine.toml"}
AXES = "xyz"
SETUPS: tuple[dict[str, Any], ...] = (
    {"start": [0.0, 0.0, 0.0], "work": [100.0, 80.0, -30.0], "second": [210.0, -15.0, -42.0]},
    {"start": [7.0, -3.0, -1.0], "work": [-40.5, 25.25, -12.0], "second": [33.75, 12.5, 4.0]},
)
"""Where the axes are and where the work zeros of G54 and G55 are, machine mm: no number of a case fits both."""
_PLACE = re.compile(r"(?P<origin>[msv]?) ?(?P<number>-?[0-9.]+)")
_ORIGINS = {"": "work", "s": "start", "v": "second"}


@dataclass(frozen=True, eq=False)
class Case:
    """A trap: its name (page and heading), its texts, and its files by name."""

    name: str
    section: Section = field(repr=False)

    def programs(self, role: str) -> list[str]:
        """Names of the programs of a role: ``source``, ``target`` or ``wrong``."""
        found = [name for name in self.section.files if Path(name).suffix in DIALECTS and "/" not in name]
        return [name for name in found if name.partition(".")[0].partition("-")[0] == role]

    @property
    def source(self) -> str:
        """The name of the source program."""
        return self.programs("source")[0]

    def side(self, program: str) -> str:
        """Whose machine and files a program has: ``source``, or ``target``, of which wrong ones are also."""
        return "source" if program.startswith("source.") else "target"

    def dialect(self, program: str) -> str:
        """The controller that reads a program."""
        return DIALECTS[Path(program).suffix]

    def rows(self, program: str) -> list[dict[str, Any]]:
        """The rows that a program must give, ``to`` and ``center`` as written."""
        name = f"{self.side(program)}.jsonl"
        text = self.section.files.get(name, self.section.files["source.jsonl"])
        return [json.loads(line) for line in text.decode().splitlines()]

    @property
    def unproven(self) -> str:
        """Why a validator cannot prove the pair, "" where it must."""
        return self.section.said("Proof: none: ")

    def leaves(self) -> bool:
        """Whether the page says what is left for the next job."""
        return any(row["op"] == "left" for row in self.rows(self.source))

    def setups(self) -> list[dict[str, Any]]:
        """Every setup that the case runs under: both zeros, with each of its own states."""
        stated = self.section.said("Setup: ").strip("`")
        states = json.loads(stated) if stated else [{}]
        return [setup | state for setup in SETUPS for state in (states if isinstance(states, list) else [states])]

    def written(self, program: str, folder: Path, *, alone: bool = False) -> tuple[Path, Path]:
        """A program, its machine and the files it calls, written into a folder: (program, machine file).

        alone: without the next job that shows what is left.
        """
        side, dialect = self.side(program), self.dialect(program)
        called = {n.partition("/")[2]: data for n, data in self.section.files.items() if n.startswith(f"{side}/")}
        files = machine_files(dialect) | called | {program: self.section.files[program]}
        name = MACHINE[dialect]
        said = self.section.said(f"{side.capitalize()} machine: ")
        files[name] = changed(files[name].decode(), said).encode()
        job = Path(program)
        if self.leaves() and not alone:
            job, files = followed(dialect, program, files)
        for inner, data in files.items():
            (folder / inner).write_bytes(data)
        return folder / job, folder / name


def followed(dialect: str, program: str, files: dict[str, bytes]) -> tuple[Path, dict[str, bytes]]:
    """A job and a next one that goes to its zero, as one program, and its files.

    WinCNC gives the zero back at the end of a file, a called one too (M98); Eding CNC by no end (3.5.1).
    """
    if dialect == "wincnc":
        return Path("NEXT.TAP"), files | {"NEXT.TAP": f"M98 {program}\nG22\nG90\nG0 X0 Y0 Z0\n".encode()}
    if dialect == "eding":
        text = files[program].decode().removesuffix("M30\n")
        return Path(program), files | {program: f"{text}G21 G90 G94 G0 X0 Y0 Z0\nM30\n".encode()}
    raise ValueError(f"what {dialect} leaves for the next job is open")


def changed(text: str, said: str) -> str:
    """A machine file with the changes of a case. ValueError: a text to replace is not there once."""
    for change in (part.strip() for part in said.split("; ") if part.strip()):
        added = re.fullmatch(r"`\+ (.*)`", change)
        if added:
            text = f"{text.rstrip()}\n{added[1]}\n"
            continue
        pair = re.fullmatch(r"`(.*?)` → `(.*)`", change)
        if pair is None or text.count(pair[1]) != 1:
            raise ValueError(f"a change of a machine that fits nothing: {change}")
        text = text.replace(pair[1], pair[2])
    return text


@cache
def machine_files(dialect: str) -> dict[str, bytes]:
    """The files of the plain machine of a controller."""
    found: dict[str, bytes] = {}
    for section in sections((FOLDER / "machines.md").read_text("utf-8")):
        prefix = f"{dialect}/"
        found |= {name.removeprefix(prefix): data for name, data in section.files.items() if name.startswith(prefix)}
    return found


def cases() -> list[Case]:
    """All cases, page by page."""
    found: list[Case] = []
    for page in sorted(FOLDER.glob("*.md")):
        if page.name in {"README.md", "machines.md"}:
            continue
        for section in sections(page.read_text("utf-8")):
            if any(name.startswith("source.") for name in section.files):
                found.append(Case(f"{page.stem}/{section.heading}", section))
    return found


def placed(row: dict[str, Any], setup: dict[str, Any]) -> dict[str, Any]:
    """A row with ``to`` and ``center`` in machine millimetres; ``left`` as the move of a next job to its zero."""
    if row["op"] == "left":
        row = {"op": "traverse", "to": row["zero"]}
    plane = row.get("plane", "XY").lower()
    letters = {"to": AXES, "center": plane}
    return row | {
        key: [_machine(place, AXES.index(letter), setup) for place, letter in zip(row[key], letters[key], strict=True)]
        for key in letters
        if key in row
    }


def _machine(place: float | str, axis: int, setup: dict[str, Any]) -> float:
    found = _PLACE.fullmatch(str(place))
    if found is None:
        raise ValueError(f"no place: {place}")
    origin = _ORIGINS.get(found["origin"])
    return float(found["number"]) + (setup[origin][axis] if origin else 0.0)
