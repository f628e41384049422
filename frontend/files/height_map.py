"""``[height_map]`` of a setup file: a grid in the file itself, or a table of points next to it.

The controller's own format is not documented (Eding CNC manual 2.2.5.5 names the file only); this one is gproof's: a
line for each point with its machine X, Y and measured Z, in the setup's unit, in any order; ``;`` or ``#`` starts a
comment. The points make a full grid with equal steps in X and Y.
"""

from __future__ import annotations

import hashlib
from fractions import Fraction

from gproof.frontend.common.number_rows import number_rows
from gproof.frontend.common.paths import is_file
from gproof.frontend.common.toml_table import TomlTable, show
from gproof.ir import codes
from gproof.ir.finding import Span
from gproof.ir.setup import HeightMap

GRID = Fraction(1, 100)
"""Of a step: how far a point may be from where the grid has it."""

CANDIDATES = 200
"""Distances that are tried as the size of a step."""

Point = tuple[Fraction, Fraction, Fraction]


def read_height_map(table: TomlTable | None, unit: Fraction) -> tuple[HeightMap | None, list[tuple[str, str]]]:
    """The map, and (name, sha256) of the file it came from; None, with findings, when it is bad."""
    if table is None:
        return None, []
    on = table.boolean("on")
    name = table.text("file")
    files: list[tuple[str, str]] = []
    found: HeightMap | None = None
    if name is not None:
        points, files = _points(table, name)
        if points:
            found = _from_points(table, name, points, unit)
    else:
        found = _inline(table, unit)
    table.finish()
    if found is None:
        return None, files
    problem = found.problem()
    if problem is not None:
        table.bad("file" if name is not None else "heights", problem)
        return None, files
    stated = HeightMap(
        x=found.x, y=found.y, size=found.size, heights=found.heights, name=name or "", on=True if on is None else on
    )
    return stated, files


def _inline(table: TomlTable, unit: Fraction) -> HeightMap | None:
    for key in ("x", "y", "size", "heights"):
        if key not in table.values:
            table.missing(key)
    x, y, size = table.number("x", unit=unit), table.number("y", unit=unit), table.positive("size", unit=unit)
    heights = table.grid("heights")
    if x is None or y is None or size is None or heights is None:
        return None
    return HeightMap(x=x, y=y, size=size, heights=tuple(tuple(float(h * unit) for h in row) for row in heights))


def _points(table: TomlTable, name: str) -> tuple[list[Point], list[tuple[str, str]]]:
    """The points of a file; a finding at each line that is none."""
    target = table.file.path.parent / name
    if not is_file(target):
        table.bad("file", f"{show(name)}: no such file")
        return [], []
    try:
        raw = target.read_bytes()
    except OSError as error:
        table.bad("file", f"{show(name)}: {error.strerror or error}")
        return [], []
    files = [(str(target), hashlib.sha256(raw).hexdigest())]
    points: list[Point] = []
    good = True
    for number, row in number_rows(raw.decode("latin-1").replace(",", " "), 3):
        if row is None:
            good = False
            what = "a point of a height map must be X, Y and Z"
            table.file.add_at(codes.FILE_UNREADABLE, Span(str(target), number), what=what)
        else:
            points.append((row[0], row[1], row[2]))
    if good and not points:
        good = False
        table.bad("file", f"{name} has no points")
    return (points if good else []), files


def _from_points(table: TomlTable, name: str, points: list[Point], unit: Fraction) -> HeightMap | None:
    """The grid that the points make: the first of their distances that fits all of them."""
    x0, y0 = min(x for x, _, _ in points), min(y for _, y, _ in points)
    sides = sorted({x - x0 for x, _, _ in points} | {y - y0 for _, y, _ in points})
    problem = "the points do not make a grid"
    # A row has at most as many points as there are in all; a smaller spacing comes from points off their places.
    sizes = [size for size in sides if size > 0 and size * len(points) >= sides[-1]]
    for size in sizes[:CANDIDATES]:
        cells, wrong = _cells(points, x0, y0, size)
        if cells is not None:
            columns, rows = 1 + max(i for i, _ in cells), 1 + max(j for _, j in cells)
            heights = tuple(tuple(float(cells[i, j] * unit) for i in range(columns)) for j in range(rows))
            return HeightMap(x=float(x0 * unit), y=float(y0 * unit), size=float(size * unit), heights=heights)
        problem = wrong if size == sizes[0] else problem
    table.bad("file", f"{name}: {problem}")
    return None


def _cells(
    points: list[Point], x0: Fraction, y0: Fraction, size: Fraction
) -> tuple[dict[tuple[int, int], Fraction] | None, str]:
    """Heights by column and row, or what is wrong with this size of steps."""
    cells: dict[tuple[int, int], Fraction] = {}
    for x, y, z in points:
        u, v = (x - x0) / size, (y - y0) / size
        place = round(u), round(v)
        where = f"the point X{float(x):g} Y{float(y):g}"
        if abs(u - place[0]) > GRID or abs(v - place[1]) > GRID:
            return None, f"{where} is off the grid of {float(size):g} mm"
        if place in cells:
            return None, f"{where} is given twice"
        cells[place] = z
    missing = (1 + max(i for i, _ in cells)) * (1 + max(j for _, j in cells)) - len(cells)
    return (None, f"{missing} points of the grid are missing") if missing else (cells, "")
