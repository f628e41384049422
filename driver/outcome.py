"""What ``check`` found out about each of several jobs, as plain data: reports of every format are made from it."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from gproof.driver.conditions import SAFE_IF, word_of_report
from gproof.driver.errors import COULD_NOT_RUN
from gproof.driver.source_text import source_lines
from gproof.ir.record import field, record
from gproof.ir.verdict import Verdict

LEVELS = ("note", "warning", "unknown", "error")
"""Severities of findings, the lightest first."""


@record(frozen=True, slots=True, kw_only=True)
class Outcome:
    """Of one job. report: as docs/check-json.md defines it, None where the job could not be judged; problem: why.

    read: the report with its texts in the unit of the shop, for documents that people read, None where that is the
    millimetre; text: the report as text, lines; code: the exit code; known: of its findings, what a baseline says.
    """

    job: str
    report: dict[str, Any] | None = None
    read: dict[str, Any] | None = None
    problem: str = ""
    text: tuple[str, ...] = ()
    code: int = COULD_NOT_RUN
    known: dict[str, list[dict[str, str]]] = field(default_factory=dict)

    @property
    def verdict(self) -> Verdict | None:
        """The verdict of the policy, None without a report."""
        return None if self.report is None else Verdict(self.report["verdict"])

    @property
    def word(self) -> str:
        """The verdict in one word, ``SAFE-IF`` for a SAFE with conditions; ``not judged`` without a report."""
        return "not checked" if self.report is None else word_of_report(self.report)

    @property
    def shown(self) -> dict[str, Any] | None:
        """The report that people read."""
        return self.report if self.read is None else self.read

    @property
    def findings(self) -> list[dict[str, Any]]:
        """Its findings, by place."""
        return [] if self.report is None else list(self.report["findings"])


def exit_code(outcomes: Iterable[Outcome]) -> int:
    """Of all jobs together: 3 if one could not be judged, else UNSAFE over UNKNOWN over SAFE."""
    codes = {outcome.code for outcome in outcomes}
    return next((code for code in (COULD_NOT_RUN, 1, 2) if code in codes), 0)


def counted(number: int, what: str) -> str:
    """``1 job``, ``2 jobs``."""
    return f"{number} {what}{'' if number == 1 else 's'}"


def closing_line(outcomes: list[Outcome]) -> str:
    """``7 jobs: 4 SAFE, 1 SAFE-IF, 1 UNSAFE, 1 UNKNOWN``."""
    names = ["SAFE", SAFE_IF, "UNSAFE", "UNKNOWN", "not checked"]
    said = [outcome.word for outcome in outcomes]
    parts = [f"{said.count(name)} {name}" for name in names if name in said]
    return f"{counted(len(outcomes), 'job')}: {', '.join(parts) or 'none'}"


@record(slots=True)
class Fingerprints:
    """Names for findings that stay when lines move: file, code, the text of the line, and which one of its like.

    A line's text counts without its white space and line number (N word), which programs get again each time.
    """

    _texts: dict[str, dict[int, str]] = field(default_factory=dict)
    _met: dict[tuple[str, str, str], int] = field(default_factory=dict)

    def of(self, places: Sequence[tuple[str, int, str]]) -> Iterator[str]:
        """The fingerprint of each finding. places: file, line, label of the code."""
        wanted: dict[str, set[int]] = {}
        for file, line, _ in places:
            wanted.setdefault(file, set()).add(line)
        for name, lines in wanted.items():
            self._texts.setdefault(name, {}).update(source_lines(name, lines - {0}))
        for file, line, label in places:
            text = self._texts[file].get(line, "")
            text = re.sub(r"^[Nn]\d+", "", re.sub(r"\s+", "", text))
            key = file, label, text
            self._met[key] = number = self._met.get(key, 0) + 1
            yield hashlib.sha256(f"{label}\0{text}\0{number}".encode()).hexdigest()[:32]
