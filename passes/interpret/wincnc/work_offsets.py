"""Where numbers count from, on controllers of one command a line: local coordinates, workspaces, tool measures, units.

WinCNC Users Guide, Coordinate System, Workspace, Tool Length Offset, Command Reference: G20 to G23, G28, G43, G49 to
G59, G90 to G95, L3, L4, L28, L92, M37. A position is machine = words + workspace + local (G92) + tool measure.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, NoReturn

from gproof.ir import codes
from gproof.ir.dialects.wincnc_settings import wincnc_settings
from gproof.ir.finding import FollowedRefusal, Refusal
from gproof.ir.machine import AXES, AXIS_NAMES
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.settings import Workspace
from gproof.ir.symbolic import NOWHERE, Position, Unknown, Value
from gproof.ir.trace import Op, Wait
from gproof.passes.interpret.core.modal_state import INCH, ZERO
from gproof.passes.interpret.core.plane_transform import NO_TRANSFORM, Transform
from gproof.passes.interpret.wincnc.moves import (
    Handler,
    _in_mm,
    follow,
    note_assumptions,
    scaled_axes,
    stored_in,
    turn_unsettled,
)
from gproof.passes.interpret.wincnc.state import (
    REGISTERS_OPEN,
    TURN_SETTLED,
    arm_low_boundaries,
    machine_zero,
    turned_shift,
    turning,
    vertical_axes,
)

if TYPE_CHECKING:
    from gproof.passes.interpret.eding.moves import Motion
    from gproof.passes.interpret.wincnc.line import Command

_UNITS = {F.UNITS_INCH: INCH, F.UNITS_CM: 10.0, F.UNITS_MM: 1.0}


def _distance(ex: Motion, axis: int, value: Value) -> Position:
    """A word as a distance of its axis."""
    length = _in_mm(ex, axis, value)
    return NOWHERE if length is None or isinstance(length, Unknown) else Position(length)


def _all_axes(ex: Motion) -> list[int]:
    return [axis.index for axis in ex.machine.axes]


# ---- units and modes


def units(ex: Motion, line: Command, rule: CodeRule) -> None:
    """G20 inch, G21 centimetre, G22 mm, G23 the one before."""
    s = ex.modal
    new = _UNITS.get(rule.function, s.single.unit_before)
    if new is None:
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=f"{rule.text} before any change of the unit"))
    s.single = s.single.but(unit_before=s.unit)
    if new != s.unit:
        # Whether kept numbers are numbers or lengths is not said.
        s.cycle = {}
        _keep_feeds(ex, new)
        if s.single.center is not None:
            s.single = s.single.but(center=(math.nan, math.nan))
    s.unit = new
    s.stated.add("units")
    ex._state_changed()
    ex.event(Op.UNITS, line.span, arg=(new, 0.0))


def _keep_feeds(ex: Motion, new: float) -> None:
    """An F from before a change of the unit, number or length: not known until the next F, or that unit again.

    What the axes have of the machine's own file (axisvel= F) stays.
    """
    s = ex.modal
    state = s.single
    own = {axis.index: axis.feed_velocity * 60.0 for axis in ex.machine.axes if axis.feed_velocity is not None}

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
    s.single = state.but(kept_feeds=(s.unit, state.feeds, state.arc_feed), feeds=feeds, arc_feed=arc)


def feed_mode(ex: Motion, line: Command, rule: CodeRule) -> None:
    """G93 and G94."""
    ex.modal.feed_mode = 93 if rule.function is F.FEED_INVERSE_TIME else 94
    ex._state_changed()


def rotary_feed(ex: Motion, line: Command, rule: CodeRule) -> None:
    """G95 F: the feed of rotary axes follows the radius, the position of Z; alone: off."""
    s = ex.modal
    rotary = [axis.index for axis in ex.machine.axes if not s.linear[axis.index]]
    feeds = list(s.single.feeds)
    for axis in rotary:
        feeds[axis] = math.nan
    s.single = s.single.but(feeds=tuple(feeds))


# ---- local coordinates


def _local_from(ex: Motion, axis: int, value: Value) -> Position:
    """The local offset that makes the present place read as ``value``."""
    s = ex.modal
    base = s.work_offsets[s.work, axis].plus(s.beside_work(axis))
    return s.position[axis].minus(base).minus(_distance(ex, axis, value))


def _set_local(ex: Motion, line: Command, found: dict[int, Position]) -> None:
    s = ex.modal
    for axis, place in found.items():
        s.g92[axis] = place
    ex._state_changed()
    ex.event(Op.OFFSET, line.span, arg=(0.0, 0.0))


def local_set(ex: Motion, line: Command, rule: CodeRule) -> None:
    """G92 with words: the present place gets these numbers; alone: no local coordinates."""
    axes = line.axes()
    if not axes:
        _doubt_zeros(ex, line, rule, dict.fromkeys(range(AXES), ZERO))
        _set_local(ex, line, dict.fromkeys(range(AXES), ZERO))
        return
    # What the place reads as while it is scaled or turned is open too.
    _doubt_transform(ex, line, rule, set(axes))
    _set_local(ex, line, {axis: _local_from(ex, axis, value) for axis, value in axes.items()})
    if {0, 1} <= axes.keys():
        s = ex.modal
        s.single = s.single.but(cell_open=False)


def local_shift_machine(ex: Motion, line: Command, rule: CodeRule) -> None:
    """G92.1: local zero lies at this machine position."""
    found = {axis: _distance(ex, axis, value) for axis, value in line.axes().items()}
    _doubt_zeros(ex, line, rule, found)
    _set_local(ex, line, found)


def local_shift(ex: Motion, line: Command, rule: CodeRule) -> None:
    """G92.2: local zero is shifted by this."""
    s = ex.modal
    found = {axis: s.g92[axis].plus(_distance(ex, axis, value)) for axis, value in line.axes().items()}
    _doubt_zeros(ex, line, rule, found)
    _set_local(ex, line, found)


def local_switch(ex: Motion, line: Command, rule: CodeRule) -> None:
    """G92.3: store and clear, or restore what was stored."""
    s = ex.modal
    stored = s.single.local_stored
    _doubt_zeros(ex, line, rule, dict(enumerate((ZERO,) * AXES if stored is None else stored)))
    if stored is None:
        s.single = s.single.but(local_stored=tuple(s.g92))
        if any(place.form for place in s.g92):
            ex.assumed["a local coordinate system is set where G92.3 stores it"] = None
        elif all(place == ZERO for place in s.g92):
            # Nothing is set, so nothing is stored: the next one stores again.
            s.single = s.single.but(local_stored=None)
        _set_local(ex, line, dict.fromkeys(range(AXES), ZERO))
        return
    s.single = s.single.but(local_stored=None)
    if any(place != ZERO for place in s.g92) and tuple(s.g92) != stored:
        ex.findings.add(codes.LOCAL_RESTORED_OVER.at(line.span, code=rule.text))
    _set_local(ex, line, dict(enumerate(stored)))


def local_crossing(ex: Motion, line: Command, rule: CodeRule) -> None:
    """G92.4: local X and Y zero where two lines through stored positions cross."""
    points = []
    for letter in "ABCD":
        points.append(_stored_xy(ex, line, letter))
    shift = line.number("O")
    if shift:
        what = f"O of {rule.text} (which way the points are shifted is not said)"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.where("O"), code=what))
    if any(ex.modal.work_offsets[ex.modal.work, axis] != ZERO for axis in (0, 1)):
        what = f"{rule.text} in a workspace that is shifted (whether its shift counts for the crossing)"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what))
    (ax, ay), (bx, by), (cx, cy), (dx, dy) = points
    cross = (bx - ax) * (dy - cy) - (by - ay) * (dx - cx)
    if abs(cross) < 1e-9:
        raise Refusal(codes.ILLEGAL_VALUE.at(line.span, word=rule.text, what="the two lines do not cross"))
    along = ((cx - ax) * (dy - cy) - (cy - ay) * (dx - cx)) / cross
    found = {0: Position(ax + along * (bx - ax)), 1: Position(ay + along * (by - ay))}
    _doubt_zeros(ex, line, rule, found)
    _set_local(ex, line, found)


def _stored_xy(ex: Motion, line: Command, letter: str) -> tuple[float, float]:
    number = line.whole(letter, ex.program.rules.integer_tolerance)
    stored = stored_in(ex, f"P{number}")
    places = {} if stored is None else dict(stored[0])
    if any(axis not in places or places[axis].form for axis in (0, 1)):
        what = f"the stored position P{number}, of which X and Y are not known,"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.where(letter), code=what))
    zeros = [machine_zero(ex.modal.single, axis).value for axis in (0, 1)]
    return places[0].value - zeros[0], places[1].value - zeros[1]


def keep_local(ex: Motion, line: Command, rule: CodeRule) -> None:
    """L92: the local coordinates outlive this file."""
    ex.modal.single = ex.modal.single.but(keep_local=True)


# ---- workspaces, rotation, scaling


def workspace(ex: Motion, line: Command, rule: CodeRule) -> None:
    """G54 to G59 of type 0: another head, at the same X and Y of the program; of others see ``_turn``."""
    s = ex.modal
    controls = wincnc_settings(ex.machine)
    ex.settings.meet(f"workspaces.{rule.value + 53}", line.span)
    spaces = {space.number: space for space in controls.workspaces}
    space = spaces.get(rule.value + 53)
    if space is None and rule.value != 1 and controls.devices is not None:
        raise Refusal(codes.NOT_ENABLED.at(
            line.where_code(rule), code=rule.text, device="its workspace", key=f"g{rule.value + 53}="))  # fmt: skip
    if line.axes() or (space is not None and space.kind):
        _turn(ex, line, rule, space)
    if (
        space is not None and space.moves is not False and controls.shift_sign is None
        and (space.x, space.y) != (0.0, 0.0)
    ):  # fmt: skip
        for axis in (0, 1):
            s.position[axis] = NOWHERE
        s.work, s.jumped = rule.value, True
        ex._state_changed()
        what = f"{rule.text} (which way its shift counts is not said)"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what, hint="[controls] shift_sign tells"))
    before = [s.program_position(axis) for axis in (0, 1)]
    if s.work == rule.value:
        return
    old = [s.work_offsets[s.work, axis] for axis in (0, 1)]
    moved = {axis for axis in (0, 1) if old[axis] != s.work_offsets[rule.value, axis]}
    if moved:
        _doubt_transform(ex, line, rule, moved)
    s.work = rule.value
    s.stated.add("work")
    ex._state_changed()
    ex.event(Op.OFFSET, line.span, arg=(float(rule.value), 0.0))
    if space is not None and space.moves is False:
        return
    target = list(s.position)
    for axis in (0, 1):
        change = s.work_offsets[s.work, axis].minus(old[axis])
        target[axis] = s.position[axis].plus(change) if before[axis] != NOWHERE else NOWHERE
    if target != s.position:
        note_assumptions(ex, line.span)
        turn_unsettled(s)
        ex.move(Op.TRAVERSE, follow(ex, target, line.span), line.span)
        ex._moved = True
    if space is None or space.moves is not None:
        return
    for axis in (0, 1):
        # Without M the key does not say whether axes move, and the text of G55 says it: both.
        change = s.work_offsets[s.work, axis].minus(old[axis])
        if change.form:
            s.position[axis] = NOWHERE
        elif change != ZERO and target[axis] != NOWHERE and axis not in s.single.locked:
            ends = min(0.0, -change.value), max(0.0, -change.value)
            s.position[axis] = ex.unknown_place("value", axis, ends, target[axis])
            s.jumped = True


def _turn(ex: Motion, line: Command, rule: CodeRule, space: Workspace | None) -> NoReturn:
    """G54 to G59 of types 3 and 5, and with X and Y: what turns and where it stands then is open.

    A shift of type 3 is bounded where R is known: at most twice the radius from that of the file, however it turns, if
    at all (``single_state.turned_shift``), so that what no direction keeps within limits is still told.
    """
    s = ex.modal
    s.work, s.jumped = rule.value, True
    s.single = s.single.but(flags=s.single.flags | {"turned"})
    for axis in [known.index for known in ex.machine.axes if known.index < 2 or not s.linear[known.index]]:
        s.position[axis] = NOWHERE
        if space is None or not space.kind:
            continue
        ends = turned_shift(space, axis) if axis < 2 else None
        if ends is None:
            s.work_offsets[s.work, axis] = NOWHERE
            continue
        s.work_offsets[s.work, axis] = ex.unknown_place("value", axis, ends, ZERO)
        ex.assumed["a spindle that turns (g54= T3) stands within twice its radius of its workspace's shift"] = None
    ex._state_changed()
    ex.event(Op.OFFSET, line.span, arg=(float(rule.value), 0.0))
    raise FollowedRefusal(codes.UNSUPPORTED_CODE.at(line.span, code=f"{rule.text} {turning(space)}"))


def _doubt_transform(ex: Motion, line: Command, rule: CodeRule, axes: set[int]) -> None:
    """Where zero is moved of axes that G51 scales or G52 turns, what they turn and scale about is open."""
    s = ex.modal
    turn = s.transform
    both = turn.rotated or bool(turn.open)
    moulded = {axis for axis, _ in scaled_axes(s)}
    moulded |= {axis for axis in (0, 1) if turn.on and (both or turn.factors[axis] != 1.0)}
    if axes & moulded:
        raise Refusal(codes.TRANSFORM_OPEN.at(line.span, what=f"what {rule.text} does while G51 or G52 is on"))


def _doubt_zeros(ex: Motion, line: Command, rule: CodeRule, zeros: dict[int, Position]) -> None:
    """The same for local zeros: those that stay where they are move nothing."""
    _doubt_transform(ex, line, rule, {axis for axis, place in zeros.items() if place != ex.modal.g92[axis]})


def transform_off(ex: Motion, line: Command, rule: CodeRule) -> None:
    """G50: no scaling, no rotation; nothing moves."""
    ex.modal.transform = NO_TRANSFORM
    ex.modal.single = ex.modal.single.but(scales=())
    ex._state_changed()


def _begin_transform(ex: Motion, line: Command, rule: CodeRule, made: Transform) -> None:
    s = ex.modal
    if s.transform.on and (made.scaled, made.rotated) != (s.transform.scaled, s.transform.rotated):
        what = f"what {rule.text} does while G51 or G52 is on"
        s.transform = replace(s.transform, open=what)
        raise Refusal(codes.TRANSFORM_OPEN.at(line.span, what=what))
    s.transform = made
    ex._state_changed()


def _together(ex: Motion, line: Command, rule: CodeRule) -> NoReturn:
    """Refusal GP276 where G51 and G52 meet: whether the later ends the earlier, and which comes first, is not said."""
    what = f"what {rule.text} does while G51 or G52 is on"
    ex.modal.transform = replace(ex.modal.transform, open=what)
    raise Refusal(codes.TRANSFORM_OPEN.at(line.span, what=what))


def scaling(ex: Motion, line: Command, rule: CodeRule) -> None:
    """G51: X and Y by factors about a fixed point; factors of other axes are not modelled."""
    s = ex.modal
    words = line.axes()
    for axis, value in words.items():
        if isinstance(value, Unknown):
            raise Refusal(codes.UNKNOWN_CONDITION.at(line.span, cause=value.cause))
        if value == 0.0:
            raise Refusal(codes.ILLEGAL_VALUE.at(line.span, word=ex.machine.word(axis), what="a factor of 0"))
    numbers = {axis: value for axis, value in words.items() if not isinstance(value, Unknown)}
    common = line.number("C") or 0.0
    i, j, k = (common if line.number(letter) is None else line.number(letter) or 0.0 for letter in "IJK")
    if s.transform.rotated:
        _together(ex, line, rule)
    # An axis that an earlier G51 scaled and this one does not name: whether it still is, nobody says.
    scales = {axis: (math.nan if factor != 1.0 else 1.0, 0.0, ZERO) for axis, (factor, _, _) in s.single.scales}
    for axis, factor in numbers.items():
        if axis > 1:
            scales[axis] = factor, (k if axis == 2 else common) * s.scale(axis), s.offset(axis)
    s.single = s.single.but(scales=tuple(sorted(scales.items(), key=lambda pair: pair[0])))
    missing = [axis for axis in (0, 1) if axis not in numbers and s.transform.factors[axis] != 1.0]
    if missing:
        what = "whether an axis that this G51 does not name stays scaled"
        s.transform = replace(s.transform, open=what)
        raise Refusal(codes.TRANSFORM_OPEN.at(line.span, what=what))
    if not {0, 1} & numbers.keys():
        return
    factors = tuple(numbers.get(axis, 1.0) for axis in (0, 1))
    center = (i * s.unit, j * s.unit)
    origin = s.offset(0), s.offset(1)
    _begin_transform(
        ex, line, rule, Transform(scaled=True, factors=(factors[0], factors[1]), center=center, origin=origin)
    )  # fmt: skip


def rotation(ex: Motion, line: Command, rule: CodeRule) -> None:
    """G52: by A degrees about I and J, counter-clockwise unless the machine's file says otherwise."""
    s = ex.modal
    angle = (line.number("A") or 0.0) * wincnc_settings(ex.machine).rotation_sign
    center = ((line.number("I") or 0.0) * s.unit, (line.number("J") or 0.0) * s.unit)
    origin = s.offset(0), s.offset(1)
    _begin_turn(ex, line, rule, Transform(rotated=True, angle=angle, center=center, origin=origin))


def _begin_turn(ex: Motion, line: Command, rule: CodeRule, made: Transform) -> None:
    s = ex.modal
    if scaled_axes(s):
        _together(ex, line, rule)
    at = [s.program_position(axis) for axis in (0, 1)] if not s.transform.on else [NOWHERE, NOWHERE]
    _begin_transform(ex, line, rule, made)
    turn_unsettled(s)
    if all(place == Position(middle) for place, middle in zip(at, made.center, strict=True)):
        s.single = s.single.but(flags=s.single.flags | {TURN_SETTLED})


def rotation_line(ex: Motion, line: Command, rule: CodeRule) -> None:
    """G52.1: about the local zero, to the direction of a line through two stored positions."""
    s = ex.modal
    (ax, ay), (bx, by) = _stored_xy(ex, line, "A"), _stored_xy(ex, line, "B")
    if math.hypot(bx - ax, by - ay) < 1e-9:
        raise Refusal(codes.ILLEGAL_VALUE.at(line.span, word=rule.text, what="the two positions are one"))
    angle = math.degrees(math.atan2(by - ay, bx - ax))
    origin = s.offset(0), s.offset(1)
    _begin_turn(ex, line, rule, Transform(rotated=True, angle=angle, origin=origin))


# ---- homing, machine zero, stored home


def _homing_order(ex: Motion, axes: list[int]) -> list[int]:
    """Axes as the lines of g28move= have them, others behind."""
    listed = [AXIS_NAMES.index(name) for line in wincnc_settings(ex.machine).homing for name, _ in line.distances]
    return sorted(axes, key=lambda axis: (listed.index(axis) if axis in listed else len(listed), axis))


def home(ex: Motion, line: Command, rule: CodeRule) -> None:
    """G28: axes run to their switches; there they count as machine zero, or what g28coord= says."""
    s = ex.modal
    axes = _homing_order(ex, list(line.axes()) or _all_axes(ex))
    held = s.single.locked & set(axes)
    held |= {axis for pair in s.single.slaves for axis in pair} & set(axes)
    if held:
        for axis in axes:
            s.position[axis] = NOWHERE
        s.jumped = True
        what = f"{rule.text} of an axis that L300 locks or L13 couples"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.where_code(rule), code=what))
    turn_unsettled(s, axes)
    names = " ".join(AXIS_NAMES[axis] for axis in axes)
    ex.event(Op.HOME, line.span, text=ex._text(names))
    for axis in axes:
        there = ex.machine.axis(AXIS_NAMES[axis])
        place = there.home_place if there is not None else None
        s.position[axis] = Position(0.0 if place is None else place)
    s.single = s.single.but(
        touched=s.single.touched - set(axes), drift=_without(s.single.drift, axes),
        zeros=_without(s.single.zeros, axes), found=s.single.found - set(axes),
    )  # fmt: skip
    ex._state_changed()
    s.unhomed -= set(axes)
    _warn_kept(ex, line, rule, axes)
    ex.assumed["homing moves do not leave the machine"] = None
    if any(s.g92[axis] != ZERO for axis in axes):
        ex.assumed["local coordinates (G92) outlive homing"] = None
    letters = {axis.index: axis.word for axis in ex.machine.axes}
    ex.findings.add(codes.HOMING.at(line.span, axes=" ".join(letters.get(axis, "?") for axis in axes)))
    ex._end_section(Wait.HOME, "homed", None, line.span)


def _without(
    pairs: tuple[tuple[int, Position], ...], axes: list[int]
) -> tuple[tuple[int, Position], ...]:  # fmt: skip
    return tuple(pair for pair in pairs if pair[0] not in axes)


def _warn_kept(ex: Motion, line: Command, rule: CodeRule, axes: list[int]) -> None:
    """GP335 for local coordinates and tool measures that the job has given to axes whose machine zero moves.

    A measure is there for being kept over G28, which then shows the tip above the table (Tool Length Offset).
    """
    s = ex.modal
    kept = [(s.g92, "a local zero (G92) is")]
    if rule.function is not F.HOME:
        kept.append((s.tool_offset, "a tool measure (M37) is"))
    for places, what in kept:
        moved = [axis for axis in axes if not places[axis].form and places[axis] != ZERO]
        if moved:
            names = " ".join(ex.machine.word(axis) for axis in moved)
            ex.findings.add(codes.OFFSET_KEPT.at(line.span, code=rule.text, axes=names, what=what))


def set_machine(ex: Motion, line: Command, rule: CodeRule) -> None:
    """L28: the present place gets these machine coordinates.

    At a limit switch that the job has found, and behind it, that is how machine zero comes about: positions count from
    there. Anywhere else the machine's ends stay where they are, and so do positions; what the controller counts from
    machine zero (words, G53, stored places, soft limits, boundaries) moves with it.
    """
    s = ex.modal
    axes = line.axes()
    _doubt_transform(ex, line, rule, set(axes))
    _warn_kept(ex, line, rule, list(axes))
    at_switch = [axis for axis in axes if axis in s.single.touched | s.single.found]
    zeros = dict(s.single.zeros)
    for axis, value in axes.items():
        place = _distance(ex, axis, value)
        if axis in at_switch:
            s.position[axis] = place
            zeros.pop(axis, None)
            continue
        before = machine_zero(s.single, axis)
        zeros[axis] = s.position[axis].minus(place)
        if axis in dict(s.single.drift):
            ex._fail(codes.MACHINE_ZERO_MOVED.at(line.span, code=rule.text))
            zeros[axis] = NOWHERE
        if zeros[axis] != before and s.single.homes[axis] is not None:
            # What L3 stored: a number, or a place.
            s.single = s.single.but(homes=tuple(NOWHERE if n == axis else at for n, at in enumerate(s.single.homes)))
    turn_unsettled(s, axes)
    s.single = s.single.but(
        touched=s.single.touched - set(axes), found=s.single.found | set(at_switch),
        drift=_without(s.single.drift, list(axes)),
        zeros=tuple(sorted((axis, place) for axis, place in zeros.items() if place != ZERO)),
    )  # fmt: skip
    ex._state_changed()
    if len(at_switch) < len(axes):
        ex.assumed["L28 moves what counts from machine zero, and positions in this report go on from where it was"] = (
            None
        )
    if at_switch:
        ex._end_section(Wait.HOME, "position set", None, line.span)
    else:
        ex.event(Op.OFFSET, line.span, arg=(0.0, 0.0))


def wrap_rotary(ex: Motion, line: Command, rule: CodeRule) -> None:
    """L28.1: rotary axes count between 0 and 360 degrees."""
    s = ex.modal
    changed = False
    for axis in ex.machine.axes:
        place = s.position[axis.index]
        if s.linear[axis.index]:
            continue
        new = NOWHERE if place.form else Position(math.fmod(math.fmod(place.value, 360.0) + 360.0, 360.0))
        changed = changed or new != place
        s.position[axis.index] = new
    if changed:
        ex._end_section(Wait.HOME, "position set", None, line.span)


def store_home(ex: Motion, line: Command, rule: CodeRule) -> None:
    """L3: remembers where axes stand."""
    s = ex.modal
    homes = list(s.single.homes)
    for axis in line.axes() or _all_axes(ex):
        homes[axis] = s.position[axis]
    s.single = s.single.but(homes=tuple(homes))


def return_home(ex: Motion, line: Command, rule: CodeRule) -> None:
    """L4: rapid to where L3 was met."""
    s = ex.modal
    note_assumptions(ex, line.span)
    target = list(s.position)
    for axis in line.axes() or _all_axes(ex):
        stored = s.single.homes[axis]
        if stored is None:
            s.position[axis] = NOWHERE
            s.jumped = True
            what = f"{rule.text} for an axis that no L3 of this job stored"
            raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what))
        target[axis] = stored
    turn_unsettled(s, line.axes() or (0, 1))
    ex.move(Op.TRAVERSE, follow(ex, target, line.span), line.span)
    ex._moved = True


# ---- tool measures


def lengths(ex: Motion, line: Command, rule: CodeRule) -> None:
    """G43 and G49: measures on and off, of all vertical axes or of those named."""
    s = ex.modal
    axes = set(line.axes()) or set(vertical_axes(ex.machine))
    off = set(s.single.unmeasured)
    stored = dict(enumerate(s.single.before or s.tool_offset))
    if rule.function is F.TOOL_OFFSET_OFF:
        for axis in axes - off:
            stored[axis] = s.tool_offset[axis]
        for axis in axes:
            s.tool_offset[axis] = ZERO
        off |= axes
    else:
        for axis in axes & off:
            s.tool_offset[axis] = stored[axis]
        s.lengths_used = True
        arm_low_boundaries(s)
        off -= axes
    s.single = s.single.but(unmeasured=frozenset(off), before=tuple(stored[axis] for axis in range(AXES)))
    ex._state_changed()
    ex.event(Op.TOOL_OFFSET, line.span, arg=(0.0, 0.0))


def set_measure(ex: Motion, axis: int, offset: Position) -> None:
    """A tool measure of an axis: in force from here."""
    s = ex.modal
    s.tool_offset[axis] = offset
    s.lengths_used = True
    s.single = s.single.but(unmeasured=s.single.unmeasured - {axis})
    arm_low_boundaries(s)


def measure_tool(ex: Motion, line: Command, rule: CodeRule) -> None:
    """M37: the present place of a vertical axis reads as this, without local coordinates."""
    s = ex.modal
    axes = line.axes()
    if "O" in line.values or not axes:
        for axis in vertical_axes(ex.machine):
            set_measure(ex, axis, NOWHERE)
        ex._state_changed()
        what = f"{rule.text} with O" if "O" in line.values else f"{rule.text} without an axis"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=f"{what} (which way it counts is not said)"))
    if axes.keys() & {axis for axis, _ in scaled_axes(s)}:
        for axis in axes:
            set_measure(ex, axis, NOWHERE)
        ex._state_changed()
        raise Refusal(codes.TRANSFORM_OPEN.at(line.span, what=f"what {rule.text} names while G51 scales its axis"))
    for axis, value in axes.items():
        base = s.work_offsets[s.work, axis].plus(machine_zero(s.single, axis))
        offset = s.position[axis].minus(base).minus(_distance(ex, axis, value))
        if s.g92[axis] != ZERO:
            # The place reads so with local coordinates or without them: which, is not said.
            local = s.g92[axis]
            known = not local.form and offset != NOWHERE
            ends = min(0.0, -local.value), max(0.0, -local.value)
            offset = ex.unknown_place("value", axis, ends, offset) if known else NOWHERE
        set_measure(ex, axis, offset)
        for letter in "HT":
            if letter in line.values:
                number = line.whole(letter, ex.program.rules.integer_tolerance) or 0
                heights = {**dict(s.single.heights), number: offset}
                s.single = s.single.but(heights=tuple(sorted(heights.items(), key=lambda pair: pair[0])))
    for axis in s.single.unmeasured - axes.keys():
        # M37 "turns on G43 mode": of its own axis, or of all that G49 put aside. G43 and G49 settle it.
        if (s.single.before or s.tool_offset)[axis] != s.tool_offset[axis]:
            s.tool_offset[axis] = NOWHERE
    ex._state_changed()
    ex.event(Op.TOOL_OFFSET, line.span, arg=(math.nan, 0.0))


def measure_switch(ex: Motion, line: Command, rule: CodeRule) -> None:
    """M37.1, M37.2: the height of a measure switch, which TM1 and TM2 show."""
    s = ex.modal
    heights = list(s.single.switch_heights)
    heights[rule.value - 1] = Unknown(f"TM{rule.value}")
    s.single = s.single.but(switch_heights=(heights[0], heights[1]))


def shift_measures(ex: Motion, line: Command, rule: CodeRule) -> None:
    """M37.3: measures, H registers and workspaces are shifted; of what is stored nobody knows it then."""
    s = ex.modal
    axes = line.axes()
    if line.values.keys() & set("HTM"):
        s.single = s.single.but(
            heights=(), switch_heights=(Unknown("TM1"), Unknown("TM2")),
            flags=s.single.flags | {REGISTERS_OPEN},
        )  # fmt: skip
        for axis in vertical_axes(ex.machine):
            set_measure(ex, axis, NOWHERE)
    for axis in axes:
        s.work_offsets[s.work, axis] = NOWHERE
    ex._state_changed()
    if axes or line.values.keys() & set("HTM"):
        what = f"{rule.text} (which way the shift counts is not said)"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what))


def store_register(ex: Motion, line: Command, rule: CodeRule) -> None:
    """L1 N V: an H register."""
    number = line.whole("N", ex.program.rules.integer_tolerance)
    if number is None or not 0 <= number < 30:
        raise Refusal(codes.PARAMETER_RANGE.at(line.where("N"), code=rule.text, word="N", allowed="0 to 29"))
    s = ex.modal
    # Whether L101 and home positions (H) of that number are the same register, and how V counts there, is not said.
    heights = {**dict(s.single.heights), number: NOWHERE}
    places = tuple((known, where, lift) for known, where, lift in s.single.places if known != f"H{number}")
    s.single = s.single.but(
        heights=tuple(sorted(heights.items(), key=lambda pair: pair[0])),
        places=(*places, (f"H{number}", tuple((axis, NOWHERE) for axis in _all_axes(ex)), False)),
    )


HANDLERS: dict[F, Handler] = {
    F.UNITS_INCH: units,
    F.UNITS_CM: units,
    F.UNITS_MM: units,
    F.UNITS_LAST: units,
    F.FEED_INVERSE_TIME: feed_mode,
    F.FEED_PER_MINUTE: feed_mode,
    F.FEED_ROTARY: rotary_feed,
    F.LOCAL_SET: local_set,
    F.LOCAL_SHIFT_MACHINE: local_shift_machine,
    F.LOCAL_SHIFT: local_shift,
    F.LOCAL_SWITCH: local_switch,
    F.LOCAL_CROSSING: local_crossing,
    F.KEEP_LOCAL: keep_local,
    F.WORKSPACE: workspace,
    F.TRANSFORM_OFF: transform_off,
    F.SCALING_ON: scaling,
    F.ROTATION_ON: rotation,
    F.ROTATION_LINE: rotation_line,
    F.HOME: home,
    F.SET_MACHINE: set_machine,
    F.WRAP_ROTARY: wrap_rotary,
    F.STORE_HOME: store_home,
    F.RETURN_HOME: return_home,
    F.TOOL_OFFSET_ON: lengths,
    F.TOOL_OFFSET_OFF: lengths,
    F.MEASURE_TOOL: measure_tool,
    F.MEASURE_SWITCH: measure_switch,
    F.SHIFT_MEASURES: shift_measures,
    F.STORE_REGISTER: store_register,
}
