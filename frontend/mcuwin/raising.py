"""Program -> Job for McuWIN (DIN 66025 blocks with rw_SymPas). Sections are those of the manual of V 2.5.3.133.

What a line without a code goes on with is the order of the source (3.1), which the Program has
(``Block.continued``): no mode of motion goes from line to line here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import cast

from gproof.frontend.common.move_tables import MoveLetters
from gproof.frontend.common.raising import Line, Unraisable
from gproof.frontend.common.raising_modes import UNKNOWN_MODE
from gproof.frontend.mcuwin.raising_codes import MODES
from gproof.frontend.mcuwin.raising_events import ENDS, EVENTS, SETTINGS
from gproof.frontend.mcuwin.raising_moves import is_plain, move, shaped
from gproof.frontend.mcuwin.raising_state import McuWinState
from gproof.frontend.mcuwin.raising_words import CENTERS, Gathered, Part, gather
from gproof.ir.dialects.mcuwin.persistence import OPEN
from gproof.ir.dialects.mcuwin.settings import VERSIONS
from gproof.ir.finding import Span
from gproof.ir.job import DwellFor, EndJob, Job, Moves, Node, NotRaised, Quantity, SetVariable, ShowText
from gproof.ir.machine import AXES, Machine
from gproof.ir.program import (
    Block,
    BlockTable,
    Call,
    Device,
    For,
    If,
    Message,
    Number,
    Program,
    Repeat,
    Statement,
    Subprogram,
    Variable,
    While,
)
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F

MAINTAINED = 920
"""G92, which a line without a code goes on with too (3.26)."""
_UNLIKE = "the manual does not say whether the last motion goes on (3.1)"


class McuWinRaiser(McuWinState):
    """Lines of one or more codes: modes, F, S, T and D act before the motion, other codes where they are."""

    # ---- lines

    def line(self, words: Line, span: Span) -> list[Node]:
        """What a line does."""
        line = gather(self.program.rules, self.din, self.columns, words)
        motion = self._motion_of(line)
        earlier = [part for part in line.parts if part.rule.function in EVENTS and part.at < line.moves_from]
        later = [part for part in line.parts if part.rule.function in EVENTS and part not in earlier]
        if motion is None:
            earlier, later = [], [*earlier, *later]
        for part in earlier:
            if part.rule.function in ENDS:
                raise Unraisable(f"{part.rule.text} in front of a move in one line", "which is first is open (4.3)")
        found: list[Node] = []
        asked = False
        for part in line.parts:
            if part.rule.function not in EVENTS:
                found += self._mode(part, line, motion, span)
                asked |= part.at > line.feed_at and self.now.own("feed") == "asked"
        feed = None
        for letter, word in line.settings.items():
            if letter == "F":
                feed = self.feed_of(word)
                self.keep(feed="given")
            else:
                found += SETTINGS[letter](self, word, span)
        if asked:
            self.keep(feed="asked")
        for part in earlier:
            found += EVENTS[part.rule.function](self, part, span)
        if motion is not None and motion.tenths == MAINTAINED:
            self._no_centers(line)
            found += MODES[motion.function](self, Part(motion, 0, line.moves), span)
        elif motion is not None:
            found += move(self, motion, line.moves, feed, span)
            feed = None
        if feed is not None:
            found += move(self, self.program.rules.codes["G", 0], {}, feed, span)
        for part in later:
            found += EVENTS[part.rule.function](self, part, span)
        return found

    def _no_centers(self, line: Gathered) -> None:
        for letter in CENTERS:
            if letter in line.moves:
                raise Unraisable(f"{letter} in this line", "it belongs to arcs (3.3)")

    def _mode(self, part: Part, line: Gathered, motion: CodeRule | None, span: Span) -> list[Node]:
        """A code that acts before the motion; after the words of a move only where it changes nothing."""
        before = self.modes
        found = MODES[part.rule.function](self, part, span)
        behind = motion is not None and part.at > line.words_from
        if behind and (found or self.modes != before) and part.rule.function is not F.ZERO_OFFSET_READ:
            raise Unraisable(f"{part.rule.text} after the words of a move", "which is first is open (5.3)")
        return found

    def _motion_of(self, line: Gathered) -> CodeRule | None:
        """The code of a line's motion, its own or the one that goes on (3.1)."""
        if line.motion is not None:
            if self._is_number(line.motion.tenths):
                self.set_modes(motion=line.motion.tenths)
            return line.motion
        if not line.moves:
            return None
        others = [part.rule for part in line.parts if part.rule.letter == "G"]
        keeps = self.din.keeps_over_codes and not any(rule.function is F.DWELL for rule in others)
        if self.now.motion == UNKNOWN_MODE:
            raise Unraisable("axis words alone", _UNLIKE)
        if others and not keeps:
            raise Unraisable(f"axis words with {others[0].text}", _UNLIKE)
        rule = self.program.rules.codes.get(("G", cast("int", self.now.motion)))
        if rule is None:
            self.set_modes(motion=UNKNOWN_MODE)
            raise Unraisable("axis words alone", "no motion is in force (3.5)")
        return rule

    @staticmethod
    def _is_number(tenths: int) -> bool:
        return 0 <= tenths <= 30

    def _begin(self, continued: str, distances: str) -> None:
        """What the order of the source decides for a line or a table."""
        motion: int | str = -1
        if continued:
            motion = UNKNOWN_MODE if continued == OPEN else int(continued[1:]) * 10
        self.set_modes(motion=motion)
        if distances:
            self.set_modes(relative=distances == "G91")

    def _done(self) -> None:
        if self.modes is not None:
            self.set_modes(motion=-1)

    # ---- tables

    def table(self, table: BlockTable) -> list[Node]:
        """Plain lines: rows of moves, as far as modes leave no question."""
        self._begin(table.continued, table.distances)
        linear = [""] * AXES
        for letter, column in self.columns.items():
            linear[column] = "" if letter in self.rotary else letter
        centers = "IJ" if self.now.plane == "xy" else ""
        self.letters = MoveLetters(axes=tuple(linear), centers=centers, radius="")
        found = super().table(table)
        self._done()
        return found

    def plain_moves(self) -> bool:
        """See ``raising_moves``."""
        return is_plain(self, self.now.motion)

    def table_moves(self, moves: Moves) -> list[Node]:
        """See ``raising_moves``."""
        return shaped(self, moves)

    # ---- statements

    def block(self, node: Block) -> list[Node]:
        """A line with expressions, or an assignment."""
        self._begin(node.continued, node.distances)
        for one in node.assigns:
            self.plain(one.target)
            self.plain(one.value)
        try:
            return super().block(node)
        finally:
            self._done()

    def choice(self, node: If) -> Node:
        """$if (7)."""
        self.plain(node.condition)
        return super().choice(node)

    def loop(self, node: While | Repeat | For) -> Node:
        """$while, $repeat, $for (8)."""
        for value in (node.first, node.last, node.variable) if isinstance(node, For) else (node.condition,):
            self.plain(value)
        return super().loop(node)

    def _once(self, body: Sequence[Statement]) -> list[Node]:
        return super()._once(_joined_texts(body))

    def own(self, node: Statement) -> list[Node]:
        """WRITE, WRITELN (5.7), wt (10)."""
        if isinstance(node, Message):
            if node.kind == "write":
                raise Unraisable("WRITE", "its line of text goes on in another statement (5.7.1)")
            parts = tuple(self.plain(part) for part in node.parts)
            return [ShowText(kind="msg", parts=parts, span=node.span)]
        if isinstance(node, Device) and node.name == "wait":
            unit = "ms" if self.din.wait_unit == 0.001 else "s"
            return [DwellFor(time=Quantity(self.plain(node.arguments[0]), unit), span=node.span)]
        raise Unraisable(getattr(node, "name", type(node).__name__), "a command of this controller")

    def call(self, node: Call) -> list[Node]:
        """M98 (4.16), or a procedure (10), whose var parameters go back into what they were given."""
        if node.count is not None:
            self.plain(node.count)
            count = node.count.value if isinstance(node.count, Number) else 1.0
            if count < 1.0 or count != round(count):
                raise Unraisable(f"M98 with O{count:g}", "no whole number above 0 (4.16)")
        sub = self.program.subprograms.get(node.name)
        if sub is None or sub.is_module or not sub.parameters:
            return [self.run_routine(node.name, node.span, count=node.count)]
        arguments, back = [], []
        for (_, kind, _), target, word in zip(sub.parameters, self.parameters_of(sub), node.arguments, strict=True):
            value = self.plain(word.value)
            arguments.append((target, value))
            if kind.startswith("var "):
                if not isinstance(value, Variable):
                    raise Unraisable(f"a call of {node.text}", "a var parameter needs a variable (10)")
                back.append(SetVariable(target=value, value=target, span=node.span))
        return [self.run_routine(node.name, node.span, arguments=tuple(arguments)), *back]

    def parameters_of(self, sub: Subprogram) -> tuple[Variable, ...]:
        """Those of a procedure (10)."""
        return tuple(Variable(Number(float(number), sub.span), sub.span, name) for name, _, number in sub.parameters)

    def at_end(self, sub: Subprogram | None) -> list[Node]:
        """The end of a module is reached without M02, M30 or M17: error 190, before 2.5.3.90 an end (14)."""
        if self.modes is None or (sub is not None and not (sub.is_module or sub.name[:1].isdigit())):
            return []
        span = sub.span if sub is not None else Span(self.program.files[0].name, max(1, self.program.line_count))
        self.modes = None
        alone = not any(one.is_module for one in self.program.subprograms.values())
        if sub is None and alone and self.din.version == VERSIONS[1]:
            return [EndJob(span=span)]
        return [NotRaised(construct="the end of a module", why="no M02, M30 or M17 ends it (14 (2.5.3.90))", span=span)]

    # ---- comments

    def comment_text(self, kind: int, text: bytes) -> str:
        """Round brackets, a quote, two slashes or braces are around it (6, 7)."""
        written = super().comment_text(kind, text)
        for opening, closing in (("(", ")"), ("{", "}"), ("'", ""), ("//", "")):
            if written.startswith(opening):
                return written.removeprefix(opening).removesuffix(closing).strip()
        return written


def _joined_texts(body: Sequence[Statement]) -> Sequence[Statement]:
    """WRITE with what goes on with its line right after it, as one text (5.7)."""
    if not any(isinstance(node, Message) and node.kind == "write" for node in body):
        return body
    found: list[Statement] = []
    for node in body:
        last = found[-1] if found else None
        if isinstance(node, Message) and isinstance(last, Message) and last.kind == "write":
            found[-1] = replace(node, parts=(*last.parts, *node.parts), span=last.span)
        else:
            found.append(node)
    return found


def raise_program(program: Program, machine: Machine) -> Job:
    """A Program of McuWIN as a Job."""
    return McuWinRaiser(program, machine).job()
