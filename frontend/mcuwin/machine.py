"""What is known of a McuWIN machine when no file says anything."""

from __future__ import annotations

from dataclasses import replace

from gproof.ir.din import NO_DIN
from gproof.ir.machine import NO_MACHINE, Controller, Machine

NO_MCUWIN: Machine = replace(NO_MACHINE, controller=Controller(dialect="mcuwin", din=NO_DIN))
"""Six axes X Y Z A B C of which nothing is known, and the settings that the manual calls the usual ones."""


def with_axes(machine: Machine) -> Machine:
    """The machine; one of this dialect of which no file names an axis has those of ``NO_MCUWIN``."""
    if machine.controller.dialect != "mcuwin":
        return machine
    controller = replace(machine.controller, din=machine.controller.din or NO_DIN)
    return replace(machine, controller=controller, axes=machine.axes or NO_MCUWIN.axes)
