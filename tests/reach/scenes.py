"""Scenes that witnesses share: programs, bodies, machines with one thing more."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from reach.witness import m
from reach.worlds import BLOCK, EDING

from gproof.ir.columns import Columns
from gproof.ir.machine import Area, Axis, AxisKind, Spindle
from gproof.ir.workpiece import TRIANGLES, Cylinder, Mesh, Placed, Prism, Workpiece

CUT = "G21 G90 G17; M3 S1000; G0 G43 H1 X10 Y10 Z5; G1 Z-1 F200; G1 X50; G2 X60 Y20 I10 J0; G0 Z5; M5; M30"
BLOCKED = EDING.with_setup(workpiece=BLOCK)
ROUTER = tuple(
    Axis(
        name=name,
        kind=AxisKind.LINEAR,
        steps_per_unit=Fraction(320),
        lower=low,
        upper=high,
        travel_lower=low - 4.0,
        travel_upper=high + 4.0,
        max_velocity=100.0,
        max_acceleration=500.0,
    )
    for name, low, high in (("x", 0.0, 600.0), ("y", 0.0, 400.0), ("z", -150.0, 0.0))
)
ROTARY_A = Axis(
    name="a",
    kind=AxisKind.ROTARY,
    steps_per_unit=Fraction(10),
    lower=-400.0,
    upper=400.0,
    max_velocity=50.0,
    max_acceleration=100.0,
)
ZONED = EDING.but(*m(("machine.keep_out", (Area(name="post", box=((20.0, 40.0), (-50.0, 400.0), (-150.0, 10.0))),))))
SOLID = Workpiece(
    stock=BLOCK.stock,
    part=(
        Placed(
            name="part",
            body=Prism(outline=((20.0, 20.0), (100.0, 20.0), (100.0, 60.0), (20.0, 60.0)), low=-15.0, high=-2.0),
        ),
    ),
    fixtures=(Placed(name="pin", body=Cylinder(x=-20.0, y=40.0, radius=5.0, low=0.0, high=12.0)),),
)
MADE = EDING.with_setup(workpiece=SOLID)
DEEP = "G21 G90 G17; M3 S1000; G0 G43 H1 X10 Y40 Z5; G1 Z-2.5 F200; G1 X30; G0 Z5; G0 X-10; G1 Z6; M5; M30"
SPUN = EDING.but(
    *m(
        (
            "machine.spindles",
            (Spindle(number=0, min_rpm=100.0, max_rpm=24000.0), Spindle(number=1, offset=(10.0, 0.0, 0.0))),
        )
    )
)


_SIDES = ("0264", "1573", "0451", "2376", "0132", "4675")
"""Corners of a cuboid, bits X, Y, Z of each, around every side as seen from outside."""


def mesh_of(x0: float, y0: float, z0: float, x1: float, y1: float, z1: float) -> Columns:
    """The twelve triangles of a cuboid."""
    corners = np.array([[(x0, x1)[n & 1], (y0, y1)[n >> 1 & 1], (z0, z1)[n >> 2]] for n in range(8)])
    rings = [[int(n) for n in side] for side in _SIDES]
    faces = np.array([[ring[0], ring[n], ring[n + 1]] for ring in rings for n in (1, 2)])[:, ::-1]
    return Columns(TRIANGLES, {name: corners[faces[:, n]].copy() for n, name in enumerate("abc")})


BRICK = Mesh(triangles=mesh_of(20.0, 20.0, -15.0, 100.0, 60.0, -2.0), source="part.stl")
WIDE_BRICK = Mesh(triangles=mesh_of(-300.0, -300.0, -300.0, 900.0, 900.0, 300.0), source="part.stl")
PIN = Placed(name="pin", body=Cylinder(x=-20.0, y=40.0, radius=5.0, low=0.0, high=60.0))
PRISM = SOLID.part[0]
