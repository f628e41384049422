"""A job whose offsets nobody knew when it was compiled, put where they are measured: the Trace and the stream moved.

Such a Trace has positions as a number and a sum of unknowns (``work.1.x + g92.x``). Where every place of an axis rests
on one and the same sum, other values of it move the whole axis and change no length, so that one stream, made for a
reference value, holds for all of them: moved by whole steps of every motor of the axis. ``places_of`` finds those sums
or says why there is none, ``put`` moves the Trace, ``moved`` both. Nothing here is believed: what comes out is
validated as any stream is. docs/certificate.md, "Measured offsets".
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
import numpy.typing as npt

from gproof.ir.columns import Columns, occurring
from gproof.ir.machine import AXES, AXIS_NAMES, Machine
from gproof.ir.record import record
from gproof.ir.setup import Interval, Setup
from gproof.ir.stream import StepStream
from gproof.ir.symbols import describe
from gproof.ir.trace import TRACE_ROW, Affine, Frame, Op, Trace, TraceSection
from gproof.ir.verdict import Condition
from gproof.verify.certificate.package import Package
from gproof.verify.explain.certificate_words import number

MEASURED = ("start", "work", "g92")
"""Kinds of symbols that may be measured later."""
_FEW = 3
"""So many sums are named in a message."""
_NEAR = 1e-6
"""Steps: what float64 may lose, as in the stream checker."""
_FAR = float(1 << 28)
"""Steps, as far as the stream checker goes."""


class NotPlaced(ValueError):
    """Why a Trace cannot be put at other offsets, or not at these; a part of a sentence."""


class NotStated(NotPlaced):
    """A setup says nothing of an offset that has to be known; symbols: which."""

    def __init__(self, said: str, symbols: frozenset[str]) -> None:
        super().__init__(said)
        self.symbols = symbols


@record(frozen=True, slots=True, kw_only=True)
class Place:
    """What the places of an axis rest on.

    form: the sum that every place of the job rests on, () for none; start: where the axis is when the job starts,
    less the form's value, None where its start rests on the form itself (or is the form); grid: mm or degrees, the
    least distance that is whole steps of all motors of the axis; step: of the finest of them.
    """

    axis: int
    form: Affine
    start: float | None
    grid: Fraction
    step: Fraction

    @property
    def name(self) -> str:
        """The axis as the IR calls it."""
        return AXIS_NAMES[self.axis]

    @property
    def begins(self) -> Affine:
        """The symbol of its start."""
        return ((f"start.{self.name}", 1),)

    def nearest(self, value: float) -> Fraction:
        """The nearest value on the grid; NotPlaced where that is more than half a step of some motor away."""
        if not math.isfinite(value) or abs(value) / float(self.step) > _FAR:
            raise NotPlaced(f"{value} is not a position")
        taken = round(Fraction(value) / self.grid) * self.grid
        if abs(Fraction(value) - taken) > self.step / 2 + self.step * Fraction(_NEAR):
            what = f"{number(value)} is {number(float(abs(Fraction(value) - taken)))} from the nearest position that"
            raise NotPlaced(f"{what} all its motors can reach: more than half a step")
        return taken

    def conditions(self) -> Iterator[Condition]:
        """What the runtime requires of a setup: the form is given, and the axis is where the stream starts."""
        if self.start is None:
            yield Condition(terms=self.form, low=-math.inf, high=math.inf)
            return
        terms = tuple(sorted((*self.begins, *((symbol, -count) for symbol, count in self.form))))
        half = float(self.step * (Fraction(1, 2) + Fraction(_NEAR)))
        yield Condition(terms=terms, low=self.start - half, high=self.start + half)


@record(frozen=True, slots=True, kw_only=True)
class Moved:
    """A job where its offsets are: with numbers for positions."""

    trace: Trace
    stream: StepStream


Values = Mapping[int, float]
"""The value of a form by axis, mm or degrees."""


def places_of(trace: Trace, machine: Machine, setup: Setup) -> dict[int, Place]:
    """By axis, what its places rest on; empty where all are known. NotPlaced where the job cannot be put anywhere."""
    found: dict[int, Place] = {}
    frames = {section.start_frame for section in trace.sections}
    for section in trace.sections:
        frames.update(occurring(section.rows["frame"]) if len(section.rows) else ())
    for axis in machine.axes:
        used = {trace.frames[frame][axis.index] for frame in frames}
        if used - {()} and trace.sections:
            found[axis.index] = _place(trace, machine, axis.index, used)
    if not any(place.form for place in found.values()):
        return {}
    if setup.cylinder is not None:
        raise NotPlaced("Y is mapped onto A, which fixes the position of the job")
    if setup.height_map is not None:
        raise NotPlaced("the height map fixes the position of the job")
    for number_, place in found.items():
        if any(drive.pitch is not None for axis in machine.axes if axis.index == number_ for drive in axis.drives()):
            raise NotPlaced(f"{machine.word(number_)} has a pitch table, so the steps depend on the position")
        for symbol, _ in place.form:
            stated = setup.interval(symbol)
            if stated is not None and stated.exact:
                raise NotPlaced(f"{describe(((symbol, 1),), machine)} is in the setup, and yet open")
    return found


def _place(trace: Trace, machine: Machine, axis: int, used: set[Affine]) -> Place:
    word = machine.word(axis)
    begins: Affine = ((f"start.{AXIS_NAMES[axis]}", 1),)
    rests = used - {begins}
    if len(rests) > 1:
        said = sorted({"a machine position" if not form else describe(form, machine) for form in rests})
        said.sort(key=len)
        said[_FEW:] = [f"{len(said) - _FEW} more"] if len(said) > _FEW else []
        raise NotPlaced(f"{word} depends on {' and on '.join(said)}: the distance between them is not known")
    form = next(iter(rests), begins)
    for symbol, count in form:
        kind, *rest = symbol.split(".")
        if kind not in MEASURED or rest[-1] != AXIS_NAMES[axis] or count != 1 or symbol in trace.symbols:
            what = describe(((symbol, count),), machine)
            raise NotPlaced(f"{word} depends on {describe(form, machine)}, and {what} cannot be measured later")
        if kind == "work" and not 1 <= int(rest[0]) <= 9:
            raise NotPlaced(f"{word} depends on the active work offset, and the setup does not say which one is active")
    start = _start(trace, axis, begins, form) if begins in used and form != begins else None
    rates = [d.steps_per_unit for a in machine.axes if a.index == axis for d in a.drives()]
    if any(rate is None or not rate for rate in rates):
        raise NotPlaced(f"{word} has a motor without steps_per_unit in the machine file")
    known = [abs(Fraction(rate)) for rate in rates if rate is not None]
    grid = Fraction(math.lcm(*(r.denominator for r in known)), math.gcd(*(r.numerator for r in known)))
    return Place(axis=axis, form=form, start=start, grid=grid, step=1 / max(known))


def _start(trace: Trace, axis: int, begins: Affine, form: Affine) -> float:
    """Where the axis must be, less the form's value: where the first move to a place of the form takes it.

    The first section that has such a move decides; of others, and of moves in between, the lengths are known then too.
    """
    for section in trace.sections:
        frames = np.concatenate([[section.start_frame], section.rows["frame"]])
        numbers = np.concatenate([[section.start[axis]], section.rows["to"][:, axis]])
        rests = np.array([frame[axis] == form for frame in trace.frames])[frames]
        free = np.array([frame[axis] == begins for frame in trace.frames])[frames]
        at = np.flatnonzero(rests[1:] & free[:-1])
        if len(at):
            return float(numbers[at[0] + 1] - numbers[at[0]])
    raise NotPlaced("no move leads from the start to the work")


def put(trace: Trace, places: Mapping[int, Place], values: Values) -> Trace:
    """The Trace with numbers for the places of these axes: ``values`` for their forms."""
    by_frame = np.zeros((len(trace.frames), AXES))
    frames: list[Frame] = []
    for index, frame in enumerate(trace.frames):
        forms = list(frame)
        for axis, place in places.items():
            if frame[axis] == place.begins and place.start is not None:
                by_frame[index, axis] = values[axis] + place.start
                forms[axis] = ()
            elif frame[axis] == place.form:
                by_frame[index, axis] = values[axis]
                forms[axis] = ()
        a, b, c, d, e, f = forms
        frames.append((a, b, c, d, e, f))
    sections = [_put(section, by_frame) for section in trace.sections]
    return dataclasses.replace(trace, frames=frames, sections=sections)


def _put(section: TraceSection, by_frame: npt.NDArray[np.float64]) -> TraceSection:
    rows = section.rows
    more = by_frame[rows["frame"]]
    before = by_frame[np.concatenate([[section.start_frame], rows["frame"]])[: len(rows)]]
    arcs = rows["op"] == Op.ARC
    if (more[arcs] != before[arcs]).any():
        raise NotPlaced("an arc starts at the unknown start position")
    columns = {column.name: rows[column.name] for column in TRACE_ROW.columns}
    columns["to"] = rows["to"] + more
    columns["center"] = rows["center"] + np.where(arcs[:, np.newaxis], more[:, :3], 0.0)
    start = np.array(section.start) + by_frame[section.start_frame]
    return dataclasses.replace(section, start=tuple(start.tolist()), rows=Columns(TRACE_ROW, columns))


def reference(places: Mapping[int, Place], conditions: Sequence[Condition], setup: Setup) -> dict[int, float]:
    """A value for each form on whole steps: in the middle of what conditions and ranges of the setup leave of it."""
    return {axis: _reference(place, conditions, setup) for axis, place in places.items()}


def _reference(place: Place, conditions: Sequence[Condition], setup: Setup) -> float:
    if not place.form:
        return 0.0
    stated = [setup.interval(symbol) for symbol, _ in place.form]
    low, high = -math.inf, math.inf
    if all(ends is not None for ends in stated):
        low = sum(ends.low for ends in stated if ends is not None)
        high = sum(ends.high for ends in stated if ends is not None)
    for condition in conditions:
        count, shift = _of_form(condition, place, setup)
        if count:
            ends = sorted(((condition.low - shift) / count, (condition.high - shift) / count))
            low, high = max(low, ends[0]), min(high, ends[1])
    if low > high:
        raise NotPlaced(
            f"the conditions for {describe(place.form)} and for the start of the axis contradict each other"
        )
    both = math.isfinite(low) and math.isfinite(high)
    middle = (low + high) / 2 if both else low if math.isfinite(low) else high if math.isfinite(high) else 0.0
    if abs(middle) / float(place.step) > _FAR:
        raise NotPlaced(f"{describe(place.form)} is too far away")
    return float(round(Fraction(middle) / place.grid) * place.grid)


def _of_form(condition: Condition, place: Place, setup: Setup) -> tuple[int, float]:
    """A condition as count x form + shift, the start being where the stream starts; (0, 0) when it has no such form.

    Of offsets that are bounded, and that a condition has no term of, the middle counts.
    """
    counts = dict(condition.terms)
    begins = 0 if place.start is None else counts.pop(place.begins[0][0], 0)
    for symbol, _ in place.form if begins else ():
        counts[symbol] = counts.get(symbol, 0) + begins
    used = {symbol: count for symbol, count in counts.items() if count}
    count, shift = max(used.values(), key=abs, default=0), begins * (place.start or 0.0)
    for symbol, _ in place.form:
        ends = setup.interval(symbol)
        if symbol not in used and ends is not None:
            used[symbol] = count
            shift -= count * (ends.low + ends.high) / 2
    return (count, shift) if count and used == {symbol: count for symbol, _ in place.form} else (0, 0.0)


@record(frozen=True, slots=True, kw_only=True)
class Open:
    """What a package leaves to be measured. reference: the values that its stream was made for."""

    places: dict[int, Place]
    reference: dict[int, float]

    @property
    def symbols(self) -> frozenset[str]:
        """Those that a setup has to state."""
        forms = [p.form if p.start is None else (*p.form, *p.begins) for p in self.places.values()]
        return frozenset(symbol for form in forms for symbol, _ in form)


def written(places: Mapping[int, Place], reference: Mapping[int, float]) -> dict[str, str]:
    """The ``reference`` of a certificate's body."""
    return {place.name: repr(reference[axis]) for axis, place in places.items()}


def open_of(body: Mapping[str, Any], trace: Trace, machine: Machine, setup: Setup) -> Open | None:
    """What a package leaves to be measured, None for nothing; ValueError where its body does not fit its Trace."""
    given = body.get("reference")
    if given is None:
        return None
    places = places_of(trace, machine, setup)
    if not isinstance(given, dict) or not places or set(given) != {place.name for place in places.values()}:
        raise ValueError("the reference does not fit the axes that depend on open offsets")
    values = {axis: float(given[place.name]) for axis, place in places.items()}
    if not all(abs(value) / float(places[axis].step) < _FAR for axis, value in values.items()):
        raise ValueError("a reference is not a position")
    return Open(places=places, reference=values)


def values_of(
    places: Mapping[int, Place], setup: Setup, machine: Machine
) -> tuple[dict[int, Fraction], list[tuple[Place, NotPlaced]]]:
    """The forms' values on whole steps, as a setup states them, and where it does not, or states what cannot be.

    The axes must be where the stream starts, to half a step.
    """
    found: dict[int, Fraction] = {}
    problems: list[tuple[Place, NotPlaced]] = []
    for axis, place in places.items():
        try:
            found[axis] = _value(place, setup, machine)
        except NotPlaced as error:
            problems.append((place, error))
    return found, problems


def _value(place: Place, setup: Setup, machine: Machine) -> Fraction:
    exact = sum((_exact(symbol, setup, machine) for symbol, _ in place.form), Fraction(0))
    try:
        taken = place.nearest(float(exact)) if place.form else Fraction(0)
    except NotPlaced as error:
        raise NotPlaced(f"{describe(place.form, machine)} {error}") from None
    if place.start is not None:
        stands = _exact(place.begins[0][0], setup, machine)
        beside = abs(stands - taken - Fraction(place.start))
        if beside > place.step / 2 + place.step * Fraction(_NEAR):
            word, at = machine.word(place.axis), number(float(taken + Fraction(place.start)))
            stood = number(float(stands))
            raise NotPlaced(f"the job starts with {word} at machine position {at}, but it is at {stood}")
    return taken


def _exact(symbol: str, setup: Setup, machine: Machine) -> Fraction:
    stated: Interval | None = setup.interval(symbol)
    called = describe(((symbol, 1),), machine)
    if stated is None:
        raise NotStated(f"{called} is not in the setup, and the steps of the job depend on it", frozenset({symbol}))
    if not stated.exact or not math.isfinite(stated.low):
        raise NotPlaced(f"the setup does not give an exact {called}, and the steps of the job depend on it")
    return Fraction(stated.low)


def taken(package: Package, setup: Setup | None) -> list[str]:
    """What measured offsets are taken for, on whole steps, and how far off; [] where they are not all stated."""
    try:
        open_ = open_of(package.body, package.trace, package.machine, package.setup)
    except (ValueError, TypeError, ArithmeticError):
        return []
    if open_ is None or setup is None:
        return []
    values, problems = values_of(open_.places, setup, package.machine)
    said = []
    for axis, place in open_.places.items() if not problems else ():
        if place.form:
            beside = abs(_sum(place.form, setup) - values[axis])
            more = f", {number(float(beside))} off the setup" if beside * 10**4 >= 1 else ""
            said.append(f"{describe(place.form, package.machine)} as {number(float(values[axis]))}{more}")
    return said


def slack(places: Mapping[int, Place], taken: Mapping[int, Fraction], condition: Condition, setup: Setup) -> float:
    """How far a condition's sum may be from what the setup states, because offsets are taken for whole steps."""
    counts, total = {symbol: abs(count) for symbol, count in condition.terms}, 0.0
    for axis, place in places.items():
        exact = _sum(place.form, setup)
        most = max((counts.get(symbol, 0) for symbol, _ in place.form), default=0)
        total += most * float(abs(exact - taken[axis]))
        begins = counts.get(place.begins[0][0], 0) if place.start is not None else 0
        if begins and place.start is not None:
            total += begins * float(abs(_sum(place.begins, setup) - taken[axis] - Fraction(place.start)))
    return total


def _sum(form: Affine, setup: Setup) -> Fraction:
    return sum((Fraction(ends.low) for s, _ in form if (ends := setup.interval(s)) is not None), Fraction(0))


def moved(trace: Trace, stream: StepStream, open_: Open, at: Mapping[int, Fraction], machine: Machine) -> Moved:
    """The job at these values; stream: as it was made for the reference, which is on whole steps."""
    places = open_.places
    shifts = {axis: at[axis] - base for axis, base in _bases(open_, machine).items()}
    steps = [shifts.get(motor.axis, Fraction(0)) * motor.steps_per_unit for motor in stream.motors]
    if any(step.denominator != 1 for step in steps):
        raise NotPlaced("the stream's motors are not those of the machine")
    sections = [
        dataclasses.replace(s, start=tuple(a + int(b) for a, b in zip(s.start, steps, strict=True)))
        for s in stream.sections
    ]
    return Moved(
        trace=put(trace, places, {axis: float(value) for axis, value in at.items()}),
        stream=dataclasses.replace(stream, sections=sections),
    )  # fmt: skip


def _bases(open_: Open, machine: Machine) -> dict[int, Fraction]:
    """The reference, on whole steps."""
    found: dict[int, Fraction] = {}
    for axis, place in open_.places.items():
        made_for = Fraction(open_.reference[axis])
        found[axis] = round(made_for / place.grid) * place.grid
        if abs(made_for - found[axis]) > place.step * Fraction(_NEAR):
            what = f"{describe(place.form, machine)} {open_.reference[axis]}"
            raise NotPlaced(f"the stream was made for {what}: between motor steps")
    return found


def moved_to(package: Package, start: Sequence[int]) -> Moved | None:
    """The job of a package where its motors start at these steps; None where it has no open offsets, or none such."""
    open_ = open_of(package.body, package.trace, package.machine, package.setup)
    stream = package.stream
    if open_ is None or len(start) != len(stream.motors) or not stream.sections:
        return None
    begins = zip(stream.motors, start, stream.sections[0].start, strict=True)
    shifts = {(motor.axis, Fraction(now - then) / motor.steps_per_unit) for motor, now, then in begins}
    by_axis = dict(shifts)
    free = {axis for axis, place in open_.places.items() if place.form}
    if len(by_axis) != len(shifts) or any(shift and axis not in free for axis, shift in shifts):
        return None
    at = {axis: base + by_axis.get(axis, 0) for axis, base in _bases(open_, package.machine).items()}
    if any(value % open_.places[axis].grid for axis, value in at.items()):
        return None
    return moved(package.trace, stream, open_, at, package.machine)
