"""Findings: what the tool has to say about a place in a file.

A ``Code`` is declared once, in ``ir/codes.py``, with a stable number and name; ``code.at(span, ...)``
makes a ``Finding``. Spans are required: a finding without a place names its file with line 0.
"""

from __future__ import annotations

import enum
from collections.abc import Iterable

from gproof.ir.record import field, record


class Severity(enum.Enum):
    """How much a finding weighs: errors make a job UNSAFE, unknowns make it UNKNOWN."""

    ERROR = "error"
    UNKNOWN = "unknown"
    WARNING = "warning"
    NOTE = "note"


@record(frozen=True, slots=True)
class Span:
    """A place in a source file.

    file: path as the user gave it; line: from 1 (0: the file as a whole);
    column, end_column: from 1, in characters, end exclusive; 0 when unknown.
    """

    file: str
    line: int
    column: int = 0
    end_column: int = 0


@record(frozen=True, slots=True)
class Code:
    """A kind of finding: number (``GP301`` has 301), name, severity, message template, and the property it decides."""

    number: int
    name: str
    severity: Severity
    template: str
    decides: str

    @property
    def label(self) -> str:
        """The stable printed form, such as ``GP301``."""
        return f"GP{self.number:03d}"

    def at(self, span: Span, *, hint: str = "", related: Iterable[Related] = (), **values: object) -> Finding:
        """A finding of this kind at ``span``; ``values`` fill the template."""
        return Finding(self, span, self.template.format(**values), hint, tuple(related), tuple(values.items()))


@record(frozen=True, slots=True)
class Related:
    """A second place that explains a finding."""

    span: Span
    message: str


@record(frozen=True, slots=True)
class Finding:
    """One thing to tell the user; see ``Code``. values: those of the message, lengths in mm, for other units."""

    code: Code
    span: Span
    message: str
    hint: str = ""
    related: tuple[Related, ...] = ()
    values: tuple[tuple[str, object], ...] = field(default=(), compare=False, repr=False)

    @property
    def severity(self) -> Severity:
        """The severity of its code."""
        return self.code.severity


class Refusal(Exception):
    """A stage can not go on: carries the finding that says why."""

    def __init__(self, finding: Finding) -> None:
        super().__init__(finding.message)
        self.finding = finding


@record(slots=True)
class Findings:
    """A collector with a cap for each code, so that a million-line job does not print a million lines.

    ``counts`` holds every occurrence by code; ``kept`` the first ``limit`` different findings of each code in
    order of arrival; ``times`` how often each kept one came.
    """

    limit: int = 20
    kept: list[Finding] = field(default_factory=list)
    counts: dict[int, int] = field(default_factory=dict)
    times: dict[Finding, int] = field(default_factory=dict)
    _different: dict[int, int] = field(default_factory=dict)

    def add(self, finding: Finding) -> None:
        """Count a finding; keep it when it is new and its code is below the cap."""
        number = finding.code.number
        self.counts[number] = self.counts.get(number, 0) + 1
        if finding in self.times:
            self.times[finding] += 1
            return
        different = self._different.get(number, 0)
        if different < self.limit:
            self._different[number] = different + 1
            self.times[finding] = 1
            self.kept.append(finding)

    def has(self, severity: Severity, properties: Iterable[str] | None = None) -> bool:
        """True when a kept finding of that severity belongs to one of ``properties`` (all: None)."""
        wanted = None if properties is None else set(properties)
        return any(f.severity is severity and (wanted is None or f.code.decides in wanted) for f in self.kept)

    def hidden(self, code: Code) -> int:
        """How many findings of a code were counted but not kept."""
        shown = sum(times for finding, times in self.times.items() if finding.code.number == code.number)
        return max(0, self.counts.get(code.number, 0) - shown)
