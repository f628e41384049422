"""Moves of controllers of one command a line: straight, arcs, to stored places, lifted, until a limit switch.

WinCNC Users Guide, Command Reference: G0, G0.1, G1, G2, G3, G53, P, H, F, M28, M29, L10 to L13, L90, L91. Words count
in the unit and mode that are on; places are columns of ``AXIS_NAMES`` in mm or degrees.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.dialects import accepts
from gproof.ir.dialects.wincnc_settings import WinCncSettings, wincnc_settings
from gproof.ir.finding import Refusal, Span
from gproof.ir.machine import AXES, AXIS_NAMES
from gproof.ir.modal_groups import MOTION, OF_FEEDS
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import NOWHERE, Position, Unknown, Value
from gproof.ir.symbols import describe
from gproof.ir.trace import Op, Plane, Wait
from gproof.passes.interpret.core import line_kernels as k
from gproof.passes.interpret.core import refused_lines
from gproof.passes.interpret.core.arc_condition import radius_arc_warning
from gproof.passes.interpret.wincnc.line_kernels import SAME, ZERO_RADIUS, agreed, distance
from gproof.passes.interpret.wincnc.state import (
    LEANING,
    REGISTERS_OPEN,
    TURN_SETTLED,
    UNSCALED,
    followed,
    machine_zero,
    own_way,
    tell_held_back,
    turning,
    vertical_axes,
    went_along,
    with_pair,
)

if TYPE_CHECKING:
    from gproof.passes.interpret.core.modal_state import Modal
    from gproof.passes.interpret.eding.moves import Motion
    from gproof.passes.interpret.wincnc.line import Command

Handler = Callable[["Motion", "Command", CodeRule], None]

MOVES = frozenset((
    F.TRAVERSE, F.TRAVERSE_LIFTED, F.FEED, F.ARC_CW, F.ARC_CCW, F.MACHINE_TRAVERSE, F.DRILL, F.DRILL_DWELL,
    F.DRILL_PECK, F.DRILL_CHIP_BREAK,
))  # fmt: skip


def note_assumptions(ex: Motion, span: Span | None) -> None:
    """What is taken for granted because neither job nor files say it. span: of the move, None of a code without one."""
    stated = ex.modal.stated
    controls = wincnc_settings(ex.machine)
    if "distance" not in stated and controls.absolute is None:
        ex.assumed["the job starts in absolute distances (G90)"] = None
    if ex.settings.waiting:
        ex.settings.meet(f"workspaces.{ex.modal.work + 53}", span)
    if ex.setup.active_work is None and "work" not in stated:
        ex.assumed["the job starts in workspace G54"] = None
    space = next((one for one in controls.workspaces if one.kind and one.number - 53 == ex.modal.work), None)
    if space is not None and span is not None and "turned" not in ex.modal.single.flags:
        ex.modal.single = ex.modal.single.but(flags=ex.modal.single.flags | {"turned"})
        what = f"the job's first workspace, G{space.number}, {turning(space)}"
        ex._fail(codes.UNSUPPORTED_CODE.at(span, code=what))
    if ex.setup.default_offset is None:
        ex.assumed[
            "no rotation, no scaling, no axis that is mapped, coupled or locked, no cutter compensation, no knife and "
            "no array is on at the start"
        ] = None


def lose_places(ex: Motion) -> None:
    """Nobody knows any more where the axes stand that the machine has."""
    for axis in ex.machine.axes:
        ex.modal.position[axis.index] = NOWHERE
    ex.modal.jumped = True


# ---- words to places


def is_absolute(ex: Motion) -> bool:
    """Whether the words of the line that runs are places."""
    once = ex.modal.single.absolute_once
    return ex.modal.absolute if once is None else once


def mapped(ex: Motion, line: Command) -> dict[int, Value]:
    """Axis words by the column that they move (L11, L12): an axis takes the word of its source."""
    words = line.axes()
    sources = ex.modal.single.sources
    for column in words.keys() - set(sources):
        # The rule gives this word to the axis that is named twice, the example gives that axis another's words.
        what = f"a word of {ex.machine.word(column)} while two axes take those of another letter (L11, L12)"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what))
    return {axis: words[sources[axis]] for axis in range(AXES) if sources[axis] in words and ex.modal.has_axis(axis)}


def aim(ex: Motion, line: Command, *, machine: bool = False) -> list[Position]:
    """Where the axis words send all axes, in machine coordinates; machine: the words are such."""
    s = ex.modal
    words = mapped(ex, line)
    if s.single.cell_open and words.keys() & {0, 1}:
        what = "an array without G92 X Y behind its L10, which the manual asks for,"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what))
    target = list(s.position)
    if machine:
        _doubt_machine(ex, line, words)
        for axis, value in words.items():
            target[axis] = _bounded(ex, axis, value, machine_zero(s.single, axis))
        return follow(ex, target, line.span, frozenset(words))
    for axis, value in words.items():
        if s.single.sources[axis] != axis:
            _doubt_source(ex, line, axis)
        target[axis] = place_of(ex, axis, value)
    if s.transform.on and (0 in words or 1 in words):
        _doubt_turning(ex, line)
        pair = tuple(_in_mm(ex, axis, words.get(axis)) for axis in (0, 1))
        at = s.position[0], s.position[1]
        if is_absolute(ex):
            _doubt_other(ex, line, words)
            target[0], target[1] = s.transform.absolute((pair[0], pair[1]), at, (s.offset(0), s.offset(1)))
        else:
            target[0], target[1] = s.transform.incremental((pair[0], pair[1]), at)
    return follow(ex, target, line.span, frozenset(words))


def _doubt_machine(ex: Motion, line: Command, words: dict[int, Value]) -> None:
    """Refusal where more than tool measures and local coordinates, which G53 ignores, lies between words and places."""
    s = ex.modal
    if not is_absolute(ex) and words:
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code="G53 with distances (G91, L91)"))
    if (s.transform.on and words.keys() & {0, 1}) or words.keys() & {axis for axis, _ in scaled_axes(s)}:
        raise Refusal(codes.TRANSFORM_OPEN.at(line.span, what="whether G53 is scaled and turned by G51 and G52"))


def _doubt_turning(ex: Motion, line: Command) -> None:
    """Refusal where X or Y is scaled or turned and mapped: which comes first is not said."""
    for axis, source in enumerate(ex.modal.single.sources):
        if axis != source and {axis, source} & {0, 1}:
            raise Refusal(codes.TRANSFORM_OPEN.at(line.span, what="whether L11 maps words before or after they turn"))


def _doubt_other(ex: Motion, line: Command, words: dict[int, Value]) -> None:
    """Refusal GP276 for one of X and Y alone while G52 turns both, where nobody knows the other one of the program.

    It is the one that was programmed last, or what the place of the machine is when it is turned back: the same once
    both were named behind G52, or where the axes stood at the middle of the turn.
    """
    s = ex.modal
    if {0, 1} <= words.keys():
        if {0, 1} & (s.single.locked | {axis for axis, _ in s.single.slaves}):
            turn_unsettled(s)
        else:
            s.single = s.single.but(flags=s.single.flags | {TURN_SETTLED})
    elif s.transform.rotated and TURN_SETTLED not in s.single.flags:
        what = "which place the other one of X and Y has in the program behind G52, before a line names both"
        raise Refusal(codes.TRANSFORM_OPEN.at(line.span, what=what))


def turn_unsettled(s: Modal, axes: Iterable[int] = (0, 1)) -> None:
    """X or Y, if among ``axes``, went to a place of the machine: while G52 turns them the program's is open again."""
    if TURN_SETTLED in s.single.flags and not {0, 1}.isdisjoint(axes):
        s.single = s.single.but(flags=s.single.flags - {TURN_SETTLED})


def place_of(ex: Motion, axis: int, value: Value) -> Position:
    """Where a word sends an axis by itself, as G51 scales it; of X and Y nobody can say that while G51 or G52 is on."""
    s = ex.modal
    absolute = is_absolute(ex)
    origin = s.offset(axis) if absolute else s.position[axis]
    factor, center, zero = dict(s.single.scales).get(axis, UNSCALED)
    if factor == 1.0:
        return _bounded(ex, axis, value, origin)
    if isinstance(value, Unknown) or math.isnan(factor) or (absolute and zero != origin):
        return NOWHERE
    about = center / s.scale(axis)
    return _bounded(ex, axis, about + factor * (value - about) if absolute else factor * value, origin)


def _doubt_source(ex: Motion, line: Command, axis: int) -> None:
    """Where L11 or L12 has another axis's words move one: whose zero and scale count, that axis's or its own?

    A tool's measure is that of the head that moves (Head Swap, Tool Length Offset). GP304, once for each axis, where
    local coordinates differ, the row having its own; GP276 where the scales do.
    """
    s = ex.modal
    source = s.single.sources[axis]
    scales = dict(s.single.scales)
    if {scales.get(axis, UNSCALED)[0], scales.get(source, UNSCALED)[0]} != {1.0} or s.scale(axis) != s.scale(source):
        what = f"whether {ex.machine.word(axis)}, which L11 or L12 maps, is scaled as itself or as the letter's axis"
        raise Refusal(codes.TRANSFORM_OPEN.at(line.span, what=what))
    zeros = [s.g92[n].plus(s.work_offsets[s.work, n]).plus(machine_zero(s.single, n)) for n in (axis, source)]
    if zeros[0] != zeros[1] and is_absolute(ex):
        what = "whose local zero counts for words that L11 or L12 maps"
        tell_open(ex, line.span, axis, what)


def tell_open(ex: Motion, span: Span, axis: int, cause: str) -> None:
    """GP304 for a place that another reading has elsewhere, once for each axis and cause; nothing is proved then."""
    s = ex.modal
    name = f"open {axis} {cause[:12]}"
    if name in s.single.flags:
        return
    s.single = s.single.but(flags=s.single.flags | {name})
    ex._refuse(codes.POSITION_UNKNOWN.at(span, axis=ex.machine.word(axis), cause=cause))


def scaled_axes(s: Modal) -> list[tuple[int, float]]:
    """Columns beside X and Y that G51 scales, and their factors, NaN where it is not known."""
    return [(axis, factor) for axis, (factor, _, _) in s.single.scales if factor != 1.0]


def _in_mm(ex: Motion, axis: int, value: Value | None) -> Value | None:
    return value if value is None or isinstance(value, Unknown) else value * ex.modal.scale(axis)


def _bounded(ex: Motion, axis: int, value: Value, origin: Position) -> Position:
    scale = ex.modal.scale(axis)
    if not isinstance(value, Unknown):
        return Position(value * scale + origin.value, origin.form)
    if not value.bounded or origin == NOWHERE:
        return NOWHERE
    return ex.unknown_place("value", axis, (value.low * scale, value.high * scale), origin)


def follow(
    ex: Motion, target: list[Position], span: Span, named: frozenset[int] = frozenset()
) -> list[Position]:  # fmt: skip
    """The target with what follows other axes step by step (L13), and without what is locked (L300): GP200.

    named: columns of the line's words. Refusal GP113 for a follower that is sent somewhere itself.
    """
    own_way(ex, target, span, named)
    for axis in went_along(ex.modal, target, named):
        tell_open(ex, span, axis, "whether the steps count that it followed another axis (L13)")
    tell_held_back(ex, target, span)
    return followed(ex.modal.single, ex.modal.position, target)


# ---- lines


def without_command(ex: Motion, line: Command) -> None:
    """A line of words alone: the active motion, a stored place, a feed, a speed."""
    s = ex.modal
    letters = set(line.values)
    if letters == {"S"}:
        spindle_speed(ex, line)
        return
    if "S" in letters:
        raise Refusal(codes.UNUSED_WORD.at(line.where("S"), word="S"))
    stored = letters & set("PHT")
    axes = line.axes()
    if not letters:
        return
    if letters == {"F"}:
        feed_word(ex, line)
        return
    if axes and "F" in letters and letters <= {"F", *line.columns} and _first_is_feed(line):
        # "F100 X Y" gives a feed to the axes that it names, and a line without a command moves them.
        columns = set(axes)
        if line.bare >= letters - {"F"} and aim(ex, line) != s.position:
            what = "an F in front of axes without numbers: a feed for them, or a move to 0 besides"
            feed_word(ex, line, columns)
            raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what))
    if MOTION in s.unknown_modes:
        if axes and "F" in letters:
            feed_word(ex, line, set(axes))
        refused_lines.vague(ex, line, refused_lines.LOST_MOTION)
        return
    if s.motion == 0 and not s.cycle_code and not stored and not ex.takes(accepts.KEPT_MOTION):
        hint = accepts.KEPT_MOTION.hint
        # G0 and G1 stay, and no section says what a file begins with: whether, and how, such words move is not known.
        code = codes.AXIS_WORDS_UNUSED.as_unknown()
        raise Refusal(code.at(line.span, why="no motion code before", hint=hint))
    rule = ex.program.rules.codes["G", s.cycle_code] if s.cycle_code else ex._motion_rules.get(s.motion)
    if rule is None:
        rule = ex.program.rules.codes["G", 0]
    motion = s.motion
    if stored and rule.function in (F.ARC_CW, F.ARC_CCW):
        # A place is gone to in a straight line where arcs are modal too; they go on afterwards.
        rule = ex.program.rules.codes["G", 0]
    for letter in sorted(letters - {*line.columns, *rule.takes}):
        raise Refusal(codes.UNUSED_WORD.at(line.where(letter), word=letter))
    if s.cycle_code and stored and not axes:
        lose_places(ex)
        what = f"{min(stored)} alone behind {rule.text} (a stored position, or a word of the cycle)"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what))
    if s.cycle_code and not {0, 1} & axes.keys():
        what = f"{' and '.join(sorted(letters))} without X and Y behind {rule.text} (a hole here, a move, or neither)"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=what))
    from gproof.passes.interpret.wincnc.line import HANDLERS as ALL

    ex.settings.line(rule, line.span)
    if s.line_lost:
        if "F" in letters:
            feed_word(ex, line, set(axes))
        if refused_lines.vague(ex, line, rule):
            return
    ALL[rule.function](ex, line, rule)
    if stored:
        s.motion = motion


def _first_is_feed(line: Command) -> bool:
    return min(line.spans.items(), key=lambda pair: pair[1].column)[0] == "F"


def spindle_range(ex: Motion, line: Command) -> None:
    """GP271 for an S beyond what the spindle can do (spindle= R, or the machine file); S0 is a spindle that rests."""
    value, spindle = line.values["S"], ex.machine.spindle(0)
    if spindle is None or isinstance(value, Unknown):
        return
    least, most = spindle.min_rpm or 0.0, math.inf if spindle.max_rpm is None else spindle.max_rpm
    if value > most or 0.0 < value < least:
        high = "..." if spindle.max_rpm is None else f"{most:g}"
        ex.findings.add(codes.SPINDLE_RANGE.at(line.where("S"), value=value, low=f"{least:g}", high=high))


def spindle_speed(ex: Motion, line: Command) -> None:
    """S alone sets what the speed output gives; which way the spindle turns the program does not say."""
    value = line.values["S"]
    if not isinstance(value, Unknown) and value < 0:
        raise Refusal(codes.ILLEGAL_VALUE.at(line.where("S"), word="S", what=f"a speed of {value:g}"))
    spindle_range(ex, line)
    devices = wincnc_settings(ex.machine).devices
    if devices is not None and "spinmac" in devices:
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.where("S"), code="S with spindle=T2, which runs SPIN.MAC,"))
    ex.modal.spindle_speed = value
    rpm = math.nan if isinstance(value, Unknown) else value
    ex.event(Op.SETPOINT, line.span, arg=(0.0, rpm), text=ex._text("spindle_speed"))


def feed_word(ex: Motion, line: Command, columns: set[int] | None = None) -> None:
    """F: the feed of the groups of these axes, or of the command group (vgroup=)."""
    value = line.values.get("F")
    if value is None:
        return
    s = ex.modal
    if isinstance(value, Unknown):
        rate = math.nan
    elif value <= 0:
        raise Refusal(codes.ILLEGAL_VALUE.at(line.where("F"), word="F", what=f"a feed of {value:g}"))
    else:
        rate = value
    feeds = list(s.single.feeds)
    named = feed_columns(wincnc_settings(ex.machine), columns or set())
    for column in named:
        feeds[column] = math.nan if s.unknown_modes & OF_FEEDS else rate * s.scale(column)
    doubt = s.single.feed_doubt and not named & {0, 1}
    s.single = s.single.but(feeds=tuple(feeds), feed_doubt=doubt)


def feed_columns(controls: WinCncSettings, columns: set[int]) -> set[int]:
    """The columns to which an F beside axis words of these columns gives a feed."""
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


def use_feed(ex: Motion, line: Command, target: list[Position], moving: set[int] | None = None) -> None:
    """The feed of the groups that this move moves, where they agree; unknown else."""
    s = ex.modal
    if moving is None:
        moving = {axis for axis in range(AXES) if target[axis] != s.position[axis]}
    linear = sum(1 << axis for axis in range(AXES) if s.linear[axis])
    s.feed = agreed(s.single.feeds, 0, sum(1 << axis for axis in moving), linear)
    if s.single.feed_doubt and moving & {0, 1}:
        s.feed = math.nan
    s.feed_unit = 1.0


def straight(ex: Motion, line: Command, rule: CodeRule) -> None:
    """G0 and G1."""
    note_assumptions(ex, line.span)
    s = ex.modal
    s.motion = int(rule.function)
    s.cycle, s.cycle_code = {}, 0
    companion = line.find(F.LIMIT_STOPS_AXIS, F.LIMIT_STOPS_LINE)
    moved = set(mapped(ex, line))
    if rule.function is F.FEED and s.feed_mode == 93:
        _inverse_feed(ex, line)
    else:
        feed_word(ex, line, moved)
    if stored_place(ex, line, Op.TRAVERSE if rule.function is F.TRAVERSE else Op.FEED):
        return
    for letter in "IJKR":
        if letter in line.values:
            raise Refusal(codes.UNUSED_WORD.at(line.where(letter), word=letter))
    if not moved:
        return
    target = aim(ex, line)
    op = Op.TRAVERSE if rule.function is F.TRAVERSE else Op.FEED
    if op is Op.FEED and s.feed_mode != 93:
        use_feed(ex, line, target, moved)
    target = adjusted(ex, line, target, moved)
    switch_output(ex, line, cutting=op is Op.FEED)
    if companion is not None:
        until_limit(ex, line, op, target, companion)
        return
    ex.move(op, target, line.span)
    ex._moved = True


def switch_output(ex: Motion, line: Command, *, cutting: bool) -> None:
    """The output that is on during feed moves and off else (autoaux=, L34)."""
    s = ex.modal
    controls = wincnc_settings(ex.machine)
    number = controls.auto_output
    if number is None or "autoaux" not in s.single.flags or ("cutting" in s.single.flags) == cutting:
        return
    flags = s.single.flags | {"cutting"} if cutting else s.single.flags - {"cutting"}
    s.single = s.single.but(flags=flags, outputs=with_pair(s.single.outputs, number, float(cutting)))
    ex.event(Op.OUTPUT, line.span, arg=(float(number), float(cutting)), text=int(not controls.auto_pausing))
    dwell = s.single.auto_dwell[0 if cutting else 1]
    if dwell:
        ex.event(Op.DWELL, line.span, arg=(dwell, 0.0))


def adjusted(ex: Motion, line: Command, target: list[Position], moved: set[int]) -> list[Position]:
    """The target where the controller goes instead of past a boundary or, of vertical axes, a limit (softlim= B V)."""
    s = ex.modal
    controls = wincnc_settings(ex.machine)
    if not (controls.adjust_boundary or controls.adjust_vertical):
        return target
    target = list(target)
    for axis in sorted(moved):
        there = ex.machine.axis(AXIS_NAMES[axis])
        vertical = controls.adjust_vertical and axis in vertical_axes(ex.machine)
        ends: list[tuple[str, str, Position]] = []
        if s.single.bound and (controls.adjust_boundary or vertical):
            base = s.work_offsets[s.work, axis].plus(s.beside_work(axis))
            for side, value in (("lower", s.single.lower[axis]), ("upper", s.single.upper[axis])):
                if value is not None:
                    ends.append((side, "boundary", base.moved(value)))
        if s.single.soft and vertical and there is not None:
            for side, value in (("lower", there.lower), ("upper", there.upper)):
                if value is not None:
                    ends.append((side, "limit", machine_zero(s.single, axis).moved(value)))
        for side, kind, end in ends:
            over = target[axis].minus(end)
            if over.form:
                raise Refusal(codes.POSITION_UNKNOWN.at(line.span, axis=ex.machine.word(axis),
                                                        cause=f"whether it goes past its {side} {kind}"))  # fmt: skip
            if (over.value > 0) == (side == "upper") and abs(over.value) > SAME:
                word = ex.machine.word(axis)
                ex.findings.add(
                    codes.LIMIT_ADJUSTED.at(
                        line.span, axis=word, side=side, kind=kind, limit=end.value, wanted=target[axis].value,
                        unit="mm" if s.linear[axis] else "deg",
                    )
                )  # fmt: skip
                target[axis] = end
    return target


def _inverse_feed(ex: Motion, line: Command) -> None:
    value = line.values.get("F")
    if value is None:
        raise Refusal(codes.INVERSE_TIME_FEED_MISSING.at(line.span))
    if not isinstance(value, Unknown) and value <= 0:
        raise Refusal(codes.ILLEGAL_VALUE.at(line.where("F"), word="F", what=f"a feed of {value:g}"))
    ex.modal.feed = math.nan if isinstance(value, Unknown) else value


def until_limit(ex: Motion, line: Command, op: Op, target: list[Position], companion: CodeRule) -> None:
    """A move that a limit switch may end (M28: each axis for itself, M29: all): somewhere on the way."""
    s = ex.modal
    start = list(s.position)
    ex.move(op, list(target), line.span)
    ex._moved = True
    ex.assumed["a move that a limit switch may end stops at its programmed point at the latest"] = None
    touched = set(s.single.touched)
    for axis in range(AXES):
        way = target[axis].minus(start[axis])
        if way == Position(0.0):
            continue
        touched.add(axis)
        if way.form or start[axis] == NOWHERE:
            s.position[axis] = NOWHERE
        else:
            ends = _stated_contact(ex, axis, start[axis], (min(0.0, way.value), max(0.0, way.value)))
            s.position[axis] = ex.unknown_place("home", axis, ends, start[axis])
    s.single = s.single.but(touched=frozenset(touched))
    ex._end_section(Wait.PROBE, "stopped", None, line.span)


def _stated_contact(ex: Motion, axis: int, start: Position, ends: tuple[float, float]) -> tuple[float, float]:
    """The part of a way on which the setup says that a switch ends it; all of it where the setup says nothing of it."""
    stated = ex.setup.contacts.get(AXIS_NAMES[axis])
    if stated is None or start.form:
        return ends
    low, high = max(ends[0], stated.low - start.value), min(ends[1], stated.high - start.value)
    if low > high:
        return ends
    ex.assumed[f"the setup says where a switch ends a move of {ex.machine.word(axis)}"] = None
    return low, high


def stored_place(ex: Motion, line: Command, op: Op, *, machine: bool = False) -> bool:
    """Go to a stored position (P), home position (H) or tool position (T); whether the line says so.

    Beside G53 axes choose what of it counts, and a number is a distance from there (``G53 T3 X Y-2``).
    """
    names = [letter for letter in "PHT" if letter in line.values]
    if not names:
        return False
    letter = names[0]
    given = line.number(letter) or 0.0
    if abs(given - round(given)) > ex.program.rules.integer_tolerance:
        what = f"{given:g} is not the number of a stored position"
        raise Refusal(codes.STORED_POSITION_COMMAND.at(line.where(letter), code=letter, what=what))
    number = round(given)
    ex.settings.meet("stored", line.span)
    if len(names) > 1:
        what = "a stored position can not stand beside another place"
        raise Refusal(codes.STORED_POSITION_COMMAND.at(line.where(letter), code=f"{letter}{number}", what=what))
    if line.axes() and not machine:
        what = f"{letter}{number} beside axes in a line without G53 (what counts is not said)"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.where(letter), code=what))
    s = ex.modal
    controls = wincnc_settings(ex.machine)
    most = {"P": controls.positions, "H": controls.homes, "T": controls.tool_positions}[letter]
    if number < 0 or (most is not None and number > most):
        raise Refusal(codes.STORED_POSITION_MISSING.at(line.where(letter), word=f"{letter}{number}"))
    place = stored_in(ex, f"{letter}{number}")
    if place is None:
        lose_places(ex)
        hint = f"[positions.{letter}{number}] of the setup states it"
        if letter == "T" and line.command is None:
            hint += "; a tool change that a post wrote needs a macro in CNC.MAC"
        what = f"the stored position {letter}{number}, which no setup states,"
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.where(letter), code=what, hint=hint))
    places, lift = place
    target = list(s.position)
    words = mapped(ex, line)
    for column, where in places:
        if not words or column in words:
            target[column] = where if column not in words else _bounded(ex, column, words[column], where)
    for column in words.keys() - {column for column, _ in places}:
        target[column] = NOWHERE
    target = follow(ex, target, line.span)
    turn_unsettled(s, words or (axis for axis, _ in places))
    if lift:
        heads = vertical_axes(ex.machine)
        over_heads(ex, line, target, heads, _clearance(ex, f"{letter}{number}"))
        for column in set(heads) - words.keys() if words else ():
            # A head that is not named: whether it comes down again behind the lift is not said.
            top = ex.machine.axis(AXIS_NAMES[column])
            is_known = top is not None and top.upper is not None and column not in dict(s.single.zeros)
            high = max(0.0, top.upper) if is_known and top is not None and top.upper is not None else math.inf
            s.position[column] = _up_to(ex, column, target[column], high)
            s.jumped = True
        return True
    if op is Op.FEED:
        use_feed(ex, line, target)
    ex.move(op, target, line.span)
    ex._moved = True
    return True


def _up_to(ex: Motion, column: int, place: Position, high: float) -> Position:
    """Anywhere between a place and machine position ``high`` above it."""
    if place.form or place.value >= high:
        return NOWHERE if place.form else place
    return ex.unknown_place("value", column, (0.0, high - place.value), place)


def stored_in(ex: Motion, name: str) -> tuple[tuple[tuple[int, Position], ...], bool] | None:
    """Places by column under a name such as P4, and whether heads are lifted on the way; of the job, else the setup."""
    for known, places, lift in ex.modal.single.places:
        if known == name:
            return _from_zero(ex, places), lift
    if name[0] == "H" and REGISTERS_OPEN in ex.modal.single.flags:
        return tuple((axis.index, NOWHERE) for axis in ex.machine.axes), False
    stated = ex.setup.positions.get(name)
    if stated is None:
        return None
    places = tuple((AXIS_NAMES.index(axis), Position(value)) for axis, value in stated.axes.items())
    return _from_zero(ex, places), stated.lift


def _from_zero(ex: Motion, places: tuple[tuple[int, Position], ...]) -> tuple[tuple[int, Position], ...]:
    """Stored numbers as places: they count from machine zero, wherever L28 has moved it."""
    single = ex.modal.single
    return tuple((axis, place.plus(machine_zero(single, axis))) for axis, place in places) if single.zeros else places


def _clearance(ex: Motion, name: str) -> float | None:
    """The machine height to which the setup lifts heads on their way; None where it says none, or the job stores it."""
    stated = ex.setup.positions.get(name)
    own = any(known == name for known, _, _ in ex.modal.single.places)
    return None if stated is None or own else stated.clearance


def lifted(ex: Motion, line: Command, rule: CodeRule) -> None:
    """G0.1: vertical heads up, over, down to where they were."""
    note_assumptions(ex, line.span)
    target = aim(ex, line)
    heads = vertical_axes(ex.machine)
    if any(axis in heads for axis in mapped(ex, line)):
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.span, code=f"{rule.text} with a vertical axis"))
    over_heads(ex, line, target, heads)


def over_heads(
    ex: Motion, line: Command, target: list[Position], heads: tuple[int, ...], clearance: float | None = None
) -> None:
    """Heads up; over; and down to where the target has them. Locked ones stay.

    clearance: machine height to which they go up, those that are above it stay there; None: how far is not said.
    """
    s = ex.modal
    locked = s.single.locked
    tell_held_back(ex, [NOWHERE if n in heads and n in locked else at for n, at in enumerate(s.position)], line.span)
    up, over = list(s.position), list(target)
    for axis in (axis for axis in heads if axis not in locked):
        there = ex.machine.axis(AXIS_NAMES[axis])
        top = math.inf if there is None or there.upper is None else max(0.0, there.upper)
        low = s.position[axis].value
        known = not s.position[axis].form and not target[axis].form
        if known and clearance is not None:
            up[axis] = over[axis] = Position(max(low, clearance))
            continue
        up[axis] = over[axis] = (
            ex.unknown_place("value", axis, (low, max(low, top)), Position(0.0)) if known else NOWHERE
        )  # fmt: skip
    own_way(ex, [NOWHERE if n in heads and n not in locked else at for n, at in enumerate(up)], line.span, frozenset())
    for place_of_all in (up, over, target):
        ex.move(Op.TRAVERSE, list(place_of_all), line.span)
    ex._moved = True


def machine_traverse(ex: Motion, line: Command, rule: CodeRule) -> None:
    """G53: rapid in machine coordinates; alone it lifts all vertical axes to machine zero."""
    note_assumptions(ex, line.span)
    switch_output(ex, line, cutting=False)
    if stored_place(ex, line, Op.TRAVERSE, machine=True):
        return
    s = ex.modal
    if line.axes():
        target = aim(ex, line, machine=True)
        turn_unsettled(s, mapped(ex, line))
    else:
        target = list(s.position)
        for axis in vertical_axes(ex.machine):
            target[axis] = machine_zero(s.single, axis)
        target = follow(ex, target, line.span)
    ex.move(Op.TRAVERSE, target, line.span)
    ex._moved = True


# ---- arcs


def arc(ex: Motion, line: Command, rule: CodeRule) -> None:
    """G2 and G3 in X and Y; what else the line names moves along evenly."""
    note_assumptions(ex, line.span)
    s = ex.modal
    controls = wincnc_settings(ex.machine)
    if controls.arcs_modal:
        s.motion = int(rule.function)
        s.cycle, s.cycle_code = {}, 0
    if "compensation" in s.single.flags:
        raise Refusal(codes.ARC_UNKNOWN.at(line.span, cause="how much it is compensated (G41, G42)"))
    moved = set(mapped(ex, line))
    if "mapped" in s.single.flags:
        raise Refusal(codes.ARC_MAPPED.at(line.span, code="L11"))
    if LEANING in s.single.flags:
        raise Refusal(codes.ARC_LEANING_KNIFE.at(line.span))
    if s.transform.factors != (1.0, 1.0):
        raise Refusal(codes.ARC_SCALED.at(line.span, axes="X or Y", code="G51"))
    if not moved & {3, 4, 5} and not controls.helical_arcs and moved & {2}:
        raise Refusal(codes.HELIX_NOT_SUPPORTED.at(line.span, axes="Z"))
    if "K" in line.values and (not {"I", "J"} <= line.values.keys() or line.number("K")):
        # With I and J beside it a K of 0 says nothing; else it may be the centre of an arc in another plane.
        _keep_words(s, line)
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.where("K"), code=f"K of {rule.text}, an arc in another plane,"))
    target = aim(ex, line)
    turns = 1 if rule.function is F.ARC_CCW else -1
    start, end = (s.position[0], s.position[1]), (target[0], target[1])
    for a, b, name in zip(start, end, "XY", strict=True):
        difference = b.minus(a)
        if difference.form:
            _keep_words(s, line)
            raise Refusal(codes.ARC_UNKNOWN.at(line.span, cause=f"{name}: {describe(difference.form)}"))
    center = _center(ex, line, rule, start, end, moved)
    same = all(abs(a.value - b.value) < SAME for a, b in zip(start, end, strict=True))
    radius = distance(center[0] - start[0].value, center[1] - start[1].value)
    if radius < ZERO_RADIUS:
        raise Refusal(codes.ARC_RADIUS_ZERO.at(line.span))
    at_end = distance(center[0] - end[0].value, center[1] - end[1].value)
    if abs(at_end - radius) > s.arc_tolerance() + SAME:
        raise Refusal(
            codes.ARC_RADIUS_MISMATCH.at(
                line.span, start=radius, end=at_end, off=abs(at_end - radius), allowed=s.arc_tolerance(), unit="mm",
                hint="the controller stops with Arc Radius; arc_err= of its settings is what it allows",
            )
        )  # fmt: skip
    if same:
        target[0], target[1] = start
        if moved & {0, 1}:
            ex.findings.add(codes.ARC_FULL_CIRCLE.at(line.span))
    if s.feed_mode == 93:
        s.feed = math.nan
        s.feed_mode = 94
        try:
            _make(ex, line, target, center, radius, turns)
        finally:
            s.feed_mode = 93
        return
    _arc_feed(ex, line, moved | {0, 1})
    _make(ex, line, target, center, radius, turns)


def _arc_feed(ex: Motion, line: Command, moved: set[int]) -> None:
    """F of arcs is kept apart from that of lines (Feed Velocity); without one of either kind, where both agree."""
    s = ex.modal
    share = wincnc_settings(ex.machine).arcs_share_feed
    value = line.values.get("F")
    if share:
        feed_word(ex, line, moved)
        s.feed = agreed(s.single.feeds, 0, 3, 3)
    elif value is not None:
        if not isinstance(value, Unknown) and value <= 0:
            raise Refusal(codes.ILLEGAL_VALUE.at(line.where("F"), word="F", what=f"a feed of {value:g}"))
        s.feed = math.nan if isinstance(value, Unknown) else value * s.unit
        s.single = s.single.but(arc_feed=s.feed, feed_doubt=share is None and s.single.feeds[:2] != (s.feed, s.feed))
    else:
        own = usual_feed(ex) if s.single.arc_feed is None else s.single.arc_feed
        alike = share is False or (s.single.feeds[0] == own and s.single.feeds[1] == own)
        s.feed = own if alike else math.nan
    s.feed_unit = 1.0


def usual_feed(ex: Motion) -> float:
    """mm/min of X before a program gives another; NaN where no file says it."""
    axis = ex.machine.axis("x")
    return math.nan if axis is None or axis.feed_velocity is None else axis.feed_velocity * 60.0


def _make(
    ex: Motion, line: Command, target: list[Position], center: list[float], radius: float, turns: int
) -> None:  # fmt: skip
    s = ex.modal
    switch_output(ex, line, cutting=True)
    smallest = wincnc_settings(ex.machine).smallest_arc
    if smallest is not None and radius < smallest:
        closed = all(abs(target[axis].value - s.position[axis].value) < SAME for axis in (0, 1))
        hint = "the arc is a full circle, so nothing of it is cut" if closed else ""
        ex.findings.add(codes.ARC_UNDER_MINIMUM.at(line.span, radius=radius, allowed=smallest, unit="mm", hint=hint))
        if s.feed_mode != 93:
            use_feed(ex, line, target, {0, 1})
        ex.move(Op.FEED, target, line.span)
    else:
        whole = [center[0], center[1], ex.modal.position[2].value]
        ex.move(Op.ARC, target, line.span, center=whole, turns=turns, plane=Plane.XY)
    ex._moved = True


def _keep_words(s: Modal, line: Command) -> None:
    """I and J that a later arc counts with, of an arc that nobody can follow."""
    given = [line.values.get(letter) for letter in "IJ"]
    if "R" in line.values:
        s.single = s.single.but(center=(math.nan, math.nan))
    elif given != [None, None]:
        i, j = (value * s.unit if isinstance(value, float) else math.nan for value in given)
        s.single = s.single.but(center=(math.nan, math.nan) if math.isnan(i + j) else (i, j))


def _center(
    ex: Motion, line: Command, rule: CodeRule, start: tuple[Position, Position], end: tuple[Position, Position],
    moved: set[int],
) -> list[float]:  # fmt: skip
    s = ex.modal
    if any(isinstance(line.values.get(letter), Unknown) for letter in "IJR"):
        _keep_words(s, line)
    given = {letter: line.number(letter) for letter in "IJ" if letter in line.values}
    if "R" in line.values:
        if given:
            raise Refusal(codes.UNUSED_WORD.at(line.where("R"), word="R beside a centre"))
        radius = line.number("R") or 0.0
        if radius <= 0.0:
            raise Refusal(codes.ILLEGAL_VALUE.at(line.where("R"), word="R", what=f"a radius of {radius:g}"))
        radius *= s.unit
        x, y, bad = k.radius_center(
            start[0].value, start[1].value, end[0].value, end[1].value, radius, int(rule.function is F.ARC_CCW)
        )
        if bad == k.RADIUS_SAME_POINT:
            raise Refusal(codes.ARC_SAME_POINT.at(line.span))
        chord = math.hypot(end[0].value - start[0].value, end[1].value - start[1].value)
        if bad == k.RADIUS_UNREACHABLE:
            raise Refusal(codes.ARC_UNREACHABLE.at(line.where("R"), chord=chord, radius=radius, unit="mm"))
        warning = radius_arc_warning(line.span, chord, radius, s.unit != 1.0)
        if warning is not None:
            ex.findings.add(warning)
        # Whether R leaves the I and J before it, those of its own centre, or none is not told.
        s.single = s.single.but(center=(math.nan, math.nan))
        return [x, y]
    kept = s.single.center
    if not given:
        if kept is None:
            raise Refusal(codes.ARC_CENTER_MISSING.at(line.span, code=rule.text, needed="I and J, or R"))
        if math.isnan(kept[0]):
            raise Refusal(codes.ARC_UNKNOWN.at(line.span, cause="I and J of an arc before, which are not known"))
        i, j = kept
    else:
        values = []
        for n, letter in enumerate("IJ"):
            value = given.get(letter)
            if value is None:
                if kept is not None and not abs(kept[n]) <= SAME:
                    other = f"{letter} left out: that of the arc before, or 0"
                    _keep_words(s, line)
                    raise Refusal(codes.ARC_UNKNOWN.at(line.span, cause=other))
                value = 0.0
                if kept is None:
                    ex.assumed["no I or J is kept from the job before"] = None
                if ex.machine.controller.absolute_arc_centers:
                    raise Refusal(codes.ARC_UNKNOWN.at(line.span, cause=f"{letter} left out with absolute centres on"))
            values.append(value * s.unit)
        i, j = values
        s.single = s.single.but(center=(i, j))
    if ex.machine.controller.absolute_arc_centers:
        places = [s.offset(axis).moved(value) for axis, value in ((0, i), (1, j))]
        if s.transform.on:
            places = list(s.transform.absolute((i, j), (start[0], start[1]), (s.offset(0), s.offset(1))))
        for place, at in zip(places, start, strict=True):
            if place.form != at.form:
                raise Refusal(codes.ARC_UNKNOWN.at(line.span, cause=describe(place.minus(at).form)))
        return [places[0].value, places[1].value]
    if s.transform.on:
        i, j = s.transform.step(i, j)
    return [start[0].value + i, start[1].value + j]


HANDLERS: dict[F, Handler] = {
    F.TRAVERSE: straight,
    F.FEED: straight,
    F.ARC_CW: arc,
    F.ARC_CCW: arc,
    F.TRAVERSE_LIFTED: lifted,
    F.MACHINE_TRAVERSE: machine_traverse,
}
