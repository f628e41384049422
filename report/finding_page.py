"""The page of a finding, docs/codes/GPnnn.md: explanation, programs, and the files that the programs need."""

from __future__ import annotations

import re
import textwrap
from importlib import resources

from gproof.ir.finding import Code

FILES = "\n## Files\n"
"""Where the technical part of a page starts."""

MORE = "..."
"""Before the rest of a program's line that is too long for the page."""


def whole_page(code: Code) -> str:
    """All of a page, as Markdown."""
    return _text(f"{code.label}.md").rstrip()


def page_with_files(code: Code) -> str:
    """All of a page, and the files of other pages and of all pages that its programs run with."""
    page = whole_page(code)
    parts = [page]
    names = dict.fromkeys(re.findall(r"\]\(((?:[a-z]+/)?[\w.-]+\.(?:toml|INI))\)", page.partition(FILES)[2]))
    for name in [*names, *["wincnc/CNC.MAC"] * ("wincnc/WINCNC.INI" in names)]:
        language = {"toml": "toml", "INI": "ini"}.get(name.rpartition(".")[2], "gcode")
        parts.append(f"`{name}`, which other pages use too:\n\n```{language} ../{name}\n{_text(name).rstrip()}\n```")
    return "\n\n".join(parts)


def _text(name: str) -> str:
    """A file of docs/codes: of a checkout, or out of the one file that a wheel has for all (setup.py)."""
    folder = resources.files("gproof.docs_codes")
    if (folder / name).is_file():
        return (folder / name).read_text(encoding="utf-8")
    start = f"\f{name}\n"
    found = (folder / "pages.txt").read_text(encoding="utf-8").partition(start)[2]
    return found.partition("\f")[0]


def page_to_read(code: Code) -> str:
    """The explanation and the programs of a page, as Markdown."""
    return whole_page(code).partition(FILES)[0].rstrip()


def within(page: str, width: int) -> str:
    """Markdown with no longer lines: paragraphs and lists wrapped again, the rest of a program's line on the next."""
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
