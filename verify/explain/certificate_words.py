"""What messages of the certificate's checker call offsets, switches and ranges: words of a machine, none of the file's.

Decides nothing; ``verify/certificate/check.py`` does.
"""

from __future__ import annotations

import math

from gproof.ir.setup import CylinderMap, HeightMap, InForce

SETTINGS = {
    "active_work": "the active work offset",
    "tool": "the tool in the spindle",
    "default_start": "the start positions that are not listed",
    "default_offset": "the offsets that are not listed",
    "default_parameter": "the variables that are not listed",
    "block_delete": "the block delete switch",
    "optional_stop": "the optional stop switch",
    "transform": "the rotation and scaling of X and Y",
    "cylinder": "the mapping onto a cylinder",
    "height_map": "the height map",
    "workpiece": "stock, part and fixtures",
    "homed": "the homed axes",
}
"""Fields of a Setup in words."""
_NAMES = ("none", "G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3")


def between(low: float, high: float) -> str:
    """A range of lengths or angles: ``from 1 to 5``, ``at least 1``, ``1`` for one value, ``any value``."""
    if low == high:
        return number(low)
    if math.isfinite(low) and math.isfinite(high):
        return f"from {number(low)} to {number(high)}"
    ends = [f"at least {number(low)}"] * math.isfinite(low) + [f"at most {number(high)}"] * math.isfinite(high)
    return " and ".join(ends) or "any value"


def number(value: float) -> str:
    """A number with at most four decimals, and more where they are all that it has."""
    short = f"{value + 0.0:.4f}".rstrip("0").rstrip(".")
    return f"{value:g}" if value and float(short) == 0.0 else "0" if short == "-0" else short


def setting(name: str, value: object) -> str:
    """The value of a field of a Setup in words; None: not stated."""
    if isinstance(value, HeightMap):
        return f"{value.name or 'that of the setup file'} ({'on' if value.on else 'off'})"
    if isinstance(value, CylinderMap):
        parts = {"radius": value.radius, "Y": value.y, "Z": value.z, "zero": value.zero}
        return " ".join(f"{part} {number(at)}" for part, at in parts.items() if at is not None) or "one without numbers"
    if isinstance(value, InForce):
        return _in_force(value)
    if value is None:
        return "none" if name in ("cylinder", "height_map") else "not in the setup"
    if isinstance(value, bool):
        return "on" if value else "off"
    if name == "active_work" and isinstance(value, int) and 0 <= value < len(_NAMES):
        return _NAMES[value]
    if isinstance(value, int | float):
        return number(value)
    return str(value) if isinstance(value, str) else "another one"


def _in_force(value: InForce) -> str:
    parts = {"angle": value.angle, "factor of X": value.factor_x, "factor of Y": value.factor_y}
    said = [f"{part} {'not given' if at is None else number(at)}" for part, at in parts.items()]
    return f"{', '.join(said)}, about X{number(value.x)} Y{number(value.y)}"
