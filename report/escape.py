"""What others wrote, as a terminal may show it: names of jobs, machines, motors, files, reasons and comments.

Built on Unicode's general categories. Whatever would move the cursor, end the line, change colours or turn the order
of what stands beside it (control characters, ESC, separators of lines, formats such as the overrides of direction,
surrogates, private ones and those that are not assigned) is printed as its number.

Logs of CI servers are read by programs too: what GitHub's runner takes for a command (``::name`` at the beginning of a
line, ``##[name]`` anywhere in one: actions/runner, ActionCommand.cs) is broken by the number of one of its characters.
"""

from __future__ import annotations

import re
import unicodedata

_NOT_PLAIN = re.compile("[^\n -~]")

LONGEST = 400
"""Characters of one text that are printed; of more, the beginning, and how many there are."""


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


def json_text(value: object, *, indent: int | None = None) -> str:
    """A value as JSON in which whatever would act on a terminal is a JSON escape: it is read back as it was."""
    import json

    text = json.dumps(value, indent=indent, ensure_ascii=False)
    return in_strings(_NOT_PLAIN.sub(_json_escape, text))


def in_strings(text: str) -> str:
    """JSON, or another text whose strings are those of JSON, without commands to a CI server and without DEL."""
    return text.replace("##[", r"#\u0023[").replace("\x7f", r"\u007f")


def _json_escape(found: re.Match[str]) -> str:
    if found[0].isprintable():
        return found[0]
    units = found[0].encode("utf-16-be", "surrogatepass")
    return "".join(f"\\u{units[n]:02x}{units[n + 1]:02x}" for n in range(0, len(units), 2))


def xml_text(document: str) -> str:
    """A document of XML in which whatever would act on a terminal is a reference to the character."""
    plain = _NOT_PLAIN.sub(_xml_reference, document).replace("##[", "#&#35;[")
    return re.sub(r"(?m)^(\s*):(?=:)", r"\1&#58;", plain)


def _xml_reference(found: re.Match[str]) -> str:
    return found[0] if found[0].isprintable() or found[0] == "\t" else f"&#{ord(found[0])};"


def program_line(line: str) -> str:
    """A line of a program with its end, as a terminal may show it: tabs stay."""
    return "\t".join(map(escaped, line.rstrip("\r\n").split("\t"))) + "\n" * line.endswith("\n")


def escaped(text: str) -> str:
    """Each character that can not be seen as its number."""
    return "".join(map(_visible, text))


def _visible(character: str) -> str:
    if character.isprintable() or character == " ":
        return character
    if unicodedata.category(character) == "Zs":
        return " "  # a blank of another width
    number = ord(character)
    return f"\\x{number:02x}" if number < 0x100 else f"\\u{number:04x}" if number < 0x10000 else f"\\U{number:08x}"
