"""Machine: what a controller's files say of axes, areas, tools and the board.

Lengths are millimetres, angles degrees, times seconds, whatever the file used. ``None`` is "not stated",
never zero.
"""

from __future__ import annotations

import enum
from fractions import Fraction

from gproof.ir.drives import AXES, AXIS_NAMES, Drive, PitchTable
from gproof.ir.record import field, record
from gproof.ir.settings import NO_SETTINGS, Settings

__all__ = [
    "AXES", "AXIS_NAMES", "NO_MACHINE", "SHAPES", "TOUCHES", "Area", "Axis", "AxisKind", "Board", "Controller", "Drive",
    "Knife", "Machine", "PitchTable", "Slave", "Spindle", "Tool", "Unmodelled",
]  # fmt: skip


class AxisKind(enum.Enum):
    """Linear axes count millimetres, rotary ones degrees."""

    LINEAR = "linear"
    ROTARY = "rotary"


@record(frozen=True, slots=True, kw_only=True)
class Slave:
    """A further motor of an axis (gantry, Eding manual 2.1.3, 2.10.3), in the axis's own units.

    joint: the name of the output that it uses; None: as the axis's own motor has it. The axis may only go where,
    and only as fast as, all its motors may.
    """

    joint: str = ""
    steps_per_unit: Fraction | None = None
    lower: float | None = None
    upper: float | None = None
    travel_lower: float | None = None
    travel_upper: float | None = None
    max_velocity: float | None = None
    max_acceleration: float | None = None
    backlash: float | None = None
    pitch: PitchTable | None = None
    home_position: float | None = None
    home_velocity: float | None = None


@record(frozen=True, slots=True, kw_only=True)
class Axis:
    """One axis.

    steps_per_unit: exact, its sign is the motor's direction; lower, upper: soft limits;
    travel_lower, travel_upper: the physical end stops; velocity in unit/s, acceleration in unit/s2;
    slaves: further motors that follow this axis; pitch: its motor's table; home_position: where the home sensor
    is; home_velocity: unit/s towards it, its sign is the direction, 0: homed by hand; tip_feed: the feed is that of
    the tool over the turning material (Eding 4THMILL), which gproof does not plan.
    letter: the word that moves it, "" for that of its name: a second vertical axis W has the column of A;
    vertical: it carries a head up and down, None where that is unknown; boundary_lower, boundary_upper: like limits,
    in work positions without local coordinates (WinCNC lobound=, hibound=); feed_velocity: unit/s of feed moves
    before a program gives another; home_place: machine position after homing, None: not stated.
    position_unit: mm or degrees in one unit of the axis's own positions, the unit of G00 of McuWIN whatever the
    interpolation unit is (3.1), None: not stated.
    """

    name: str
    kind: AxisKind
    steps_per_unit: Fraction | None = None
    lower: float | None = None
    upper: float | None = None
    travel_lower: float | None = None
    travel_upper: float | None = None
    max_velocity: float | None = None
    max_acceleration: float | None = None
    backlash: float = 0.0
    slaves: tuple[Slave, ...] = ()
    pitch: PitchTable | None = None
    home_position: float | None = None
    home_velocity: float | None = None
    tip_feed: bool = False
    letter: str = ""
    vertical: bool | None = None
    boundary_lower: float | None = None
    boundary_upper: float | None = None
    feed_velocity: float | None = None
    home_place: float | None = None
    position_unit: float | None = None

    @property
    def word(self) -> str:
        """The letter of its words in programs, upper case."""
        return self.letter or self.name.upper()

    @property
    def index(self) -> int:
        """Its column in position arrays: X Y Z A B C are 0..5."""
        return AXIS_NAMES.index(self.name)

    @property
    def unit(self) -> str:
        """``mm`` or ``deg``."""
        return "mm" if self.kind is AxisKind.LINEAR else "deg"

    def drives(self) -> tuple[Drive, ...]:
        """Its motors, the axis's own first, named X, X2, X3."""
        own = Drive(
            self.name.upper(), self.steps_per_unit, self.lower, self.upper, self.travel_lower, self.travel_upper,
            self.max_velocity, self.max_acceleration, self.backlash, self.pitch,
        )  # fmt: skip
        found = [own]
        for number, slave in enumerate(self.slaves, 2):
            stated = {n: getattr(slave, n) for n in Drive._fields[1:] if getattr(slave, n) is not None}
            found.append(own._replace(name=f"{own.name}{number}", **stated))
        return tuple(found)


@record(frozen=True, slots=True, kw_only=True)
class Area:
    """A region of space: ((lower, upper) for X, Y, Z); an unbounded side is infinite.

    rings: where it is a polygon of X and Y, its points and those of its holes, without the first one again at the end;
    box is then around it. work: the coordinate system (1 is G54) whose zero positions count from; 0: the machine's.
    """

    name: str
    box: tuple[tuple[float, float], tuple[float, float], tuple[float, float]]
    rings: tuple[tuple[tuple[float, float], ...], ...] = ()
    work: int = 0


@record(frozen=True, slots=True, kw_only=True)
class Tool:
    """A tool table entry; lengths in mm, ``None`` where the table does not say.

    shape: one of ``SHAPES``; corner_radius: of a bull; tip_angle: degrees between the flanks of a vee or drill;
    tip_diameter: of the flat at the tip of a vee; flute_length: from the tip to where cutting ends; shank_diameter:
    above that; stickout: from the tip to the holder; holder: (diameter below, diameter above, height) of its parts from
    there upwards. min_rpm, max_rpm, max_feed, max_plunge (mm/s) and max_depth (mm): what it may be used with.
    """

    number: int
    length: float | None = None
    x_offset: float | None = None
    diameter: float | None = None
    orientation: int | None = None
    shape: str | None = None
    corner_radius: float | None = None
    tip_angle: float | None = None
    tip_diameter: float | None = None
    flute_length: float | None = None
    shank_diameter: float | None = None
    stickout: float | None = None
    holder: tuple[tuple[float, float, float], ...] = ()
    min_rpm: float | None = None
    max_rpm: float | None = None
    max_feed: float | None = None
    max_plunge: float | None = None
    max_depth: float | None = None


SHAPES = ("flat", "ball", "bull", "vee", "drill")
"""Shapes of tools: end mill, ball nose, end mill with rounded corners, engraver, drill."""


@record(frozen=True, slots=True, kw_only=True)
class Knife:
    """Tangential knife (Eding manual 2.1.9): an axis that turns about Z follows the direction of X-Y moves.

    axis: its axis; angle: degrees between two moves up to which it turns without being lifted; lift: mm up before
    it turns by more; blend_angle, blend_distance: a move that turns by less and is shorter (mm) turns it on the way.
    """

    axis: str = "c"
    angle: float = 0.0
    lift: float = 0.0
    blend_angle: float = 0.0
    blend_distance: float = 0.0


@record(frozen=True, slots=True, kw_only=True)
class Spindle:
    """A spindle, or another tool head (Eding manual 3.5.2, 3.5.6), by the number of ``Op.HEAD``.

    min_rpm, max_rpm: what it can do; ramp_time: seconds to reach its speed; offset: mm in X, Y, Z that are added to a
    machine position while it is selected, None where that is unknown; unsigned: a controller file gives the
    offset without saying which way it counts; pwm: (rpm, percent of its output) pairs of its table (2.4).
    spin_up: seconds that it needs to its speed, whatever the controller waits (``ramp_time``); output: channel that
    runs it while it is on, where no code of the language does; None: not stated. oriented_stop: it can stop in one
    orientation, which back boring needs (Eding manual 3.4.21.10); False: it cannot, or that is unknown.
    """

    number: int
    min_rpm: float | None = None
    max_rpm: float | None = None
    ramp_time: float | None = None
    offset: tuple[float | None, float | None, float | None] = (None, None, None)
    unsigned: bool = False
    pwm: tuple[tuple[float, float], ...] = ()
    spin_up: float | None = None
    output: int | None = None
    oriented_stop: bool = False


@record(frozen=True, slots=True, kw_only=True)
class Controller:
    """What every controller has settings for; those of one alone are in ``Machine.settings``.

    dialect: the language of its programs; None: not stated. version: of the controller's software, as text; None: not
    stated. accepts: what it takes beyond its manual, names of ``ir/dialects/accepts.py``. limits_hold: soft limits hold
    for the "motor" or for the "programmed" position, to which compensation of backlash and pitch adds; None: not
    stated.
    laf_angle: degrees within which successive segments pass without a stop; None: not stated.
    interpolation_time, fifo_time: seconds. max_step_frequency: Hz. homing_mandatory: no job before homing;
    safety_feed: mm/s at most while the safety input is active or the machine not homed; home_is_stop: a home
    sensor stops the machine once it is homed; turning: a lathe, which starts in the X-Z plane; extruder: words E move
    what else is axis A (2.11).
    xz_seen_from: ``+y`` or ``-y``: from where the XZ plane is looked at by G2, G3, G41 and G42; None: not stated.
    straight_traverse: a traverse of several axes is a straight line; None: as the controller's manual says.
    """

    dialect: str | None = None
    version: str | None = None
    accepts: tuple[str, ...] = ()
    limits_hold: str | None = None
    laf_angle: float | None = None
    interpolation_time: float = 0.005
    fifo_time: float = 0.25
    max_step_frequency: float | None = None
    auto_tool_change: bool = False
    absolute_arc_centers: bool = False
    diameter_programming: bool = False
    extruder: bool = False
    xz_seen_from: str | None = None
    spindle_ramp_time: float = 0.0
    homing_mandatory: bool | None = None
    safety_feed: float | None = None
    home_is_stop: bool | None = None
    turning: bool = False
    straight_traverse: bool | None = None


@record(frozen=True, slots=True, kw_only=True)
class Pin:
    """A pin of a board by the board's own name for it. inverted: what it says or is told counts the other way round;
    pull_up: of an input, the board's own resistor pulls it up."""

    name: str
    inverted: bool = False
    pull_up: bool = False


@record(frozen=True, slots=True, kw_only=True)
class WiredMotor:
    """Which pins drive a motor. motor: its name in streams (X, X2). step: inverted where a step is a falling edge;
    direction: inverted where the pin is low for steps that count up; enable: on as long as a host has the board;
    limit: its switch. None: not wired."""

    motor: str
    step: Pin
    direction: Pin
    enable: Pin | None = None
    limit: Pin | None = None


@record(frozen=True, slots=True, kw_only=True)
class WiredOutput:
    """A pin that the program switches. output: ``spindle``, ``spindle_reverse``, ``mist``, ``flood``, or the number of
    an output channel; idle: on after power-up and when the board stops; speed: the one at which the spindle runs when
    it is on, rpm, None: set by hand or not stated."""

    output: str
    pin: Pin
    idle: bool = False
    speed: float | None = None


@record(frozen=True, slots=True, kw_only=True)
class Board:
    """What the board needs between edges: seconds; ticks a second. And its wiring: which pin is for what.

    port, baud: where it is plugged in today, "" and 0 where that is not stated. They are no part of what a package is
    made for: another port is the same machine, another pin is not.
    """

    name: str = "virtual"
    tick_frequency: int = 16_000_000
    step_pulse: float = 2e-6
    direction_setup: float = 5e-6
    motors: tuple[WiredMotor, ...] = ()
    outputs: tuple[WiredOutput, ...] = ()
    probe: Pin | None = None
    port: str = field(default="", compare=False)
    baud: int = field(default=0, compare=False)


TOUCHES = {
    "moves": "jobs that move any axis",
    "limits": "jobs that move any axis; it decides about limits and boundaries alone",
    "arcs": "jobs with arcs",
    "cycles": "jobs with drill cycles",
    "homing": "jobs that home",
    "tools": "jobs that change or measure tools, or switch tool lengths",
    "workspaces": "jobs that use the workspace of the number after the dot",
    "compensation": "jobs that compensate a cutter's diameter",
    "knife": "jobs that switch the tangential knife on",
    "saw": "jobs that switch the saw on",
    "torch": "jobs that burn with the torch",
    "probe": "jobs that measure with the probe",
    "stored": "jobs that move to stored positions",
    "drills": "jobs that lower drills of a bank",
}
"""Which jobs a setting that gproof cannot follow touches."""


@record(frozen=True, slots=True)
class Unmodelled:
    """A setting that is on and that gproof cannot follow.

    what: as the file has it; why: what is not known of it, "" where the setting says all; axis: the only one whose
    place rests on it, so that a job that does not move it may be judged, "" for all; file, line: where it is;
    stated_by: the keys of gproof's own machine file that settle it when they are there, with blanks between;
    touches: the jobs whose path rests on it, a name of ``TOUCHES``, with a number after a dot where there are several
    of a kind; "" for all, or for those that move ``axis``.
    """

    what: str
    why: str = ""
    axis: str = ""
    file: str = ""
    line: int = 0
    stated_by: str = ""
    touches: str = ""

    @property
    def text(self) -> str:
        """As findings name it."""
        return f"{self.what} ({self.why})" if self.why else self.what

    def opens(self, name: str) -> bool:
        """Whether a property cannot be proved of a job that it touches; the arcs' radii rest on no motor."""
        if self.touches == "limits":
            return name == "limits"
        return name != "language" and not (name == "arcs" and (self.axis or self.touches in ("moves", "homing")))


@record(frozen=True, slots=True, kw_only=True)
class Machine:
    """A machine; ``axes`` holds those the machine has, in X Y Z A B C order.

    settings: those of the controller that the machine has (``ir/settings.py``).
    unit: mm in one length unit of the controller's own numbers (25.4 for a machine set up in inches);
    kinematics: ``trivial``, or the name of another that gproof does not follow; z_down_tool_length: length of the
    tool that touches the table with Z all the way down, mm;
    not_modelled: settings that are on and that gproof cannot follow; unknown_keys: (file, key);
    kept: (name, text) of settings that are known and have no bearing on where the axes go. spindle_started: whether
    programs start a spindle on it; False: it has none (knife, torch, laser, nozzle), or one that is switched by hand;
    None: not stated. tool_change_clearance: machine position of Z that has to be reached before a tool is changed,
    None: none is required; clearance_at_start: before the first move of X or Y too.
    """

    name: str
    axes: tuple[Axis, ...]
    tool_change_area: Area | None = None
    keep_out: tuple[Area, ...] = ()
    tools: tuple[Tool, ...] = ()
    spindles: tuple[Spindle, ...] = ()
    controller: Controller = field(default_factory=Controller)
    settings: Settings = NO_SETTINGS
    board: Board = field(default_factory=Board)
    unit: float = 1.0
    not_modelled: tuple[Unmodelled, ...] = ()
    unknown_keys: tuple[tuple[str, str], ...] = ()
    kinematics: str = "trivial"
    knife: Knife | None = None
    z_down_tool_length: float | None = None
    kept: tuple[tuple[str, str], ...] = ()
    spindle_started: bool | None = None
    tool_change_clearance: float | None = None
    clearance_at_start: bool = False

    def word(self, column: int) -> str:
        """The letter that programs give the axis of a column."""
        known = self.axis(AXIS_NAMES[column])
        return AXIS_NAMES[column].upper() if known is None else known.word

    def axis(self, name: str) -> Axis | None:
        """The axis of that name, or None."""
        return next((axis for axis in self.axes if axis.name == name), None)

    def tool(self, number: int) -> Tool | None:
        """The tool table entry, or None."""
        return next((tool for tool in self.tools if tool.number == number), None)

    def spindle(self, number: int) -> Spindle | None:
        """The spindle or head of that number, or None."""
        return next((spindle for spindle in self.spindles if spindle.number == number), None)

    def verify(self) -> None:
        """Names unique and ordered, limits ordered, rates positive; ValueError otherwise."""
        order = [axis.index for axis in self.axes]
        if order != sorted(set(order)):
            raise ValueError("axes must be unique and in X Y Z A B C order")
        for axis in self.axes:
            low, high = axis.boundary_lower, axis.boundary_upper
            if low is not None and high is not None and low > high:
                raise ValueError(f"axis {axis.name}: lower boundary above upper boundary")
        for axis in self.axes:
            for drive in axis.drives():
                drive.verify()


NO_MACHINE = Machine(
    name="(no machine file)",
    axes=tuple(Axis(name=n, kind=AxisKind.LINEAR if i < 3 else AxisKind.ROTARY) for i, n in enumerate(AXIS_NAMES)),
)
"""Used without a machine file: six axes of which nothing is known."""
