"""Words that gproof's texts do not use, and what they say instead.

``EVERYWHERE`` is for all that a user reads: findings, hints, help, summaries, README, pages. ``IN_MESSAGES`` is for
what is read at the machine. A word that is part of a hyphenated or dotted name (``spindle-not-told``) is not one of
them, nor is a name in quotes (``'begin'``), nor code in a page: ``prose`` takes it out. ``old_words`` is empty for a
text that is fit to print.
"""

from __future__ import annotations

import functools
import re

EVERYWHERE = {
    r"behind": "after",
    r"told": "reported, said",
    r"(?:nobody|nothing|no one) (?:states?|stated|tells?|says|knows)": "not known, not in the setup file",
    r"stands?": "is",
    r"stood": "was",
    r"ask(?:s|ed)? for": "required, requested, needs",
    r"can not": "cannot",
    r"at the (?:least|most)": "at least",
    r"begins?|began|begun|beginning": "start",
    r"lies|lay|lain": "is",
    r"may (?:lie|stand)": "can be",
    r"mend(?:s|ed|ing)?": "fix",
    r"beside": "next to, with",
    r"leads? nowhere": "does not move",
    r"the way": "path",
    r"some way": "some path",
    r"anew": "again",
    r"as it lies": "as it is",
    r"(?:counts?|counted) in": "is in",
    r"(?:is|are) none of": "is not one of",
    r"else(?=[.,;:]|$)": "otherwise",
}
"""Old words, as regular expressions of lower case text, and what takes their place."""

IN_MESSAGES = {
    r"traverses?|traversed|traversing": "rapid, rapid move",
    r"goes|go": "moves, cuts",
    r"an?other way": "the reverse",
    r"whole(?! (?:numbers?|digits?))": "complete, all of",
    r"the like": "such",
}
"""Those that a page may have, and a message may not."""

ALLOWED = (
    r"stands? (?:for|still|up to)",
    r"stand-alone|standstill",
    r"all the way|(?:on|by) the way|the way (?:that|in which|you|it|to)",
    r"or (?:something )?else",
    r"(?:is|are|be) told apart",
    r"go (?:on|back|to page)|goes (?:on|back)",
)
"""Phrases in which an old word is the right one."""

_NAME = re.compile(r"(?<!\w)(['\"])\w+\1(?!\w)")
_EDGE = r"(?<![\w.-]){}(?![\w-])"
_FENCED = re.compile(r"^([ ]*)(```|~~~).*?^\1\2[ ]*$", re.MULTILINE | re.DOTALL)
_INLINE = re.compile(r"(`+)[^`].*?\1", re.DOTALL)
_ADDRESS = re.compile(r"\]\([^)\s]*\)|https?://\S+")


@functools.cache
def _any_of(words: str) -> re.Pattern[str]:
    """Most texts have none of them: one search says so."""
    return re.compile(_EDGE.format(f"(?:{words})"))


def old_words(text: str, *, message: bool = False) -> list[str]:
    """The old words of a text, each with what takes its place: ``behind: after``."""
    plain = _NAME.sub(" ", re.sub(r"\s+", " ", text.lower()))
    for phrase in ALLOWED:
        plain = re.sub(_EDGE.format(f"(?:{phrase})"), " ", plain)
    words = {**EVERYWHERE, **(IN_MESSAGES if message else {})}
    if _any_of("|".join(words)).search(plain) is None:
        return []
    found = ((re.search(_EDGE.format(f"(?:{word})"), plain), instead) for word, instead in words.items())
    return [f"{one[0]}: {instead}" for one, instead in found if one is not None]


def prose(page: str) -> str:
    """A page of Markdown without its blocks of code, code in lines and addresses of links; lines stay lines."""
    for code in (_FENCED, _INLINE, _ADDRESS):
        page = code.sub(lambda found: "\n" * found[0].count("\n") or " ", page)
    return page
