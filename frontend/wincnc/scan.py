"""Plain lines of WinCNC: what they are as an automaton's steps, and their words.

A plain line has only axis letters, I, J, K, R and F, each with a number or without (which counts as 0), at most G0 to
G3 of the codes, and a comment that nothing but comments follows (manual: Command Reference, Axis Specification, G0,
Comment). Which characters start a comment, what a decimal point is and which codes a macro replaces is each machine's.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Iterable

from gproof.frontend.common import number_kernels as k
from gproof.frontend.common import words
from gproof.frontend.common.lines import Automata, LineIndex, automata, index_lines
from gproof.frontend.common.words import WordBytes, word_bytes
from gproof.ir.columns import Columns
from gproof.ir.dialects.wincnc.settings import Lexical
from gproof.ir.record import record

AXIS_LETTERS = "XYZWUVABC"
PLAIN_LETTERS = AXIS_LETTERS + "IJKRF"

NO_LEXICAL = Lexical()
COMMENT_SIGNS = "[(%"
CLOSING = {"[": "]", "(": ")"}

_CLASSES = (
    "blank letter named G zero low digit plus minus point square round close_square close_round comment skip odd"
    " return feed other"
).split()
"""named: a letter that may start the name of a macro; odd: closes comments, and starts one or has lines left out."""


def _class_of(byte: int, lexical: Lexical, names: str) -> str:
    if byte > 127:
        # Which character it is a part of, the rest of the line decides.
        return "other"
    sign = chr(byte)
    char = sign.upper()
    skips = any(char in signs.upper() for signs, _ in lexical.skips)
    if sign in "])" and (skips or sign in lexical.comment_signs):
        return "odd"
    single = {"\n": "feed", "\r": "return", "[": "square", "(": "round", "]": "close_square", ")": "close_round"}
    if char in single and not skips:
        return single[char]
    if skips:
        return "skip"
    if sign in lexical.comment_signs or sign == "%":
        return "comment"
    if char in PLAIN_LETTERS:
        return "named" if char in names else "letter"
    single = {"\t": "blank", " ": "blank", ".": "point", ",": "point" if lexical.comma else "other", "0": "zero",
              "+": "plus", "-": "minus", "G": "G"}  # fmt: skip
    if char in single:
        return single[char]
    return "low" if char in "123" else "digit" if char in "456789" else "other"


_SIGNS = {"plus": "signed", "minus": "signed"}
_DIGITS = ("zero", "low", "digit")
_ENDS_WITH_WORDS = ("code", "code0", "need", "first", "gap", "int", "real", "item", "rest1", "after_square1",
                    "after_round1", "square1", "round1", "return1")  # fmt: skip
_ENDS_WITHOUT = ("start", "rest0", "square0", "round0", "after_square0", "after_round0", "return0")


def _steps(codes: bool, open_names: bool) -> dict[str, dict[str, str]]:
    """state -> {class: next state}; what is missing leads to ``bad``. codes, open_names: see Scanner."""
    steps: dict[str, dict[str, str]] = {"start": {}, "bad": {}}
    begins = {"letter": "need"} | ({"G": "g"} if codes else {})
    items = begins | {"named": "need"}
    ends = [
        {"square": f"square{has}", "round": f"round{has}", "comment": f"rest{has}", "return": f"return{has}"}
        for has in (0, 1)
    ]
    behind = items | ends[1] | {"blank": "item"}
    steps["start"] = begins | ends[0] | {"blank": "start"}
    steps["g"] = {"zero": "code0", "low": "code", "blank": "g", "plus": "gplus"}
    steps["gplus"] = {"zero": "code0", "low": "code"}
    steps["code0"] = {"zero": "code0", "low": "code"} | behind
    steps["code"] = dict(behind)
    number = dict.fromkeys(_DIGITS, "int") | {"point": "dot"}
    steps["need"] = items | ends[1] | number | _SIGNS | {"blank": "gap"}
    steps["gap"] = items | ends[1] | number | _SIGNS | {"blank": "gap"}
    steps["first"] = ends[1] | number | _SIGNS | {"blank": "gap"}
    if open_names:
        steps["start"]["letter"] = "first"
    steps["signed"] = dict(number)
    steps["int"] = behind | dict.fromkeys(_DIGITS, "int") | {"point": "real"}
    steps["dot"] = dict.fromkeys(_DIGITS, "real")
    steps["real"] = behind | dict.fromkeys(_DIGITS, "real")
    steps["item"] = dict(behind)
    for has in (0, 1):
        text = [c for c in _CLASSES if c not in ("odd", "return", "feed")]
        steps[f"rest{has}"] = dict.fromkeys(text, f"rest{has}") | {"return": f"return{has}"}
        for shape in ("square", "round"):
            inside = f"{shape}{has}"
            steps[inside] = dict.fromkeys(text, inside) | {"return": f"return{has}"}
            steps[inside][f"close_{shape}"] = f"after_{inside}"
            steps[f"after_{inside}"] = ends[has] | {"blank": f"after_{inside}"}
        steps[f"return{has}"] = {}
    return steps


@record(frozen=True, slots=True)
class Scanner:
    """The lines and words of a file with the settings of one machine.

    codes: G0 to G3 may be in plain lines; names: letters that may not start one, as names of macros do; open_names:
    no line may start with two letters, since which names macros have is not known.
    """

    lexical: Lexical = NO_LEXICAL
    codes: bool = True
    names: str = ""
    open_names: bool = False

    def index(self, data: bytes, begin: int, limit: int, end: int | None = None) -> LineIndex:
        """Find the lines of ``data[begin:end]`` that are not plain; limit: characters that a line may have."""
        return index_lines(_automata(self), data, begin, limit, end)

    def scan(self, data: bytes, begin: int, end: int, line: int, limit: int) -> tuple[Columns, int, int]:
        """Words of the plain lines ``data[begin:end]`` whose first has number ``line``; see ``Program.load``."""
        return words.scan(word_bytes_of(self.lexical), data, begin, end, line, limit)


def scanner(lexical: Lexical, macros: Iterable[str]) -> Scanner:
    """The scanner of a machine whose macros have these names (in upper case, codes without leading zeros).

    A line that starts with the name of a macro is not plain.
    """
    plain = [name for name in macros if set(name) <= set(f"{PLAIN_LETTERS}G.0123456789")]
    names = "".join(sorted({name[0] for name in plain} - {"G"}))
    return Scanner(lexical, not any(_OWN_CODE.match(name) for name in plain), names)


@functools.cache
def _automata(scanner: Scanner) -> Automata:
    return automata(
        _steps(scanner.codes, scanner.open_names), _CLASSES,
        lambda byte: _class_of(byte, scanner.lexical, scanner.names), _ENDS_WITH_WORDS, _ENDS_WITHOUT,
    )  # fmt: skip


_KINDS = dict.fromkeys(_DIGITS, k.DIGIT) | {"point": k.POINT, "minus": k.MINUS, "feed": k.FEED} | dict.fromkeys(
    ("square", "round", "comment"), k.COMMENT
)  # fmt: skip
"""Nothing but comments is after a comment, whatever starts it."""


def _kind(byte: int, lexical: Lexical) -> int:
    name = _class_of(byte, lexical, "")
    return ord(chr(byte).upper()) if name in ("letter", "G") else _KINDS.get(name, k.OTHER)


@functools.cache
def word_bytes_of(lexical: Lexical) -> WordBytes:
    """What each byte is to ``scan_words``; a word may be its letter alone."""
    return word_bytes([_kind(byte, lexical) for byte in range(256)], 1)


_OWN_CODE = re.compile(r"G0*[0-3](?![0-9.])")
