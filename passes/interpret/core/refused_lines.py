"""A line that is refused or not understood loses what it may have changed: one rule for all languages.

Words that were read say by the table of ``ir/modal_groups.py`` which modal groups they may have changed; a text that
was not understood may have been anything. What rests on such a group is not known from there on: places, feeds,
speeds. Codes that state a group whole make it known again. The refused line is reported itself; after an unknown one
the first move that rests on it is GP304, once; after an error nothing is, as no controller comes there, unless somebody
accepts the error.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir import modal_groups as g
from gproof.ir.finding import Finding, FollowedRefusal, Refusal, Related, Severity, Span
from gproof.ir.machine import AXES
from gproof.ir.rules import CodeRule, LanguageRules
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import NOWHERE, Position, Unknown, Value
from gproof.ir.trace import KNIFE, UNKNOWN, Op, Plane
from gproof.passes.interpret.core.parsed_line import LARGEST
from gproof.passes.interpret.core.plane_transform import NO_TRANSFORM

if TYPE_CHECKING:
    from gproof.passes.interpret.core.modal_state import Modal
    from gproof.passes.interpret.core.parsed_line import Line
    from gproof.passes.interpret.core.run import Run

_STRAIGHT = frozenset((F.TRAVERSE, F.FEED))
LOST_MOTION = CodeRule(letter="G", tenths=0, function=F.UNSUPPORTED, group="", source="")
"""The motion that is in force after a refused line that may have changed it."""
_ALL = frozenset(range(AXES))
Words = Sequence[tuple[str, Value, Span]]


def rules_of(rules: LanguageRules, words: Words) -> list[CodeRule] | None:
    """The codes of a line that was read to its end; None where one of its words is no word of the language."""
    found: list[CodeRule] = []
    code_letters = rules.code_letters
    for letter, value, _ in words:
        if letter not in code_letters:
            continue
        if isinstance(value, Unknown) or abs(value) > LARGEST:
            return None
        known = rules.codes.get((letter, round(value * 10)))
        if known is None or abs(value * 10 - round(value * 10)) > 1e-3:
            return None
        found.append(known)
    return found


def refuse_words(
    run: Run, words: Words, columns: dict[str, int], refusal: Refusal, finding: Finding,
    aim: Callable[[], list[Position]] | None = None,
) -> None:  # fmt: skip
    """After a refused line of these words: lost is what they may have changed.

    columns: of the letters that are axes; finding: what is reported of the refusal, an unknown for an error that
    somebody accepts; aim: gives where the line sends the axes: an arc of which only the path is open ends there.
    """
    if isinstance(refusal, FollowedRefusal):
        _name_line(run, finding)
        return
    # An error is lost as in the run that found it, where somebody accepts it: what follows has the same findings then.
    if aim is not None and finding.code.decides == "arcs" and refusal.finding.severity is Severity.UNKNOWN:
        s = run.modal
        with contextlib.suppress(Refusal):
            place = aim()
            s.jumped = s.jumped or place != s.position
            s.position = place
            if s.compensation is None:
                return
    found = rules_of(run.program.rules, words)
    axes = {columns[letter] for letter, _, _ in words if letter in columns}
    letters = {letter for letter, _, _ in words}
    lose_line(run, found, letters, axes, finding)


def lose_line(
    run: Run, found: Iterable[CodeRule] | None, letters: Iterable[str], axes: Iterable[int], finding: Finding
) -> None:
    """The same for codes that are known already; found: None where a word does not belong to the language."""
    functions = None if found is None else [rule.function for rule in found]
    groups = None if functions is None else g.changed_by(functions)
    if groups is None or functions is None:
        lose_everything(run, finding)
        return
    named = frozenset(axes)
    letters = set(letters)
    if letters & run.dialect.stored_places and all(f in g.MOVES for f in functions):
        named = _ALL  # a stored position
    groups |= {g.PLACE} if named and not any(map(_takes_axes, functions)) else set()
    # Words alone are those of the motion or the cycle in force.
    groups |= {g.PLACE} if not functions and letters - set("FST@N") else set()
    groups |= {g.FEED} if "F" in letters else set()
    groups |= {g.SPEED} if "S" in letters else set()
    groups |= {g.TOOL} if "T" in letters else set()
    moves = [function for function in functions if g.PLACE in g.CHANGES[function]]
    whole = any(function not in _STRAIGHT | {F.MACHINE_TRAVERSE} for function in moves) or not named
    whole = whole or run.modal.cycle_code != 0 or run.modal.motion not in (0, *map(int, _STRAIGHT))
    lose(run, groups, finding, _ALL if whole else named | ({0, 1} if run.modal.transform.on else set()))


def _takes_axes(function: F) -> bool:
    """Whether axis words next to a code of this function are its own, and send nothing anywhere."""
    return function in _OWN_WORDS


_OWN_WORDS = frozenset((
    F.SET_COORDINATES, F.SCALING_ON, F.ROTATION_ON, F.AXIS_OFFSET_SET, F.LOCAL_SET, F.LOCAL_SHIFT,
    F.LOCAL_SHIFT_MACHINE,
    F.ZERO_OFFSET_SET, F.POSITION_FACTOR, F.EFFECTIVE_RADIUS, F.INTERPOLATION_AXES, F.LIMIT_LEFT, F.LIMIT_RIGHT,
    F.LOW_BOUNDARY, F.HIGH_BOUNDARY, F.LOW_BOUNDARY_RESTORE, F.HIGH_BOUNDARY_RESTORE, F.MAP_WORDS, F.MAP_HEADS,
    F.MAP_PULSES, F.LOCK_AXIS, F.UNLOCK_AXIS, F.TOOL_OFFSET_ON, F.TOOL_OFFSET_OFF, F.MEASURE_TOOL, F.SHIFT_MEASURES,
    F.STORE_POSITION, F.STORE_LOCAL_POSITION, F.STORE_HOME, F.STORE_TOOL, F.DYNAMICS, F.BACKLASH, F.DWELL,
    F.FEED_ROTARY, F.LIMITS_ON, F.LIMITS_OFF,
))  # fmt: skip


def lose_everything(run: Run, finding: Finding) -> None:
    """After a text that nobody understands: all that a code of the language can change.

    Variables stay after an error: what they would decide is a path that no controller takes, and its own errors show.
    """
    lost = g.everything(run.program.rules)
    lose(run, lost - {g.VARIABLES} if finding.severity is Severity.ERROR else lost, finding, _ALL)


def lose(run: Run, groups: Iterable[str], finding: Finding, axes: frozenset[int] = _ALL) -> None:
    """These groups are not known from here on; axes: columns whose places are lost with ``place``."""
    s = run.modal
    lost = frozenset(groups)
    forget(s, lost, axes, finding.span)
    s.line_lost = True
    run.state_changed()
    if lost & (g.OF_PLACES | {g.PLACE}):
        _name_line(run, finding)


def _name_line(run: Run, finding: Finding) -> None:
    """The next move that rests on a lost place is reported with this line; not after an error, nor where the line's own
    finding says that places are not known."""
    if finding.severity is not Severity.ERROR and finding.code.decides != "limits":
        run.modal.refused_at = run.modal.refused_at or finding.span


def forget(s: Modal, lost: frozenset[str], axes: frozenset[int], span: Span) -> None:
    """Leave nothing of these groups in the state."""
    cause = f"line {span.line}, which was refused"
    if lost & {g.PLACE, g.TOOL} and s.has_offset_path:
        lost |= {g.RADIUS}  # where its contour goes on is lost
    if g.PLACE in lost or lost & g.OF_PLACES:
        gone = axes if g.PLACE in lost else frozenset[int]()
        if lost & g.OF_PLACES == {g.RADIUS}:
            gone |= {0, 1} if s.plane is Plane.XY else {0, 1, 2}
        elif lost & g.OF_PLACES:
            gone = _ALL
        s.position = [NOWHERE if axis in gone and s.has_axis(axis) else place for axis, place in enumerate(s.position)]
        s.jumped = True
    if g.MOTION in lost:
        s.cycle, s.cycle_code = {}, 0
    s.forget(lost, cause)
    if g.FEED in lost:
        s.feed = math.nan
    if g.SPEED in lost:
        s.spindle_speed = Unknown(cause)
    if g.SPINDLE in lost:
        s.stated.discard("spindle")
    if g.TOOL in lost:
        s.tool = s.selected_tool = s.length_tool = s.offset_tool = None
    if g.OVERRIDE in lost:
        s.feed_override, s.speed_override_known = math.nan, False
    if lost & {g.ROTATION, g.SCALING}:
        s.transform = NO_TRANSFORM
    if g.RADIUS in lost:
        s.compensation = None
    if g.KNIFE in lost:
        s.following = tuple(name for name in s.following if name != KNIFE)
    if g.GUARDS in lost:
        s.guards_off = ()
    if g.VARIABLES in lost:
        s.parameters.update({number: Unknown(cause) for number in s.parameters})
        s.lost = s.lost or cause
    s.unknown_modes |= lost & g.TRACKED


# ---- lines after it


def is_stated(rule: CodeRule, has_axes: bool) -> bool:
    """Whether a code says it all by itself: what it does rests on no group that sets what words are measured in."""
    function = rule.function
    if function not in g.STATES:
        return False
    return not (rule.uses_axes and has_axes) or not g.STATES[function] or function in g.WITH_WORDS


def restate(run: Run, rules: Iterable[CodeRule], has_axes: bool) -> None:
    """Codes of a line that is executed: the groups that they state whole are known again."""
    s = run.modal
    for rule in rules if s.unknown_modes else ():
        if rule.function in g.MOVES:
            s.unknown_modes -= {g.MOTION}
        elif is_stated(rule, has_axes):
            s.unknown_modes -= set(g.STATES[rule.function])
    if s.compensation is not None:
        s.unknown_modes -= {g.RADIUS}


def settle(s: Modal) -> None:
    """After lines that say all of it again nothing is lost any more."""
    known = not s.unknown_modes and s.refused_at is None
    known = known and all(place.form != UNKNOWN for axis, place in enumerate(s.position) if s.has_axis(axis))
    if known and s.feeds_known:
        s.line_lost = False


def is_lost(run: Run, rule: CodeRule, has_axes: bool, span: Span) -> bool:
    """Whether what a code would change rests on what is lost: then that is lost too."""
    s = run.modal
    if not s.unknown_modes or rule.function in g.MOVES or is_stated(rule, has_axes):
        return False
    changed = g.changed_by((rule.function,))
    if changed is None or not changed - {g.OUTPUTS, g.COOLANT, g.SPINDLE}:
        return False
    forget(s, changed, _ALL, span)
    run.state_changed()
    return True


def words_count(s: Modal, *, machine: bool = False) -> bool:
    """Whether it is known where axis words send a straight move; machine: the words are machine coordinates."""
    return not s.unknown_modes & (g.OF_MACHINE_PLACES if machine else g.OF_PLACES)


def vague(run: Run, line: Line, rule: CodeRule, *, machine: bool = False) -> bool:
    """Make a move whose way rests on what is lost: somewhere. False where the move can be followed.

    rule: of the motion, ``LOST_MOTION`` for one that is not known itself.
    """
    s = run.modal
    if not s.line_lost:
        return False
    function = rule.function
    straight = function in _STRAIGHT or function is F.MACHINE_TRAVERSE
    known = rule is not LOST_MOTION and words_count(s, machine=machine)
    if known and not straight and function not in _TO_STORED:
        known = not s.unknown_modes & g.OF_ARCS
        known = known and all(s.position[axis].form != UNKNOWN for axis in range(3))
    if known:
        restate(run, (rule,), has_axes=True)
        return False
    line.used.update(line.values)
    named = set(line.axes())
    axes = named if straight and named and not s.transform.on else {axis.index for axis in run.machine.axes}
    target = [NOWHERE if axis in axes else place for axis, place in enumerate(s.position)]
    s.compensation = None
    if function not in _RAPID and run.dialect.has_own_feeds:
        s.feed = math.nan  # which of the feeds counts, those axes say that move
    run.move(Op.TRAVERSE if function in _RAPID else Op.FEED, target, line.span)
    run.moved = True
    if rule is LOST_MOTION:
        return True
    if function in _MODAL_MOTIONS:
        # Where the source decides what goes on, nothing of it is kept here.
        s.motion, s.cycle, s.cycle_code = int(function) if run.dialect.keeps_motion else 0, {}, 0
        s.unknown_modes -= {g.MOTION}
    else:
        # A cycle whose words are not all known may be in force.
        s.motion, s.cycle, s.cycle_code = 0, {}, 0
        s.unknown_modes |= {g.MOTION}
    return True


_RAPID = frozenset((F.TRAVERSE, F.TRAVERSE_LIFTED, F.MACHINE_TRAVERSE, F.PARK_1, F.PARK_2))
_MODAL_MOTIONS = frozenset((F.TRAVERSE, F.FEED, F.ARC_CW, F.ARC_CCW))
_TO_STORED = frozenset((F.RETURN_HOME, F.TRAVERSE_LIFTED, F.PARK_1, F.PARK_2))


NAMED = 6
"""This many modes that a line may have changed are named in a hint."""


def tell(run: Run, target: list[Position], span: Span) -> None:
    """GP304 at the first move that rests on a place that a refused line has lost."""
    s = run.modal
    assert s.refused_at is not None
    lost = [axis.word for axis in run.machine.axes if target[axis.index].form == UNKNOWN]
    if not lost:
        if words_count(s):
            s.refused_at = None  # all of it is known again: no move rests on that line any more
        return
    where, s.refused_at = s.refused_at, None
    names = "every axis" if len(lost) == len(run.machine.axes) else " ".join(lost)
    modes = [group for group in g.ORDER if group in s.unknown_modes & g.OF_PLACES]
    shown = ", ".join(modes[:NAMED]) + (f" and {len(modes) - NAMED} more modes" if len(modes) > NAMED else "")
    again = f"program {shown} again; then " if modes else ""
    finding = codes.POSITION_UNKNOWN.at(
        span, axis=names, cause=f"line {where.line}, which gproof cannot follow",
        hint=f"fix that line; or after it: {again}move the axes to a known position",
        related=(Related(where, "this line may have changed it"),),
    )  # fmt: skip
    run.refuse(finding)
