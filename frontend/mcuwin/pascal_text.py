"""Where a section of rw_SymPas ends: ``{$DINSTART}`` outside of its comments and texts (McuWIN manual 10, 12)."""

from __future__ import annotations

import re

MODE = re.compile(r"\{[ \t]*\$DINSTART[ \t]*\}", re.IGNORECASE)
_NEXT = re.compile(r"""//|\{|"[^"]*"|'[^']*'""")


def mode_sign(text: str, opened: bool) -> tuple[tuple[int, int] | None, bool]:
    """Begin and end of ``{$DINSTART}`` in a line, and whether a comment is open behind the line.

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
