"""The state that controllers of DIN blocks with Pascal inside have in addition to the one of all (McuWIN).

Sections are those of the APCI-8001 G-code manual, McuWIN V 2.5.3.133; docs/dialects/mcuwin.md says how open questions
are read. Values are immutable; a change is a new ``McuWinState``. Columns are those of ``AXIS_NAMES``.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from gproof.ir import modal_groups as g
from gproof.ir.dialects.mcuwin.rules import COMMON, DECLARED
from gproof.ir.dialects.mcuwin.settings import McuWinSettings, mcuwin_settings
from gproof.ir.finding import Span
from gproof.ir.machine import AXES, AXIS_NAMES, Machine
from gproof.ir.program import Declare, Program
from gproof.ir.record import record
from gproof.ir.rules import LanguageRules
from gproof.ir.setup import Setup
from gproof.ir.symbolic import NOWHERE, Position, Value
from gproof.ir.trace import Boundary
from gproof.passes.interpret.core.axis_words import letters_of, linear_axes
from gproof.passes.interpret.core.channels import Pairs
from gproof.passes.interpret.core.modal_state import Modal
from gproof.passes.interpret.core.run import Run

if TYPE_CHECKING:
    from gproof.passes.interpret.mcuwin.correction import Correction


def whole_numbers(program: Program) -> frozenset[int]:
    """Numbers of the variables that a program declares as integers, those of its procedures included (12)."""
    found: set[int] = set()
    for sub in program.subprograms.values():
        found.update(number for _, type_, number in sub.parameters if type_.removeprefix("var ") == "integer")
    for body in (program.body, *(sub.body for sub in program.subprograms.values())):
        for node in body:
            if isinstance(node, Declare) and node.kind == "var" and node.type == "integer":
                found.update(range(node.number, node.number + len(node.names)))
    return frozenset(found)


def fits(number: int, value: object, whole: frozenset[int]) -> bool:
    """Whether a variable can hold a value: CI n, and those of ``whole``, are integers of 32 bits (11)."""
    if not (COMMON <= number < DECLARED or number in whole) or not isinstance(value, float):
        return True
    return -(2.0**31) <= value < 2.0**31 and value == math.floor(value)


SAME = 1e-9
"""mm or degrees within which two places are one."""


@record(frozen=True, slots=True, kw_only=True)
class McuWinState:
    """Lengths mm, angles degrees.

    mode_open: whether words are places or distances is not known (G53 in G91, 3.18). reflected: columns; factors: of X
    and Y, NaN: open (3.12, 3.13). radii: (column, mm) of G51, NaN: open. interpolating: columns of G01 to G03;
    doubtful: those that one reading also includes; at_start: those where G60 is read once; programmed_axes: a G60
    has come (3.20). centers_absolute: centres are places in G90, None: not stated. plane_open: G18 or G19 without a
    tool table (2.7). spline: G151. feed: mm/min of linear moves, NaN: not known, for feed_cause; given: an F has come;
    asked: the code after which F must be given again (3.21, 3.22, 3.28); time_unit: seconds, None: not stated;
    constant_speed: G96. center: I and J of the last arc in mm. side: of the radius compensation that is on, 1 left, -1
    right, 0 off; idle: the same while the tool's radius is 0; corrected: what is known of the compensation, None:
    nothing; tool: the record that is selected, chosen: by a T of the job. lower, upper: software limits that hold now
    in every reading, None: those of the machine's file; limit_readings: what each reading of a limit leaves where they
    differ, one end each; limits_open: columns whose limits are not known. saved: values that the job saved (M901,
    M903), by the variable's number. contour: a move that can be joined was the last one. stored: by axis what the last
    G153 left in CD50 and on, and the offset it stands for. ``told``: what is reported once. mirrored: a code that
    reflects axes since before the first move, and its place.
    """

    mode_open: bool = False
    reflected: frozenset[int] = frozenset()
    factors: tuple[float, float] = (-1.0, -1.0)
    radii: tuple[tuple[int, float], ...] = ()
    interpolating: frozenset[int] = frozenset()
    doubtful: frozenset[int] = frozenset()
    at_start: frozenset[int] = frozenset()
    programmed_axes: bool = False
    centers_absolute: bool | None = None
    plane_open: bool = False
    spline: bool = False
    feed: float = math.nan
    feed_cause: str = "the initial feed, as no F has come before"
    given: bool = False
    asked: str = ""
    time_unit: float | None = None
    constant_speed: bool = False
    center: tuple[float, float] | None = None
    side: int = 0
    idle: int = 0
    corrected: Correction | None = None
    tool: int | None = None
    chosen: bool = False
    lower: tuple[float | None, ...] | None = None
    upper: tuple[float | None, ...] | None = None
    limit_readings: tuple[Boundary, ...] = ()
    limits_open: frozenset[int] = frozenset()
    saved: Pairs = ()
    contour: bool = False
    stored: tuple[tuple[Value, Position], ...] | None = None
    told: frozenset[str] = frozenset()
    mirrored: tuple[str, Span] | None = None

    def but(self, **changes: Any) -> McuWinState:
        """The same with some values changed."""
        return replace(self, **changes)


def din_of(machine: Machine) -> McuWinSettings:
    """The settings of the machine's file; none where it is of another controller."""
    return mcuwin_settings(machine)


def own_unit(machine: Machine, axis: int) -> float:
    """mm or degrees in one unit of an axis's own positions (3.1); mm and degrees where the machine's file is silent."""
    known = machine.axis(AXIS_NAMES[axis])
    return 1.0 if known is None or known.position_unit is None else known.position_unit


def mirror_columns(machine: Machine) -> tuple[int | None, int | None]:
    """Columns of the axes that programs call X and Y."""
    letters = letters_of(machine)
    return letters.get("X"), letters.get("Y")


def factor(modal: McuWinModal, axis: int) -> float:
    """What a programmed number of an axis is multiplied by; NaN: open."""
    din = modal.own
    if axis not in din.reflected:
        return 1.0
    return din.factors[mirror_columns(modal.machine).index(axis)]


def has_tools(machine: Machine) -> bool | None:
    """Whether a tool radius table with contents is loaded (2.7); None: not stated."""
    tools = din_of(machine).tools
    return None if tools is None else bool(tools)


def zero_offset_table(modal: McuWinModal, record: int, axis: int) -> Position:
    """A number of the zero offset table, G54 first (3.19): the setup's, else the machine's file, else an unknown."""
    table = din_of(modal.machine).zero_offsets
    if table is not None and (record, AXIS_NAMES[axis]) not in modal.setup.work:
        row = table[record - 1] if record <= len(table) else ()
        return Position(row[axis]) if axis < len(row) else NOWHERE
    return modal.symbol(f"work.{record}.{AXIS_NAMES[axis]}")


def limits_of(modal: McuWinModal) -> tuple[Boundary, ...]:
    """The software limits that rows carry, once a program has changed one (3.29, 3.30)."""
    din = modal.own
    if din.lower is None or din.upper is None:
        return ()
    held = (
        Boundary(axis, low, high, 0.0, (), limit=True)
        for axis, (low, high) in enumerate(zip(din.lower, din.upper, strict=True))
        if low is not None or high is not None
    )
    return (*held, *din.limit_readings)


class McuWinModal(Modal):
    """The state of a run on such a controller. own: what it keeps in addition to the state of all."""

    own: McuWinState

    def __init__(self, rules: LanguageRules, setup: Setup, machine: Machine) -> None:
        super().__init__(rules, setup, machine)
        self.own = McuWinState()
        prepare(self)

    def _linear_axes(self) -> tuple[bool, ...]:
        return linear_axes(self.machine)

    def beside_tip(self, axis: int) -> Position:
        """What the position of an axis has more than the tip of the tool in the spindle, see ``State.tip``."""
        return self.tool_offset[axis]

    def zero_at_start(self, number: int, axis: int) -> Position:
        """Before anything has run: what G54 to G58 select is the offset (3.19), one at a time; 0: the one in force."""
        return self.work_offsets.get((number, axis), NOWHERE) if number else self.g92[axis]

    def _retimed(self) -> tuple[str, ...]:
        return ()

    def _boundaries(self) -> tuple[Boundary, ...]:
        return limits_of(self)

    def arc_tolerance(self) -> float:
        """mm by which the radii at start and end of an arc may differ."""
        return din_of(self.machine).arc_tolerance

    @property
    def has_offset_path(self) -> bool:
        """True while the tool is next to the programmed contour."""
        return super().has_offset_path or self.own.side != 0

    def forget(self, lost: frozenset[str], cause: str) -> None:
        """Leave nothing of these modal groups in what the language keeps besides."""
        found: dict[str, object] = {"contour": False}
        if g.FEED in lost:
            found |= {"feed": math.nan, "feed_cause": cause, "asked": ""}
        if g.REFLECTION in lost:
            found |= {"reflected": frozenset(), "mirrored": None}
        if g.FACTORS in lost:
            found["factors"] = (math.nan, math.nan)
        if lost & {g.RADIUS, g.TOOL}:
            found |= {"side": 0, "idle": 0, "corrected": None}
        if g.TOOL in lost:
            found["tool"] = None
        if lost & {g.PLACE, g.PLANE, g.UNITS, g.CENTERS}:
            found["center"] = (math.nan, math.nan)
        if g.DISTANCES in lost:
            found["mode_open"] = False
        if g.SPLINE in lost:
            found["spline"] = False
        if g.CYLINDER in lost:
            found["radii"] = ()
        self.own = self.own.but(**found)


class McuWinRun(Run):
    """A run on such a controller."""

    modal: McuWinModal


def prepare(modal: McuWinModal) -> None:
    """The start of a job on such a controller."""
    machine, setup = modal.machine, modal.setup
    din = din_of(machine)
    modal.unit = din.position_unit or 1.0
    modal.work = 0
    for axis in range(AXES):
        modal.work_offsets[0, axis] = Position(0.0)
    for number in range(1, 6):
        for axis in range(AXES):
            modal.work_offsets[number, axis] = zero_offset_table(modal, number, axis)
    if setup.active_work is not None and 1 <= setup.active_work <= 5:
        # The offset in force, where [g92] does not state it, is that record.
        for axis, name in enumerate(AXIS_NAMES):
            if setup.interval(f"g92.{name}") is None:
                modal.g92[axis] = modal.work_offsets[setup.active_work, axis]
    modal.tool = setup.tool
    modal.tool_offset = [Position(0.0)] * AXES
    if din.tools is None and setup.default_offset is None:
        # A table may be loaded whose selected record has a length (2.7).
        modal.tool_offset[2] = modal.symbol("tool.0.z")
    number = 0 if setup.tool is None else setup.tool
    if any(record.number == number and record.length != 0.0 for record in din.tools or ()):
        # When a length acts, and along which axis, is not described.
        modal.tool_offset[:3] = [NOWHERE] * 3
    letters = letters_of(machine)
    named = din.interpolation_axes
    columns = frozenset(letters.values() if named is None else (letters[c] for c in named if c in letters))
    modal.own = McuWinState(
        centers_absolute=din.absolute_centers, time_unit=din.time_unit, interpolating=columns, at_start=columns,
        tool=0 if setup.tool is None else setup.tool,
    )  # fmt: skip
