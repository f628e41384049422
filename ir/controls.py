"""Controls: settings of controllers that take one command a line (WinCNC), where they change what a job does.

Lengths are millimetres, angles degrees, times seconds, whatever the file used; ``None`` is "not stated". Axes go by
their column names (``ir/machine.py`` AXIS_NAMES).
"""

from __future__ import annotations

from gproof.ir.finding import Span
from gproof.ir.record import field, record

DEVICES = (
    "knife", "saw", "laser", "laserscan", "thc", "bevel", "pump", "da", "spindle", "autoaux", "probe", "axisadj",
    "drillbank", "spinmac", "axismap",
)  # fmt: skip
"""Features that a machine file can set up (``Controls.devices``)."""
HIGHEST_CHANNEL = 64
"""Of inputs and outputs, where no file says otherwise: the most that the manual has (Virtual AuxIn Indicators)."""


@record(frozen=True, slots=True, kw_only=True)
class Workspace:
    """A preconfigured workspace (WinCNC g54= ... g59=).

    number: of its code, 54 to 59; x, y: shift as the file has it, mm; kind: 0 swap of vertical heads, 3 rotating
    spindle, 5 spindle with two points of rotation; radius: of rotation; offset: degrees that correct the zero
    direction; moves: axes go to their places in the new coordinates when it is selected, None: not stated.
    """

    number: int
    x: float = 0.0
    y: float = 0.0
    kind: int = 0
    radius: float | None = None
    offset: float = 0.0
    moves: bool | None = None


@record(frozen=True, slots=True, kw_only=True)
class Changer:
    """An automatic tool changer (WinCNC atc1=, atc2=).

    number: 1 or 2; height: where tools are unloaded; sensor: offset to the tool sensor; spindle_height: of the bottom
    of its spindle; axis: column of its spindle's axis; in_library: measures are those of the tool library.
    """

    number: int
    height: float | None = None
    sensor: float | None = None
    spindle_height: float | None = None
    axis: str = "z"
    in_library: bool = False


@record(frozen=True, slots=True, kw_only=True)
class MeasureSwitch:
    """Tool measuring (WinCNC g37=): x, y and i, j: first and second switch; descent: rapid way down; feed: mm/s."""

    x: float | None = None
    y: float | None = None
    i: float | None = None
    j: float | None = None
    descent: float | None = None
    feed: float | None = None


@record(frozen=True, slots=True, kw_only=True)
class DrillSettings:
    """Drilling cycles (WinCNC g81set=, g81dwell=).

    dwell, other_dwell: seconds at the bottom by the one and the other key; approach: mm above the hole's bottom where
    a rapid ends; lift: mm above the top of the hole between pecks.
    """

    dwell: float | None = None
    other_dwell: float | None = None
    approach: float | None = None
    lift: float | None = None


@record(frozen=True, slots=True, kw_only=True)
class HomingLine:
    """Axes that home together (one g28move= line of WinCNC; the lines in order are the order of homing).

    distances: (column, mm or degrees) that each axis goes from its switch at the end: above 0 from a low one, below 0
    from a high one; retreat: mm off the switch behind the first contact; feed, second_feed: mm/s towards it; longest:
    mm that an axis moves at most; alternate: the alternate switches count; singly: one axis behind the other.
    """

    distances: tuple[tuple[str, float], ...] = ()
    retreat: float | None = None
    feed: float | None = None
    second_feed: float | None = None
    longest: float | None = None
    alternate: bool = False
    singly: bool = False


@record(frozen=True, slots=True, kw_only=True)
class KnifeMode:
    """A knife that turns with the path (WinCNC knifemode=, knifeangle=).

    axis: column that turns it; target: it turns while a move runs (type 1), else between moves; angle: degrees beyond
    which it is lifted to turn; blend: mm at both ends of a segment along which it turns; lifted, lowered: positions in
    mm; vertical: column that lifts it, "" when an output does: output, with dwell seconds; automatic: it goes up and
    down by itself; lifts_in_arcs: also within arcs; blade: degrees that it leans, both_ways: it cuts forth and back;
    x, y: mm from the axis to the middle of the blade.
    """

    axis: str
    target: bool = False
    angle: float | None = None
    blend: float = 0.0
    lifted: float | None = None
    lowered: float | None = None
    vertical: str = "z"
    output: int | None = None
    dwell: float = 0.0
    automatic: bool = False
    lifts_in_arcs: bool = True
    blade: float = 0.0
    both_ways: bool = False
    x: float = 0.0
    y: float = 0.0


@record(frozen=True, slots=True, kw_only=True)
class SawMode:
    """A saw that turns with the path (WinCNC sawmode=). axis: column; radius: mm; offset: degrees; lift: mm."""

    axis: str
    radius: float | None = None
    offset: float = 0.0
    lift: float | None = None


@record(frozen=True, slots=True, kw_only=True)
class TorchControl:
    """Torch height control (WinCNC thc=).

    axis: column that it moves, at feed mm/s; output: of the torch; input: of the arc; start_delay, end_delay:
    seconds; compression: mm of the switch at touch-off; lift: mm up when the torch is off.
    """

    axis: str = ""
    feed: float | None = None
    output: int | None = None
    input: int | None = None
    start_delay: float | None = None
    end_delay: float | None = None
    compression: float | None = None
    lift: float | None = None


@record(frozen=True, slots=True, kw_only=True)
class Lexical:
    """How lines are read.

    comment_signs: characters beside those of the language that begin a comment; skips: (characters, count): a line
    that begins with one of them makes so many lines be left out; comma: a comma is a decimal point too; continued:
    words after a closed comment are executed; numbered: lines may have numbers of their own (both: ``accepts`` of
    the machine file).
    """

    comment_signs: str = ""
    skips: tuple[tuple[str, int], ...] = ()
    comma: bool = False
    continued: bool = False
    numbered: bool = False


@record(frozen=True, slots=True, kw_only=True)
class Controls:
    """See the module's text.

    lexical: how lines are read; start, end: lines that run before and behind each job (cmdstart=, cmdend=), abort:
    behind one that is aborted; places: by these three names where each stands, no part of the value.
    unit_stated: a file says in what numbers count (unit=). coolant: outputs that switch coolant.
    absolute: the distance mode at the start, None: that of the job before (nmode=).
    arc_tolerance: mm by which start and end radius may differ (arc_err=); smallest_arc: mm, arcs below are lines
    (arc_min=); arcs_modal: lines without a command behind an arc are arcs (g2modal=, arcs=, arctype=).
    feed_groups: columns of the axes that share a feed, a text for each group (vgroup=); command_group: columns whose
    feed an F without axes sets.
    soft_limits: checked from the start, None: not stated; limits_available: they can be switched on (softlim=T);
    adjust_boundary: a target beyond a boundary is moved onto it (softlim=B1); adjust_vertical: so are limits and
    boundaries of vertical axes (softlim=V1); forced: ((lower, upper) of X and Y) outside of which nothing goes
    (forcelim=).
    shift_sign: whether a workspace's shift is added to (+1) or taken from (-1) a position, None: not stated.
    knife_positions: lifted and lowered of the knife count from the machine's zero (machine) or as axis words do (work);
    None: not stated.
    arcs_share_feed: an F of lines holds for arcs and the reverse; False: each keeps its own; None: not stated.
    helical_arcs: False: an arc that moves another axis is an error.
    inputs, outputs: numbers of the channels that are there; None: no file says so. drill_banks: (first output, count).
    unsteady_outputs: those that the controller itself switches with motion or at a pause (auxout= T2, T3, W).
    devices: those of DEVICES that are set up; None: no file says which.
    axis_order: columns in the order of the controller's axis numbers (axischar=), 0 first.
    smoothing: corners are rounded, or velocities planned otherwise than gproof does (accel=, g08=, g09=, vmatch=,
    autoarcfeed=, axisvel= C).
    homing: lines in order. knife, saw, torch: see there. probe_input, probe_axis: channel and column of the probe.
    compensation_entry: cutter compensation begins with a move of its own (cutcomp=T1); compensation_swapped: left and
    right are exchanged (cutcomp= D below 0). override: (lowest, highest) percent that a program may set; None: no file
    says so; override_enabled: it may at all; rapids_unlocked: velocities of rapids may be changed too. backlash:
    (column, mm or degrees) that the file has, though its compensation is off at the start (axisspec= B, backlash= B0).
    positions, homes, tool_positions: how many of each can be stored. nesting: how deep subprograms may call one
    another. around_files: start and end run around each file that a job calls, too; None: not stated. array_order: the
    cells of an array of rows and columns are cut row by row (rows) or column by column (columns); "": not stated.
    highest_channel: of inputs and outputs, None: any. rotation_sign: whether an angle of G52 turns counter-clockwise
    (+1) or clockwise (-1). virtual_on: which of L60 and L61 switches a virtual input on. workspaces, changers, measure,
    drill: see there. auto_output: output that is on during feed moves (autoaux=); auto_output_on: from the start;
    auto_dwell: seconds behind switching it on and off; auto_pausing: motion stops for it.
    """

    lexical: Lexical = Lexical()
    start: str = ""
    end: str = ""
    abort: str = ""
    unit_stated: bool = True
    coolant: tuple[int, ...] = ()
    absolute: bool | None = None
    arc_tolerance: float | None = None
    smallest_arc: float | None = None
    arcs_modal: bool = False
    feed_groups: tuple[str, ...] = ()
    command_group: str = ""
    soft_limits: bool | None = None
    limits_available: bool = True
    adjust_boundary: bool = False
    adjust_vertical: bool = False
    forced: tuple[tuple[float | None, float | None], tuple[float | None, float | None]] | None = None
    shift_sign: int | None = None
    knife_positions: str | None = None
    helical_arcs: bool = True
    arcs_share_feed: bool | None = None
    inputs: tuple[int, ...] | None = None
    outputs: tuple[int, ...] | None = None
    unsteady_outputs: tuple[int, ...] = ()
    drill_banks: tuple[tuple[int, int], ...] = ()
    devices: tuple[str, ...] | None = None
    positions: int | None = None
    homes: int | None = None
    tool_positions: int | None = None
    nesting: int | None = None
    around_files: bool | None = None
    array_order: str = ""
    highest_channel: int | None = None
    rotation_sign: int = 1
    virtual_on: int = 61
    workspaces: tuple[Workspace, ...] = ()
    changers: tuple[Changer, ...] = ()
    measure: MeasureSwitch | None = None
    drill: DrillSettings = DrillSettings()
    auto_output: int | None = None
    auto_output_on: bool = False
    auto_dwell: tuple[float, float] = (0.0, 0.0)
    auto_pausing: bool = True
    axis_order: str = ""
    smoothing: bool = False
    homing: tuple[HomingLine, ...] = ()
    knife: KnifeMode | None = None
    saw: SawMode | None = None
    torch: TorchControl | None = None
    probe_input: int | None = None
    probe_axis: str = "z"
    compensation_entry: bool = False
    compensation_swapped: bool = False
    override: tuple[float | None, float | None] | None = None
    override_enabled: bool = True
    rapids_unlocked: bool = False
    backlash: tuple[tuple[str, float], ...] = ()
    places: tuple[tuple[str, Span], ...] = field(default=(), compare=False, repr=False)

    def place(self, name: str) -> Span | None:
        """Where a line stands that runs before or behind the job; None when no file with lines says so."""
        return dict(self.places).get(name)


NO_CONTROLS = Controls()
