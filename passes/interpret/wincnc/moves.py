"""Moves of controllers of one command a line: straight, arcs, to stored places, lifted, until a limit switch.

WinCNC Users Guide, Command Reference: G0, G0.1, G1, G2, G3, G53, P, H, F, M28, M29, L10 to L13, L90, L91. Words count
in the unit and mode that are on; places are columns of ``AXIS_NAMES`` in mm or degrees.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.dialects import accepts
from gproof.ir.dialects.wincnc.settings import WinCncSettings, wincnc_settings
from gproof.ir.finding import Refusal, Span
from gproof.ir.machine import AXES, AXIS_NAMES
from gproof.ir.modal_groups import MOTION, OF_FEEDS
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import NOWHERE, Position, Unknown
from gproof.ir.trace import Op, Wait
from gproof.passes.geometry.machine_axes import vertical_axes
from gproof.passes.interpret.core import refused_lines
from gproof.passes.interpret.core.channels import with_pair
from gproof.passes.interpret.core.line_kernels import SAME
from gproof.passes.interpret.wincnc.axis_targets import aim, bounded, follow, mapped, turn_unsettled
from gproof.passes.interpret.wincnc.coupling import own_way, tell_held_back
from gproof.passes.interpret.wincnc.line_kernels import agreed
from gproof.passes.interpret.wincnc.state import (
    REGISTERS_OPEN,
    machine_zero,
    turning,
)

if TYPE_CHECKING:
    from gproof.passes.interpret.wincnc.command import Command
    from gproof.passes.interpret.wincnc.state import (
        WinCncRun,
    )

Handler = Callable[["WinCncRun", "Command", CodeRule], None]

MOVES = frozenset((
    F.TRAVERSE, F.TRAVERSE_LIFTED, F.FEED, F.ARC_CW, F.ARC_CCW, F.MACHINE_TRAVERSE, F.DRILL, F.DRILL_DWELL,
    F.DRILL_PECK, F.DRILL_CHIP_BREAK,
))  # fmt: skip


def note_assumptions(run: WinCncRun, span: Span | None) -> None:
    """What is taken for granted because neither job nor files say it. span: of the move, None of a code without one."""
    stated = run.modal.stated
    controls = wincnc_settings(run.machine)
    if "distance" not in stated and controls.absolute is None:
        run.assumed["the job starts in absolute distances (G90)"] = None
    if run.settings.waiting:
        run.settings.meet(f"workspaces.{run.modal.work + 53}", span)
    if run.setup.active_work is None and "work" not in stated:
        run.assumed["the job starts in workspace G54"] = None
    space = next((one for one in controls.workspaces if one.kind and one.number - 53 == run.modal.work), None)
    if space is not None and span is not None and "turned" not in run.modal.own.flags:
        run.modal.own = run.modal.own.but(flags=run.modal.own.flags | {"turned"})
        what = f"the job's first workspace, G{space.number}, {turning(space)}"
        run.fail(codes.UNSUPPORTED_CODE.at(span, code=what))
    if run.setup.default_offset is None:
        run.assumed[
            "at the start no rotation, scaling, cutter compensation, knife or array is on, and no axis is mapped, "
            "coupled or locked"
        ] = None


# ---- words to places


# ---- lines


def without_command(run: WinCncRun, line: Command, handlers: Mapping[F, Handler]) -> None:
    """A line of words alone: the active motion, a stored place, a feed, a speed."""
    s = run.modal
    letters = set(line.values)
    if letters == {"S"}:
        spindle_speed(run, line)
        return
    if "S" in letters:
        raise Refusal(codes.UNUSED_WORD.at(line.where("S"), word="S"))
    stored = letters & set("PHT")
    axes = line.axes()
    if not letters:
        return
    if letters == {"F"}:
        feed_word(run, line)
        return
    if axes and "F" in letters and letters <= {"F", *line.columns} and _first_is_feed(line):
        # "F100 X Y" gives a feed to the axes that it names, and a line without a command moves them.
        columns = set(axes)
        if line.bare >= letters - {"F"} and aim(run, line) != s.position:
            what = "an F before axes without numbers: a feed for them, or a move to 0 as well"
            feed_word(run, line, columns)
            raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what))
    if MOTION in s.unknown_modes:
        if axes and "F" in letters:
            feed_word(run, line, set(axes))
        refused_lines.vague(run, line, refused_lines.LOST_MOTION)
        return
    if s.motion == 0 and not s.cycle_code and not stored and not run.takes(accepts.KEPT_MOTION):
        hint = accepts.KEPT_MOTION.hint
        # G0 and G1 stay, and no section says what a file starts with: whether, and how, such words move is not known.
        code = codes.AXIS_WORDS_UNUSED.as_unknown()
        raise Refusal(code.at(line.span, why="no motion code comes before", hint=hint))
    rule = run.program.rules.codes["G", s.cycle_code] if s.cycle_code else run.motion_rules.get(s.motion)
    if rule is None:
        rule = run.program.rules.codes["G", 0]
    motion = s.motion
    if stored and rule.function in (F.ARC_CW, F.ARC_CCW):
        # A place is gone to in a straight line where arcs are modal too; they go on afterwards.
        rule = run.program.rules.codes["G", 0]
    for letter in sorted(letters - {*line.columns, *rule.takes}):
        raise Refusal(codes.UNUSED_WORD.at(line.where(letter), word=letter))
    if s.cycle_code and stored and not axes:
        run.lose_places()
        what = f"{min(stored)} alone after {rule.text} (a stored position, or a word of the cycle)"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what))
    if s.cycle_code and not {0, 1} & axes.keys():
        what = f"{' and '.join(sorted(letters))} without X and Y after {rule.text} (a hole here, a move, or neither)"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what))
    run.settings.line(rule, line.span)
    if s.line_lost:
        if "F" in letters:
            feed_word(run, line, set(axes))
        if refused_lines.vague(run, line, rule):
            return
    handlers[rule.function](run, line, rule)
    if stored:
        s.motion = motion


def _first_is_feed(line: Command) -> bool:
    return min(line.spans.items(), key=lambda pair: pair[1].column)[0] == "F"


def spindle_range(run: WinCncRun, line: Command) -> None:
    """GP271 for an S beyond what the spindle can do (spindle= R, or the machine file); S0 is a spindle that rests."""
    value, spindle = line.values["S"], run.machine.spindle(0)
    if spindle is None or isinstance(value, Unknown):
        return
    least, most = spindle.min_rpm or 0.0, math.inf if spindle.max_rpm is None else spindle.max_rpm
    if value > most or 0.0 < value < least:
        high = "..." if spindle.max_rpm is None else f"{most:g}"
        run.findings.add(codes.SPINDLE_RANGE.at(line.where("S"), value=value, low=f"{least:g}", high=high))


def spindle_speed(run: WinCncRun, line: Command) -> None:
    """S alone sets what the speed output gives; which way the spindle turns the program does not say."""
    value = line.values["S"]
    if not isinstance(value, Unknown) and value < 0:
        raise Refusal(codes.ILLEGAL_VALUE.at(line.where("S"), word="S", what=f"a speed of {value:g}"))
    spindle_range(run, line)
    devices = wincnc_settings(run.machine).devices
    if devices is not None and "spinmac" in devices:
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.where("S"), code="S with spindle=T2, which runs SPIN.MAC,"))
    run.modal.spindle_speed = value
    rpm = math.nan if isinstance(value, Unknown) else value
    run.event(Op.SETPOINT, line.span, arg=(0.0, rpm), text=run.text_number("spindle_speed"))


def feed_word(run: WinCncRun, line: Command, columns: set[int] | None = None) -> None:
    """F: the feed of the groups of these axes, or of the command group (vgroup=)."""
    value = line.values.get("F")
    if value is None:
        return
    s = run.modal
    if isinstance(value, Unknown):
        rate = math.nan
    elif value <= 0:
        raise Refusal(codes.ILLEGAL_VALUE.at(line.where("F"), word="F", what=f"a feed of {value:g}"))
    else:
        rate = value
    feeds = list(s.own.feeds)
    named = feed_columns(wincnc_settings(run.machine), columns or set())
    for column in named:
        feeds[column] = math.nan if s.unknown_modes & OF_FEEDS else rate * s.scale(column)
    doubt = s.own.feed_doubt and not named & {0, 1}
    s.own = s.own.but(feeds=tuple(feeds), feed_doubt=doubt)


def feed_columns(controls: WinCncSettings, columns: set[int]) -> set[int]:
    """The columns to which an F next to axis words of these columns gives a feed."""
    named = {AXIS_NAMES[column] for column in columns}
    if not named:
        named = set(controls.command_group) or {"x", "y"}
    if columns:
        grouped = {name for group in controls.feed_groups for name in group}
        for group in (*controls.feed_groups, controls.command_group):
            # The command group is one of axes only where no other says whom an axis belongs to.
            if named & set(group) and (group is not controls.command_group or not named & grouped):
                named |= set(group)
    return {AXIS_NAMES.index(name) for name in named}


def use_feed(run: WinCncRun, line: Command, target: list[Position], moving: set[int] | None = None) -> None:
    """The feed of the groups that this move moves, where they agree; otherwise unknown."""
    s = run.modal
    if moving is None:
        moving = {axis for axis in range(AXES) if target[axis] != s.position[axis]}
    linear = sum(1 << axis for axis in range(AXES) if s.linear[axis])
    s.feed = agreed(s.own.feeds, 0, sum(1 << axis for axis in moving), linear)
    if s.own.feed_doubt and moving & {0, 1}:
        s.feed = math.nan
    s.feed_unit = 1.0


def straight(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """G0 and G1."""
    note_assumptions(run, line.span)
    s = run.modal
    s.motion = int(rule.function)
    s.cycle, s.cycle_code = {}, 0
    companion = line.find(F.LIMIT_STOPS_AXIS, F.LIMIT_STOPS_LINE)
    moved = set(mapped(run, line))
    if rule.function is F.FEED and s.feed_mode == 93:
        _inverse_feed(run, line)
    else:
        feed_word(run, line, moved)
    if stored_place(run, line, Op.TRAVERSE if rule.function is F.TRAVERSE else Op.FEED):
        return
    for letter in "IJKR":
        if letter in line.values:
            raise Refusal(codes.UNUSED_WORD.at(line.where(letter), word=letter))
    if not moved:
        return
    target = aim(run, line)
    op = Op.TRAVERSE if rule.function is F.TRAVERSE else Op.FEED
    if op is Op.FEED and s.feed_mode != 93:
        use_feed(run, line, target, moved)
    target = adjusted(run, line, target, moved)
    switch_output(run, line, cutting=op is Op.FEED)
    if companion is not None:
        until_limit(run, line, op, target, companion)
        return
    run.move(op, target, line.span)
    run.moved = True


def switch_output(run: WinCncRun, line: Command, *, cutting: bool) -> None:
    """The output that is on during feed moves and off else (autoaux=, L34)."""
    s = run.modal
    controls = wincnc_settings(run.machine)
    number = controls.auto_output
    if number is None or "autoaux" not in s.own.flags or ("cutting" in s.own.flags) == cutting:
        return
    flags = s.own.flags | {"cutting"} if cutting else s.own.flags - {"cutting"}
    s.own = s.own.but(flags=flags)
    s.outputs = with_pair(s.outputs, number, float(cutting))
    run.event(Op.OUTPUT, line.span, arg=(float(number), float(cutting)), text=int(not controls.auto_pausing))
    dwell = s.own.auto_dwell[0 if cutting else 1]
    if dwell:
        run.event(Op.DWELL, line.span, arg=(dwell, 0.0))


def adjusted(run: WinCncRun, line: Command, target: list[Position], moved: set[int]) -> list[Position]:
    """The target where the controller goes instead of past a boundary or, of vertical axes, a limit (softlim= B V)."""
    s = run.modal
    controls = wincnc_settings(run.machine)
    if not (controls.adjust_boundary or controls.adjust_vertical):
        return target
    target = list(target)
    for axis in sorted(moved):
        there = run.machine.axis(AXIS_NAMES[axis])
        vertical = controls.adjust_vertical and axis in vertical_axes(run.machine)
        ends: list[tuple[str, str, Position]] = []
        if s.own.bound and (controls.adjust_boundary or vertical):
            base = s.work_offsets[s.work, axis].plus(s.beside_work(axis))
            for side, value in (("lower", s.own.lower[axis]), ("upper", s.own.upper[axis])):
                if value is not None:
                    ends.append((side, "boundary", base.moved(value)))
        if s.own.soft and vertical and there is not None:
            for side, value in (("lower", there.lower), ("upper", there.upper)):
                if value is not None:
                    ends.append((side, "limit", machine_zero(s.own, axis).moved(value)))
        for side, kind, end in ends:
            over = target[axis].minus(end)
            if over.form:
                raise Refusal(codes.POSITION_UNKNOWN.at(line.span, axis=run.machine.word(axis),
                                                        cause=f"whether it moves past its {side} {kind}"))  # fmt: skip
            if (over.value > 0) == (side == "upper") and abs(over.value) > SAME:
                word = run.machine.word(axis)
                run.findings.add(
                    codes.LIMIT_ADJUSTED.at(
                        line.span, axis=word, side=side, kind=kind, limit=end.value, wanted=target[axis].value,
                        unit="mm" if s.linear[axis] else "deg",
                    )
                )  # fmt: skip
                target[axis] = end
    return target


def _inverse_feed(run: WinCncRun, line: Command) -> None:
    value = line.values.get("F")
    if value is None:
        raise Refusal(codes.INVERSE_TIME_FEED_MISSING.at(line.span))
    if not isinstance(value, Unknown) and value <= 0:
        raise Refusal(codes.ILLEGAL_VALUE.at(line.where("F"), word="F", what=f"a feed of {value:g}"))
    run.modal.feed = math.nan if isinstance(value, Unknown) else value


def until_limit(run: WinCncRun, line: Command, op: Op, target: list[Position], companion: CodeRule) -> None:
    """A move that a limit switch may end (M28: each axis for itself, M29: all): somewhere on the way."""
    s = run.modal
    start = list(s.position)
    run.move(op, list(target), line.span)
    run.moved = True
    run.assumed["a move that a limit switch may end stops at its programmed point at the latest"] = None
    touched = set(s.own.touched)
    for axis in range(AXES):
        way = target[axis].minus(start[axis])
        if way == Position(0.0):
            continue
        touched.add(axis)
        if way.form or start[axis] == NOWHERE:
            s.position[axis] = NOWHERE
        else:
            ends = _stated_contact(run, axis, start[axis], (min(0.0, way.value), max(0.0, way.value)))
            s.position[axis] = run.unknown_place("home", axis, ends, start[axis])
    s.own = s.own.but(touched=frozenset(touched))
    run.end_section(Wait.PROBE, "stopped", None, line.span)


def _stated_contact(run: WinCncRun, axis: int, start: Position, ends: tuple[float, float]) -> tuple[float, float]:
    """The part of a way on which the setup says that a switch ends it; all of it where the setup says nothing of it."""
    stated = run.setup.contacts.get(AXIS_NAMES[axis])
    if stated is None or start.form:
        return ends
    low, high = max(ends[0], stated.low - start.value), min(ends[1], stated.high - start.value)
    if low > high:
        return ends
    run.assumed[f"the setup file gives the place where a switch stops {run.machine.word(axis)}"] = None
    return low, high


def stored_place(run: WinCncRun, line: Command, op: Op, *, machine: bool = False) -> bool:
    """Go to a stored position (P), home position (H) or tool position (T); whether the line says so.

    With G53 axes choose what of it counts, and a number is a distance from there (``G53 T3 X Y-2``).
    """
    names = [letter for letter in "PHT" if letter in line.values]
    if not names:
        return False
    letter = names[0]
    given = line.number(letter) or 0.0
    if abs(given - round(given)) > run.program.rules.integer_tolerance:
        what = f"{given:g} is not the number of a stored position"
        raise Refusal(codes.STORED_POSITION_COMMAND.at(line.where(letter), code=letter, what=what))
    number = round(given)
    run.settings.meet("stored", line.span)
    if len(names) > 1:
        what = "a stored position cannot be on a line with another position"
        raise Refusal(codes.STORED_POSITION_COMMAND.at(line.where(letter), code=f"{letter}{number}", what=what))
    if line.axes() and not machine:
        what = f"{letter}{number} together with axes on a line without G53 (the manual does not say which counts)"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.where(letter), code=what))
    s = run.modal
    controls = wincnc_settings(run.machine)
    most = {"P": controls.positions, "H": controls.homes, "T": controls.tool_positions}[letter]
    if number < 0 or (most is not None and number > most):
        raise Refusal(codes.STORED_POSITION_MISSING.at(line.where(letter), word=f"{letter}{number}"))
    place = stored_in(run, f"{letter}{number}")
    if place is None:
        run.lose_places()
        hint = f"state [positions.{letter}{number}] in the setup file"
        if letter == "T" and line.command is None:
            hint += "; define a macro in CNC.MAC if the post processor wrote it as a tool change"
        what = f"the stored position {letter}{number}, which is not in the setup file,"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.where(letter), code=what, hint=hint))
    places, lift = place
    target = list(s.position)
    words = mapped(run, line)
    for column, where in places:
        if not words or column in words:
            target[column] = where if column not in words else bounded(run, column, words[column], where)
    for column in words.keys() - {column for column, _ in places}:
        target[column] = NOWHERE
    target = follow(run, target, line.span)
    turn_unsettled(s, words or (axis for axis, _ in places))
    if lift:
        heads = vertical_axes(run.machine)
        over_heads(run, line, target, heads, _clearance(run, f"{letter}{number}"))
        for column in set(heads) - words.keys() if words else ():
            # A head that is not named: whether it comes down again after the lift is not said.
            top = run.machine.axis(AXIS_NAMES[column])
            is_known = top is not None and top.upper is not None and column not in dict(s.own.zeros)
            high = max(0.0, top.upper) if is_known and top is not None and top.upper is not None else math.inf
            s.position[column] = _up_to(run, column, target[column], high)
            s.jumped = True
        return True
    if op is Op.FEED:
        use_feed(run, line, target)
    run.move(op, target, line.span)
    run.moved = True
    return True


def _up_to(run: WinCncRun, column: int, place: Position, high: float) -> Position:
    """Anywhere between a place and machine position ``high`` above it."""
    if place.form or place.value >= high:
        return NOWHERE if place.form else place
    return run.unknown_place("value", column, (0.0, high - place.value), place)


def stored_in(run: WinCncRun, name: str) -> tuple[tuple[tuple[int, Position], ...], bool] | None:
    """Places by column under a name such as P4, and whether heads are lifted on the way; of the job, else the setup."""
    for known, places, lift in run.modal.own.places:
        if known == name:
            return _from_zero(run, places), lift
    if name[0] == "H" and REGISTERS_OPEN in run.modal.own.flags:
        return tuple((axis.index, NOWHERE) for axis in run.machine.axes), False
    stated = run.setup.positions.get(name)
    if stated is None:
        return None
    places = tuple((AXIS_NAMES.index(axis), Position(value)) for axis, value in stated.axes.items())
    return _from_zero(run, places), stated.lift


def _from_zero(run: WinCncRun, places: tuple[tuple[int, Position], ...]) -> tuple[tuple[int, Position], ...]:
    """Stored numbers as places: they count from machine zero, wherever L28 has moved it."""
    single = run.modal.own
    return tuple((axis, place.plus(machine_zero(single, axis))) for axis, place in places) if single.zeros else places


def _clearance(run: WinCncRun, name: str) -> float | None:
    """The machine height to which the setup lifts heads on their way; None where it says none, or the job stores it."""
    stated = run.setup.positions.get(name)
    own = any(known == name for known, _, _ in run.modal.own.places)
    return None if stated is None or own else stated.clearance


def lifted(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """G0.1: vertical heads up, over, down to where they were."""
    note_assumptions(run, line.span)
    target = aim(run, line)
    heads = vertical_axes(run.machine)
    if any(axis in heads for axis in mapped(run, line)):
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=f"{rule.text} with a vertical axis"))
    over_heads(run, line, target, heads)


def over_heads(
    run: WinCncRun, line: Command, target: list[Position], heads: tuple[int, ...], clearance: float | None = None
) -> None:
    """Heads up; over; and down to where the target has them. Locked ones stay.

    clearance: machine height to which they go up, those that are above it stay there; None: how far is not said.
    """
    s = run.modal
    locked = s.own.locked
    tell_held_back(run, [NOWHERE if n in heads and n in locked else at for n, at in enumerate(s.position)], line.span)
    up, over = list(s.position), list(target)
    for axis in (axis for axis in heads if axis not in locked):
        there = run.machine.axis(AXIS_NAMES[axis])
        top = math.inf if there is None or there.upper is None else max(0.0, there.upper)
        low = s.position[axis].value
        known = not s.position[axis].form and not target[axis].form
        if known and clearance is not None:
            up[axis] = over[axis] = Position(max(low, clearance))
            continue
        up[axis] = over[axis] = (
            run.unknown_place("value", axis, (low, max(low, top)), Position(0.0)) if known else NOWHERE
        )  # fmt: skip
    own_way(run, [NOWHERE if n in heads and n not in locked else at for n, at in enumerate(up)], line.span, frozenset())
    for place_of_all in (up, over, target):
        run.move(Op.TRAVERSE, list(place_of_all), line.span)
    run.moved = True


def machine_traverse(run: WinCncRun, line: Command, rule: CodeRule) -> None:
    """G53: rapid in machine coordinates; alone it lifts all vertical axes to machine zero."""
    note_assumptions(run, line.span)
    switch_output(run, line, cutting=False)
    if stored_place(run, line, Op.TRAVERSE, machine=True):
        return
    s = run.modal
    if line.axes():
        target = aim(run, line, machine=True)
        turn_unsettled(s, mapped(run, line))
    else:
        target = list(s.position)
        for axis in vertical_axes(run.machine):
            target[axis] = machine_zero(s.own, axis)
        target = follow(run, target, line.span)
    run.move(Op.TRAVERSE, target, line.span)
    run.moved = True
