"""Witnesses of what a setup file states, stock, part and fixtures included."""

from __future__ import annotations

from dataclasses import replace

from reach.scenes import (
    BLOCKED,
    BRICK,
    CUT,
    DEEP,
    MADE,
    PIN,
    PRISM,
    ROTARY_A,
    ROUTER,
    SOLID,
    SPUN,
    WIDE_BRICK,
    ZONED,
    mesh_of,
)
from reach.witness import Witnesses, m
from reach.worlds import BLOCK, EDING, HOME, WINCNC, exactly

from gproof.ir.machine import Area
from gproof.ir.setup import CylinderMap, HeightMap, InForce, Interval, StoredPosition

w = Witnesses()
# -- Setup, what it holds, and the workpiece

w("Setup.homed", EDING, CUT, "setup.homed", ())
w("Setup.start", EDING, CUT, "setup.start", exactly(x=590.0, y=0.0, z=0.0))
w("Setup.start", BLOCKED, "G53 G0 Z-105; M30", "setup.start", exactly(x=590.0, y=0.0, z=0.0))
w("Setup.work", EDING, CUT, "setup.work", {})
w("Setup.g92", EDING, CUT, "setup.g92", {})
w("Setup.tool_lengths", EDING, CUT, "setup.tool_lengths", {0: Interval(20.0, 20.0)})
w("Setup.tool_lengths", BLOCKED, DEEP.replace("G43 H1 ", ""), "setup.tool_lengths", {0: Interval(20.0, 20.0)})
w("Setup.parameters", EDING, "G0 X#1; M30", "setup.parameters", {1: 5.0})
w("Setup.parameter_ranges", EDING, "G0 X#1; M30", "setup.parameter_ranges", {1: Interval(0.0, 500.0)})
w("Setup.active_work", EDING, CUT, "setup.active_work", 2)
w("Setup.tool", MADE, "G0 X10 Y40 Z5; G1 Z-2.5 F10; G1 X30; M30", "setup.tool", 2)
w("Setup.default_start", EDING.with_setup(start={}), CUT, "setup.default_start", 0.0)
w("Setup.default_offset", EDING.with_setup(work={}), CUT, "setup.default_offset", 0.0)
w("Setup.default_parameter", EDING, "G0 X#1; M30", "setup.default_parameter", None)
w("Setup.block_delete", EDING, "G0 X1; /G0 X900; M30", "setup.block_delete", True)
w("Setup.block_delete", EDING, "G0 X1; /G0 X900; M30", "setup.block_delete", None)
w("Setup.optional_stop", EDING, "G0 X1; M1; G0 X2; M30", "setup.optional_stop", True)
w("Setup.name", EDING, CUT, "setup.name", "zero")
ROLLED = EDING.but(*m(("machine.axes", (*ROUTER, ROTARY_A)))).with_setup(
    start=exactly(a=0.0, **HOME),
    homed=("x", "y", "z", "a"),
    cylinder=CylinderMap(radius=30.0, y=150.0, z=-120.0, zero=100.0),
)
w("Setup.cylinder", ROLLED, CUT.replace("X50", "Y30"), "setup.cylinder", None)
for name, value in (("radius", 10.0), ("y", 170.0), ("z", -100.0), ("zero", 20.0)):
    w(f"CylinderMap.{name}", ROLLED, CUT, f"setup.cylinder.{name}", value)
    w(f"CylinderMap.{name}", ROLLED, CUT, f"setup.cylinder.{name}", None)
GRID = HeightMap(x=150.0, y=120.0, size=40.0, heights=((0.0, 1.0, 2.0), (0.0, 0.5, 3.0)), name="map")
WARPED = EDING.with_setup(height_map=GRID)
w("Setup.height_map", EDING, CUT, "setup.height_map", GRID)
for name, value in (
    ("x", 100.0),
    ("y", 100.0),
    ("size", 10.0),
    ("heights", ((0.0, 0.0), (0.0, 200.0))),
    ("on", False),
    ("name", "other"),
):
    w(f"HeightMap.{name}", WARPED, CUT, f"setup.height_map.{name}", value)
w(
    "Setup.heads",
    SPUN.but(*m(("machine.spindles.1.offset", (None, None, None)))),
    "M91; G0 X10; M30",
    "setup.heads",
    {(1, "x"): Interval(30.0, 30.0)},
)
w("Setup.transform", EDING, CUT, "setup.transform", InForce(angle=30.0))
TILTED = EDING.with_setup(transform=InForce(angle=30.0, factor_x=1.0, factor_y=1.0))
for name, value in (("angle", 80.0), ("factor_x", 2.0), ("factor_y", 2.0), ("x", 30.0), ("y", 30.0)):
    w(f"InForce.{name}", TILTED, CUT, f"setup.transform.{name}", value)
w("Setup.positions", WINCNC, "G53 P4", "setup.positions", {"P4": StoredPosition(axes={"x": 100.0})})
PARKED = WINCNC.with_setup(positions={"P4": StoredPosition(axes={"x": 100.0})})
for name, value in (("axes", {"x": 300.0}), ("lift", True), ("clearance", -20.0)):
    w(
        f"StoredPosition.{name}",
        PARKED.with_setup(start=exactly(x=0.0, y=0.0, z=-50.0)),
        "G53 P4",
        f"setup.positions.P4.{name}",
        value,
    )
LIFTED = WINCNC.with_setup(
    positions={"P4": StoredPosition(axes={"x": 100.0}, lift=True)}, start=exactly(x=0.0, y=0.0, z=-50.0)
)
w("StoredPosition.clearance", LIFTED, "G53 P4", "setup.positions.P4.clearance", -20.0)
w("Setup.inputs", WINCNC, "M17.1 C6; G0 X90; G0 X1", "setup.inputs", {6: 0.0})
w("Setup.inputs", EDING, "M56 P6; if [#5399 == 1]; G0 X900; endif; M30", "setup.inputs", {6: 1.0})
w("Setup.outputs", WINCNC, "M18.2 C6; G0 X90; G0 X1", "setup.outputs", {6: 0.0})
w("Setup.outputs", WINCNC, "M17.2 C6; G0 X90; G0 X1", "setup.outputs", {6: 1.0})
w("Setup.virtual", WINCNC, "M17.3 C3; G0 X90; G0 X1", "setup.virtual", {3: 1.0})
w("Setup.answers", WINCNC, "G5 T1; G0 X90; G0 X1", "setup.answers", {1: 0.0})
w("Setup.measures", WINCNC, "G0 X1 Z0", "setup.measures", {})
w("Setup.contacts", WINCNC, "L91 G1 Z-5 F10 M28 G31; G0 X1", "setup.contacts", exactly(z=-50.0))
w(
    "Setup.keep_out",
    EDING,
    CUT,
    "setup.keep_out",
    (Area(name="post", box=((155.0, 170.0), (100.0, 400.0), (-150.0, 0.0))),),
)
w("Setup.workpiece", BLOCKED, DEEP, "setup.workpiece", None)
w(
    "Interval.low",
    EDING.with_setup(start={"x": Interval(0.0, 100.0), **exactly(y=0.0, z=0.0)}),
    "G91 G0 X-20; M30",
    "setup.start.x.low",
    30.0,
)
w(
    "Interval.high",
    EDING.with_setup(start={"x": Interval(0.0, 100.0), **exactly(y=0.0, z=0.0)}),
    "G91 G0 X520; M30",
    "setup.start.x.high",
    30.0,
)
FULL = DEEP.replace("G1 Z6", "G0 X-12; G1 Z6")
for name, value in (
    ("stock", ()),
    ("part", ()),
    ("fixtures", ()),
    ("tolerance", 3.0),
    ("clearance", 9.0),
    ("cell", 2.0),
):
    w(f"Workpiece.{name}", MADE, FULL, f"setup.workpiece.{name}", value)
w("Placed.body", MADE, FULL, "setup.workpiece.part.0.body.high", -8.0)
w("Placed.work", MADE, FULL, "setup.workpiece.part.0.work", 0)
w("Placed.work", MADE, FULL, "setup.workpiece.fixtures.0.work", 0)
w("Placed.name", MADE, DEEP.replace("X-10", "X-18"), "setup.workpiece.fixtures.0.name", "post")
for name, value in (
    ("outline", ((120.0, 20.0), (140.0, 20.0), (140.0, 60.0))),
    ("holes", (((10.0, 30.0), (40.0, 30.0), (40.0, 50.0), (10.0, 50.0)),)),
    ("low", -2.1),
    ("high", -8.0),
    ("error", 3.0),
):
    w(f"Prism.{name}", MADE, FULL, f"setup.workpiece.part.0.body.{name}", value)
w("Prism.low", MADE, FULL, "setup.workpiece.part.0.body.low", -2.2)
for name, value in (("x", -10.0), ("y", 140.0), ("radius", 25.0), ("low", 6.5), ("high", 3.0)):
    w(f"Cylinder.{name}", MADE, DEEP.replace("X-10", "X-18"), f"setup.workpiece.fixtures.0.body.{name}", value)
w("Cylinder.x", MADE, FULL, "setup.workpiece.fixtures.0.body.x", -10.0)
w("Cylinder.radius", MADE, FULL, "setup.workpiece.fixtures.0.body.radius", 25.0)
for name, value in (("low", (0.0, 0.0, -1.0)), ("high", (120.0, 80.0, -3.0))):
    w(f"Box.{name}", MADE, FULL, f"setup.workpiece.stock.0.body.{name}", value)

w("Workpiece.cell", MADE, FULL.replace("G0 X-12", "G0 X45"), "setup.workpiece.cell", 9.0)
w("Workpiece.fixtures", MADE, DEEP.replace("X-10", "X-18"), "setup.workpiece.fixtures", ())
w("Workpiece.stock", MADE, FULL.replace("G0 X-12", "G0 X45"), "setup.workpiece.stock", ())
SLAB = MADE.with_setup(workpiece=BLOCK)
OVER = "G21 G90 G17; M3 S1000; G0 G43 H1 X10 Y40 Z5; G0 X-20 Z13; G0 X60 Y70 Z-1; M30"
w("Box.low", SLAB, OVER, "setup.workpiece.stock.0.body.low", (70.0, 0.0, -15.0))
w("Box.high", SLAB, OVER, "setup.workpiece.stock.0.body.high", (120.0, 60.0, -2.0))
w("Box.high", SLAB, OVER, "setup.workpiece.fixtures.0.body.high", (-4.0, 48.0, 16.0))
w("Prism.error", MADE, DEEP.replace("X30", "X16.9"), "setup.workpiece.part.0.body.error", 3.0)

# -- under, over and beside bodies

TALL = MADE.with_setup(workpiece=replace(SOLID, fixtures=(PIN,)))
SHALLOW = ZONED.but(*m(("machine.keep_out.0.box", ((20.0, 40.0), (-50.0, 400.0), (-150.0, -80.0)))))
STAND = "G21 G90 G17; G0 G43 H1 X0 Y40 Z5; M30"
for name, value in (("shank_diameter", 40.0), ("holder", ((40.0, 40.0, 22.0),)), ("stickout", 3.0)):
    w(f"Tool.{name}", TALL, STAND, f"machine.tools.0.{name}", value)
    beside = SHALLOW if name == "stickout" else ZONED
    w(f"Tool.{name}", beside, "G53 G0 Z-100; G53 G0 X10; M30", f"machine.tools.0.{name}", value)
SLIM = TALL.but(*m(("machine.tools.0.shank_diameter", 1.0), ("machine.tools.0.holder", ((2.0, 2.0, 90.0),))))
w("Cylinder.low", SLIM, STAND.replace("X0", "X-12.5"), "setup.workpiece.fixtures.0.body.low", 30.0)
HIGH_PART = SLIM.with_setup(workpiece=replace(SOLID, part=(replace(PRISM, body=replace(PRISM.body, high=60.0)),)))
w("Prism.low", HIGH_PART, STAND.replace("X0", "X18"), "setup.workpiece.part.0.body.low", 30.0)
POCKET = "G21 G90 G17; G0 G43 H1 X10 Y70 Z5; G1 Z-1 F200; X60; Y72; X10; G0 Z5; M30"
w("Workpiece.cell", MADE, POCKET.replace("G0 Z5; M30", "G0 X20 Y71; G0 X50; M30"), "setup.workpiece.cell", 9.0)
w("Workpiece.stock", MADE, POCKET.replace("G0 Z5; M30", "G0 Y78; M30"), "setup.workpiece.stock", ())
MESHED = MADE.with_setup(workpiece=replace(SOLID, part=(replace(PRISM, body=BRICK),)))
w(
    "Mesh.triangles",
    MESHED,
    DEEP,
    "setup.workpiece.part.0.body.triangles",
    mesh_of(40.0, 20.0, -15.0, 100.0, 60.0, -2.0),
)
INSIDE = "G21 G90 G17; G0 G43 H1 X60 Y40 Z-10; M30"
WHOLE = MADE.with_setup(workpiece=replace(SOLID, stock=(), part=(replace(PRISM, body=WIDE_BRICK),)))
w("Mesh.closed", WHOLE, INSIDE, "setup.workpiece.part.0.body.closed", False)
w("CylinderMap.zero", ROLLED.with_setup(start=exactly(**HOME)), CUT, "setup.cylinder.zero", 20.0)
w("CylinderMap.z", ROLLED.with_setup(start=exactly(**HOME)), CUT, "setup.cylinder.z", -100.0)
