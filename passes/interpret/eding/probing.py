"""G38.2, the straight probe: the contact is anywhere on the programmed segment. Eding CNC manual 3.4.10.

What the probe touched is an unknown of its own for each axis that moved, bounded by the ends of the segment where both
rest on the same offsets; the place where the axes are afterwards, drawn back a little, is another one.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.finding import Refusal
from gproof.ir.intervals import ANY, Range
from gproof.ir.machine import AXES, AXIS_NAMES
from gproof.ir.rules import CodeRule
from gproof.ir.symbolic import NOWHERE, Position, Unknown, Value, at_place, between
from gproof.ir.trace import Op, Wait
from gproof.passes.interpret.core.parsed_line import Line

if TYPE_CHECKING:
    from gproof.passes.interpret.core.run import Run

CONTACT = 5051
"""The first of the parameters that show the contact in machine coordinates (3.1.1): a setup may bound them."""
SHORTEST_MM = 0.254
"""3.4.10.1: a programmed point nearer than this is an error."""


def run_probe(run: Run, line: Line, rule: CodeRule, target: list[Position]) -> None:
    """Execute a probe move to ``target``; Refusal GP291 to GP294."""
    s = run.modal
    axes = line.axes()
    if not any(axis < 3 for axis in axes):
        raise Refusal(codes.PROBE_AXIS_MISSING.at(line.span, code=rule.text))
    if s.feed_mode == 93:
        raise Refusal(codes.PROBE_INVERSE_TIME.at(line.where_code(rule) if rule in line.rules else line.span))
    start = list(s.position)
    for axis in range(3, AXES):
        if axis in axes and target[axis] != start[axis]:
            raise Refusal(codes.PROBE_ROTARY.at(line.span, axis=AXIS_NAMES[axis].upper()))
    ways = [end.minus(begin) for begin, end in zip(start, target, strict=True)]
    if all(not way.form for way in ways[:3]):
        distance = math.sqrt(sum(way.value * way.value for way in ways[:3]))
        if distance < SHORTEST_MM:
            raise Refusal(codes.PROBE_TOO_NEAR.at(line.span, distance=distance, least=SHORTEST_MM))
    run.move(Op.PROBE, list(target), line.span)
    if s.rendering:
        _record(run, list(target), 1.0)
        return
    run.assumed["a probing move ends at its programmed point at the latest"] = None
    reach = [_reach(run, axis, start[axis], target[axis]) for axis in range(AXES)]
    contact = [_somewhere(run, axis, start[axis], target[axis], reach[axis]) for axis in range(AXES)]
    # In the tool setter of the manual's macro file a program goes on without contact, and asks #5067 for it.
    _record(run, contact, Unknown("whether the probe touched", 0.0, 1.0))
    # Drawn back a little: between the contact and the start.
    back = [(min(0.0, low), max(0.0, high)) for low, high in reach]
    s.position = [_somewhere(run, axis, start[axis], target[axis], back[axis]) for axis in range(AXES)]
    run.end_section(Wait.PROBE, "stopped", None, line.span)


def _reach(run: Run, axis: int, start: Position, end: Position) -> Range:
    """How far from the start the contact can be: on the segment, and where the setup says that it will be."""
    way = end.minus(start)
    if way.form:
        return ANY
    low, high = min(0.0, way.value), max(0.0, way.value)
    stated = run.setup.parameter_ranges.get(CONTACT + axis)
    if stated is not None and not start.form:
        scale = run.modal.scale(axis)
        low = min(max(low, stated.low * scale - start.value), high)
        high = max(min(high, stated.high * scale - start.value), low)
    return low, high


def _somewhere(run: Run, axis: int, start: Position, end: Position, reach: Range) -> Position:
    """A place between two: an unknown of its own."""
    way = end.minus(start)
    if not way.form and way.value == 0.0:
        return end
    if NOWHERE.form in (start.form, end.form):
        return NOWHERE
    if way.form:
        first, last = run.modal.spread(start), run.modal.spread(end)
        if first is None or last is None or first[0] != last[0]:
            return run.unknown_place("probe", axis, ANY, Position(0.0))
        # Both rest on unknowns that arose earlier, each between its bounds.
        (rest, *one), (_, *other) = first, last
        return run.unknown_place("probe", axis, (min(*one, *other), max(*one, *other)), Position(0.0, rest))
    return run.unknown_place("probe", axis, reach, start)


def _record(run: Run, contact: list[Position], hit: Value) -> None:
    """What #5051 to #5067 show from now on, in machine and in program coordinates."""
    s = run.modal
    s.probed, s.probe_hit = list(contact), hit
    work: list[Value] = []
    places = s.in_program(contact)
    for axis in range(AXES):
        place = places[axis]
        unit = s.scale(axis)
        value = s.plain(place, unit, 5061 + axis)
        if isinstance(value, Unknown):
            ends: Range = (value.low, value.high)
            value = between("the probe contact", ends)
        if isinstance(value, Unknown) and not (axis < 2 and s.transform.on):
            value = at_place(value, axis, contact[axis], s.offset(axis), unit)
        work.append(value)
    s.probed_work = work
