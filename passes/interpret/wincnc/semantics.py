"""Lines of controllers that take one command a line: see ``manner``."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from gproof.ir.finding import Span
from gproof.ir.program import Block, Call, Input, Named, Unsupported
from gproof.ir.symbolic import Value
from gproof.passes.interpret.core.call_stack import Frame, Kept, PlainCell
from gproof.passes.interpret.core.line_decoder_kernels import WordColumns
from gproof.passes.interpret.core.semantics import Manner
from gproof.passes.interpret.wincnc import line as single
from gproof.passes.interpret.wincnc.fast_path import PlainLines
from gproof.passes.interpret.wincnc.line_kernels import run_moves
from gproof.passes.interpret.wincnc.outputs_and_waits import read_input, read_named

if TYPE_CHECKING:
    from gproof.passes.interpret.core.block_tables import Straight
    from gproof.passes.interpret.core.executor import Executor
    from gproof.passes.interpret.core.trace_writer import Emitter


class SingleManner(Manner):
    """Lines of one command. plain: what the kernel needs of the machine, made when a table is entered first."""

    kernel = run_moves

    def __init__(self) -> None:
        self.plain: PlainLines | None = None

    def block(self, ex: Executor, node: Block, words: list[tuple[str, Value, Span]]) -> None:
        """Execute a line."""
        bare = frozenset(w.letter for w in node.words if w.bare)
        single.run(ex, node.span, words, texts=node.texts, comment=node.comment, bare=bare)

    def unsupported(self, ex: Executor, node: Unsupported) -> None:
        """Nothing: what such a line leaves is for the line itself to say."""

    def line(self, ex: Straight, span: Span, words: list[tuple[str, Value, Span]], bare: frozenset[str]) -> None:
        """Execute a line of a table."""
        single.run(ex, span, words, bare=bare)

    def cold(self, ex: Straight, frame: Frame, columns: WordColumns, count: int) -> set[int]:
        """None: of one command a line the kernel hands back what is rare."""
        return set()

    def hot(self, ex: Straight, run: Any, columns: WordColumns, count: int, at: int, compiled: bool) -> int:
        """Run lines in the kernel from word ``at``; returns the first word it left over."""
        if self.plain is None:
            self.plain = PlainLines(ex)
        return self.plain.run(ex, run, columns, count, at, compiled)

    def cells(self, ex: Straight, cell: PlainCell, places: Any, line: int) -> int:
        """Run cells of an array; see ``Manner``."""
        if self.plain is None:
            self.plain = PlainLines(ex)
        return self.plain.cells(ex, cell, places, line)

    def named(self, ex: Emitter, node: Named) -> Value:
        """What the controller holds under a name."""
        return read_named(ex, node)

    def input(self, ex: Emitter, node: Input) -> Value:
        """An input of the controller."""
        return read_input(ex, node, ex.evaluator)

    def call(self, ex: Executor, node: Call) -> None:
        """Run a file with the words of its call; local coordinates are the caller's again behind it."""
        arguments = tuple((word.letter, ex.evaluator.value(word.value)) for word in node.arguments)
        s = ex.modal
        kept = Kept(tuple(s.g92), s.single.keep_local, s.single.arguments)
        depth = len(ex._stack)
        ex._called(node.name, node.span)
        if len(ex._stack) > depth:
            frame = ex._stack[-1]
            assert frame.caller is not None
            frame.caller = replace(frame.caller, before=kept)
            s.single = s.single.but(arguments=arguments, keep_local=False)
