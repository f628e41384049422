"""What others wrote, as a terminal may show it: names of jobs, machines, motors, files, reasons and comments.

Built on Unicode's general categories. Whatever would move the cursor, end the line, change colours or turn the order
of the text next to it (control characters, ESC, separators of lines, formats such as the overrides of direction,
surrogates, private ones and those that are not assigned) is printed as its number.

Logs of CI servers are read by programs too: what GitHub's runner takes for a command (``::name`` at the start of a
line, ``##[name]`` anywhere in one: actions/runner, ActionCommand.cs) is broken by the number of one of its characters.
``report/escape.py`` does the same inside JSON, XML and programs.
"""

from __future__ import annotations

import unicodedata

LONGEST = 400
"""Characters of one text that are printed; of more, the start, and how many there are."""


def shown(text: object, longest: int = LONGEST) -> str:
    """One line, in which nothing acts on the terminal; long ones cut, which is said."""
    whole = str(text)
    part = whole if len(whole) <= longest else whole[:longest]
    out = in_one_line(part)
    return out if part is whole else f"{out}... ({len(whole)} characters)"


def in_one_line(text: str) -> str:
    """The same, however long it is."""
    plain = text if text.isprintable() else escaped(text)
    if plain.lstrip().startswith("::"):
        plain = plain.replace("::", r"\x3a:", 1)
    return plain.replace("##[", r"#\x23[")


def escaped(text: str) -> str:
    """Each character that cannot be seen as its number."""
    return "".join(map(_visible, text))


def _visible(character: str) -> str:
    if character.isprintable() or character == " ":
        return character
    if unicodedata.category(character) == "Zs":
        return " "  # a blank of another width
    number = ord(character)
    return f"\\x{number:02x}" if number < 0x100 else f"\\u{number:04x}" if number < 0x10000 else f"\\U{number:08x}"
