"""Drives: what proving a stream needs of a Machine and a Setup, and nothing else of them.

The trusted base reads this, not the Machine: motors with all that bounds them, the board's and the controller's times,
where the job starts, a height map, a mapping onto a cylinder. ``ir/machine_drives.py`` takes them out. Lengths are
millimetres, angles degrees, times seconds; ``None`` is "not stated", never zero.
"""

from __future__ import annotations

import itertools
import math
from fractions import Fraction
from typing import NamedTuple

from gproof.ir.record import record

AXIS_NAMES = ("x", "y", "z", "a", "b", "c")
AXES = len(AXIS_NAMES)


@record(frozen=True, slots=True)
class Interval:
    """low <= value <= high, in mm or degrees; exact when both are equal."""

    low: float
    high: float

    @property
    def exact(self) -> bool:
        """True when only one value is possible."""
        return self.low == self.high


@record(frozen=True, slots=True, kw_only=True)
class PitchTable:
    """Where the axis really is when its motor is meant to be at a position (Eding manual 2.3).

    machine: positions of the motor, mm or degrees; calibrated: what was measured there. Both rise; between points
    the map is linear, beyond the first and last point the correction stays what it is there. An axis that is to be
    at a calibrated position needs its motor at the machine position paired with it. docs/kinematics.md: the readings.
    """

    machine: tuple[float, ...]
    calibrated: tuple[float, ...]

    def problem(self) -> str | None:
        """What keeps the table from being a map that can be turned round."""
        if len(self.machine) != len(self.calibrated) or len(self.machine) < 1:
            return "a pitch table needs pairs of positions"
        for name, column in (("machine", self.machine), ("calibrated", self.calibrated)):
            if not all(math.isfinite(value) for value in column):
                return f"a {name} position is not finite"
            if any(not b > a for a, b in itertools.pairwise(column)):
                return f"{name} positions must rise from line to line"
        return None


@record(frozen=True, slots=True, kw_only=True)
class CylinderMap:
    """Y is mapped onto A: the surface of a cylinder as if it were the X-Y plane (Eding manual 2.2.5.4).

    radius: mm; y, z: machine position of the axis of rotation; zero: machine Y at which A is 0. None: not stated.
    """

    radius: float | None = None
    y: float | None = None
    z: float | None = None
    zero: float | None = None


@record(frozen=True, slots=True, kw_only=True)
class HeightMap:
    """Measured heights of a surface, to which Z is raised or lowered (Eding manual 2.2.5.5).

    x, y: machine position of the first point; size: mm between points; heights: rows by rising Y, each by rising X,
    mm. What is added to Z is the height, between points bilinear, less that of the first point; outside the
    measured range nothing. name: of the file it came from; on: compensation is on when the job starts.
    """

    x: float
    y: float
    size: float
    heights: tuple[tuple[float, ...], ...]
    name: str = ""
    on: bool = True

    def problem(self) -> str | None:
        """What keeps the heights from being a grid."""
        if len(self.heights) < 2 or len(self.heights[0]) < 2:
            return "a height map has at least 2 rows of 2 heights"
        if any(len(row) != len(self.heights[0]) for row in self.heights):
            return "the rows of a height map are of one length"
        if not all(math.isfinite(value) for row in self.heights for value in row):
            return "a height is not a finite number"
        if not (math.isfinite(self.x) and math.isfinite(self.y) and self.size > 0 and math.isfinite(self.size)):
            return "the grid's origin or size is not a usable number"
        return None


class Drive(NamedTuple):
    """One motor of an axis with everything that bounds it; what a slave leaves open is the axis's."""

    name: str
    steps_per_unit: Fraction | None
    lower: float | None
    upper: float | None
    travel_lower: float | None
    travel_upper: float | None
    max_velocity: float | None
    max_acceleration: float | None
    backlash: float
    pitch: PitchTable | None

    def verify(self) -> None:
        """Limits ordered, rates positive, the pitch table a map; ValueError otherwise."""
        where = f"axis {self.name.lower()}"
        for low, high in ((self.lower, self.upper), (self.travel_lower, self.travel_upper)):
            if low is not None and high is not None and low > high:
                raise ValueError(f"{where}: lower limit {low} above upper limit {high}")
        if self.steps_per_unit == 0:
            raise ValueError(f"{where}: steps_per_unit is zero")
        for rate in (self.max_velocity, self.max_acceleration):
            if rate is not None and not rate > 0:
                raise ValueError(f"{where}: velocity and acceleration must be positive")
        problem = self.pitch.problem() if self.pitch is not None else None
        if problem is not None:
            raise ValueError(f"{where}: {problem}")


class DrivenAxis(NamedTuple):
    """An axis: its column in position arrays, its motors, the axis's own first; tip_feed: see ``Axis``."""

    column: int
    drives: tuple[Drive, ...]
    tip_feed: bool


class Drives(NamedTuple):
    """The machine's axes in X Y Z A B C order, and what bounds all motors.

    tick_frequency: Hz, step_pulse, direction_setup: of the board; interpolation_time, max_step_frequency (Hz),
    spindle_ramp_time: of the controller; limits_programmed: limits hold for programmed positions, to which compensation
    adds; auto_tool_change: the changer's cycle is in the rows; knife_turned: by the controller, not by rows.
    homed: names of axes that have had their reference run; start: the stated start by column.
    """

    axes: tuple[DrivenAxis, ...]
    tick_frequency: int
    step_pulse: float
    direction_setup: float
    interpolation_time: float
    max_step_frequency: float | None
    spindle_ramp_time: float
    limits_programmed: bool
    auto_tool_change: bool
    knife_turned: bool
    homed: tuple[str, ...] | None
    start: tuple[Interval | None, ...]
    height_map: HeightMap | None
    cylinder: CylinderMap | None

    def verify(self) -> None:
        """Axes in their order, each motor what it has to be; ValueError otherwise."""
        order = [axis.column for axis in self.axes]
        if order != sorted(set(order)) or not set(order) <= set(range(AXES)) or len(self.start) != AXES:
            raise ValueError("axes must be unique and in X Y Z A B C order")
        for axis in self.axes:
            for drive in axis.drives:
                drive.verify()
