"""Keep-out zones in reports and pictures: where they are on the machine, as far as that is known."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from gproof.driver.session import Session
from gproof.ir.machine import AXIS_NAMES, Area
from gproof.ir.symbols import describe
from gproof.passes.checks.zones.shapes import Zone, shape_of

Pair = tuple[float, float]


def placed(session: Session) -> tuple[Area, ...]:
    """The zones in machine coordinates; those that count from a work zero which is not known exactly are left out."""
    out = []
    for area in (*session.machine.keep_out, *session.setup.keep_out):
        shift = [0.0, 0.0, 0.0]
        if area.work:
            stated = [session.setup.interval(f"work.{area.work}.{name}") for name in AXIS_NAMES[:3]]
            if any(one is None or not one.exact for one in stated):
                continue
            shift = [one.low for one in stated if one is not None]
        sides = [(low + by, high + by) for (low, high), by in zip(area.box, shift, strict=True)]
        rings = tuple(tuple((x + shift[0], y + shift[1]) for x, y in ring) for ring in area.rings)
        out.append(dataclasses.replace(area, box=(sides[0], sides[1], sides[2]), rings=rings, work=0))
    return tuple(out)


def named(session: Session) -> str:
    """What the summary says of them, "" where there are none."""
    machine = [area.name for area in session.machine.keep_out]
    setup = [f"{area.name} (of the setup{_origin(area.work)})" for area in session.setup.keep_out]
    return ", ".join([*machine, *setup])


def _origin(work: int) -> str:
    return f", from the zero of {describe(((f'work.{work}.x', 1),)).partition(' ')[0]}" if work else ""


def entry(at: np.ndarray, moves: np.ndarray, areas: tuple[Area, ...], reach: float) -> np.ndarray | None:
    """About where moves come within ``reach`` of a zone, from above; None where they do not. at: (n, 3)."""
    zones = [Zone(shape=shape_of(area), z=area.box[2], grow=reach) for area in areas]
    for i in moves.tolist():
        points = at[i - 1] + (at[i] - at[i - 1]) * np.linspace(0.0, 1.0, 101)[:, np.newaxis]
        for zone in zones:
            inside = np.flatnonzero(zone.depths(points.astype(float)) >= 0.0)
            if len(inside):
                return np.asarray(points[inside[0]], dtype=float)
    return None


def outline(area: Area, axes: tuple[int, int], low: Pair, high: Pair) -> list[list[Pair]]:
    """The rings of an area in a view, sides beyond it just outside; empty where it is outside the view."""
    u, v = area.box[axes[0]], area.box[axes[1]]
    if u[1] < low[0] or u[0] > high[0] or v[1] < low[1] or v[0] > high[1]:
        return []
    if area.rings and axes == (0, 1):
        return [list(ring) for ring in area.rings]
    pad = high[0] - low[0] + high[1] - low[1]
    a, b = max(u[0], low[0] - pad), min(u[1], high[0] + pad)
    c, d = max(v[0], low[1] - pad), min(v[1], high[1] + pad)
    assert all(math.isfinite(value) for value in (a, b, c, d))
    return [[(a, c), (b, c), (b, d), (a, d)]]
