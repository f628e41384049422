"""Why a job has no plan: GP503 for places, feeds and times that are not numbers, GP504 for axes without data.

Each cause is reported once, at the first line that has it, with what would help (``motion_hints``); what only follows
from another refusal (a place after a probe's contact, where outcomes of a condition meet) is not reported again.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Protocol

import numpy as np

from gproof.ir import codes
from gproof.ir.finding import Findings, Span
from gproof.ir.machine import AXIS_NAMES, Machine
from gproof.ir.rules import LanguageRules
from gproof.ir.symbols import describe
from gproof.ir.trace import OTHER_UNIT, Affine, Chunk, Edge, Op, Trace, TraceSection, Wait
from gproof.ir.trace_rows import row_span
from gproof.passes.motion import plan_kernels as k
from gproof.passes.motion import refusal_hints as hints


class Measured(Protocol):
    """What measuring a section has noted (``plan._Measure``)."""

    def noted(self, kind: int) -> Iterator[int]:
        """Rows with a note of that kind."""

    def lacking(self) -> list[tuple[str, tuple[str, ...]]]:
        """(axis name, what the machine file does not say) of axes that moved."""


class Refusals:
    """Judges sections one after the other, then ``finish``."""

    def __init__(self, trace: Trace, machine: Machine, findings: Findings, rules: LanguageRules | None) -> None:
        self.trace, self.machine, self.findings = trace, machine, findings
        self.arcs_apart = rules is not None and rules.arcs_keep_feed
        self._told: set[object] = set()
        # By whether arcs are meant: feeds not known; whether one was known; kinds after a known one of the other.
        self._feeds: dict[bool, list[Span]] = {}
        self._many = False
        self._had_feed = {False: False, True: False}
        self._doubted: set[bool] = set()
        self._left: list[Edge] = []

    def section(self, chunk: Chunk, section: TraceSection, measure: Measured) -> bool:
        """True when the section has all that a plan needs, and nothing but the operator ends it."""
        places = self._places(chunk, measure)
        times = self._times(chunk, measure)
        motors = self._motors(chunk, measure)
        changed = self._changed(chunk)
        return self._open_loop(section) and places and times and motors and changed

    def finish(self) -> None:
        """Tell what was counted."""
        for arc, spans in self._feeds.items():
            more = "many" if self._many else len(spans) - 1
            others = f", and of {more} more moves" if len(spans) > 1 else ""
            self._needs(spans[0], f"the feed of this move is unknown{others}", self._feed_hint(arc))
        if self._left and not self._told:
            edge = self._left[0]
            self._needs(self._at(edge), *hints.WAITS[Wait.BRANCH])

    def _needs(self, span: Span, cause: str, hint: str) -> None:
        if (cause, span) not in self._told:
            self._told.add((cause, span))
            self.findings.add(codes.PLAN_NEEDS_NUMBERS.at(span, cause=cause, hint=hint))

    # ---- places

    def _places(self, chunk: Chunk, measure: Measured) -> bool:
        unknown = self._first_unknown(chunk)
        if unknown is None:
            rows = list(measure.noted(k.N_UNKNOWN))
            for at in rows:
                hint = f"use a line no longer than a machine, in {self.trace.files[0]} or in its setup"
                self._needs(self._row(chunk, at), "the length of this move is not a usable number", hint)
            return not rows
        row, forms = unknown
        cause = ", ".join(f"{word} depends on {describe(form, self.machine)}" for word, form in forms)
        follows = all(hints.arises(form) for _, form in forms) and bool(self._told)
        if not follows and cause not in self._told:
            self._needs(self._row(chunk, row), cause, hints.of_forms(form for _, form in forms))
            self._told.add(cause)
        return False

    def _first_unknown(self, chunk: Chunk) -> tuple[int, list[tuple[str, Affine]]] | None:
        """The first motion row, and by axis why, that starts or ends where an axis of the machine is not known."""
        trace, rows, axes = chunk.trace, chunk.rows, self.machine.axes
        known = np.array([all(not frame[axis.index] for axis in axes) for frame in trace.frames])
        if known.all():
            return None
        before = chunk.start_frames()
        moves = (rows["op"] < Op.DWELL) & ((rows["frame"] != before) | (rows["to"] != chunk.starts()).any(axis=1))
        bad = np.flatnonzero(moves & ~(known[rows["frame"]] & known[before]))
        if not len(bad):
            return None
        row = int(bad[0])
        frame = trace.frames[int((rows["frame"] if not known[rows["frame"][row]] else before)[row])]
        return row, [(axis.word, frame[axis.index]) for axis in axes if frame[axis.index]]

    # ---- feeds and times

    def _times(self, chunk: Chunk, measure: Measured) -> bool:
        sound = True
        noted = list(measure.noted(k.N_FEED))
        self._many = self._many or len(noted) == k.KEPT
        for at in noted:
            sound = False
            feed = float(chunk.rows["feed"][at])
            if feed >= 0:
                cause, hint = f"a feed of {feed:g} never ends this move", "program an F above 0"
                self._needs(self._row(chunk, at), cause, hint)
                continue
            arc = bool(chunk.rows["op"][at] == Op.ARC)
            self._feeds.setdefault(arc, []).append(self._row(chunk, at))
            if self._had_feed[not arc] or _has_feed(chunk, at, arc=not arc):
                self._doubted.add(arc)
        for at in measure.noted(k.N_DWELL):
            sound = False
            hint = "use a plain number in the job, or state it in [parameters] of the setup file"
            self._needs(self._row(chunk, at), "the time of this dwell is unknown", hint)
        for arc in (False, True):
            self._had_feed[arc] = self._had_feed[arc] or _has_feed(chunk, len(chunk.rows), arc=arc)
        return sound

    def _feed_hint(self, arc: bool) -> str:
        share = self.machine.settings.arcs_share_feed
        if self.arcs_apart and share is None and arc in self._doubted:
            return hints.ARCS_FEED
        if self.arcs_apart and arc and share is False:
            return hints.OWN_FEED
        if self.findings.counts.get(codes.FEED_UNKNOWN.number):
            return f"see {codes.FEED_UNKNOWN.label}: it says what the feed depends on"
        return hints.FEED_FORGOTTEN

    def _changed(self, chunk: Chunk) -> bool:
        """False where the program itself has changed how axes go: steps by the machine's file are others."""
        rows = chunk.rows
        for at in np.flatnonzero(rows["op"] < Op.DWELL).tolist() if self._sets(chunk) else []:
            state = chunk.trace.states[int(rows["state"][at])]
            if state.retimed or state.backlash:
                changed = [name for name in state.retimed if name != OTHER_UNIT]
                names = " and ".join((*changed, *(["L8 or L9"] if state.backlash else [])))
                cause = f"{names} in the job have changed the axes of the machine file"
                hint = "leave them out: then the values of the machine file apply"
                if not names:
                    cause = (
                        "F was programmed before the unit changed, and the manual does not say whether its number "
                        "or its length stays"
                    )
                    hint = "program F after the change of unit"
                self._needs(self._row(chunk, at), cause, hint)
                return False
        return True

    def _sets(self, chunk: Chunk) -> bool:
        return any(state.retimed or state.backlash for state in chunk.trace.states)

    # ---- motors

    def _motors(self, chunk: Chunk, measure: Measured) -> bool:
        lacking = measure.lacking()
        for name, missing in lacking:
            if name in self._told:
                continue
            self._told.add(name)
            hint = hints.of_motor(self.machine.axis(name), name, missing)
            where = self._row(chunk, _first_move(chunk, AXIS_NAMES.index(name)))
            what = " and no ".join(missing)
            self.findings.add(codes.NO_MOTOR_DATA.at(where, axis=name.upper(), missing=what, hint=hint))
        return not lacking

    # ---- waits

    def _open_loop(self, section: TraceSection) -> bool:
        """True when nothing but the operator ends the section: that is all a stream of steps can wait for."""
        for edge in section.edges:
            if edge.wait not in hints.WAITS:
                continue
            if edge.outcome or edge.wait is not Wait.BRANCH:
                self._needs(self._at(edge), *hints.WAITS[edge.wait])
            elif self._never_ends(section.number, edge.target):
                self._needs(self._at(edge), *hints.ENDLESS)
            else:
                self._left.append(edge)  # outcomes meet: where they part is reported
            return False
        return True

    def _never_ends(self, number: int, target: int) -> bool:
        """True when all ways from ``target`` lead on for ever, ``number`` among them."""
        seen, todo = {target}, [target]
        while todo:
            for edge in self.trace.sections[todo.pop()].edges:
                if edge.target < 0:
                    return False
                if edge.target not in seen:
                    seen.add(edge.target)
                    todo.append(edge.target)
        return number in seen

    # ---- spans

    def _at(self, edge: Edge) -> Span:
        return Span(self.trace.files[edge.file], max(1, edge.line))

    def _row(self, chunk: Chunk, row: int) -> Span:
        return row_span(self.trace, chunk.rows, row)


def _has_feed(chunk: Chunk, end: int, *, arc: bool) -> bool:
    """True when an arc, or a line, before row ``end`` has a feed that is known."""
    rows = chunk.rows
    feed = rows["feed"][:end]
    return bool(((rows["op"][:end] == (Op.ARC if arc else Op.FEED)) & np.isfinite(feed) & (feed > 0)).any())


def _first_move(chunk: Chunk, axis: int) -> int:
    """The first motion row that moves an axis (0 when none does by its ends: a full circle)."""
    rows = chunk.rows
    moving = (rows["op"] < Op.DWELL) & ((rows["to"][:, axis] != chunk.starts()[:, axis]) | (rows["op"] == Op.ARC))
    return int(np.argmax(moving))
