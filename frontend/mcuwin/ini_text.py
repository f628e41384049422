"""The lines of an .ini file of McuWIN: sections of ``key=value``, with findings at line and column.

Source: APCI-8001 G-code manual, McuWIN V 2.5.3.133, 2.7 (ToolComp.INI is plain text of a fixed layout) and 14
(McuWIN.ini has sections and keys). What the manual leaves open of such files is in docs/machine-files.md.
"""

from __future__ import annotations

import hashlib
import re
from fractions import Fraction
from pathlib import Path
from typing import Any

from gproof.frontend.common.exact_numbers import LARGEST
from gproof.frontend.common.source import UTF8_MARK, decode
from gproof.ir import codes
from gproof.ir.finding import Code, Findings, Severity, Span
from gproof.ir.record import record

COMMENT_SIGNS = (";", "#", "//", "'")
"""Beginnings of lines that are passed over: no section and no key starts so."""

_END_OF_LINE = re.compile(r"\r\n|\r|\n")
_SECTION = re.compile(r"\s*\[(?P<name>[^\]]*)\]\s*")
_SETTING = re.compile(r"(?P<key>[^=]*+)=(?P<value>.*)", re.DOTALL)
_CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f]")
_NUMBER = re.compile(r"[-+]?(?:[0-9]+[.,]?[0-9]*|[.,][0-9]+)", re.ASCII)
_MOST_DIGITS = 40


@record(frozen=True, slots=True)
class Entry:
    """A line ``key=value``. section, key: as first written in the file; text: the value without blanks around it.

    column, end_column: of the value, from 1, or of the key where there is no value.
    """

    section: str
    key: str
    text: str
    line: int
    column: int
    end_column: int

    @property
    def shown(self) -> str:
        """As findings name it."""
        return f"[{self.section}] {self.key}" if self.section else self.key


class IniText:
    """The sections of a file by folded name, each its entries by folded key, and the findings about it."""

    def __init__(self, path: Path, findings: Findings) -> None:
        self.path = path
        self.name = str(path)
        self.findings = findings
        self.errors = 0
        self.unknown: list[tuple[str, str]] = []
        self.files: list[tuple[str, str]] = []
        self.sections: dict[str, dict[str, Entry]] = {}
        self.names: dict[str, tuple[str, int]] = {}
        """(as written, line) of each section."""
        try:
            raw = path.read_bytes()
        except (OSError, ValueError) as error:
            what = f"{self.name}: {getattr(error, 'strerror', None) or error}"
            self.add(codes.FILE_UNREADABLE, 0, what=what)
            return
        self.files = [(self.name, hashlib.sha256(raw).hexdigest())]
        if b"\0" in raw or raw[:2] in (b"\xff\xfe", b"\xfe\xff"):
            self.add(codes.FILE_UNREADABLE, 0, what=f"{self.name}: not a text file")
            return
        self._parse(decode(raw.removeprefix(UTF8_MARK)))

    def add(self, code: Code, line: int, column: int = 0, end_column: int = 0, **values: Any) -> None:
        """A finding at a place of the file."""
        self.errors += code.severity is Severity.ERROR
        self.findings.add(code.at(Span(self.name, line, column, end_column), **values))

    def bad(self, entry: Entry, what: str) -> None:
        """A finding for the value of a key."""
        self.add(codes.BAD_VALUE, entry.line, entry.column, entry.end_column, key=entry.shown, what=what)

    def report_unknown(self, entry: Entry) -> None:
        """A warning for a key that gproof has never heard of."""
        self.unknown.append((self.path.name, entry.shown))
        self.add(codes.UNKNOWN_KEY, entry.line, entry.column, entry.end_column, key=entry.shown)

    def report_unknown_section(self, section: str) -> None:
        """One warning for a section of which no key is known."""
        name, line = self.names[section]
        self.unknown.append((self.path.name, f"[{name}]"))
        self.add(codes.UNKNOWN_KEY, line, key=f"[{name}]")

    def number(self, entry: Entry) -> Fraction | None:
        """A decimal number with a comma or a point, exactly; None, with a finding, for any other text."""
        value = decimal(entry.text)
        if value is None:
            self.bad(entry, f"{entry.text[:40]!r} is not a number" if entry.text else "there is no number")
        return value

    def _parse(self, text: str) -> None:
        section = ""
        for number, line in enumerate(_END_OF_LINE.split(text.rstrip("\x1a")), 1):
            bare = line.strip()
            if not bare or bare.startswith(COMMENT_SIGNS):
                continue
            control = _CONTROL.search(line)
            if control is not None:
                what = f"control character U+{ord(control.group()):04X} in the line"
                self.add(codes.FILE_UNREADABLE, number, control.start() + 1, control.end() + 1, what=what)
                continue
            header = _SECTION.fullmatch(line)
            if header is not None:
                section = self._open(header["name"].strip(), number)
                continue
            found = None if bare[0] == "[" else _SETTING.fullmatch(line)
            if found is None or not found["key"].strip():
                begin = len(line) - len(line.lstrip()) + 1
                what = "neither [section] nor key=value"
                self.add(codes.FILE_UNREADABLE, number, begin, begin + len(bare), what=what)
                continue
            self._enter(section, number, found)

    def _open(self, name: str, line: int) -> str:
        """The folded name of a section; a second one of that name is an error: which of them is read is not known."""
        folded = name.casefold()
        known = self.names.setdefault(folded, (name, line))
        self.sections.setdefault(folded, {})
        if known[1] != line:
            self.add(codes.BAD_VALUE, line, key=f"[{name}]", what=f"the section is already in line {known[1]}")
        return folded

    def _enter(self, section: str, number: int, found: re.Match[str]) -> None:
        key, value = found["key"].strip(), found["value"].strip()
        part = "value" if value else "key"
        begin = found.end(part) - len(found[part].lstrip())
        name = self.names.get(section, ("", 0))[0]
        entry = Entry(name, key, value, number, begin + 1, begin + len(value or key) + 1)
        before = self.sections.setdefault(section, {}).setdefault(key.casefold(), entry)
        if before is not entry and before.text != entry.text:
            self.bad(entry, f"given again with another value than in line {before.line}")


def decimal(text: str) -> Fraction | None:
    """``5,0``, ``5.0`` or ``5``, exactly; None for anything else and for what is absurdly large."""
    if len(text) > _MOST_DIGITS or _NUMBER.fullmatch(text) is None:
        return None
    value = Fraction(text.replace(",", "."))
    return value if abs(value) <= LARGEST else None
