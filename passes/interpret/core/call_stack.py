"""What an execution has still to do, as data: frames of statements, outcomes that wait, groups that come together."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from gproof.ir.columns import Array, Columns
from gproof.ir.finding import Span
from gproof.ir.machine import AXES
from gproof.ir.program import Block, BlockTable, Statement
from gproof.ir.record import field, record
from gproof.ir.symbolic import NOWHERE, Position, Unknown, Value, bounds, is_whole
from gproof.ir.trace import Edge
from gproof.passes.interpret.core.modal_state import Modal


@record(slots=True, eq=False)
class Group:
    """Outcomes of one question, which come together after its block.

    open: how many of them are still on their way; parked: those that have arrived, each in another state. narrowed: by
    the number of a variable what it was before the question, and what the answers have made of it; wide: parked ones by
    what is left of their state without that.
    """

    open: int
    parked: list[Path] = field(default_factory=list)
    narrowed: dict[int, tuple[Value | None, tuple[Value, ...]]] = field(default_factory=dict)
    wide: dict[object, Path] = field(default_factory=dict)


@record(frozen=True, slots=True)
class Kept:
    """Of a caller: its local coordinates, whether it keeps them (L92), the words it was called with itself."""

    local: tuple[Position, ...]
    keep_local: bool
    arguments: tuple[tuple[str, Value], ...]


@record(frozen=True, slots=True)
class Cells:
    """An array that is being cut: a grid of cells, and the path back from the last one.

    step: mm in X from column to column, in Y from row to row; start: where the first cell starts; by_rows: a row is cut
    whole before the next one.
    """

    rows: int
    columns: int
    step: tuple[float, float]
    start: tuple[Position, Position]
    goes_back: bool
    by_rows: bool = True

    @property
    def count(self) -> int:
        """How many cells there are."""
        return self.rows * self.columns

    def place(self, cell: int) -> tuple[int, int]:
        """Column and row of a cell, from 0."""
        if self.by_rows:
            return cell % self.columns, cell // self.columns
        return cell // self.rows, cell % self.rows


@record(frozen=True, slots=True, eq=False)
class PlainCell:
    """Literal words that each cell of an array is: line, letter, value and flags; how many lines, and of which file.

    zeros: words of the G92 that it starts with, which are not among ``columns``; zero_line: its line, 0 for none.
    """

    columns: tuple[Array, ...]
    lines: int
    file: int
    zeros: tuple[tuple[str, float], ...] = ()
    zero_line: int = 0


@record(frozen=True, slots=True)
class Caller:
    """Where a call came from; rest: words of its line that are executed when it is back.

    before: what of the state is to be as it was when a subprogram that is a file is over. back: (number of a parameter,
    number of the variable that it was given) of a procedure, which takes what it holds when the procedure is over.
    numbers: the variables as they were, where a subprogram calls itself.
    """

    call: int
    file: int
    rest: tuple[Span, list[tuple[str, Value, Span]]] | None
    before: Kept | None = None
    back: tuple[tuple[int, int], ...] = ()
    numbers: dict[int, Value] | None = field(default=None, compare=False, repr=False)


ANY = -1
"""Of a call: it runs its subprogram any number of times more."""


@record(slots=True)
class Frame:
    """Statements that are being executed: those of ``body`` from ``at`` on, or the words of a table from ``at`` on.

    node: the block, subprogram or table they belong to, None for the job itself; group: outcomes come together after
    it; cells, cell: of an array, and which of them it is. For tables: the words of the piece that was loaded, in
    columns for the kernel, lines that it must not run and where their words are, and where the next piece starts;
    continued: what a line of it without a code goes on with.
    again: how often a subprogram runs once more, ``ANY`` where that is left open; more: how often it may besides;
    counter, last: of a counted loop, its variable's value and its end; is_open: how often it runs is left open.
    """

    body: tuple[Statement, ...]
    node: object = None
    at: int = 0
    caller: Caller | None = None
    group: Group | None = None
    words: Columns | None = None
    columns: Any = ()
    cold: set[int] = field(default_factory=set)
    stops: list[int] = field(default_factory=list)
    base: int = 0
    next_byte: int = 0
    line: int = 0
    cells: Cells | None = None
    cell: int = 0
    around: bool = False
    continued: str = ""
    again: int = 0
    more: int = 0
    counter: float = 0.0
    last: Value = 0.0
    is_open: bool = False

    def position(self) -> tuple[object, ...]:
        """The place in a table, in an array, in what is repeated."""
        return (
            self.base, self.next_byte, self.cell, self.cells, self.continued, self.again, self.more, self.counter,
            self.last,
            self.is_open,
        )  # fmt: skip

    def next_line(self) -> int:
        """The line of a table that comes next, 0 after its end."""
        if self.words is not None and self.at < len(self.words):
            return int(self.words["line"][self.at])
        return 0


@record(frozen=True, slots=True, eq=False)
class HotLine:
    """A line of motion that is evaluated ahead of its execution.

    node: its block, or None for a line of a table, which is ``table``: (table, words, ``begin``, ``end``, first byte
    of the piece). motion: the code that moves it, as ``Block.continued``; added: that code is in front of its own
    words. call: of the call that it is in (an index of ``Trace.calls``), -1 for the one that runs.
    """

    number: int
    file: int
    letters: tuple[str, ...]
    node: Block | None = None
    table: tuple[BlockTable, Columns, int, int, int] | None = None
    motion: str = ""
    added: bool = False
    call: int = -1

    @property
    def words(self) -> int:
        """How many there are, what was added included."""
        return len(self.letters)


class Stretch:
    """Lines of motion that are executed together: their words in columns but for the values.

    letter: (words,) u1; line: (words,) i4, counts ``lines``; numbers: (lines,) i4, where they are in the source;
    places: (2, lines) i4, their files and calls, None where they are in the one that runs.
    """

    __slots__ = ("letter", "line", "lines", "numbers", "places")

    def __init__(self, lines: Sequence[HotLine]) -> None:
        self.lines = tuple(lines)
        self.letter = np.array([ord(x) for line in lines for x in line.letters], dtype=np.uint8)
        self.line = np.repeat(np.arange(len(lines), dtype=np.int32), [line.words for line in lines])
        self.numbers = np.array([line.number for line in lines], dtype=np.int32)
        self.places: Array | None = None
        if any(line.call >= 0 for line in lines):
            self.places = np.array([[line.file for line in lines], [line.call for line in lines]], dtype=np.int32)


@record(slots=True)
class Pending:
    """Lines of motion that are evaluated and not executed yet; value: of all their words."""

    parts: list[Stretch] = field(default_factory=list)
    value: list[float] = field(default_factory=list)
    lines: int = 0

    def columns(self) -> tuple[Array, Array, Array, Array]:
        """Line (from 0), letter and value of the words; for each line where it is in the source."""
        sizes = [len(part.line) for part in self.parts]
        first = np.cumsum([0, *(len(part.lines) for part in self.parts)])[:-1]
        line = np.concatenate([part.line for part in self.parts])
        line += np.repeat(first.astype(np.int32), sizes)
        letter = np.concatenate([part.letter for part in self.parts])
        numbers = np.concatenate([part.numbers for part in self.parts])
        return line, letter, np.array(self.value, dtype=np.float64), numbers

    def places(self, file: int, call: int) -> Array | None:
        """(2, lines) i4: files and calls of the lines; None where all are in this one."""
        if all(part.places is None for part in self.parts):
            return None
        here = np.array([[file], [call]], dtype=np.int32)
        found = [np.repeat(here, len(p.lines), axis=1) if p.places is None else p.places for p in self.parts]
        places = np.concatenate(found, axis=1)
        own = places[1] < 0
        places[1, own] = call
        return places

    def nth(self, number: int) -> HotLine:
        """The line that ``line`` counts as ``number``."""
        for part in self.parts:
            if number < len(part.lines):
                return part.lines[number]
            number -= len(part.lines)
        raise IndexError


@record(frozen=True, slots=True)
class Passes:
    """run: (variables, passes to go on after at most, values, stretches) -> (passes that were followed by another one,
    blocks in all of them, how many of these calls only count as, whether the last one is at its end: if not, it has not
    started).

    most: blocks of a pass at most; modes: distance modes in which its lines are (``Block.distances``); reads: numbers
    of the variables. ``run`` raises one of ``FALLS_BACK`` where a variable has no number, before it does anything.
    """

    run: Callable[[dict[int, Any], int, list[float], list[Stretch]], tuple[int, int, int, bool]]
    most: int
    modes: frozenset[str]
    reads: tuple[int, ...]


@record(slots=True)
class Hot:
    """A place whose passes are compiled. make: compiles them; at: where a pass ends in its body; cost: blocks between
    two passes; back, done: how often one was taken back, and how many were done.
    """

    make: Callable[[], Passes | None]
    passes: Passes | None = None
    at: int = 0
    cost: int = 1
    back: int = 0
    done: int = 0


@record(slots=True)
class Path:
    """An outcome that waits to be followed: its frames, its state, its section, its place in the source."""

    stack: list[Frame]
    modal: Modal
    section: int
    place: tuple[int, int, list[str], bool, int]


@record(slots=True)
class Lap:
    """A place that a run comes by again and again: in which state it was there, at its nth visit, of how many.

    saved, modal, key: of the visit that is remembered, twice as far each time (Brent's way to find a cycle);
    section: that started in this state, -1 while there is none; until: the visit at which it is to be the same again.
    full: a counter of 32 bits, its value and its change in a pass.
    witness: a variable that differed when last asked. blocks, branches: of the run at the first visit; span: the loop.
    """

    span: Span
    blocks: int = 0
    branches: int = 0
    count: int = 0
    next: int = 1
    saved: int = 0
    modal: Modal | None = None
    key: object = None
    witness: int | None = None
    section: int = -1
    until: int = 0
    full: tuple[int, float, float] | None = None


@record(slots=True, eq=False)
class Followed:
    """A question whose outcomes were followed, in a state of which only bounds of variables are left open.

    visits: how often it was asked with other bounds; held: what the variables held, the last time; edges: where its
    outcomes lead.
    """

    visits: int = 0
    held: dict[int, Unknown] = field(default_factory=dict)
    edges: tuple[Edge, ...] = ()

    def covers(self, held: dict[int, Unknown]) -> bool:
        """Whether all that variables may be here was followed."""
        return bool(self.edges) and all(_within(value, self.held[number]) for number, value in held.items())

    def widened(self, held: dict[int, Unknown], *, far: bool) -> dict[int, Unknown]:
        """What variables may be here and were before; far: without the ends that move, from the ``FAR``th visit on."""
        self.visits += 1
        if self.visits < JOINED or not self.held:
            return held
        found = {}
        for number, value in held.items():
            old = self.held[number]
            low, high = min(value.low, old.low), max(value.high, old.high)
            if far and self.visits >= FAR:
                low, high = low if low == old.low else -math.inf, high if high == old.high else math.inf
            found[number] = Unknown(value.cause, low, high, value.whole and old.whole)
        return found


JOINED, FAR = 3, 6
"""At so many visits of a question with other bounds of variables it is followed for all of them; and for any value."""


def _within(value: Unknown, other: Unknown) -> bool:
    return other.low <= value.low and value.high <= other.high and (value.whole or not other.whole)


NO_PLACE = Span("", 0)
EXACT = 32
"""So many outcomes are kept apart in every number; after later ones what differs is only bounded."""


APART = 8
"""At most this many outcomes are kept apart because a loop around them needs what differs."""


Somewhere = Callable[[int, float, float, Position], Position]
"""(axis, low, high, origin) -> a place with an unknown of its own."""


def merged(
    paths: list[Path], somewhere: Somewhere, *, exact: bool, asked: Iterable[int] = ()
) -> list[tuple[Path, list[Path]]]:  # fmt: skip
    """Paths that are at one place, as (path that goes on, paths that it stands for).

    When they are not to be kept apart, those that differ in nothing but numbered variables, what the last probing
    move has left and where it has left an axis become one: what differs is unknown between the least and the greatest
    of its values, so that all that any does, the one may do. asked: variables that a loop around them needs; a few
    outcomes that differ in these stay apart, so that one which ends the loop does not go round once more.
    """
    if exact:
        return [(path, [path]) for path in paths]
    alike: dict[object, list[Path]] = {}
    for path in paths:
        alike.setdefault(path.modal.key(parameters=False, probed=False, position=False), []).append(path)
    numbers = sorted(asked)
    out = []
    for same in itertools.chain.from_iterable(map(_by_place, alike.values())):
        parts: dict[object, list[Path]] = {}
        for path in same:
            parts.setdefault(tuple(path.modal.parameters.get(number) for number in numbers), []).append(path)
        found = list(parts.values()) if len(parts) <= APART else [same]
        out += [(_hull(part, somewhere), part) for part in found]
    return out


def _by_place(paths: list[Path]) -> Iterable[list[Path]]:
    """Paths whose axes are at the same places, but for axes of which one of them knows no more than bounds."""
    spreads = [[path.modal.spread(place) for place in path.modal.position] for path in paths]
    is_open = [any(one[axis] is not None and one[axis][1] < one[axis][2] for one in spreads) for axis in range(AXES)]  # type: ignore[index]
    found: dict[object, list[Path]] = {}
    for path, spread in zip(paths, spreads, strict=True):
        key = tuple(
            ends[0] if wide and ends is not None else place
            for place, ends, wide in zip(path.modal.position, spread, is_open, strict=True)
        )
        found.setdefault(key, []).append(path)
    return found.values()


def _hull(paths: list[Path], somewhere: Somewhere) -> Path:
    first = paths[0]
    if len(paths) == 1:
        return first
    modal = first.modal.copy()
    numbers = {number for path in paths for number in path.modal.parameters}
    for number in sorted(numbers):
        own = first.modal.parameters.get(number)
        if own is not None and all(path.modal.parameters.get(number) == own for path in paths):
            continue
        values = [path.modal.read(float(number), NO_PLACE) for path in paths]
        if any(value != values[0] for value in values):
            modal.parameters[number] = _either(values)
    for axis, place in enumerate(first.modal.position):
        if any(path.modal.position[axis] != place for path in paths):
            spreads = [path.modal.spread(path.modal.position[axis]) for path in paths]
            rest = [ends[0] for ends in spreads if ends is not None]
            low, high = min(ends[1] for ends in spreads if ends), max(ends[2] for ends in spreads if ends)
            modal.position[axis] = somewhere(axis, low, high, Position(0.0, rest[0]))
    modal.probe_hit = _either([path.modal.probe_hit for path in paths])
    for axis in range(AXES):
        modal.probed_work[axis] = _either([path.modal.probed_work[axis] for path in paths])
        if any(path.modal.probed[axis] != modal.probed[axis] for path in paths):
            modal.probed[axis] = NOWHERE
    return Path(first.stack, modal, -1, first.place)


def _either(values: list[Value]) -> Value:
    """What is known of a value that may be any of these."""
    if all(value == values[0] for value in values):
        return values[0]
    ends = [bounds(value) for value in values]
    cause = next((value.cause for value in values if isinstance(value, Unknown)), "earlier inputs")
    low, high = min(low for low, _ in ends), max(high for _, high in ends)
    return Unknown(cause, low, high, all(map(is_whole, values)))
