"""Stock, part and fixtures in reports and pictures: what they are, how large, and where, as far as that is known."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from gproof.driver.dialects import semantics_of
from gproof.driver.session import Session
from gproof.ir.record import record
from gproof.ir.symbolic import add_forms
from gproof.ir.trace import Affine, TipOffset
from gproof.ir.workpiece import ACTIVE, MACHINE, Body, Box, Cylinder, Mesh, Placed, Prism, Workpiece
from gproof.passes.checks.tooling.tip_position import Placing
from gproof.report.units import LengthUnit

Pair = tuple[float, float]
Corner = tuple[float, float, float]

ROLES = ("stock", "part", "fixtures")
_UNNAMED = re.compile(r"(?:stock|part|fixture)(?: \d+)?")
_SHOWN = 4
_CHORDS = 72


@record(frozen=True, slots=True)
class Drawn:
    """A body in machine coordinates, or relative to the unknown zero of the scene it is drawn in.

    role: of ``ROLES``; rings: from above, holes too; low, high: its box; number: its place among those of
    its role in the setup.
    """

    role: str
    rings: tuple[tuple[Pair, ...], ...]
    low: Corner
    high: Corner
    number: int = 0


def extent(body: Body) -> tuple[Corner, Corner]:
    """The box of a body, in its own coordinates, mm."""
    if isinstance(body, Box):
        return body.low, body.high
    if isinstance(body, Cylinder):
        r = body.radius
        return (body.x - r, body.y - r, body.low), (body.x + r, body.y + r, body.high)
    if isinstance(body, Prism):
        corners = np.array(body.outline)
        (x0, y0), (x1, y1) = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
        return (x0, y0, body.low), (x1, y1, body.high)
    columns = [body.triangles[name] for name in ("a", "b", "c")]
    low = np.min([column.min(axis=0) for column in columns], axis=0).tolist()
    high = np.max([column.max(axis=0) for column in columns], axis=0).tolist()
    return (low[0], low[1], low[2]), (high[0], high[1], high[2])


def _around(bodies: Iterable[Placed]) -> tuple[Corner, Corner]:
    """The box of several bodies."""
    boxes = [extent(placed.body) for placed in bodies]
    low = np.min([box[0] for box in boxes], axis=0).tolist()
    high = np.max([box[1] for box in boxes], axis=0).tolist()
    return (low[0], low[1], low[2]), (high[0], high[1], high[2])


def named(workpiece: Workpiece, unit: LengthUnit) -> str:
    """What the summary says: ``stock 200 x 100 x 20 mm, part bracket.dxf, fixtures left clamp, right clamp``."""
    said = []
    for role in ROLES:
        bodies: tuple[Placed, ...] = getattr(workpiece, role)
        names = list(dict.fromkeys(placed.name for placed in bodies))
        if not names:
            continue
        if all(_UNNAMED.fullmatch(name) for name in names):
            names = [] if len(names) == 1 else [str(len(names))]
        more = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
        text = f"{', '.join(names[:_SHOWN])}{more}"
        label = "fixture" if role == "fixtures" and len(names) < 2 else role
        text = f"{text} {role}" if text.isdigit() else f"{label} {text}".rstrip()
        if role == "stock" and len({placed.work for placed in bodies}) == 1:
            low, high = _around(bodies)
            sizes = " x ".join(
                f"{unit.of(b - a):.{unit.places}f}".rstrip("0").rstrip(".") for a, b in zip(low, high, strict=True)
            )
            text = f"{text} {sizes} {unit.name}"
        said.append(text)
    return "; ".join(said)


def report(workpiece: Workpiece) -> dict[str, object]:
    """What the JSON report says."""
    found: dict[str, object] = {
        role: [_one(name, bodies) for name, bodies in _by_name(getattr(workpiece, role))] for role in ROLES
    }
    return found | {
        "tolerance": workpiece.tolerance, "clearance": workpiece.clearance, "cell": workpiece.cell,
    }  # fmt: skip


def _by_name(bodies: tuple[Placed, ...]) -> list[tuple[str, list[Placed]]]:
    found: dict[str, list[Placed]] = {}
    for placed in bodies:
        found.setdefault(placed.name, []).append(placed)
    return list(found.items())


def _one(name: str, bodies: list[Placed]) -> dict[str, object]:
    work = bodies[0].work
    low, high = _around(bodies)
    return {
        "name": name,
        "bodies": len(bodies),
        "counts_from": {MACHINE: "machine", ACTIVE: "active"}.get(work, str(work)),
        "low": list(low),
        "high": list(high),
        "closed": all(not isinstance(one.body, Mesh) or one.body.closed for one in bodies),
    }


def drawn(session: Session, forms: tuple[Affine, ...], tip: tuple[TipOffset, ...] | None) -> list[Drawn]:
    """The bodies that are where a picture with unknowns ``forms`` of X, Y and Z has them.

    tip: of the tool that heights are drawn for, None for no heights.
    """
    workpiece = session.setup.workpiece
    if workpiece is None or session.program is None:
        return []
    start = semantics_of(session.program).first_state(session.program, session.setup, session.machine)
    placing = Placing(session.machine, session.setup, start.zero_at_start)
    found = []
    for role in ROLES:
        for number, placed in enumerate(getattr(workpiece, role)):
            shift = []
            for axis, zero in enumerate(placing.zero(placed.work)):
                value, form = zero.value, zero.form
                for each in tip or ():
                    if each.axis == axis:
                        value, form = value + each.mm, add_forms(form, each.form)
                shift.append(value if form == forms[axis] and (axis < 2 or tip is not None) else None)
            if shift[0] is None or shift[1] is None:
                continue
            moved = _moved(role, placed.body, shift[0], shift[1], shift[2])
            found.append(replace(moved, number=number))
    return found


def _moved(role: str, body: Body, x: float, y: float, z: float | None) -> Drawn:
    low, high = extent(body)
    rings = tuple(tuple((u + x, v + y) for u, v in ring) for ring in _rings(body, low, high))
    heights = (float("nan"), float("nan")) if z is None else (low[2] + z, high[2] + z)
    return Drawn(role, rings, (low[0] + x, low[1] + y, heights[0]), (high[0] + x, high[1] + y, heights[1]))


def _rings(body: Body, low: Corner, high: Corner) -> tuple[tuple[Pair, ...], ...]:
    """A body from above; of a mesh what is around it."""
    if isinstance(body, Prism):
        return (body.outline, *body.holes)
    if isinstance(body, Cylinder):
        angles = np.linspace(0.0, 2.0 * np.pi, _CHORDS, endpoint=False)
        points = zip((body.x + body.radius * np.cos(angles)).tolist(), (body.y + body.radius * np.sin(angles)).tolist(),
                     strict=True)  # fmt: skip
        return (tuple(points),)
    if isinstance(body, Mesh):
        return (_hull(np.concatenate([body.triangles[name][:, :2] for name in ("a", "b", "c")])),)
    return (((low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])),)


def _hull(points: np.ndarray) -> tuple[Pair, ...]:
    """The convex outline of points (Andrew's monotone chain)."""
    ordered = sorted({(float(x), float(y)) for x, y in points.tolist()})
    sides: list[list[Pair]] = []
    for way in (ordered, ordered[::-1]):
        side: list[Pair] = []
        for x, y in way:
            while len(side) > 1 and _turn(side[-2], side[-1], (x, y)) <= 0.0:
                side.pop()
            side.append((x, y))
        sides.append(side[:-1])
    return (*sides[0], *sides[1])


def _turn(a: Pair, b: Pair, c: Pair) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
