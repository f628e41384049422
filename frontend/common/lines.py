"""Plain lines of any dialect: an automaton from a table of steps, and the index of the lines that are not plain.

A dialect gives character classes, and for each state which class leads where; what is missing leads to ``bad``. The
automaton goes two bytes at a time.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from gproof.frontend.common import number_kernels as k
from gproof.ir.mapped import PIECE, forget
from gproof.ir.record import record

Ints = npt.NDArray[Any]


@record(frozen=True, slots=True)
class Automaton:
    """Tables for ``index_lines``: class of a byte as the first and second of a pair, steps, verdicts."""

    row: Any
    column: Any
    pairs: Any
    verdicts: Any


Automata = tuple[Automaton, Automaton]
"""For plain Python (lists), for compiled code (arrays)."""


def automata(
    steps: Mapping[str, Mapping[str, str]],
    classes: Sequence[str],
    class_of: Callable[[int], str],
    ends_with_words: Sequence[str],
    ends_without: Sequence[str],
) -> Automata:
    """Tables of an automaton that starts in the first state of ``steps``, which has a state ``bad``.

    steps: state -> {class: next state}; classes: their names, with ``feed`` for the byte that ends a line; class_of:
    of a byte; ends_*: states in which a line may end, with and without a word; a state whose name starts with
    ``return`` is after a carriage return.
    """
    states = list(steps)
    bad = states.index("bad")
    n = len(classes) + 1  # class 0 stands for "no second byte"
    single = np.full((len(states), n), bad, np.int64)
    single[:, 0] = np.arange(len(states))
    for s, state in enumerate(states):
        for name, after in steps[state].items():
            single[s, 1 + classes.index(name)] = states.index(after)
    pairs = single[single, :] * (n * n)  # [state, first, second] -> state's first entry
    feed = 1 + classes.index("feed")
    pairs[:, feed, :] = k.STOP
    pairs[:, :, feed] = k.STOP
    verdicts = np.zeros(len(states) * n * n, np.uint8)
    for s, state in enumerate(states):
        verdict = k.HAS_WORDS if state in ends_with_words else 0 if state in ends_without else k.NOT_PLAIN
        verdicts[s * n * n] = verdict | (k.HAS_RETURN if state.startswith("return") else 0)
    numbers = np.array([1 + classes.index(class_of(byte)) for byte in range(256)], np.uint16)
    row, column, flat = numbers * np.uint16(n), numbers, pairs.reshape(-1).astype(np.uint16)
    plain = Automaton(row.tolist(), column.tolist(), flat.tolist(), verdicts.tolist())
    return plain, Automaton(row, column, flat, verdicts)


@record(frozen=True, slots=True)
class LineIndex:
    """The lines of a file that are not plain, as columns, and totals.

    ``line``, ``begin``, ``end``: number, first byte, byte after the line's end; words_before: a plain line between the
    special line before (or the top) and this one has a word; words_after: one after the last has.
    """

    line: Ints
    begin: Ints
    end: Ints
    words_before: Ints
    words_after: bool
    line_count: int

    def rows(self) -> Iterator[tuple[int, int, int, int]]:
        """``(line, begin, end, words_before)`` of each line."""
        columns = (self.line, self.begin, self.end, self.words_before)
        for start in range(0, len(self.line), _ROOM):
            yield from zip(*(c[start : start + _ROOM].tolist() for c in columns), strict=True)


_ROOM = 4096


def _end_of_piece(data: bytes, begin: int, end: int) -> int:
    """After the last line end of the piece that starts here; ``end`` when it has none."""
    if end - begin <= PIECE:
        return end
    return data.rfind(b"\n", begin, begin + PIECE) + 1 or end


def index_lines(tables: Automata, data: bytes, begin: int, limit: int, end: int | None = None) -> LineIndex:
    """Find the lines of ``data[begin:end]`` that are not plain; limit: characters that a line may have."""
    end = len(data) if end is None else end
    plain, compiled = tables
    run = k.index_lines.pick(end - begin)
    auto = plain if run is k.index_lines.python else compiled
    source: Any = data if auto is plain else np.frombuffer(data, np.uint8)
    at = [np.empty(_ROOM, np.int64) for _ in range(4)]
    parts: list[list[Ints]] = []
    position, line, words = begin, 1, 0
    while position < end or not parts:
        first, stop = position, _end_of_piece(data, position, end)
        while position < stop or not parts:
            count, position, line, words = run(
                source, position, stop, line, words, limit, auto.row, auto.column, auto.pairs, auto.verdicts, *at
            )
            parts.append([column[:count].copy() for column in at])
        forget(data, first, position)
    numbers, firsts, afters, befores = (np.concatenate(columns) for columns in zip(*parts, strict=True))
    return LineIndex(numbers, firsts, afters, befores, bool(words), line - 1)
