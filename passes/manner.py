"""What a line is to a kind of controller: one object per run, chosen by the rules of the language.

``Manner`` is that of RS274NGC: many commands a line, executed in the order of a table. The others stand in modules of
their own, which are imported only for programs that need them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from gproof.ir import codes
from gproof.ir.columns import Columns
from gproof.ir.finding import Refusal, Span
from gproof.ir.kernel import Kernel
from gproof.ir.program import Block, Call, Input, Named, Unsupported
from gproof.ir.rules import LanguageRules
from gproof.passes import execute_kernels as k
from gproof.passes.values import Value

if TYPE_CHECKING:
    from gproof.passes.emitter import Emitter
    from gproof.passes.execute import Executor
    from gproof.passes.frames import Frame
    from gproof.passes.straight import Straight

_COLD = np.array([chr(letter) not in "XYZABCIJKRFG" for letter in range(256)])
"""Letters that ``run_lines`` hands back."""


class Manner:
    """Lines of many commands."""

    kernel: Kernel[Any, Any] = k.run_lines
    """What runs the lines of a table."""

    def block(self, ex: Executor, node: Block, words: list[tuple[str, Value, Span]]) -> None:
        """Execute a line; words: of the node, evaluated."""
        settings = [ex._setting(a) for a in node.assigns]
        # Settings take effect once every value of the line is found, before anything moves (3.2.3).
        for number, value, span in settings:
            ex.modal.write(number, value, span)
            ex._table_written(round(number), span)
        if words:
            ex._line(node.span, words)

    def line(self, ex: Straight, span: Span, words: list[tuple[str, Value, Span]], bare: frozenset[str]) -> None:
        """Execute a line of a table; bare: letters without a number."""
        ex._line(span, words)

    def cold(self, ex: Straight, frame: Frame, words: Columns) -> set[int]:
        """Lines of a piece of a table with a word that the kernel certainly leaves to Python: not worth a call."""
        letter, value = words["letter"], words["value"]
        cold = _COLD[letter]
        g = np.flatnonzero(letter == ord("G"))
        cold[g] = ~np.isin(value[g], (0.0, 1.0, 2.0, 3.0))
        return set(words["line"][cold].tolist())

    def hot(self, ex: Straight, run: Any, columns: tuple[Any, ...], count: int, at: int, compiled: bool) -> int:
        """Run lines in the kernel from word ``at``; returns the first word it left over.

        columns: line, letter, value and flags of the words.
        """
        return ex._hot(run, columns, count, at, compiled)

    def call(self, ex: Executor, node: Call) -> None:
        """Run a subprogram with the words of its call."""
        ex._called(node.name, node.span)

    def named(self, ex: Emitter, node: Named) -> Value:
        """What the controller holds under a name; Refusal GP113 where it knows no names."""
        raise Refusal(codes.UNSUPPORTED_CODE.at(node.span, code=node.name))

    def input(self, ex: Emitter, node: Input) -> Value:
        """An input of the controller; Refusal GP113 where a program reads none."""
        raise Refusal(codes.UNSUPPORTED_CODE.at(node.span, code=node.kind))

    def unsupported(self, ex: Executor, node: Unsupported) -> None:
        """What a statement that is not modelled leaves unknown, before it is refused."""


def manner_of(rules: LanguageRules) -> Manner:
    """How lines of a language are executed."""
    if rules.one_command:
        from gproof.passes.single_manner import SingleManner

        return SingleManner()
    if rules.source_order:
        from gproof.passes.din_manner import DinManner

        return DinManner()
    return Manner()
