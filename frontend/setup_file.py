"""The setup file (TOML, schema ``gproof-setup/1``): what is known of the machine at this moment.

docs/setup-files.md lists every key; all are optional, and what is not stated is unknown.
"""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

from gproof.frontend.height_map_file import read_height_map
from gproof.frontend.machine_file import HIGHEST_TOOL, Files
from gproof.frontend.toml_table import MILLIMETRES, TomlFile, TomlTable, small_number
from gproof.ir.dialects import rules_named
from gproof.ir.finding import Findings
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.setup import Cylinder, Interval, Setup

SCHEMA = "gproof-setup/1"
COORDINATE_SYSTEMS = 9


def load_setup(path: Path, findings: Findings) -> tuple[Setup | None, Files]:
    """The setup in a file, lengths in mm; None, with findings GP601–GP604, when it is bad."""
    file = TomlFile(path, SCHEMA, findings)
    root = file.root
    if root is None:
        return None, file.files
    unit = MILLIMETRES[root.text("units", tuple(MILLIMETRES)) or "mm"]
    work: dict[tuple[int, str], Interval] = {}
    for number, table in root.numbered("work", 1, COORDINATE_SYSTEMS):
        work |= {(number, axis): value for axis, value in _axes(table, unit).items()}
    lengths: dict[int, Interval] = {}
    for number, table in root.numbered("tools", 1, HIGHEST_TOOL):
        length = table.interval("length", unit=unit)
        if length is not None:
            lengths[number] = Interval(*length)
        table.finish()
    parameters, ranges = _parameters(root.table("parameters"))
    height_map, more = read_height_map(root.table("height_map"), unit)
    setup = Setup(
        name=root.text("name") or path.name,
        homed=_homed(root),
        start=_axes(root.table("start"), unit),
        work=work,
        g92=_axes(root.table("g92"), unit),
        tool_lengths=lengths,
        parameters=parameters,
        parameter_ranges=ranges,
        active_work=root.whole("active_work", 1, COORDINATE_SYSTEMS),
        tool=root.whole("tool", 0, HIGHEST_TOOL),
        block_delete=root.boolean("block_delete"),
        optional_stop=root.boolean("optional_stop"),
        cylinder=_cylinder(root.table("cylinder"), unit),
        height_map=height_map,
    )
    root.finish()
    return (None if file.errors else setup), file.files + more


def _cylinder(table: TomlTable | None, unit: Fraction) -> Cylinder | None:
    """``[cylinder]``: Y is mapped onto A."""
    if table is None:
        return None
    cylinder = Cylinder(
        radius=table.positive("radius", unit=unit),
        y=table.number("y", unit=unit),
        z=table.number("z", unit=unit),
        zero=table.number("zero", unit=unit),
    )
    table.finish()
    return cylinder


def _axes(table: TomlTable | None, unit: Fraction) -> dict[str, Interval]:
    """Values by axis name; X Y Z are lengths, A B C degrees."""
    if table is None:
        return {}
    found = {}
    for axis in AXIS_NAMES:
        ends = table.interval(axis, unit=unit if axis in "xyz" else Fraction(1))
        if ends is not None:
            found[axis] = Interval(*ends)
    table.finish()
    return found


def _homed(root: TomlTable) -> tuple[str, ...]:
    value = root.take("homed")
    if value is None:
        return ()
    if not isinstance(value, list) or any(axis not in AXIS_NAMES for axis in value):
        root.bad("homed", f"not a list of axes such as {list(AXIS_NAMES[:3])}")
        return ()
    return tuple(axis for axis in AXIS_NAMES if axis in value)


_ELSEWHERE = {
    "position": "[start] and the offsets",
    "machine_position": "[start]",
    "g92": "[g92]",
    "work": "[work.1] to [work.9]",
    "tool": "tool",
    "lower_limit": "the machine file",
    "upper_limit": "the machine file",
    "home_position": "the machine file",
    "area_lower": "the machine file",
    "area_upper": "the machine file",
}
"""Kinds of parameters that show what is stated in another place."""


def _stated_elsewhere(number: int) -> str:
    for entry in rules_named("eding").parameters:
        if entry.first <= number <= entry.last:
            return _ELSEWHERE.get(entry.kind, "")
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
        place = _stated_elsewhere(int(name))
        if place:
            table.bad(name, f"#{name} follows from {place}, not from [parameters]")
            continue
        is_list = isinstance(table.values[name], list)
        ends = table.interval(name)
        if ends is not None and is_list:
            ranges[int(name)] = Interval(*ends)
        elif ends is not None:
            found[int(name)] = ends[0]
    return found, ranges
