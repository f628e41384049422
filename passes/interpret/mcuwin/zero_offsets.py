"""Zero offsets and software limits of controllers of DIN blocks with Pascal inside.

APCI-8001 G-code manual 3.18 (G53), 3.19 (G54 to G58), 3.26 (G92), 3.29 (G98), 3.30 (G99), 3.33 (G153), 3.34 (G154).
The offset that is in force is ``Modal.g92``; these codes end a contour of spooled moves, and move nothing.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.dialects.mcuwin.rules import OFFSETS_AT
from gproof.ir.dialects.mcuwin.settings import VERSIONS
from gproof.ir.finding import Refusal
from gproof.ir.machine import AXES, AXIS_NAMES, Axis
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import NOBODY, NOWHERE, ORIGIN, Position, Unknown, Value, bounds, not_known
from gproof.ir.symbols import describe
from gproof.ir.trace import Boundary, Op
from gproof.passes.interpret.core.modal_state import ZERO
from gproof.passes.interpret.mcuwin.moves import Handler, note_assumptions
from gproof.passes.interpret.mcuwin.state import SAME, din_of, own_unit

if TYPE_CHECKING:
    from collections.abc import Iterator

    from gproof.passes.interpret.mcuwin.parts import Part
    from gproof.passes.interpret.mcuwin.state import McuWinRun

FROM_WHERE = "program G53 before it: the manual does not say whether it counts from the zero offset (3.29)"


def end_contour(run: McuWinRun, line: Part, code: str) -> bool:
    """GP513 where moves come before that could have been joined with those after; whether that is so."""
    s = run.modal
    broke = s.own.contour
    if broke:
        run.findings.add(codes.CONTOUR_BREAK.at(line.span, code=code))
    s.own = s.own.but(contour=False)
    return broke


def _changed(run: McuWinRun, line: Part, code: str, record: int) -> None:
    """Reported in the Trace; 1 after the number: the axes rest for it."""
    broke = end_contour(run, line, code)
    run.state_changed()
    run.event(Op.OFFSET, line.span, arg=(float(record), float(broke)))


def _no_correction(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    if run.modal.own.side:
        what = f"{rule.text} while the tool radius is corrected"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.code_span(), code=what))


def _interpolating(run: McuWinRun) -> frozenset[int]:
    """Columns whose offsets G53 to G58 set (3.18, 3.19); of doubtful ones the offset is then not known."""
    din = run.modal.own
    if not din.programmed_axes and din_of(run.machine).interpolation_axes is None:
        run.assumed["every axis of the machine is an interpolation axis (3.20)"] = None
    return din.interpolating


def _set(run: McuWinRun, axis: int, place: Position) -> None:
    s = run.modal
    s.g92[axis] = place if axis not in s.own.doubtful or s.g92[axis] == place else NOWHERE


def offset_off(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """G53: no offset of the interpolation axes; as G92 does it in G90 (3.18), so that G91 may be over too."""
    _no_correction(run, line, rule)
    s = run.modal
    for axis in _interpolating(run):
        _set(run, axis, ZERO)
    if not s.absolute:
        s.own = s.own.but(mode_open=True)
    s.stated.add("work")
    _changed(run, line, rule.text, 0)


def offset_record(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """G54 to G58: the offsets of a record of the table, for the interpolation axes, in V 2.5.3.32 for all (4.19)."""
    _no_correction(run, line, rule)
    s = run.modal
    if din_of(run.machine).version == VERSIONS[1]:
        for each in run.machine.axes:
            s.g92[each.index] = s.work_offsets[rule.value, each.index]
    else:
        for axis in _interpolating(run):
            _set(run, axis, s.work_offsets[rule.value, axis])
    s.stated.add("work")
    _changed(run, line, rule.text, rule.value)


def _in_doubt(run: McuWinRun, axis: int) -> bool:
    """Whether a number of an axis is in the axis's unit or in that of interpolation, and these differ (3.26, 3.29)."""
    s = run.modal
    return s.unit != own_unit(run.machine, axis) if s.linear[axis] else axis in dict(s.own.radii)


def zero_offset(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """G92: the offsets of the named axes: from machine zero in G90, from the offset in force in G91."""
    _no_correction(run, line, rule)
    s = run.modal
    words = line.axes()
    note_assumptions(run)
    if not words:
        raise Refusal(codes.G92_AXIS_MISSING.at(line.code_span()))
    open_axes = []
    for axis, value in words.items():
        place = _number(run, line, axis, value)
        moved = place if s.absolute else s.g92[axis].plus(place)
        if s.own.mode_open and s.g92[axis] != ZERO:
            moved = NOWHERE
        if value != 0.0 and (_in_doubt(run, axis) or axis in s.own.reflected):
            open_axes.append(run.machine.word(axis))
            moved = NOWHERE
        s.g92[axis] = moved
    _changed(run, line, rule.text, 0)
    if open_axes:
        what = f"in which unit or direction {rule.text} counts {' '.join(open_axes)} under G70, G51 or mirroring"
        raise Refusal(codes.TRANSFORM_OPEN.at(line.span, what=what))


def _number(run: McuWinRun, line: Part, axis: int, value: Value) -> Position:
    scale = own_unit(run.machine, axis)
    if not isinstance(value, Unknown):
        return Position(value * scale)
    word = run.machine.word(axis)
    if not value.bounded:
        run.findings.add(not_known(line.where(word), word, value))
        return NOWHERE
    return run.unknown_place("value", axis, (value.low * scale, value.high * scale), ZERO)


def _number_open(run: McuWinRun, axis: int) -> bool:
    """Whether it is open in which unit CD50 and on hold an offset: that of IniCfg, of G70 or along G51 (3.33)."""
    s = run.modal
    if s.linear[axis]:
        return s.unit != (din_of(run.machine).position_unit or 1.0)
    return axis in dict(s.own.radii) or own_unit(run.machine, axis) != 1.0


def read_offset(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """G153: the offsets of all axes into CD 50 and on, in interpolation units."""
    s = run.modal
    told: list[tuple[Value, Position]] = []
    for number, axis in enumerate(run.machine.axes):
        place = s.g92[axis.index]
        value: Value = s.plain(place, s.unit if s.linear[axis.index] else 1.0, OFFSETS_AT + number)
        if isinstance(value, Unknown):
            value = Unknown(f"the zero offset of {axis.word}", value.low, value.high)
        elif place != ZERO and _number_open(run, axis.index):
            value = Unknown(f"the unit of {axis.word}'s zero offset in CD{OFFSETS_AT + number}")
        s.parameters[OFFSETS_AT + number] = value
        told.append((value, place))
    s.own = s.own.but(told=s.own.told | {"offsets read"}, stored=tuple(told))


def restore_offset(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """G154: the offsets of all axes from CD 50 and on, as G153 has left them or as the job has set them."""
    _no_correction(run, line, rule)
    s = run.modal
    stored = s.own.stored
    for number, axis in enumerate(run.machine.axes):
        value = s.parameters.get(OFFSETS_AT + number)
        if value is None:
            s.g92[axis.index] = NOWHERE
            run.findings.add(codes.UNKNOWN_VALUE.at(
                line.span, word=f"the zero offset of {axis.word}", cause=f"CD{OFFSETS_AT + number}",
                why=NOBODY))  # fmt: skip
        elif isinstance(value, Unknown):
            # The very value that the last G153 left there, not one of the same description.
            same = stored is not None and value is stored[number][0]
            s.g92[axis.index] = stored[number][1] if same and stored is not None else NOWHERE
        elif value != 0.0 and _number_open(run, axis.index):
            s.g92[axis.index] = NOWHERE
            cause = f"the unit in which CD{OFFSETS_AT + number} counts"
            run.findings.add(
                codes.UNKNOWN_VALUE.at(line.span, word=f"the zero offset of {axis.word}", cause=cause, why=NOBODY)
            )
        else:
            s.g92[axis.index] = Position(value * (s.unit if s.linear[axis.index] else 1.0))
    _changed(run, line, rule.text, 0)


def limit(run: McuWinRun, line: Part, rule: CodeRule) -> None:
    """G98, G99: software limits of the named axes on the left and on the right, machine coordinates."""
    s = run.modal
    words = line.axes()
    if not words:
        raise Refusal(codes.AXIS_WORDS_MISSING.at(line.code_span(), code=rule.text))
    by_index = {axis.index: axis for axis in run.machine.axes}
    lower = list(s.own.lower or [by_index[n].lower if n in by_index else None for n in range(AXES)])
    upper = list(s.own.upper or [by_index[n].upper if n in by_index else None for n in range(AXES)])
    left = rule.function is F.LIMIT_LEFT
    unsure = set(s.own.limits_open)
    readings = [edge for edge in s.own.limit_readings if edge.axis not in words or (edge.low is None) == left]
    for axis, value in words.items():
        side = lower if left else upper
        scale = own_unit(run.machine, axis)
        if isinstance(value, Unknown) or _in_doubt(run, axis) or axis in s.own.reflected:
            # In which unit, and which way: an unknown limit holds nothing, and the one before it no longer holds.
            unsure.add(axis)
            side[axis] = None
            run.fail(codes.LIMIT_UNKNOWN.at(
                line.where(run.machine.word(axis)), side="left" if left else "right", axis=run.machine.word(axis),
                hint="program it without mirroring and in the axis's own unit (3.29)"))  # fmt: skip
            continue
        if not s.absolute:
            unsure.add(axis)
            side[axis] = None
            run.fail(codes.LIMIT_UNKNOWN.at(
                line.where(run.machine.word(axis)), side="left" if left else "right", axis=run.machine.word(axis),
                hint="program G90 before: the manual does not say whether G91 applies to it"))  # fmt: skip
            continue
        origins = _origins(run, axis)
        places = [Position(value * scale).plus(origin) for origin in origins]
        ends = [_ends(run, place) for place in places]
        if all(_past_all(by_index[axis], high if left else low, left=left) for low, high in ends):
            # The end stops decide there, and nobody said where they are.
            unsure.add(axis)
            key = "travel_min" if left else "travel_max"
            run.fail(codes.LIMIT_UNKNOWN.at(
                line.where(run.machine.word(axis)), side="left" if left else "right", axis=run.machine.word(axis),
                hint=f"keep it within the limit of the machine file ({key} of [axes]): it is past it",
            ))  # fmt: skip
        widest = min(low for low, _ in ends) if left else max(high for _, high in ends)
        side[axis] = widest if math.isfinite(widest) else None
        if len(origins) > 1:
            readings += _open_ends(axis, value * scale, origins, widest, left=left)
        if NOWHERE in origins:
            run.fail(codes.LIMIT_UNKNOWN.at(
                line.where(run.machine.word(axis)), side="left" if left else "right", axis=run.machine.word(axis),
                hint=FROM_WHERE))  # fmt: skip
        _stands(run, line, axis, places, left=left)
    s.own = s.own.but(
        lower=tuple(lower), upper=tuple(upper), limit_readings=tuple(readings), limits_open=frozenset(unsure)
    )
    _use_limits(run)


def _origins(run: McuWinRun, axis: int) -> list[Position]:
    """Where a limit of G98 or G99 may count from: machine zero, or the zero offset in force (3.29 leaves it open)."""
    offset = run.modal.g92[axis]
    low, high = _ends(run, offset)
    return [ORIGIN] if -SAME <= low <= high <= SAME else [ORIGIN, offset]


def _ends(run: McuWinRun, place: Position) -> tuple[float, float]:
    """The least and the greatest number that a place can be; infinite where it is not known."""
    value = run.modal.plain(place, 1.0, 0)
    return (-math.inf, math.inf) if isinstance(value, Unknown) and not value.bounded else bounds(value)


def _open_ends(
    axis: int, value: float, origins: list[Position], widest: float, *, left: bool
) -> Iterator[Boundary]:  # fmt: skip
    """A limit as each origin has it, but for the one that holds anyway."""
    for origin in origins:
        if origin != NOWHERE and (origin.form or value + origin.value != widest):
            low, high = (value, None) if left else (None, value)
            yield Boundary(axis, low, high, origin.value, origin.form, limit=True, open=FROM_WHERE)


def _past_all(axis: Axis, place: float, *, left: bool) -> bool:
    """Whether a limit is past the one of the machine's file and the end stop after it is not known."""
    soft, travel = (axis.lower, axis.travel_lower) if left else (axis.upper, axis.travel_upper)
    return travel is None and soft is not None and (place < soft if left else place > soft)


def _stands(run: McuWinRun, line: Part, axis: int, limits: list[Position], *, left: bool) -> None:
    """GP301 where the axis is past its new limit, which the controller watches at once (13.1.1.7); else GP304.

    limits: where it is in each reading; past some of them only is GP302.
    """
    at, word = run.modal.position[axis], run.machine.word(axis)
    if at == NOWHERE:
        return
    # How far past each limit it is, at least and at most.
    rooms = [_ends(run, limit.minus(at) if left else at.minus(limit)) for limit in limits if limit != NOWHERE]
    if not all(math.isfinite(low) for low, _ in rooms):
        run.assumed[f"{word} is within the limits that G98 and G99 set where they set them"] = None
        rooms = [room for room in rooms if math.isfinite(room[0])]
    if len(rooms) == len(limits) and min(low for low, _ in rooms) > SAME:
        known = run.machine.axis(AXIS_NAMES[axis])
        low, high = _ends(run, at)
        nearest, over = high if left else low, min(low for low, _ in rooms)
        run.fail(codes.SOFT_LIMIT.at(
            line.where(word), axis=word, reached=nearest, unit="mm" if known is None else known.unit,
            over=over, side="lower" if left else "upper", limit=nearest + (over if left else -over),
            hint="check the move: the axis is there already",
        ))  # fmt: skip
    elif any(low > SAME for low, _ in rooms):
        side = "lower" if left else "upper"
        run.fail(codes.LIMIT_UNKNOWN.at(line.where(word), side=side, axis=word, hint=FROM_WHERE))
    elif any(high > SAME for _, high in rooms):
        run.fail(codes.POSITION_UNKNOWN.at(line.where(word), axis=word, cause=describe(at.form)))


def _use_limits(run: McuWinRun) -> None:
    """Rows carry the limits; where one is beyond that of the machine's file, the end stops of the axis decide."""
    s = run.modal
    wider = False
    for axis in run.machine.axes:
        low, high = (s.own.lower or ())[axis.index], (s.own.upper or ())[axis.index]
        wider = wider or (axis.lower is not None and (low is None or low < axis.lower))
        wider = wider or (axis.upper is not None and (high is None or high > axis.upper))
    s.guards_off = tuple(sorted({*s.guards_off, "machine_area"} if wider else {*s.guards_off} - {"machine_area"}))
    run.state_changed()


HANDLERS: dict[F, Handler] = {
    F.ZERO_OFFSET_OFF: offset_off,
    F.SELECT_COORDINATES: offset_record,
    F.ZERO_OFFSET_SET: zero_offset,
    F.ZERO_OFFSET_READ: read_offset,
    F.ZERO_OFFSET_RESTORE: restore_offset,
    F.LIMIT_LEFT: limit,
    F.LIMIT_RIGHT: limit,
}
