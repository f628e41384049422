"""Lines whose order in the source decides what goes on (DIN 66025 of McuWIN): see ``manner``."""

from __future__ import annotations

import bisect
import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from gproof.ir import codes
from gproof.ir.finding import Refusal, Span
from gproof.ir.modal_groups import OF_FEEDS
from gproof.ir.program import Block, Call, Expr, Input, Named, Number, Unsupported
from gproof.ir.symbolic import Value, bounds
from gproof.passes.interpret.core import line_kernels as k
from gproof.passes.interpret.core.assigned_numbers import targets
from gproof.passes.interpret.core.call_stack import Frame
from gproof.passes.interpret.core.line_decoder_kernels import WordColumns
from gproof.passes.interpret.core.semantics import Manner, cold_words, settings_of
from gproof.passes.interpret.mcuwin import fast_path as din_plain
from gproof.passes.interpret.mcuwin import line as din
from gproof.passes.interpret.mcuwin import outputs_and_waits as din_events
from gproof.passes.interpret.mcuwin.state import fits

if TYPE_CHECKING:
    from gproof.passes.interpret.core.block_tables import Straight
    from gproof.passes.interpret.core.executor import Executor
    from gproof.passes.interpret.core.trace_writer import Emitter


class DinManner(Manner):
    """Lines in the order of the source."""

    def block(self, ex: Executor, node: Block, words: list[tuple[str, Value, Span]]) -> None:
        """Execute a line."""
        settings = [
            (one, new, span)
            for number, value, span in settings_of(ex, node)
            for one, new in targets(ex, number, value, span)
        ]
        for number, value, span in settings:
            if not fits(round(number), value, ex._whole):
                name = ex.evaluator.names.get(round(number)) or ex.program.rules.name_of(round(number))
                what = f"{name} is a whole number of 32 bits; {value!r} is none"
                raise Refusal(codes.ARITHMETIC.at(span, what=what))
            ex.modal.write(number, value, span)
        if words:
            bare = frozenset(w.letter for w in node.words if w.bare)
            din.run(ex, node.span, words, bare=bare, continued=node.continued, distances=node.distances)

    def line(self, ex: Straight, span: Span, words: list[tuple[str, Value, Span]], bare: frozenset[str]) -> None:
        """Execute a line of a table."""
        frame = ex._stack[-1]
        continued = frame.continued
        for letter, value, _ in words:
            if letter == "G":
                frame.continued = f"G{value:g}"
        din.run(ex, span, words, bare=bare, continued=continued)

    def cold(self, ex: Straight, frame: Frame, columns: WordColumns, count: int) -> set[int]:
        """Lines for Python, which are where the kernel stops too."""
        lines, frame.stops = cold_words(columns, count, din_plain.hot_letters(ex.modal.din), pairs=True)
        return set(lines)

    def hot(self, ex: Straight, run: Any, columns: WordColumns, count: int, at: int, compiled: bool) -> int:
        """Run lines in the kernel from word ``at``; returns the first word it left over."""
        frame = ex._stack[-1]
        at, frame.continued = _hot(ex, run, columns, count, at, compiled, frame.stops, frame.continued)
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

    def stops(self, ex: Straight, columns: WordColumns, count: int) -> list[int]:
        """First words of lines of a loop that the kernel must not run."""
        found: list[int] = cold_words(columns, count, din_plain.hot_letters(ex.modal.din), pairs=True)[1]
        return found

    def hot_lines(
        self, ex: Straight, run: Any, columns: WordColumns, count: int, at: int, compiled: bool, stops: list[int],
        motion: str, numbers: Any,
    ) -> int:  # fmt: skip
        """As ``hot``, for lines of a loop: see ``Manner``."""
        return _hot(ex, run, columns, count, at, compiled, stops, motion, numbers)[0]

    def again(
        self, ex: Straight, span: Span, words: list[tuple[str, Value, Span]], motion: str, distances: str
    ) -> None:  # fmt: skip
        """Execute a line of a loop that the kernel left over."""
        din.run(ex, span, words, continued=motion, distances=distances)

    def call(self, ex: Executor, node: Call) -> None:
        """Run a subprogram so often as the call says (4.21)."""
        ex._not_spooled(node.span, f"M98 L{node.name}")
        count, often = ex._count(node)
        back = ex._bind(node)
        depth = len(ex._stack)
        ex._called(node.name, node.span)
        if len(ex._stack) > depth:
            frame = ex._stack[-1]
            frame.again = count - 1
            frame.more, frame.last = round(bounds(often)[1]) - count, often
            ex._counted.pop((id(frame.node), "call"), None)
            assert frame.caller is not None
            frame.caller = replace(frame.caller, back=back)

    def named(self, ex: Emitter, node: Named) -> Value:
        """What the controller holds under a name."""
        return din_events.read_named(ex, node)

    def input(self, ex: Emitter, node: Input) -> Value:
        """An input of the controller."""
        from gproof.passes.interpret.wincnc.outputs_and_waits import read_input

        return read_input(ex, node, ex.evaluator)

    def unsupported(self, ex: Executor, node: Unsupported) -> None:
        """All places and all variables: the statement may have changed any."""
        din_events.lose_all(ex, node.what)


def _hot(
    ex: Straight, run: Any, columns: WordColumns, count: int, at: int, compiled: bool, stops: list[int],
    continued: str, numbers: Any = None,
) -> tuple[int, str]:  # fmt: skip
    """Run lines in the kernel from word ``at``: the first word it left over, and the code that goes on there."""
    s, rows = ex.modal, ex.rows
    if not ex._moved or not s.plain_motion or not din_plain.begin(ex, continued):
        return at, continued
    start = [p.value for p in s.position]
    stop = bisect.bisect_left(stops, at)
    count = stops[stop] if stop < len(stops) else count
    state = ex._packed(start, compiled)
    state.ints[k.ARC_ABSOLUTE] = int(not din_plain.arcs_are_plain(ex))
    state.ints[k.ACTIVE_AXES] &= 7
    before, first = rows.count, at
    at = ex.run_kernel(run, columns, state, count, at)
    ex._unpack(state)
    if s.unknown_modes & OF_FEEDS:
        s.feed = math.nan
    continued = din_plain.taken(ex, start, before, columns, first, at, numbers)
    s.motion = 0
    return at, continued
