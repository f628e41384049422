"""Moves of controllers of DIN blocks with Pascal inside: G00 to G03 with reflection, factors, cylinders, planes.

APCI-8001 G-code manual 3.1 to 3.4, 3.6 to 3.17, 3.20 to 3.22, 3.32, 3.35, 3.36. G00 uses the axes' own units,
whatever G70 says (3.1), the others in the interpolation unit. A place is zero offset + factor times word.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.dialects.mcuwin.settings import USUAL
from gproof.ir.finding import Refusal, Span
from gproof.ir.machine import AXES, AXIS_NAMES, AxisKind
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.setup import Interval
from gproof.ir.symbolic import NOWHERE, Position, Unknown, Value, not_known
from gproof.ir.symbols import MIRRORED, describe
from gproof.ir.trace import Op, Plane
from gproof.passes.interpret.core import refused_lines
from gproof.passes.interpret.core.line_kernels import ZERO_RADIUS, distance
from gproof.passes.interpret.core.modal_state import ZERO
from gproof.passes.interpret.core.moves import AXES_OF_PLANE
from gproof.passes.interpret.mcuwin.radius_correction import (
    before,
    contour_place,
    follow,
    no_arc,
    note_record,
    tell_for_nothing,
)
from gproof.passes.interpret.mcuwin.state import SAME, din_of, factor, has_tools, own_unit
from gproof.passes.interpret.mcuwin.value_hints import of_value

if TYPE_CHECKING:
    from gproof.passes.interpret.mcuwin.parts import Part
    from gproof.passes.interpret.mcuwin.state import McuWinRun

Handler = Callable[["McuWinRun", "Part", CodeRule], None]

_CENTERS = {Plane.XY: "IJ", Plane.XZ: "IK", Plane.YZ: "JK"}
"""Centre words by plane (DIN 66025), in the order of ``AXES_OF_PLANE``."""
_SECOND = "a second G60, or one after moves (the manual does not say whether it counts, 3.20)"
_G60 = "state g60 under [din] of the machine file: which one counts"


def note_assumptions(run: McuWinRun) -> None:
    """What is taken for granted because neither job nor files say it."""
    s, din = run.modal, din_of(run.machine)
    if "distance" not in s.stated:
        run.assumed["the job starts in absolute distances (G90)"] = None
    if "units" not in s.stated and din.position_unit is None:
        run.assumed["interpolation is in millimetres (3.22)"] = None
    if any(axis.position_unit is None for axis in run.machine.axes):
        run.assumed["axes without a unit in the machine file use millimetres and degrees in G00 (3.1)"] = None
    turns = any(axis.kind is AxisKind.ROTARY for axis in run.machine.axes)
    unused = {"tool_file"} if turns else {"tool_file", "shortest_path"}
    run.assumed.update({USUAL[key]: None for key in din.unstated if key not in unused})
    if any(record.length != 0.0 for record in din.tools or ()):
        note_record(run)
    if run.setup.default_offset is None:
        run.assumed["no mirroring, no effective radius, no spline and no radius correction is on at the start"] = None


def tell_once(run: McuWinRun, name: str) -> bool:
    """True the first time."""
    s = run.modal
    if name in s.own.told:
        return False
    s.own = s.own.but(told=s.own.told | {name})
    return True


# ---- words to places


def unit_of(run: McuWinRun, axis: int, *, own: bool) -> float:
    """mm or degrees in one of a word; own: in the axis's unit. NaN: not known (G51 before another unit)."""
    s = run.modal
    if s.linear[axis]:
        return own_unit(run.machine, axis) if own else s.unit
    radius = dict(s.own.radii).get(axis)
    return own_unit(run.machine, axis) if own or radius is None else math.degrees(s.unit / radius)


def aim(run: McuWinRun, line: Part, *, own: bool) -> list[Position]:
    """Where the axis words send the axes, machine mm or degrees; own: words are in the axes' own units (3.1)."""
    s = run.modal
    words = line.axes()
    if words and s.own.mode_open:
        what = "axis words after G53 in G91 (the manual does not say whether they are absolute until G90 or G91)"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what))
    target = list(s.position)
    for axis, value in words.items():
        by, unit = factor(s, axis), unit_of(run, axis, own=own)
        if math.isnan(by):
            what = f"the factor of {_word(run, axis)} after G24 and before the next G39"
            raise Refusal(codes.TRANSFORM_OPEN.at(line.span, what=what))
        if math.isnan(unit):
            what = f"the effective radius of {_word(run, axis)}, given in another unit"
            raise Refusal(codes.TRANSFORM_OPEN.at(line.span, what=what))
        origin = _zero(run, line, axis, by) if s.absolute else s.position[axis]
        target[axis] = _placed(run, line, axis, value, by * unit, origin)
    return target


def _zero(run: McuWinRun, line: Part, axis: int, by: float) -> Position:
    """Where words of an axis, times ``by``, count from in G90: under a reflection the zero offset or the machine's.

    Both are followed (3.9, 3.26): one unknown, the same for all places under the offset, holds the two.
    """
    offset = run.modal.offset(axis)
    if by == 1.0 or offset == ZERO:
        return offset
    if offset.form:
        what = f"whether {_word(run, axis)} is mirrored about the zero offset or about machine zero"
        raise Refusal(
            codes.TRANSFORM_OPEN.at(line.span, what=what, hint="state the zero offset: then both are followed")
        )
    apart = (by - 1.0) * offset.value
    symbol = f"{MIRRORED}.{repr(apart).replace('.', ',')}.{AXIS_NAMES[axis]}"
    run.trace.symbols[symbol] = Interval(min(0.0, apart), max(0.0, apart))
    return Position(offset.value, ((symbol, 1),))


def _placed(run: McuWinRun, line: Part, axis: int, value: Value, scale: float, origin: Position) -> Position:
    if not isinstance(value, Unknown):
        return Position(value * scale + origin.value, origin.form)
    if not value.bounded:
        word = _word(run, axis)
        run.findings.add(not_known(line.where(word), word, value, of_value(value.cause)))
        return NOWHERE
    if origin == NOWHERE:
        return NOWHERE  # as from a plain number; what it rests on was reported where it came about
    ends = value.low * scale, value.high * scale
    return run.unknown_place("value", axis, (min(ends), max(ends)), origin)


def _word(run: McuWinRun, axis: int) -> str:
    return run.machine.word(axis)


# ---- moves


def move(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """G00 to G03, given or going on."""
    note_assumptions(run)
    if refused_lines.vague(run, line, rule):
        return
    s = run.modal
    words = line.axes()
    arc = rule.function in (F.ARC_CW, F.ARC_CCW)
    for letter in "IJK":
        if letter in line.values and not arc:
            raise Refusal(codes.UNUSED_WORD.at(line.where(letter), word=letter))
    if rule.function is not F.TRAVERSE:
        _interpolated(run, line, rule)
    if not words and not (arc and line.values):
        return
    if run.setup.homed is None:
        run.assumed["every axis has had its reference run"] = None
    target = aim(run, line, own=rule.function is F.TRAVERSE)
    if s.own.side:
        target = follow(run, target)
    elif rule.function is not F.TRAVERSE:
        tell_for_nothing(run, line)
    if rule.function is F.TRAVERSE:
        if target == s.position and tell_way(run, line):
            run.findings.add(codes.NO_WAY.at(Span(line.span.file, line.span.line), code=rule.text))
        s.own = s.own.but(contour=False)
        before(run, Op.TRAVERSE, line, target)
        run.move(Op.TRAVERSE, target, line.span)
    elif arc and s.own.side and s.own.corrected is None:
        # Which circle it is does not matter where it is not known where the tool moves.
        _straight(run, line, rule, target)
    elif arc:
        _arc(run, line, rule, target)
    else:
        _straight(run, line, rule, target)
    run.moved = True


def tell_way(run: McuWinRun, line: Part) -> bool:
    """Whether the way that the line leads is known: an axis whose place is unknown may well move."""
    return all(place != NOWHERE for place in (run.modal.position[axis] for axis in line.axes()))


def _interpolated(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """Refusal GP129 or GP113 for axes that are not in the interpolation (3.20)."""
    din = run.modal.own
    for letter, axis in line.columns.items():
        if letter not in line.values or (axis in din.interpolating and axis not in din.doubtful):
            continue
        if axis in din.doubtful:
            what = f"{letter} in {rule.text} after {_SECOND}"
            raise Refusal(codes.UNSUPPORTED_CODE.at(line.where(letter), code=what, hint=_G60))
        names = " ".join(word for word, column in line.columns.items() if column in din.interpolating)
        what = f"not one of the interpolation axes, {names or 'which are none'} (G60)"
        raise Refusal(codes.ILLEGAL_VALUE.at(line.where(letter), word=letter, what=what))


def _straight(run: McuWinRun, line: Part, rule: CodeRule, target: list[Position]) -> None:
    s = run.modal
    if s.own.spline:
        target = [NOWHERE if axis in line.axes() else place for axis, place in enumerate(target)]
    elif _is_same(s.position, target) and tell_way(run, line):
        run.findings.add(codes.NO_WAY.at(Span(line.span.file, line.span.line), code=rule.text))
    _use_feed(run, line, rule, target)
    s.own = s.own.but(contour=True)
    before(run, Op.FEED, line, target)
    run.move(Op.FEED, target, line.span)


def _is_same(one: list[Position], other: list[Position]) -> bool:
    places = ((contour_place(a), contour_place(b)) for a, b in zip(one, other, strict=True))
    return all(a.form == b.form and abs(a.value - b.value) < SAME for a, b in places)


def _use_feed(run: McuWinRun, line: Part, rule: CodeRule, target: list[Position]) -> None:
    """The feed of this move, in the unit of its row."""
    s = run.modal
    din = s.own
    s.feed_unit = 1.0
    if din.asked:
        hint = (
            f"program F again: {din.asked} came after the last F, and the manual does not say whether its number "
            "or its speed is kept"
        )
        raise Refusal(codes.FEED_MISSING.at(line.span, code=rule.text, hint=hint))
    if din.feed == 0.0:
        raise Refusal(codes.VELOCITY_ZERO.at(line.span, code=rule.text, hint="program an F above 0 before"))
    s.feed = din.feed
    cause = din.feed_cause if math.isnan(din.feed) else ""
    if din.constant_speed:
        s.feed, cause = math.nan, "G96, constant cutting speed"
    turning = [axis for axis in range(AXES) if not s.linear[axis] and target[axis] != s.position[axis]]
    if turning and not cause:
        s.feed, cause = _with_rotary(run, target, turning)
    if cause and tell_once(run, f"feed {cause}"):
        hint = next((hint for words, hint in _FEED_HINTS if words in cause), "")
        run.findings.add(codes.FEED_UNKNOWN.at(line.span, code=rule.text, cause=cause, hint=hint))


_FEED_HINTS = (
    ("initial feed", "program F on this line or before it"),
    (
        "per minute or per second",
        'state time_unit = "min" or "s" under [din] of the machine file, or program G94 before F',
    ),
    ("G96", "program G97 before"),
    ("effective radius", "program G51 with a radius for the axis before"),
)
"""By words of the cause of a feed that is not known, what helps."""


def _with_rotary(run: McuWinRun, target: list[Position], turning: list[int]) -> tuple[float, str]:
    """The feed of a row whose rotary axes turn, and why it is not known: along a cylinder (3.17) the path counts."""
    s = run.modal
    radii = dict(s.own.radii)
    ways = [target[axis].minus(s.position[axis]) for axis in range(AXES)]
    if any(axis not in radii for axis in turning) or any(way.form for way in ways):
        return math.nan, "how F counts while a rotary axis without an effective radius (G51) turns"
    turned = math.sqrt(sum((math.radians(ways[axis].value) * radii[axis]) ** 2 for axis in turning))
    angle = math.sqrt(sum(ways[axis].value ** 2 for axis in turning))
    linear = math.sqrt(sum(way.value**2 for way in ways[:3]))
    whole = math.hypot(linear, turned)
    return s.own.feed * (linear if linear > 0.0 else angle) / whole, ""


# ---- arcs


def _arc(run: McuWinRun, line: Part, rule: CodeRule, target: list[Position]) -> None:
    """G02 and G03: DIN's centre words of the plane; the third axis moves along evenly."""
    s = run.modal
    din = s.own
    if din.plane_open:
        tools = "no tool table is loaded" if has_tools(run.machine) is False else "the machine file names no tool table"
        cause = f"the plane: {tools}, and the manual does not say what G18 or G19 do without one (2.7)"
        raise Refusal(codes.ARC_UNKNOWN.at(line.span, cause=cause, hint="program G17 before"))
    first, second, third = AXES_OF_PLANE[s.plane]
    for axis in line.axes():
        if axis > 2:
            word = _word(run, axis)
            raise Refusal(codes.UNSUPPORTED_CODE.at(line.where(word), code=f"{word} together with an arc"))
    for letter, axis in line.columns.items():
        if axis in (first, second) and axis not in din.interpolating:
            what = "an arc uses it, and it is not one of the interpolation axes (G60)"
            raise Refusal(codes.ILLEGAL_VALUE.at(line.span, word=letter, what=what))
        if axis in (first, second) and axis in din.doubtful:
            what = f"an arc with {letter} after {_SECOND}"
            raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what, hint=_G60))
    letters = _CENTERS[s.plane]
    for letter in "IJK":
        if letter in line.values and letter not in letters:
            raise Refusal(codes.UNUSED_WORD.at(line.where(letter), word=f"{letter} (out of the arc's plane)"))
    factors = factor(s, first), factor(s, second)
    if math.isnan(factors[0]) or math.isnan(factors[1]):
        raise Refusal(codes.TRANSFORM_OPEN.at(line.span, what="factors after G24 and before the next G39"))
    if abs(abs(factors[0]) - abs(factors[1])) > SAME:
        names = f"{_word(run, first)} and {_word(run, second)}"
        raise Refusal(codes.ARC_SCALED.at(line.span, axes=f"{names} unequally", code="G39"))
    no_arc(run, line)
    start = contour_place(s.position[first]), contour_place(s.position[second])
    end = contour_place(target[first]), contour_place(target[second])
    for a, b, axis in zip(start, end, (first, second), strict=True):
        difference = b.minus(a)
        if difference.form:
            raise Refusal(codes.ARC_UNKNOWN.at(line.span, cause=f"{_word(run, axis)}: {describe(difference.form)}"))
    center = _center(run, line, rule, (first, second), start, factors)
    turns = 1 if rule.function is F.ARC_CCW else -1
    if factors[0] * factors[1] < 0:
        turns = -turns
    at_start = distance(center[0] - start[0].value, center[1] - start[1].value)
    at_end = distance(center[0] - end[0].value, center[1] - end[1].value)
    if at_start < ZERO_RADIUS:
        raise Refusal(codes.ARC_RADIUS_ZERO.at(line.span))
    if abs(at_end - at_start) > s.arc_tolerance() + SAME:
        finding = codes.ARC_RADIUS_MISMATCH.at(
            line.span, start=at_start, end=at_end, off=abs(at_end - at_start), allowed=s.arc_tolerance(), unit="mm"
        )
        if s.own.side or s.own.spline:
            raise Refusal(finding)
        # As ``din_plain.taken`` does: the row stays, and ``arcs`` tells it of its row.
        run.fail(finding, told=True)
    if all(abs(a.value - b.value) < 1e-6 for a, b in zip(start, end, strict=True)):
        target[first], target[second] = start
    whole = [p.value for p in s.position[:3]]
    whole[first], whole[second] = center
    if s.own.spline:
        for axis in (first, second, third):
            target[axis] = NOWHERE if axis in (first, second) or axis in line.axes() else target[axis]
        _use_feed(run, line, rule, target)
        run.move(Op.FEED, target, line.span)
        return
    _use_feed(run, line, rule, target)
    s.own = s.own.but(contour=True)
    before(run, Op.ARC, line, target, whole, turns)
    run.move(Op.ARC, target, line.span, center=whole, turns=turns, plane=s.plane)


def _center(
    run: McuWinRun, line: Part, rule: CodeRule, axes: tuple[int, int], start: tuple[Position, Position],
    factors: tuple[float, float],
) -> list[float]:  # fmt: skip
    """Machine place of the centre in the plane; Refusal GP203 or GP405."""
    s = run.modal
    letters = _CENTERS[s.plane]
    given = [line.number(letter) for letter in letters]
    if given == [None, None]:
        raise Refusal(codes.ARC_CENTER_MISSING.at(line.span, code=rule.text, needed=" and ".join(letters)))
    kept = s.own.center
    values: list[float] = []
    for n, value in enumerate(given):
        if value is None:
            if kept is None:
                run.assumed["a missing centre word counts as 0"] = None
            elif kept[n] != 0.0:
                cause = f"{letters[n]} missing: the value of the arc before, or 0"
                raise Refusal(codes.ARC_UNKNOWN.at(line.span, cause=cause))
            value = 0.0
        values.append(value * s.unit)
    s.own = s.own.but(center=(values[0], values[1]))
    relative = [at.value + by * value for at, by, value in zip(start, factors, values, strict=True)]
    if not s.absolute or s.own.centers_absolute is False:
        return relative
    if None in given:
        raise Refusal(codes.ARC_UNKNOWN.at(line.span, cause="a missing centre word with absolute centres on"))
    places = []
    for axis, by, value, at in zip(axes, factors, values, start, strict=True):
        origin = _zero(run, line, axis, by)
        if origin.form != contour_place(at).form:
            raise Refusal(codes.ARC_UNKNOWN.at(line.span, cause=describe(origin.minus(at).form)))
        places.append(origin.value + by * value)
    if s.own.centers_absolute is None and any(abs(a - b) > SAME for a, b in zip(places, relative, strict=True)):
        cause = (
            "whether arc centres are absolute or incremental in G90: the IniCfg option is not in the machine "
            "file (3.3, 3.35)"
        )
        raise Refusal(
            codes.ARC_UNKNOWN.at(
                line.span, cause=cause, hint="program G161 before for absolute centres, G162 for incremental ones"
            )
        )
    return places
