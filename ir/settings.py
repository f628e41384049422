"""Settings: what a controller is set up to do, where it changes what a job does.

A Machine has one object of them: that of its controller (``EdingSettings``, ``WinCncSettings``, ``McuWinSettings`` of
``ir/dialects/``), or a plain ``Settings`` where no file says anything of one. Here are the fields that are read where
no controller is known; one without such a setting leaves them at their defaults, which change nothing.
Lengths are millimetres, angles degrees, times seconds; ``None`` is "not stated". Axes go by their column names
(``ir/machine.py`` AXIS_NAMES).
"""

from __future__ import annotations

from gproof.ir.record import record


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
class HomingLine:
    """Axes that home together (one g28move= line of WinCNC; the lines in order are the order of homing).

    distances: (column, mm or degrees) that each axis goes from its switch at the end: above 0 from a low one, below 0
    from a high one; retreat: mm off the switch after the first contact; feed, second_feed: mm/s towards it; longest:
    mm that an axis moves at most; alternate: the alternate switches count; singly: one axis after the other.
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
class Settings:
    """See the module's text.

    unit_stated: a file says in what numbers count.
    coolant: outputs that switch coolant.
    devices: features that are set up, by name; None: no file says which.
    absolute: the distance mode at the start; None: that of the job before.
    position_unit: mm in one unit of positions, whatever programs say; None: not stated.
    arc_tolerance: mm by which start and end radius may differ; None: as the controller's manual says.
    smallest_arc: mm; arcs below are lines.
    arcs_share_feed: an F of lines holds for arcs and the reverse; False: each keeps its own; None: not stated.
    forced: ((lower, upper) of X and Y) outside of which nothing goes.
    workspaces: those that are preconfigured.
    zero_offsets: a table of zero offsets, that of G54 first, six columns X to C; None: not stated.
    auto_output: output that is on during feed moves.
    smoothing: corners are rounded, or velocities planned otherwise than gproof does.
    homing: lines in the order of homing.
    knife, saw, torch: see there.
    backlash: (column, mm or degrees) that the file has, though its compensation is off at the start.
    nesting: how deep subprograms may call one another.
    """

    unit_stated: bool = True
    coolant: tuple[int, ...] = ()
    devices: tuple[str, ...] | None = None
    absolute: bool | None = None
    position_unit: float | None = None
    arc_tolerance: float | None = None
    smallest_arc: float | None = None
    arcs_share_feed: bool | None = None
    forced: tuple[tuple[float | None, float | None], tuple[float | None, float | None]] | None = None
    workspaces: tuple[Workspace, ...] = ()
    zero_offsets: tuple[tuple[float, ...], ...] | None = None
    auto_output: int | None = None
    smoothing: bool = False
    homing: tuple[HomingLine, ...] = ()
    knife: KnifeMode | None = None
    saw: SawMode | None = None
    torch: TorchControl | None = None
    backlash: tuple[tuple[str, float], ...] = ()
    nesting: int | None = None


NO_SETTINGS = Settings()
"""Of a machine of whose controller no file says anything."""
