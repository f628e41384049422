"""Plain lines of Eding: the automaton that recognises them, and what each byte is to the scanner of their words.

The automaton follows the line format of the Eding manual, 3.2: what may follow what in a line of literal
words. Each character class, each state and each step is in the tables below.
"""

from __future__ import annotations

import functools

from gproof.frontend.common import number_kernels as k
from gproof.frontend.common import words
from gproof.frontend.common.lines import Automata, LineIndex, automata, index_lines
from gproof.frontend.common.words import WordBytes, word_bytes
from gproof.ir.columns import Columns

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

    The suffix ``0`` / ``1`` of the states after an item says whether the line has a word so far.
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
    """Find the lines of ``data[begin:end]`` that are not plain; limit: characters that a line may have."""
    return index_lines(_tables(), data, begin, limit, end)


_KINDS = {
    "N": k.NUMBER, "digit": k.DIGIT, "point": k.POINT, "feed": k.FEED, "semicolon": k.COMMENT, "open": k.ROUND,
    "slash": k.DELETE,
}  # fmt: skip


def _kind(byte: int) -> int:
    name = _class_of(byte)
    if name in _LETTERS:
        return ord(chr(byte).upper())
    return _KINDS.get(name, k.MINUS if byte == ord("-") else k.OTHER)


@functools.cache
def _word_bytes() -> WordBytes:
    return word_bytes([_kind(byte) for byte in range(256)], 2)


def scan(data: bytes, begin: int, end: int, line: int, limit: int) -> tuple[Columns, int, int]:
    """Words of the plain lines ``data[begin:end]`` whose first has number ``line``; see ``Program.load``."""
    return words.scan(_word_bytes(), data, begin, end, line, limit)
