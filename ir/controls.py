"""Controls: settings of controllers that take one command a line (WinCNC), where they change what a job does.

Lengths are millimetres, angles degrees, times seconds, whatever the file used; ``None`` is "not stated". Axes go by
their column names (``ir/machine.py`` AXIS_NAMES).
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
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


@dataclass(frozen=True, slots=True, kw_only=True)
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


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasureSwitch:
    """Tool measuring (WinCNC g37=): x, y and i, j: first and second switch; descent: rapid way down; feed: mm/s."""

    x: float | None = None
    y: float | None = None
    i: float | None = None
    j: float | None = None
    descent: float | None = None
    feed: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class DrillSettings:
    """Drilling cycles (WinCNC g81set=, g81dwell=).

    dwell, other_dwell: seconds at the bottom by the one and the other key; approach: mm above the hole's bottom where
    a rapid ends; lift: mm above the top of the hole between pecks.
    """

    dwell: float | None = None
    other_dwell: float | None = None
    approach: float | None = None
    lift: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Lexical:
    """How lines are read.

    comment_signs: characters beside those of the language that begin a comment; skips: (characters, count): a line
    that begins with one of them makes so many lines be left out; comma: a comma is a decimal point too.
    """

    comment_signs: str = ""
    skips: tuple[tuple[str, int], ...] = ()
    comma: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Controls:
    """See the module's text.

    lexical: how lines are read; start, end: lines that run before and behind each job (cmdstart=, cmdend=), abort:
    behind one that is aborted.
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
    helical_arcs: False: an arc that moves another axis is an error.
    inputs, outputs: numbers of the channels that are there; None: no file says so. drill_banks: (first output, count).
    devices: names of features that are set up: ``knife saw laser thc pump da spindle autoaux probe``.
    positions, homes, tool_positions: how many of each can be stored.
    nesting: how deep subprograms may call one another.
    workspaces, changers, measure, drill: see there.
    auto_output: output that is on during feed moves (autoaux=); auto_output_on: from the start; auto_dwell: seconds
    behind switching it on and off; auto_pausing: motion stops for it.
    """

    lexical: Lexical = Lexical()
    start: str = ""
    end: str = ""
    abort: str = ""
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
    helical_arcs: bool = True
    inputs: tuple[int, ...] | None = None
    outputs: tuple[int, ...] | None = None
    drill_banks: tuple[tuple[int, int], ...] = ()
    devices: tuple[str, ...] = ()
    positions: int | None = None
    homes: int | None = None
    tool_positions: int | None = None
    nesting: int | None = None
    workspaces: tuple[Workspace, ...] = ()
    changers: tuple[Changer, ...] = ()
    measure: MeasureSwitch | None = None
    drill: DrillSettings = DrillSettings()
    auto_output: int | None = None
    auto_output_on: bool = False
    auto_dwell: tuple[float, float] = (0.0, 0.0)
    auto_pausing: bool = True


NO_CONTROLS = Controls()
