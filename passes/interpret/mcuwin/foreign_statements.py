"""What a setup or machine file states that controllers of DIN blocks with Pascal inside (McuWIN) do not have: GP630.

Such a statement is true of another controller, or is meant for a setting that has another name here. Nothing of it
reaches the job's answer, so that the answer is UNKNOWN. Source: APCI-8001 G-code manual, McuWIN V 2.5.3.133, which has
no rotation and no scaling (3), lengths of tools in ToolComp.INI alone (2.7), five records of zero offsets (3.19), and
whole numbers in CI (11).
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from gproof.ir.dialects.mcuwin.rules import COMMON, DECLARED
from gproof.ir.dialects.mcuwin.settings import mcuwin_settings
from gproof.ir.machine import AXIS_NAMES, Machine
from gproof.ir.setup import Interval, Setup

RECORDS = 5
"""Of zero offsets: G54 to G58 (3.19, 14 (2.5.3.23))."""
_FIRST_INPUT = 101
"""Digital inputs have the number of their axis in front (4.11, 7)."""


def _contradicted(setup: Setup, machine: Machine, name: str) -> bool:
    """Whether [g92] and the record that active_work names state zero offsets in force that exclude each other."""
    number, now = setup.active_work, setup.g92.get(name)
    if number is None or now is None or number > RECORDS:
        return False
    record = setup.work.get((number, name))
    table = mcuwin_settings(machine).zero_offsets or ()
    if record is None and number <= len(table):
        record = Interval(table[number - 1][AXIS_NAMES.index(name)], table[number - 1][AXIS_NAMES.index(name)])
    return record is not None and (record.high < now.low or record.low > now.high)


def foreign(setup: Setup, machine: Machine) -> Iterator[tuple[str, str]]:
    """(what of both no McuWIN has, in words of the files, its dotted key); what is neutral everywhere is left out."""
    turned = setup.transform
    if turned is not None and (
        math.fmod(turned.angle or 0.0, 360.0) or (turned.factor_x or 1.0, turned.factor_y or 1.0) != (1.0, 1.0)
    ):
        yield "[transform]: this controller has no code that rotates or scales", "setup.transform"
    if any(ends.low or ends.high for ends in setup.heads.values()):
        yield "[heads]: this controller has no code that selects a head", "setup.heads"
    if setup.cylinder is not None:
        yield "[cylinder]: a cylinder is programmed by G51 (3.17)", "setup.cylinder"
    if setup.height_map is not None:
        yield "[height_map]: this controller follows no height map", "setup.height_map"
    lengths = [number for number, ends in setup.tool_lengths.items() if ends.low or ends.high]
    if lengths:
        key = f"setup.tools.{min(lengths)}" if min(lengths) else "setup.tool_length"
        yield "lengths of tools ([tools], tool_length): this controller has them in ToolComp.INI (2.7)", key
    if any(ends.low or ends.high for ends in setup.measures.values()):
        yield "[measures]: this controller has lengths of tools in ToolComp.INI (2.7)", "setup.measures"
    beyond = [number for (number, _), ends in setup.work.items() if number > RECORDS and (ends.low or ends.high)]
    if beyond:
        said = "[work.6] and on: there are five records of zero offsets, G54 to G58 (3.19)"
        yield said, f"setup.work.{min(beyond)}"
    if setup.active_work is not None and setup.active_work > RECORDS:
        said = f"active_work = {setup.active_work}: there are five records of zero offsets, G54 to G58 (3.19)"
        yield said, "setup.active_work"
    other = [name for name in AXIS_NAMES if _contradicted(setup, machine, name)]
    if other:
        names = " ".join(name.upper() for name in other)
        said = (
            f"active_work = {setup.active_work} together with [g92], which states another active zero offset for "
            f"{names}"
        )
        yield said, f"setup.g92.{other[0]}"
    strange = [number for number in setup.inputs if number < _FIRST_INPUT]
    if strange:
        yield f'[inputs] {strange[0]}: inputs here have an axis, "X.digib.1" (7)', f"setup.inputs.{strange[0]}"
    stated = {**{n: (v, v) for n, v in setup.parameters.items()},
              **{n: (r.low, r.high) for n, r in setup.parameter_ranges.items()}}  # fmt: skip
    for number, ends in sorted(stated.items()):
        key = f"setup.parameters.{number}"
        if number >= DECLARED:
            yield f"[parameters] {number}: the number of CD0 is 0, of CI0 {COMMON}, and of CI999 {DECLARED - 1}", key
        elif number >= COMMON and not all(end == math.floor(end) and abs(end) < 2.0**31 for end in ends):
            yield f"[parameters] {number}: CI{number - COMMON} is a whole number of 32 bits (11)", key
    controller = machine.controller
    for key in ("diameter_programming", "absolute_arc_centers", "turning", "extruder"):
        if getattr(controller, key):
            yield f"{key} of the machine file: this controller does not have it", f"machine.controller.{key}"
    if machine.knife is not None:
        yield "[knife] of the machine file: this controller turns no knife", "machine.knife"
    if "controls" in mcuwin_settings(machine).foreign:
        yield "[controls] of the machine file: settings of another controller", "machine.controls"
