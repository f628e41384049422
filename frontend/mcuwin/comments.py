"""Comments of DIN lines: a single quote to the end of the line, and round brackets (McuWIN manual 6).

The manual says both that comments nest and that they must not; it does not say what a quote does within brackets.
A comment is taken where all these readings leave the same code, and refused where they do not.
"""

from __future__ import annotations

import re

from gproof.frontend.common.comment_hints import CommentStyle
from gproof.ir import codes
from gproof.ir.finding import Refusal, Span

QUOTE = "'"
COMMENTS = CommentStyle(
    ("(", QUOTE), "write a comment in parentheses, or from ' to the end of the line"
)  # fmt: skip
_REST = re.compile(r"[ \t]*(?:'.*)?\Z", re.DOTALL)


def is_rest(text: str, at: int) -> bool:
    """True when nothing but blanks and a quoted comment is after ``at``."""
    return _REST.match(text, at) is not None


def round_comment(text: str, at: int, file: str, line: int, *, nests: bool = False) -> int:
    """Where the comment that starts with the bracket at ``at`` ends; Refusal when it does not, or may end elsewhere.

    nests: they do, as the manual of version 2.5.3.32 says without taking it back.
    """
    flat = text.find(")", at) + 1
    if not flat:
        raise Refusal(codes.UNCLOSED_COMMENT.at(Span(file, line, at + 1, len(text.rstrip()) + 1)))
    nested = _nested_end(text, at)
    flat = nested if nests and nested else flat
    one_end = nested == flat and QUOTE not in text[at:flat]
    if one_end or (nested and is_rest(text, flat) and is_rest(text, nested)):
        return nested
    hint = "use a single quote for a comment to the end of the line: the manual does not say where this one ends"
    raise Refusal(codes.NESTED_COMMENT.at(Span(file, line, at + 1, max(flat, nested) + 1), hint=hint))


def _nested_end(text: str, at: int) -> int:
    """The place after the bracket that closes the one at ``at`` when brackets nest; 0: there is none."""
    depth = 0
    for i in range(at, len(text)):
        depth += {"(": 1, ")": -1}.get(text[i], 0)
        if depth == 0:
            return i + 1
    return 0
