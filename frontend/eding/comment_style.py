"""Comments of Eding CNC programs (manual 3.2.4)."""

from __future__ import annotations

from gproof.frontend.common.comment_hints import CommentStyle

COMMENTS = CommentStyle(
    ("(", ";"), "write a comment in parentheses, or from ; to the end of the line"
)  # fmt: skip
