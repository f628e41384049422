"""Comments of WinCNC programs (manual, Comment; comchars= of WINCNC.INI)."""

from __future__ import annotations

from gproof.frontend.common.comment_hints import CommentStyle

COMMENTS = CommentStyle(
    ("[", "("), "a comment begins with [ or (; comchars= of WINCNC.INI names further characters"
)  # fmt: skip
