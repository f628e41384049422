"""What others wrote inside JSON, XML and programs, so that nothing of it acts on a terminal or a CI server.

As ``driver/escape.py`` does for one line; here the forms have escapes of their own, and are read back as they were.
"""

from __future__ import annotations

import re

from gproof.driver.escape import escaped

_NOT_PLAIN = re.compile("[^\n -~]")


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
