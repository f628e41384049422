"""What is known of a McuWIN machine when no file says anything."""

from __future__ import annotations

from dataclasses import replace

from gproof.ir.dialects.mcuwin.settings import NO_MCUWIN_SETTINGS, mcuwin_settings
from gproof.ir.machine import NO_MACHINE, Controller, Machine

NO_MCUWIN: Machine = replace(NO_MACHINE, controller=Controller(dialect="mcuwin"), settings=NO_MCUWIN_SETTINGS)
"""Six axes X Y Z A B C of which nothing is known, and the settings that the manual calls the usual ones."""


def with_axes(machine: Machine) -> Machine:
    """The machine; one of this dialect of which no file names an axis has those of ``NO_MCUWIN``."""
    if machine.controller.dialect != "mcuwin":
        return machine
    return replace(machine, settings=mcuwin_settings(machine), axes=machine.axes or NO_MCUWIN.axes)
