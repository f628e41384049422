"""Which outcomes a finding rests on: answers that are not known before the job runs, and that lead to where it arose.

Takes the graph of sections, what was asked at its forks (``Asked``), and for each finding where it arose
(``Findings.sections``); gives ``Rests``. A finding that every way through the program meets rests on nothing. Else it
is the answers on a way there, without those that make no difference: what it needs, where every way to it has them; an
example, where other answers lead there too. Ways that never end do not count.
"""

from __future__ import annotations

import itertools
from collections import deque
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from gproof.ir.finding import AT_END, Finding, Findings, Outcome, Rests, Severity, Span
from gproof.ir.program import Expr, Input, Number, Program, Unary
from gproof.ir.record import field, record
from gproof.ir.trace import Chunk, Edge

KEPT = 20
"""Answers that a finding keeps, those nearest to it."""
LONGEST = 60
"""Characters of a condition."""
MOST_ASKED = 100
"""So many different answers on a way are looked at one by one."""
END = -1
"""What is after the program."""


Answer = tuple[Span, int, str, str]


@record(frozen=True, slots=True, kw_only=True)
class Asked:
    """What led into a section: of a condition, its truth; of any other question, its words and the answer."""

    span: Span
    condition: Expr | None = None
    what: str = ""
    answer: str = ""

    @property
    def key(self) -> Answer:
        """The same wherever this is asked and has this answer."""
        return self.span, id(self.condition), self.what, self.answer


def of_condition(condition: Expr, span: Span, *, truth: bool) -> Asked:
    """A condition that is true, or is not."""
    return Asked(span=span, condition=condition, answer="is true" if truth else "is false")


@record(slots=True)
class Outcomes:
    """The graph of a job's sections while it streams by."""

    _edges: dict[int, tuple[Edge, ...]] = field(default_factory=dict)
    _before: list[tuple[int, int, int]] = field(default_factory=list)
    _lines: dict[tuple[int, int], set[int]] = field(default_factory=dict)
    _files: Sequence[str] = ()

    def feed(self, chunk: Chunk, *, forked: bool) -> None:
        """Some rows; forked: something was asked before them or in their section."""
        rows = chunk.rows
        self._files = chunk.trace.files
        if chunk.last:
            self._edges[chunk.section] = chunk.edges
        if not len(rows):
            return
        places = rows["file"].astype(np.int64) << 32 | rows["line"]
        if not forked:
            for file in np.unique(rows["file"]).tolist():
                lines = rows["line"][rows["file"] == file]
                self._before.append((file, int(lines.min()), int(lines.max())))
            return
        for place in np.unique(places).tolist():
            self._lines.setdefault((place >> 32, place & 0xFFFFFFFF), set()).add(chunk.section)

    def name(self, findings: Findings, asked: Mapping[int, Asked], program: Program) -> None:
        """Give each finding of the run what it rests on."""
        if asked:
            graph = _Graph(self._edges, asked)
            for n, finding in enumerate(findings.kept):
                rests = self._rests(graph, finding, findings.sections.get(finding, set()), asked, program)
                if rests is not None:
                    findings.kept[n] = finding.resting(rests)
        findings.sections.clear()

    def _rests(
        self, graph: _Graph, finding: Finding, sections: set[int], asked: Mapping[int, Asked], program: Program
    ) -> Rests | None:
        there = self._of_line(finding.span)
        is_late = AT_END in sections
        if is_late:
            # Reported at the end of the job: all that is known is where its line has run.
            sections = there
        elif finding.severity in (Severity.WARNING, Severity.NOTE):
            # Often reported once, whatever comes by later.
            sections = sections | there if there else set()
        found = graph.needed(frozenset(sections)) if sections else None
        if found is None:
            return None
        way, certain = found
        if certain and finding.severity is Severity.UNKNOWN:
            certain = graph.needed(frozenset(sections | there)) == found
        named = _put_together([_outcome(asked[target], program) for target in way])
        if not named:
            return None
        example = is_late or not certain
        return Rests(outcomes=tuple(named[-KEPT:]), more=max(0, len(named) - KEPT), example=example)

    def _of_line(self, span: Span) -> set[int]:
        if span.file not in self._files:
            return set()
        file = self._files.index(span.file)
        if any(one == file and low <= span.line <= high for one, low, high in self._before):
            return set()
        return self._lines.get((file, span.line), set())


class _Graph:
    """Sections, and which answers lead from one to another."""

    def __init__(self, edges: Mapping[int, tuple[Edge, ...]], asked: Mapping[int, Asked]) -> None:
        self._next: dict[int, list[tuple[int, Answer | None]]] = {}
        for section, ways in edges.items():
            forks = len(ways) > 1
            found = [(edge.target, asked[edge.target].key if forks and edge.target in asked else None) for edge in ways]
            self._next[section] = found or [(END, None)]
        self._known: dict[frozenset[int], tuple[list[int], bool] | None] = {}

    def needed(self, sections: frozenset[int]) -> tuple[list[int], bool] | None:
        """Targets of the answers on a way to one of some sections, in order, and whether every way there has them.

        None where every way through the program comes by one of the sections. No answer can be left out: all ways that
        have them, wherever they are asked, come by one of the sections.
        """
        if sections not in self._known:
            self._known[sections] = self._needed(sections)
        return self._known[sections]

    def _needed(self, sections: frozenset[int]) -> tuple[list[int], bool] | None:
        if not self._passes_by(sections, set()):
            return None
        way = self._way(sections)
        keys = list(dict.fromkeys(key for key, _ in way))
        if len(keys) > MOST_ASKED:
            return [target for _, target in way], False
        kept = set(keys)
        for key in keys:
            if not self._passes_by(sections, kept - {key}):
                kept.discard(key)
        certain = not any(self._reached(sections, key) for key in kept)
        return [target for key, target in way if key in kept], certain

    def _allowed(self, section: int, answers: set[Answer]) -> list[tuple[int, Answer | None]]:
        """The ways on from a section where these answers are given."""
        ways = self._next.get(section, [])
        given = [way for way in ways if way[1] in answers]
        return given or ways

    def _passes_by(self, sections: frozenset[int], answers: set[Answer]) -> bool:
        """Whether a way with these answers comes to the end by none of some sections."""
        if 0 in sections:
            return False
        todo, seen = [0], {0, *sections}
        while todo:
            for other, _ in self._allowed(todo.pop(), answers):
                if other == END:
                    return True
                if other not in seen:
                    seen.add(other)
                    todo.append(other)
        return False

    def _reached(self, sections: frozenset[int], without: Answer) -> bool:
        """Whether a way without an answer comes to one of some sections."""
        todo, seen = [0], {0}
        while todo:
            for other, answer in self._next.get(todo.pop(), ()):
                if answer == without or other in seen:
                    continue
                if other in sections:
                    return True
                seen.add(other)
                todo.append(other)
        return False

    def _way(self, sections: frozenset[int]) -> list[tuple[Answer, int]]:
        """The answers on a way from the start to one of some sections, as few as there can be."""
        costs = {0: 0}
        before: dict[int, tuple[int, Answer | None]] = {}
        todo, done = deque([0]), set[int]()
        while todo:
            node = todo.popleft()
            if node in done:
                continue
            done.add(node)
            if node in sections:
                way: list[tuple[Answer, int]] = []
                while node in before:
                    last, answer = before[node]
                    way += [] if answer is None else [(answer, node)]
                    node = last
                return way[::-1]
            for other, answer in self._next.get(node, ()):
                cost = costs[node] + (answer is not None)
                if other not in done and cost < costs.get(other, cost + 1):
                    costs[other], before[other] = cost, (node, answer)
                    (todo.appendleft if answer is None else todo.append)(other)
        return []


def _outcome(asked: Asked, program: Program) -> Outcome:
    what, answer = asked.what, asked.answer
    if asked.condition is not None:
        what, answer = _in_words(asked.condition, asked.answer == "is true", program, asked.span)
    return Outcome(span=asked.span, what=what, answer=answer)


def _in_words(condition: Expr, truth: bool, program: Program, span: Span) -> tuple[str, str]:
    """A condition as the program has it, or, where it is a whole line, the channel that it reads; and its truth."""
    if condition.span != span:
        return _source(condition.span, program) or "the condition", "is true" if truth else "is false"
    inner, holds = condition, truth
    while isinstance(inner, Unary) and inner.operator == "not":
        inner, holds = inner.operand, not holds
    if isinstance(inner, Input) and isinstance(inner.number, Number) and inner.kind in _CHANNELS:
        return _CHANNELS[inner.kind].format(inner.number.value), _STATES[inner.kind][holds]
    return _source(span, program) or "the condition", "is true" if truth else "is false"


_CHANNELS = {
    "input": "input {:g}", "output": "output {:g}", "virtual": "virtual input {:g}", "answer": "question {:g}",
}  # fmt: skip
_STATES = dict.fromkeys(_CHANNELS, ("is off", "is on")) | {"answer": ("is answered no", "is answered yes")}


def _source(place: Span, program: Program) -> str:
    """What is at a place in the source, its line where no columns are known."""
    source = next((file for file in program.files if file.name == place.file), None)
    if source is None or place.line < 1:
        return ""
    raw = next(itertools.islice(_lines_of(source.data), place.line - 1, None), b"")
    try:
        text = raw.decode("utf-8-sig" if place.line == 1 else "utf-8")
    except UnicodeDecodeError:
        text = raw.decode("cp1252", "replace")
    if 0 < place.column < place.end_column:
        text = text[place.column - 1 : place.end_column - 1]
    text = " ".join("".join(c if c.isprintable() else " " for c in text).split())
    return text if len(text) <= LONGEST else text[: LONGEST - 3] + "..."


def _lines_of(data: bytes) -> Iterable[bytes]:
    at = 0
    while at < len(data):
        end = data.find(b"\n", at)
        end = len(data) if end < 0 else end
        yield data[at:end].rstrip(b"\r")
        at = end + 1


def _put_together(found: list[Outcome]) -> list[Outcome]:
    """Answers in order; the same one again and again is there once, with how often."""
    out: list[Outcome] = []
    for one in found:
        if out and out[-1].again(one):
            out[-1] = out[-1].more()
        else:
            out.append(one)
    return out
