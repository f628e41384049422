"""The page of a finding, docs/codes/GPnnn.md: explanation, programs, and the files that the programs need."""

from __future__ import annotations

import re
import textwrap
from importlib import resources

from gproof.ir.finding import Code

FILES = "\n## Files\n"
"""Where the technical part of a page begins."""

MORE = "..."
"""Before the rest of a program's line that is too long for the page."""


def whole_page(code: Code) -> str:
    """All of a page, as Markdown."""
    page = resources.files("gproof.docs_codes") / f"{code.label}.md"
    return page.read_text(encoding="utf-8").rstrip()


def page_to_read(code: Code) -> str:
    """The explanation and the programs of a page, as Markdown."""
    return whole_page(code).partition(FILES)[0].rstrip()


def within(page: str, width: int) -> str:
    """Markdown with no longer lines: paragraphs and lists anew, the rest of a program's line on the next."""
    out: list[str] = []
    text: list[str] = []

    def end_of_text() -> None:
        if text:
            hanging = "  " if text[0].startswith("- ") else ""
            joined = " ".join(line.strip() for line in text)
            out.extend(
                textwrap.wrap(joined, width, subsequent_indent=hanging, break_long_words=False, break_on_hyphens=False)
            )
            text.clear()

    fence = ""
    for line in page.split("\n"):
        opened = re.match(r"`{3,}", line)
        if fence or opened or not line or line.startswith(("#", "|")):
            end_of_text()
            out.extend(_folded(line, width) if fence else [line])
            fence = "" if fence and line == fence else fence or (opened[0] if opened else "")
            continue
        if line.startswith("- "):
            end_of_text()
        text.append(line)
    end_of_text()
    return "\n".join(out)


def _folded(line: str, width: int) -> list[str]:
    """A line of a program in pieces."""
    pieces, rest = [line[:width]], line[width:]
    while rest:
        room = width - len(MORE)
        pieces.append(MORE + rest[:room])
        rest = rest[room:]
    return pieces
