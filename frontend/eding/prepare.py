"""A raw line made ready for the grammar: decoded, its kind found, blanks and the ``;`` comment taken out.

Blanks do not change the meaning of a line except inside comments (Eding manual 3.2), so they are removed
with a map back to the columns; texts in quotes, and statements of chapter 4 that hold names, keep theirs.
"""

from __future__ import annotations

import re
from typing import Any

from gproof.ir import codes
from gproof.ir.finding import Code
from gproof.ir.record import record

FUNCTIONS = frozenset("abs acos asin atan cos exp fix fup int ln round sin sqrt tan not".split())
STRUCTURE = frozenset("if else endif while endwhile sub endsub gosub then".split())
"""Words that must be on a line of their own."""

_WITH_EXPRESSIONS = frozenset("if else endif while endwhile endsub msg warnmsg errmsg logmsg".split())
_WITH_NAMES = frozenset(
    "sub gosub dlgmsg logfile tcaguard mcaguard homeisestop setlafangle sp tanknife home hometandem"
    " preparetandemhome moveslavetomaster movestavetomaster".split()
)

PIECE = re.compile(
    r"""(?P<rest>;.*)
      | (?P<comment>\([^()]*\)) | (?P<open>\()
      | (?P<text>"[^"]*"|[“”„][^“”„]*[“”„]) | (?P<quote>["“”„])
      | (?P<blank>[ \t]+) | (?P<code>[^;("“”„ \t]+)""",
    re.VERBOSE,
)
_HEAD = re.compile(
    r"""[ \t]* /? [ \t]* (?:n[ \t]*[0-9][ \t0-9]*)? (?:\([^()]*\)[ \t]*)*
        (?P<word> end[ \t]*(?:if|while|sub)(?![a-z]) | [a-z]+ )""",
    re.VERBOSE | re.IGNORECASE | re.ASCII,
)
NESTING = re.compile(r"[ \t]*%[ \t]*[mdo][ \t]*[xy][ \t]*=", re.IGNORECASE)
"""A preset of the nesting dialog (2.2.4.4); any other text after a percent sign is no code."""
_CONTROL = re.compile(r"[\x00-\x08\x0a-\x1f\x7f]")
SHORTEST_COMMAND = 3
"""Letters from which on a word that starts a line and has no meaning here is a command that the manual lacks."""
_BLANKS = re.compile(r"[ \t]+")


class LineError(Exception):
    """A mistake in a line: code, start and end as indices into the text of the line, template values.

    structure: the word of flow control that the line nevertheless has, so that one mistake in an ``if`` does
    not make its ``endif`` another.
    """

    def __init__(self, code: Code, begin: int, end: int, *, structure: str = "", **values: Any) -> None:
        super().__init__(code.label)
        self.code = code
        self.begin = begin
        self.end = end
        self.structure = structure
        self.values = values


@record(frozen=True, slots=True)
class Line:
    """A prepared line.

    text: as written, without its end; rule: ``block``, ``flow``, or ``foreign`` for a command that the manual does not
    have; keyword: of the latter two, lower case;
    keyword_at: where it is, or -1; code: what the grammar reads; places: for each character of
    ``code`` its index in ``text``, and one more for the end; comment: the text after a semicolon.
    """

    text: str
    rule: str
    keyword: str
    keyword_at: int
    code: str
    places: list[int]
    comment: str


def prepare(text: str) -> Line:
    """Ready a line for the grammar; LineError where it cannot be."""
    control = _CONTROL.search(text)
    if control:
        what = f"control character U+{ord(control.group()):04X} in the line"
        raise LineError(codes.SYNTAX, *control.span(), structure=structure_of(text), what=what)
    keyword, keyword_at = _keyword(text)
    structure = keyword if keyword in STRUCTURE else ""
    is_known = keyword in _WITH_NAMES or keyword in _WITH_EXPRESSIONS or keyword.startswith(("zhc", "%")) or not keyword
    keep_from = keyword_at if keyword not in _WITH_EXPRESSIONS and keyword not in ("", "%") else len(text)
    pieces: list[str] = []
    places: list[int] = []
    comment = ""
    end = len(text)
    for piece in PIECE.finditer(text):
        kind, at = piece.lastgroup, piece.start()
        if kind == "blank" and at < keep_from:
            continue
        if kind == "rest":
            comment = piece.group()[1:].strip()
            end = at
            break
        if kind == "open":
            raise _bad_comment(text, at, structure)
        if kind == "quote" and keyword:
            what = "this text has no closing quote"
            raise LineError(codes.SYNTAX, at, len(text), structure=structure, what=what)
        pieces.append(piece.group())
        places.extend(range(at, piece.end()))
    code = "".join(pieces).rstrip(" \t")
    del places[len(code) :]
    places.append(places[-1] + 1 if places else end)
    rule = "foreign" if not is_known else "flow" if keyword else "block"
    return Line(text, rule, keyword, keyword_at, code, places, comment)


def structure_of(text: str) -> str:
    """The word of flow control that a line starts with, however wrong the rest of it is, or ""."""
    try:
        keyword, _ = _keyword(text)
    except LineError:
        return ""
    return keyword if keyword in STRUCTURE else ""


def _keyword(text: str) -> tuple[str, int]:
    """The statement of chapter 4 that a line starts with and where, or ("", -1) for a line of words."""
    head = _HEAD.match(text)
    if head is None:
        return ("%", text.index("%")) if NESTING.match(text) else ("", -1)
    word = _BLANKS.sub("", head.group("word")).lower()
    at, end = head.span("word")
    is_statement = word in _WITH_EXPRESSIONS or word in _WITH_NAMES or word.startswith("zhc")
    if is_statement and (word != "sp" or text[end : end + 1] in tuple(' \t"“')):
        return word, at
    after = text[end:].lstrip(" \t")[:1]
    is_words = (
        len(word) == 1
        or (word[1:] in FUNCTIONS and after == "[")
        or (len(word) == 2 and (after in "+-.0123456789[#;("))
        or word == "then"
    )
    is_value = after == "[" and word.endswith(tuple(FUNCTIONS))
    if not is_words and not is_value and len(word) >= SHORTEST_COMMAND:
        return word, at
    if not is_words:
        raise LineError(codes.SYNTAX, at, end, what=f"{word!r} is not a statement of this controller")
    return "", -1


def _bad_comment(text: str, at: int, structure: str) -> LineError:
    """Nested when another parenthesis opens inside and the comment is closed somewhere, else unclosed."""
    inner = text.find("(", at + 1)
    if inner >= 0 and text.find(")", inner) >= 0:
        return LineError(codes.NESTED_COMMENT, inner, inner + 1, structure=structure)
    return LineError(codes.UNCLOSED_COMMENT, at, len(text), structure=structure)
