"""What is wrong with a line that the grammar refuses: the code, the place, the words."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from gproof.frontend.eding.prepare import FUNCTIONS, STRUCTURE, Line, LineError
from gproof.ir import codes
from gproof.ir.finding import Code

if TYPE_CHECKING:
    from lark.exceptions import UnexpectedInput

_NUMBERISH = "+-.0123456789"
_COMMENT = re.compile(r"\([^()]*\)|\"[^\"]*\"|[“”„][^“”„]*[“”„]")
_STRUCTURE_WORD = re.compile(
    r"(?<![a-z])(?:end[ \t]*(?:if|while|sub)|" + "|".join(sorted(STRUCTURE)) + r")(?![a-z])", re.IGNORECASE
)


def diagnose(line: Line, error: UnexpectedInput) -> LineError:
    """The mistake in ``line`` at which the grammar stopped."""
    code = line.code
    at = len(code) if getattr(getattr(error, "token", None), "type", "") == "$END" else error.pos_in_stream
    at = min(len(code) if at is None else at, len(code))
    before = _COMMENT.sub(lambda m: " " * len(m.group()), code[:at])
    misplaced = _structure_word(line, at, before)
    if misplaced is not None:
        return misplaced
    if before.count("[") > before.count("]"):
        return _expression(line, at, before)
    run = _number_run(code, at, before)
    if run is not None:
        return run
    letter = re.search(r"([a-z])$", before, re.IGNORECASE)
    if letter and line.rule == "block":
        place = letter.start()
        if letter.group().lower() == "n":
            return _error(line, codes.BAD_LINE_NUMBER, place, at, text="")
        return _error(line, codes.MISSING_VALUE, place, place + 1, letter=letter.group().upper())
    if line.keyword in ("if", "while") and "[" not in before:
        what = f"the condition of {line.keyword!r} stands in brackets"
        return _error(line, codes.BAD_EXPRESSION, at, at + 1, what=what)
    if at >= len(code):
        return _error(line, codes.SYNTAX, at, at, what=_incomplete(line, before))
    what = f"{_shown(code, at)} is not expected here"
    return _error(line, codes.SYNTAX, at, at + 1, what=what)


def _error(line: Line, code: Code, begin: int, end: int, **values: Any) -> LineError:
    """A LineError at code[begin:end]; at the end of the line it points behind the last character."""
    places = line.places
    first = places[min(begin, len(places) - 1)]
    last = places[end - 1] + 1 if begin < end <= len(line.code) else first + 1
    return LineError(code, first, last, **values)


def _shown(code: str, at: int) -> str:
    character = code[at]
    return repr(character) if character.isascii() else f"{character!r} (U+{ord(character):04X})"


def _structure_word(line: Line, at: int, before: str) -> LineError | None:
    """A word of flow control among other code, or other code behind one."""
    place = line.places[min(at, len(line.code))]
    for found in _STRUCTURE_WORD.finditer(line.text):
        if found.start() <= place <= found.end() and (line.rule == "block" or place > line.places[0]):
            word = re.sub(r"[ \t]", "", found.group()).lower()
            what = f"{word!r} must stand on a line of its own"
            return LineError(codes.FLOW_WORD_MISPLACED, found.start(), found.end(), what=what)
    closed = before.count("[") == before.count("]")
    complete = line.keyword not in ("if", "while") or "[" in before
    named = line.keyword not in ("sub", "gosub") or len(before.split()) > 1
    if line.keyword in STRUCTURE and at < len(line.code) and closed and complete and named:
        what = f"code beside {line.keyword!r}: it must stand on a line of its own"
        return _error(line, codes.FLOW_WORD_MISPLACED, at, len(line.code), what=what)
    return None


def _expression(line: Line, at: int, before: str) -> LineError:
    code = line.code
    if at >= len(code):
        depth = 0
        for place in range(len(before) - 1, -1, -1):
            depth += (before[place] == "]") - (before[place] == "[")
            if depth < 0:
                return _error(line, codes.BAD_EXPRESSION, place, place + 1, what="this bracket is not closed")
    name = re.match(r"[a-z]+", code[at:], re.IGNORECASE)
    wants_value = re.search(r"(?:[\[#=<>*/+-]|mod|and|or)$", before, re.IGNORECASE) is not None
    if name and wants_value:
        word = name.group().lower()
        what = f"{word!r} is not a function"
        if word in FUNCTIONS:
            what = f"{word!r} needs its value in brackets"
        return _error(line, codes.BAD_EXPRESSION, at, at + len(word), what=what)
    end = at + (len(name.group()) if name else 1)
    if wants_value:
        what = "a value is missing here"
    elif re.search(r"atan\[.*\]$", before, re.IGNORECASE):
        what = "'atan' takes two values: atan[y]/[x]"
    elif re.search(r"[a-z]$", before, re.IGNORECASE):
        what = "a function needs its value in brackets"
    else:
        what = f"an operator or ']' is expected, not {code[at:end]!r}"
    return _error(line, codes.BAD_EXPRESSION, at, end, what=what)


def _number_run(code: str, at: int, before: str) -> LineError | None:
    return None


def _incomplete(line: Line, before: str) -> str:
    if line.keyword in ("sub", "gosub"):
        return f"{line.keyword!r} needs a name"
    if line.rule == "block" and "#" in before:
        return "a parameter on its own: a setting needs '=' and a value"
    return "the line ends too early"
