"""The property sense: does the program say what its author meant? Wanted by ``--also sense``.

What is read off the program without running it (``sense_program``, ``sense_flow``), units that do not fit the machine
(``sense_units``), and lines of another controller's language. Nothing here breaks a tool by itself: findings are
warnings and notes, and the property is SAFE unless the job could not be followed. docs/cutting-sense.md has the rules.
"""

from __future__ import annotations

import bisect
from collections import Counter

import numpy as np

from gproof.ir import codes
from gproof.ir.dialects.looks import LOOKS
from gproof.ir.finding import Finding, Findings, Severity, Span
from gproof.ir.machine import Machine
from gproof.ir.program import Program, SourceFile
from gproof.ir.rules import Function as F
from gproof.ir.setup import Setup
from gproof.ir.trace import Chunk, Op
from gproof.ir.trace_rows import row_span
from gproof.ir.verdict import PropertyResult
from gproof.passes.checks.aggregate import answer
from gproof.passes.checks.base import Check
from gproof.passes.checks.lint.program_structure import Written
from gproof.passes.checks.lint.unit_evidence import UnitEvidence
from gproof.passes.checks.tooling.cutting_rows import CutRows, Floats, StateColumn

_UNITS = frozenset((F.UNITS_INCH, F.UNITS_MM, F.UNITS_CM))
_LEAST_LINES = 2


class Sense(Check):
    """See the module's text."""

    name = "sense"

    def __init__(self, program: Program, machine: Machine, setup: Setup, findings: Findings) -> None:
        super().__init__(machine, setup, findings)
        self._program = program
        self._rows = CutRows(program)
        self._evidence = UnitEvidence(machine)
        self._spindle = StateColumn(lambda state: state.spindle)
        self._speed = 0.0
        self._units = self._moved = False
        self._unstated: Span | None = None

    def feed(self, chunk: Chunk) -> None:
        """Some successive rows."""
        rows = chunk.rows
        self._evidence.units(chunk)
        if not self._moved:
            moves = np.flatnonzero(rows["op"] < Op.DWELL)
            named = np.flatnonzero(rows["op"] == Op.UNITS)
            self._units = self._units or (named.size > 0 and (not moves.size or named[0] < moves[0]))
            if moves.size:
                self._moved = True
                self._unstated = None if self._units else row_span(chunk.trace, rows, int(moves[0]))
        way = self._rows.ways(chunk)
        self._evidence.cuts(chunk, self._rows.cuts(chunk, way), way, self._speeds(chunk))

    def _speeds(self, chunk: Chunk) -> Floats:
        """(n,): revolutions a minute; the last S where a spindle is run by an output, and no code starts it."""
        by_code = self._spindle.rows(chunk)
        rows = chunk.rows
        names = [k for k, text in enumerate(chunk.trace.texts) if text == "spindle_speed"]
        at = np.flatnonzero((rows["op"] == Op.SETPOINT) & np.isin(rows["text"], names))
        last = np.concatenate([[self._speed], rows["arg"][at, 1]])
        self._speed = float(last[-1])
        return np.where(by_code != 0.0, by_code, last[np.searchsorted(at, np.arange(len(rows)), side="right")])

    def finish(self) -> PropertyResult:
        """The answer, after the last chunk."""
        foreign = self._foreign()
        if self._unstated is not None and self._may_state_units():
            self.findings.add(codes.UNITS_NEVER_SET.at(self._unstated, hint="program the code for the unit before it"))
        written = Written(self._program, self.setup)
        for found in (self._evidence.finding(), self._distances(written)):
            if found is not None:
                self.findings.add(found)
        if foreign:
            # What such lines would set, call or leave is not read: nothing to say of the rest.
            return answer(self.name, self.findings)
        told = {name for f in self.findings.kept if f.code is codes.UNSET_PARAMETER for name in _names(f.values)}
        for found in written.findings():
            if found.code is codes.READ_BEFORE_SET and told.intersection(_names(found.values)):
                continue  # the line that runs says so already (GP234)
            self.findings.add(found)
        assumed = ("variables are not followed in a program of this length",) if written.too_long else ()
        return answer(self.name, self.findings, assumed)

    def _may_state_units(self) -> bool:
        """Whether the language has codes of units, and no file of the machine says in what its numbers count."""
        if self._program.rules.unit_of_machine and self.machine.settings.unit_stated:
            return False  # unit= of the machine's own file says it
        known = {rule.function for rule in self._program.rules.codes.values()}
        return bool(known & _UNITS) and self.machine.settings.position_unit is None

    def _distances(self, written: Written) -> Finding | None:
        if self.machine.settings.absolute is not None:
            return None  # nmode= of WINCNC.INI says it
        return written.distances()

    def _foreign(self) -> bool:
        """GP152: lines that are refused here, and that another controller has; whether there are any."""
        refused = [
            f.span
            for f in self.findings.kept
            if f.severity in (Severity.ERROR, Severity.UNKNOWN) and f.code.decides == "language" and f.span.line > 0
        ]
        lines = _texts(self._program.files, sorted(set(refused), key=lambda span: span.line))
        looks: dict[str, dict[Span, str]] = {}
        for span, text in lines.items():
            for own, controller, pattern in LOOKS:
                found = pattern.search(text) if own != self._program.rules.name else None
                if found is not None:
                    looks.setdefault(controller, {})[Span(span.file, span.line)] = found[0].strip()
        if not looks:
            return False
        counted = Counter({controller: len(places) for controller, places in looks.items()})
        controller, count = counted.most_common(1)[0]
        if count < _LEAST_LINES and count < len(lines):
            return False
        places = looks[controller]
        words = ", ".join(dict.fromkeys(repr(text) for text in list(places.values())[:3]))
        hint = "use the post processor for this controller; or give --dialect if the language was guessed wrong"
        self.findings.add(
            codes.FOREIGN_DIALECT.at(min(places, key=_line), controller=controller, what=words, lines=count, hint=hint)
        )
        return True


def _line(span: Span) -> int:
    return span.line


def _names(values: tuple[tuple[str, object], ...]) -> set[object]:
    return {value for key, value in values if key == "name"}


def _texts(files: list[SourceFile], spans: list[Span]) -> dict[Span, str]:
    """The lines of these places, where the source is at hand."""
    found: dict[Span, str] = {}
    for file in files:
        here = [span for span in spans if span.file == file.name]
        if not here or not file.data:
            continue
        ends = np.flatnonzero(np.frombuffer(file.data, dtype=np.uint8) == ord("\n")).tolist()
        for span in here:
            if span.line - 1 > len(ends):
                continue
            begin = 0 if span.line == 1 else ends[span.line - 2] + 1
            at = bisect.bisect_left(ends, begin)
            end = ends[at] if at < len(ends) else len(file.data)
            text = bytes(file.data[begin:end]).decode("latin-1").rstrip("\r")
            found[Span(span.file, span.line)] = text
    return found
