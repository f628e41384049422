"""Plain lines of McuWIN: what they are as an automaton's steps, and their words.

A plain line has a line number or none, axis letters, I, J, K and F, each with a literal number, at most G0 to G3 of the
codes, and comments at its end (manual 3.1 to 3.4, 5.3, 6). Which letters are axes, and whether small letters are words,
is each machine's.
"""

from __future__ import annotations

import functools

from gproof.frontend.common import number_kernels as k
from gproof.frontend.common import words
from gproof.frontend.common.lines import Automata, LineIndex, automata, index_lines
from gproof.frontend.common.words import WordBytes, word_bytes
from gproof.ir.columns import Columns
from gproof.ir.record import record

LINE_LIMIT = 1000
"""Characters of a plain line at most."""

_CLASSES = (
    "blank letter N G zero low digit plus minus point open close quote text return feed control".split()
)  # fmt: skip
"""Classes of bytes; ``text`` is what only comments may hold."""


@record(frozen=True, slots=True)
class Scanner:
    """The lines and words of files with the settings of one machine.

    axes: letters of its axes, upper case; small: small letters are words too; numbered: a line with words has a number.
    """

    axes: str = "XYZABC"
    small: bool = True
    numbered: bool = False

    def index(self, data: bytes, begin: int, end: int | None = None) -> LineIndex:
        """Find the lines of ``data[begin:end]`` that are not plain."""
        return index_lines(_automata(self), data, begin, LINE_LIMIT, end)

    def scan(self, data: bytes, begin: int, end: int, line: int, limit: int) -> tuple[Columns, int, int]:
        """Words of the plain lines ``data[begin:end]`` whose first has number ``line``; see ``Program.load``."""
        return words.scan(_word_bytes(self), data, begin, end, line, limit)


def _class_of(byte: int, scanner: Scanner) -> str:
    if byte in (9, 32):
        return "blank"
    if byte >= 0x80:
        return "text"
    if byte in (10, 13):
        return "feed" if byte == 10 else "return"
    if byte < 32 or byte == 127:
        return "control"
    char = chr(byte)
    if char.isalpha() and char.islower():
        if not scanner.small:
            return "text"
        char = char.upper()
    single = {".": "point", "(": "open", ")": "close", "'": "quote", "+": "plus", "-": "minus", "0": "zero",
              "G": "G", "N": "N"}  # fmt: skip
    if char in scanner.axes + "IJKF" and char not in single:
        return "letter"
    if char in single:
        return single[char]
    return "low" if char in "123" else "digit" if char in "456789" else "text"


_DIGITS = ("zero", "low", "digit")
_ENDS_WITH_WORDS = ("code", "code0", "int", "real", "item1", "rest1", "return1")
_ENDS_WITHOUT = ("start", "number", "item0", "rest0", "return0")


def _steps(numbered: bool) -> dict[str, dict[str, str]]:
    """state -> {class: next state}; what is missing leads to ``bad``."""
    steps: dict[str, dict[str, str]] = {"start": {}, "bad": {}}
    word = {"letter": "need", "G": "g"}
    ends = [{"quote": f"rest{has}", "open": f"round{has}", "return": f"return{has}"} for has in (0, 1)]
    behind = word | ends[1] | {"blank": "item1"}
    steps["start"] = ends[0] | {"blank": "start", "N": "n"} | ({} if numbered else word)
    steps["n"] = dict.fromkeys(_DIGITS, "number") | {"blank": "n"}
    steps["number"] = dict.fromkeys(_DIGITS, "number") | word | ends[0] | {"blank": "item0"}
    steps["item0"] = word | ends[0] | {"blank": "item0"}
    steps["item1"] = dict(behind)
    steps["g"] = {"zero": "code0", "low": "code", "blank": "g"}
    steps["code0"] = behind | {"zero": "code0", "low": "code"}
    steps["code"] = dict(behind)
    number = dict.fromkeys(_DIGITS, "int") | {"point": "dot"}
    steps["need"] = number | {"blank": "need", "plus": "signed", "minus": "signed"}
    steps["signed"] = dict(number)
    steps["int"] = behind | dict.fromkeys(_DIGITS, "int") | {"point": "real"}
    steps["dot"] = dict.fromkeys(_DIGITS, "real")
    steps["real"] = behind | dict.fromkeys(_DIGITS, "real")
    text = [c for c in _CLASSES if c not in ("return", "feed", "control")]
    for has in (0, 1):
        steps[f"rest{has}"] = dict.fromkeys(text, f"rest{has}") | {"return": f"return{has}"}
        inside = {c: f"round{has}" for c in text if c not in ("open", "close", "quote")}
        steps[f"round{has}"] = inside | {"close": f"closed{has}"}
        steps[f"closed{has}"] = ends[has] | {"blank": f"closed{has}"}
        steps[f"return{has}"] = {}
    return steps


@functools.cache
def _automata(scanner: Scanner) -> Automata:
    return automata(
        _steps(scanner.numbered), _CLASSES, lambda byte: _class_of(byte, scanner), (*_ENDS_WITH_WORDS, "closed1"),
        (*_ENDS_WITHOUT, "closed0"),
    )  # fmt: skip


_KINDS = {
    "N": k.NUMBER, "zero": k.DIGIT, "low": k.DIGIT, "digit": k.DIGIT, "point": k.POINT, "minus": k.MINUS,
    "feed": k.FEED, "quote": k.COMMENT, "open": k.COMMENT,
}  # fmt: skip
"""Nothing but comments is after a comment in brackets."""


def _kind(byte: int, scanner: Scanner) -> int:
    name = _class_of(byte, scanner)
    return ord(chr(byte).upper()) if name in ("letter", "G") else _KINDS.get(name, k.OTHER)


@functools.cache
def _word_bytes(scanner: Scanner) -> WordBytes:
    return word_bytes([_kind(byte, scanner) for byte in range(256)], 2)
