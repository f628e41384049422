"""What G68, G69, G50 and G51 do to the state, and what may not be done while they are in force.

Eding CNC manual 3.4.13, 3.4.18 and table 3-3. What the manual leaves open is GP276: X and Y are then not known until
the rotation or the scaling is switched off. docs/dialects/eding.md lists the questions.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.dialects.accepts import READINGS_OF_Z, SCALED_Z, UNSCALED_Z
from gproof.ir.finding import Refusal, Span
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import Unknown
from gproof.ir.trace import Plane
from gproof.passes.interpret.core.parsed_line import Line
from gproof.passes.interpret.core.plane_transform import NO_TRANSFORM, Pair, Transform, is_tall

if TYPE_CHECKING:
    from gproof.passes.interpret.core.modal_state import Modal
    from gproof.passes.interpret.core.run import Run

_SETS = (F.ROTATION_ON, F.SCALING_ON)
_CANCELS = (F.ROTATION_OFF, F.SCALING_OFF)
_STATES = {F.ROTATION_OFF: "rotation", F.SCALING_OFF: "scaling"}
_LENGTHS_ALONG = (F.DRILL_PECK, F.DRILL_CHIP_BREAK, F.BORE_BACK)
"""Cycles with lengths along Z that are no places."""
_BESIDE = frozenset((
    F.ROTATION_ON, F.ROTATION_OFF, F.SCALING_ON, F.SCALING_OFF, F.PLANE_XY, F.PLANE_XZ, F.PLANE_YZ, F.UNITS_INCH,
    F.UNITS_MM, F.COMPENSATION_OFF, F.TOOL_OFFSET_OFF, F.SELECT_COORDINATES, F.ABSOLUTE, F.INCREMENTAL, F.MOTION_CANCEL,
    F.FEED_INVERSE_TIME, F.FEED_PER_MINUTE, F.FEED_PER_REVOLUTION, F.RETRACT_INITIAL, F.RETRACT_R, F.SPINDLE_CW,
    F.SPINDLE_CCW, F.SPINDLE_OFF, F.MIST_ON, F.FLOOD_ON, F.COOLANT_OFF, F.STOP, F.OPTIONAL_STOP, F.END, F.END_RESET,
))  # fmt: skip
"""Functions without words of their own; of any other code on the line P, R, I or J could be meant for it."""


def run_transform(run: Run, line: Line, before: tuple[object, ...]) -> None:
    """Execute the codes of this family on a line; before: what ``frame_of`` returned before its settings."""
    for rule in line.rules:
        if rule.function in _STATES:
            run.modal.stated.add(_STATES[rule.function])
        if rule.function in _CANCELS:
            _cancel(run, line, rule)
    setter = line.find(*_SETS)
    side = line.find(F.COMPENSATION_LEFT, F.COMPENSATION_RIGHT)
    if side is not None and run.modal.transform.factors != (1.0, 1.0):
        what = f"{side.text} while G51 is on: whether the tool's radius is scaled"
        run.fail(codes.TRANSFORM_OPEN.at(line.where_code(side), what=what))
    if setter is not None:
        _set(run, line, setter, before)


def _set(run: Run, line: Line, rule: CodeRule, before: tuple[object, ...]) -> None:
    made = _rotation(run, line, rule) if rule.function is F.ROTATION_ON else _scaling(run, line, rule)
    made = replace(made, origin=(run.modal.offset(0), run.modal.offset(1)))
    why = made.open or _doubts(run, line, rule, before)
    run.modal.transform = replace(made, open=why)
    run.state_changed()
    if why:
        run.fail(codes.TRANSFORM_OPEN.at(line.span, what=why))


def frame_of(modal: Modal, line: Line) -> tuple[object, ...]:
    """What the point of a transform is given in, offsets and unit; () on lines that give none."""
    if line.find(*_SETS) is None:
        return ()
    return modal.offset(0), modal.offset(1), modal.unit


def _doubts(run: Run, line: Line, rule: CodeRule, before: tuple[object, ...]) -> str:
    """Why the meaning of a complete G68 or G51 is open, "" when it is not."""
    s = run.modal
    if run.machine.controller.diameter_programming:
        return f"{rule.text} on a machine with diameter programming"
    if rule.function is F.ROTATION_ON and not s.absolute:
        return f"{rule.text} in incremental distances (G91): its X and Y may be absolute or incremental"
    if before != frame_of(s, line):
        return f"{rule.text} together with a change of units or coordinate system"
    if s.compensation is not None:
        return f"{rule.text} while cutter radius compensation is on"
    other = next((code for code in line.rules if code.function not in _BESIDE), None)
    if other is not None:
        return f"{rule.text} together with {other.text}: which code each word belongs to"
    return ""


def _cancel(run: Run, line: Line, rule: CodeRule) -> None:
    s = run.modal
    now = s.transform
    if now.on and not now.open and (0 in line.axes() or 1 in line.axes()) and line.find(*_SETS) is None:
        why = f"whether the words X and Y next to {rule.text} still follow the code that it ends"
        s.transform = replace(now, open=why)
        run.fail(codes.TRANSFORM_OPEN.at(line.span, what=why))
        return
    if now.on and s.compensation is not None:
        what = f"{rule.text} while cutter radius compensation is on"
        run.fail(codes.TRANSFORM_OPEN.at(line.where_code(rule), what=what))
    if rule.function is F.ROTATION_OFF:
        now = replace(now, rotated=False, angle=0.0)
    else:
        now = replace(now, scaled=False, factors=(1.0, 1.0), uniform=1.0, tall=None)
    s.transform = now if now.rotated or now.scaled else NO_TRANSFORM
    run.state_changed()


def _rotation(run: Run, line: Line, rule: CodeRule) -> Transform:
    """G68 R X Y (3.4.18)."""
    now = run.modal.transform
    _only_xy(line)
    if "R" not in line.values:
        raise Refusal(codes.WORD_MISSING.at(line.where_code(rule), code=rule.text, needed="its angle in R"))
    made = replace(now, rotated=True)
    values = _values(line, "RXY")
    if values is None:
        return replace(made, open=f"{rule.text} with an unknown number")
    angle, x, y = values
    if angle is None or ((x is None or y is None) and not (now.scaled and x is None and y is None)):
        return replace(made, open=f"{rule.text} without the point X Y to rotate about")
    point = None if x is None or y is None else (x * run.modal.unit, y * run.modal.unit)
    return _about(run, replace(made, angle=math.fmod(angle, 360.0)), rule, point, now.rotated)


def _scaling(run: Run, line: Line, rule: CodeRule) -> Transform:
    """G51 P I J, or G51 X Y I J (3.4.13)."""
    now = run.modal.transform
    _only_xy(line)
    uniform = math.nan if "P" in line.values else 1.0
    made = replace(now, scaled=True, uniform=uniform, tall=is_tall(run.machine))
    values = _values(line, "PXYIJ")
    if values is None:
        return replace(made, open=f"{rule.text} with an unknown number")
    p, x, y, i, j = values
    if p is not None and not (x is None and y is None):
        return replace(made, open=f"{rule.text} with both P and X Y")
    if p is not None:
        x = y = p
    if x is None or y is None:
        raise Refusal(
            codes.WORD_MISSING.at(line.where_code(rule), code=rule.text, needed="its factor in P, or X and Y")
        )
    if 0.0 in (x, y):
        raise Refusal(codes.SCALING_ZERO.at(line.where_code(rule), code=rule.text))
    if (i is None or j is None) and not (now.rotated and i is None and j is None):
        raise Refusal(codes.WORD_MISSING.at(line.where_code(rule), code=rule.text, needed="its point in I and J"))
    point = None if i is None or j is None else (i * run.modal.unit, j * run.modal.unit)
    return _about(run, replace(made, factors=(x, y), uniform=1.0 if p is None else p), rule, point, now.scaled)


def note_reading(run: Run) -> None:
    """The answer rests on which axes ``G51 P`` scales, where the shop states it."""
    if run.modal.transform.uniform != 1.0 and not run.takes(SCALED_Z):
        run.takes(UNSCALED_Z)


def _about(run: Run, made: Transform, rule: CodeRule, point: Pair | None, again: bool) -> Transform:
    """With its point, which rotation and scaling share ("the same", 3.4.13)."""
    now = run.modal.transform
    if now.open:
        return replace(made, open=now.open)
    if now.rotated or now.scaled:
        if now.origin != (run.modal.offset(0), run.modal.offset(1)):
            return replace(made, open=f"{rule.text} over another one that was programmed under other offsets")
        if point is not None and point != now.center:
            return replace(made, open=f"{rule.text} about another point than the active one")
    if again:
        run.assumed[f"{rule.text} replaces the active one"] = None
    made = made if point is None else replace(made, center=point)
    if made.factors[0] != made.factors[1] and math.fmod(made.angle, 180.0) != 0.0:
        return replace(made, open="the order of rotation and scaling by different factors,")
    return made


def _only_xy(line: Line) -> None:
    for axis in line.axes():
        if axis > 1:
            letter = AXIS_NAMES[axis].upper()
            raise Refusal(codes.UNUSED_WORD.at(line.where(letter), word=letter))


def _values(line: Line, letters: str) -> list[float | None] | None:
    """The words of these letters, None for those that are not there; None when one is unknown."""
    line.used.update(letters)
    values = [line.values.get(letter) for letter in letters]
    known = [value for value in values if not isinstance(value, Unknown)]
    return known if len(known) == len(values) else None


def settle(run: Run, span: Span) -> None:
    """Before X or Y move under a transform: GP276 when the offsets are others than those of its point."""
    s = run.modal
    if s.transform.on and not s.transform.open and s.transform.origin != (s.offset(0), s.offset(1)):
        why = s.transform.doubt or "where the point of G68 or G51 is after a change of offsets"
        s.transform = replace(s.transform, open=why)
        run.fail(codes.TRANSFORM_OPEN.at(span, what=why))


def shifts(run: Run, line: Line, rule: CodeRule) -> bool:
    """Whether this line makes the present point, rotated or scaled, have new X or Y numbers: GP276."""
    if not run.modal.transform.on or not (0 in line.axes() or 1 in line.axes()):
        return False
    why = f"which origin {rule.text} sets while G68 or G51 is on"
    run.modal.transform = replace(run.modal.transform, open=why)
    run.fail(codes.TRANSFORM_OPEN.at(line.where_code(rule), what=why))
    return True


def check_arc(run: Run, line: Line) -> float:
    """The factor of an arc's radius; Refusal GP277 or GP405."""
    s = run.modal
    if not s.transform.on or s.transform.open:
        return 1.0
    if s.plane is not Plane.XY:
        raise Refusal(codes.ARC_UNKNOWN.at(line.span, cause="G68 or G51, which act on X and Y, in another plane"))
    x, y = s.transform.factors
    if x != y:
        raise Refusal(codes.ARC_UNEQUAL_SCALING.at(line.span, x=x, y=y))
    return abs(x)


def check_cycle(run: Run, line: Line, rule: CodeRule, drill: int) -> None:
    """Refusal for cycles whose direction is not known: GP276 out of G17, GP113 along a diameter."""
    now = run.modal.transform
    if drill == 2 and 2 in now.loose:
        hint = READINGS_OF_Z
        raise Refusal(
            codes.TRANSFORM_OPEN.at(line.span, what=f"whether G51 P scales the depths of {rule.text}", hint=hint)
        )
    if drill == 2:
        note_reading(run)
        if now.upright < 0.0:
            raise Refusal(codes.TRANSFORM_OPEN.at(line.span, what=f"{rule.text} upside down (G51 P{now.upright:g})"))
        if now.upright != 1.0 and rule.function in _LENGTHS_ALONG:
            what = f"whether G51 P scales the pecks and lifts of {rule.text}"
            raise Refusal(codes.TRANSFORM_OPEN.at(line.span, what=what))
    if run.modal.transform.on and drill != 2:
        raise Refusal(codes.TRANSFORM_OPEN.at(line.span, what=f"{rule.text} in another plane than G17"))
    if drill == 0 and run.machine.controller.diameter_programming:
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=f"{rule.text} along X with diameter programming"))
