"""Trace: what the machine does, evaluated; canonical machining functions as numpy columns.

Positions are machine coordinates in mm and degrees. A position is ``to[axis]`` plus the affine form that
``frames[frame][axis]`` names: a sum of unknown offsets with whole coefficients, empty when everything is
known. A section runs from rest to rest; edges say what ends it and where each outcome leads.
The canonical functions are those of NISTIR 5970.
"""

from __future__ import annotations

import enum
from collections.abc import Iterator

import numpy as np

from gproof.ir.columns import Column, Columns, Schema, batches, joined
from gproof.ir.drives import AXES, Interval
from gproof.ir.end_state import EndState, Question
from gproof.ir.record import field, record


class Op(enum.IntEnum):
    """Canonical functions; motion is below 10."""

    TRAVERSE = 1
    FEED = 2
    ARC = 3
    PROBE = 4
    DWELL = 10
    SPINDLE = 11
    COOLANT = 12
    TOOL_CHANGE = 13
    OUTPUT = 14
    INPUT_WAIT = 15
    STOP = 16
    HOME = 17
    OFFSET = 18
    TOOL_OFFSET = 19
    UNITS = 20
    PLANE = 21
    OVERRIDE = 22
    PATH_MODE = 23
    GUARD = 24
    MESSAGE = 25
    END = 26
    ORIENT = 27
    HEAD = 28
    SETPOINT = 29
    DEVICE = 30


class Plane(enum.IntEnum):
    """The plane of an arc; 0 for rows that are no arcs."""

    NONE = 0
    XY = 1
    XZ = 2
    YZ = 3


class PathMode(enum.IntEnum):
    """How corners are taken."""

    EXACT_PATH = 0
    EXACT_STOP = 1
    CONTINUOUS = 2


TRACE_ROW = Schema(
    "trace",
    Column("op", "u1"),
    Column("file", "i2"),
    Column("line", "i4"),
    Column("call", "i4"),
    Column("to", "f8", AXES),
    Column("frame", "i4"),
    Column("state", "i4"),
    Column("feed", "f8"),
    Column("center", "f8", 3),
    Column("turns", "i4"),
    Column("plane", "u1"),
    Column("arg", "f8", 2),
    Column("text", "i4"),
)
"""One row for each canonical call.

op: Op; file, line: place in Trace.files; call: index into Trace.calls; to: end position (equal to the
start for rows that do not move); frame: index into Trace.frames, for `to` and `center`;
state: index into Trace.states; feed: effective mm/min or deg/min (0: rapid or no motion, NaN: unknown);
center: machine mm of an arc (0 otherwise; the coordinate along the normal is that of the start);
turns: +1 counter-clockwise and at most one full circle, seen from the positive end of the third axis of a
right-handed frame; plane: Plane. arg, text: by op, see ``ARGUMENTS``.
"""

_PROGRAMMED = "arg: where state.compensation is not 0, the programmed point the row belongs to"

ARGUMENTS = {
    Op.TRAVERSE: _PROGRAMMED,
    Op.FEED: _PROGRAMMED,
    Op.ARC: _PROGRAMMED,
    Op.DWELL: "arg[0]: seconds (NaN: unknown)",
    Op.SPINDLE: "arg[0]: direction (+1 cw, -1 ccw, 0 off); arg[1]: revolutions a minute (NaN: unknown)",
    Op.COOLANT: "arg[0]: mist (0 or 1); arg[1]: flood",
    Op.TOOL_CHANGE: "arg[0]: tool number (NaN: unknown)",
    Op.OUTPUT: "arg[0]: channel; arg[1]: value, the bits of all of a group; text: 1 when motion does not stop for "
    "it; -1 - n: a word of all outputs of the axis in column n",
    Op.SETPOINT: "text: what is set (SETPOINTS); arg[0]: channel, 0 where there is one; arg[1]: value (NaN: unknown)",
    Op.INPUT_WAIT: "arg[0]: channel; arg[1]: value",
    Op.STOP: "arg[0]: 1 when optional",
    Op.OFFSET: "arg[0]: coordinate system (0: G92); arg[1]: 1 when motion stops for it",
    Op.TOOL_OFFSET: "arg[0]: tool (0: cancelled)",
    Op.UNITS: "arg[0]: mm in one program unit",
    Op.PLANE: "arg[0]: Plane",
    Op.OVERRIDE: "arg[0]: 1 when overrides are allowed",
    Op.ORIENT: "the spindle, which rests, is in a fixed orientation",
    Op.HEAD: "arg[0]: 0 to 2 spindles, 4 probe, 5 camera",
    Op.PATH_MODE: "arg[0]: PathMode; arg[1]: tolerance in mm (infinite: unknown)",
    Op.GUARD: "arg[0]: 1 on, 0 off; text: name",
    Op.MESSAGE: "text: the message",
    Op.END: "arg[0]: 1 where no code says so: after the last line; 2 after what runs after an abort; arg[1]: 1 where "
    "the code switches spindle and coolant off",
    Op.DEVICE: "text: a command to a device or a setting that moves nothing, as written",
}

SETPOINTS = {
    "pwm": "duty of a pulse width output, 0 to 1",
    "drives": "1 motors powered, 0 not",
    "height_control": "torch height control: 1 on, 0 off",
    "height_setpoint": "what torch height control aims at, in the controller's own unit",
    "extruder_temperature": "degrees Celsius",
    "bed_temperature": "degrees Celsius",
    "extruder_maximum": "degrees Celsius at which the controller cuts the heater off",
    "fan": "0 to 1",
    "spindle_speed": "revolutions a minute, whether it turns or not",
}
"""What a SETPOINT row may set, and its unit."""

Affine = tuple[tuple[str, int], ...]
"""A sum of unknowns: ((symbol, coefficient), ...), sorted; () is known. Symbols: see ir/setup.py."""

UNKNOWN: Affine = (("?", 1),)
"""A position of which nothing is known."""

Frame = tuple[Affine, Affine, Affine, Affine, Affine, Affine]

KNOWN_FRAME: Frame = ((), (), (), (), (), ())


UNMEASURED = "low_boundaries"
"""Name in ``State.guards_off``: no tool was measured, and low boundaries of vertical axes do not count yet."""


OTHER_UNIT = "F before G20 or G21"
"""In ``State.retimed``: the feed in force was given in another unit; rows have it as the speed that it was then."""


@record(frozen=True, slots=True)
class Boundary:
    """A boundary of the work for one axis: low <= machine position - (shift + form) <= high, mm or degrees.

    low, high: None where there is none; shift, form: workspace and tool measure in force, number and unknowns.
    limit: a software limit that the program has set or moved; shift is then where the controller has machine zero.
    open: why it is open whether it holds; past such a one the answer is unknown.
    """

    axis: int
    low: float | None
    high: float | None
    shift: float
    form: Affine
    limit: bool = False
    open: str = ""


@record(frozen=True, slots=True)
class TipOffset:
    """What a position of one axis has more than the tip of the tool has where the work's numbers count from.

    mm and form: number and unknowns, for the tool that is in the spindle.
    """

    axis: int
    mm: float
    form: Affine = ()


@record(frozen=True, slots=True)
class ToolDiameter:
    """The diameter of a tool that counts instead of the machine file's tool table: low <= it <= high, mm."""

    tool: int
    low: float
    high: float


@record(frozen=True, slots=True, kw_only=True, eq=False)
class State:
    """The slow part of the machine's state, shared by many rows.

    spindle: rpm, signed (+ clockwise, NaN unknown); feed_mode: G-code style 93, 94 or 95;
    synchronised: the move follows the turns of the spindle, its feed is nominal; feed_override: the factor that the
    program set, NaN unknown (feeds are those with it); surface_speed: m/min at constant surface speed, else 0
    (NaN unknown), spindle_limit: rpm it may reach then (NaN: no limit); head: see Op.HEAD;
    path_tolerance: mm (P), simplify: mm (Q), infinite: unknown; laf_angle: degrees (R, NaN: the machine's setting);
    arc_tolerance: mm that start and end radius of an arc may differ; guards_off: names of guards that are off.
    compensation: of the cutter's radius, 0 off, else the tool left (+) or right (-) of the path in the right-handed
    pair of Plane 1 or 2, whose number it is; then ``arg`` of motion rows is the programmed point in that pair.
    following: what the controller adds to the programmed path, see ``FOLLOWING``.
    boundaries: of the work, by axis; their guard is ``boundaries``.
    tip: what positions have more than the tip of the tool, its length above all; axes that are not named: nothing.
    machine_tip: the same in machine coordinates, where it is not ``tip``: tool measures of some controllers are places,
    so that machine heights are those of the tip of the tool that was in the spindle when the job started.
    diameters: what the program or the setup has written over the diameter in the tool table, of the tool in the
    spindle, or of all tools where it is not known which one that is.
    retimed: commands of the program that have changed velocities or accelerations of the machine's file, and
    OTHER_UNIT.
    backlash: (axis, mm or degrees) of axes whose compensation the program has set or switched: the most that it is.
    """

    tool: int = -1
    spindle: float = 0.0
    feed_mode: int = 94
    path_mode: PathMode = PathMode.EXACT_PATH
    path_tolerance: float = 0.0
    simplify: float = 0.0
    laf_angle: float = float("nan")
    work: int = 1
    overrides: bool = True
    compensation: int = 0
    arc_tolerance: float = 0.0
    guards_off: tuple[str, ...] = ()
    following: tuple[str, ...] = ()
    synchronised: bool = False
    feed_override: float = 1.0
    surface_speed: float = 0.0
    spindle_limit: float = float("nan")
    head: int = 0
    boundaries: tuple[Boundary, ...] = ()
    tip: tuple[TipOffset, ...] = ()
    machine_tip: tuple[TipOffset, ...] | None = None
    diameters: tuple[ToolDiameter, ...] = ()
    retimed: tuple[str, ...] = ()
    backlash: tuple[tuple[int, float], ...] = ()

    def tip_beside(self, work: int) -> tuple[TipOffset, ...]:
        """``tip`` in a coordinate system, 0: ``machine_tip``."""
        return self.tip if work or self.machine_tip is None else self.machine_tip

    def __eq__(self, other: object) -> bool:
        """Bit for bit: NaN, which stands for "not stated", equals itself."""
        return isinstance(other, State) and repr(self) == repr(other)

    def __hash__(self) -> int:
        return hash(repr(self))


HEIGHT_MAP = "height_map"
KNIFE = "knife"
FOLLOWING = {
    HEIGHT_MAP: "Z follows the setup's height map; rows have Z without it",
    KNIFE: "an axis follows the direction of X-Y moves; rows have its positions",
}
"""What may be in ``State.following``."""


class Wait(enum.Enum):
    """What ends a section."""

    END = "end"
    OPERATOR = "operator"
    TOOL_CHANGE = "tool_change"
    INPUT = "input"
    PROBE = "probe"
    HOME = "home"
    BRANCH = "branch"
    UNKNOWN = "unknown"


@record(frozen=True, slots=True, kw_only=True)
class Edge:
    """From a section to what follows one outcome of its wait; target -1: the program is over or not followed.

    line: of the statement that waits; file: index in ``Trace.files``.
    """

    wait: Wait
    outcome: str
    target: int
    line: int = 0
    file: int = 0


@record(slots=True, kw_only=True)
class TraceSection:
    """Rows from rest to rest. start: position (6) and frame index at its start."""

    number: int
    start: tuple[float, ...]
    start_frame: int
    rows: Columns
    edges: tuple[Edge, ...] = ()


@record(slots=True, kw_only=True)
class Trace:
    """A whole evaluated program as a graph of sections; section 0 is where it starts.

    symbols: the ranges, mm or degrees, of unknowns that arose in the run (probe contacts, answers): see ir/setup.py.
    macro_files: see ``Program``. ends: by section that ends the program what it leaves; questions: by section what its
    two outcomes rest on, where that is the state of one channel; first: the state before anything has run. These three
    are notes for who compares programs, no part of the stage.
    """

    files: list[str] = field(default_factory=list)
    calls: list[str] = field(default_factory=lambda: [""])
    frames: list[Frame] = field(default_factory=lambda: [KNOWN_FRAME])
    states: list[State] = field(default_factory=list)
    texts: list[str] = field(default_factory=list)
    sections: list[TraceSection] = field(default_factory=list)
    symbols: dict[str, Interval] = field(default_factory=dict)
    macro_files: frozenset[str] = field(default=frozenset(), compare=False, repr=False)
    ends: dict[int, EndState] = field(default_factory=dict, compare=False, repr=False)
    questions: dict[int, Question] = field(default_factory=dict, compare=False, repr=False)
    first: State | None = field(default=None, compare=False, repr=False)

    def verify(self) -> None:
        """The invariants of this stage; ValueError with the first one that fails."""
        for place, section in enumerate(self.sections):
            where = f"section {section.number}"
            if section.number != place:
                raise ValueError(f"{where}: is at place {place}")
            if len(section.start) != AXES or not 0 <= section.start_frame < len(self.frames):
                raise ValueError(f"{where}: bad start")
            for edge in section.edges:
                if not -1 <= edge.target < len(self.sections):
                    raise ValueError(f"{where}: edge to section {edge.target}, which does not exist")
                if not 0 <= edge.file < max(1, len(self.files)):
                    raise ValueError(f"{where}: edge at a line of file {edge.file}, which does not exist")
        for begin, end in batches([len(section.rows) for section in self.sections]):
            tables = [section.rows for section in self.sections[begin:end]]
            try:
                verify_rows(joined(TRACE_ROW, tables), self)
            except (ValueError, LookupError):
                for section in self.sections[begin:end]:
                    verify_rows(section.rows, self, f"section {section.number}")
                raise


_KNOWN = np.zeros(256, np.bool_)
_KNOWN[list(Op)] = True


def verify_rows(rows: Columns, trace: Trace, where: str = "rows") -> None:
    """Row invariants: known ops, finite positions, indices in range, arcs whole."""
    if not len(rows):
        return
    op = rows["op"]
    if not _KNOWN[op].all():
        raise ValueError(f"{where}: unknown op")
    if not np.isfinite(rows["to"]).all() or not np.isfinite(rows["center"]).all():
        raise ValueError(f"{where}: a position is not finite")
    for name, bound in (
        ("frame", trace.frames),
        ("state", trace.states),
        ("call", trace.calls),
        ("file", trace.files),
    ):
        index = rows[name]
        if index.min() < 0 or index.max() >= len(bound):
            raise ValueError(f"{where}: {name} index out of range")
    arcs = op == Op.ARC
    if ((rows["turns"] != 0) != arcs).any() or ((rows["plane"] != 0) != arcs).any():
        raise ValueError(f"{where}: arcs, and only arcs, have turns and a plane")
    feed = rows["feed"]
    if (feed < 0).any() or (feed[op == Op.TRAVERSE] != 0).any():
        raise ValueError(f"{where}: negative feed, or a rapid move with one")
    texts = rows["text"][(op == Op.MESSAGE) | (op == Op.SETPOINT) | (op == Op.DEVICE)]
    if ((texts < 0) | (texts >= len(trace.texts))).any():
        raise ValueError(f"{where}: text index out of range")


@record(slots=True, kw_only=True)
class Chunk:
    """Some successive rows of a section while a job streams by.

    ``begin``: index of its first row in the section; start, start_frame: position before its first row;
    last: True when the section ends with it; expected: how many more rows a kernel can count on from here than
    earlier chunks have reported, -1 when nobody reckons: its own. Tables (frames, states ...) are those of ``trace``,
    which grows.
    """

    trace: Trace
    section: int
    begin: int
    start: tuple[float, ...]
    start_frame: int
    rows: Columns
    last: bool = False
    edges: tuple[Edge, ...] = ()
    expected: int = -1

    @property
    def work(self) -> int:
        """Rows to charge a kernel with when it chooses between its two speeds; over all chunks their number."""
        return len(self.rows) if self.expected < 0 else self.expected

    def starts(self) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
        """(n, 6): the position before each row."""
        before = np.empty((len(self.rows), AXES))
        if len(self.rows):
            before[0] = self.start
            before[1:] = self.rows["to"][:-1]
        return before

    def start_frames(self) -> np.ndarray[tuple[int], np.dtype[np.int32]]:
        """(n,): the frame before each row."""
        before = np.empty(len(self.rows), dtype=np.int32)
        if len(self.rows):
            before[0] = self.start_frame
            before[1:] = self.rows["frame"][:-1]
        return before


def chunks(trace: Trace) -> Iterator[Chunk]:
    """A complete Trace as one chunk a section."""
    for s in trace.sections:
        yield Chunk(
            trace=trace,
            section=s.number,
            begin=0,
            start=s.start,
            start_frame=s.start_frame,
            rows=s.rows,
            last=True,
            edges=s.edges,
        )
