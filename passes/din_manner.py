"""Lines whose order in the source decides what goes on (DIN 66025 of McuWIN): see ``manner``."""

from __future__ import annotations

import bisect
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from gproof.ir import codes
from gproof.ir.finding import Refusal, Span
from gproof.ir.program import Block, Call, Input, Named, Unsupported
from gproof.passes import din, din_events, din_plain
from gproof.passes import execute_kernels as k
from gproof.passes.din_state import fits
from gproof.passes.frames import Frame
from gproof.passes.manner import Manner, cold_words
from gproof.passes.values import Value

if TYPE_CHECKING:
    from gproof.passes.emitter import Emitter
    from gproof.passes.execute import Executor
    from gproof.passes.straight import Straight


class DinManner(Manner):
    """Lines in the order of the source."""

    def block(self, ex: Executor, node: Block, words: list[tuple[str, Value, Span]]) -> None:
        """Execute a line."""
        settings = [ex._setting(a) for a in node.assigns]
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

    def cold(self, ex: Straight, frame: Frame, columns: tuple[Any, ...], count: int) -> set[int]:
        """Lines for Python, which are where the kernel stops too."""
        lines, frame.stops = cold_words(columns, count, din_plain.hot_letters(ex.modal.din), pairs=True)
        return set(lines)

    def hot(self, ex: Straight, run: Any, columns: tuple[Any, ...], count: int, at: int, compiled: bool) -> int:
        """Run lines in the kernel from word ``at``; returns the first word it left over."""
        s, frame, rows = ex.modal, ex._stack[-1], ex.rows
        if not ex._moved or not s.plain_motion or not din_plain.begin(ex, frame.continued):
            return at
        start = [p.value for p in s.position]
        stop = bisect.bisect_left(frame.stops, at)
        count = frame.stops[stop] if stop < len(frame.stops) else count
        state = ex._packed(start, compiled)
        state[0][k.ARC_ABSOLUTE] = int(not din_plain.arcs_are_plain(ex))
        state[0][k.ACTIVE_AXES] &= 7
        before, first = rows.count, at
        at = ex.run_kernel(run, columns, state, count, at)
        ex._unpack(state)
        frame.continued = din_plain.taken(ex, start, before, columns[:3], first, at)
        s.motion = 0
        return at

    def call(self, ex: Executor, node: Call) -> None:
        """Run a subprogram so often as the call says (4.21)."""
        ex._not_spooled(node.span, f"M98 L{node.name}")
        count = ex._count(node)
        back = ex._bind(node)
        depth = len(ex._stack)
        ex._called(node.name, node.span)
        if len(ex._stack) > depth:
            frame = ex._stack[-1]
            frame.again = count - 1
            ex._counted.pop((id(frame.node), "call"), None)
            assert frame.caller is not None
            frame.caller = replace(frame.caller, back=back)

    def named(self, ex: Emitter, node: Named) -> Value:
        """What the controller holds under a name."""
        return din_events.read_named(ex, node)

    def input(self, ex: Emitter, node: Input) -> Value:
        """An input of the controller."""
        from gproof.passes.single_events import read_input

        return read_input(ex, node, ex.evaluator)

    def unsupported(self, ex: Executor, node: Unsupported) -> None:
        """All places and all variables: the statement may have changed any."""
        din_events.lose_all(ex, node.what)
