"""Nodes of a line made again for lines of the same shape, without reading those.

A *run* is a row of digits. Two lines have one shape when they differ only in runs that are literal numbers, the line
number or a label's number, and in the comment at the end. The nodes of one of them with the columns, numbers and
comment of the other are then what reading the other gives: no token starts or ends elsewhere.
"""

from __future__ import annotations

import dataclasses
import re
from bisect import bisect_right
from collections.abc import Callable, Sequence
from itertools import accumulate
from typing import Any

from gproof.frontend.mcuwin.names import label_name
from gproof.ir.finding import Span
from gproof.ir.program import Block, Call, Jump, Label, Number, Unsupported, Word
from gproof.ir.record import record

Part = Callable[[Sequence[Span], Sequence[Any]], Any]
"""Makes a node of the spans and values of a line."""
Place = tuple[int, int]
"""A character of a line: how many are before it that are in no run before it, and how many runs end before it."""

_NUMBER = re.compile(r"([-+]?)[ \t]*([0-9]++(?:\.[0-9]*+)?|\.[0-9]+)")
_LABEL = re.compile(r"[Ll][ \t]*\Z")


class UnfitError(Exception):
    """The nodes of a line cannot be made again."""


def lengths(runs: Sequence[str]) -> list[int]:
    """How many characters the first 0, 1, 2 … runs have."""
    return list(accumulate(map(len, runs), initial=0))


def place_of(character: int, runs: Sequence[tuple[int, int]]) -> Place:
    """Of a character of a line. runs: start and end of each."""
    count = bisect_right(runs, character, key=lambda run: run[1])
    return character - sum(end - begin for begin, end in runs[:count]), count


@record(frozen=True, slots=True)
class Value:
    """What a line has at a place. kind: ``+`` or ``-`` and a number, ``label``, or ``comment``;
    ``begin``, ``end``: of it."""

    kind: str
    begin: Place
    end: Place

    def of(self, text: str, before: Sequence[int]) -> Any:
        """Its value. before: see ``lengths``."""
        written = text[self.begin[0] + before[self.begin[1]] : self.end[0] + before[self.end[1]]]
        if self.kind == "label":
            return label_name(written)
        value = float(written)
        return -value if self.kind == "-" else value


@record(frozen=True, slots=True)
class Pattern:
    """The nodes of a line, to be made again. free: runs that other lines of its shape have other digits in."""

    parts: tuple[Part, ...]
    spans: tuple[tuple[int, int, int, int], ...]
    values: tuple[Value, ...]
    free: frozenset[int]

    def nodes(self, text: str, file: str, line: int, before: Sequence[int], comment: str) -> list[Any]:
        """Those of another line of this shape."""
        spans, values = self._filled(text, file, line, before, comment)
        return [part(spans, values) for part in self.parts]

    def node(self, index: int, text: str, file: str, line: int, before: Sequence[int], comment: str) -> Any:
        """One of them."""
        return self.parts[index](*self._filled(text, file, line, before, comment))

    def _filled(
        self, text: str, file: str, line: int, before: Sequence[int], comment: str
    ) -> tuple[list[Span], list[Any]]:
        spans = [Span(file, line, a + before[i], b + before[j]) for a, i, b, j in self.spans]
        return spans, [comment, *[value.of(text, before) for value in self.values]]


def pattern_of(
    nodes: Sequence[Any], text: str, file: str, line: int, runs: Sequence[tuple[int, int]], *, comment: str = "",
    number: int = -1, labels: bool = False,
) -> Pattern:  # fmt: skip
    """The pattern of the nodes of a line; UnfitError where there is none.

    runs: start and end of each; comment: the one at the end, which no other comment of the line equals; number: the
    run that is the line number; labels: a run after L is a label's number.
    """
    maker = _Maker(text, file, line, runs, comment, labels)
    parts = tuple([maker.part(node) for node in nodes])
    free = frozenset({*maker.free, number} - {-1} - maker.fixed)
    for a, i, b, j in maker.spans.values():
        for at, count in ((a + maker.before[i] - 1, i), (b + maker.before[j] - 1, j)):
            if count in free and at > runs[count][0]:
                raise UnfitError
    return Pattern(parts, tuple(maker.spans.values()), tuple(maker.values), free)


class _Maker:
    def __init__(
        self, text: str, file: str, line: int, runs: Sequence[tuple[int, int]], comment: str, labels: bool
    ) -> None:
        self.text = text
        self.place = file, line
        self.runs = runs
        self.before = lengths([text[begin:end] for begin, end in runs])
        self.comment = comment
        self.labels = labels
        self.free: set[int] = set()
        self.fixed: set[int] = set()
        self.spans: dict[Span, tuple[int, int, int, int]] = {}
        self.places: dict[Span, int] = {}
        self.values: list[Value] = []

    def part(self, value: Any, free: bool = True) -> Part:
        """What makes a value; free: a literal number in it may be another in other lines."""
        if value is None or isinstance(value, str | bool | int | float):
            return lambda spans, values: value
        if isinstance(value, Span):
            return self._span(value)
        if isinstance(value, Number):
            return self._number(value, free)
        if isinstance(value, tuple) and type(value) is tuple:
            items = tuple([self.part(item) for item in value])
            if not items:
                return lambda spans, values: ()
            return lambda spans, values: tuple([item(spans, values) for item in items])
        if isinstance(value, tuple):
            return _call(type(value), [self.part(item) for item in value], {})
        if not dataclasses.is_dataclass(value) or isinstance(value, type):
            raise UnfitError
        parts = {field.name: self._field(value, field.name) for field in dataclasses.fields(value)}
        named = {field.name for field in dataclasses.fields(value) if field.kw_only}
        return _call(
            type(value),
            [part for name, part in parts.items() if name not in named],
            {name: part for name, part in parts.items() if name in named},
        )

    def _field(self, node: Any, name: str) -> Part:
        value = getattr(node, name)
        if name == "text" and isinstance(node, Unsupported) and value:
            begin, end = node.span.column - 1, node.span.end_column - 1
            self.fixed.update(i for i, run in enumerate(self.runs) if begin <= run[0] and run[1] <= end)
        if name == "value" and isinstance(node, Word) and node.letter in "GM":
            return self.part(value, free=False)
        if name == "comment" and isinstance(node, Block) and value and value == self.comment:
            return lambda spans, values: values[0]
        if name == "name" and self.labels and isinstance(node, Label | Jump | Call) and value.isdigit():
            return self._label(node)
        return self.part(value)

    def _span(self, span: Span) -> Part:
        if (span.file, span.line) != self.place or not 0 < span.column <= span.end_column:
            raise UnfitError
        if span not in self.spans:
            begin, end = (place_of(at - 1, self.runs) for at in (span.column, span.end_column))
            self.places[span] = len(self.spans)
            self.spans[span] = (begin[0] + 1, begin[1], end[0] + 1, end[1])
        index = self.places[span]
        return lambda spans, values: spans[index]

    def _number(self, node: Number, free: bool) -> Part:
        place, point = self._span(node.span), node.point
        begin, end = node.span.column - 1, node.span.end_column - 1
        found = _NUMBER.fullmatch(self.text, begin, end) if free else None
        if found is None:
            fixed = node.value
            return lambda spans, values: Number(fixed, place(spans, values), point)
        inside = [i for i, run in enumerate(self.runs) if found.start(2) <= run[0] and run[1] <= end]
        value = self._value("-" if found[1] == "-" else "+", found.start(2), end, inside)
        if repr(self.values[value - 1].of(self.text, self.before)) != repr(node.value) or point != ("." in found[2]):
            raise UnfitError
        return lambda spans, values: Number(values[value], place(spans, values), point)

    def _label(self, node: Label | Jump | Call) -> Part:
        """The name of a label, by the run after its L."""
        begin, end = node.span.column - 1, node.span.end_column - 1
        for i, run in enumerate(self.runs):
            if begin <= run[0] and run[1] <= end and _LABEL.search(self.text, begin, run[0]):
                if label_name(self.text[run[0] : run[1]]) != node.name:
                    raise UnfitError
                value = self._value("label", *run, [i])
                return lambda spans, values: values[value]
        return self.part(node.name)

    def _value(self, kind: str, begin: int, end: int, runs: Sequence[int]) -> int:
        """A further value, whose runs become free; its index."""
        self.free.update(runs)
        self.values.append(Value(kind, place_of(begin, self.runs), place_of(end, self.runs)))
        return len(self.values)


def _call(make: Callable[..., Any], parts: Sequence[Part], named: dict[str, Part]) -> Part:
    """Makes a node of its fields."""
    if not named:
        return lambda spans, values: make(*[part(spans, values) for part in parts])
    if not parts:
        pairs = tuple(named.items())
        return lambda spans, values: make(**{name: part(spans, values) for name, part in pairs})
    raise UnfitError
