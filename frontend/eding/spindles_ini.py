"""The sections [SPINDLE_0] to [SPINDLE_2] of a ``cnc.ini``. Eding CNC manual 3.5.2 and 2.1.11."""

from __future__ import annotations

from fractions import Fraction

from gproof.frontend.eding.ini_file import Ini
from gproof.ir.machine import Spindle

HEADS = 3
"""Spindle configurations of the file (3.5.2); probe and camera keep their offsets elsewhere."""


def read_spindles(ini: Ini, unit: Fraction) -> tuple[Spindle, ...]:
    """Each section: its speeds, and for all but the first its offset, whose direction 3.5.2 does not tell."""
    spindles = []
    for number in range(HEADS):
        section = f"SPINDLE_{number}"
        if section not in ini.sections:
            continue
        low, high = ini.at_least(section, "spindleNmin", 0.0), ini.rate(section, "spindleNmax")
        if low is not None and high is not None and low > high:
            ini.bad(section, "spindleNmin", "is above spindleNmax")
        x, y, z = (ini.number(section, f"{axis}Offset", unit) if number else 0.0 for axis in "xyz")
        ramp = ini.at_least(section, "spindleRampUpTime", 0.0)
        spindles.append(
            Spindle(number=number, min_rpm=low, max_rpm=high, ramp_time=ramp, offset=(x, y, z), unsigned=number > 0)
        )
    return tuple(spindles)
