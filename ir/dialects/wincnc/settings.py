"""WinCncSettings: what a WinCNC controller is set up to do, where it changes a job. Units as of ``ir/settings.py``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gproof.ir.finding import Span
from gproof.ir.record import field, record
from gproof.ir.settings import Settings

if TYPE_CHECKING:
    from gproof.ir.machine import Machine

DEVICES = (
    "knife", "saw", "laser", "laserscan", "thc", "bevel", "pump", "da", "spindle", "autoaux", "probe", "axisadj",
    "drillbank", "spinmac", "axismap",
)  # fmt: skip
"""Features that a machine file can set up (``Settings.devices``)."""
HIGHEST_CHANNEL = 64
"""Of inputs and outputs, where no file says otherwise: the most that the manual has (Virtual AuxIn Indicators)."""


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
class Lexical:
    """How lines are read.

    comment_signs: characters besides those of the language that start a comment; skips: (characters, count): a line
    that starts with one of them makes so many lines be left out; comma: a comma is a decimal point too; continued:
    words after a closed comment are executed; numbered: lines may have numbers of their own (both: ``accepts`` of
    the machine file).
    """

    comment_signs: str = ""
    skips: tuple[tuple[str, int], ...] = ()
    comma: bool = False
    continued: bool = False
    numbered: bool = False


@record(frozen=True, slots=True, kw_only=True)
class WinCncSettings(Settings):
    """See the module's text.

    lexical: how lines are read.
    start, end: lines that run before and after each job (cmdstart=, cmdend=); abort: after one that is aborted; places:
    by these three names where each is, no part of the value.
    arcs_modal: lines without a command after an arc are arcs (g2modal=, arcs=, arctype=).
    feed_groups: columns of the axes that share a feed, a text for each group (vgroup=).
    command_group: columns whose feed an F without axes sets.
    soft_limits: checked from the start, None: not stated; limits_available: they can be switched on (softlim=T).
    adjust_boundary: a target beyond a boundary is moved onto it (softlim=B1); adjust_vertical: so are limits and
    boundaries of vertical axes (softlim=V1).
    shift_sign: whether a workspace's shift is added to (+1) or taken from (-1) a position; None: not stated.
    knife_positions: lifted and lowered of the knife count from the machine's zero (machine) or as axis words do (work);
    None: not stated.
    helical_arcs: False: an arc that moves another axis is an error.
    inputs, outputs: numbers of the channels that are there; None: no file says so.
    unsteady_outputs: those that the controller itself switches with motion or at a pause (auxout= T2, T3, W).
    drill_banks: (first output, count).
    positions, homes, tool_positions: how many of each can be stored.
    around_files: start and end run around each file that a job calls, too; None: not stated.
    array_order: the cells of an array of rows and columns are cut row by row (rows) or column by column (columns); "":
    not stated.
    highest_channel: of inputs and outputs; None: any.
    rotation_sign: whether an angle of G52 turns counter-clockwise (+1) or clockwise (-1).
    virtual_on: which of L60 and L61 switches a virtual input on.
    changers, measure, drill: see there.
    auto_output_on: the output of feed moves (autoaux=) from the start; auto_dwell: seconds after switching it on and
    off; auto_pausing: motion stops for it.
    axis_order: columns in the order of the controller's axis numbers (axischar=), 0 first.
    probe_input, probe_axis: channel and column of the probe.
    compensation_entry: cutter compensation starts with a move of its own (cutcomp=T1); compensation_swapped: left and
    right are exchanged (cutcomp= D below 0).
    override: (lowest, highest) percent that a program may set; None: no file says so; override_enabled: it may at all;
    rapids_unlocked: velocities of rapids may be changed too.
    Of ``Settings``: unit_stated is unit=, absolute nmode=, arc_tolerance arc_err=, smallest_arc arc_min=, forced
    forcelim=, devices those of ``DEVICES``, smoothing any of accel=, g08=, g09=, vmatch=, autoarcfeed= and axisvel= C,
    homing the lines g28move=, backlash that of axisspec= B with backlash= B0, auto_output that of autoaux=.
    """

    lexical: Lexical = Lexical()
    start: str = ""
    end: str = ""
    abort: str = ""
    arcs_modal: bool = False
    feed_groups: tuple[str, ...] = ()
    command_group: str = ""
    soft_limits: bool | None = None
    limits_available: bool = True
    adjust_boundary: bool = False
    adjust_vertical: bool = False
    shift_sign: int | None = None
    knife_positions: str | None = None
    helical_arcs: bool = True
    inputs: tuple[int, ...] | None = None
    outputs: tuple[int, ...] | None = None
    unsteady_outputs: tuple[int, ...] = ()
    drill_banks: tuple[tuple[int, int], ...] = ()
    positions: int | None = None
    homes: int | None = None
    tool_positions: int | None = None
    around_files: bool | None = None
    array_order: str = ""
    highest_channel: int | None = None
    rotation_sign: int = 1
    virtual_on: int = 61
    changers: tuple[Changer, ...] = ()
    measure: MeasureSwitch | None = None
    drill: DrillSettings = DrillSettings()
    auto_output_on: bool = False
    auto_dwell: tuple[float, float] = (0.0, 0.0)
    auto_pausing: bool = True
    axis_order: str = ""
    probe_input: int | None = None
    probe_axis: str = "z"
    compensation_entry: bool = False
    compensation_swapped: bool = False
    override: tuple[float | None, float | None] | None = None
    override_enabled: bool = True
    rapids_unlocked: bool = False
    places: tuple[tuple[str, Span], ...] = field(default=(), compare=False, repr=False)

    def place(self, name: str) -> Span | None:
        """Where a line is that runs before or after the job; None when no file with lines says so."""
        return dict(self.places).get(name)


NO_WINCNC_SETTINGS = WinCncSettings()


def wincnc_settings(machine: Machine) -> WinCncSettings:
    """The settings of a WinCNC machine; the usual ones where the machine's files state those of none."""
    own = machine.settings
    return own if isinstance(own, WinCncSettings) else NO_WINCNC_SETTINGS
