"""The setup file (TOML, schema ``gproof-setup/1``): what is known of the machine at this moment.

docs/setup-files.md lists every key; all are optional, and what is not stated is unknown.
"""

from __future__ import annotations

import math
import re
from fractions import Fraction
from pathlib import Path

from gproof.frontend.common.exact_numbers import MILLIMETRES
from gproof.frontend.common.frontend import Files
from gproof.frontend.files.areas_table import keep_out_from
from gproof.frontend.files.height_map import read_height_map
from gproof.frontend.files.machine import HIGHEST_HEAD, HIGHEST_TOOL
from gproof.frontend.files.setup_channels import Columns, axes_of, columns_of, with_channels
from gproof.frontend.files.toml_table import TomlFile, TomlTable, in_range, small_number
from gproof.ir.dialects import rules_named
from gproof.ir.dialects.mcuwin import COMMON, PROTECTED
from gproof.ir.finding import Findings
from gproof.ir.machine import NO_MACHINE, Machine
from gproof.ir.setup import CylinderMap, InForce, Interval, Setup
from gproof.ir.workpiece import Workpiece

SCHEMA = "gproof-setup/1"
COORDINATE_SYSTEMS = 9
_RESIDENT = re.compile(r"C([ID])([1-9][0-9]{2})", re.ASCII)
_LINEAR: Columns = {name: (name, False) for name in "xyz"}


def load_setup(path: Path, findings: Findings, machine: Machine = NO_MACHINE) -> tuple[Setup | None, Files]:
    """The setup in a file, lengths in mm; None, with findings GP601–GP604, when it is bad.

    machine: whose axes the file's letters name.
    """
    file = TomlFile(path, SCHEMA, findings)
    root = file.root
    if root is None:
        return None, file.files
    unit = MILLIMETRES[root.text("units", tuple(MILLIMETRES)) or "mm"]
    columns = columns_of(machine)
    work: dict[tuple[int, str], Interval] = {}
    for number, table in root.numbered("work", 1, COORDINATE_SYSTEMS):
        work |= {(number, axis): value for axis, value in axes_of(table, unit, columns).items()}
    lengths: dict[int, Interval] = {}
    for number, table in root.numbered("tools", 1, HIGHEST_TOOL):
        length = table.interval("length", unit=unit)
        if length is not None:
            lengths[number] = Interval(*length)
        table.finish()
    in_force = root.interval("tool_length", unit=unit)
    if in_force is not None:
        lengths[0] = Interval(*in_force)
    parameters, ranges = _parameters(root.table("parameters"))
    heads: dict[tuple[int, str], Interval] = {}
    for number, table in root.numbered("heads", 1, HIGHEST_HEAD):
        heads |= {(number, axis): value for axis, value in axes_of(table, unit, _LINEAR).items()}
    height_map, more = read_height_map(root.table("height_map"), unit)
    workpiece: Workpiece | None = None
    if {"workpiece", "stock", "part", "fixtures"} & root.values.keys():
        from gproof.frontend.files.workpiece import read_workpiece

        workpiece, others = read_workpiece(root, unit)
        more += others
    setup = Setup(
        name=root.text("name") or path.name,
        homed=_homed(root, columns),
        start=axes_of(root.table("start"), unit, columns),
        work=work,
        g92=axes_of(root.table("g92"), unit, columns),
        tool_lengths=lengths,
        parameters=parameters,
        parameter_ranges=ranges,
        resident=_resident(root.table("resident")),
        active_work=root.whole("active_work", 1, COORDINATE_SYSTEMS),
        tool=root.whole("tool", 0, HIGHEST_TOOL),
        block_delete=root.boolean("block_delete"),
        optional_stop=root.boolean("optional_stop"),
        cylinder=_cylinder(root.table("cylinder"), unit),
        height_map=height_map,
        heads=heads,
        transform=_transform(root.table("transform"), unit),
        keep_out=keep_out_from(root, unit),
        workpiece=workpiece,
    )
    setup = with_channels(setup, root, unit, columns, machine)
    root.finish()
    return (None if file.errors else in_range(setup, path, findings)), file.files + more


def _resident(table: TomlTable | None) -> dict[int, Interval]:
    """``[resident]``: what M901 and M903 of an earlier job have kept, by the names of McuWIN: ``CI601``, ``CD601``."""
    found: dict[int, Interval] = {}
    for name in table.values if table else ():
        assert table is not None
        written = _RESIDENT.fullmatch(name.upper())
        ends = table.interval(name)
        if written is None or not PROTECTED <= int(written[2]) < COMMON:
            table.bad(name, f"{name!r} is not CI or CD and a number from {PROTECTED} to {COMMON - 1}")
            continue
        if ends is None:
            continue
        whole = written[1] == "I"
        if whole and not all(end == math.floor(end) and abs(end) < 2.0**31 for end in ends):
            table.bad(name, f"{name} is a whole number of 32 bits")
            continue
        found[int(written[2]) + COMMON * whole] = Interval(*ends)
    return found


def _cylinder(table: TomlTable | None, unit: Fraction) -> CylinderMap | None:
    """``[cylinder]``: Y is mapped onto A."""
    if table is None:
        return None
    cylinder = CylinderMap(
        radius=table.positive("radius", unit=unit),
        y=table.number("y", unit=unit),
        z=table.number("z", unit=unit),
        zero=table.number("zero", unit=unit),
    )
    table.finish()
    return cylinder


def _transform(table: TomlTable | None, unit: Fraction) -> InForce | None:
    """``[transform]``: what G68 and G51 have left in force, about one point (3.4.13, 3.4.18)."""
    if table is None:
        return None
    angle, both = table.number("angle"), table.number("factor")
    fx, fy = table.number("factor_x"), table.number("factor_y")
    if both is not None and not (fx is None and fy is None):
        table.bad("factor", "given beside factor_x or factor_y")
    fx, fy = (both, both) if both is not None else (fx, fy)
    if (fx is None) != (fy is None):
        table.missing("factor_x" if fx is None else "factor_y")
    for name in ("factor", "factor_x", "factor_y"):
        if table.values.get(name) == 0:
            table.bad(name, "a factor of 0 puts every point into one")
    turns = angle is not None and math.fmod(angle, 360.0) != 0.0
    if turns and fx != fy and math.fmod(angle or 0.0, 180.0) != 0.0:
        table.bad("factor_x", "different factors under a rotation: no section says which of the two comes first")
    x, y = table.number("x", unit=unit), table.number("y", unit=unit)
    if turns or (fx, fy) not in ((None, None), (1.0, 1.0)):
        for axis in "xy":
            if axis not in table.values:
                table.missing(axis)
    table.finish()
    return InForce(angle=angle, factor_x=fx, factor_y=fy, x=x or 0.0, y=y or 0.0)


def _homed(root: TomlTable, columns: Columns) -> tuple[str, ...] | None:
    """``homed``: the axes that have had their reference run, an empty list: none; None: not stated."""
    value = root.take("homed")
    if value is None:
        return None
    if not isinstance(value, list) or any(not isinstance(axis, str) or axis not in columns for axis in value):
        root.bad("homed", f"not a list of axes such as {list(columns)[:3]}")
        return None
    return tuple(column for name, (column, _) in columns.items() if name in value)


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
    "simulation": "the way it is run",
    "rendering": "--render",
}
"""Kinds of parameters that show what is stated in another place."""


_CHANGING = ("probe_machine", "probe_input", "hand_wheel")
"""Kinds that change while the job runs: only bounds can be stated."""
_PROBE_JOINTS = 5081
"""From here "probe_machine" repeats the contact (3.1.1): its bounds are those of #5051 to #5056."""


def _mistake(number: int, is_list: bool, low: float) -> str:
    """What is wrong with a stated parameter, "" for nothing."""
    kind = next((e.kind for e in rules_named("eding").parameters if e.first <= number <= e.last), "")
    if kind in _ELSEWHERE:
        return f"#{number} follows from {_ELSEWHERE[kind]}, not from [parameters]"
    if kind == "probe_machine" and number >= _PROBE_JOINTS:
        return f"#{number} follows from #{number - _PROBE_JOINTS + 5051}"
    if kind in _CHANGING and not is_list:
        return f"#{number} changes while the job runs: state a list of its lower and upper end"
    if kind in ("head", "work_number", "g92") and is_list:
        return f"#{number} is one number"
    if kind == "head" and low not in (0.0, 1.0, 2.0):
        return f"#{number} is 0 (M90), 1 (M91) or 2 (M92)"
    if kind == "rotation" and (is_list or low != 0.0):
        return (
            f"#{number} other than 0 turns a coordinate system, which gproof does not model; [transform] states a G68"
        )
    return ""


def _parameters(table: TomlTable | None) -> tuple[dict[int, float], dict[int, Interval]]:
    """Numbered parameters in the program's own numbers: exact ones, and those of which only bounds are stated."""
    highest = rules_named("eding").highest_parameter
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
