"""What the kernel of the validator needs of a machine and of what it is set up for."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gproof.ir.drives import AXIS_NAMES, DrivenAxis, Drives

if TYPE_CHECKING:
    from gproof.ir.machine import Machine
    from gproof.ir.setup import Setup


def drives_of(machine: Machine, setup: Setup) -> Drives:
    """What is stated of a machine that is well formed, and of what it is set up for."""
    controller, board = machine.controller, machine.board
    knife = machine.settings.knife
    return Drives(
        axes=tuple(DrivenAxis(axis.index, axis.drives(), axis.tip_feed) for axis in machine.axes),
        tick_frequency=board.tick_frequency,
        step_pulse=board.step_pulse,
        direction_setup=board.direction_setup,
        interpolation_time=controller.interpolation_time,
        max_step_frequency=controller.max_step_frequency,
        spindle_ramp_time=controller.spindle_ramp_time,
        limits_programmed=controller.limits_hold == "programmed",
        auto_tool_change=controller.auto_tool_change,
        knife_turned=knife is not None and bool(knife.output is not None or knife.target or knife.blend),
        homed=setup.homed,
        start=tuple(setup.interval(f"start.{name}") for name in AXIS_NAMES),
        height_map=setup.height_map,
        cylinder=setup.cylinder,
    )
