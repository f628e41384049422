"""Job: what a program says, in operations that mean the same on every controller.

A Program holds words, whose meaning depends on its dialect and on modes. A Job has the same structure (loops,
choices, routines, comments, places in the source), and in it operations whose operands have names, quantities and
units, but no letters and no modes. ``frontend/<dialect>/raising.py`` makes it, ``passes/legalize/`` brings it to what
a target has, ``backend/emit/`` prints it. docs/job.md describes it.

Straight-line code is a table here too (``Moves``): numpy columns, one row a move.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import get_args

import numpy as np

from gproof.ir.columns import Column, Columns, Schema
from gproof.ir.drives import AXES, AXIS_NAMES
from gproof.ir.finding import Span
from gproof.ir.record import field, record
from gproof.ir.statements import Expr, Number, Variable

LENGTHS = ("mm", "inch", "cm")
UNITS = (*LENGTHS, "deg", "s", "ms", "rpm", "1/min", "1", "percent")
"""Units of quantities; that of a feed is the one of its path: per minute, per revolution or for the whole move says
``Feed.per``."""


@record(frozen=True, slots=True)
class Quantity:
    """A value with its unit, as the program has it. value: an expression over the program's variables."""

    value: Expr
    unit: str

    @property
    def number(self) -> float | None:
        """The literal value, None for an expression."""
        return self.value.value if isinstance(self.value, Number) else None


@record(frozen=True, slots=True)
class AxisPlace:
    """Where an axis goes, or by how much. axis: a name of AXIS_NAMES; relative: counted from the position before."""

    axis: str
    at: Quantity
    relative: bool = False


@record(frozen=True, slots=True)
class Feed:
    """A feed. per: ``minute``, ``revolution`` (of the spindle) or ``move`` (inverse time: so many moves a minute)."""

    amount: Quantity
    per: str = "minute"


PER = ("minute", "revolution", "move")
FRAMES = ("work", "machine")
PLANES = ("xy", "xz", "yz")

RAPID, STRAIGHT, ARC_CW, ARC_CCW = 1, 2, 3, 4
"""Kinds of rows of ``Moves``."""

MOVE = Schema(
    "moves",
    Column("file", "i2"),
    Column("line", "i4"),
    Column("kind", "u1"),
    Column("axes", "u1"),
    Column("to", "f8", AXES),
    Column("centred", "u1"),
    Column("center", "f8", 3),
    Column("radius", "f8"),
    Column("feed", "f8"),
)
"""One move a row. file, line: in ``Job.files``; kind: RAPID ... ARC_CCW; axes: bit n for the axis in column n that the
row names, whose number is in ``to``; centred: bits of the coordinates of the centre that it names, ``center``: from the
start of the arc; radius: 0 for none, negative for more than half a circle; feed: NaN for that in force. Numbers are in
the table's unit, rotary axes in degrees."""


@record(slots=True, kw_only=True)
class Moves:
    """Successive literal moves in work coordinates. unit: of lengths and feeds; relative: every place counts from the
    position before; plane: of arcs; per: of feeds."""

    rows: Columns
    unit: str
    span: Span
    relative: bool = False
    plane: str = "xy"
    per: str = "minute"


@record(frozen=True, slots=True, kw_only=True)
class MoveTo:
    """A straight move, or one as a rapid of the machine goes. kind: ``rapid``, ``feed``, ``probe``."""

    to: tuple[AxisPlace, ...]
    span: Span
    kind: str = "feed"
    frame: str = "work"
    feed: Feed | None = None


@record(frozen=True, slots=True, kw_only=True)
class ArcTo:
    """An arc or a helix. plane: of PLANES; clockwise: seen from the positive end of the axis across the plane of a
    right-handed frame (in xz: from +Y); center: by axis, relative: from the start, else a place in the frame; radius:
    instead of a centre, negative for more than half a circle; turns: full circles besides, None: at most one. An end
    equal to the start is a full circle."""

    to: tuple[AxisPlace, ...]
    plane: str
    clockwise: bool
    span: Span
    center: tuple[AxisPlace, ...] = ()
    radius: Quantity | None = None
    turns: Expr | None = None
    feed: Feed | None = None


CYCLES = ("drill", "dwell", "peck", "chip_break", "bore", "bore_dwell", "bore_stop", "tap_right", "tap_left")


@record(frozen=True, slots=True, kw_only=True)
class DrillHole:
    """One hole of a drilling cycle, or several in a row. kind: of CYCLES; at: in the plane (relative: repeated
    ``repeats`` times); top: where feeding starts, bottom: of the hole, along the axis across the plane; back: where
    the tool is after it, and between the pecks of ``peck``: ``top`` or ``before`` (the height before this hole, if
    above top); peck: depth of a peck; lift: how far up between pecks of ``chip_break``, None: as far as clearance;
    clearance: above the last peck, but no more than a peck, where the rapid down ends; dwell: at the bottom. ``bore``
    feeds out."""

    kind: str
    at: tuple[AxisPlace, ...]
    top: AxisPlace
    bottom: AxisPlace
    span: Span
    plane: str = "xy"
    back: str = "before"
    peck: Quantity | None = None
    clearance: Quantity | None = None
    lift: Quantity | None = None
    dwell: Quantity | None = None
    repeats: Expr | None = None
    feed: Feed | None = None


@record(frozen=True, slots=True, kw_only=True)
class SetFeed:
    """The feed of moves that name none."""

    feed: Feed
    span: Span


@record(frozen=True, slots=True, kw_only=True)
class DwellFor:
    """Wait for a time at rest."""

    time: Quantity
    span: Span


@record(frozen=True, slots=True, kw_only=True)
class WaitFor:
    """Wait until an input has a state (on: None: read it at once); timeout: None: for ever, open: or as long as the
    controller takes, which its manual does not say."""

    channel: Expr
    on: bool | None
    span: Span
    timeout: Quantity | None = None
    open: bool = False


@record(frozen=True, slots=True, kw_only=True)
class PauseJob:
    """Wait for the operator. optional: only if the machine's switch for optional stops is on; tool: what the operator
    puts into the spindle meanwhile."""

    span: Span
    optional: bool = False
    tool: Expr | None = None


@record(frozen=True, slots=True, kw_only=True)
class TurnSpindle:
    """direction: ``cw``, ``ccw``, ``off``; ``speed``: only the speed changes. speed: None: that in force; surface:
    speed is that of the surface, in m/min of the work (``limit``: rpm)."""

    direction: str
    span: Span
    speed: Quantity | None = None


@record(frozen=True, slots=True, kw_only=True)
class SwitchCoolant:
    """mist, flood: True on, False off, None as it is."""

    span: Span
    mist: bool | None = None
    flood: bool | None = None


@record(frozen=True, slots=True, kw_only=True)
class ChangeTool:
    """select: the tool is prepared; change: the tool that is selected, or ``number``, comes into the spindle; rests:
    the spindle stops for the change, and stays so."""

    span: Span
    number: Expr | None = None
    select: bool = False
    change: bool = True
    rests: bool = False


@record(frozen=True, slots=True, kw_only=True)
class SwitchOutput:
    """value: 0 off, 1 on; moving: without stopping motion."""

    channel: Expr
    value: Expr
    span: Span
    moving: bool = False


@record(frozen=True, slots=True, kw_only=True)
class SetFrame:
    """Where work coordinates count from.

    action: ``select`` (work offset ``number``; axes: of these alone, () of all); ``store`` (offset ``number`` :=
    places, from machine zero); ``store_here`` (offset ``number``: the present place is called places);
    ``zero_at`` (of the axes of places the work zero is there, from machine zero, in place of a work offset, which
    stays as stored, until the next ``select``, and their local offset is 0); ``zero_shift`` (as ``zero_at``, from the
    work zero in force); ``zero_keep``, ``zero_recall`` (the work zero in force is kept apart, with the local offset,
    under ``number``, None: in the only place; it is in force again); ``local_here`` (the local offset: the present
    place is called places); ``local_at`` (the local offset := places, from the work offset); ``local_add``;
    ``local_off``, ``local_suspend``, ``local_restore``; ``rotate``
    (``angle`` about places), ``scale`` (``factors``), ``mirror`` (axes of places, about these), ``transform_off``.
    """

    action: str
    span: Span
    number: Expr | None = None
    places: tuple[AxisPlace, ...] = ()
    angle: Quantity | None = None
    factors: tuple[AxisPlace, ...] = ()
    axes: tuple[str, ...] = ()


FRAME_ACTIONS = (
    "select", "store", "store_here", "zero_at", "zero_shift", "zero_keep", "zero_recall", "local_here",
    "local_at", "local_add", "local_off", "local_suspend", "local_restore", "rotate", "rotate_off", "scale",
    "scale_off", "mirror", "mirror_off",
)  # fmt: skip


@record(frozen=True, slots=True, kw_only=True)
class SetPathMode:
    """mode: ``exact_path``, ``exact_stop``, ``continuous``; tolerance: of continuous; simplify: places that are no
    farther from a straight line may be left out; angle: degrees up to which a corner is taken without slowing down."""

    mode: str
    span: Span
    tolerance: Quantity | None = None
    simplify: Quantity | None = None
    angle: Quantity | None = None


@record(frozen=True, slots=True, kw_only=True)
class Compensate:
    """Cutter compensation. side: ``left``, ``right``, ``off``; tool: whose diameter counts; diameter: instead of it;
    plane: of the contour; open: which path the source's controller takes, its manual does not say."""

    side: str
    span: Span
    tool: Expr | None = None
    diameter: Quantity | None = None
    plane: str = "xy"
    open: bool = False


@record(frozen=True, slots=True, kw_only=True)
class UseLength:
    """Tool length offset. tool: whose length counts from now on, None with on: that in the spindle."""

    on: bool
    span: Span
    tool: Expr | None = None


@record(frozen=True, slots=True, kw_only=True)
class HomeAxes:
    """Reference run of axes, in this order."""

    axes: tuple[str, ...]
    span: Span


@record(frozen=True, slots=True, kw_only=True)
class ParkAt:
    """To a parking place of the controller: by way of the places given first. number: 1 or 2."""

    number: int
    to: tuple[AxisPlace, ...]
    span: Span


@record(frozen=True, slots=True, kw_only=True)
class ShowText:
    """A text for the operator. kind: ``msg``, ``warning``, ``log``; waits for nothing."""

    kind: str
    parts: tuple[Expr, ...]
    span: Span


@record(frozen=True, slots=True, kw_only=True)
class AllowOverrides:
    """Whether the operator's overrides of feed and speed count."""

    on: bool
    span: Span


@record(frozen=True, slots=True, kw_only=True)
class SwitchGuard:
    """A guard of the controller. name: as of ``ir.program.Guard``."""

    name: str
    on: bool
    span: Span


@record(frozen=True, slots=True, kw_only=True)
class EndJob:
    """The job is over. reset: it goes back to its beginning too; rests: spindle and coolant are switched off; plane,
    unit: in which the source leaves its controller, "": as it usually is."""

    span: Span
    reset: bool = False
    rests: bool = False
    plane: str = ""
    unit: str = ""


@record(frozen=True, slots=True, kw_only=True)
class Remark:
    """A comment; trailing: at the end of the line before it."""

    text: str
    span: Span
    trailing: bool = False


@record(frozen=True, slots=True, kw_only=True)
class SetVariable:
    """A variable gets a value."""

    target: Variable
    value: Expr
    span: Span


@record(frozen=True, slots=True, kw_only=True)
class Choice:
    """then where condition is not 0. question: the text that asks the operator, for a condition on an answer."""

    condition: Expr
    then: tuple[Node, ...]
    otherwise: tuple[Node, ...]
    span: Span
    question: tuple[Expr, ...] = ()


@record(frozen=True, slots=True, kw_only=True)
class OptionalPart:
    """What block delete leaves out."""

    body: tuple[Node, ...]
    span: Span


@record(frozen=True, slots=True, kw_only=True)
class LoopWhile:
    """Repeats while condition is not 0. first: the body runs once before it is asked."""

    condition: Expr
    body: tuple[Node, ...]
    span: Span
    first: bool = False


@record(frozen=True, slots=True, kw_only=True)
class CountLoop:
    """Repeats for each whole number from first to last, both evaluated before. down: falling."""

    variable: Variable
    first: Expr
    last: Expr
    body: tuple[Node, ...]
    span: Span
    down: bool = False


@record(frozen=True, slots=True, kw_only=True)
class RunRoutine:
    """Runs a routine of ``Job.routines``. arguments: (variable of the routine, value); count: None: once."""

    name: str
    span: Span
    arguments: tuple[tuple[Variable, Expr], ...] = ()
    count: Expr | None = None


@record(frozen=True, slots=True, kw_only=True)
class LeaveRoutine:
    """Back to where the routine was run from."""

    span: Span


@record(frozen=True, slots=True, kw_only=True)
class Mark:
    """A place that ``GoTo`` goes to."""

    name: str
    span: Span


@record(frozen=True, slots=True, kw_only=True)
class GoTo:
    """Goes on after a mark of the same list, or of one around it."""

    name: str
    span: Span


@record(frozen=True, slots=True, kw_only=True)
class RepeatGrid:
    """The body again at each place of a grid, whose first is where the axes are: columns dx apart along x, rows dy
    apart along y; rapid to each but the first. by_rows: row by row. back: rapid to the first place at last."""

    rows: int
    columns: int
    dx: Quantity
    dy: Quantity
    body: tuple[Node, ...]
    span: Span
    back: bool = True
    by_rows: bool = True


@record(frozen=True, slots=True, kw_only=True)
class NotRaised:
    """What has no form here: nothing can be translated beyond it. construct: as the manual calls it; why: a reason."""

    construct: str
    why: str
    span: Span


Node = (
    Moves | MoveTo | ArcTo | DrillHole | SetFeed | DwellFor | WaitFor | PauseJob | TurnSpindle | SwitchCoolant
    | ChangeTool | SwitchOutput | SetFrame | SetPathMode | Compensate | UseLength | HomeAxes | ParkAt | ShowText
    | AllowOverrides | SwitchGuard | EndJob | Remark | SetVariable | Choice | OptionalPart | LoopWhile | CountLoop
    | RunRoutine | LeaveRoutine | Mark | GoTo | RepeatGrid | NotRaised
)  # fmt: skip
NODES = frozenset(get_args(Node))

Nodes = tuple[Node, ...]


@record(frozen=True, slots=True, kw_only=True)
class Routine:
    """A list of operations with a name. parameters: variables that a call gives values; file: it is one of its own in
    the source, or has to be one in the target."""

    name: str
    body: tuple[Node, ...]
    span: Span
    parameters: tuple[Variable, ...] = ()
    file: str = ""


@record(slots=True, kw_only=True)
class Job:
    """A whole job. source: the dialect it was written in; files: that its places are in; routines: by name, in the
    order of the source; kept: numbers of variables that outlive the job."""

    source: str
    files: list[str] = field(default_factory=list)
    body: tuple[Node, ...] = ()
    routines: dict[str, Routine] = field(default_factory=dict)

    def verify(self) -> None:
        """The invariants of this stage; ValueError with the first one that fails."""
        for name, routine in self.routines.items():
            if routine.name != name:
                raise ValueError(f"routine {routine.name!r} is listed as {name!r}")
            self._verify(routine.body, frozenset())
        self._verify(self.body, frozenset())

    def _verify(self, body: Nodes, around: frozenset[str]) -> None:
        marks = around | {node.name for node in body if isinstance(node, Mark)}
        for node in body:
            if type(node) not in NODES:
                raise ValueError(f"{type(node).__name__} is no operation of a job")
            if isinstance(node, Moves):
                verify_moves(node, len(self.files))
            elif isinstance(node, RunRoutine) and node.name not in self.routines:
                raise ValueError(f"routine {node.name!r} is not there")
            elif isinstance(node, GoTo) and node.name not in marks:
                raise ValueError(f"{node} leads to a mark that it cannot reach")
            elif isinstance(node, SetFrame) and node.action not in FRAME_ACTIONS:
                raise ValueError(f"{node.action!r} is nothing that a frame does")
            for amount in quantities(node):
                if amount.unit not in UNITS:
                    raise ValueError(f"{amount.unit!r} is no unit")
            for part in bodies(node):
                self._verify(part, marks)


def verify_moves(moves: Moves, files: int) -> None:
    """Known kinds, finite numbers, arcs with a centre or a radius, units and planes that there are."""
    rows = moves.rows
    if moves.unit not in LENGTHS or moves.plane not in PLANES or moves.per not in PER:
        raise ValueError(f"moves with {moves.unit!r}, {moves.plane!r}, {moves.per!r}")
    kind = rows["kind"]
    if not len(rows):
        raise ValueError("a table of no moves")
    if kind.min() < RAPID or kind.max() > ARC_CCW:
        raise ValueError("moves of an unknown kind")
    if not (np.isfinite(rows["to"]).all() and np.isfinite(rows["center"]).all() and np.isfinite(rows["radius"]).all()):
        raise ValueError("moves to a place that is not finite")
    arcs = kind >= ARC_CW
    if (((rows["centred"] != 0) | (rows["radius"] != 0.0)) & ~arcs).any():
        raise ValueError("a straight move with a centre")
    if (arcs & (rows["centred"] == 0) & (rows["radius"] == 0.0)).any():
        raise ValueError("an arc without a centre or a radius")
    if rows["file"].min() < 0 or rows["file"].max() >= max(1, files):
        raise ValueError("moves of a file that is not there")


def bodies(node: Node) -> tuple[Nodes, ...]:
    """The lists of operations within one."""
    if isinstance(node, Choice):
        return node.then, node.otherwise
    if isinstance(node, OptionalPart | LoopWhile | CountLoop | RepeatGrid):
        return (node.body,)
    return ()


def quantities(node: Node) -> Iterator[Quantity]:
    """The quantities of an operation."""
    for name in getattr(type(node), "__slots__", ()):
        value = getattr(node, name)
        for one in value if isinstance(value, tuple) else (value,):
            if isinstance(one, Quantity):
                yield one
            elif isinstance(one, AxisPlace):
                yield one.at
            elif isinstance(one, Feed):
                yield one.amount


def walk(body: Nodes) -> Iterator[Node]:
    """Every operation of a list, those within others too."""
    for node in body:
        yield node
        for part in bodies(node):
            yield from walk(part)


def used_routines(body: Nodes, routines: dict[str, Routine]) -> dict[str, Routine]:
    """Those that a body runs, and that these run, in the order of their list."""
    used: set[str] = set()
    rest = [body]
    while rest:
        for node in walk(rest.pop()):
            if isinstance(node, RunRoutine) and node.name not in used:
                used.add(node.name)
                rest.append(routines[node.name].body)
    return {name: routine for name, routine in routines.items() if name in used}


AXIS_BIT = {name: 1 << column for column, name in enumerate(AXIS_NAMES)}
MM = {"mm": 1.0, "inch": 25.4, "cm": 10.0}
"""Millimetres of a unit of length."""
