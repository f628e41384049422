"""A random program for a controller: its files, the machines of both sides, its translation and the one back."""

from __future__ import annotations

import random
import tempfile
from dataclasses import replace
from functools import cache
from pathlib import Path

from support.traps import MACHINE, machine_files

from gproof.driver.session import open_session
from gproof.driver.targets import TARGETS
from gproof.driver.translation import Translation, Wanted, raised, translate
from gproof.driver.translation_map import proposed
from gproof.ir.translation_map import TranslationMap

from . import eding, mcuwin, wincnc
from .writer import Made

WRITERS = {"eding": eding.program, "wincnc": wincnc.program, "mcuwin": mcuwin.program}
DIRECTIONS = [(one, other) for one in WRITERS for other in (*WRITERS, "linuxcnc", "grbl") if one != other]

CANNOT: dict[tuple[str, str], frozenset[str]] = {
    ("eding", "wincnc"): frozenset({"reverse", "else", "work", "plane_arc", "optional", "scaled", "limit", "bored"}),
    ("eding", "mcuwin"): frozenset({"length", "wait", "scaled", "machine", "bored"}),
    ("eding", "linuxcnc"): frozenset({"asked", "scaled"}),
    ("eding", "grbl"): frozenset({"asked", "scaled", "wait", "output", "optional"}),
    ("wincnc", "eding"): frozenset({"moving", "expression", "array"}),
    ("wincnc", "mcuwin"): frozenset({"wait", "expression", "array", "machine", "tool"}),
    ("wincnc", "linuxcnc"): frozenset({"asked", "expression", "array", "shifted", "placed", "kept"}),
    ("wincnc", "grbl"): frozenset({"asked", "expression", "array", "shifted", "placed", "kept", "output", "wait"}),
    ("mcuwin", "eding"): frozenset({"output", "placed"}),
    ("mcuwin", "wincnc"): frozenset({"reverse", "work", "optional", "else"}),
    ("mcuwin", "linuxcnc"): frozenset({"asked", "placed", "shifted"}),
    ("mcuwin", "grbl"): frozenset({"asked", "placed", "shifted", "output", "optional"}),
}
"""Kinds of statements that a controller cannot have: one program in eight has them all the same."""
SHOP = {
    "CNC.MAC": "M3=M11C2\nM4=M11C1\nM5=M98 REST.MAC\nM6=M98 CHANGE.MAC\nM7=M11C4\nM8=M11C3\nM9=M98 DRY.MAC\n",
    "REST.MAC": "M12C1\nM12C2\n",
    "DRY.MAC": "M12C3\nM12C4\n",
    "CHANGE.MAC": "G53 Z0\nG4 [put it in]\nL101 T{t}\n",
}
"""A shop with WinCNC: the spindle both ways, mist and flood, a tool change by hand [Macro File Configuration]."""
TOOLS = "".join(
    f"[Tools{plane}]\n" + "".join(f"R{n}=0,0\nL{n}=0,0\n" for n in range(4)) for plane in ("XY", "YZ", "ZX")
)
OUTPUTS = "".join(f"auxout=C{n} P7 B{n - 1} O0 S0 E0\n" for n in (6, 7))


@cache
def machines() -> Path:
    """A folder with a machine of each controller, of equal axes, travel and tools."""
    folder = Path(tempfile.mkdtemp())
    for dialect in WRITERS:
        (folder / dialect).mkdir()
        for name, data in machine_files(dialect).items():
            (folder / dialect / name).write_bytes(data)
    for name, commands in SHOP.items():
        (folder / "wincnc" / name).write_text(commands)
    with (folder / "wincnc" / "WINCNC.INI").open("a") as file:
        file.write(OUTPUTS)
    machine = folder / "mcuwin" / MACHINE["mcuwin"]
    machine.write_text(machine.read_text().replace('tool_file = ""', 'tool_file = "ToolComp.INI"'))
    (folder / "mcuwin" / "ToolComp.INI").write_text(TOOLS)
    return folder


def machine_of(dialect: str) -> Path:
    """The machine file of a controller; LinuxCNC and grbl take gproof's own."""
    own = dialect if dialect in WRITERS else "eding"
    return machines() / own / MACHINE[own]


def made(dialect: str, to: str, seed: int) -> Made:
    """The program of a seed."""
    rng = random.Random(f"{dialect} {to} {seed}")
    # Outputs of the shop turn the spindle: its M4 does not end what M3 has begun.
    always = CANNOT[dialect, to] & {"reverse"}
    without = always if rng.random() < 0.125 else CANNOT[dialect, to]
    return WRITERS[dialect](rng, without)


def written(job: Made, folder: Path, name: str = "job") -> Path:
    """The files of a program; its own."""
    for inner, text in job.files.items():
        (folder / inner).write_text(text)
    path = folder / f"{name}{job.extension}"
    path.write_text(job.text)
    return path


def mapped(job: Path, dialect: str, to: str) -> TranslationMap:
    """The numbers of a job as themselves; McuWIN's channels are those of axis 1 (4.11)."""
    session = open_session(job, machine=machine_of(dialect), setup=None, dialect=dialect)
    given = proposed(raised(session), TARGETS[to].target())
    by = 100 * ((to == "mcuwin") - (dialect == "mcuwin"))
    return replace(
        given, outputs={n: n + by for n in given.outputs}, inputs={n: n + by for n in given.inputs},
    )  # fmt: skip


def translated(job: Path, dialect: str, to: str, *, exact: bool) -> Translation:
    """A job for another controller."""
    return translate(
        Wanted(
            job=job, to=to, machine=machine_of(dialect), dialect=dialect, machine_to=machine_of(to), exact=exact,
            given=mapped(job, dialect, to),
        )
    )  # fmt: skip
