"""The lines of an .ini file: sections of ``key = value``, with findings at their lines.

``Ini`` holds the values by section (upper case) and key (lower case); every reader gives None for a missing key, and
for a bad value with its finding.
"""

from __future__ import annotations

import re
from fractions import Fraction
from pathlib import Path
from typing import Any

from gproof.frontend.common.exact_numbers import LARGEST, exact_ratio
from gproof.ir import codes
from gproof.ir.finding import Code, Findings, Span
from gproof.ir.record import record

_LINE = re.compile(
    r"\s*+(?:\[(?P<section>[^\]]*)\]|(?P<key>[^=;#\[\]]++)=\s*+(?P<value>\"[^\"]*\"|[^;#]*))\s*(?:[;#].*)?$"
)
NUMBERED = re.compile(r"(JOINT|SPINDLE|TOOL)_(\d{1,2})$")
"""Sections of which a file has several."""


@record(frozen=True, slots=True)
class Value:
    """What comes after a key: its text, its line, the key as written."""

    text: str
    line: int
    key: str


class Ini:
    """The values of a file by section and lower-case key, with findings at their lines."""

    def __init__(self, name: str, findings: Findings) -> None:
        self.name = name
        self.findings = findings
        self.errors = 0
        self.unknown: list[tuple[str, str]] = []
        self.sections: dict[str, dict[str, Value]] = {}

    def add(self, code: Code, line: int, **values: Any) -> None:
        """A finding at a line."""
        if code is not codes.UNKNOWN_KEY:
            self.errors += 1
        self.findings.add(code.at(Span(self.name, line), **values))

    def parse(self, text: str) -> None:
        """Read the whole file."""
        section: dict[str, Value] = {}
        for number, line in enumerate(text.splitlines(), 1):
            if not line.strip() or line.lstrip()[0] in ";#":
                continue
            found = _LINE.match(line)
            if found is None:
                self.add(codes.FILE_UNREADABLE, number, what="neither [section] nor key = value")
            elif found["section"] is not None:
                section = self.sections.setdefault(found["section"].strip().upper(), {})
            else:
                key, value = found["key"].strip(), found["value"].strip().strip('"').strip()
                before = section.setdefault(key.lower(), Value(value, number, key))
                if before.text != value:
                    what = f"given again with another value than in line {before.line}"
                    self.add(codes.BAD_VALUE, number, key=key, what=what)

    def text(self, section: str, key: str) -> str | None:
        """The text of a key as written, without quotes."""
        value = self.sections.get(section, {}).get(key.lower())
        return None if value is None else value.text

    def bad(self, section: str, key: str, what: str) -> None:
        """A finding for the value of a key."""
        value = self.sections[section][key.lower()]
        self.add(codes.BAD_VALUE, value.line, key=f"[{section}] {value.key}", what=what)

    def exact(self, section: str, key: str) -> Fraction | None:
        """A decimal number, exactly."""
        text = self.text(section, key)
        if text is None:
            return None
        value = exact_ratio(text) if "/" not in text else None
        if value is None or abs(value) > LARGEST:
            self.bad(section, key, f"{text!r} is not a number")
            return None
        return value

    def number(self, section: str, key: str, unit: Fraction = Fraction(1)) -> float | None:
        """A number times ``unit``, rounded once."""
        value = self.exact(section, key)
        return None if value is None else float(value * unit)

    def at_least(self, section: str, key: str, low: float, unit: Fraction = Fraction(1)) -> float | None:
        """A number not below ``low``."""
        value = self.number(section, key, unit)
        if value is not None and value < low:
            self.bad(section, key, f"{self.text(section, key)} is below {low:g}")
            return None
        return value

    def rate(self, section: str, key: str, unit: Fraction = Fraction(1)) -> float | None:
        """A number greater than 0."""
        value = self.number(section, key, unit)
        if value is not None and not value > 0:
            self.bad(section, key, f"{self.text(section, key)} is not greater than 0")
            return None
        return value

    def switch(self, section: str, key: str) -> bool:
        """True for a number other than 0."""
        value = self.exact(section, key)
        return value is not None and value != 0

    def where(self, section: str, *keys: str) -> tuple[str, str] | None:
        """The section and key under which a setting is: ``section`` first, then any other without a number.

        The manual names few sections, and releases differ; the keys are distinctive enough to be found anywhere.
        BAD_VALUE when two places disagree.
        """
        others = [name for name in self.sections if name != section and not NUMBERED.match(name)]
        found = [
            (name, key) for name in (section, *others) for key in keys if key.lower() in self.sections.get(name, {})
        ]
        texts = {self.text(*place) for place in found}
        if len(texts) > 1:
            first, last = (self.sections[name][key.lower()] for name, key in (found[0], found[-1]))
            self.add(
                codes.BAD_VALUE, last.line, key=f"[{found[-1][0]}] {last.key}",
                what=f"another value than that of {first.key} in line {first.line}",
            )  # fmt: skip
        return found[0] if found else None

    def report_unknown(self, line: int, key: str) -> None:
        """A warning for a key or section that gproof has never heard of."""
        self.unknown.append((Path(self.name).name, key))
        self.add(codes.UNKNOWN_KEY, line, key=key)
