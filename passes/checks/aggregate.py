"""Findings by cause: one for all moves that have it, at the first of them, with their number and the last one."""

from __future__ import annotations

from collections.abc import Hashable

from gproof.ir.finding import Code, Findings, Related, Severity, Span
from gproof.ir.record import field, record
from gproof.ir.verdict import PropertyResult, Verdict


@record(slots=True)
class Cause:
    """Why rows are reported: first and last place, how many there are; hint, values: of the finding; sections: where
    they are."""

    code: Code
    first: Span
    last: Span
    count: int = 0
    hint: str = ""
    values: dict[str, object] = field(default_factory=dict)
    sections: set[int] = field(default_factory=set)


class Causes:
    """Collects causes by code and a key of the check's own, in order of arrival; findings: those of the run."""

    def __init__(self, findings: Findings) -> None:
        self._findings = findings
        self._found: dict[tuple[int, Hashable], Cause] = {}

    def add(
        self, code: Code, key: Hashable, first: Span, last: Span, count: int = 1, hint: str = "", **values: object
    ) -> None:
        """``count`` more rows with this cause, from ``first`` to ``last``; values are those of its first rows."""
        known = self._found.get((code.number, key))
        if known is None:
            known = self._found[code.number, key] = Cause(code, first, last, 0, hint, values)
        known.count += count
        known.last = last
        if self._findings.section is not None:
            known.sections.add(self._findings.section)

    def worse(self, code: Code, key: Hashable, name: str, value: float, **values: object) -> None:
        """Put ``values`` in the place of those of a cause that has less under ``name`` than ``value``."""
        known = self._found.get((code.number, key))
        if known is not None and value > float(str(known.values[name])):
            known.values.update(values)

    def take_over(self, other: Causes) -> None:
        """Add what another collector has, and empty it."""
        for (number, key), cause in other._found.items():
            known = self._found.setdefault((number, key), cause)
            if known is not cause:
                known.count += cause.count
                known.last = cause.last
                known.sections |= cause.sections
        other.clear()

    def clear(self) -> None:
        """Forget everything."""
        self._found = {}

    def forget(self, code: Code) -> None:
        """Do not tell a code."""
        self._found = {key: cause for key, cause in self._found.items() if cause.code is not code}

    def take(self, code: Code) -> Cause | None:
        """The first cause of a code, which is then not reported; None when there is none."""
        found = next((cause for cause in self._found.values() if cause.code is code), None)
        self.forget(code)
        return found

    def report(self) -> None:
        """One finding for each, whatever chunks the job came in: by code, and by what else keeps causes apart."""
        for _, cause in sorted(self._found.items(), key=lambda one: (one[0][0], repr(one[0][1]))):
            related: tuple[Related, ...] = ()
            if cause.last != cause.first:
                related = (Related(cause.last, f"the last of {cause.count} such moves"),)
            values = {"moves": cause.count, **cause.values}
            finding = cause.code.at(cause.first, hint=cause.hint, related=related, **values)
            self._findings.add(finding, sections=cause.sections)


def answer(name: str, findings: Findings, assumptions: tuple[str, ...] = ()) -> PropertyResult:
    """What the findings that decide a property make of it."""
    verdict = Verdict.SAFE
    if findings.has(Severity.ERROR, (name,)):
        verdict = Verdict.UNSAFE
    elif findings.has(Severity.UNKNOWN, (name,)):
        verdict = Verdict.UNKNOWN
    return PropertyResult(name=name, verdict=verdict, assumptions=assumptions)
