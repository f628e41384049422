"""Ranges of unknown offsets for which a job fits its soft limits, and what they come to: conditions or findings."""

from __future__ import annotations

import math

from gproof.ir import codes
from gproof.ir.finding import Findings, Related, Span
from gproof.ir.machine import Axis, Machine
from gproof.ir.setup import Interval, Setup
from gproof.ir.symbolic import hint_of
from gproof.ir.symbols import describe
from gproof.ir.trace import Affine, Trace
from gproof.ir.trace_rows import form_interval, split_form
from gproof.ir.verdict import Condition
from gproof.passes.checks.base import apart, inward, no_safe_offset, none_suits

ROUNDING = 1e-9
"""mm: what the arithmetic of an exact position may add; a position this far beyond is on the limit."""


class OffsetRange:
    """What all rows under one unknown offset leave of it, whatever frame and guard they are in.

    low, high: its range; least, most: extent of the rows without it; span: the first move that rests on it; low_span,
    high_span: the rows that bound the range.
    """

    def __init__(self, axis: Axis, span: Span) -> None:
        self.axis, self.span = axis, span
        self.low, self.high = -math.inf, math.inf
        self.least, self.most = math.inf, -math.inf
        self.low_span = self.high_span = Span("", 0)

    def within(self, room: tuple[float, float], least: float, most: float, spans: tuple[Span, Span]) -> None:
        """Rows from ``least`` to ``most``, the lowest and the highest at ``spans``, fit with the offset in ``room``."""
        if room[0] > self.low or not self.low_span.line:
            self.low_span = spans[0]
        if room[1] < self.high or not self.high_span.line:
            self.high_span = spans[1]
        self.low, self.high = max(self.low, room[0]), min(self.high, room[1])
        self.least, self.most = min(self.least, least), max(self.most, most)

    def apart(self, form: Affine, machine: Machine) -> tuple[Span, str, tuple[Related, ...]]:
        """Where the two rows that bound the range are reported when they leave nothing of it."""
        asked = Condition(terms=form, low=self.low, high=self.high, places=(self.low_span, self.high_span))
        return apart(asked, machine, self.axis.unit, self.span)


class OffsetRanges:
    """What the ranges of a whole job come to.

    first: its first move. errors: how many findings say that a limit is passed for certain; assumptions: what an answer
    then rests on.
    """

    def __init__(
        self, trace: Trace, machine: Machine, setup: Setup, findings: Findings, first: Span | None
    ) -> None:  # fmt: skip
        self.trace, self.machine, self.setup, self.findings = trace, machine, setup, findings
        assert first is not None
        self.first = first
        self.errors = 0
        self.assumptions: list[str] = []

    def conditions(self, found: dict[Affine, OffsetRange]) -> tuple[Condition, ...]:
        """Conditions that the setup does not already meet; findings where it cannot or need not."""
        out = []
        rooms: dict[Affine, Condition] = {}
        axes: dict[Affine, Axis] = {}
        for form, offset in sorted(found.items()):
            if offset.low > offset.high + 2 * ROUNDING:
                self._no_room(form, offset)
                continue
            low, high = sorted((offset.low, offset.high))
            stated = form_interval(form, self.setup, self.trace)
            if stated is not None:
                if low - ROUNDING <= stated.low and stated.high <= high + ROUNDING:
                    continue
                # The move that needs the side of the range which the statement does not keep.
                needed = offset.low_span if stated.low < low - ROUNDING else offset.high_span
                if stated.high < low or stated.low > high:
                    self.errors += 1
                    self.findings.add(
                        none_suits(
                            needed, form, self.machine, known=stated, safe=Interval(low, high), unit=offset.axis.unit
                        )
                    )
                else:
                    unit = offset.axis.unit
                    safe = inward(low, high)
                    said = f"{round(stated.low, 6) + 0.0:g} to {round(stated.high, 6) + 0.0:g}"
                    cause = f"{describe(form, self.machine)}, which is {said} {unit}; only {safe} {unit} is safe"
                    word = offset.axis.word
                    self.findings.add(codes.POSITION_UNKNOWN.at(needed, axis=word, cause=cause, hint=hint_of(form)))
                continue
            if low > high or (low == -math.inf and high == math.inf):
                continue
            arising, rest = split_form(form)
            if arising:
                span = form_interval(arising, self.setup, self.trace)
                if span is None or not rest or low - span.low > high - span.high:
                    there = offset.apart(form, self.machine) if span is not None and rest else (offset.span, "", ())
                    where, hint, related = there
                    cause = describe(form, self.machine)
                    self.findings.add(
                        codes.POSITION_UNKNOWN.at(
                            where, axis=offset.axis.word, cause=cause, hint=hint_of(form) or hint, related=related
                        )
                    )
                    continue
                low, high = low - span.low, high - span.high
            if len(rest) == 1 and rest[0][0].startswith("start."):
                ends = f"between {inward(low, high, ' and ')} {offset.axis.unit}"
                said = f"{describe(rest, self.machine)} is {ends} (machine coordinates)"
                self.assumptions.append(said)
            axes.setdefault(rest, offset.axis)
            asked = Condition(terms=rest, low=low, high=high, places=(offset.low_span, offset.high_span))
            rooms[rest] = asked.within(rooms[rest]) if rest in rooms else asked
        for form, asked in sorted(rooms.items()):
            if asked.low > asked.high:
                name = describe(form, self.machine)
                where, hint, related = apart(asked, self.machine, axes[form].unit, self.first)
                cause = f"{name}: no value fits the complete job"
                self.findings.add(
                    codes.POSITION_UNKNOWN.at(
                        where, axis=axes[form].word, cause=cause, hint=hint_of(form) or hint, related=related
                    )
                )
            else:
                out.append(asked)
        return tuple(out)

    def _no_room(self, form: Affine, offset: OffsetRange) -> None:
        """GP303: the lowest and the highest point of the job do not fit at the same time."""
        self.errors += 1
        extent = offset.most - offset.least
        where, hint, related = offset.apart(form, self.machine)
        self.findings.add(
            no_safe_offset(
                where, form, self.machine, extent=extent, unit=offset.axis.unit,
                room=max(0.0, extent - (offset.low - offset.high)), hint=hint, related=related,
            )
        )  # fmt: skip
