"""How far an axis may go before one of its motors, or what it turns, is past a limit.

Takes a Machine and a Setup; gives, for each axis, what its limits leave of its programmed positions. Slave motors
have limits of their own; pitch and backlash compensation carry a motor away from its axis; with the Y to A mapping
the limits of A hold for Y. Eding CNC manual 2.1.3, 2.1.5, 2.3, 2.2.5.4; docs/kinematics.md derives the bounds.
"""

from __future__ import annotations

import math

from gproof.ir.machine import Axis, Drive, Machine, PitchTable
from gproof.ir.record import record
from gproof.ir.setup import Setup
from gproof.passes.geometry.pitch import axis_position, motor_position

Range = tuple[float | None, float | None]


@record(frozen=True, slots=True)
class Reach:
    """Ranges of an axis's programmed positions, with the guard on and with it off; None: a limit is not stated.

    stated: outside it a limit is passed for certain; sure: inside it none is, whatever compensation adds;
    what: the compensations that make the difference; unit: of the limits that were stated.
    """

    axis: Axis
    stated: tuple[Range, Range]
    sure: tuple[Range, Range]
    what: str = ""

    @property
    def plain(self) -> bool:
        """True when nothing is added to the axis's positions."""
        return self.stated == self.sure


def reaches(machine: Machine, setup: Setup) -> dict[str, Reach]:
    """By axis name; Y under a mapping has what A leaves it."""
    found = {axis.name: _reach(axis, programmed=_programmed(machine)) for axis in machine.axes}
    if setup.cylinder is not None and "y" in found:
        found["y"] = _mapped(found["y"].axis, found.get("a"), setup)
    return found


def reach_of(machine: Machine, name: str) -> Reach | None:
    """What an axis's own motors leave it."""
    axis = machine.axis(name)
    return None if axis is None else _reach(axis, programmed=_programmed(machine))


def _programmed(machine: Machine) -> bool:
    """Whether the shop says that soft limits hold for programmed positions, to which backlash is added."""
    return machine.controller.limits_hold == "programmed"


def _reach(axis: Axis, *, programmed: bool) -> Reach:
    """programmed: soft limits leave the backlash out; the end stops never do."""
    drives = axis.drives()
    stated: list[Range] = []
    sure: list[Range] = []
    for off in (False, True):
        sides = [(d.travel_lower, d.travel_upper) if off else (d.lower, d.upper) for d in drives]
        stated.append((_most([low for low, _ in sides]), _least([high for _, high in sides])))
        beside = programmed and not off
        inner = [_inner(d, side, 0.0 if beside else d.backlash) for d, side in zip(drives, sides, strict=True)]
        inner += [_inner(d, _ends(d), d.backlash) for d in drives if beside]
        sure.append((_most([low for low, _ in inner]), _least([high for _, high in inner])))
    names = [
        name
        for name, used in (
            ("pitch compensation", any(d.pitch is not None for d in drives)),
            ("backlash compensation", any(d.backlash for d in drives)),
        )
        if used
    ]
    return Reach(axis, (stated[0], stated[1]), (sure[0], sure[1]), " and ".join(names))


def _ends(drive: Drive) -> Range:
    """The end stops of a motor; infinite where they are not stated."""
    low, high = drive.travel_lower, drive.travel_upper
    return -math.inf if low is None else low, math.inf if high is None else high


def _inner(drive: Drive, side: Range, backlash: float) -> Range:
    """Axis positions at which this motor is within ``side`` in every reading of its pitch table and backlash."""
    low, high = side
    return (
        None if low is None else max(_readings(drive.pitch, low + backlash)),
        None if high is None else min(_readings(drive.pitch, high - backlash)),
    )


def _readings(table: PitchTable | None, motor: float) -> tuple[float, ...]:
    """Axis positions at which the motor is at ``motor``: with the table, with it the other way round, without."""
    if table is None or math.isinf(motor):
        return (motor,)
    return motor, axis_position(table, motor), motor_position(table, motor)


def _most(values: list[float | None]) -> float | None:
    return None if None in values else max(v for v in values if v is not None)


def _least(values: list[float | None]) -> float | None:
    return None if None in values else min(v for v in values if v is not None)


def _mapped(axis: Axis, turned: Reach | None, setup: Setup) -> Reach:
    """Y under the mapping: A turns by Y / radius, and is 0 at the stated Y, else at 0 or at the rotation point."""
    cylinder = setup.cylinder
    assert cylinder is not None
    nothing: tuple[Range, Range] = ((None, None), (None, None))
    if cylinder.radius is None or turned is None:
        return Reach(axis, nothing, nothing)
    zeros = [cylinder.zero] if cylinder.zero is not None else [0.0, cylinder.y]
    mm = math.radians(cylinder.radius)
    stated: list[Range] = []
    sure: list[Range] = []
    for k in range(2):
        for from_, into, outer in ((turned.stated[k], stated, True), (turned.sure[k], sure, False)):
            low = [None if zero is None or from_[0] is None else zero + from_[0] * mm for zero in zeros]
            high = [None if zero is None or from_[1] is None else zero + from_[1] * mm for zero in zeros]
            into.append((_least(low), _most(high)) if outer else (_most(low), _least(high)))
    return Reach(axis, (stated[0], stated[1]), (sure[0], sure[1]), "the mapping of Y onto A")


def needed(drive: Drive, low: float, high: float, *, placed: bool) -> tuple[float, float]:
    """The limits that leave a motor the axis positions from ``low`` to ``high``: the other way round than ``_reach``.

    placed: they are machine positions; else only their distance counts, and a pitch table adds what is not known.
    """
    table = drive.pitch if placed else None
    return min(_readings(table, low)) - drive.backlash, max(_readings(table, high)) + drive.backlash
