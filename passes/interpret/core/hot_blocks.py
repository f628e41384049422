"""Blocks and conditions that come again: evaluated by compiled functions, their motion executed together.

``passes/interpret/core/block_compiler.py`` makes the functions. Lines of motion wait in ``Pending`` until something
needs the state that they leave; then they run in the kernel of straight-line code, so that the moves of a loop are
columns, never objects.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from gproof.ir.finding import Span
from gproof.ir.program import FLAG_BARE, FLAG_DELETE, Block, BlockTable, DeferredBlock, Expr, Number
from gproof.ir.symbolic import Value
from gproof.passes.interpret.core import line_kernels as k
from gproof.passes.interpret.core.block_compiler import (
    FALLS_BACK,
    HOT_LETTERS,
    Condition,
    FastBlock,
    compile_block,
    compile_condition,
)
from gproof.passes.interpret.core.block_tables import CHUNK_BYTES
from gproof.passes.interpret.core.call_stack import NO_PLACE, HotLine, Pending, Stretch
from gproof.passes.interpret.core.flow_part import FlowPart
from gproof.passes.interpret.core.line_decoder_kernels import WordColumns

if TYPE_CHECKING:
    from gproof.passes.interpret.core.control_flow import ControlFlow

_ONCE = FastBlock(lambda _: (), (), (), (), False, None)  # type: ignore[arg-type]
"""A block that was executed once."""
NO_LINES = Stretch(())
MOST_BLOCKS = 1000
"""Blocks of a pass that may be executed with others at once; in longer ones what is between blocks is no matter."""
PENDING_LINES = 1 << 14
"""Lines of motion that wait at most before they are executed together."""


class _Numbers:
    """Where lines that wait are in the source; asked: of which of them somebody wanted to know that last."""

    def __init__(self, lines: Any) -> None:
        self._lines = lines
        self.asked: Any = ()

    def __getitem__(self, numbers: Any) -> Any:
        self.asked = numbers.copy()
        return self._lines[numbers]


class HotBlocks(FlowPart):
    """The fast way; each method says when the evaluator must do it instead. pending: lines of motion that wait."""

    def __init__(self, flow: ControlFlow) -> None:
        super().__init__(flow)
        self._fast: dict[int, FastBlock | None] = {}
        self._tests: dict[int, Condition | None] = {}
        self._stretches: dict[int, Stretch] = {}
        self.pending = Pending()

    def fast_condition(self, condition: Expr) -> float | None:
        """The value of a condition that was evaluated before; None when the evaluator must do it."""
        key = id(condition)
        if not self.flow.loops and not self.flow.called and not self.flow.came_back:
            return None
        if key not in self._tests:
            # As for blocks.
            self._tests[key] = compile_condition(condition, self.run.program.rules)
            return None
        test = self._tests[key]
        if test is None:
            return None
        try:
            return test[0](self.run.modal.parameters)
        except FALLS_BACK:
            self.settle(test[1])
            return None

    def fast_block(self, node: Block) -> bool:
        """Evaluate a block that was executed before, and keep its motion for later; False: not possible this time."""
        if not self.run.dialect.hot_blocks:
            return False
        key = id(node)
        if key not in self._fast:
            # The first time is the evaluator's: it reports what is to be reported once.
            self._fast[key] = _ONCE
            return False
        fast = self.known_block(node)
        if fast is None:
            return False
        stretch = self._stretches.get(key)
        if stretch is None:
            if fast.letters:
                line = self.hot_line(fast.node)
                if line is None:
                    self._fast[key] = None
                    return False
                stretch = Stretch([line])
            else:
                stretch = NO_LINES
            self._stretches[key] = stretch
        if stretch.lines and not self.in_mode(fast.node.distances):
            return False
        parameters = self.run.modal.parameters
        try:
            values = fast.run(parameters)
        except FALLS_BACK:
            self.settle(fast.reads)
            return False
        words = len(fast.letters)
        fits = self.run.dialect.fits
        if fits is not None and not all(map(fits, fast.targets, values[words:])):
            return False
        self.run.spend(fast.node.span)
        if words:
            p = self.pending
            p.parts.append(stretch)
            if stretch.lines[0].added:
                p.value.append(float(stretch.lines[0].motion[1:]))
            p.value.extend(values[:words])
            p.lines += 1
        for target, value in zip(fast.targets, values[words:], strict=True):
            parameters[target] = value
        if self.pending.lines >= PENDING_LINES:
            self.run_pending()
        return True

    def known_block(self, node: Block) -> FastBlock | None:
        """The compiled form of a block that was executed; None where the evaluator must do it every time."""
        key = id(node)
        fast = self._fast.get(key)
        if fast is _ONCE:
            fast = None if node.deleted else compile_block(node, self.run.program.rules)
            if fast is not None and fast.letters and not fast.is_motion:
                fast = None
            self._fast[key] = fast
        return fast

    def in_mode(self, distances: str) -> bool:
        """Whether the source decides nothing else of a line than what holds."""
        return not distances or (distances == "G90") == self.run.modal.absolute

    def hot_line(self, node: Block) -> HotLine | None:
        """A block as a line for the kernel; None where it is not for it."""
        node = node.made() if isinstance(node, DeferredBlock) else node
        letters = tuple(w.letter for w in node.words)
        if node.deleted or node.texts or any(w.bare for w in node.words):
            return None
        motion, added = self.run.dialect.motion_of(letters, [w.value for w in node.words], node.continued)
        if motion is None:
            return None
        letters = ("G", *letters) if added else letters
        return HotLine(node.span.line, self.run.file_of(node.span), letters, node, None, motion, added)

    def hot_table(self, table: BlockTable) -> list[tuple[HotLine, list[float]]] | None:
        """Lines of a small table for the kernel, with their values; None where one is not for it."""
        if table.last_line - table.first_line >= MOST_BLOCKS:
            return None
        words, after, _ = self.run.ahead.load(table, table.begin, table.first_line, CHUNK_BYTES)
        if after < table.end or (words["flags"] & (FLAG_BARE | FLAG_DELETE)).any():
            return None
        found: list[tuple[HotLine, list[float]]] = []
        continued, at, numbers = table.continued, 0, words["line"].tolist()
        letters, values = [chr(x) for x in words["letter"].tolist()], words["value"].tolist()
        while at < len(numbers):
            end = at
            while end < len(numbers) and numbers[end] == numbers[at]:
                end += 1
            own, given = tuple(letters[at:end]), values[at:end]
            if not HOT_LETTERS.issuperset(own):
                return None
            motion, added = self.run.dialect.motion_of(own, [Number(v, NO_PLACE) for v in given], continued)
            if motion is None:
                return None
            continued = motion or continued
            place = (table, words, at, end, table.begin)
            own = ("G", *own) if added else own
            line = HotLine(numbers[at], table.file, own, None, place, motion, added)
            found.append((line, [float(motion[1:]), *given] if added else given))
            at = end
        return found

    def settle(self, numbers: Iterable[int]) -> None:
        """Variables that the setup states and nobody has set: from now on as if they were set."""
        for number in numbers:
            if number not in self.run.modal.parameters and not self.run.modal.lost:
                stated = self.run.setup.parameter(number)
                if stated is not None:
                    self.run.modal.parameters[number] = stated

    def run_pending(self) -> None:
        """Execute the lines that wait, in the kernel as far as it takes them."""
        pending = self.pending
        if not pending.lines:
            return
        self.pending = Pending()
        line, letter, value, lines = pending.columns()
        run, count, at = k.run_lines.pick(pending.lines), len(line), 0
        compiled = run is not k.run_lines.python
        # No word of a hot line is without a number.
        columns = WordColumns(line, letter, value, np.zeros(count, np.uint8))
        if not compiled:
            columns = WordColumns(line.tolist(), letter.tolist(), pending.value, [0] * count)
        file, call = self.run.file, self.run.call
        self.run.file = next((part.lines[0].file for part in pending.parts if part.places is None), file)
        places = pending.places(self.run.file, call)
        numbers = _Numbers(lines)
        stops = self.run.dialect.stops(self.run, columns, count)
        # Their blocks are counted: what holes of cycles add may use the budget up, once all of them are there.
        alarm, self.run.alarm = self.run.alarm, sys.maxsize
        try:
            while at < count:
                blocks, before = self.run.blocks, self.run.rows.count
                motion = pending.nth(int(line[at])).motion
                at = self.run.dialect.hot_lines(self.run, run, columns, count, at, compiled, stops, motion, numbers)
                self.run.blocks = blocks  # they are counted already
                if places is not None and self.run.rows.count > before:
                    made = slice(before, self.run.rows.count)
                    self.run.rows.arrays["file"][made], self.run.rows.arrays["call"][made] = places[:, numbers.asked]
                if self.run.rows.count == self.run.rows.capacity:
                    self.run.rows.flush()
                elif at < count:
                    at = self._cold_line(pending, at, int(line[at]))
        finally:
            self.run.alarm = alarm
        self.run.file = file

    def _cold_line(self, pending: Pending, at: int, number: int) -> int:
        """One of the lines that wait in Python; returns where the words of the next one start."""
        line = pending.nth(number)
        call = self.run.call
        self.run.call = line.call if line.call >= 0 else call
        end = at + line.words
        values = pending.value[at + line.added : end]
        if line.node is not None:
            node = line.node
            words: list[tuple[str, Value, Span]] = [
                (word.letter, value, word.span) for word, value in zip(node.words, values, strict=True)
            ]
            self.run.dialect.again(self.run, node.span, words, line.motion, node.distances)
        else:
            assert line.table is not None
            span, given, _ = self.flow.tables.words_of(*line.table)
            self.run.dialect.again(self.run, span, given, line.motion, line.table[0].distances)
        self.run.call = call
        return end
