"""Comments of WinCNC programs (manual, Comment; comchars= of WINCNC.INI)."""

from __future__ import annotations

from gproof.frontend.common.comment_hints import CommentStyle

COMMENTS = CommentStyle(
    ("[", "("), "start a comment with [ or (, or with a character of comchars= in WINCNC.INI"
)  # fmt: skip
