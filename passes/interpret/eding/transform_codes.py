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
from gproof.ir.symbolic import NOWHERE, Unknown
from gproof.ir.trace import Plane
from gproof.passes.interpret.core.parsed_line import Line
from gproof.passes.interpret.core.plane_transform import NO_TRANSFORM, Pair, Transform

if TYPE_CHECKING:
    from gproof.ir.machine import Machine
    from gproof.passes.interpret.core.modal_state import Modal
    from gproof.passes.interpret.core.trace_writer import Emitter
    from gproof.passes.interpret.eding.moves import Motion

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


def run_transform(ex: Motion, line: Line, before: tuple[object, ...]) -> None:
    """Execute the codes of this family on a line; before: what ``frame_of`` told in front of its settings."""
    for rule in line.rules:
        if rule.function in _STATES:
            ex.modal.stated.add(_STATES[rule.function])
        if rule.function in _CANCELS:
            _cancel(ex, line, rule)
    setter = line.find(*_SETS)
    side = line.find(F.COMPENSATION_LEFT, F.COMPENSATION_RIGHT)
    if side is not None and ex.modal.transform.factors != (1.0, 1.0):
        what = f"{side.text} while G51 is on: whether the tool's radius is scaled"
        ex._fail(codes.TRANSFORM_OPEN.at(line.where_code(side), what=what))
    if setter is not None:
        _set(ex, line, setter, before)


def _set(ex: Motion, line: Line, rule: CodeRule, before: tuple[object, ...]) -> None:
    made = _rotation(ex, line, rule) if rule.function is F.ROTATION_ON else _scaling(ex, line, rule)
    made = replace(made, origin=(ex.modal.offset(0), ex.modal.offset(1)))
    why = made.open or _doubts(ex, line, rule, before)
    ex.modal.transform = replace(made, open=why)
    ex._state_changed()
    if why:
        ex._fail(codes.TRANSFORM_OPEN.at(line.span, what=why))


def at_start(modal: Modal) -> Transform:
    """What the setup states to be in force when the job begins."""
    stated = modal.setup.transform
    if stated is None:
        return NO_TRANSFORM
    modal.stated |= {"rotation"} if stated.angle is not None else set()
    modal.stated |= {"scaling"} if stated.factor_x is not None else set()
    angle = math.fmod(stated.angle or 0.0, 360.0)
    factors = (stated.factor_x or 1.0, stated.factor_y or 1.0)
    if angle == 0.0 and factors == (1.0, 1.0):
        return NO_TRANSFORM
    origin, doubt = (modal.offset(0), modal.offset(1)), ""
    uniform = factors[0] if factors[0] == factors[1] else 1.0
    if modal.machine.controller.diameter_programming:
        origin, doubt = (NOWHERE, NOWHERE), "what the setup's rotation or scaling makes of diameters"
    return Transform(
        rotated=angle != 0.0, scaled=factors != (1.0, 1.0), angle=angle, factors=factors,
        center=(stated.x, stated.y), origin=origin, doubt=doubt, uniform=uniform,
        # Equal factors may be those of X and Y, which leave Z as it is on every controller.
        tall=_tall(modal.machine) and None,
    )  # fmt: skip


def frame_of(modal: Modal, line: Line) -> tuple[object, ...]:
    """What the point of a transform is given in, offsets and unit; () on lines that give none."""
    if line.find(*_SETS) is None:
        return ()
    return modal.offset(0), modal.offset(1), modal.unit


def _doubts(ex: Motion, line: Line, rule: CodeRule, before: tuple[object, ...]) -> str:
    """Why the meaning of a complete G68 or G51 is open, "" when it is not."""
    s = ex.modal
    if ex.machine.controller.diameter_programming:
        return f"{rule.text} on a machine with diameter programming"
    if rule.function is F.ROTATION_ON and not s.absolute:
        return f"{rule.text} in incremental distances (G91): its X and Y could be either"
    if before != frame_of(s, line):
        return f"{rule.text} beside a change of units or coordinate system"
    if s.compensation is not None:
        return f"{rule.text} while cutter radius compensation is on"
    other = next((code for code in line.rules if code.function not in _BESIDE), None)
    if other is not None:
        return f"{rule.text} beside {other.text}: whose each word is"
    return ""


def _cancel(ex: Motion, line: Line, rule: CodeRule) -> None:
    s = ex.modal
    now = s.transform
    if now.on and not now.open and (0 in line.axes() or 1 in line.axes()) and line.find(*_SETS) is None:
        why = f"whether the words X and Y beside {rule.text} still fall under what it ends"
        s.transform = replace(now, open=why)
        ex._fail(codes.TRANSFORM_OPEN.at(line.span, what=why))
        return
    if now.on and s.compensation is not None:
        what = f"{rule.text} while cutter radius compensation is on"
        ex._fail(codes.TRANSFORM_OPEN.at(line.where_code(rule), what=what))
    if rule.function is F.ROTATION_OFF:
        now = replace(now, rotated=False, angle=0.0)
    else:
        now = replace(now, scaled=False, factors=(1.0, 1.0), uniform=1.0, tall=None)
    s.transform = now if now.rotated or now.scaled else NO_TRANSFORM
    ex._state_changed()


def _rotation(ex: Motion, line: Line, rule: CodeRule) -> Transform:
    """G68 R X Y (3.4.18)."""
    now = ex.modal.transform
    _only_xy(line)
    if "R" not in line.values:
        raise Refusal(codes.WORD_MISSING.at(line.where_code(rule), code=rule.text, needed="its angle in R"))
    made = replace(now, rotated=True)
    values = _values(line, "RXY")
    if values is None:
        return replace(made, open=f"{rule.text} with a number that nobody stated")
    angle, x, y = values
    if angle is None or ((x is None or y is None) and not (now.scaled and x is None and y is None)):
        return replace(made, open=f"{rule.text} without the point X Y to rotate about")
    point = None if x is None or y is None else (x * ex.modal.unit, y * ex.modal.unit)
    return _about(ex, replace(made, angle=math.fmod(angle, 360.0)), rule, point, now.rotated)


def _scaling(ex: Motion, line: Line, rule: CodeRule) -> Transform:
    """G51 P I J, or G51 X Y I J (3.4.13)."""
    now = ex.modal.transform
    _only_xy(line)
    uniform = math.nan if "P" in line.values else 1.0
    made = replace(now, scaled=True, uniform=uniform, tall=_tall(ex.machine))
    values = _values(line, "PXYIJ")
    if values is None:
        return replace(made, open=f"{rule.text} with a number that nobody stated")
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
    point = None if i is None or j is None else (i * ex.modal.unit, j * ex.modal.unit)
    return _about(ex, replace(made, factors=(x, y), uniform=1.0 if p is None else p), rule, point, now.scaled)


def _tall(machine: Machine) -> bool | None:
    """Whether ``G51 P`` scales Z, as the shop states it; None: nobody did."""
    accepts = machine.controller.accepts
    return True if SCALED_Z.name in accepts else False if UNSCALED_Z.name in accepts else None


def note_reading(ex: Emitter) -> None:
    """The answer rests on which axes ``G51 P`` scales, where the shop states it."""
    if ex.modal.transform.uniform != 1.0 and not ex.takes(SCALED_Z):
        ex.takes(UNSCALED_Z)


def noted(ex: Emitter) -> bool:
    """Whether Z is as it is written, and nothing has to be said of that any more."""
    now = ex.modal.transform
    return now.uniform == 1.0 or (now.tall is False and UNSCALED_Z.assumption in ex.assumed)


def _about(ex: Motion, made: Transform, rule: CodeRule, point: Pair | None, again: bool) -> Transform:
    """With its point, which rotation and scaling share ("the same", 3.4.13)."""
    now = ex.modal.transform
    if now.open:
        return replace(made, open=now.open)
    if now.rotated or now.scaled:
        if now.origin != (ex.modal.offset(0), ex.modal.offset(1)):
            return replace(made, open=f"{rule.text} over another that was given under other offsets")
        if point is not None and point != now.center:
            return replace(made, open=f"{rule.text} about another point than the one in force")
    if again:
        ex.assumed[f"{rule.text} replaces the one that is in force"] = None
    made = made if point is None else replace(made, center=point)
    if made.factors[0] != made.factors[1] and math.fmod(made.angle, 180.0) != 0.0:
        return replace(made, open="which comes first, rotation or scaling by different factors,")
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


def settle(ex: Motion, span: Span) -> None:
    """Before X or Y move under a transform: GP276 when the offsets are others than those of its point."""
    s = ex.modal
    if s.transform.on and not s.transform.open and s.transform.origin != (s.offset(0), s.offset(1)):
        why = s.transform.doubt or "where the point of G68 or G51 is after the offsets have changed"
        s.transform = replace(s.transform, open=why)
        ex._fail(codes.TRANSFORM_OPEN.at(span, what=why))


def shifts(ex: Motion, line: Line, rule: CodeRule) -> bool:
    """Whether this line makes the present point, rotated or scaled, have new X or Y numbers: GP276."""
    if not ex.modal.transform.on or not (0 in line.axes() or 1 in line.axes()):
        return False
    why = f"which origin {rule.text} sets while G68 or G51 is on"
    ex.modal.transform = replace(ex.modal.transform, open=why)
    ex._fail(codes.TRANSFORM_OPEN.at(line.where_code(rule), what=why))
    return True


def check_arc(ex: Motion, line: Line) -> float:
    """The factor of an arc's radius; Refusal GP277 or GP405."""
    s = ex.modal
    if not s.transform.on or s.transform.open:
        return 1.0
    if s.plane is not Plane.XY:
        raise Refusal(codes.ARC_UNKNOWN.at(line.span, cause="G68 or G51, which act on X and Y, in another plane"))
    x, y = s.transform.factors
    if x != y:
        raise Refusal(codes.ARC_UNEQUAL_SCALING.at(line.span, x=x, y=y))
    return abs(x)


def check_cycle(ex: Motion, line: Line, rule: CodeRule, drill: int) -> None:
    """Refusal for cycles whose direction is not known: GP276 out of G17, GP113 along a diameter."""
    now = ex.modal.transform
    if drill == 2 and 2 in now.loose:
        hint = READINGS_OF_Z
        raise Refusal(
            codes.TRANSFORM_OPEN.at(line.span, what=f"whether G51 P scales the depths of {rule.text}", hint=hint)
        )
    if drill == 2:
        note_reading(ex)
        if now.upright < 0.0:
            raise Refusal(codes.TRANSFORM_OPEN.at(line.span, what=f"{rule.text} upside down (G51 P{now.upright:g})"))
        if now.upright != 1.0 and rule.function in _LENGTHS_ALONG:
            what = f"whether G51 P scales the pecks and lifts of {rule.text}"
            raise Refusal(codes.TRANSFORM_OPEN.at(line.span, what=what))
    if ex.modal.transform.on and drill != 2:
        raise Refusal(codes.TRANSFORM_OPEN.at(line.span, what=f"{rule.text} in another plane than G17"))
    if drill == 0 and ex.machine.controller.diameter_programming:
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=f"{rule.text} along X with diameter programming"))
