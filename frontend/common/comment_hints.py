"""Comments in the manner of another controller: where code is not understood, which characters begin a comment here."""

from __future__ import annotations

_HERE = {
    # Eding CNC manual 3.2.4.
    "eding": (("(", ";"), "a comment stands in parentheses, or begins with ; and goes to the end of the line"),
    # WinCNC manual, Comment; comchars= of WINCNC.INI.
    "wincnc": (("[", "("), "a comment begins with [ or (; comchars= of WINCNC.INI names further characters"),
    # McuWIN manual 6.
    "mcuwin": (("(", "'"), "a comment stands in parentheses, or begins with ' and goes to the end of the line"),
}
"""By dialect: the signs of its own, and the sentence that says them."""
_ELSEWHERE = (";", "'", "//", "#", "%", "{", "!", "--", "[", "*")
"""What begins a comment in some language."""


def comment_hint(dialect: str, text: str, at: int) -> str:
    """The sentence, where the text at a place begins a comment in another language; "" elsewhere."""
    own, said = _HERE[dialect]
    at -= text[max(0, at - 1) : at + 1] == "//"  # the first slash may have been taken for a block delete
    begins = next((sign for sign in _ELSEWHERE if text.startswith(sign, at)), "")
    # A sign alone may be a slip; with words behind it, it is a comment.
    return said if begins and begins not in own and text[at + len(begins) :].strip() else ""
