"""Lines whose order in the source decides what goes on (DIN 66025 of McuWIN): see ``Dialect``."""

from __future__ import annotations

import bisect
import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

from gproof.ir import codes
from gproof.ir.dialects.mcuwin.rules import COMMON, OFFSETS_AT
from gproof.ir.dialects.mcuwin.settings import VERSIONS
from gproof.ir.end_state import EndState
from gproof.ir.finding import Refusal, Span
from gproof.ir.machine import Machine
from gproof.ir.modal_groups import OF_FEEDS
from gproof.ir.program import Block, Call, Device, Expr, Input, Named, Number, Program, Subprogram, Unsupported
from gproof.ir.setup import Setup
from gproof.ir.symbolic import Unknown, Value, between, bounds
from gproof.passes.interpret.core import line_kernels as k
from gproof.passes.interpret.core.assigned_numbers import targets
from gproof.passes.interpret.core.axis_words import letters_of
from gproof.passes.interpret.core.call_stack import Frame
from gproof.passes.interpret.core.expressions import MOST_WHOLE
from gproof.passes.interpret.core.line_decoder_kernels import WordColumns
from gproof.passes.interpret.core.line_runs import packed, run_kernel, unpack
from gproof.passes.interpret.core.notes_of_sections import common_modes, end_state
from gproof.passes.interpret.core.semantics import Dialect, Word, cold_words, settings_of
from gproof.passes.interpret.mcuwin import fast_path as din_plain
from gproof.passes.interpret.mcuwin import line as din
from gproof.passes.interpret.mcuwin import outputs_and_waits as din_events
from gproof.passes.interpret.mcuwin.calls import bind, count_of
from gproof.passes.interpret.mcuwin.foreign_statements import foreign
from gproof.passes.interpret.mcuwin.parts import gather
from gproof.passes.interpret.mcuwin.state import McuWinModal, McuWinRun, din_of, fits, whole_numbers


class McuWinDialect(Dialect[McuWinRun]):
    """Lines in the order of the source. whole: numbers of the variables that the program declares as integers."""

    has_own_feeds = True
    keeps_motion = False
    modules = True
    run_type = McuWinRun

    def __init__(self, program: Program) -> None:
        super().__init__(program)
        self.whole = whole_numbers(program)
        self.fits = self._fits

    def _fits(self, number: int, value: object) -> bool:
        return fits(number, value, self.whole)

    def first_state(self, program: Program, setup: Setup, machine: Machine) -> McuWinModal:
        """The state in which a job starts."""
        return McuWinModal(program.rules, setup, machine)

    def begin(self, run: McuWinRun) -> None:
        """GP630 for what setup and machine state that McuWIN does not have."""
        for what, key in foreign(run.setup, run.machine):
            file = run.machine.name if key.startswith("machine.") else run.setup.name
            run.fail(codes.FOREIGN_FACT.at(run.findings.where(key, Span(file, 1)), what=what))

    def end_state(self, run: McuWinRun) -> EndState:
        """The zero offset, which the next program may meet or not (14 (2.5.3.88)), and the reflection of axes."""
        own = run.modal.own
        reflected = ("mcuwin: reflected", repr(sorted(own.reflected)))
        found = end_state(run, (*common_modes(run.modal, "mcuwin"), reflected))
        # The tables of zero offsets and tools are written by no program (2.7, 3.19).
        assumed = ("McuWIN keeps the zero offset for the next program",)
        return replace(found, table=(), length=None, assumed=assumed)

    def letters(self, machine: Machine) -> dict[str, int]:
        """Column of each letter that moves an axis."""
        return letters_of(machine)

    def block(self, run: McuWinRun, node: Block, words: list[tuple[str, Value, Span]]) -> None:
        """Execute a line."""
        settings = [
            (one, new, span)
            for number, value, span in settings_of(run, node)
            for one, new in targets(run, number, value, span)
        ]
        for number, value, span in settings:
            if not fits(round(number), value, self.whole):
                name = run.evaluator.names.get(round(number)) or run.program.rules.name_of(round(number))
                what = f"{name} is a whole number of 32 bits; {value!r} is not"
                raise Refusal(codes.ARITHMETIC.at(span, what=what))
            run.modal.write(number, value, span)
        if words:
            bare = frozenset(w.letter for w in node.words if w.bare)
            din.run_line(run, node.span, words, bare=bare, continued=node.continued, distances=node.distances)

    def line(self, run: McuWinRun, span: Span, words: list[tuple[str, Value, Span]], bare: frozenset[str]) -> None:
        """Execute a line of a table."""
        frame = run.flow.stack[-1]
        continued = frame.continued
        for letter, value, _ in words:
            if letter == "G":
                frame.continued = f"G{value:g}"
        din.run_line(run, span, words, bare=bare, continued=continued)

    def cold(self, run: McuWinRun, frame: Frame, columns: WordColumns, count: int) -> set[int]:
        """Lines for Python, which are where the kernel stops too."""
        lines, frame.stops = cold_words(columns, count, din_plain.hot_letters(run.modal.own), pairs=True)
        return set(lines)

    def hot(self, run: McuWinRun, kernel: Any, columns: WordColumns, count: int, at: int, compiled: bool) -> int:
        """Run lines in the kernel from word ``at``; returns the first word it left over."""
        frame = run.flow.stack[-1]
        at, frame.continued = _hot(run, kernel, columns, count, at, compiled, frame.stops, frame.continued)
        return at

    def motion_of(self, letters: Sequence[str], values: Sequence[Expr], continued: str) -> tuple[str | None, bool]:
        """The motion of a line of a loop, its own or the one that goes on."""
        own = [value for letter, value in zip(letters, values, strict=True) if letter == "G"]
        if len(own) > 1 or not all(isinstance(value, Number) for value in own):
            return None, False
        if set(letters) == {"F"}:
            return (continued, False) if continued in din_plain.MOTIONS else (None, False)
        if own:
            assert isinstance(own[0], Number)
            motion = f"G{own[0].value:g}"
            return (motion if motion in din_plain.MOTIONS else None), False
        return (continued, True) if continued in din_plain.MOTIONS else (None, False)

    def stops(self, run: McuWinRun, columns: WordColumns, count: int) -> list[int]:
        """First words of lines of a loop that the kernel must not run."""
        found: list[int] = cold_words(columns, count, din_plain.hot_letters(run.modal.own), pairs=True)[1]
        return found

    def hot_lines(
        self, run: McuWinRun, kernel: Any, columns: WordColumns, count: int, at: int, compiled: bool,
        stops: list[int], motion: str, numbers: Any,
    ) -> int:  # fmt: skip
        """As ``hot``, for lines of a loop: see ``Manner``."""
        return _hot(run, kernel, columns, count, at, compiled, stops, motion, numbers)[0]

    def again(
        self, run: McuWinRun, span: Span, words: list[tuple[str, Value, Span]], motion: str, distances: str
    ) -> None:  # fmt: skip
        """Execute a line of a loop that the kernel left over."""
        din.run_line(run, span, words, continued=motion, distances=distances)

    def call(self, run: McuWinRun, node: Call) -> None:
        """Run a subprogram so often as the call says (4.21)."""
        self.at_jump(run, node.span, f"M98 L{node.name}")
        count, often = count_of(run, node)
        back = bind(run, node)
        depth = len(run.flow.stack)
        run.flow.call_subprogram(node.name, node.span)
        if len(run.flow.stack) > depth:
            frame = run.flow.stack[-1]
            frame.again = count - 1
            frame.more, frame.last = round(bounds(often)[1]) - count, often
            run.flow.widening.counted.pop((id(frame.node), "call"), None)
            assert frame.caller is not None
            frame.caller = replace(frame.caller, back=back)

    def named(self, run: McuWinRun, node: Named) -> Value:
        """What the controller holds under a name."""
        return din_events.read_named(run, node)

    def judge_line(self, machine: Machine, span: Span, words: Sequence[Word], bare: frozenset[str]) -> None:
        """Refusal for a line that means nothing by itself."""
        gather(self.program.rules, machine, letters_of(machine), span, words, bare)

    def input(self, run: McuWinRun, node: Input) -> Value:
        """An input of the controller."""
        return din_events.read_input(run, node)

    def unsupported(self, run: McuWinRun, node: Unsupported) -> None:
        """All places and all variables: the statement may have changed any."""
        din_events.lose_all(run, node.what)

    def device(self, run: McuWinRun, node: Device) -> None:
        """``wt``; nothing else is a statement of its own."""
        if node.name != "wait":
            super().device(run, node)
        din_events.wait(run, run.evaluator.value(node.arguments[0]), node.span)

    def motion_of_frame(self, run: McuWinRun, frame: Frame) -> int:
        """The motion that the source says."""
        return din_plain.MOTIONS.get(frame.continued, 0)

    def takes_lost_feed(self, run: McuWinRun, open_feeds: bool) -> bool:
        """Any F is taken."""
        return True

    def take_lost_feed(self, run: McuWinRun, feed: float, last: float) -> None:
        """The last of some F is the one in force."""
        din_events.take_feed(run.modal, last)

    # ---- the order of statements

    def looks_at_jumps(self, run: McuWinRun) -> bool:
        """Whether jumps and returns end a contour, and have that to tell (14: before 2.5.3.41)."""
        return din_of(run.machine).version == VERSIONS[1]

    def at_jump(self, run: McuWinRun, span: Span, code: str) -> None:
        """GP513: before 2.5.3.41 jumps, calls, returns and labels ended a contour (14)."""
        if self.looks_at_jumps(run) and run.modal.own.contour:
            run.flow.hot_blocks.run_pending()
            run.findings.add(codes.CONTOUR_BREAK.at(span, code=code))
            run.modal.own = run.modal.own.but(contour=False)

    def is_unended(self, run: McuWinRun, frame: Frame) -> bool:
        """Whether the text of a module is over without an end (GP515): what comes after it is another module."""
        if frame.at > len(frame.body):
            return False
        node = frame.node
        if node is None:
            old = din_of(run.machine).version == VERSIONS[1]
            # Before 2.5.3.90 a program needed no M30, where nothing else is after it (14 (2.5.3.30)).
            ends = old and not any(sub.is_module for sub in self.program.subprograms.values())
            return frame.body is self.program.body and not ends
        return isinstance(node, Subprogram) and (node.is_module or node.name[:1].isdigit())

    # ---- variables

    def is_whole(self, number: int) -> bool:
        """CI n, and those that are declared as integers, are whole numbers of 32 bits (11)."""
        return not fits(number, MOST_WHOLE + 1.0, self.whole)

    def of_its_type(self, number: int, value: Value) -> Value:
        """What is known of a variable that is declared to hold whole numbers, or is one of those that do."""
        if not isinstance(value, Unknown) or value.whole or fits(number, 0.5, self.whole):
            return value
        if not value.bounded:
            return Unknown(value.cause, value.low, value.high, whole=True)
        low, high = float(math.ceil(value.low)), float(math.floor(value.high))
        return between(value.cause, (low, high), whole=True) if low <= high else value

    def by_number(self, number: int) -> tuple[int, ...]:
        """Variables that a code may take by this number: M901 and its like, CI and CD."""
        return number, COMMON + number

    @property
    def always_read(self) -> Iterable[int]:
        """G154 reads its own."""
        return range(OFFSETS_AT, OFFSETS_AT + 10)


def _hot(
    run: McuWinRun, kernel: Any, columns: WordColumns, count: int, at: int, compiled: bool, stops: list[int],
    continued: str, numbers: Any = None,
) -> tuple[int, str]:  # fmt: skip
    """Run lines in the kernel from word ``at``: the first word it left over, and the code that goes on there."""
    s, rows = run.modal, run.rows
    if not run.moved or not s.plain_motion or not din_plain.begin(run, continued):
        return at, continued
    start = [p.value for p in s.position]
    stop = bisect.bisect_left(stops, at)
    count = stops[stop] if stop < len(stops) else count
    state = packed(run, start, compiled)
    state.ints[k.ARC_ABSOLUTE] = int(not din_plain.arcs_are_plain(run))
    state.ints[k.ACTIVE_AXES] &= 7
    before, first = rows.count, at
    at = run_kernel(run, kernel, columns, state, count, at)
    unpack(run, state)
    if s.unknown_modes & OF_FEEDS:
        s.feed = math.nan
    continued = din_plain.taken(run, start, before, columns, first, at, numbers)
    s.motion = 0
    return at, continued
