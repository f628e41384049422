"""Lines of rw_SymPas: where a section ends, and the comments (McuWIN manual 7, 10, 12)."""

from __future__ import annotations

import re

from gproof.frontend.mcuwin.notes import Found
from gproof.ir.notes import NoteKind

MODE = re.compile(r"\{[ \t]*\$DINSTART[ \t]*\}", re.IGNORECASE)
_NEXT = re.compile(r"""//|\{|"[^"]*"|'[^']*'""")


def mode_sign(text: str, opened: bool) -> tuple[tuple[int, int] | None, bool]:
    """Start and end of ``{$DINSTART}`` in a line, and whether a comment is open after the line.

    opened: one is open before it.
    """
    at = 0
    while True:
        if opened:
            close = text.find("}", at)
            if close < 0:
                return None, True
            at, opened = close + 1, False
        found = _NEXT.search(text, at)
        if found is None or found[0] == "//":
            return None, False
        at = found.end()
        if found[0] == "{":
            sign = MODE.match(text, found.start())
            if sign is not None:
                return sign.span(), False
            opened = True


def pascal_notes(text: str, at: int, opened: bool) -> list[Found]:
    """The comments of a line from character ``at``; opened: one of an earlier line is open there."""
    begin, found, spans = at, [], []
    while True:
        if opened:
            close = text.find("}", at) + 1
            spans.append((at, close or len(text)))
            at = close or len(text)
        sign = _NEXT.search(text, at)
        if sign is None:
            break
        at, opened = sign.end(), sign[0] == "{"
        if sign[0] == "//":
            spans.append((sign.start(), len(text)))
            break
        if opened:
            at = sign.start()
    code = text[begin:]
    for first, end in spans:
        code = code[: first - begin] + " " * (end - first) + code[end - begin :]
    first_code = begin + len(code) - len(code.lstrip(" \t")) if code.strip(" \t") else len(text)
    before = bool(text[:begin].strip(" \t"))
    for first, end in spans:
        place = int(before or first >= first_code)
        found.append((place, NoteKind.SIGNED, first, text[first:end].rstrip(" \t")))
    return found
