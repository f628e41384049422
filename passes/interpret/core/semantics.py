"""What a line is to a kind of controller: one object per run, chosen by the rules of the language.

``Manner`` is that of RS274NGC: many commands a line, executed in the order of a table. The others stand in modules of
their own, which are imported only for programs that need them.
"""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from gproof.ir import codes
from gproof.ir.finding import Refusal, Span
from gproof.ir.kernel import Kernel
from gproof.ir.program import Block, Call, Expr, Input, Named, Number, Unsupported
from gproof.ir.rules import LanguageRules
from gproof.ir.symbolic import Unknown, Value
from gproof.passes.interpret.core import line_kernels as k
from gproof.passes.interpret.core.assigned_numbers import write_setting
from gproof.passes.interpret.core.line_decoder_kernels import SLOTS, WordColumns, letter_slots
from gproof.passes.interpret.core.line_filter_kernels import cold_lines

if TYPE_CHECKING:
    from gproof.passes.interpret.core.block_tables import Straight
    from gproof.passes.interpret.core.call_stack import Frame, PlainCell
    from gproof.passes.interpret.core.executor import Executor
    from gproof.passes.interpret.core.trace_writer import Emitter

_HOT = letter_slots({letter: axis for axis, letter in enumerate("XYZABC")})
"""Letters that ``run_lines`` takes."""


def cold_words(columns: WordColumns, count: int, hot: list[int], *, pairs: bool = False) -> tuple[Any, Any]:
    """(line numbers, first words) of the lines that a kernel certainly hands back; see ``cold_lines``.

    columns: ``count`` words, as lists for plain Python; hot: see there.
    """
    lines, firsts = np.empty(count, np.int64), np.empty(count, np.int64)
    if isinstance(columns.line, list):
        found = cold_lines(columns, count, hot, [0.0] * SLOTS, int(pairs), lines, firsts)
    else:
        slots = np.array(hot, np.int64)
        found = cold_lines.pick(count)(columns, count, slots, np.zeros(SLOTS), int(pairs), lines, firsts)
    return lines[:found].tolist(), firsts[:found].tolist()


def settings_of(ex: Executor, node: Block) -> list[tuple[Value, Value, Span]]:
    """What the assignments of a line give: variable, value, place.

    Where one is refused, none takes place: what was to be written is not known then, and not what it was before.
    """
    try:
        return [ex._setting(one) for one in node.assigns]
    except Refusal:
        for one in node.assigns:
            if isinstance(one.target.number, Number):
                number = round(one.target.number.value)
                lost = Unknown(f"{one.target.name or f'#{number}'} (its line is refused)")
                with contextlib.suppress(Refusal):
                    ex.modal.write(number, lost, one.target.span)
        raise


class Manner:
    """Lines of many commands."""

    kernel: Kernel[Any, Any] = k.run_lines
    """What runs the lines of a table."""

    def block(self, ex: Executor, node: Block, words: list[tuple[str, Value, Span]]) -> None:
        """Execute a line; words: of the node, evaluated."""
        settings = settings_of(ex, node)
        # Settings take effect once every value of the line is found, before anything moves (3.2.3).
        for number, value, span in settings:
            write_setting(ex, number, value, span)
        if words:
            ex._line(node.span, words)

    def line(self, ex: Straight, span: Span, words: list[tuple[str, Value, Span]], bare: frozenset[str]) -> None:
        """Execute a line of a table; bare: letters without a number."""
        ex._line(span, words)

    def cold(self, ex: Straight, frame: Frame, columns: WordColumns, count: int) -> set[int]:
        """Lines of a piece of a table with a word that the kernel certainly leaves to Python: not worth a call.

        columns: line, letter, value and flags of its ``count`` words.
        """
        return set(cold_words(columns, count, _HOT)[0])

    def hot(self, ex: Straight, run: Any, columns: WordColumns, count: int, at: int, compiled: bool) -> int:
        """Run lines in the kernel from word ``at``; returns the first word it left over.

        columns: line, letter, value and flags of the words.
        """
        return ex._hot(run, columns, count, at, compiled)

    def motion_of(self, letters: Sequence[str], values: Sequence[Expr], continued: str) -> tuple[str | None, bool]:
        """The code with which a line of a loop is to move, and whether it must be added to its words.

        None: the line is not for the kernel. continued: see ``ir.program.Block``.
        """
        return "", False

    def stops(self, ex: Straight, columns: WordColumns, count: int) -> list[int]:
        """First words of lines of a loop that the kernel must not run."""
        return []

    def hot_lines(
        self, ex: Straight, run: Any, columns: WordColumns, count: int, at: int, compiled: bool, stops: list[int],
        motion: str, numbers: Any,
    ) -> int:  # fmt: skip
        """As ``hot``, for lines of a loop, the first of which moves with ``motion``.

        numbers: where the lines stand in the source, by the numbers that they have in ``columns``.
        """
        before = ex.rows.count
        at = ex._hot(run, columns, count, at, compiled, distances=True)
        made = ex.rows.arrays["line"][before : ex.rows.count]
        made[:] = numbers[made]
        return at

    def again(
        self, ex: Straight, span: Span, words: list[tuple[str, Value, Span]], motion: str, distances: str
    ) -> None:  # fmt: skip
        """Execute a line of a loop that the kernel left over."""
        ex._line(span, words)

    def cells(self, ex: Straight, cell: PlainCell, places: Any, line: int) -> int:
        """Run cells of an array, each of them ``cell``; returns how many. places, line: see ``run_cells``."""
        return 0

    def call(self, ex: Executor, node: Call) -> None:
        """Run a subprogram with the words of its call."""
        ex._called(node.name, node.span)

    def named(self, ex: Emitter, node: Named) -> Value:
        """What the controller holds under a name; Refusal GP113 where it knows no names."""
        raise Refusal(codes.UNSUPPORTED_CODE.at(node.span, code=node.name))

    def input(self, ex: Emitter, node: Input) -> Value:
        """An input of the controller; Refusal GP113 where a program reads none."""
        if node.kind == "outside":
            return Unknown("what another device gives")
        raise Refusal(codes.UNSUPPORTED_CODE.at(node.span, code=node.kind))

    def unsupported(self, ex: Executor, node: Unsupported) -> None:
        """What a statement that is not modelled leaves unknown, before it is refused: all places and variables."""
        ex.modal.lose_all(node.what.rstrip(","))


def manner_of(rules: LanguageRules) -> Manner:
    """How lines of a language are executed."""
    if rules.one_command:
        from gproof.passes.interpret.wincnc.semantics import SingleManner

        return SingleManner()
    if rules.source_order:
        from gproof.passes.interpret.mcuwin.semantics import DinManner

        return DinManner()
    return Manner()
