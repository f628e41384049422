"""Where words send the axes, and what a move takes for granted. Eding CNC manual 3.4.1 to 3.4.3, 3.4.13, 3.4.24."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.finding import Refusal
from gproof.ir.machine import AXES
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import NOWHERE, ORIGIN, Position, Unknown, Value, bounds, scaled
from gproof.ir.symbols import UNIFORM
from gproof.ir.trace import Plane
from gproof.passes.interpret.core.parsed_line import Line
from gproof.passes.interpret.eding.cycle_motions import CYCLES
from gproof.passes.interpret.eding.spindle import note_speed_unknown
from gproof.passes.interpret.eding.transform_codes import note_reading, settle

if TYPE_CHECKING:
    from gproof.passes.interpret.core.run import Run

X_OFFSET = "X offset of a tool (G43)"
_LEFT = (
    {"rotation": "rotation (G68)", "scaling": "scaling (G51)"},
    {"side": "cutter compensation (G41)", "length": X_OFFSET},
)
"""What the job before may have left on, by the name under which ``Modal.stated`` holds that this job says it."""


def aim(run: Run, line: Line, words: dict[int, Value] | None = None, *, machine: bool = False) -> list[Position]:
    """Where axis words (those of the line) send the axes, in machine coordinates; machine: the words are such.

    The words of a line go together: under a rotation each of X and Y moves both axes.
    """
    s = run.modal
    words = line.axes() if words is None else words
    target = [s.programmed(axis) for axis in range(AXES)]
    for axis, value in words.items():
        if not machine:
            target[axis] = place_of(run, axis, value)
        elif isinstance(value, Unknown):
            target[axis] = named_place(run, axis, value, ORIGIN) or bounded(run, axis, value, ORIGIN)
        else:
            target[axis] = Position(value * s.scale(axis))
    if not machine and s.transform.on and (0 in words or 1 in words):
        settle(run, line.span)
        target[0], target[1] = _transformed(run, words.get(0), words.get(1))
    return target


def place_of(run: Run, axis: int, value: Value) -> Position:
    """Where the word of one axis sends it; of X and Y nobody can say it for one alone while G68 or G51 is on."""
    s = run.modal
    if axis < 2 and s.transform.on:
        return NOWHERE
    if s.transform.uniform != 1.0 and value != 0.0:
        if axis in s.transform.loose:
            return _either_scaled(run, axis, value)
        if axis == 2:
            note_reading(run)
            value = scaled(value, s.transform.upright)
    if isinstance(value, Unknown):
        named = named_place(run, axis, value, s.offset(axis)) if s.absolute else None
        return named or bounded(run, axis, value, None)
    origin = s.offset(axis) if s.absolute else s.programmed(axis)
    return Position(value * s.scale(axis) + origin.value, origin.form)


def _either_scaled(run: Run, axis: int, value: Value) -> Position:
    """By both readings of ``G51 P``: not scaled, which is the number of the row, or about the program's zero."""
    s = run.modal
    factor = s.transform.uniform
    if not isinstance(value, Unknown) and math.isfinite(factor):
        origin = s.offset(axis) if s.absolute else s.programmed(axis)
        plain, more = value * s.scale(axis), value * s.scale(axis) * (factor - 1.0)
        at = Position(plain + origin.value, origin.form)
        return run.unknown_place(UNIFORM, axis, (min(0.0, more), max(0.0, more)), at)
    ends = [end * by for end in bounds(value) for by in (1.0, factor)]
    if not all(map(math.isfinite, ends)):
        return NOWHERE
    return bounded(run, axis, Unknown(f"{run.machine.word(axis)} under G51 P", min(ends), max(ends)), None)


def named_place(run: Run, axis: int, value: Unknown, origin: Position) -> Position | None:
    """The place whose coordinate from an origin a value is, whatever number that is: ``Z#5063`` after a probe."""
    place = value.place
    if place is None or place.axis != axis or place.scale != run.modal.scale(axis) or place.origin != origin:
        return None
    return place.at


def bounded(run: Run, axis: int, value: Unknown, origin: Position | None) -> Position:
    """A place that is only bounded, from ``origin`` or from where the axis words count."""
    if not value.bounded:
        return NOWHERE
    s = run.modal
    if origin is None:
        origin = s.offset(axis) if s.absolute else s.programmed(axis)
    scale = s.scale(axis)
    return run.unknown_place("value", axis, (value.low * scale, value.high * scale), origin)


def _transformed(run: Run, x: Value | None, y: Value | None) -> tuple[Position, Position]:
    """Where X and Y words send their axes under G68 and G51."""
    s = run.modal
    words = (
        x if x is None or isinstance(x, Unknown) else x * s.scale(0),
        y if y is None or isinstance(y, Unknown) else y * s.scale(1),
    )
    at = s.programmed(0), s.programmed(1)
    if s.absolute:
        return s.transform.absolute(words, at, (s.offset(0), s.offset(1)))
    return s.transform.incremental(words, at)


def note_assumptions(run: Run, line: Line, rule: CodeRule) -> None:
    """What the first moves take as given because the job has not said it."""
    stated = run.modal.stated
    if "units" not in stated:
        run.assumed["the job starts in millimetres (G21)"] = None
    if run.machine.controller.diameter_programming:
        run.assumed["every X number is a diameter, in G10, G53 and G92 and in #5001 and #5071 as well"] = None
    # The zeroing menu can leave a rotation (2.2.4.3), the job before whatever it did not end: M2 ends nothing, M30
    # compensation (3.5.1). The zero setup says that there is nothing of that kind.
    if run.modal.setup.default_offset is None:
        for names in _LEFT:
            wanted = (text for key, text in names.items() if key not in stated)
            left = [text for text in wanted if text != X_OFFSET or _x_offsets(run)]
            if left:
                run.assumed[f"no {' and no '.join(left)} is active at the start"] = None
        if "path" not in stated and _beside_bodies(run):
            run.assumed["no corner rounding (G64 P) and no joining of lines (Q) is active at the start"] = None
    if "distance" not in stated:
        run.assumed["the job starts in absolute distances (G90)"] = None
    if "plane" not in stated and rule.group == "G1" and rule.function not in (F.TRAVERSE, F.FEED):
        plane = "XZ plane (G18)" if run.modal.plane is Plane.XZ else "XY plane (G17)"
        run.assumed[f"the job starts in the {plane}"] = None
    if "retract" not in stated and rule.function in CYCLES:
        run.assumed["the job starts with return to the initial level in cycles (G98)"] = None
    if "head" not in stated and _heads_apart(run) and run.modal.setup.default_offset is None:
        run.assumed["the job starts with the first spindle (M90)"] = None


def _beside_bodies(run: Run) -> bool:
    """True where something is stated that the tool must keep clear of, whatever the controller does at corners."""
    return bool(run.machine.keep_out or run.setup.keep_out or run.setup.workpiece is not None)


def _x_offsets(run: Run) -> bool:
    """True on machines whose tools have offsets in X (3.4.12: for turning)."""
    return run.machine.controller.turning or any(tool.x_offset for tool in run.machine.tools)


def _heads_apart(run: Run) -> bool:
    """True where it matters for positions which spindle is selected, and the setup does not say it (3.5.2)."""
    setup = run.modal.setup
    others = [spindle for spindle in run.machine.spindles if spindle.number]
    apart = bool(setup.heads) or any(offset != 0.0 for spindle in others for offset in spindle.offset)
    return apart and 5390 not in setup.parameters


def need_feed(run: Run, line: Line, rule: CodeRule) -> None:
    """Refusal GP204 or GP205 when a feed move has no feed rate."""
    s = run.modal
    if s.feed_mode == 93 and "F" not in line.values:
        raise Refusal(codes.INVERSE_TIME_FEED_MISSING.at(line.span))
    if s.feed == 0.0:
        raise Refusal(codes.FEED_MISSING.at(line.span, code=rule.text))
    if s.feed_mode == 95 and s.spindle_direction == 0:
        hint = "program S and start the spindle before"
        run.findings.add(codes.SPINDLE_UNKNOWN.at(line.span, code="G95", hint=hint))
    elif s.feed_mode == 95:
        note_speed_unknown(run, line, "G95")
