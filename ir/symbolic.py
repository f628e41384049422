"""Values that may rest on unknowns: numbers, sums with unknown offsets, and the plainly unknown."""

from __future__ import annotations

import math

from gproof.ir import codes
from gproof.ir.dialects.accepts import READINGS_OF_L20, READINGS_OF_Z
from gproof.ir.finding import Finding, Span
from gproof.ir.intervals import Range
from gproof.ir.machine import AXES, AXIS_NAMES
from gproof.ir.record import record
from gproof.ir.symbols import ACTUAL, STORED, UNHOMED, UNIFORM
from gproof.ir.trace import UNKNOWN, Affine, Frame


@record(frozen=True, slots=True)
class Unknown:
    """A number that is not known but for its bounds; cause: what is unknown, for the message; whole: it is a whole
    number; place: the place of an axis whose coordinate it is."""

    cause: str
    low: float = -math.inf
    high: float = math.inf
    whole: bool = False
    place: Place | None = None

    def __hash__(self) -> int:
        # Equal ones have equal bounds; many of them are parts of the keys of states.
        return hash((self.low, self.high))

    @property
    def bounded(self) -> bool:
        """True when it is between two finite numbers."""
        return math.isfinite(self.low) and math.isfinite(self.high)


Value = float | Unknown

NOBODY = "whose value is unknown"


def not_known(span: Span, word: str, value: Unknown, hint: str = "") -> Finding:
    """GP225 for a word whose value is unknown, or of which only bounds are known where one number is needed."""
    why = "whose limits are known but not its value" if value.bounded else NOBODY
    return codes.UNKNOWN_VALUE.at(span, word=word, cause=value.cause, why=why, hint=hint)


def behind_loop(name: str) -> str:
    """The cause of what the variable of a counted loop holds after it."""
    return f"{name} after its loop"


def bounds(value: Value) -> Range:
    """The least and the greatest number that a value can be."""
    return (value.low, value.high) if isinstance(value, Unknown) else (value, value)


def scaled(value: Value, factor: float) -> Value:
    """A value times a number that is known."""
    if not isinstance(value, Unknown):
        return value * factor
    low, high = sorted((value.low * factor, value.high * factor))
    return Unknown(value.cause, low, high)


def hull(one: Value, other: Value) -> Range:
    """The least range that holds both."""
    (a, b), (c, d) = bounds(one), bounds(other)
    return min(a, c), max(b, d)


def between(cause: str, ends: Range, *, whole: bool = False) -> Value:
    """A value somewhere in a range: a number when only one is possible."""
    return ends[0] if ends[0] == ends[1] else Unknown(cause, *ends, whole)


def is_whole(value: Value) -> bool:
    """Whether it is known to be a whole number."""
    return value.whole if isinstance(value, Unknown) else math.isfinite(value) and value == math.floor(value)


def add_forms(left: Affine, right: Affine, sign: int = 1) -> Affine:
    """left + sign * right; anything with UNKNOWN is UNKNOWN."""
    if not right:
        return left
    if UNKNOWN in (left, right):
        return UNKNOWN
    total = dict(left)
    for symbol, coefficient in right:
        total[symbol] = total.get(symbol, 0) + sign * coefficient
    return tuple(sorted((s, c) for s, c in total.items() if c))


@record(frozen=True, slots=True)
class Position:
    """A coordinate: a number of mm or degrees plus a sum of unknown offsets."""

    value: float
    form: Affine = ()

    def plus(self, other: Position) -> Position:
        """Their sum."""
        return Position(self.value + other.value, add_forms(self.form, other.form))

    def minus(self, other: Position) -> Position:
        """Their difference; equal forms cancel."""
        return Position(self.value - other.value, add_forms(self.form, other.form, -1))

    def moved(self, distance: float) -> Position:
        """Shifted by a known distance."""
        return Position(self.value + distance, self.form)


NOWHERE = Position(0.0, UNKNOWN)
ORIGIN = Position(0.0)


@record(frozen=True, slots=True)
class Place:
    """Where a coordinate that is not known is: as a word of its axis it sends the axis there, as long as words count
    from the same origin.

    axis: column; at: machine place; origin: what was taken from it; scale: mm or degrees in one unit of the number.
    """

    axis: int
    at: Position
    origin: Position
    scale: float

    def moved(self, distance: float) -> Place:
        """That of a coordinate so many units on."""
        return Place(self.axis, self.at.moved(distance * self.scale), self.origin, self.scale)


def at_place(value: Unknown, axis: int, at: Position, origin: Position, scale: float) -> Unknown:
    """A coordinate as the value that it is, with its place where that is known."""
    if UNKNOWN in (at.form, origin.form):
        return value
    return Unknown(value.cause, value.low, value.high, value.whole, Place(axis, at, origin, scale))


BESIDE = "beside."
"""How the symbols of places along a contour start (docs/trace.md, Frames)."""


def hint_of(form: Affine) -> str:
    """What a shop can state of the unknowns of a sum, "" where nothing is known that it could."""
    if any(s.startswith(f"{UNIFORM}.") and s.endswith(".z") for s, _ in form):
        return READINGS_OF_Z
    if any(s.startswith(f"{ACTUAL}.") for s, _ in form):
        return READINGS_OF_L20
    if any(s.startswith(f"{STORED}.") for s, _ in form):
        return "state it under [parameters] in the setup file: G92.2 of an earlier job leaves it"
    return ""


NO_AXES = frozenset[int]()


def _shifted(form: Affine, axis: int) -> Affine:
    """A form of an axis that was never homed: wherever the controller shows it, it is elsewhere."""
    return form if form == UNKNOWN else add_forms(form, ((f"{UNHOMED}.{AXIS_NAMES[axis]}", 1),))


class FrameTable:
    """Interns forms and frames so that rows carry small integers."""

    def __init__(self, frames: list[Frame]) -> None:
        self.frames = frames
        self._index = {frame: i for i, frame in enumerate(frames)}
        self.forms: list[Affine] = [()]
        self._form_index: dict[Affine, int] = {(): 0}

    def form(self, form: Affine) -> int:
        """A small integer for a form; 0 is "known"."""
        index = self._form_index.get(form)
        if index is None:
            index = self._form_index[form] = len(self.forms)
            self.forms.append(form)
        return index

    def frame(self, positions: list[Position], unhomed: frozenset[int] = NO_AXES) -> int:
        """The index of the frame in which these positions are; unhomed: columns without a reference run."""
        p = positions
        frame = (p[0].form, p[1].form, p[2].form, p[3].form, p[4].form, p[5].form)
        if unhomed:
            frame = tuple(_shifted(form, axis) if axis in unhomed else form for axis, form in enumerate(frame))  # type: ignore[assignment]
        index = self._index.get(frame)
        if index is None:
            index = self._index[frame] = len(self.frames)
            self.frames.append(frame)
        return index


AXIS_RANGE = range(AXES)
AXIS_INDEX = {name.upper(): i for i, name in enumerate(AXIS_NAMES)}


def beyond(letter: str, value: float) -> str:
    """What to say of a word's number that no machine has; letter: ``@`` for one that is without a letter."""
    name = "the parameter" if letter == "@" else letter
    if not math.isfinite(value):
        return f"the number of {name} is too large for any machine"
    return f"{name}{' ' if letter == '@' else ''}{value:g} is too large for any machine"
