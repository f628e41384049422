"""Machine: what a controller's files say of axes, areas, tools and the board.

Lengths are millimetres, angles degrees, times seconds, whatever the file used. ``None`` is "not stated",
never zero.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass, field
from fractions import Fraction

AXIS_NAMES = ("x", "y", "z", "a", "b", "c")
AXES = len(AXIS_NAMES)


class AxisKind(enum.Enum):
    """Linear axes count millimetres, rotary ones degrees."""

    LINEAR = "linear"
    ROTARY = "rotary"


@dataclass(frozen=True, slots=True, kw_only=True)
class Axis:
    """One axis.

    steps_per_unit: exact, its sign is the motor's direction; lower, upper: soft limits;
    travel_lower, travel_upper: the physical end stops; velocity in unit/s, acceleration in unit/s2;
    slaves: how many further motors follow this axis.
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
    slaves: int = 0

    @property
    def index(self) -> int:
        """Its column in position arrays: X Y Z A B C are 0..5."""
        return AXIS_NAMES.index(self.name)

    @property
    def unit(self) -> str:
        """``mm`` or ``deg``."""
        return "mm" if self.kind is AxisKind.LINEAR else "deg"


@dataclass(frozen=True, slots=True, kw_only=True)
class Area:
    """A box in machine coordinates: ((lower, upper) for X, Y, Z); an unbounded side is infinite."""

    name: str
    box: tuple[tuple[float, float], tuple[float, float], tuple[float, float]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Tool:
    """A tool table entry; lengths in mm, ``None`` where the table does not say."""

    number: int
    length: float | None = None
    x_offset: float | None = None
    diameter: float | None = None
    orientation: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Controller:
    """Settings of the controller that change what a job does.

    laf_angle: degrees within which successive segments pass without a stop; None: not stated.
    interpolation_time, fifo_time: seconds. max_step_frequency: Hz.
    xz_seen_from: ``+y`` or ``-y``: from where the XZ plane is looked at by G2, G3, G41 and G42; None: not stated.
    """

    dialect: str | None = None
    laf_angle: float | None = None
    interpolation_time: float = 0.005
    fifo_time: float = 0.25
    max_step_frequency: float | None = None
    auto_tool_change: bool = False
    absolute_arc_centers: bool = False
    diameter_programming: bool = False
    xz_seen_from: str | None = None
    spindle_ramp_time: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Board:
    """What the board needs between edges: seconds; ticks a second."""

    name: str = "virtual"
    tick_frequency: int = 16_000_000
    step_pulse: float = 2e-6
    direction_setup: float = 5e-6


@dataclass(frozen=True, slots=True, kw_only=True)
class Machine:
    """A machine; ``axes`` holds those the machine has, in X Y Z A B C order.

    unit: mm in one length unit of the controller's own numbers (25.4 for a machine set up in inches);
    not_modelled: settings that are on and that gproof can not follow; unknown_keys: (file, key).
    """

    name: str
    axes: tuple[Axis, ...]
    tool_change_area: Area | None = None
    keep_out: tuple[Area, ...] = ()
    tools: tuple[Tool, ...] = ()
    controller: Controller = field(default_factory=Controller)
    board: Board = field(default_factory=Board)
    unit: float = 1.0
    not_modelled: tuple[str, ...] = ()
    unknown_keys: tuple[tuple[str, str], ...] = ()

    def axis(self, name: str) -> Axis | None:
        """The axis of that name, or None."""
        return next((axis for axis in self.axes if axis.name == name), None)

    def tool(self, number: int) -> Tool | None:
        """The tool table entry, or None."""
        return next((tool for tool in self.tools if tool.number == number), None)

    def verify(self) -> None:
        """Names unique and ordered, limits ordered, rates positive; ValueError otherwise."""
        order = [axis.index for axis in self.axes]
        if order != sorted(set(order)):
            raise ValueError("axes must be unique and in X Y Z A B C order")
        for axis in self.axes:
            for low, high in ((axis.lower, axis.upper), (axis.travel_lower, axis.travel_upper)):
                if low is not None and high is not None and low > high:
                    raise ValueError(f"axis {axis.name}: lower limit {low} above upper limit {high}")
            if axis.steps_per_unit == 0:
                raise ValueError(f"axis {axis.name}: steps_per_unit is zero")
            for rate in (axis.max_velocity, axis.max_acceleration):
                if rate is not None and not rate > 0:
                    raise ValueError(f"axis {axis.name}: velocity and acceleration must be positive")


NO_MACHINE = Machine(
    name="(no machine file)",
    axes=tuple(Axis(name=n, kind=AxisKind.LINEAR if i < 3 else AxisKind.ROTARY) for i, n in enumerate(AXIS_NAMES)),
)
"""Used without a machine file: six axes of which nothing is known."""
