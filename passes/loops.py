"""Blocks and conditions that come again: evaluated by compiled functions, their motion executed together.

``passes/compiled.py`` makes the functions. Lines of motion wait in ``Pending`` until something needs the state that
they leave; then they run in the kernel of straight-line code, so that the moves of a loop are columns, never
objects.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import repeat
from typing import Any

import numpy as np

from gproof.ir.program import Block, Expr
from gproof.passes import execute_kernels as k
from gproof.passes.compiled import FALLS_BACK, FastBlock, compile_block, compile_condition
from gproof.passes.din_state import fits
from gproof.passes.frames import Pending
from gproof.passes.straight import Straight

_ONCE = FastBlock(lambda _: (), (), (), (), False, None)  # type: ignore[arg-type]
"""A block that was executed once."""
PENDING_LINES = 1 << 14
"""Lines of motion that wait at most before they are executed together."""


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
            # The kernel here is of lines of many commands; texts, comments and bare letters count besides.
            return False
        key = id(node)
        if key not in self._fast:
            # The first time is the evaluator's: it tells what is to be told once.
            self._fast[key] = _ONCE
            return False
        fast = self._fast[key]
        if fast is _ONCE:
            fast = None if node.deleted else compile_block(node, self.program.rules)
            self._fast[key] = fast
        if fast is None or not (fast.is_motion or not fast.letters):
            return False
        if fast.letters and self.program.rules.source_order:
            # The kernel here is of lines whose words count alike under every code.
            return False
        parameters = self.modal.parameters
        try:
            values = fast.run(parameters)
        except FALLS_BACK:
            self._settle(fast.reads)
            return False
        if self.program.rules.source_order and not all(map(fits, fast.targets, values, repeat(self._whole))):
            return False
        self.spend(fast.node.span)
        words = len(fast.letters)
        if words:
            p = self._pending
            number = len(p.nodes)
            p.nodes.append(fast.node)
            p.line.extend([number] * words)
            p.letter.extend(map(ord, fast.letters))
            p.value.extend(values[:words])
        for target, value in zip(fast.targets, values[words:], strict=True):
            parameters[target] = value
        if len(self._pending.nodes) >= PENDING_LINES:
            self._run_pending()
        return True

    def _settle(self, numbers: Iterable[int]) -> None:
        """Variables that the setup states and nobody has set: from now on as if they were set."""
        for number in numbers:
            if number not in self.modal.parameters:
                stated = self.setup.parameter(number)
                if stated is not None:
                    self.modal.parameters[number] = stated

    def _run_pending(self) -> None:
        """Execute the lines that wait, in the kernel as far as it takes them."""
        pending = self._pending
        if not pending.nodes:
            return
        self._pending = Pending()
        nodes, count, at = pending.nodes, len(pending.line), 0
        run = k.run_lines.pick(len(nodes))
        compiled = run is not k.run_lines.python
        columns: Any = pending.line, pending.letter, pending.value
        if compiled:
            types = np.int32, np.uint8, np.float64
            columns = tuple(np.array(c, dtype=t) for c, t in zip(columns, types, strict=True))
        file, self._file = self._file, self._file_of(nodes[0].span)
        lines = np.array([node.span.line for node in nodes], dtype=np.int32)
        while at < count:
            before = self.rows.count
            blocks = self.blocks
            at = self._hot(run, columns, count, at, compiled)
            self.blocks = blocks  # they are counted already
            made = self.rows.arrays["line"][before : self.rows.count]
            made[:] = lines[made]
            if self.rows.count == self.rows.capacity:
                self.rows.flush()
            elif at < count:
                node = nodes[pending.line[at]]
                end = at + len(node.words)
                words = zip(node.words, pending.value[at:end], strict=True)
                self._line(node.span, [(word.letter, value, word.span) for word, value in words])
                at = end
        self._file = file
