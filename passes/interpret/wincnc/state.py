"""The state that controllers of one command a line have beside the one of all: feeds by group, heads, switches.

Source: WinCNC Users Guide, Command Reference; docs/dialects/wincnc.md says how open questions are read. Values are
immutable; a change is a new ``SingleState``.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from gproof.ir import codes
from gproof.ir.dialects.wincnc_settings import wincnc_settings
from gproof.ir.finding import Refusal, Span
from gproof.ir.machine import AXES, AXIS_NAMES, AxisKind, Machine
from gproof.ir.record import record
from gproof.ir.settings import Workspace
from gproof.ir.symbolic import NOWHERE, Position, Unknown, Value
from gproof.ir.trace import UNMEASURED, Boundary, ToolDiameter

if TYPE_CHECKING:
    from gproof.passes.interpret.core.modal_state import Modal
    from gproof.passes.interpret.core.trace_writer import Emitter

TURNING = 3
"""Type of a workspace whose spindle turns (WinCNC g54= T)."""
COUPLING_OPEN = "coupling open"
"""Flag: which axes follow which (L13), and how far, is not known for certain."""
REGISTERS_OPEN = "registers open"
"""Flag: nobody knows what H registers hold that the job has not written since."""
TURN_SETTLED = "turn settled"
"""Flag: the place of X and Y in the program is the same in all readings, though G52 turns them."""
STILL = Position(0.0)
LEANING = "leaning knife"
"""Flag: a knife is on whose blade leans."""

Pairs = tuple[tuple[int, Value], ...]
Scaling = tuple[float, float, Position]
UNSCALED: Scaling = (1.0, 0.0, Position(0.0))
"""Of an axis: factor, mm about which, and the offset under which that was said."""


@record(frozen=True, slots=True)
class KnifeNow:
    """Settings in force (L30.1): degrees beyond which it is lifted, mm up and down; None: nobody said."""

    angle: float | None
    lifted: float | None
    lowered: float | None


@record(frozen=True, slots=True, kw_only=True)
class SingleState:
    """Columns are those of ``AXIS_NAMES``; lengths mm.

    feeds: by column, mm/min or deg/min, NaN: nobody said. center: I and J of the last arc, None before the first.
    unit_before: of G23. local_stored: what G92.3 took away. homes: by column, what L3 stored. unmeasured: columns
    whose tool measure is off (G49). lower, upper: boundaries now, None: none. soft, bound: soft limits and boundaries
    are checked. outputs, virtual: states of channels that are known; tools: number of the tool in changer 1 and 2.
    sources: by column, the letter's column whose words move it (L11, L12). slaves: (column that
    follows, column) (L13). locked: columns (L300), held_back: those to which a move was given since then.
    arguments: words of the call that runs. keep_local: L92 was met.
    absolute_once: of the line that runs, None: as the mode. touched: columns that stand at a limit switch. flags:
    names of devices that are on.
    heights: measures stored by tool number; switch_heights: TM1 and TM2; before: measures that G49 put aside.
    arc_feed: mm/min of arcs, None before their first F; feed_doubt: an arc had an F since the last one of lines in X
    and Y, another one; scales: (column, Scaling) of axes beside X and Y (G51), a factor of NaN: open; places: stored
    positions as (name, places by column, whether heads are lifted); auto_dwell: seconds behind switching the automatic
    output on and off. knife: its settings now, None: those of the machine's file; spans: ((column, low, high), place)
    of places between two readings. unworn: tools of the library that L500.2 gave one diameter, nominal and actual, and
    nothing to compensate; diameters: those that it gave. kept_feeds: (unit, feeds, arc_feed) before the unit changed,
    which come back with it. reference: what positions had more than the tip of the tool of
    the start when another one came, None before. cell_open: the cell of an array has named no local zero of X and Y
    yet. measured: M37 was used, in the job or before it. zeros: (column, place) of machine zeros that L28 moved, in the
    coordinates of the one before, in which positions go on to count; found: columns whose machine zero the job found at
    a limit switch. drift: (column, way) that followers have gone with their
    leaders, which the controller counts or not. cycle_at: bottom and R of the last hole. retimed, backlash: see
    ``State``.
    """

    feeds: tuple[float, ...] = (math.nan,) * AXES
    center: tuple[float, float] | None = None
    unit_before: float | None = None
    local_stored: tuple[Position, ...] | None = None
    homes: tuple[Position | None, ...] = (None,) * AXES
    unmeasured: frozenset[int] = frozenset()
    lower: tuple[float | None, ...] = (None,) * AXES
    upper: tuple[float | None, ...] = (None,) * AXES
    soft: bool = True
    bound: bool = True
    outputs: Pairs = ()
    virtual: Pairs = ()
    tools: tuple[Value, Value] = (Unknown("the tool in changer 1"), Unknown("the tool in changer 2"))
    sources: tuple[int, ...] = tuple(range(AXES))
    slaves: tuple[tuple[int, int], ...] = ()
    locked: frozenset[int] = frozenset()
    held_back: frozenset[int] = frozenset()
    arguments: tuple[tuple[str, Value], ...] = ()
    keep_local: bool = False
    absolute_once: bool | None = None
    touched: frozenset[int] = frozenset()
    flags: frozenset[str] = frozenset()
    heights: tuple[tuple[int, Position], ...] = ()
    switch_heights: tuple[Value, Value] = (Unknown("the height of the measure switch"),) * 2
    before: tuple[Position, ...] | None = None
    arc_feed: float | None = None
    kept_feeds: tuple[float, tuple[float, ...], float | None] | None = None
    feed_doubt: bool = False
    scales: tuple[tuple[int, Scaling], ...] = ()
    places: tuple[tuple[str, tuple[tuple[int, Position], ...], bool], ...] = ()
    auto_dwell: tuple[float, float] = (0.0, 0.0)
    knife: KnifeNow | None = None
    spans: tuple[tuple[tuple[int, float, float], Position], ...] = ()
    unworn: frozenset[int] = frozenset()
    diameters: tuple[ToolDiameter, ...] = ()
    reference: tuple[Position, ...] | None = None
    cell_open: bool = False
    measured: bool = False
    zeros: tuple[tuple[int, Position], ...] = ()
    found: frozenset[int] = frozenset()
    drift: tuple[tuple[int, Position], ...] = ()
    cycle_at: tuple[Position, Position] | None = None
    retimed: frozenset[str] = frozenset()
    backlash: tuple[tuple[int, float], ...] = ()

    def but(self, **changes: Any) -> SingleState:
        """The same with some values changed."""
        return replace(self, **changes)


def with_pair(pairs: Pairs, number: int, value: Value) -> Pairs:
    """One channel changed."""
    return tuple(sorted((*((n, v) for n, v in pairs if n != number), (number, value)), key=lambda pair: pair[0]))


def value_of(pairs: Pairs, number: int) -> Value | None:
    """The state of a channel; None where nobody knows it."""
    return next((value for n, value in pairs if n == number), None)


def letters_of(machine: Machine) -> dict[str, int]:
    """Column of each letter that moves an axis."""
    return {axis.word: axis.index for axis in machine.axes}


def linear_axes(machine: Machine) -> tuple[bool, ...]:
    """By column: whether the axis counts in lengths; X, Y and Z where there is no such axis."""
    kinds = {axis.index: axis.kind is AxisKind.LINEAR for axis in machine.axes}
    return tuple(kinds.get(n, n < 3) for n in range(AXES))


SAME_PLACE = 1e-9
"""mm or degrees: less is no move."""


def vertical_axes(machine: Machine) -> tuple[int, ...]:
    """Columns of the axes that carry heads up and down."""
    return tuple(
        axis.index
        for axis in machine.axes
        if (axis.vertical if axis.vertical is not None else axis.word in "ZWUV" and axis.kind is AxisKind.LINEAR)
    )


def followed(single: SingleState, position: list[Position], target: list[Position]) -> list[Position]:
    """The target with what follows other axes step by step (L13), and without what is locked (L300).

    While a cutter is compensated by an amount other than 0, nobody knows where X and Y go.
    """
    target = list(target)
    if "compensation" in single.flags:
        target[:2] = [NOWHERE, NOWHERE]
    for axis, leader in single.slaves:
        way = STILL if leader in single.locked else target[leader].minus(position[leader])
        is_open = COUPLING_OPEN in single.flags and way != STILL
        target[axis] = NOWHERE if is_open else position[axis].plus(way)
    for axis in single.locked:
        target[axis] = position[axis]
    return target


def own_way(ex: Emitter, target: list[Position], span: Span, named: frozenset[int]) -> None:
    """Refusal GP113 for a follower (L13) that is sent somewhere itself: whether it goes, and how far, is not said.

    named: columns of the line's words.
    """
    s = ex.modal
    for axis, leader in s.single.slaves:
        if target[axis] != s.position[axis] or (axis in named and target[leader] != s.position[leader]):
            what = f"a move of {ex.machine.word(axis)}, which follows {ex.machine.word(leader)} (L13),"
            raise Refusal(codes.UNSUPPORTED_CODE.at(span, code=what))


def went_along(s: Modal, target: list[Position], named: frozenset[int]) -> list[int]:
    """Columns that are sent to a place and have followed another axis: where they go then rests on what is counted.

    A command without words for an axis sends it to a place of the machine.
    """
    absolute = s.absolute if s.single.absolute_once is None else s.single.absolute_once
    return [
        axis for axis, _ in s.single.drift if (absolute if axis in named else target[axis] != s.position[axis])
    ]  # fmt: skip


def drifted(single: SingleState, position: list[Position], target: list[Position]) -> SingleState:
    """The state behind a move: how far followers went with their leaders."""
    ways = dict(single.drift)
    for axis, _ in single.slaves:
        way = ways.get(axis, STILL).plus(target[axis].minus(position[axis]))
        ways[axis] = STILL if not way.form and abs(way.value) < SAME_PLACE else way
    return single.but(drift=tuple(sorted((axis, way) for axis, way in ways.items() if way != STILL)))


def tell_held_back(ex: Emitter, target: list[Position], span: Span) -> None:
    """GP200 at the first move of each axis since L300 locked it."""
    s = ex.modal
    if not s.single.locked - s.single.held_back:
        return
    target = followed(s.single.but(locked=frozenset()), s.position, target)
    for axis in sorted(s.single.locked - s.single.held_back):
        wanted, there = target[axis], s.position[axis]
        if wanted.form == there.form and abs(wanted.value - there.value) < SAME_PLACE:
            continue
        s.single = s.single.but(held_back=s.single.held_back | {axis})
        what = f"{ex.machine.word(axis)} is locked (L300), and from here on moves of it are programmed"
        ex.findings.add(codes.COMMAND_IGNORED.at(span, what=what, hint="L301 unlocks it"))


def turned_shift(space: Workspace, axis: int) -> tuple[float, float] | None:
    """Between what a turning spindle (g54= T3) shifts X or Y, mm, whatever is meant by its shift and its radius.

    Where the tool stands as the spindle turns is a place on a circle; counted from the circle's middle it is at most R
    away, counted from where it stands at 0 degrees at most 2 R, and the file's shift may count either way. None: not
    bounded.
    """
    if space.kind != TURNING or space.radius is None:
        return None
    most = abs((space.x, space.y)[axis]) + 2.0 * abs(space.radius)
    return -most, most


def turning(space: Workspace | None) -> str:
    """What of a workspace that turns, or is told to turn, the manual does not say."""
    if space is None or not space.kind:
        return "with X and Y, which only workspaces of type 3 have,"
    if space.kind == TURNING:
        return "of type 3 (which axis turns, about what X and Y are seen, whether they move, and what R adds to them)"
    return "of type 5 (two points of rotation: the manual has no more than these words)"


def machine_zero(single: SingleState, axis: int) -> Position:
    """Where the controller's machine zero of an axis lies: 0 unless L28 moved it."""
    return next((place for column, place in single.zeros if column == axis), STILL)


def _moved_limits(modal: Modal) -> list[Boundary]:
    """The soft limits of axes whose machine zero L28 moved: they count from there (Soft Limit / Boundaries: lolim=).

    Without ends where none count: they still say where machine zero is.
    """
    found = []
    for axis, zero in modal.single.zeros:
        there = modal.machine.axis(AXIS_NAMES[axis])
        if there is not None:
            ends = (there.lower, there.upper) if modal.single.soft else (None, None)
            found.append(Boundary(axis, *ends, zero.value, zero.form, limit=True))
    return found


def boundaries_of(modal: Modal) -> tuple[Boundary, ...]:
    """The boundaries that rows carry: they move with workspace and tool measure, not with local coordinates."""
    single = modal.single
    found = []
    for axis, (low, high) in enumerate(zip(single.lower, single.upper, strict=True)):
        if low is not None or high is not None:
            base = modal.work_offsets[modal.work, axis].plus(modal.beside_work(axis))
            found.append(Boundary(axis, low, high, base.value, base.form))
    return (*found, *_moved_limits(modal))


def prepare(modal: Modal) -> None:
    """The start of a job on such a controller."""
    machine, setup = modal.machine, modal.setup
    controls = wincnc_settings(machine)
    modal.unit = machine.unit
    modal.absolute = controls.absolute is not False
    zero = Position(0.0)
    shifts = {space.number - 53: space for space in controls.workspaces}
    for (number, axis), _ in list(modal.work_offsets.items()):
        space = shifts.get(number)
        shift = (space.x, space.y)[axis] if space is not None and axis < 2 else 0.0
        sign = controls.shift_sign
        turns = space is not None and space.kind and (axis < 2 or not modal.linear[axis])
        if turns or (shift != 0.0 and sign is None):
            modal.work_offsets[number, axis] = NOWHERE
        else:
            modal.work_offsets[number, axis] = Position(shift * (sign or 1)) if shift else zero
    modal.work = modal.work or 1
    for axis in vertical_axes(machine):
        if setup.default_offset is None:
            modal.tool_offset[axis] = modal._symbol(f"tool.0.{AXIS_NAMES[axis]}")
    if setup.default_offset is None and 2 not in vertical_axes(machine):
        modal.tool_offset[2] = zero
    feeds = [math.nan] * AXES
    lower: list[float | None] = [None] * AXES
    upper: list[float | None] = [None] * AXES
    for known in machine.axes:
        if known.feed_velocity is not None:
            feeds[known.index] = known.feed_velocity * 60.0
        lower[known.index], upper[known.index] = known.boundary_lower, known.boundary_upper
    tool: Value = Unknown("the tool in the spindle") if setup.tool is None else float(setup.tool)
    on = controls.soft_limits is not False
    flags = frozenset({"autoaux"} if controls.auto_output_on else ())
    modal.single = SingleState(
        feeds=tuple(feeds), lower=tuple(lower), upper=tuple(upper), tools=(tool, Unknown("the tool in changer 2")),
        soft=on, bound=on, flags=flags, auto_dwell=controls.auto_dwell, measured=bool(setup.measures),
    )  # fmt: skip
    modal.guards_off = guards_now(modal)


def guards_now(modal: Modal) -> tuple[str, ...]:
    """The guards that are off, as rows carry them."""
    single = modal.single
    names = []
    if not single.bound:
        names.append("boundaries")
    if not single.measured and any(single.lower[axis] is not None for axis in vertical_axes(modal.machine)):
        # Low boundaries of vertical axes are there once M37 is used (Soft Limit / Boundaries).
        names.append(UNMEASURED)
    if not single.soft:
        names.append("machine_area")
    return tuple(names)


def arm_low_boundaries(modal: Modal) -> None:
    """A tool is measured (M37), or a stored measure is in force: low boundaries of vertical axes count."""
    if not modal.single.measured:
        modal.single = modal.single.but(measured=True)
        modal.guards_off = guards_now(modal)
