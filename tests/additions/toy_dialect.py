"""A dialect from outside: ten codes, a line at a time, no variables and no jumps. Importing it registers it.

``G0`` rapid, ``G1`` feed, ``G4 P`` seconds, ``G20`` inch, ``G21`` mm, ``G90`` places, ``G91`` distances, ``M3`` and
``M5`` spindle, ``M30`` end; a comment begins with ``#``.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from gproof.backend.emit.printer import Printer
from gproof.driver import dialects
from gproof.frontend.common.alone import Alone
from gproof.frontend.common.frontend import Files, Frontend, Read, Reading
from gproof.frontend.common.source import read_source
from gproof.ir import codes
from gproof.ir.dialects import RULES
from gproof.ir.finding import Findings, Refusal, Span
from gproof.ir.machine import AXIS_NAMES, Machine
from gproof.ir.program import Block, Number, Program, Word
from gproof.ir.rules import CodeRule, LanguageRules
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import Position, Unknown, Value
from gproof.ir.trace import Op, Wait
from gproof.passes.interpret.core.parsed_line import Line, gather
from gproof.passes.interpret.core.run import ProgramEnd, Run
from gproof.passes.interpret.core.semantics import Dialect

FILES = (
    "ir/dialects/toy/",
    "ir/dialects/__init__.py",
    "frontend/toy/",
    "passes/interpret/toy/",
    "backend/emit/toy/",
    "driver/dialects.py",
    "docs/dialects/toy.md",
    "tests/hand/toy/",
)
REGISTRY = ("ir/dialects/__init__.py", "driver/dialects.py")

_CODES = {
    ("G", 0): (F.TRAVERSE, "motion"),
    ("G", 10): (F.FEED, "motion"),
    ("G", 40): (F.DWELL, "once"),
    ("G", 200): (F.UNITS_INCH, "units"),
    ("G", 210): (F.UNITS_MM, "units"),
    ("G", 900): (F.ABSOLUTE, "distances"),
    ("G", 910): (F.INCREMENTAL, "distances"),
    ("M", 30): (F.SPINDLE_CW, "spindle"),
    ("M", 50): (F.SPINDLE_OFF, "spindle"),
    ("M", 300): (F.END, "end"),
}
TOY = LanguageRules(
    name="toy",
    codes={
        key: CodeRule(letter=key[0], tenths=key[1], function=function, group=group, source="toy", uses_axes=key[1] < 20)
        for key, (function, group) in _CODES.items()
    },
    parameters=(),
    highest_parameter=0,
    arc_tolerance_mm=0.01,
    arc_tolerance_inch=0.0005,
    line_length=200,
    m_codes_in_line=1,
    highest_tool=0,
    integer_tolerance=1e-6,
    peck_clearance_mm=0.0,
    call_depth=0,
    straight_traverse=True,
)
RULES["toy"] = lambda: TOY
_WORD = re.compile(r"\s*([A-Z])\s*([+-]?\d+(?:\.\d*)?)")


def load(path: Path, findings: Findings, name: str = "") -> Program | None:
    """Words of each line, up to a comment; GP101 for any other text."""
    try:
        source = read_source(path)
    except Refusal as refusal:
        findings.add(refusal.finding)
        return None
    program = Program(dialect="toy", rules=TOY, files=[source])
    file, body = name or source.name, list[Block]()
    lines = bytes(source.data).decode("ascii", "replace").splitlines()
    program.line_count = len(lines)
    for number, text in enumerate(lines, 1):
        code = text.partition("#")[0].rstrip()
        words, at = [], 0
        while at < len(code):
            found = _WORD.match(code, at)
            if found is None:
                findings.add(codes.SYNTAX.at(Span(file, number, at + 1, len(code) + 1), what=f"'{code[at:]}'"))
                return None
            span = Span(file, number, found.start(1) + 1, found.end() + 1)
            words.append(Word(found[1], Number(float(found[2]), span), span))
            at = found.end()
        if words:
            body.append(Block(words=tuple(words), assigns=(), span=Span(file, number, 1, len(code) + 1)))
    program.body = tuple(body)
    return program


class Toy(Dialect[Run]):
    """What its lines do."""

    hot_blocks = False

    def block(self, run: Run, node: Block, words: list[tuple[str, Value, Span]]) -> None:
        try:
            self._execute(run, gather(TOY, node.span, words))
        except Refusal as refusal:
            run.modal.lose_all("a line that is refused")
            run.refuse(run.as_accepted(refusal.finding))

    def _execute(self, run: Run, line: Line) -> None:
        s = run.modal
        units, distances, spindle = line.group("units"), line.group("distances"), line.group("spindle")
        if units is not None:
            s.unit = 25.4 if units.function is F.UNITS_INCH else 1.0
            run.event(Op.UNITS, line.span, arg=(s.unit, 0.0))
        if distances is not None:
            s.absolute = distances.function is F.ABSOLUTE
        if "F" in line.values:
            s.feed = (line.number("F") or 0.0) * s.unit
        if "S" in line.values:
            s.spindle_speed = line.values["S"]
        if spindle is not None:
            s.spindle_direction = 1 if spindle.function is F.SPINDLE_CW else 0
            run.spindle_row(line)
        if line.group("once") is not None:
            run.event(Op.DWELL, line.span, arg=(line.number("P") or 0.0, 0.0))
        motion = line.group("motion")
        if motion is not None:
            s.motion = int(motion.function)
        if line.axes():
            self._move(run, line)
        if line.group("end") is not None:
            run.event(Op.END, line.span)
            run.end_section(Wait.END, "end", -1, line.span)
            raise ProgramEnd

    def _move(self, run: Run, line: Line) -> None:
        s = run.modal
        if s.motion not in (F.TRAVERSE, F.FEED):
            raise Refusal(codes.AXIS_WORDS_UNUSED.at(line.span, why="no motion code comes before"))
        if s.motion == F.FEED and s.feed == 0.0:
            raise Refusal(codes.FEED_MISSING.at(line.span, code="G1"))
        target = list(s.position)
        for axis, value in line.axes().items():
            assert not isinstance(value, Unknown)
            if not s.has_axis(axis):
                raise Refusal(codes.AXIS_NOT_THERE.at(line.span, axis=AXIS_NAMES[axis].upper()))
            origin = s.offset(axis) if s.absolute else s.position[axis]
            target[axis] = origin.plus(Position(value * s.scale(axis)))
        run.move(Op.TRAVERSE if s.motion == F.TRAVERSE else Op.FEED, target, line.span)
        run.moved = True


def _load_program(job: Reading) -> Read:
    return load(job.job, job.findings), job.machine


def _load_machine(
    path: Path, findings: Findings, alone: bool, anew: frozenset[tuple[str, ...]]
) -> tuple[Machine | None, Files]:
    raise AssertionError("it has no machine file of its own")


def _alone(machine: Machine, machine_file: Path | None, folder: Path | None, path: Path) -> Alone:
    return Alone(load)


def _emit(program: Program, machine: Machine, kept: frozenset[int]) -> Iterable[bytes]:
    for line in bytes(program.files[0].data).splitlines():
        yield b" ".join(line.split()) + b"\n"


FRONTEND = Frontend(
    name="toy", title="Toy", extensions=(".toy",), load_program=_load_program, alone=_alone, load_machine=_load_machine,
    knows_machine=lambda path: False,
)  # fmt: skip


def semantics(program: Program) -> Dialect[Any]:
    return Toy(program)


dialects.DIALECTS["toy"] = dialects.Language(frontend=FRONTEND, printer=Printer(emit=_emit), semantics=semantics)
