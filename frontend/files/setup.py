"""The setup file (TOML, schema ``gproof-setup/1``): what is known of the machine at this moment.

docs/setup-files.md lists every key; all are optional, and what is not stated is unknown.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

from gproof.frontend.common.exact_numbers import MILLIMETRES
from gproof.frontend.common.frontend import Files, Frontend
from gproof.frontend.common.toml_table import TomlFile, TomlTable, in_range
from gproof.frontend.files.areas_table import keep_out_from
from gproof.frontend.files.height_map import read_height_map
from gproof.frontend.files.machine import HIGHEST_HEAD, HIGHEST_TOOL
from gproof.frontend.files.setup_channels import Columns, axes_of, columns_of, with_channels
from gproof.ir.finding import Findings
from gproof.ir.machine import Machine
from gproof.ir.setup import CylinderMap, InForce, Interval, Setup
from gproof.ir.workpiece import Workpiece

SCHEMA = "gproof-setup/1"
COORDINATE_SYSTEMS = 9
_LINEAR: Columns = {name: (name, False) for name in "xyz"}


def load_setup(
    path: Path, findings: Findings, frontends: Sequence[Frontend], machine: Machine
) -> tuple[Setup | None, Files]:  # fmt: skip
    """The setup in a file, lengths in mm; None, with findings GP601–GP604, when it is bad.

    frontends: of the dialects that there are, some of which have tables of their own; machine: whose axes the file's
    letters name.
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
    tables = [one for one in frontends if one.setup_table in root.values]
    of_dialects = {name: value for one in tables for name, value in one.setup_fields(root).items()}
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
        **of_dialects,
    )
    setup = with_channels(setup, root, unit, columns, machine)
    root.finish()
    return (None if file.errors else in_range(setup, path, findings)), file.files + more


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
        table.bad("factor", "given together with factor_x or factor_y")
    fx, fy = (both, both) if both is not None else (fx, fy)
    if (fx is None) != (fy is None):
        table.missing("factor_x" if fx is None else "factor_y")
    for name in ("factor", "factor_x", "factor_y"):
        if table.values.get(name) == 0:
            table.bad(name, "a factor of 0 moves every point to one place")
    turns = angle is not None and math.fmod(angle, 360.0) != 0.0
    if turns and fx != fy and math.fmod(angle or 0.0, 180.0) != 0.0:
        table.bad("factor_x", "different factors under a rotation: the manual does not say which comes first")
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
