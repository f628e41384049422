"""Plain lines: the automaton that recognises them, and the kernels behind plain functions.

The automaton stands on the line format of the Eding manual, 3.2: what may follow what in a line of literal
words. Each character class, each state and each step is in the tables below.
"""

from __future__ import annotations

import functools
import re
from typing import Any

import numpy as np
import numpy.typing as npt

from gproof.frontend.common.lines import Automata, LineIndex, automata, index_lines
from gproof.frontend.eding import scan_kernels as k
from gproof.ir.columns import Columns
from gproof.ir.program import FLAG_DELETE, FLAG_POINT, WORD

Ints = npt.NDArray[Any]

LONGEST_LINE = 1024
"""More bytes than a plain line can have; the line limit of any dialect's rules lies below."""

WORD_LETTERS = "ABCDEFGHIJKLMPQRSTXYZ"
"""Table 3-2 of the manual without N, and E, which M54, M55, M56 (3.5.9) and G76 (3.4.19) use."""

_CLASSES = tuple(
    "blank slash N letter M S G digit sign point open close comma semicolon percent return feed text control high"
    .split()
)  # fmt: skip
"""Character classes; ``text`` is printable ASCII that only comments may hold."""


def _class_of(byte: int) -> str:
    if byte in (9, 32):
        return "blank"
    if byte >= 0x80:
        return "high"
    if byte == 13:
        return "return"
    if byte == 10:
        return "feed"
    if byte < 32 or byte == 127:
        return "control"
    char = chr(byte).upper()
    single = {
        "/": "slash",
        ".": "point",
        "(": "open",
        ")": "close",
        ",": "comma",
        ";": "semicolon",
        "%": "percent",
    }
    if char in single:
        return single[char]
    if char in "NMSG":
        return char
    if char in WORD_LETTERS:
        return "letter"
    if char.isdigit():
        return "digit"
    return "sign" if char in "+-" else "text"


_LETTERS = ("letter", "M", "S", "G")
_BLANK_LOOPS = (
    "start",
    "delete",
    "n0",
    "n1",
    "n2",
    "n3",
    "n4",
    "n5",
    "need",
    "signed",
    "int",
    "dot",
    "real",
    "percent",
)


def _steps() -> dict[str, dict[str, str]]:
    """state -> {class: next state}; what is missing leads to ``bad``.

    The suffix ``0`` / ``1`` of the states behind an item says whether the line has a word so far.
    """
    steps: dict[str, dict[str, str]] = {"start": {}, "bad": {}}
    word = dict.fromkeys(_LETTERS, "need")
    end0 = {"open": "comment0", "semicolon": "rest0", "return": "return0"}
    end1 = {"open": "comment1", "semicolon": "rest1", "return": "return1"}
    steps["start"] = word | end0 | {"slash": "delete", "N": "n0", "percent": "percent"}
    steps["delete"] = word | end0 | {"N": "n0"}
    steps["n0"] = {"digit": "n1"}
    for digits in range(1, 6):
        steps[f"n{digits}"] = word | end0 | ({"digit": f"n{digits + 1}"} if digits < 5 else {})
    steps["need"] = {"sign": "signed", "digit": "int", "point": "dot"}
    steps["signed"] = {"digit": "int", "point": "dot"}
    steps["int"] = word | end1 | {"digit": "int", "point": "real"}
    steps["dot"] = {"digit": "real"}
    steps["real"] = word | end1 | {"digit": "real"}
    steps["percent"] = {"semicolon": "rest0", "return": "return0"}
    for state in _BLANK_LOOPS:
        steps[state]["blank"] = state
    for has in "01":
        steps[f"item{has}"] = word | (end1 if has == "1" else end0) | {"blank": f"item{has}"}
        inside = {c: f"comment_text{has}" for c in _CLASSES if c not in ("open", "return", "feed", "control")}
        inside["close"] = f"item{has}"
        steps[f"comment_text{has}"] = inside
        begins = inside | {"blank": f"comment{has}", "M": f"comment_m{has}"}
        steps[f"comment{has}"] = begins
        for state, char, after in (("m", "S", "s"), ("s", "G", "g")):
            again = {"blank": f"comment_{state}{has}", char: f"comment_{after}{has}"}
            steps[f"comment_{state}{has}"] = inside | again
        steps[f"comment_g{has}"] = inside | {"blank": f"comment_g{has}", "comma": "bad"}
        rest = {c: f"rest{has}" for c in _CLASSES if c not in ("return", "feed", "control")}
        steps[f"rest{has}"] = rest | {"return": f"return{has}"}
        steps[f"return{has}"] = {}
    return steps


_ENDS_WITH_WORDS = ("int", "real", "item1", "rest1", "return1")
_ENDS_WITHOUT = ("start", "delete", "n1", "n2", "n3", "n4", "n5", "item0", "rest0", "percent", "return0")


@functools.cache
def _tables() -> Automata:
    """The automaton for plain Python and for compiled code."""
    return automata(_steps(), _CLASSES, _class_of, _ENDS_WITH_WORDS, _ENDS_WITHOUT)


def index(data: bytes, begin: int, limit: int, end: int | None = None) -> LineIndex:
    """Find the lines of data[begin:end] that are not plain; limit: characters that a line may have."""
    return index_lines(_tables(), data, begin, limit, end)


_POWERS = [10.0**n for n in range(k.DECIMALS_LIMIT + 1)]


def scan(data: bytes, begin: int, end: int, line: int, limit: int) -> tuple[Columns, int, int]:
    """Words of the plain lines data[begin:end] whose first has number ``line``; see ``Program.load``.

    Stops at the first line end at or behind ``begin + limit``. Returns (WORD columns with offsets from
    ``begin``, next byte, number of the next line).
    """
    room = (min(end - begin, limit + LONGEST_LINE)) // 2 + 1
    columns = {c.name: np.empty(room, np.dtype(c.dtype)) for c in WORD.columns}
    run = k.scan_words.pick(min(end - begin, limit))
    source: Any = data
    powers: Any = _POWERS
    if run is not k.scan_words.python:
        source, powers = np.frombuffer(data, np.uint8), np.array(_POWERS)
    count, after, next_line = run(source, begin, end, line, limit, powers, *columns.values())
    columns = {name: column[:count] for name, column in columns.items()}
    _fix_inexact(data, begin, columns)
    return Columns(WORD, columns), after, next_line


_NUMBER = re.compile(rb"[-+0-9. \t]*")


def _fix_inexact(data: bytes, begin: int, columns: dict[str, Ints]) -> None:
    """Give the values that the kernel's exact path does not cover the value of float(text)."""
    flags = columns["flags"]
    for row in np.flatnonzero(flags & k.FLAG_INEXACT).tolist():
        found = _NUMBER.match(data, begin + int(columns["offset"][row]) + 1)
        assert found is not None
        columns["value"][row] = float(found.group().translate(None, b" \t"))
        flags[row] &= FLAG_POINT | FLAG_DELETE
