"""Machines of other controllers that are like a given one: equal axes, travel, limits, zero places, tools and spindle.

What the target needs besides to have spindle, coolant, tool changes and outputs is stated as a shop would: WinCNC has
them in CNC.MAC, McuWIN in Task 0.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path

from gproof.driver.dialects import load_machine
from gproof.ir.dialects.mcuwin.settings import mcuwin_settings
from gproof.ir.finding import Findings
from gproof.ir.machine import Axis, Machine, Tool

FILE = "machine.toml"
SHOP = {
    "CNC.MAC": "M3=M11C22\nM4=M11C21\nM5=M98 REST.MAC\nM6=M98 CHANGE.MAC\nM7=M11C24\nM8=M11C23\nM9=M98 DRY.MAC\n",
    "REST.MAC": "M12C21\nM12C22\n",
    "DRY.MAC": "M12C23\nM12C24\n",
    "CHANGE.MAC": "G53 Z0\nG4 [put it in]\nL101 T{t}\n",
}
"""A shop with WinCNC: the spindle both ways, mist and flood, a tool change by hand [Macro File Configuration];
outputs 1 to 20 are free for jobs."""
CONTROLS = """
[controls]
absolute = true
feed_groups = ["xy"]
command_group = "xy"
"""
DIN = """
[din]
version = "2.5.3.133"
case_sensitive = true
line_numbers = false
position_unit = "mm"
time_unit = "min"
absolute_centers = false
interpolation_axes = "{letters}"
angle_unit = "radians"
wait_unit = "ms"
tool_file = "{tools}"
pre_include = ""
post_include = ""
shortest_path = false
error_compensation = false
program_size = {size}
{zeros}
[din.task0]
M0 = "stop"
M2 = "end"
M3 = "spindle_cw"
M4 = "spindle_ccw"
M5 = "spindle_off"
M6 = "tool_change"
M8 = "coolant_on"
M9 = "coolant_off"
M30 = "end"
S = "spindle_speed"
T = "tool_select"
G74 = "home"
"""


def machine_like(source: Path, to: str, folder: Path) -> Path:
    """A machine file for a controller, in a folder that exists, of the machine that another one describes."""
    machine = _read(source)
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in SHOP.items() if to == "wincnc" else ():
        (folder / name).write_text(text, encoding="utf-8")
    path = folder / FILE
    path.write_text("\n".join(_lines(machine, to)) + "\n", encoding="utf-8")
    _read(path)
    return path


def _read(path: Path) -> Machine:
    findings = Findings()
    machine, _ = load_machine(path, findings)
    if machine is None:
        raise ValueError(f"{path}: {[one.message for one in findings.kept]}")
    return machine


def _lines(machine: Machine, to: str) -> Iterator[str]:
    yield 'schema = "gproof-machine/1"\nunits = "mm"'
    for axis in machine.axes:
        yield from _axis(axis, to)
    for tool in machine.tools:
        yield from _tool(tool)
    yield from _records(machine)
    for spindle in machine.spindles:
        yield f"\n[spindles.{spindle.number}]"
        yield from _stated(min_rpm=spindle.min_rpm, max_rpm=spindle.max_rpm)
    yield "\n[controller]"
    if to == "eding":
        yield from _stated(diameter_programming=machine.controller.diameter_programming or None)
    if to in ("eding", "wincnc", "mcuwin"):
        yield f'dialect = "{to}"'
    if to == "wincnc":
        yield CONTROLS
    if to == "mcuwin":
        linear = "".join(axis.word for axis in machine.axes if axis.unit == "mm")
        own = mcuwin_settings(machine)
        size = own.program_size if machine.controller.dialect == "mcuwin" else 500_000
        zeros = [[0.0] * len(machine.axes)] * 5
        yield DIN.format(letters=linear, tools="", zeros=f"zero_offsets = {zeros}", size=size)


def _axis(axis: Axis, to: str) -> Iterator[str]:
    yield f'\n[axes.{axis.name}]\nkind = "{axis.kind.value}"'
    yield from _stated(
        steps_per_unit=axis.steps_per_unit, min=axis.lower, max=axis.upper, travel_min=axis.travel_lower,
        travel_max=axis.travel_upper, max_velocity=axis.max_velocity, max_acceleration=axis.max_acceleration,
        home_place=axis.home_place, letter=axis.letter or None,
    )  # fmt: skip
    if to == "mcuwin":
        yield f'position_unit = "{axis.unit}"'


def _records(machine: Machine) -> Iterator[str]:
    """Tools that only the controller's own table has (McuWIN 2.7): record 0 is none."""
    listed = {0, *(tool.number for tool in machine.tools)}
    for one in mcuwin_settings(machine).tools or () if machine.controller.dialect == "mcuwin" else ():
        if one.plane == "xy" and one.number not in listed:
            yield f"\n[tools.{one.number}]"
            yield from _stated(diameter=None if one.radius is None else 2.0 * one.radius)


def _tool(tool: Tool) -> Iterator[str]:
    yield f"\n[tools.{tool.number}]"
    yield from _stated(length=tool.length, diameter=tool.diameter, x_offset=tool.x_offset, orientation=tool.orientation)


def _stated(**values: object) -> Iterator[str]:
    """Keys that have a value."""
    for name, value in values.items():
        if isinstance(value, bool):
            yield f"{name} = {str(value).lower()}"
        elif isinstance(value, Fraction | str):
            yield f'{name} = "{value}"'
        elif isinstance(value, int | float) and math.isfinite(value):
            yield f"{name} = {value!r}"
