"""Small programs of all dialects, run by the interpreter with nothing known, and compared."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from gproof.driver.dialects import DIALECTS, load_machine
from gproof.driver.running import execute
from gproof.frontend.common.frontend import Reading
from gproof.ir.finding import Findings
from gproof.ir.machine import Machine
from gproof.ir.setup import NOTHING
from gproof.ir.trace import Trace
from gproof.ir.translation_terms import TranslationTerms
from gproof.verify.translation.compare import compare
from gproof.verify.translation.comparison import Comparison

AXIS = '[axes.{}]\nkind = "{}"\nmin = -500.0\nmax = 500.0\nmax_velocity = 100.0\nmax_acceleration = 500.0\n'
AXES = "".join(AXIS.format(name, "linear") for name in "xyz") + AXIS.format("a", "rotary")
TOOLS = "[tools.2]\ndiameter = 6.0\nlength = 40.0\n[tools.3]\ndiameter = 6.0\nlength = 50.0\n"
MACHINES = {
    "eding": f'schema = "gproof-machine/1"\nunits = "mm"\n{AXES}{TOOLS}[controller]\ndialect = "eding"\n',
    "wincnc": f'schema = "gproof-machine/1"\nunits = "mm"\n{AXES}[controller]\ndialect = "wincnc"\n',
    "mcuwin": f'schema = "gproof-machine/1"\nunits = "mm"\n{AXES}[controller]\ndialect = "mcuwin"\n',
}
SUFFIX = {"eding": "cnc", "wincnc": "tap", "mcuwin": "src"}
STRAIGHT = TranslationTerms(source_straight=True, target_straight=True)


class Shop:
    """Runs programs in a folder of its own; machines and what was run once are kept."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.known: dict[tuple[str, str, str], Trace] = {}
        self.machines: dict[tuple[str, str], tuple[Path, Machine]] = {}

    def machine(self, dialect: str, more: str) -> tuple[Path, Machine]:
        if (dialect, more) not in self.machines:
            path = self.folder / f"machine{len(self.machines)}.toml"
            path.write_text(MACHINES[dialect] + more, encoding="utf-8")
            findings = Findings()
            machine, _ = load_machine(path, findings)
            assert machine is not None, findings.kept
            self.machines[dialect, more] = path, machine
        return self.machines[dialect, more]

    def trace(self, program: str, dialect: str = "eding", more: str = "") -> Trace:
        key = program, dialect, more
        if key not in self.known:
            job = self.folder / f"{len(self.known)}.{SUFFIX[dialect]}"
            job.write_text(program, encoding="utf-8")
            path, machine = self.machine(dialect, more)
            findings = Findings()
            reading = Reading(job=job, findings=findings, machine=machine, machine_file=path)
            read, its_machine = DIALECTS[dialect].frontend.load_program(reading)
            assert read is not None, findings.kept
            self.known[key] = execute(read, NOTHING, its_machine, findings)
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
