"""``[areas.NAME]`` and ``[[keep_out]]`` of gproof's TOML files: the tool change area, and zones that tools keep out of.

docs/machine-files.md, docs/setup-files.md. A zone is a box, or a polygon of X and Y between two heights.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from decimal import Decimal
from fractions import Fraction
from typing import Any

from gproof.frontend.common.exact_numbers import LARGEST, exact_number
from gproof.frontend.common.toml_table import TomlTable, show
from gproof.ir import codes
from gproof.ir.machine import Area

COORDINATE_SYSTEMS = 9
EVERYWHERE = (-math.inf, math.inf)
Pair = tuple[float, float]
Ring = tuple[Pair, ...]


def areas_from(
    root: TomlTable, change: Area | None, keep_out: tuple[Area, ...], unit: Fraction
) -> tuple[Area | None, tuple[Area, ...]]:
    """The tool change area and the zones of a machine file, over those of its base; a name says it again."""
    outer = root.table("areas")
    zones = {area.name: area for area in keep_out}
    for name in outer.values if outer else ():
        assert outer is not None
        table = outer.table(name)
        if table is None:
            continue
        area = _box(table, name, unit)
        table.finish()
        if name == "tool_change":
            change = area
        else:
            zones[name] = area
    for area in keep_out_from(root, unit):
        zones[area.name] = area
    return change, tuple(zones.values())


def keep_out_from(root: TomlTable, unit: Fraction) -> tuple[Area, ...]:
    """The zones of ``[[keep_out]]``, in their order."""
    out: list[Area] = []
    names: set[str] = set()
    for number, table in enumerate(root.tables("keep_out"), 1):
        name = table.text("name")
        if "name" not in table.values:
            table.missing("name")
        if name is not None and name in names:
            table.bad("name", f"there is another zone {name!r} in this file")
        work = table.whole("work", 0, COORDINATE_SYSTEMS)
        label = name or f"keep_out {number}"
        if "polygon" in table.values or "holes" in table.values:
            area = _polygon(table, label, unit)
        else:
            area = _box(table, label, unit)
        table.finish()
        if area is not None:
            names.add(area.name)
            out.append(Area(name=area.name, box=area.box, rings=area.rings, work=work or 0))
    return tuple(out)


def _box(table: TomlTable, name: str, unit: Fraction) -> Area:
    sides = [_range(table, axis, unit) for axis in "xyz"]
    if all(axis not in table.values for axis in "xyz"):
        table.file.add(codes.MISSING_KEY, ".".join(table.path), key=f"{'.'.join(table.path)}.x, .y or .z")
    return Area(name=name, box=(sides[0], sides[1], sides[2]))


def _range(table: TomlTable, key: str, unit: Fraction) -> Pair:
    """[low, high], each a number or an infinity; a key that is left out is unbounded."""
    value = table.take(key)
    if value is None:
        return EVERYWHERE
    ends = [_end(one, unit) for one in value] if isinstance(value, list) else []
    low, high = ends if len(ends) == 2 else (None, None)
    if low is None or high is None:
        table.bad(key, f"{show(value)} is not a list of a lower and an upper end")
        return EVERYWHERE
    if not low < high:
        table.bad(key, f"the lower end {show(value[0])} is not below the upper end {show(value[1])}")
        return EVERYWHERE
    return low, high


def _end(value: Any, unit: Fraction) -> float | None:
    if isinstance(value, float | Decimal) and Decimal(value).is_infinite():
        return math.copysign(math.inf, value)
    exact = exact_number(value)
    return None if exact is None or abs(exact * unit) > LARGEST else float(exact * unit)


def _polygon(table: TomlTable, name: str, unit: Fraction) -> Area | None:
    """``polygon``, ``holes`` and ``z``."""
    rings = [_ring(table, "polygon", table.grid("polygon"), unit)]
    for hole in table.grids("holes"):
        rings.append(_ring(table, "holes", hole, unit))
    z = _range(table, "z", unit)
    for axis in "xy":
        if axis in table.values:
            table.take(axis)
            table.bad(axis, "a polygon must have its X and Y in its points")
    if "polygon" not in table.values:
        table.missing("polygon")
    whole = [ring for ring in rings if ring is not None]
    if len(whole) != len(rings):
        return None
    problem = _problem(whole)
    if problem:
        table.bad("polygon", problem)
        return None
    xs, ys = [x for x, _ in whole[0]], [y for _, y in whole[0]]
    return Area(name=name, box=((min(xs), max(xs)), (min(ys), max(ys)), z), rings=tuple(whole))


def _ring(table: TomlTable, key: str, grid: list[list[Fraction]] | None, unit: Fraction) -> Ring | None:
    if grid is None:
        return None
    if any(len(point) != 2 for point in grid):
        table.bad(key, "a point of a polygon must be a list of its X and Y")
        return None
    points = [(float(point[0] * unit), float(point[1] * unit)) for point in grid]
    if len(points) > 1 and points[0] == points[-1]:
        points.pop()
    if len(points) < 3:
        table.bad(key, "a polygon must have at least three points")
        return None
    return tuple(points)


def _problem(rings: Sequence[Ring]) -> str:
    """What keeps rings from bounding a region, "" for nothing."""
    import shapely

    for n, ring in enumerate(rings):
        if any(a == b for a, b in zip(ring, (*ring[1:], ring[0]), strict=True)):
            return f"{'hole' if n else 'polygon'}: a point is given twice in a row"
    whole = shapely.Polygon(rings[0], rings[1:])
    return "" if whole.is_valid and whole.area > 0 else str(shapely.is_valid_reason(whole)).lower()
