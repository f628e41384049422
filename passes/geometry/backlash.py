"""How a motor takes up its backlash in a stream: by how many steps, and how fast compared with what its axis does.

The Eding CNC manual (2.1.5) says that compensation asks more of a motor's acceleration and leaves open how much. Here
the motor keeps its greatest acceleration: a share of it is for the backlash, and the axis is planned with the rest.
"""

from __future__ import annotations

import math
from fractions import Fraction

from gproof.ir.machine import Drive

SHARE = 0.5
"""Of a motor's acceleration, for taking up its backlash."""


def backlash_steps(drive: Drive) -> int:
    """Whole steps that the motor makes to take up its backlash; 0 for one that cannot move for lack of data."""
    if drive.steps_per_unit is None or drive.max_velocity is None or drive.max_acceleration is None:
        return 0
    return round(abs(Fraction(drive.backlash) * drive.steps_per_unit))


def take_up_rates(drive: Drive) -> tuple[float, float]:
    """unit/s and unit/s2 with which a motor takes up its backlash, over what its axis does meanwhile."""
    assert drive.max_acceleration is not None
    assert drive.max_velocity is not None
    acceleration = SHARE * drive.max_acceleration
    return min(math.sqrt(acceleration * drive.backlash), 0.5 * drive.max_velocity), acceleration


def left_for_axis(drive: Drive, interpolation_time: float) -> tuple[float, float]:
    """Shares of the motor's velocity and acceleration with which its axis may be planned.

    While backlash is taken up, for at most twice the time that ``take_up_rates`` needs to get to its speed, the axis
    comes from rest, or from a junction's jump: its velocity is the motor's own wherever that leaves enough room.
    """
    if not backlash_steps(drive):
        return 1.0, 1.0
    assert drive.max_velocity is not None
    speed, acceleration = take_up_rates(drive)
    rest = acceleration * (1.0 - SHARE) / SHARE
    reached = rest * (speed / acceleration + drive.backlash / speed + interpolation_time)
    if reached + speed <= drive.max_velocity:
        return 1.0, 1.0 - SHARE
    return 1.0 - speed / drive.max_velocity, 1.0 - SHARE
