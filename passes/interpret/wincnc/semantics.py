"""Lines of controllers that take one command a line: see ``Dialect``."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from gproof.ir.dialects.wincnc.settings import wincnc_settings
from gproof.ir.end_state import EndState
from gproof.ir.finding import Span
from gproof.ir.machine import Machine
from gproof.ir.program import Array, Block, Call, Input, Named, Program, Unsupported
from gproof.ir.setup import Setup
from gproof.ir.symbolic import Position, Value
from gproof.ir.trace import KNIFE, Op
from gproof.passes.interpret.core.axis_words import letters_of
from gproof.passes.interpret.core.call_stack import Frame, Kept, PlainCell
from gproof.passes.interpret.core.dead_variables import Idle
from gproof.passes.interpret.core.line_decoder_kernels import WordColumns
from gproof.passes.interpret.core.notes_of_sections import common_modes, end_state, left, zero
from gproof.passes.interpret.core.semantics import Dialect, Word
from gproof.passes.interpret.wincnc import line as single
from gproof.passes.interpret.wincnc import part_arrays
from gproof.passes.interpret.wincnc.command import judge_line
from gproof.passes.interpret.wincnc.coupling import go
from gproof.passes.interpret.wincnc.fast_path import PlainLines
from gproof.passes.interpret.wincnc.line_kernels import run_moves
from gproof.passes.interpret.wincnc.readings import read_input, read_named
from gproof.passes.interpret.wincnc.state import WinCncModal, WinCncRun


class WinCncDialect(Dialect[WinCncRun]):
    """Lines of one command.

    plain: what the kernel needs of the machine, made when a table is entered first; cells: arrays whose cells the
    kernel may run, by node.
    """

    kernel = run_moves
    hot_blocks = False  # texts, comments and bare letters also count within lines
    has_own_feeds = True
    stored_places = frozenset("PHT")
    run_type = WinCncRun

    def __init__(self, program: Program) -> None:
        super().__init__(program)
        self.plain: PlainLines | None = None
        self.plain_cells = part_arrays.PlainCells(self.cells)

    def first_state(self, program: Program, setup: Setup, machine: Machine) -> WinCncModal:
        """The state in which a job starts."""
        return WinCncModal(program.rules, setup, machine)

    def nesting(self, machine: Machine) -> int:
        """How deep calls may be within calls (nesting=)."""
        own = wincnc_settings(machine).nesting
        return super().nesting(machine) if own is None else own

    def letters(self, machine: Machine) -> dict[str, int]:
        """Column of each letter that moves an axis."""
        return letters_of(machine)

    def block(self, run: WinCncRun, node: Block, words: list[tuple[str, Value, Span]]) -> None:
        """Execute a line."""
        bare = frozenset(w.letter for w in node.words if w.bare)
        single.run_line(run, node.span, words, texts=node.texts, comment=node.comment, bare=bare)

    def judge_line(self, machine: Machine, span: Span, words: Sequence[Word], bare: frozenset[str]) -> None:
        """Refusal for a line that means nothing by itself."""
        judge_line(self.program.rules, letters_of(machine), span, words)

    def unsupported(self, run: WinCncRun, node: Unsupported) -> None:
        """Nothing: what such a line leaves is for the line itself to say."""

    def line(self, run: WinCncRun, span: Span, words: list[tuple[str, Value, Span]], bare: frozenset[str]) -> None:
        """Execute a line of a table."""
        single.run_line(run, span, words, bare=bare)

    def hot(self, run: WinCncRun, kernel: Any, columns: WordColumns, count: int, at: int, compiled: bool) -> int:
        """Run lines in the kernel from word ``at``; returns the first word it left over."""
        if self.plain is None:
            self.plain = PlainLines(run)
        return self.plain.run(run, kernel, columns, count, at, compiled)

    def cells(self, run: WinCncRun, cell: PlainCell, places: Any, line: int) -> int:
        """Run cells of an array; see ``Manner``."""
        if self.plain is None:
            self.plain = PlainLines(run)
        return self.plain.cells(run, cell, places, line)

    def named(self, run: WinCncRun, node: Named) -> Value:
        """What the controller holds under a name."""
        return read_named(run, node)

    def input(self, run: WinCncRun, node: Input) -> Value:
        """An input of the controller."""
        return read_input(run, node, run.evaluator)

    def call(self, run: WinCncRun, node: Call) -> None:
        """Run a file with the words of its call; local coordinates are the caller's again after it."""
        arguments = tuple((word.letter, run.evaluator.value(word.value)) for word in node.arguments)
        s = run.modal
        kept = Kept(tuple(s.g92), s.own.keep_local, s.own.arguments)
        depth = len(run.flow.stack)
        run.flow.call_subprogram(node.name, node.span)
        if len(run.flow.stack) > depth:
            frame = run.flow.stack[-1]
            assert frame.caller is not None
            frame.caller = replace(frame.caller, before=kept)
            s.own = s.own.but(arguments=arguments, keep_local=False)

    def takes_lost_feed(self, run: WinCncRun, open_feeds: bool) -> bool:
        """One F is the feed of many axes; where none is known it leaves none known."""
        return open_feeds and not run.modal.own.feed_doubt and all(map(math.isnan, run.modal.own.feeds))

    def move(
        self, run: WinCncRun, op: Op, target: list[Position], span: Span, *, center: list[float] | None, turns: int,
        plane: int, length: float | None, programmed: tuple[float, float] | None,
    ) -> None:  # fmt: skip
        """A move, with couplings, locks and a knife."""
        more: dict[str, Any] = {"center": center, "turns": turns, "plane": plane}
        if KNIFE in run.modal.following:
            from gproof.passes.interpret.wincnc.tangential_knife import move

            move(run, op, target, span, length=length, programmed=programmed, **more)
            return
        go(run, op, target, span, length=length, programmed=programmed, **more)

    def array(self, run: WinCncRun, node: Array) -> None:
        """L10: what follows is cut again at each place."""
        part_arrays.begin_array(run, node)

    def next_cell(self, run: WinCncRun, frame: Frame) -> bool:
        """After a cell: to the next one, True; after the last one back to the first, False."""
        return part_arrays.next_cell(run, self.plain_cells, frame)

    def back_from_file(self, run: WinCncRun, kept: Kept | None) -> None:
        """Local coordinates are the caller's again, unless L92 keeps them."""
        part_arrays.back_from_file(run, kept)

    def end_state(self, run: WinCncRun) -> EndState:
        """Local coordinates are those of the start again, unless L92 keeps them (L92); all else stays."""
        modal = run.modal
        found = end_state(run, common_modes(modal, "wincnc"))
        if not modal.own.keep_local:
            first = self.first_state(run.program, run.setup, run.machine)
            found = replace(found, zero=left(zero(modal, first.g92)))
        scales = (("wincnc: scaling", repr(modal.own.scales)), ("wincnc: knife", repr(modal.own.knife)))
        zeros = (("wincnc: machine zero", repr(modal.own.zeros)), ("wincnc: axes", repr(modal.own.sources)))
        coupled = (("wincnc: coupling", repr(modal.own.slaves)), ("wincnc: locked", repr(sorted(modal.own.locked))))
        return replace(found, modes=(*found.modes, *scales, *zeros, *coupled))

    def idle_variables(self) -> Idle:
        """None: commands take variables by name."""
        return Idle()
