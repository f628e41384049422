"""Where numbers count from, on controllers of one command a line: local coordinates, workspaces, tool measures, units.

WinCNC Users Guide, Coordinate System, Workspace, Tool Length Offset, Command Reference: G20 to G23, G28, G43, G49 to
G59, G90 to G95, L3, L4, L28, L92, M37. A position is machine = words + workspace + local (G92) + tool measure.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, NoReturn

from gproof.ir import codes
from gproof.ir.dialects.wincnc.settings import wincnc_settings
from gproof.ir.finding import FollowedRefusal, Refusal
from gproof.ir.machine import AXES
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.settings import Workspace
from gproof.ir.symbolic import NOWHERE, Position, Unknown, Value
from gproof.ir.trace import Op
from gproof.passes.interpret.core.modal_state import INCH, ZERO
from gproof.passes.interpret.core.plane_transform import NO_TRANSFORM, Transform
from gproof.passes.interpret.wincnc.axis_targets import follow, in_mm, scaled_axes, turn_unsettled
from gproof.passes.interpret.wincnc.moves import note_assumptions, stored_in
from gproof.passes.interpret.wincnc.state import (
    TURN_SETTLED,
    machine_zero,
    turned_shift,
    turning,
)

if TYPE_CHECKING:
    from gproof.passes.interpret.wincnc.command import Command
    from gproof.passes.interpret.wincnc.state import WinCncRun

_UNITS = {F.UNITS_INCH: INCH, F.UNITS_CM: 10.0, F.UNITS_MM: 1.0}


def distance(run: WinCncRun, axis: int, value: Value) -> Position:
    """A word as a distance of its axis."""
    length = in_mm(run, axis, value)
    return NOWHERE if length is None or isinstance(length, Unknown) else Position(length)


def all_axes(run: WinCncRun) -> list[int]:
    """Columns of the axes that the machine has."""
    return [axis.index for axis in run.machine.axes]


# ---- units and modes


def units(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """G20 inch, G21 centimetre, G22 mm, G23 the one before."""
    s = run.modal
    new = _UNITS.get(rule.function, s.own.unit_before)
    if new is None:
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=f"{rule.text} before any change of the unit"))
    s.own = s.own.but(unit_before=s.unit)
    if new != s.unit:
        # Whether kept numbers are numbers or lengths is not said.
        s.cycle = {}
        _keep_feeds(run, new)
        if s.own.center is not None:
            s.own = s.own.but(center=(math.nan, math.nan))
    s.unit = new
    s.stated.add("units")
    run.state_changed()
    run.event(Op.UNITS, line.span, arg=(new, 0.0))


def _keep_feeds(run: WinCncRun, new: float) -> None:
    """An F from before a change of the unit, number or length: not known until the next F, or that unit again.

    What the axes have of the machine's own file (axisvel= F) stays.
    """
    s = run.modal
    state = s.own
    own = {axis.index: axis.feed_velocity * 60.0 for axis in run.machine.axes if axis.feed_velocity is not None}

    def stays(column: int, feed: float) -> bool:
        return not s.linear[column] or feed == own.get(column)

    kept = state.kept_feeds
    if kept is not None and kept[0] == new:
        # An F since then holds for the axes that it named, in the unit that ends now.
        pairs = enumerate(zip(kept[1], state.feeds, strict=True))
        feeds = tuple(old if math.isnan(now) or stays(column, now) else math.nan for column, (old, now) in pairs)
        arc = kept[2] if state.arc_feed is None or math.isnan(state.arc_feed) else math.nan
    else:
        feeds = tuple(feed if stays(column, feed) else math.nan for column, feed in enumerate(state.feeds))
        arc = None if state.arc_feed is None else math.nan
    s.own = state.but(kept_feeds=(s.unit, state.feeds, state.arc_feed), feeds=feeds, arc_feed=arc)


def feed_mode(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """G93 and G94."""
    run.modal.feed_mode = 93 if rule.function is F.FEED_INVERSE_TIME else 94
    run.state_changed()


def rotary_feed(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """G95 F: the feed of rotary axes follows the radius, the position of Z; alone: off."""
    s = run.modal
    rotary = [axis.index for axis in run.machine.axes if not s.linear[axis.index]]
    feeds = list(s.own.feeds)
    for axis in rotary:
        feeds[axis] = math.nan
    s.own = s.own.but(feeds=tuple(feeds))


# ---- local coordinates


def _local_from(run: WinCncRun, axis: int, value: Value) -> Position:
    """The local offset that makes the present place read as ``value``."""
    s = run.modal
    base = s.work_offsets[s.work, axis].plus(s.beside_work(axis))
    return s.position[axis].minus(base).minus(distance(run, axis, value))


def _set_local(run: WinCncRun, line: Command, found: dict[int, Position]) -> None:
    s = run.modal
    for axis, place in found.items():
        s.g92[axis] = place
    run.state_changed()
    run.event(Op.OFFSET, line.span, arg=(0.0, 0.0))


def local_set(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """G92 with words: the present place gets these numbers; alone: no local coordinates."""
    axes = line.axes()
    if not axes:
        _doubt_zeros(run, line, rule, dict.fromkeys(range(AXES), ZERO))
        _set_local(run, line, dict.fromkeys(range(AXES), ZERO))
        return
    # What the place reads as while it is scaled or turned is open too.
    doubt_transform(run, line, rule, set(axes))
    _set_local(run, line, {axis: _local_from(run, axis, value) for axis, value in axes.items()})
    if {0, 1} <= axes.keys():
        s = run.modal
        s.own = s.own.but(cell_open=False)


def local_shift_machine(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """G92.1: local zero is at this machine position."""
    found = {axis: distance(run, axis, value) for axis, value in line.axes().items()}
    _doubt_zeros(run, line, rule, found)
    _set_local(run, line, found)


def local_shift(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """G92.2: local zero is shifted by this."""
    s = run.modal
    found = {axis: s.g92[axis].plus(distance(run, axis, value)) for axis, value in line.axes().items()}
    _doubt_zeros(run, line, rule, found)
    _set_local(run, line, found)


def local_switch(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """G92.3: store and clear, or restore what was stored."""
    s = run.modal
    stored = s.own.local_stored
    _doubt_zeros(run, line, rule, dict(enumerate((ZERO,) * AXES if stored is None else stored)))
    if stored is None:
        s.own = s.own.but(local_stored=tuple(s.g92))
        if any(place.form for place in s.g92):
            run.assumed["a local coordinate system is set where G92.3 stores it"] = None
        elif all(place == ZERO for place in s.g92):
            # Nothing is set, so nothing is stored: the next one stores again.
            s.own = s.own.but(local_stored=None)
        _set_local(run, line, dict.fromkeys(range(AXES), ZERO))
        return
    s.own = s.own.but(local_stored=None)
    if any(place != ZERO for place in s.g92) and tuple(s.g92) != stored:
        run.findings.add(codes.LOCAL_RESTORED_OVER.at(line.span, code=rule.text))
    _set_local(run, line, dict(enumerate(stored)))


def local_crossing(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """G92.4: local X and Y zero where two lines through stored positions cross."""
    points = []
    for letter in "ABCD":
        points.append(_stored_xy(run, line, letter))
    shift = line.number("O")
    if shift:
        what = f"O of {rule.text} (the manual does not say in which direction the points are shifted)"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.where("O"), code=what))
    if any(run.modal.work_offsets[run.modal.work, axis] != ZERO for axis in (0, 1)):
        what = f"{rule.text} in a shifted workspace (the manual does not say whether its shift counts for the crossing)"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what))
    (ax, ay), (bx, by), (cx, cy), (dx, dy) = points
    cross = (bx - ax) * (dy - cy) - (by - ay) * (dx - cx)
    if abs(cross) < 1e-9:
        raise Refusal(codes.ILLEGAL_VALUE.at(line.span, word=rule.text, what="the two lines do not cross"))
    along = ((cx - ax) * (dy - cy) - (cy - ay) * (dx - cx)) / cross
    found = {0: Position(ax + along * (bx - ax)), 1: Position(ay + along * (by - ay))}
    _doubt_zeros(run, line, rule, found)
    _set_local(run, line, found)


def _stored_xy(run: WinCncRun, line: Command, letter: str) -> tuple[float, float]:
    number = line.whole(letter, run.program.rules.integer_tolerance)
    stored = stored_in(run, f"P{number}")
    places = {} if stored is None else dict(stored[0])
    if any(axis not in places or places[axis].form for axis in (0, 1)):
        what = f"the stored position P{number}, whose X and Y are unknown,"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.where(letter), code=what))
    zeros = [machine_zero(run.modal.own, axis).value for axis in (0, 1)]
    return places[0].value - zeros[0], places[1].value - zeros[1]


def keep_local(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """L92: the local coordinates outlive this file."""
    run.modal.own = run.modal.own.but(keep_local=True)


# ---- workspaces, rotation, scaling


def workspace(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """G54 to G59 of type 0: another head, at the same X and Y of the program; of others see ``_turn``."""
    s = run.modal
    controls = wincnc_settings(run.machine)
    run.settings.meet(f"workspaces.{rule.value + 53}", line.span)
    spaces = {space.number: space for space in controls.workspaces}
    space = spaces.get(rule.value + 53)
    if space is None and rule.value != 1 and controls.devices is not None:
        raise Refusal(codes.NOT_ENABLED.at(
            line.where_code(rule), code=rule.text, device="its workspace", key=f"g{rule.value + 53}="))  # fmt: skip
    if line.axes() or (space is not None and space.kind):
        _turn(run, line, rule, space)
    if (
        space is not None and space.moves is not False and controls.shift_sign is None
        and (space.x, space.y) != (0.0, 0.0)
    ):  # fmt: skip
        for axis in (0, 1):
            s.position[axis] = NOWHERE
        s.work, s.jumped = rule.value, True
        run.state_changed()
        what = f"{rule.text} (the manual does not say in which direction its shift counts)"
        raise Refusal(
            codes.UNSUPPORTED_CODE.at(line.span, code=what, hint="state [controls] shift_sign in the machine file")
        )
    before = [s.program_position(axis) for axis in (0, 1)]
    if s.work == rule.value:
        return
    old = [s.work_offsets[s.work, axis] for axis in (0, 1)]
    moved = {axis for axis in (0, 1) if old[axis] != s.work_offsets[rule.value, axis]}
    if moved:
        doubt_transform(run, line, rule, moved)
    s.work = rule.value
    s.stated.add("work")
    run.state_changed()
    run.event(Op.OFFSET, line.span, arg=(float(rule.value), 0.0))
    if space is not None and space.moves is False:
        return
    target = list(s.position)
    for axis in (0, 1):
        change = s.work_offsets[s.work, axis].minus(old[axis])
        target[axis] = s.position[axis].plus(change) if before[axis] != NOWHERE else NOWHERE
    if target != s.position:
        note_assumptions(run, line.span)
        turn_unsettled(s)
        run.move(Op.TRAVERSE, follow(run, target, line.span), line.span)
        run.moved = True
    if space is None or space.moves is not None:
        return
    for axis in (0, 1):
        # Without M the key does not say whether axes move, and the text of G55 says it: both.
        change = s.work_offsets[s.work, axis].minus(old[axis])
        if change.form:
            s.position[axis] = NOWHERE
        elif change != ZERO and target[axis] != NOWHERE and axis not in s.own.locked:
            ends = min(0.0, -change.value), max(0.0, -change.value)
            s.position[axis] = run.unknown_place("value", axis, ends, target[axis])
            s.jumped = True


def _turn(run: WinCncRun, line: Command, rule: CodeRule, space: Workspace | None) -> NoReturn:
    """G54 to G59 of types 3 and 5, and with X and Y: what turns and where it is then is open.

    A shift of type 3 is bounded where R is known: at most twice the radius from that of the file, however it turns, if
    at all (``single_state.turned_shift``), so that what no direction keeps within limits is still reported.
    """
    s = run.modal
    s.work, s.jumped = rule.value, True
    s.own = s.own.but(flags=s.own.flags | {"turned"})
    for axis in [known.index for known in run.machine.axes if known.index < 2 or not s.linear[known.index]]:
        s.position[axis] = NOWHERE
        if space is None or not space.kind:
            continue
        ends = turned_shift(space, axis) if axis < 2 else None
        if ends is None:
            s.work_offsets[s.work, axis] = NOWHERE
            continue
        s.work_offsets[s.work, axis] = run.unknown_place("value", axis, ends, ZERO)
        run.assumed["a turning spindle (g54= T3) is within twice its radius of the shift of its workspace"] = None
    run.state_changed()
    run.event(Op.OFFSET, line.span, arg=(float(rule.value), 0.0))
    raise FollowedRefusal(codes.UNSUPPORTED_CODE.at(line.span, code=f"{rule.text} {turning(space)}"))


def doubt_transform(run: WinCncRun, line: Command, rule: CodeRule, axes: set[int]) -> None:
    """Where zero is moved of axes that G51 scales or G52 turns, what they turn and scale about is open."""
    s = run.modal
    turn = s.transform
    both = turn.rotated or bool(turn.open)
    moulded = {axis for axis, _ in scaled_axes(s)}
    moulded |= {axis for axis in (0, 1) if turn.on and (both or turn.factors[axis] != 1.0)}
    if axes & moulded:
        raise Refusal(codes.TRANSFORM_OPEN.at(line.span, what=f"what {rule.text} does while G51 or G52 is on"))


def _doubt_zeros(run: WinCncRun, line: Command, rule: CodeRule, zeros: dict[int, Position]) -> None:
    """The same for local zeros: those that stay where they are move nothing."""
    doubt_transform(run, line, rule, {axis for axis, place in zeros.items() if place != run.modal.g92[axis]})


def transform_off(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """G50: no scaling, no rotation; nothing moves."""
    run.modal.transform = NO_TRANSFORM
    run.modal.own = run.modal.own.but(scales=())
    run.state_changed()


def _begin_transform(run: WinCncRun, line: Command, rule: CodeRule, made: Transform) -> None:
    s = run.modal
    if s.transform.on and (made.scaled, made.rotated) != (s.transform.scaled, s.transform.rotated):
        what = f"what {rule.text} does while G51 or G52 is on"
        s.transform = replace(s.transform, open=what)
        raise Refusal(codes.TRANSFORM_OPEN.at(line.span, what=what))
    s.transform = made
    run.state_changed()


def _together(run: WinCncRun, line: Command, rule: CodeRule) -> NoReturn:
    """Refusal GP276 where G51 and G52 meet: whether the later ends the earlier, and which comes first, is not said."""
    what = f"what {rule.text} does while G51 or G52 is on"
    run.modal.transform = replace(run.modal.transform, open=what)
    raise Refusal(codes.TRANSFORM_OPEN.at(line.span, what=what))


def scaling(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """G51: X and Y by factors about a fixed point; factors of other axes are not modelled."""
    s = run.modal
    words = line.axes()
    for axis, value in words.items():
        if isinstance(value, Unknown):
            raise Refusal(codes.UNKNOWN_CONDITION.at(line.span, cause=value.cause))
        if value == 0.0:
            raise Refusal(codes.ILLEGAL_VALUE.at(line.span, word=run.machine.word(axis), what="a factor of 0"))
    numbers = {axis: value for axis, value in words.items() if not isinstance(value, Unknown)}
    common = line.number("C") or 0.0
    i, j, k = (common if line.number(letter) is None else line.number(letter) or 0.0 for letter in "IJK")
    if s.transform.rotated:
        _together(run, line, rule)
    # An axis that an earlier G51 scaled and this one does not name: whether it still is scaled is not known.
    scales = {axis: (math.nan if factor != 1.0 else 1.0, 0.0, ZERO) for axis, (factor, _, _) in s.own.scales}
    for axis, factor in numbers.items():
        if axis > 1:
            scales[axis] = factor, (k if axis == 2 else common) * s.scale(axis), s.offset(axis)
    s.own = s.own.but(scales=tuple(sorted(scales.items(), key=lambda pair: pair[0])))
    missing = [axis for axis in (0, 1) if axis not in numbers and s.transform.factors[axis] != 1.0]
    if missing:
        what = "whether an axis that is not in this G51 stays scaled"
        s.transform = replace(s.transform, open=what)
        raise Refusal(codes.TRANSFORM_OPEN.at(line.span, what=what))
    if not {0, 1} & numbers.keys():
        return
    factors = tuple(numbers.get(axis, 1.0) for axis in (0, 1))
    center = (i * s.unit, j * s.unit)
    origin = s.offset(0), s.offset(1)
    _begin_transform(
        run, line, rule, Transform(scaled=True, factors=(factors[0], factors[1]), center=center, origin=origin)
    )  # fmt: skip


def rotation(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """G52: by A degrees about I and J, counter-clockwise unless the machine's file says otherwise."""
    s = run.modal
    angle = (line.number("A") or 0.0) * wincnc_settings(run.machine).rotation_sign
    center = ((line.number("I") or 0.0) * s.unit, (line.number("J") or 0.0) * s.unit)
    origin = s.offset(0), s.offset(1)
    _begin_turn(run, line, rule, Transform(rotated=True, angle=angle, center=center, origin=origin))


def _begin_turn(run: WinCncRun, line: Command, rule: CodeRule, made: Transform) -> None:
    s = run.modal
    if scaled_axes(s):
        _together(run, line, rule)
    at = [s.program_position(axis) for axis in (0, 1)] if not s.transform.on else [NOWHERE, NOWHERE]
    _begin_transform(run, line, rule, made)
    turn_unsettled(s)
    if all(place == Position(middle) for place, middle in zip(at, made.center, strict=True)):
        s.own = s.own.but(flags=s.own.flags | {TURN_SETTLED})


def rotation_line(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """G52.1: about the local zero, to the direction of a line through two stored positions."""
    s = run.modal
    (ax, ay), (bx, by) = _stored_xy(run, line, "A"), _stored_xy(run, line, "B")
    if math.hypot(bx - ax, by - ay) < 1e-9:
        raise Refusal(codes.ILLEGAL_VALUE.at(line.span, word=rule.text, what="the two positions are the same"))
    angle = math.degrees(math.atan2(by - ay, bx - ax))
    origin = s.offset(0), s.offset(1)
    _begin_turn(run, line, rule, Transform(rotated=True, angle=angle, origin=origin))


# ---- homing, machine zero, stored home
