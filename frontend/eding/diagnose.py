"""What is wrong with a line that the grammar refuses: the code, the place, the words.

The grammar says where it stopped; the text before that place says what was under way there. Each function
below recognises one kind of mistake and gives None for the others; ``diagnose`` asks them in order.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from gproof.frontend.common.comment_hints import comment_hint
from gproof.frontend.eding.comment_style import COMMENTS
from gproof.frontend.eding.prepare import FUNCTIONS, STRUCTURE, Line, LineError
from gproof.ir import codes
from gproof.ir.finding import Code
from gproof.ir.record import record

if TYPE_CHECKING:
    from lark.exceptions import UnexpectedInput

_FLAGS = re.IGNORECASE | re.ASCII
_HIDDEN = re.compile(r"\([^()]*\)|\"[^\"]*\"|[“”„][^“”„]*[“”„]")
_STRUCTURE_WORD = re.compile(
    r"(?<![a-z])(?:end[ \t]*(?:if|while|sub)|" + "|".join(sorted(STRUCTURE)) + r")(?![a-z])", _FLAGS
)
_LINE_NUMBER = re.compile(r"/?n[0-9]*", _FLAGS)
_NUMBER_RUN = re.compile(r"[0-9.]+")
_SIGN = re.compile(r"(?<![0-9.\]])[-+]$")
_LETTERS_AT_END = re.compile(r"[a-z]+$", _FLAGS)
_LETTERS = re.compile(r"[a-z]+", _FLAGS)
_OPERATOR_AT_END = re.compile(r"(?:[\[#=<>*/+-]|mod|and|or)$", _FLAGS)
_OPERATOR_WORDS = ("mod", "and", "or", "xor", "band", "bor", "bxor")
_OPERATOR_WORD = re.compile(r"mod|b?and|b?x?or", _FLAGS)
_OPERATOR = re.compile(r"\*\*|[-+*/]|[<>=]+|(?:mod|b?and|b?x?or)(?![a-z])", _FLAGS)


@record(frozen=True, slots=True)
class _Stop:
    """Where the grammar stopped in the code of a line.

    before: the code up to there, comments and texts blanked; depth: brackets that are open.
    """

    line: Line
    at: int
    before: str
    depth: int

    @property
    def rest(self) -> str:
        return self.line.code[self.at :]

    def error(self, code: Code, begin: int, end: int, **values: Any) -> LineError:
        """A mistake at ``code[begin:end]``; an empty range at the end points after the last character."""
        places = self.line.places
        first = places[min(begin, len(places) - 1)]
        last = places[end - 1] + 1 if begin < end <= len(self.line.code) else first + 1
        return LineError(code, first, last, **values)


def diagnose(line: Line, error: UnexpectedInput) -> LineError:
    """The mistake in ``line`` at which the grammar stopped."""
    size = len(line.code)
    at_end = getattr(getattr(error, "token", None), "type", "") == "$END"
    position: Any = error.pos_in_stream
    at = size if at_end else min(position, size)
    before = _HIDDEN.sub(lambda hidden: " " * len(hidden.group()), line.code[:at])
    stop = _Stop(line, at, before, before.count("[") - before.count("]"))
    for kind in (_structure, _line_number, _number, _expression, _missing_value, _operator):
        found = kind(stop)
        if found is not None:
            return found
    if at >= size:
        return stop.error(codes.SYNTAX, at, at + 1, what=_incomplete(stop))
    hint = comment_hint(COMMENTS, line.code, at)
    return stop.error(codes.SYNTAX, at, at + 1, what=_unexpected(stop), **({"hint": hint} if hint else {}))


def _structure(stop: _Stop) -> LineError | None:
    """A word of flow control among other code, or other code after one."""
    line = stop.line
    place = line.places[stop.at]
    for found in _STRUCTURE_WORD.finditer(line.text):
        if found.start() <= place <= found.end() and found.start() != line.keyword_at:
            word = re.sub(r"[ \t]", "", found.group()).lower()
            what = f"{word!r} must be on a line of its own"
            if word == "then":
                what = "'then' is allowed only after the condition of 'if'"
            structure = "" if line.keyword in STRUCTURE else word
            return LineError(codes.FLOW_WORD_MISPLACED, *found.span(), structure=structure, what=what)
    if line.keyword not in STRUCTURE or not stop.rest or stop.depth:
        return None
    complete = {"if": "]", "while": "]"}.get(line.keyword, "")
    named = line.keyword not in ("sub", "gosub") or len(stop.before.split()) > 1
    if complete in stop.before and named:
        what = f"code next to {line.keyword!r}, which must be on a line of its own"
        return stop.error(codes.FLOW_WORD_MISPLACED, stop.at, len(line.code), what=what)
    return None


def _line_number(stop: _Stop) -> LineError | None:
    """N and something that is not one to five digits, at the start of the line or elsewhere."""
    head = _LINE_NUMBER.fullmatch(stop.before)
    if head is None or stop.rest[:1] not in (".", "-", "+", "#", "["):
        letters = _LETTERS_AT_END.search(stop.before)
        if letters is None or letters.group().lower() != "n" or stop.depth or stop.line.rule != "block":
            return None
    begin = stop.before.lower().rindex("n")
    run = re.compile(r"[-+.#\[\]0-9]*").match(stop.line.code, begin + 1)
    assert run is not None
    return stop.error(codes.BAD_LINE_NUMBER, begin, run.end(), text=run.group())


def _number(stop: _Stop) -> LineError | None:
    """Digits and points that make no number, or a sign without one."""
    code, at = stop.line.code, stop.at
    if stop.rest[:1] in tuple(".0123456789"):
        begin = at
        while begin > 0 and stop.before[begin - 1] in ".0123456789":
            begin -= 1
        run = _NUMBER_RUN.match(code, begin)
        assert run is not None
        if begin < at or "." in stop.rest[:1]:
            begin -= _SIGN.search(stop.before[:begin]) is not None
            return stop.error(codes.BAD_NUMBER, begin, run.end(), text=code[begin : run.end()])
    signs = re.search(r"(?<=[a-z=#])[-+]+$", stop.before, _FLAGS)
    if signs and not stop.depth and stop.line.rule == "block":
        more = re.compile(r"[-+.0-9]*").match(code, at)
        assert more is not None
        return stop.error(codes.BAD_NUMBER, signs.start(), more.end(), text=code[signs.start() : more.end()])
    return None


def _expression(stop: _Stop) -> LineError | None:
    """Anything wrong between brackets, a function without them, a parameter without a number."""
    name = _LETTERS.match(stop.rest)
    letters = _LETTERS_AT_END.search(stop.before)
    tail = letters.group().lower() if letters else ""
    word = name.group().lower() if name else ""
    if tail in FUNCTIONS or (tail[1:] in FUNCTIONS and tail):
        begin = len(stop.before) - len(tail) + (tail not in FUNCTIONS)
        function = tail if tail in FUNCTIONS else tail[1:]
        return _bad(stop, begin, stop.at, f"{function!r} needs its value in brackets")
    calls = len(word) > 1 and word not in FUNCTIONS and stop.rest[len(word) :].startswith("[")
    if calls and (stop.depth or len(tail) == 1 or stop.before.endswith(("=", "#", "-", "+"))):
        return _bad(stop, stop.at, stop.at + len(word), f"{word!r} is not a function")
    if re.search(r"atan\[.*\]/?$", stop.before, _FLAGS) and _atan_is_open(stop.before):
        return _bad(stop, stop.at, stop.at + 1, "'atan' needs two values: atan[y]/[x]")
    if stop.depth <= 0:
        return _outside_brackets(stop)
    if not stop.rest:
        return _bad(stop, *_last_open(stop.before), "this bracket is not closed")
    end = stop.at + max(len(word), 1)
    if _OPERATOR_AT_END.search(stop.before) and (not tail or tail in _OPERATOR_WORDS):
        is_name = len(word) > 1 and word not in _OPERATOR_WORDS
        return _bad(stop, stop.at, end, f"{word!r} is not a function" if is_name else "a value is missing here")
    return _bad(stop, stop.at, end, f"an operator or ']' is expected here, not {stop.rest[: end - stop.at]!r}")


def _outside_brackets(stop: _Stop) -> LineError | None:
    keyword = stop.line.keyword
    if stop.before.endswith("#"):
        return _bad(stop, stop.at - 1, stop.at, "'#' needs a parameter number")
    if stop.rest.startswith("]"):
        return _bad(stop, stop.at, stop.at + 1, "']' without '['")
    if keyword in ("if", "while") and "[" not in stop.before:
        return _bad(stop, stop.at, stop.at + 1, f"the condition of {keyword!r} must be in brackets")
    return None


def _bad(stop: _Stop, begin: int, end: int, what: str) -> LineError:
    return stop.error(codes.BAD_EXPRESSION, begin, end, what=what)


def _atan_is_open(before: str) -> bool:
    """Whether the brackets that ``before`` ends with are the first ones of ``atan``."""
    depth = 0
    for at in range(len(before.rstrip("/")) - 1, -1, -1):
        depth += (before[at] == "]") - (before[at] == "[")
        if depth == 0:
            return before[:at].lower().endswith("atan")
    return False


def _last_open(before: str) -> tuple[int, int]:
    """The innermost bracket that is open."""
    depth = 0
    for at in range(len(before) - 1, -1, -1):
        depth += (before[at] == "]") - (before[at] == "[")
        if depth < 0:
            return at, at + 1
    return 0, 1


def _missing_value(stop: _Stop) -> LineError | None:
    """A letter, or a parameter setting, that is not followed by a value."""
    if stop.line.rule != "block" or not stop.rest[:1].isascii():
        return None
    letter = _LETTERS_AT_END.search(stop.before)
    operator = _OPERATOR_WORD.match(stop.line.code, letter.start()) if letter else None
    if letter and operator and re.search(r"[0-9.\]]$", stop.before[: letter.start()]):
        return _bad(stop, letter.start(), operator.end(), f"{operator.group()!r} is allowed only inside brackets")
    if letter:
        return stop.error(codes.MISSING_VALUE, stop.at - 1, stop.at, letter=letter.group()[-1].upper())
    setting = re.search(r"#[^#=]*=$", stop.before)
    if setting:
        return _bad(stop, setting.start(), stop.at, f"{setting.group()[:-1]} is set without a value")
    return None


def _operator(stop: _Stop) -> LineError | None:
    """Arithmetic outside brackets, after a value."""
    operator = _OPERATOR.match(stop.rest)
    if operator is None or stop.line.rule != "block" or not re.search(r"[0-9.\]]$", stop.before):
        return None
    if operator.group() in ("=", "/"):
        return None
    return _bad(stop, stop.at, stop.at + operator.end(), f"{operator.group()!r} is allowed only inside brackets")


_UNEXPECTED = {
    ")": "')' without '('",
    "/": "a block delete slash is allowed only at the start of a line",
    "%": "'%' is allowed only on a line of its own",
    "=": "'=' is allowed only after a parameter",
    '"': "text is allowed only in a message statement",
    "“": "text is allowed only in a message statement",
    "”": "text is allowed only in a message statement",
    "[": "a value has no letter",
}


_SWITCH, _AXIS, _FILE = "'on' or 'off'", "one axis: x, y, z, a, b or c", "the name of a file"
_TAKES = {
    "tcaguard": _SWITCH,
    "mcaguard": _SWITCH,
    "homeisestop": _SWITCH,
    "home": _AXIS,
    "hometandem": _AXIS,
    "preparetandemhome": _AXIS,
    "moveslavetomaster": _AXIS,
    "movestavetomaster": _AXIS,
    "setlafangle": "an angle",
    "sp": f"{_FILE}, then perhaps 0 or 1",
    "logfile": f"{_FILE}, then perhaps 0 or 1",
    "tanknife": "'on' (then perhaps 90 or -90), 'off', 'b', 'c', 'lo' or 'hi'",
    "zhcinit": "three values: grid size, points in X, points in Y",
    "zhcaddpoint": "nothing",
    "zhcs": _FILE,
    "%": "a number: %mx=200",
}
"""What the commands to the controller take after them."""


def _takes(stop: _Stop) -> str:
    return f"{stop.line.keyword!r} needs {_TAKES[stop.line.keyword]}"


def _unexpected(stop: _Stop) -> str:
    character = stop.rest[0]
    if stop.line.rule == "block":
        if character in _UNEXPECTED:
            return _UNEXPECTED[character]
        if character in "0123456789.+-":
            return "a number has no letter"
    if stop.line.keyword in ("msg", "warnmsg", "errmsg", "logmsg", "dlgmsg") and character.isalnum():
        return f"the text of {stop.line.keyword!r} must be in quotes"
    if stop.line.keyword in _TAKES:
        return _takes(stop)
    shown = repr(character) if character.isascii() else f"{character!r} (U+{ord(character):04X})"
    return f"{shown} is not expected here"


def _incomplete(stop: _Stop) -> str:
    if stop.line.keyword in ("sub", "gosub"):
        return f"{stop.line.keyword!r} needs a name"
    if stop.line.keyword in _TAKES:
        return _takes(stop)
    if stop.line.rule == "block" and "#" in stop.before:
        return "a parameter alone is not code: to set it, add '=' and a value"
    return "the line ends too early"
