"""Comments in the manner of another controller: where code is not understood, which characters start a comment here."""

from __future__ import annotations

from gproof.ir.record import record

_ELSEWHERE = (";", "'", "//", "#", "%", "{", "!", "--", "[", "*")
"""What starts a comment in some language."""


@record(frozen=True, slots=True)
class CommentStyle:
    """signs: what starts a comment in a dialect; said: the sentence that says so."""

    signs: tuple[str, ...]
    said: str


def comment_hint(own: CommentStyle, text: str, at: int) -> str:
    """The sentence, where the text at a place starts a comment in another language; "" elsewhere."""
    at -= text[max(0, at - 1) : at + 1] == "//"  # the first slash may have been taken for a block delete
    begins = next((sign for sign in _ELSEWHERE if text.startswith(sign, at)), "")
    # A sign alone may be a slip; with words after it, it is a comment.
    return own.said if begins and begins not in own.signs and text[at + len(begins) :].strip() else ""
