"""A machine's axes with what else limits them: forced limits of the controller, backlash that a program sets."""

from __future__ import annotations

import dataclasses

from gproof.ir.machine import Axis, Machine


def with_forced(machine: Machine) -> Machine:
    """The machine with its forced limits as limits, which no switch turns off (WINCNC.INI Settings: forcelim=).

    They are no end stops: below a forced limit under the soft one the travel still has to be stated.
    """
    forced = machine.settings.forced
    if forced is None:
        return machine
    axes = []
    for axis in machine.axes:
        low = forced[axis.index][0] if axis.index < len(forced) else None
        if low is None:
            axes.append(axis)
            continue
        above = axis.lower is not None and low >= axis.lower
        travel = axis.travel_lower
        travel = low if travel is None and above else travel if travel is None else max(travel, low)
        lower = low if axis.lower is None else max(axis.lower, low)
        axes.append(dataclasses.replace(axis, lower=lower, travel_lower=travel))
    return dataclasses.replace(machine, axes=tuple(axes))


def with_backlash(axis: Axis, amount: float) -> Axis:
    """The axis with at least that much backlash in each of its motors."""
    if amount <= min((drive.backlash for drive in axis.drives()), default=0.0):
        return axis
    slaves = tuple(
        slave if slave.backlash is None else dataclasses.replace(slave, backlash=max(slave.backlash, amount))
        for slave in axis.slaves
    )
    return dataclasses.replace(axis, backlash=max(axis.backlash, amount), slaves=slaves)
