"""Findings: what the tool has to say about a place in a file.

A ``Code`` is declared once, in ``ir/codes/``, with a stable number and name; ``code.at(span, ...)``
makes a ``Finding``. Spans are required: what concerns a text as a whole is at its line 1.
"""

from __future__ import annotations

import contextlib
import enum
import math
import re
import string
from collections.abc import Callable, Container, Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import PurePath
from typing import Any

from gproof.ir.record import field, record


class Severity(enum.Enum):
    """How much a finding weighs: errors make a job UNSAFE, unknowns make it UNKNOWN."""

    ERROR = "error"
    UNKNOWN = "unknown"
    WARNING = "warning"
    NOTE = "note"


_FIXED = re.compile(r"\.(\d+)f")
_LEAST = 0.5
"""Nothing that is larger than this prints as 0."""


def fixed(value: float, places: int) -> str:
    """A number with so many decimals; with as many as it needs, or a power of ten, where these would say 0."""
    text = f"{value:.{places}f}"
    if value == 0.0 or not math.isfinite(value) or float(text) != 0.0:
        return text
    needed = 1 - math.floor(math.log10(abs(value)))
    return f"{value:.{needed}f}" if needed <= _MOST_DECIMALS else f"{value:.1e}"


_MOST_DECIMALS = 9


class _Filler(string.Formatter):
    """Templates of messages: no number prints as 0 that is not 0."""

    def format_field(self, value: Any, format_spec: str) -> Any:
        """A field."""
        found = _FIXED.fullmatch(format_spec) if isinstance(value, float) else None
        return super().format_field(value, format_spec) if found is None else fixed(value, int(found[1]))


def _seen(name: str, value: object, places: int) -> object:
    """A value as it is printed: no zero has a sign, and below the printed decimals places x, y and z are noise."""
    if not isinstance(value, float):
        return value
    return (round(value, places) if name in _PLACES else value) + 0.0


_PLACES = ("x", "y", "z")


def filled(template: str, values: Mapping[str, object], places: int = 3) -> str:
    """The message of a template; places: decimals of positions, three for mm and four for inches."""
    if any(isinstance(value, float) and abs(value) < _LEAST for value in values.values()):
        seen = {name: _seen(name, value, places) for name, value in values.items()}
        return brief(_Filler().vformat(template, (), seen))
    return brief(template.format(**values))


QUOTED = 100
"""Characters of a quotation that a finding repeats of somebody else's file."""
UNBROKEN = 255
"""As many of a text without blanks: a path of the user's own stays whole."""
LONGEST = 600
"""Characters of a message; of a longer one the middle is left out."""
_QUOTATION = re.compile(r"(?<!\w)(['\"])((?:(?!\1).)*)\1(?!\w)|\S+", re.DOTALL)


def brief(text: str) -> str:
    """A message without most of what it quotes, where that is long; how long it was is said."""
    if len(text) <= 2 * QUOTED:
        return text
    short = _QUOTATION.sub(_quotation, text)
    if len(short) <= LONGEST:
        return short
    return f"{short[: LONGEST - QUOTED]} ... ({len(text)} characters) ... {short[-QUOTED:]}"


def _quotation(found: re.Match[str]) -> str:
    mark, inner = found[1] or "", found[2] if found[1] else found[0]
    most = QUOTED if mark else UNBROKEN
    if len(inner) <= most + 3:  # those that have been cut too
        return found[0]
    return f"{mark}{inner[:most]}...{mark} ({len(inner)} characters)"


@record(frozen=True, slots=True)
class Span:
    """A place in a source file.

    file: path as the user gave it; line: from 1 (0: of a file that is no text);
    column, end_column: from 1, in characters, end exclusive; 0 when unknown.
    """

    file: str
    line: int
    column: int = 0
    end_column: int = 0


@record(frozen=True, slots=True)
class Code:
    """A kind of finding: number (``GP301`` has 301), name, severity, message template, the property it decides, and
    what to do where a finding has no hint of its own."""

    number: int
    name: str
    severity: Severity
    template: str
    decides: str
    hint: str = ""

    @property
    def label(self) -> str:
        """The stable printed form, such as ``GP301``."""
        return f"GP{self.number:03d}"

    def as_note(self) -> Code:
        """The same kind where it is nothing but worth to know: an outcome of several that the job provides for."""
        return replace(self, severity=Severity.NOTE)

    def as_unknown(self) -> Code:
        """The same kind where nobody can say whether it comes to that."""
        return replace(self, severity=Severity.UNKNOWN)

    def at(self, span: Span, *, hint: str = "", related: Iterable[Related] = (), **values: object) -> Finding:
        """A finding of this kind at ``span``; ``values`` fill the template."""
        message, told = filled(self.template, values), brief(hint or self.hint)
        return Finding(self, span, message, told, tuple(related), tuple(values.items()))


@record(frozen=True, slots=True)
class Related:
    """A second place that explains a finding."""

    span: Span
    message: str


@record(frozen=True, slots=True)
class Outcome:
    """An answer that is unknown before the job runs: what was asked, where, what it was, how often in a row."""

    span: Span
    what: str
    answer: str
    times: int = 1

    def again(self, other: Outcome) -> bool:
        """Whether another one is the same, as in a loop."""
        return (self.span, self.what, self.answer) == (other.span, other.what, other.answer)

    def more(self) -> Outcome:
        """The same, once more."""
        return replace(self, times=self.times + 1)

    def text(self, file: str) -> str:
        """In words: ``#1 > 0 at line 12 is true``; file: where no file has to be named."""
        where = f" at line {self.span.line}" if self.span.line else ""
        where += f" of {PurePath(self.span.file).name}" if where and self.span.file != file else ""
        return f"{brief(self.what)}{where} {self.answer}{f' {self.times} times' if self.times > 1 else ''}"


@record(frozen=True, slots=True)
class Rests:
    """Outcomes that a finding rests on, the nearest last; more: how many come before them; example: others lead there
    too."""

    outcomes: tuple[Outcome, ...]
    more: int = 0
    example: bool = False

    def text(self, file: str) -> str:
        """In words, a handful of them; file: that of the finding."""
        told = [one.text(file) for one in self.outcomes[-HANDFUL:]]
        more = self.more + len(self.outcomes) - len(told)
        told += [f"and {more} more before"] if more else []
        return f"{'for example' if self.example else 'only'} when {'; '.join(told)}"


HANDFUL = 4
"""So many outcomes of a finding are shown."""


@record(frozen=True, slots=True)
class Finding:
    """One thing to tell the user; see ``Code``. values: those of the message, lengths in mm, for other units; rests:
    what it rests on of what is unknown before the job runs, None where it holds in every outcome."""

    code: Code
    span: Span
    message: str
    hint: str = ""
    related: tuple[Related, ...] = ()
    values: tuple[tuple[str, object], ...] = field(default=(), compare=False, repr=False)
    rests: Rests | None = field(default=None, compare=False, repr=False)

    def resting(self, rests: Rests) -> Finding:
        """The same one with what it rests on."""
        return replace(self, rests=rests)

    @property
    def severity(self) -> Severity:
        """The severity of its code."""
        return self.code.severity


class Refusal(Exception):
    """A stage cannot go on: carries the finding that says why."""

    def __init__(self, finding: Finding) -> None:
        super().__init__(finding.message)
        self.finding = finding


class FollowedRefusal(Refusal):
    """What a line leaves is open, and the state says already how: nothing else of it is lost."""


class FollowsRefusal(Refusal):
    """A line cannot be followed because an earlier one was refused, and that is reported there: one cause, once."""


_NUMBER = re.compile(
    r"(?<![\w#$.])([XYZABCUVWIJKRFSPQEDH]?)[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:e[-+]?\d+)?(?![\w])", re.IGNORECASE
)
"""Numbers of messages, with the word they belong to. After other letters they are names: G54, M999, T3, C1."""
GROUPS = 200
"""Groups of a code at most: what a program makes up (texts in messages) must not fill the memory."""


AT_END = -1
"""Of ``Findings.section``: the job is over."""
UNKNOWN_KEYS = 602
"""The code of keys of a controller's file that are not known. Such a file has hundreds: they are of one kind, and all
of them are kept."""
MOST_KEYS = 100_000
_KEY = re.compile(r"unknown key (?P<mark>['\"])(?P<key>.*)(?P=mark): ignored", re.DOTALL)


def pattern(message: str) -> str:
    """A message without its numbers; findings of a code with the same one are of a kind."""
    return "unknown key #: ignored" if _KEY.fullmatch(message) else _NUMBER.sub(r"\1#", message)


def key_of(message: str) -> str:
    """The key that a finding of an unknown key names, "" for any other."""
    found = _KEY.fullmatch(message)
    return found["key"] if found is not None else ""


def measure(finding: Finding) -> float | None:
    """How far a finding goes, among those of its kind; None where no number of it says so."""
    values = dict(finding.values)
    for names in (("over",), ("off",), ("reached", "limit"), ("wanted", "limit"), ("needed",), ("jump",)):
        found = [values.get(name) for name in names]
        numbers = [float(value) for value in found if isinstance(value, (int, float))]
        if len(numbers) == len(names):
            return abs(numbers[0] - numbers[1]) if len(numbers) > 1 else abs(numbers[0])
    return None


@record(slots=True)
class Group:
    """Findings of one code in one file that differ in numbers only.

    times: how often they came, those that are not kept too; line, last_line: from where to where; kept: how many
    different ones are; worst: the one that goes furthest, None where that is unknown.
    """

    code: Code
    file: str
    pattern: str
    line: int
    last_line: int
    times: int = 0
    kept: int = 0
    worst: Finding | None = None
    _most: float = -1.0

    def count(self, finding: Finding, times: int, line: int, last_line: int) -> None:
        """One more, or so many from line to last_line of which the finding is the one that goes furthest."""
        self.times += times
        self.line, self.last_line = min(self.line, line), max(self.last_line, last_line)
        most = measure(finding)
        if most is not None and most > self._most:
            self.worst, self._most = finding, most

    def join(self, other: Group) -> None:
        """The same kind in another run over the same lines."""
        self.line, self.last_line = min(self.line, other.line), max(self.last_line, other.last_line)
        self.times = max(self.times, other.times)
        if other.worst is not None and other._most > self._most:
            self.worst, self._most = other.worst, other._most


GroupKey = tuple[int, str, str]


def group_key(finding: Finding) -> GroupKey:
    """Code, file and message without numbers."""
    return finding.code.number, finding.span.file, pattern(finding.message)


@record(slots=True)
class Findings:
    """A collector with a cap for each code, so that a million-line job does not print a million lines.

    ``counts`` holds every occurrence by code; ``kept`` the first ``limit`` different findings of each code in
    order of arrival, and beyond these the first of each kind, ``limit`` again at most; ``times`` how often each
    kept one came; ``groups`` every kind, with those that are not kept. ``section``: of the trace, in which findings
    arise now, -1 at the end of a job, None outside of a run; ``sections``: for each kept one those in which it arose.
    ``stated``: where files state what they state, by dotted keys, ``setup.`` or ``machine.`` before them.
    """

    limit: int = 20
    kept: list[Finding] = field(default_factory=list)
    counts: dict[int, int] = field(default_factory=dict)
    times: dict[Finding, int] = field(default_factory=dict)
    groups: dict[GroupKey, Group] = field(default_factory=dict)
    section: int | None = None
    sections: dict[Finding, set[int]] = field(default_factory=dict)
    stated: dict[str, Span] = field(default_factory=dict, compare=False, repr=False)
    _different: dict[int, int] = field(default_factory=dict)
    _kinds: dict[int, int] = field(default_factory=dict)

    def add(
        self, finding: Finding, *, times: int = 1, first_line: int = 0, last_line: int = 0,
        sections: Iterable[int] = (),
    ) -> None:  # fmt: skip
        """Count a finding; keep it when it is new and its code is below the cap, or it is the first of its kind.

        times: it stands for so many of its kind, from first_line to last_line (0: its own), and goes the furthest.
        sections: where it arose, if not in the one that runs.
        """
        number = finding.code.number
        self.counts[number] = self.counts.get(number, 0) + times
        group = self._group(finding)
        if group is not None:
            line = finding.span.line
            group.count(finding, times, first_line or line, max(last_line, line))
        if finding in self.times:
            self.times[finding] += 1
            self._arose(finding, sections)
            return
        different = self._different.get(number, 0)
        is_first = group is not None and not group.kept
        limit = MOST_KEYS if number == UNKNOWN_KEYS else self.limit
        if different < limit or (is_first and different < 2 * limit):
            self._different[number] = different + 1
            self._keep(finding, 1)
            self._arose(finding, sections)
            if group is not None:
                group.kept += 1

    def where(self, key: str, otherwise: Span) -> Span:
        """Where a dotted key is stated, or the nearest table that holds it; otherwise: where no file states it."""
        while key and key not in self.stated:
            key = key.rpartition(".")[0]
        return self.stated.get(key, otherwise)

    def _arose(self, finding: Finding, sections: Iterable[int]) -> None:
        if self.section is not None:
            self.sections.setdefault(finding, set()).update(sections or (self.section,))

    @contextlib.contextmanager
    def within(self, section: int | None) -> Iterator[None]:
        """Findings that are added meanwhile arise in this section."""
        before, self.section = self.section, section
        yield
        self.section = before

    def _group(self, finding: Finding) -> Group | None:
        """The group of a finding, None for one more than there may be."""
        key = group_key(finding)
        group = self.groups.get(key)
        if group is None:
            number = finding.code.number
            kinds = self._kinds[number] = self._kinds.get(number, 0) + 1
            if kinds > GROUPS:
                return None
            line = finding.span.line
            group = self.groups[key] = Group(finding.code, finding.span.file, key[2], line, line)
        return group

    def _keep(self, finding: Finding, times: int) -> None:
        self.kept.append(finding)
        self.times[finding] = times

    def has(self, severity: Severity, properties: Iterable[str] | None = None) -> bool:
        """True when a kept finding of that severity belongs to one of ``properties`` (all: None)."""
        wanted = None if properties is None else set(properties)
        return any(f.severity is severity and (wanted is None or f.code.decides in wanted) for f in self.kept)

    def hidden(self, code: Code) -> int:
        """How many findings of a code were counted but not kept."""
        shown = sum(times for finding, times in self.times.items() if finding.code.number == code.number)
        return max(0, self.counts.get(code.number, 0) - shown)

    def join(self, other: Findings) -> None:
        """What another run over the same lines found, each once."""
        seen = {(f.code.number, f.span) for f in self.kept}
        for finding in other.kept:
            if (finding.code.number, finding.span) not in seen:
                self.add(finding)
        for key, group in other.groups.items():
            if key in self.groups:
                self.groups[key].join(group)

    def as_told(self, tell: Callable[[Finding], Finding | None]) -> Findings:
        """The findings as ``tell`` says them; those of a code that it leaves out (None) are not counted either."""
        out = Findings(limit=self.limit, counts=dict(self.counts), groups=dict(self.groups))
        for finding in self.kept:
            told = tell(finding)
            if told is None:
                out.counts.pop(finding.code.number, None)
                continue
            out._keep(told, self.times[finding])
        out.groups = {key: group for key, group in self.groups.items() if key[0] in out.counts}
        return out

    def shortened(self, limit: int, always: Container[Finding] = ()) -> Findings:
        """Those that a limit leaves, and also those that are ``always`` reported."""
        if self.limit == limit:
            return self
        out = Findings(limit=limit, counts=dict(self.counts), groups=self.groups)
        told: dict[int, int] = {}
        kinds: set[GroupKey] = set()
        for finding in self.kept:
            number, key = finding.code.number, group_key(finding)
            if finding not in always:
                first = key not in kinds and key in self.groups
                most = MOST_KEYS if number == UNKNOWN_KEYS else limit
                if told.get(number, 0) >= (2 * most if first else most):
                    continue
                told[number] = told.get(number, 0) + 1
                kinds.add(key)
            out._keep(finding, self.times[finding])
        return out


_HEAVIEST_FIRST = (Severity.ERROR, Severity.UNKNOWN, Severity.WARNING, Severity.NOTE)


def sort_key(finding: Finding) -> tuple[str, int, int, int]:
    """By place, then by weight."""
    return finding.span.file, finding.span.line, finding.span.column, _HEAVIEST_FIRST.index(finding.severity)


def distinct(findings: Findings) -> list[tuple[Finding, int]]:
    """The kept findings by place, each once, with how often it came."""
    return [(finding, findings.times[finding]) for finding in sorted(findings.kept, key=sort_key)]
