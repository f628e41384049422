"""Setup: what only the machine at that moment knows. Exact, an interval, or unknown (the default)."""

from __future__ import annotations

from gproof.ir.drives import CylinderMap, HeightMap, Interval
from gproof.ir.machine import Area, Machine
from gproof.ir.record import field, record
from gproof.ir.workpiece import Workpiece

__all__ = ["NOTHING", "ZERO", "CylinderMap", "HeightMap", "InForce", "Interval", "Setup", "StoredPosition"]

_STATED = ("start", "work", "g92", "tool", "head")
"""Kinds of symbols that a setup can state."""


@record(frozen=True, slots=True, kw_only=True)
class InForce:
    """A rotation or a scaling of X and Y that is in force when the job starts (Eding manual 3.4.13, 3.4.18).

    angle: degrees, counter-clockwise, 0 for none (the zeroing menu leaves one, 2.2.4.3); factor_x, factor_y: 1 for no
    scaling; None: not stated; x, y: the point that both are about, mm in coordinates of the active system.
    """

    angle: float | None = None
    factor_x: float | None = None
    factor_y: float | None = None
    x: float = 0.0
    y: float = 0.0


@record(frozen=True, slots=True, kw_only=True)
class StoredPosition:
    """A place that the controller has stored (WinCNC P#, H#, T#): machine mm or degrees by column name.

    lift: vertical axes go up first and down last; clearance: to this machine height, None: not stated.
    """

    axes: dict[str, float]
    lift: bool = False
    clearance: float | None = None


@record(frozen=True, slots=True, kw_only=True)
class Setup:
    """The stated part of the machine's state.

    homed: axes that have had their reference run, None: not stated; an axis that is stated and not among them has had
    none, and its machine positions are unknown. start: machine position by axis name;
    work: offsets of coordinate systems 1..9 by (number, axis); g92: axis offsets;
    tool_lengths: by tool number; parameters: numbered variables in the
    controller's numbering; parameter_ranges: those that are only bounded, and what the operator or a measurement will
    put into them; resident: what an earlier job has kept of
    variables (McuWIN M901, M903); default_*: what everything not listed is (None: unknown).
    cylinder: Y is mapped onto A, for the whole job; height_map: measured and loaded. Offsets are mm or degrees;
    parameters are in the program's own numbers. heads: what is added to positions while a head (``Op.HEAD``) is
    selected, by (number, axis); transform: of X and Y, None where nothing is stated.
    positions: stored places by letter and number (``P4``); inputs, outputs, virtual: states of channels, 0 or 1;
    answers: 1 yes, 0 no, to the questions of the job in their order.
    measures: of tools, in force when the job starts, by axis (WinCNC M37): the machine position at which its
    workspace is 0; contacts: where a move may end that a switch ends, machine positions by axis.
    workpiece: stock, part and fixtures, None where nothing is stated; keep_out: zones that the tool must not enter.
    """

    name: str = "(none)"
    homed: tuple[str, ...] | None = None
    start: dict[str, Interval] = field(default_factory=dict)
    work: dict[tuple[int, str], Interval] = field(default_factory=dict)
    g92: dict[str, Interval] = field(default_factory=dict)
    tool_lengths: dict[int, Interval] = field(default_factory=dict)
    parameters: dict[int, float] = field(default_factory=dict)
    parameter_ranges: dict[int, Interval] = field(default_factory=dict)
    resident: dict[int, Interval] = field(default_factory=dict)
    active_work: int | None = None
    tool: int | None = None
    default_start: float | None = None
    default_offset: float | None = None
    default_parameter: float | None = None
    block_delete: bool | None = None
    optional_stop: bool | None = None
    cylinder: CylinderMap | None = None
    height_map: HeightMap | None = None
    heads: dict[tuple[int, str], Interval] = field(default_factory=dict)
    transform: InForce | None = None
    positions: dict[str, StoredPosition] = field(default_factory=dict)
    inputs: dict[int, float] = field(default_factory=dict)
    outputs: dict[int, float] = field(default_factory=dict)
    virtual: dict[int, float] = field(default_factory=dict)
    answers: dict[int, float] = field(default_factory=dict)
    measures: dict[str, Interval] = field(default_factory=dict)
    contacts: dict[str, Interval] = field(default_factory=dict)
    workpiece: Workpiece | None = None
    keep_out: tuple[Area, ...] = ()

    def interval(self, symbol: str) -> Interval | None:
        """What is stated of a symbol such as ``start.x``, ``work.1.x``, ``g92.x``, ``tool.3.z``.

        None for what arises in the run (``probe.1.x``, ``home.2.z``, ``?``): no setup states that, the usual
        assumption of no offsets included.
        """
        kind, *rest = symbol.split(".")
        found: Interval | None = None
        default = self.default_offset if kind in _STATED else None
        if kind == "start":
            found, default = self.start.get(rest[0]), self.default_start
        elif kind == "work":
            found = self.work.get((int(rest[0]), rest[1]))
        elif kind == "g92":
            found = self.g92.get(rest[0])
        elif kind == "tool":
            number = int(rest[0])
            found = self.measures.get(rest[1]) if number == 0 and rest[1] in self.measures else None
            found = self.tool_lengths.get(number) if found is None else found
        elif kind == "head":
            # A symbol only where nothing exact is stated, or without its sign: no default holds for it.
            found, default = self.heads.get((int(rest[0]), rest[1])), None
        if found is None and default is not None:
            return Interval(default, default)
        return found

    def unhomed(self, machine: Machine) -> frozenset[int]:
        """Columns of the machine's axes that are stated to have had no reference run; none where nothing is stated."""
        if self.homed is None:
            return frozenset()
        return frozenset(axis.index for axis in machine.axes if axis.name not in self.homed)

    def parameter(self, number: int) -> float | None:
        """The stated value of a numbered parameter; None where only bounds are stated."""
        default = None if number in self.parameter_ranges else self.default_parameter
        return self.parameters.get(number, default)


ZERO = Setup(
    name="zero",
    homed=("x", "y", "z", "a", "b", "c"),
    active_work=1,
    tool=0,
    default_start=0.0,
    default_offset=0.0,
    default_parameter=0.0,
    block_delete=False,
)
"""The usual simulator's assumption: homed, at machine position 0, no offsets, parameters 0, tool 0.

The switch for optional stops stays open: M1 stops."""

NOTHING = Setup()
"""No value is given."""
