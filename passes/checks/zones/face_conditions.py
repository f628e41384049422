"""Where offsets are unknown: the extents of a job's rows, and what keeps all of them clear of a zone.

One face of the zone's box that the whole path stays beyond is enough; the one that leaves the most room is taken.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from gproof.ir.machine import AXIS_NAMES, Machine
from gproof.ir.record import record
from gproof.ir.setup import Setup
from gproof.ir.symbolic import Position, add_forms
from gproof.ir.symbols import describe
from gproof.ir.trace import UNKNOWN, Affine, Trace
from gproof.ir.trace_rows import form_interval, split_form
from gproof.ir.verdict import Condition
from gproof.passes.checks.zones.shapes import Box, Point, Zone

EVERYWHERE = (-math.inf, math.inf)
Ranges = dict[Affine, tuple[float, float]]


@record(frozen=True, slots=True, kw_only=True)
class View:
    """How rows in some states are judged: positions less ``shift`` and ``form`` against the zone.

    outer: what may be entered; inner: what is for certain, None when nothing is; cause: what is between the two;
    box: around outer, for plain positions; tip: what is taken from Z for a second reading, where it is not known;
    off: the guard is off; lost: another head is at work, whose place is not followed; part: of the tool, in words, ""
    its cutter.
    """

    shift: Point
    form: tuple[Affine, Affine, Affine]
    outer: Zone
    inner: Zone | None
    cause: str
    box: Box
    tip: Position | None
    off: bool
    lost: bool
    part: str = ""


class OpenPlaces:
    """Extents by (view, frame) of the rows whose places rest on something unknown. views: those of the zone."""

    def __init__(self, machine: Machine, setup: Setup, views: list[View]) -> None:
        self._machine, self._setup, self.views = machine, setup, views
        self.trace = Trace()
        self.low: dict[tuple[int, int], np.ndarray] = {}
        self.high: dict[tuple[int, int], np.ndarray] = {}

    def copy(self) -> OpenPlaces:
        """The same extents, to be widened by themselves."""
        other = OpenPlaces(self._machine, self._setup, self.views)
        other.trace, other.low, other.high = self.trace, dict(self.low), dict(self.high)
        return other

    def widen(self, view: int, frame: int, low: np.ndarray, high: np.ndarray) -> None:
        """Rows of a view reach from low to high, (3,) each, in a frame."""
        key = view, frame
        if key in self.low:
            self.low[key] = np.minimum(self.low[key], low)
            self.high[key] = np.maximum(self.high[key], high)
        else:
            self.low[key], self.high[key] = low.copy(), high.copy()

    @property
    def has_lost(self) -> bool:
        """Whether of some of the places nothing is known at all."""
        return any(UNKNOWN in self.trace.frames[frame][:3] for _, frame in self.low)

    def causes(self) -> list[str]:
        """What the places rest on, in words."""
        forms = (f for view, frame in self.low for f in (*self._forms(view, frame), *self._tip_form(view, frame)))
        return sorted({describe(form, self._machine) for form in forms if form != ()})

    def _forms(self, view: int, frame: int) -> list[Affine]:
        """What positions of a frame rest on, less what the zone does."""
        forms = self.trace.frames[frame][:3]
        return [
            UNKNOWN if a == UNKNOWN else add_forms(a, b, -1) for a, b in zip(forms, self.views[view].form, strict=True)
        ]

    def _tip_form(self, view: int, frame: int) -> list[Affine]:
        tip = self.views[view].tip
        return [] if tip is None else [add_forms(self.trace.frames[frame][2], tip.form, -1)]

    def best_face(self, given: Ranges) -> tuple[Condition, ...] | None:
        """The face of the zone's box that leaves the most room to the unknown offsets, as conditions."""
        best: tuple[float, tuple[Condition, ...]] | None = None
        for axis in range(3):
            for below in (True, False):
                found = self._face(axis, below, given)
                if found is None:
                    continue
                room = min((c.high - c.low for c in found), default=math.inf)
                if best is None or room > best[0]:
                    best = (room, found)
        return None if best is None else best[1]

    def _readings(self, axis: int) -> Iterator[tuple[Affine, float, float, Affine]]:
        """(what it rests on, low, high, what the axis rests on) of each place that must be beyond a face."""
        for (number, frame), low in self.low.items():
            own = self.trace.frames[frame][axis]
            least, most = float(low[axis]), float(self.high[number, frame][axis])
            yield self._forms(number, frame)[axis], least, most, own
            tip = self.views[number].tip
            if axis == 2 and tip is not None:
                yield self._tip_form(number, frame)[0], least - tip.value, most - tip.value, UNKNOWN

    def _face(self, axis: int, below: bool, given: Ranges) -> tuple[Condition, ...] | None:
        limits = self._machine.axis(AXIS_NAMES[axis]) if axis != 1 or self._setup.cylinder is None else None
        bounds: dict[Affine, list[float]] = {}
        views = {number for number, _ in self.low}
        faces = [self.views[number].box[axis][0 if below else 1] for number in views]
        # Faces of several views (other tools, other offsets): the farthest of them holds for all.
        face = min(faces) if below else max(faces)
        for form, low, high, own in self._readings(axis):
            if form == UNKNOWN:
                return None
            if form == ():
                if (high > face) if below else (low < face):
                    return None
                continue
            bound = bounds.setdefault(form, [-math.inf, math.inf])
            if limits is not None and form == own and limits.lower is not None:
                bound[0] = max(bound[0], limits.lower - low)
            if limits is not None and form == own and limits.upper is not None:
                bound[1] = min(bound[1], limits.upper - high)
            if below:
                bound[1] = min(bound[1], face - high)
            else:
                bound[0] = max(bound[0], face - low)
        return self._asked(bounds, given)

    def _asked(self, bounds: dict[Affine, list[float]], given: Ranges) -> tuple[Condition, ...] | None:
        """Bounds of unknowns as conditions, None when what is known of them does not suit."""
        out = []
        rooms: dict[Affine, list[float]] = {}
        for form, (low_bound, high_bound) in sorted(bounds.items()):
            stated = form_interval(form, self._setup, self.trace)
            if stated is not None:
                if not (low_bound <= stated.low and stated.high <= high_bound):
                    return None
                continue
            arising, rest = split_form(form)
            span = form_interval(arising, self._setup, self.trace)
            if span is None or not rest:
                return None
            room = rooms.setdefault(rest, list(given.get(rest, EVERYWHERE)))
            room[0], room[1] = max(room[0], low_bound - span.low), min(room[1], high_bound - span.high)
        for form, (least, most) in sorted(rooms.items()):
            if least > most:
                return None
            out.append(Condition(terms=form, low=least, high=most))
        return tuple(out)
