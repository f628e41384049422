"""Small programs of all dialects, run by the interpreter with nothing known, and compared."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from gproof.driver.running import execute
from gproof.driver.session import open_session
from gproof.ir.finding import Findings
from gproof.ir.setup import NOTHING
from gproof.ir.trace import Trace
from gproof.ir.translation_terms import TranslationTerms
from gproof.verify.translation.compare import compare
from gproof.verify.translation.comparison import Comparison

AXIS = '[axes.{}]\nkind = "{}"\nmin = -500.0\nmax = 500.0\nmax_velocity = 100.0\nmax_acceleration = 500.0\n'
AXES = "".join(AXIS.format(name, "linear") for name in "xyz") + AXIS.format("a", "rotary")
MACHINES = {
    "eding": f'schema = "gproof-machine/1"\nunits = "mm"\n{AXES}[controller]\ndialect = "eding"\n',
    "wincnc": f'schema = "gproof-machine/1"\nunits = "mm"\n{AXES}[controller]\ndialect = "wincnc"\n',
    "mcuwin": f'schema = "gproof-machine/1"\nunits = "mm"\n{AXES}[controller]\ndialect = "mcuwin"\n',
}
SUFFIX = {"eding": "cnc", "wincnc": "tap", "mcuwin": "src"}
STRAIGHT = TranslationTerms(source_straight=True, target_straight=True)


class Shop:
    """Runs programs in a folder of its own; what was run once is kept."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.known: dict[tuple[str, str, str], Trace] = {}

    def trace(self, program: str, dialect: str = "eding", machine: str = "") -> Trace:
        key = program, dialect, machine
        if key not in self.known:
            number = len(self.known)
            job = self.folder / f"{number}.{SUFFIX[dialect]}"
            job.write_text(program, encoding="utf-8")
            of = self.folder / f"machine{number}.toml"
            of.write_text(MACHINES[dialect] + machine, encoding="utf-8")
            session = open_session(job, machine=of, setup=None, dialect=dialect)
            assert session.program is not None, session.findings.kept
            self.known[key] = execute(session.program, NOTHING, session.machine, Findings())
        return self.known[key]

    def compared(
        self,
        one: str | tuple[str, ...],
        other: str | tuple[str, ...],
        terms: TranslationTerms = STRAIGHT,
        **options: Any,
    ) -> Comparison:
        sides = [(side,) if isinstance(side, str) else side for side in (one, other)]
        return compare(self.trace(*sides[0]), self.trace(*sides[1]), terms, **options)
