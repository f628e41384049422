"""What is on the table, from a setup file: ``[stock]``, ``[[part]]``, ``[[fixtures]]`` and ``[workpiece]``.

Each table is one thing: a box, a cylinder, a polygon, outlines of a DXF drawing or the mesh of an STL file, turned
about the zero it counts from (``rotate``) and then moved (``shift``). docs/setup-files.md lists the keys. Bad input is
a finding GP601 to GP604 at its line; files are named with their hashes.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from gproof.frontend.common.exact_numbers import MILLIMETRES
from gproof.frontend.common.paths import is_file
from gproof.frontend.common.toml_table import TomlTable, show
from gproof.ir import codes
from gproof.ir.columns import Columns
from gproof.ir.finding import Span
from gproof.ir.record import record
from gproof.ir.workpiece import (
    ACTIVE,
    MACHINE,
    TRIANGLES,
    Body,
    Box,
    Cylinder,
    Mesh,
    Placed,
    Point,
    Prism,
    Workpiece,
)

Files = list[tuple[str, str]]

COORDINATE_SYSTEMS = 9
_WORK = {"machine": MACHINE, "active": ACTIVE}
_DEFAULT = Workpiece()
KINDS = ("box", "cylinder", "polygon", "dxf", "stl")
CHORD = 0.1
"""Of the tolerance: how far chords may be from the curves of a drawing."""
JOIN = 0.01
"""mm that the ends of pieces of a drawing may be apart, when the table says nothing."""


@record(frozen=True, slots=True)
class Move:
    """Turned by an angle (degrees, counter-clockwise) about the zero, then moved (mm)."""

    angle: float
    shift: tuple[float, float, float]

    @property
    def turn(self) -> tuple[float, float]:
        """Cosine and sine, exact for quarters of a turn."""
        quarter = self.angle / 90.0
        if quarter == round(quarter):
            return ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[round(quarter) % 4]
        return math.cos(math.radians(self.angle)), math.sin(math.radians(self.angle))

    def point(self, x: float, y: float) -> Point:
        """A place in the plane."""
        return self.points(((x, y),))[0]

    def points(self, ring: Sequence[Point]) -> tuple[Point, ...]:
        """Places in the plane."""
        (c, s), (u, v) = self.turn, self.shift[:2]
        return tuple((x * c - y * s + u + 0.0, x * s + y * c + v + 0.0) for x, y in ring)

    def height(self, z: float) -> float:
        """A height."""
        return z + self.shift[2]


class Reader:
    """The tables of one setup file. unit: mm in its unit; files: what they name, with hashes."""

    def __init__(self, unit: Fraction, tolerance: float) -> None:
        self.unit = unit
        self.tolerance = tolerance
        self.files: Files = []

    def placed(self, table: TomlTable, name: str) -> list[Placed]:
        """The bodies of one table."""
        file = next((table.values[key] for key in ("dxf", "stl") if isinstance(table.values.get(key), str)), name)
        name = table.text("name") or Path(file).name or name
        stated = table.text("units", tuple(MILLIMETRES))
        unit = self.unit if stated is None else MILLIMETRES[stated]
        work = _work(table)
        move = Move(table.number("rotate") or 0.0, _shift(table, unit))
        kinds = [kind for kind in KINDS if kind in table.values]
        if not kinds:
            table.file.add(codes.MISSING_KEY, ".".join(table.path), key=f"{'.'.join(table.path)}.{' or .'.join(KINDS)}")
            bodies: Sequence[Body] = ()
        elif len(kinds) > 1:
            table.bad(kinds[1], f"given together with {kinds[0]}: a table is one body")
            bodies = ()
        else:
            bodies = _MAKERS[kinds[0]](self, table, unit, move, stated)
        if bodies:
            table.finish()  # else reading stopped early, and only what is no key at all is a mistake
        return [Placed(name=name, body=body, work=work) for body in bodies]

    def _box(self, table: TomlTable, unit: Fraction, move: Move, stated: str | None) -> Sequence[Body]:
        """``box = [[x, y, z], [x, y, z]]``: two corners, the lower one first."""
        corners = table.grid("box")
        if corners is None:
            return ()
        if len(corners) != 2 or any(len(corner) != 3 for corner in corners):
            table.bad("box", "a box must have its lower and its upper corner, X, Y and Z each")
            return ()
        low, high = ([float(value * unit) for value in corner] for corner in corners)
        for axis, one, other in zip("XYZ", low, high, strict=True):
            if one >= other:
                table.bad("box", f"the upper corner is not above the lower one in {axis}")
                return ()
        if move.angle % 90.0:
            corner = ((low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1]))
            ends = move.height(low[2]), move.height(high[2])
            return (Prism(outline=tuple(move.point(*at) for at in corner), low=ends[0], high=ends[1]),)
        ends_xy = [move.point(low[0], low[1]), move.point(high[0], high[1])]
        return (Box(
            low=(min(x for x, _ in ends_xy), min(y for _, y in ends_xy), move.height(low[2])),
            high=(max(x for x, _ in ends_xy), max(y for _, y in ends_xy), move.height(high[2])),
        ),)  # fmt: skip

    def _cylinder(self, table: TomlTable, unit: Fraction, move: Move, stated: str | None) -> Sequence[Body]:
        """``cylinder = {x, y, diameter, bottom, top}``."""
        inner = table.table("cylinder")
        if inner is None:
            return ()
        for key in ("x", "y", "diameter", "bottom", "top"):
            if key not in inner.values:
                inner.missing(key)
        x, y, diameter = (
            inner.number("x", unit=unit),
            inner.number("y", unit=unit),
            inner.positive("diameter", unit=unit),
        )
        ends = _heights(inner, unit)
        inner.finish()
        if x is None or y is None or diameter is None or ends is None:
            return ()
        center = move.point(x, y)
        return (Cylinder(
            x=center[0], y=center[1], radius=diameter / 2.0, low=move.height(ends[0]), high=move.height(ends[1])
        ),)  # fmt: skip

    def _polygon(self, table: TomlTable, unit: Fraction, move: Move, stated: str | None) -> Sequence[Body]:
        """``polygon = [[x, y], …]`` with ``holes``, ``pockets``, ``bottom`` and ``top``."""
        from gproof.frontend.common.outlines import Pocket

        rings = [_ring(table, "polygon", table.take("polygon"), unit)]
        holes = table.take("holes")
        for hole in holes if isinstance(holes, list) else [] if holes is None else [holes]:
            rings.append(_ring(table, "holes", hole, unit))
        ends = _heights(table, unit)
        pockets = []
        for inner in table.tables("pockets"):
            if "floor" not in inner.values:
                inner.missing("floor")
            if "polygon" not in inner.values:
                inner.missing("polygon")
                continue
            ring, floor = _ring(inner, "polygon", inner.take("polygon"), unit), inner.number("floor", unit=unit)
            islands = inner.take("holes")
            others = [_ring(inner, "holes", one, unit) for one in (islands if isinstance(islands, list) else [])]
            inner.finish()
            if ring is None or floor is None or None in others or not _within(inner, "floor", floor, ends):
                return ()
            pockets.append(Pocket((ring, *(one for one in others if one is not None)), floor))
        given = [ring for ring in rings if ring is not None]
        if ends is None or len(given) < len(rings):
            return ()
        return self._prisms(table, "polygon", given, ends, pockets, move, 0.0)

    def _prisms(
        self, table: TomlTable, key: str, rings: Sequence[Sequence[Point]], ends: tuple[float, float],
        pockets: Sequence[Any], move: Move, error: float,
    ) -> Sequence[Body]:  # fmt: skip
        from gproof.frontend.common.outlines import OutlineError, prisms

        try:
            made = prisms(rings, *ends, pockets, error)
        except OutlineError as wrong:
            table.bad(key, str(wrong))
            return ()
        return tuple(
            replace(
                prism, outline=move.points(prism.outline), holes=tuple(move.points(hole) for hole in prism.holes),
                low=move.height(prism.low), high=move.height(prism.high),
            )
            for prism in made
        )  # fmt: skip

    def _dxf(self, table: TomlTable, unit: Fraction, move: Move, stated: str | None) -> Sequence[Body]:
        """``dxf = "plate.dxf"`` with ``layers``, ``bottom`` and ``top``."""
        from gproof.frontend.common.dxf import DxfError, Sheet, open_drawing

        target = self._file(table, "dxf")
        heights = _heights(table, unit) if "layers" not in table.values else None
        layered = table.table("layers")
        join = table.positive("join", unit=unit, zero=True)
        if layered is None and heights is None:
            return ()
        if target is None:
            return ()
        try:
            sheet: Sheet = open_drawing(target)
            if sheet.unit is not None and stated is not None and sheet.unit != float(unit):
                what = f"{stated}, but {target.name} says {sheet.unit_name} ($INSUNITS)"
                table.bad("units", what)
                return ()
            scale = float(unit) if sheet.unit is None else sheet.unit
            return self._layers(table, layered, sheet, scale, unit, heights, JOIN if join is None else join, move)
        except (DxfError, OSError) as wrong:
            said = wrong.strerror if isinstance(wrong, OSError) else str(wrong)
            table.file.add(codes.FILE_UNREADABLE, table.name_of("dxf"), what=f"{target.name}: {said}")
            return ()

    def _layers(
        self, table: TomlTable, layered: TomlTable | None, sheet: Any, scale: float, unit: Fraction,
        heights: tuple[float, float] | None, join: float, move: Move,
    ) -> Sequence[Body]:  # fmt: skip
        """The bodies that layers with bottom and top make, less those that have a floor."""
        from gproof.frontend.common.dxf import layers
        from gproof.frontend.common.outlines import Pocket

        chord = self.tolerance * CHORD
        known = {name.lower(): name for name in sheet.names}
        solid: list[tuple[str, tuple[float, float]]] = []
        floors: list[tuple[TomlTable, str, float]] = []
        for name in layered.values if layered is not None else ():
            assert layered is not None
            inner = layered.table(name)
            if inner is None:
                return ()
            if name.lower() not in known:
                layered.bad(name, f"no such layer has an outline; the layers are {', '.join(sheet.names) or 'none'}")
                return ()
            if "floor" in inner.values:
                floor = inner.number("floor", unit=unit)
                if floor is None:
                    return ()
                floors.append((inner, name, floor))
            else:
                ends = _heights(inner, unit)
                if ends is None:
                    return ()
                solid.append((name, ends))
            inner.finish()
        if layered is not None and not solid:
            table.bad("layers", "no layer has a bottom and a top")
            return ()
        wanted = None if layered is None else [name for name, _ in solid] + [name for _, name, _ in floors]
        found = layers(sheet, wanted, chord / scale, join / scale)
        gap = max((layer.gap for layer in found.values()), default=0.0) * scale
        rings = {
            name: [[(x * scale, y * scale) for x, y in ring] for ring in layer.rings] for name, layer in found.items()
        }
        for name in wanted or ():
            if not rings[name]:
                table.bad("layers", f"layer {name!r} has no outline")
                return ()
        if layered is None:
            assert heights is not None
            every = [ring for name in rings for ring in rings[name]]
            if not every:
                table.bad("dxf", "it has no outline")
                return ()
            return self._prisms(table, "dxf", every, heights, (), move, chord + gap)
        bodies: list[Body] = []
        for name, ends in solid:
            pockets = [Pocket(tuple(map(tuple, rings[other])), floor) for _, other, floor in floors]
            if not all(_within(inner, "floor", floor, ends) for inner, _, floor in floors):
                return ()
            made = self._prisms(table, "dxf", rings[name], ends, pockets, move, chord + gap)
            if not made:
                return ()
            bodies += made
        return bodies

    def _stl(self, table: TomlTable, unit: Fraction, move: Move, stated: str | None) -> Sequence[Body]:
        """``stl = "clamp.stl"``."""
        from gproof.frontend.common.stl import StlError, read_stl

        target = self._file(table, "stl")
        if target is None:
            return ()
        try:
            mesh = read_stl(target)
        except StlError as wrong:
            place = table.file.place(table.name_of("stl")) if not wrong.line else Span(str(target), wrong.line)
            table.file.add_at(codes.FILE_UNREADABLE, place, what=f"{target.name}: {wrong}")
            return ()
        except OSError as wrong:
            table.bad("stl", f"{target.name}: {wrong.strerror or wrong}")
            return ()
        if mesh.opening:
            hint = "export it as a closed body: until then gouges and collisions with it are UNKNOWN"
            where = table.file.place(table.name_of("stl"))
            table.file.findings.add(codes.OPEN_MESH.at(where, name=target.name, what=mesh.opening, hint=hint))
        corners = mesh.corners * float(unit)
        c, s = move.turn
        turned = np.stack(
            [
                corners[:, :, 0] * c - corners[:, :, 1] * s,
                corners[:, :, 0] * s + corners[:, :, 1] * c,
                corners[:, :, 2],
            ],
            axis=2,
        ) + np.array(move.shift)
        triangles = Columns(
            TRIANGLES, {name: np.ascontiguousarray(turned[:, k]) for k, name in enumerate(("a", "b", "c"))}
        )
        return (Mesh(triangles=triangles, source=target.name, closed=not mesh.opening),)

    def _file(self, table: TomlTable, key: str) -> Path | None:
        """The file that a key names, next to the setup file; a finding when it is not there."""
        name = table.text(key)
        if name is None:
            return None
        target = table.file.path.parent / name
        if not is_file(target):
            table.bad(key, f"{show(name)}: no such file")
            return None
        try:
            digest = hashlib.sha256()
            with target.open("rb") as stream:
                while piece := stream.read(1 << 20):
                    digest.update(piece)
        except OSError as error:
            table.bad(key, f"{show(name)}: {error.strerror or error}")
            return None
        found = (str(target), digest.hexdigest())
        if found not in self.files:
            self.files.append(found)
        return target


_MAKERS: dict[str, Callable[[Reader, TomlTable, Fraction, Move, str | None], Sequence[Body]]] = {
    "box": Reader._box,
    "cylinder": Reader._cylinder,
    "polygon": Reader._polygon,
    "dxf": Reader._dxf,
    "stl": Reader._stl,
}


def read_workpiece(root: TomlTable, unit: Fraction) -> tuple[Workpiece, Files]:
    """What the tables of a setup file state, and the files that they name."""
    settings = root.table("workpiece")
    found: dict[str, float | None] = {}
    if settings is not None:
        found = {
            "tolerance": settings.positive("tolerance", unit=unit),
            "clearance": settings.positive("clearance", unit=unit, zero=True),
            "cell": settings.positive("cell", unit=unit),
        }
        settings.finish()
    stated = {name: value for name, value in found.items() if value is not None}
    reader = Reader(unit, stated.get("tolerance", _DEFAULT.tolerance))
    bodies = {}
    for key, one in (("stock", "stock"), ("part", "part"), ("fixtures", "fixture")):
        value = root.values.get(key)
        single = root.table(key) if isinstance(value, dict) else None
        tables = root.tables(key) if single is None else [single]
        bodies[key] = tuple(
            body for n, table in enumerate(tables, 1) for body in reader.placed(table, one if n == 1 else f"{one} {n}")
        )
    return Workpiece(stock=bodies["stock"], part=bodies["part"], fixtures=bodies["fixtures"], **stated), reader.files


def _work(table: TomlTable) -> int:
    """``work``: 1 to 9, "machine" or "active"; 1 when left out."""
    value = table.values.get("work")
    if isinstance(value, str):
        table.take("work")
        if value not in _WORK:
            table.bad("work", f'{value!r} is not one of 1 to {COORDINATE_SYSTEMS}, "machine" and "active"')
        return _WORK.get(value, 1)
    number = table.whole("work", 1, COORDINATE_SYSTEMS)
    return 1 if number is None else number


def _shift(table: TomlTable, unit: Fraction) -> tuple[float, float, float]:
    """``shift = [x, y, z]``."""
    value = table.take("shift")
    if value is None:
        return 0.0, 0.0, 0.0
    numbers = TomlTable(table.file, table.path, {"shift": [value]}).grid("shift")
    if numbers is None or len(numbers[0]) != 3:
        if numbers is not None:
            table.bad("shift", f"{show(value)} is not X, Y and Z")
        return 0.0, 0.0, 0.0
    x, y, z = (float(number * unit) for number in numbers[0])
    return x, y, z


def _heights(table: TomlTable, unit: Fraction) -> tuple[float, float] | None:
    """``bottom`` and ``top``."""
    for key in ("bottom", "top"):
        if key not in table.values:
            table.missing(key)
    low, high = table.number("bottom", unit=unit), table.number("top", unit=unit)
    if low is None or high is None:
        return None
    if low >= high:
        table.bad("top", "it is not above bottom")
        return None
    return low, high


def _within(table: TomlTable, key: str, floor: float, ends: tuple[float, float] | None) -> bool:
    """Whether a floor is below the top and not below the bottom of what it is a floor of."""
    if ends is None or ends[0] <= floor < ends[1]:
        return True
    table.bad(key, f"it must be from {ends[0]:g} to {ends[1]:g} mm, the bottom and the top around it")
    return False


def _ring(table: TomlTable, key: str, value: Any, unit: Fraction) -> tuple[Point, ...] | None:
    """A list of points."""
    rows = TomlTable(table.file, table.path, {key: value}).grid(key)
    if rows is None:
        return None
    if any(len(row) != 2 for row in rows):
        table.bad(key, "a corner must be X and Y")
        return None
    return tuple((float(x * unit), float(y * unit)) for x, y in rows)
