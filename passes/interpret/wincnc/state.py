"""The state that controllers of one command a line have in addition to the one of all: feeds by group, heads, switches.

Source: WinCNC Users Guide, Command Reference; docs/dialects/wincnc.md says how open questions are read. Values are
immutable; a change is a new ``WinCncState``.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from gproof.ir import modal_groups as g
from gproof.ir.dialects.wincnc.settings import wincnc_settings
from gproof.ir.machine import AXES, AXIS_NAMES, Machine
from gproof.ir.record import record
from gproof.ir.rules import LanguageRules
from gproof.ir.settings import Workspace
from gproof.ir.setup import Setup
from gproof.ir.symbolic import NOWHERE, Position, Unknown, Value
from gproof.ir.trace import UNMEASURED, Boundary, TipOffset, ToolDiameter
from gproof.passes.geometry.machine_axes import vertical_axes
from gproof.passes.interpret.core.axis_words import linear_axes
from gproof.passes.interpret.core.channels import Pairs
from gproof.passes.interpret.core.modal_state import Modal
from gproof.passes.interpret.core.run import Run

TURNING = 3
"""Type of a workspace whose spindle turns (WinCNC g54= T)."""
COUPLING_OPEN = "coupling open"
"""Flag: which axes follow which (L13), and how far, is not known for certain."""
REGISTERS_OPEN = "registers open"
"""Flag: what H registers hold is not known where the job has not written them since."""
TURN_SETTLED = "turn settled"
"""Flag: the place of X and Y in the program is the same in all readings, though G52 turns them."""
STILL = Position(0.0)
LEANING = "leaning knife"
"""Flag: a knife is on whose blade leans."""

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
class WinCncState:
    """Columns are those of ``AXIS_NAMES``; lengths mm.

    feeds: by column, mm/min or deg/min, NaN: nobody said. center: I and J of the last arc, None before the first.
    unit_before: of G23. local_stored: what G92.3 took away. homes: by column, what L3 stored. unmeasured: columns
    whose tool measure is off (G49). lower, upper: boundaries now, None: none. soft, bound: soft limits and boundaries
    are checked. virtual: states of virtual inputs that are known; tools: number of the tool in changer 1 and 2.
    sources: by column, the letter's column whose words move it (L11, L12). slaves: (column that
    follows, column) (L13). locked: columns (L300), held_back: those to which a move was given since then.
    arguments: words of the call that runs. keep_local: L92 was met.
    absolute_once: of the line that runs, None: as the mode. touched: columns that are at a limit switch. flags:
    names of devices that are on.
    heights: measures stored by tool number; switch_heights: TM1 and TM2; before: measures that G49 put aside.
    arc_feed: mm/min of arcs, None before their first F; feed_doubt: an arc had an F since the last one of lines in X
    and Y, another one; scales: (column, Scaling) of axes other than X and Y (G51), a factor of NaN: open; places:
    stored positions as (name, places by column, whether heads are lifted); auto_dwell: seconds after switching the
    automatic output on and off. knife: its settings now, None: those of the machine's file; spans: ((column, low,
    high), place) of places between two readings. unworn: tools of the library that L500.2 gave one diameter, nominal
    and actual, and nothing to compensate; diameters: those that it gave. kept_feeds: (unit, feeds, arc_feed) before the
    unit changed, which come back with it. reference: what positions had more than the tip of the tool of the start when
    another one came, None before. cell_open: the cell of an array has named no local zero of X and Y
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

    def but(self, **changes: Any) -> WinCncState:
        """The same with some values changed."""
        return replace(self, **changes)


SAME_PLACE = 1e-9
"""mm or degrees: less is no move."""


def turned_shift(space: Workspace, axis: int) -> tuple[float, float] | None:
    """Between what a turning spindle (g54= T3) shifts X or Y, mm, whatever is meant by its shift and its radius.

    Where the tool is as the spindle turns is a place on a circle; counted from the circle's middle it is at most R
    away, counted from where it is at 0 degrees at most 2 R, and the file's shift may count either way. None: not
    bounded.
    """
    if space.kind != TURNING or space.radius is None:
        return None
    most = abs((space.x, space.y)[axis]) + 2.0 * abs(space.radius)
    return -most, most


def turning(space: Workspace | None) -> str:
    """What of a workspace that turns, or is to turn, the manual does not say."""
    if space is None or not space.kind:
        return "with X and Y, which only workspaces of type 3 have,"
    if space.kind == TURNING:
        return (
            "of type 3 (the manual does not say which axis turns, about which point X and Y count, whether they "
            "move, and what R adds to them)"
        )
    return "of type 5 (two points of rotation: the manual says no more)"


def machine_zero(single: WinCncState, axis: int) -> Position:
    """Where the controller's machine zero of an axis is: 0 unless L28 moved it."""
    return next((place for column, place in single.zeros if column == axis), STILL)


def _moved_limits(modal: WinCncModal) -> list[Boundary]:
    """The soft limits of axes whose machine zero L28 moved: they count from there (Soft Limit / Boundaries: lolim=).

    Without ends where none count: they still say where machine zero is.
    """
    found = []
    for axis, zero in modal.own.zeros:
        there = modal.machine.axis(AXIS_NAMES[axis])
        if there is not None:
            ends = (there.lower, there.upper) if modal.own.soft else (None, None)
            found.append(Boundary(axis, *ends, zero.value, zero.form, limit=True))
    return found


def boundaries_of(modal: WinCncModal) -> tuple[Boundary, ...]:
    """The boundaries that rows carry: they move with workspace and tool measure, not with local coordinates."""
    single = modal.own
    found = []
    for axis, (low, high) in enumerate(zip(single.lower, single.upper, strict=True)):
        if low is not None or high is not None:
            base = modal.work_offsets[modal.work, axis].plus(modal.beside_work(axis))
            found.append(Boundary(axis, low, high, base.value, base.form))
    return (*found, *_moved_limits(modal))


def _lost_of(s: WinCncModal, lost: frozenset[str], cause: str) -> dict[str, object]:
    """What of the state is not known any more when these modal groups are lost."""
    single = s.own
    found: dict[str, object] = {}
    if g.FEED in lost:
        arcs = None if single.arc_feed is None else math.nan
        found |= {"feeds": (math.nan,) * AXES, "arc_feed": arcs, "feed_doubt": True, "kept_feeds": None}
    if lost & {g.PLACE, g.UNITS, g.PLANE}:
        found |= {"center": (math.nan, math.nan), "cycle_at": None}
    if g.UNITS in lost:
        found["unit_before"] = None
    if g.MAPPING in lost:
        found |= {"sources": tuple(range(AXES)), "flags": single.flags - {"mapped"}}
    if g.COUPLING in lost:
        found |= {"slaves": (), "drift": ()}
    if g.LOCKS in lost:
        found |= {"locked": frozenset(), "held_back": frozenset()}
    if g.SCALING in lost:
        found["scales"] = ()
    if g.GUARDS in lost:
        found |= {"soft": True, "bound": True}
    if g.TOOL in lost:
        found["tools"] = (Unknown(cause), Unknown(cause))
    if g.LOCAL in lost:
        found["local_stored"] = None
    if g.MACHINE_ZERO in lost:
        found["zeros"] = tuple((axis.index, NOWHERE) for axis in sorted(s.machine.axes, key=lambda axis: axis.index))
    if g.DYNAMICS in lost:
        found["retimed"] = single.retimed | {cause}
    if g.MEASURES in lost:
        found |= {
            "heights": tuple((number, NOWHERE) for number, _ in single.heights),
            "switch_heights": (Unknown(cause), Unknown(cause)),
            "homes": tuple(None if place is None else NOWHERE for place in single.homes),
            "places": tuple((name, tuple((axis, NOWHERE) for axis, _ in at), lift) for name, at, lift in single.places),
        }  # fmt: skip
    kept = found.get("flags", single.flags)
    assert isinstance(kept, frozenset)
    if g.RADIUS in lost:
        kept -= {"compensation"}
    if g.MEASURES in lost:
        kept |= {REGISTERS_OPEN}
    if kept != single.flags:
        found["flags"] = kept
    return found


class WinCncModal(Modal):
    """The state of a run on such a controller. own: what it keeps in addition to the state of all."""

    own: WinCncState

    def __init__(self, rules: LanguageRules, setup: Setup, machine: Machine) -> None:
        super().__init__(rules, setup, machine)
        self.own = WinCncState()
        prepare(self)

    def _linear_axes(self) -> tuple[bool, ...]:
        return linear_axes(self.machine)

    def beside_work(self, axis: int) -> Position:
        """The offsets of what is in use, whatever the work's are: of the tool, of the head, and of machine zero."""
        if self.own.zeros:
            return self.tool_offset[axis].plus(machine_zero(self.own, axis))
        return super().beside_work(axis)

    def beside_tip(self, axis: int) -> Position:
        """What the position of an axis has more than the tip of the tool in the spindle, see ``State.tip``."""
        offset = self.tool_offset[axis]
        if not self.lengths_used:
            return offset
        stored = self.own.before
        return offset if stored is None or axis not in self.own.unmeasured else stored[axis]

    def _retimed(self) -> tuple[str, ...]:
        return tuple(sorted(self.own.retimed))

    def _backlash(self) -> tuple[tuple[int, float], ...]:
        return self.own.backlash

    def _machine_tip(self) -> tuple[TipOffset, ...] | None:
        if self.own.reference is None:
            return ()
        places = [(axis, self.beside_tip(axis).minus(there)) for axis, there in enumerate(self.own.reference)]
        return tuple(TipOffset(axis, place.value, place.form) for axis, place in places if place != STILL)

    def _diameters(self) -> tuple[ToolDiameter, ...]:
        if self.tool is None:
            return self.own.diameters
        return tuple(each for each in self.own.diameters if each.tool == self.tool)

    def _boundaries(self) -> tuple[Boundary, ...]:
        return boundaries_of(self)

    def arc_tolerance(self) -> float:
        """mm by which the radii at start and end of an arc may differ (arc_err=)."""
        stated = wincnc_settings(self.machine).arc_tolerance
        return super().arc_tolerance() if stated is None else stated * self.transform.arc_tolerance

    @property
    def has_offset_path(self) -> bool:
        """True while the tool is next to the programmed contour."""
        return super().has_offset_path or "compensation" in self.own.flags

    @property
    def axes_are_bound(self) -> bool:
        """True where axes do more or less than their words say, though these are known."""
        own = self.own
        return bool(own.slaves or own.locked or own.cell_open) or own.absolute_once is not None

    @property
    def feeds_known(self) -> bool:
        """True where no feed that the language keeps besides is lost."""
        return not math.isnan(self.own.arc_feed or 0.0)

    def forget(self, lost: frozenset[str], cause: str) -> None:
        """Leave nothing of these modal groups in what the language keeps besides."""
        self.own = self.own.but(**_lost_of(self, lost, cause))


class WinCncRun(Run):
    """A run on such a controller."""

    modal: WinCncModal


def prepare(modal: WinCncModal) -> None:
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
            modal.tool_offset[axis] = modal.symbol(f"tool.0.{AXIS_NAMES[axis]}")
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
    modal.own = WinCncState(
        feeds=tuple(feeds), lower=tuple(lower), upper=tuple(upper), tools=(tool, Unknown("the tool in changer 2")),
        soft=on, bound=on, flags=flags, auto_dwell=controls.auto_dwell, measured=bool(setup.measures),
    )  # fmt: skip
    modal.guards_off = guards_now(modal)


def guards_now(modal: WinCncModal) -> tuple[str, ...]:
    """The guards that are off, as rows carry them."""
    single = modal.own
    names = []
    if not single.bound:
        names.append("boundaries")
    if not single.measured and any(single.lower[axis] is not None for axis in vertical_axes(modal.machine)):
        # Low boundaries of vertical axes are there once M37 is used (Soft Limit / Boundaries).
        names.append(UNMEASURED)
    if not single.soft:
        names.append("machine_area")
    return tuple(names)


def arm_low_boundaries(modal: WinCncModal) -> None:
    """A tool is measured (M37), or a stored measure is in force: low boundaries of vertical axes count."""
    if not modal.own.measured:
        modal.own = modal.own.but(measured=True)
        modal.guards_off = guards_now(modal)
