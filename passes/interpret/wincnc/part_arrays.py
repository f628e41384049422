"""Arrays of a part (WinCNC L10): what follows is cut again at the next place; and what outlives a subprogram file.

WinCNC Users Guide, L Codes: L10, L92; M Codes: M98. Which way a grid of rows and columns is walked, the manual does not
say: one row or one column is modelled, a grid where the machine's file states its order.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from gproof.ir import codes
from gproof.ir.dialects.wincnc.settings import wincnc_settings
from gproof.ir.finding import Refusal, Severity
from gproof.ir.program import FLAG_BARE, FLAG_DELETE, Array, Block, BlockTable
from gproof.ir.symbolic import NOWHERE, Unknown
from gproof.ir.trace import Op
from gproof.passes.interpret.core.block_compiler import FALLS_BACK, compile_block
from gproof.passes.interpret.core.block_tables import CHUNK_BYTES
from gproof.passes.interpret.core.call_stack import Cells, Frame, Kept, PlainCell

if TYPE_CHECKING:
    from gproof.passes.interpret.wincnc.state import WinCncRun

FEW_CELLS = 4
"""So many cells at once are worth the call."""
MOST_LINES = 1000
"""Lines of a cell that is run with others at once; in longer ones what is between cells is no matter."""


class PlainCells:
    """Cells that a kernel may run.

    run: runs some, see ``PlainLines.cells``; known: by array its cell, None where that is not plain.
    """

    def __init__(self, run: Callable[[WinCncRun, PlainCell, Any, int], int]) -> None:
        self.run = run
        self.known: dict[int, PlainCell | None] = {}


def begin_array(run: WinCncRun, node: Array) -> None:
    """Enter the body of an array; Refusals become findings, and the body runs once then."""
    s = run.modal
    cells: Cells | None = None
    is_open = False
    try:
        cells = _cells(run, node)
    except Refusal as refusal:
        finding = run.as_accepted(refusal.finding)
        is_open = finding.severity is not Severity.ERROR
        run.refuse(finding)
    run.flow.order.enter(node.span)
    run.flow.stack.append(Frame(node.body, node, cells=cells))
    s.own = s.own.but(cell_open=cells is not None and cells.count > 1)
    if is_open:
        s.position[0] = s.position[1] = NOWHERE
        s.jumped = True


def _cells(run: WinCncRun, node: Array) -> Cells:
    s = run.modal
    values: dict[str, float] = {}
    for word in node.words:
        if word.letter not in "RCXYE" or word.letter in values:
            raise Refusal(
                codes.ARRAY_PARAMETERS.at(word.span, code="L10", what=f"{word.letter} is not one of R C X Y E")
            )
        value = run.evaluator.value(word.value)
        if isinstance(value, Unknown):
            raise Refusal(codes.UNKNOWN_CONDITION.at(word.span, cause=value.cause))
        values[word.letter] = value
    _need_own_axes(run, node)
    rows, columns = values.get("R", 1.0), values.get("C", 1.0)
    for letter, count in (("R", rows), ("C", columns)):
        if count < 1 or count != round(count) or count > 1_000_000:
            what = f"{letter} is {count:g}, which is not a number of rows or columns"
            raise Refusal(codes.ARRAY_PARAMETERS.at(node.span, code="L10", what=what))
    x, y = values.get("X", 0.0) * s.scale(0), values.get("Y", 0.0) * s.scale(1)
    order = wincnc_settings(run.machine).array_order
    if order:
        where = s.position[0], s.position[1]
        return Cells(int(rows), int(columns), (x, y), where, goes_back="E" not in values, by_rows=order == "rows")
    if rows > 1 and columns > 1:
        what = "L10 with several rows and several columns (the manual does not say in which order they are cut)"
        raise Refusal(codes.UNSUPPORTED_CODE.at(node.span, code=what))
    beside = y if columns > 1 else x
    if rows * columns > 1 and beside != 0.0:
        what = "L10 of one row or column with a distance across (the manual does not say whether it is used)"
        raise Refusal(codes.UNSUPPORTED_CODE.at(node.span, code=what))
    return Cells(int(rows), int(columns), (x, y), (s.position[0], s.position[1]), goes_back="E" not in values)


def _need_own_axes(run: WinCncRun, node: Array) -> None:
    """Refusal GP113 where X or Y do not go where their words say: whether the way to a cell does is not said."""
    single = run.modal.own
    moved = {axis for axis in (0, 1) if single.sources[axis] != axis}
    moved |= {source for axis, source in enumerate(single.sources) if source in (0, 1) and axis != source}
    bound = {axis for pair in single.slaves for axis in pair} | single.locked
    if moved or bound & {0, 1} or run.modal.transform.on:
        what = "L10 while X or Y is mapped, coupled, locked, scaled or turned (the path to a cell is not in the manual)"
        raise Refusal(codes.UNSUPPORTED_CODE.at(node.span, code=what))


def next_cell(run: WinCncRun, cells_of: PlainCells, frame: Frame) -> bool:
    """After a cell: to the next one, True; after the last one back to the first, False."""
    cells = frame.cells
    assert cells is not None
    run.flow.hot_blocks.run_pending()
    frame.cell += 1
    try:
        _need_own_axes(run, frame.node)  # type: ignore[arg-type]
    except Refusal as refusal:
        run.refuse(run.as_accepted(refusal.finding))
        run.modal.position[0] = run.modal.position[1] = NOWHERE
        run.modal.jumped = True
        return False
    if run.modal.own.cell_open and NOWHERE in run.modal.position[:2]:
        # Its words of X and Y were refused, which those of each further cell would be too.
        run.modal.position[0] = run.modal.position[1] = NOWHERE
        run.modal.jumped = True
        return False
    again = frame.cell < cells.count
    run.modal.own = run.modal.own.but(cell_open=again)
    if not again and not cells.goes_back:
        return False
    assert isinstance(frame.node, Array)
    target = list(run.modal.position)
    times = cells.place(frame.cell) if again else (0, 0)
    for axis in (0, 1):
        target[axis] = cells.start[axis].moved(times[axis] * cells.step[axis])
    if target != run.modal.position:
        run.move(Op.TRAVERSE, target, frame.node.span)
    if again:
        run.spend(frame.node.span)
        frame.at = 0
        _many_cells(run, cells_of, frame, cells)
    return again


def _many_cells(run: WinCncRun, cells_of: PlainCells, frame: Frame, cells: Cells) -> None:
    """At the start of a cell: those that are only plain lines, all but the last, at once."""
    node = frame.node
    assert isinstance(node, Array)
    left = cells.count - 1 - frame.cell
    if left < FEW_CELLS:
        return
    if id(node) not in cells_of.known:
        cells_of.known[id(node)] = _plain_cell(run, node)
    cell = cells_of.known[id(node)]
    places = [run.modal.position[axis] for axis in (0, 1)]
    if cell is None or any(a.form != b.form for a, b in zip(places, cells.start, strict=True)):
        return
    room = (run.alarm - 1 - run.blocks) // (cell.lines + 1)
    if room < 1:
        return
    next_ones = np.arange(frame.cell + 1, frame.cell + 1 + min(left, room))
    if cells.by_rows:
        column, row = next_ones % cells.columns, next_ones // cells.columns
    else:
        column, row = next_ones // cells.rows, next_ones % cells.rows
    # As ``next_cell`` has them.
    ends = np.stack(
        [cells.start[axis].value + times * cells.step[axis] for axis, times in enumerate((column, row))], axis=1
    )
    file, run.file = run.file, cell.file
    done = cells_of.run(run, cell, ends, node.span.line)
    run.file = file
    if done:
        frame.cell += done
        run.blocks += done


def back_from_file(run: WinCncRun, kept: Kept | None) -> None:
    """A subprogram that is a file is over: local coordinates are the caller's again, unless L92 keeps them."""
    if kept is None:
        return
    s = run.modal
    if not s.own.keep_local:
        s.g92 = list(kept.local)
    s.own = s.own.but(keep_local=kept.keep_local, arguments=kept.arguments)
    run.state_changed()


def _plain_cell(run: WinCncRun, node: Array) -> PlainCell | None:
    """The words of a cell where they are literal, all of one file; None where they are not."""
    line: list[int] = []
    letter: list[int] = []
    value: list[float] = []
    flags: list[int] = []
    zeros: tuple[tuple[str, float], ...] = ()
    file, lines = run.file, 0
    for one in node.body:
        if isinstance(one, BlockTable):
            words, after, _ = run.ahead.load(one, one.begin, one.first_line, CHUNK_BYTES)
            if after < one.end or one.file != file or (words["flags"] & FLAG_DELETE).any():
                return None
            lines += one.last_line - one.first_line + 1
            line += words["line"].tolist()
            letter += words["letter"].tolist()
            value += words["value"].tolist()
            flags += words["flags"].tolist()
        elif isinstance(one, Block):
            fast = None if one.deleted or one.texts else compile_block(one, run.program.rules)
            if fast is None or fast.reads or fast.targets or run.file_of(one.span) != file:
                return None
            lines += 1
            try:
                value += fast.run({})
            except FALLS_BACK:
                return None
            line += [one.span.line] * len(fast.letters)
            letter += [ord(x) for x in fast.letters]
            flags += [FLAG_BARE * word.bare for word in one.words]
        else:
            return None
    if not 0 < lines <= MOST_LINES:
        return None
    zero_line = 0
    if (letter[0], value[0]) == (ord("G"), 92.0):
        # The local zero that L10 asks each cell for; of any other one the kernel makes nothing.
        zero_line = line[0]
        first = next((n for n, there in enumerate(line) if there != zero_line), len(line))
        zeros = tuple((chr(code), number) for code, number in zip(letter[1:first], value[1:first], strict=True))
        named = [name for name, _ in zeros]
        if not {"X", "Y"} <= set(named) or len(set(named)) < len(named) or set(named) - set("XYZWUVABC"):
            return None
        line, letter, value, flags = line[first:], letter[first:], value[first:], flags[first:]
    types = (line, np.int32), (letter, np.uint8), (value, np.float64), (flags, np.uint8)
    return PlainCell(tuple(np.array(column, dtype=kind) for column, kind in types), lines, file, zeros, zero_line)
