"""``[parameters]`` of setup files: what numbered parameters hold before the job (Eding CNC manual 3.1.1)."""

from __future__ import annotations

from typing import Any

from gproof.frontend.common.toml_table import TomlTable, small_number
from gproof.ir.dialects.eding.rules import EDING
from gproof.ir.setup import Interval


def setup_fields(root: TomlTable) -> dict[str, Any]:
    """The fields of a Setup that the table states."""
    parameters, ranges = _parameters(root.table("parameters"))
    return {"parameters": parameters, "parameter_ranges": ranges}


_ELSEWHERE = {
    "position": "[start] and the offsets",
    "machine_position": "[start]",
    "work": "[work.1] to [work.9]",
    "tool": "tool",
    "tool_radius": "tool and the tool table",
    "tool_z": "tool and the tool table",
    "tool_x": "tool and the tool table",
    "new_tool": "tool",
    "offset_z": "the tool table and G43",
    "offset_x": "the tool table and G43",
    "lower_limit": "the machine file",
    "upper_limit": "the machine file",
    "home_position": "the machine file",
    "area_lower": "the machine file",
    "area_upper": "the machine file",
    "kinematics": "[cylinder] and the machine file",
    "height_map": "[height_map]",
    "simulation": "how the job is run",
    "rendering": "--render",
}
"""Kinds of parameters that show what is stated in another place."""


_CHANGING = ("probe_machine", "probe_input", "hand_wheel")
"""Kinds that change while the job runs: only bounds can be stated."""
_PROBE_JOINTS = 5081
"""From here "probe_machine" repeats the contact (3.1.1): its bounds are those of #5051 to #5056."""


def _mistake(number: int, is_list: bool, low: float) -> str:
    """What is wrong with a stated parameter, "" for nothing."""
    kind = next((e.kind for e in EDING.parameters if e.first <= number <= e.last), "")
    if kind in _ELSEWHERE:
        return f"#{number} comes from {_ELSEWHERE[kind]}, not from [parameters]"
    if kind == "probe_machine" and number >= _PROBE_JOINTS:
        return f"#{number} comes from #{number - _PROBE_JOINTS + 5051}"
    if kind in _CHANGING and not is_list:
        return f"#{number} changes while the job runs: state its lower and upper end as a list"
    if kind in ("head", "work_number", "g92") and is_list:
        return f"#{number} must be one number"
    if kind == "head" and low not in (0.0, 1.0, 2.0):
        return f"#{number} must be 0 (M90), 1 (M91) or 2 (M92)"
    if kind == "rotation" and (is_list or low != 0.0):
        return (
            f"#{number} other than 0 turns a coordinate system, which gproof does not model; state a G68 in [transform]"
        )
    return ""


def _parameters(table: TomlTable | None) -> tuple[dict[int, float], dict[int, Interval]]:
    """Numbered parameters in the program's own numbers: exact ones, and those of which only bounds are stated."""
    highest = EDING.highest_parameter
    found: dict[int, float] = {}
    ranges: dict[int, Interval] = {}
    for name in table.values if table else ():
        assert table is not None
        if small_number(name, 1, highest) is None:
            table.bad(name, f"{name!r} is not a parameter number from 1 to {highest}")
            continue
        is_list = isinstance(table.values[name], list)
        ends = table.interval(name)
        wrong = "" if ends is None else _mistake(int(name), is_list, ends[0])
        if wrong:
            table.bad(name, wrong)
        elif ends is not None and is_list:
            ranges[int(name)] = Interval(*ends)
        elif ends is not None:
            found[int(name)] = ends[0]
    return found, ranges
