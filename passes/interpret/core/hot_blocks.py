"""Blocks and conditions that come again: evaluated by compiled functions, their motion executed together.

``passes/interpret/core/block_compiler.py`` makes the functions. Lines of motion wait in ``Pending`` until something
needs the state that they leave; then they run in the kernel of straight-line code, so that the moves of a loop are
columns, never objects.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from itertools import repeat
from typing import Any

import numpy as np

from gproof.ir.finding import Span
from gproof.ir.program import FLAG_BARE, FLAG_DELETE, Block, BlockTable, DeferredBlock, Expr, Number
from gproof.ir.symbolic import Value
from gproof.passes.interpret.core import line_kernels as k
from gproof.passes.interpret.core.block_compiler import (
    FALLS_BACK,
    HOT_LETTERS,
    FastBlock,
    compile_block,
    compile_condition,
)
from gproof.passes.interpret.core.block_tables import CHUNK_BYTES, Straight
from gproof.passes.interpret.core.call_stack import NO_PLACE, HotLine, Pending, Stretch
from gproof.passes.interpret.core.line_decoder_kernels import WordColumns
from gproof.passes.interpret.mcuwin.state import fits

_ONCE = FastBlock(lambda _: (), (), (), (), False, None)  # type: ignore[arg-type]
"""A block that was executed once."""
NO_LINES = Stretch(())
MOST_BLOCKS = 1000
"""Blocks of a pass that may be executed with others at once; in longer ones what lies between blocks is no matter."""
PENDING_LINES = 1 << 14
"""Lines of motion that wait at most before they are executed together."""


class _Numbers:
    """Where lines that wait stand in the source; asked: of which of them somebody wanted to know that last."""

    def __init__(self, lines: Any) -> None:
        self._lines = lines
        self.asked: Any = ()

    def __getitem__(self, numbers: Any) -> Any:
        self.asked = numbers.copy()
        return self._lines[numbers]


class Loops(Straight):
    """The fast way; each method says when the evaluator must do it instead."""

    def _fast_condition(self, condition: Expr) -> float | None:
        """The value of a condition that was evaluated before; None when the evaluator must do it."""
        key = id(condition)
        if not self._loops and not self._depth and not self._came_back:
            return None
        if key not in self._tests:
            # As for blocks.
            self._tests[key] = compile_condition(condition, self.program.rules)
            return None
        test = self._tests[key]
        if test is None:
            return None
        try:
            return test[0](self.modal.parameters)
        except FALLS_BACK:
            self._settle(test[1])
            return None

    def _fast_block(self, node: Block) -> bool:
        """Evaluate a block that was executed before, and keep its motion for later; False: not possible this time."""
        if self.program.rules.one_command:
            # Texts, comments and bare letters count there besides.
            return False
        key = id(node)
        if key not in self._fast:
            # The first time is the evaluator's: it tells what is to be told once.
            self._fast[key] = _ONCE
            return False
        fast = self._known_block(node)
        if fast is None:
            return False
        stretch = self._stretches.get(key)
        if stretch is None:
            if fast.letters:
                line = self._hot_line(fast.node)
                if line is None:
                    self._fast[key] = None
                    return False
                stretch = Stretch([line])
            else:
                stretch = NO_LINES
            self._stretches[key] = stretch
        if stretch.lines and not self._in_mode(fast.node.distances):
            return False
        parameters = self.modal.parameters
        try:
            values = fast.run(parameters)
        except FALLS_BACK:
            self._settle(fast.reads)
            return False
        words = len(fast.letters)
        if self.program.rules.source_order and not all(map(fits, fast.targets, values[words:], repeat(self._whole))):
            return False
        self.spend(fast.node.span)
        if words:
            p = self._pending
            p.parts.append(stretch)
            if stretch.lines[0].added:
                p.value.append(float(stretch.lines[0].motion[1:]))
            p.value.extend(values[:words])
            p.lines += 1
        for target, value in zip(fast.targets, values[words:], strict=True):
            parameters[target] = value
        if self._pending.lines >= PENDING_LINES:
            self._run_pending()
        return True

    def _known_block(self, node: Block) -> FastBlock | None:
        """The compiled form of a block that was executed; None where the evaluator must do it every time."""
        key = id(node)
        fast = self._fast.get(key)
        if fast is _ONCE:
            fast = None if node.deleted else compile_block(node, self.program.rules)
            if fast is not None and fast.letters and not fast.is_motion:
                fast = None
            self._fast[key] = fast
        return fast

    def _in_mode(self, distances: str) -> bool:
        """Whether the source decides nothing else of a line than what holds."""
        return not distances or (distances == "G90") == self.modal.absolute

    def _hot_line(self, node: Block) -> HotLine | None:
        """A block as a line for the kernel; None where it is not for it."""
        node = node.made() if isinstance(node, DeferredBlock) else node
        letters = tuple(w.letter for w in node.words)
        if node.deleted or node.texts or any(w.bare for w in node.words):
            return None
        motion, added = self._manner.motion_of(letters, [w.value for w in node.words], node.continued)
        if motion is None:
            return None
        letters = ("G", *letters) if added else letters
        return HotLine(node.span.line, self._file_of(node.span), letters, node, None, motion, added)

    def _hot_table(self, table: BlockTable) -> list[tuple[HotLine, list[float]]] | None:
        """Lines of a small table for the kernel, with their values; None where one is not for it."""
        if table.last_line - table.first_line >= MOST_BLOCKS:
            return None
        words, after, _ = self._ahead.load(table, table.begin, table.first_line, CHUNK_BYTES)
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
            motion, added = self._manner.motion_of(own, [Number(v, NO_PLACE) for v in given], continued)
            if motion is None:
                return None
            continued = motion or continued
            place = (table, words, at, end, table.begin)
            own = ("G", *own) if added else own
            line = HotLine(numbers[at], table.file, own, None, place, motion, added)
            found.append((line, [float(motion[1:]), *given] if added else given))
            at = end
        return found

    def _settle(self, numbers: Iterable[int]) -> None:
        """Variables that the setup states and nobody has set: from now on as if they were set."""
        for number in numbers:
            if number not in self.modal.parameters and not self.modal.lost:
                stated = self.setup.parameter(number)
                if stated is not None:
                    self.modal.parameters[number] = stated

    def _run_pending(self) -> None:
        """Execute the lines that wait, in the kernel as far as it takes them."""
        pending = self._pending
        if not pending.lines:
            return
        self._pending = Pending()
        line, letter, value, lines = pending.columns()
        run, count, at = k.run_lines.pick(pending.lines), len(line), 0
        compiled = run is not k.run_lines.python
        # No word of a hot line is without a number.
        columns = WordColumns(line, letter, value, np.zeros(count, np.uint8))
        if not compiled:
            columns = WordColumns(line.tolist(), letter.tolist(), pending.value, [0] * count)
        file, call = self._file, self._call
        self._file = next((part.lines[0].file for part in pending.parts if part.places is None), file)
        places = pending.places(self._file, call)
        numbers = _Numbers(lines)
        stops = self._manner.stops(self, columns, count)
        # Their blocks are counted: what holes of cycles count beside may use the budget up, once all of them are there.
        alarm, self._alarm = self._alarm, sys.maxsize
        try:
            while at < count:
                blocks, before = self.blocks, self.rows.count
                motion = pending.nth(int(line[at])).motion
                at = self._manner.hot_lines(self, run, columns, count, at, compiled, stops, motion, numbers)
                self.blocks = blocks  # they are counted already
                if places is not None and self.rows.count > before:
                    made = slice(before, self.rows.count)
                    self.rows.arrays["file"][made], self.rows.arrays["call"][made] = places[:, numbers.asked]
                if self.rows.count == self.rows.capacity:
                    self.rows.flush()
                elif at < count:
                    at = self._cold_line(pending, at, int(line[at]))
        finally:
            self._alarm = alarm
        self._file = file

    def _cold_line(self, pending: Pending, at: int, number: int) -> int:
        """One of the lines that wait in Python; returns where the words of the next one begin."""
        line = pending.nth(number)
        call = self._call
        self._call = line.call if line.call >= 0 else call
        end = at + line.words
        values = pending.value[at + line.added : end]
        if line.node is not None:
            node = line.node
            words: list[tuple[str, Value, Span]] = [
                (word.letter, value, word.span) for word, value in zip(node.words, values, strict=True)
            ]
            self._manner.again(self, node.span, words, line.motion, node.distances)
        else:
            assert line.table is not None
            span, given, _ = self._words_of(*line.table)
            self._manner.again(self, span, given, line.motion, line.table[0].distances)
        self._call = call
        return end
