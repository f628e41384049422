"""Witnesses of what rows of a trace carry: the same job with another value in every state of its trace."""

from __future__ import annotations

import dataclasses
import math

from reach.of_controllers import CORNER, LATHE
from reach.of_setups import WARPED
from reach.of_wincnc import SHIFTED
from reach.scenes import CUT, DEEP, MADE, SOLID, SPUN, ZONED
from reach.witness import Witnesses, m
from reach.worlds import EDING, WINCNC

from gproof.ir.machine import Area, Slave, Tool
from gproof.ir.trace import Boundary, PathMode, TipOffset, ToolDiameter
from gproof.ir.workpiece import Box, Cylinder, Placed, Workpiece

w = Witnesses()
SLOW = m(("machine.tools.1.max_feed", 1.0), ("machine.tools.1.min_rpm", 5000.0))
WIDE = m(("machine.tools.1.diameter", 16.0), ("machine.tools.1.shape", "flat"))
ROOM = MADE.but(*SLOW, *WIDE, *ZONED.changes)
"""Zone, part, pin and stock; tool 2 is wider and slower than tool 1."""
NEAR = (
    "G21 G90 G17; M3 S1000; G0 G43 H1 X10 Y15 Z5; G1 Z-2.5 F200; G1 X50; "
    "G53 G0 Z0; G53 G0 X15 Y0; G0 X-10 Y40; G0 Z6; M5; M30"
)
"""Just clear of all of them."""
OTHER = (ToolDiameter(1, 16.0, 16.0),)
w("State.tool", ROOM, NEAR, "state.tool", 2)
w("State.diameters", ROOM, NEAR, "state.diameters", OTHER)
w("State.spindle", EDING, CUT, "state.spindle", 0.0)
TURNED = LATHE.but(
    *m(
        ("machine.tools.0.max_rpm", 500.0),
        ("machine.controller.xz_seen_from", "-y"),
        ("machine.controller.diameter_programming", False),
    )
)
SURFACE = "G18; G96 S100 D2000; M3; G0 G43 H1 X50 Z5; G1 X40 Z-1 F100; M5; M30"
w("State.spindle_limit", TURNED, SURFACE, "state.spindle_limit", 400.0)
w("State.surface_speed", EDING.but(*m(("state.spindle", math.nan))), CUT, "state.surface_speed", 100.0)
w("State.feed_mode", EDING, CUT, "state.feed_mode", 95)
w("State.path_mode", EDING, CORNER, "state.path_mode", PathMode.EXACT_STOP)
LOOSE = (
    "G21 G90 G17; M3 S1000; G64 P2; G0 G43 H1 X14 Y60 Z5; G1 Z-1 F200; G1 Y70; G1 X50; G1 Y63.5; G1 X60; "
    "G0 Z5; G0 X-11 Y40; G0 Y30; G53 G0 X16.5 Y50; G53 G0 X10 Y50; M5; M30"
)
w("State.path_mode", ROOM, LOOSE, "state.path_mode", PathMode.EXACT_STOP)
for name in ("path_tolerance", "simplify"):
    w(f"State.{name}", ROOM, LOOSE.replace("P2", "P0.01"), f"state.{name}", 2.0)
w("State.laf_angle", EDING, CORNER, "state.laf_angle", 170.0)
w("State.work", SHIFTED.with_setup(workpiece=dataclasses.replace(
    SOLID, fixtures=(Placed(name="post", body=Cylinder(x=1400.0, y=160.0, radius=5.0, low=-150.0, high=50.0), work=0),)
)), "G0 X1", "state.work", 2)  # fmt: skip
w(
    "State.work",
    SHIFTED.but(*m(("machine.tools", (Tool(number=1, diameter=6.0),)))).with_setup(
        keep_out=(Area(name="post", box=((300.0, 400.0), (0.0, 9.0), (-150.0, 9.0))),)
    ),
    "G0 X1",
    "state.work",
    2,
)
w("State.overrides", EDING, CUT, "state.overrides", False)
ROUND = CUT.replace("G2 X60 Y20 I10 J0", "G2 X50 Y10.00001 I10 J0")
w("State.compensation", EDING, ROUND, "state.compensation", 1)
w("State.arc_tolerance", EDING, CUT.replace("I10", "I10.001"), "state.arc_tolerance", 1e-4)
w("State.guards_off", EDING, CUT, "state.guards_off", ("tool_change",))
CHANGE = "G53 G0 X560 Y360 Z-10; G53 G0 Z-50; M30"
w("State.guards_off", EDING, CHANGE, "state.guards_off", ("tool_change_area",))
HILLY = WARPED.but(*m(("setup.height_map.heights", ((0.0, 0.0), (0.0, 200.0)))))
w("State.following", HILLY, "G53 G0 Z-130; G53 G0 X190 Y160; M30", "state.following", ())
w("State.following", MADE, DEEP, "state.following", ("height_map",))
w("State.synchronised", EDING, CUT, "state.synchronised", True)
w("State.feed_override", EDING, CUT, "state.feed_override", 2.0)
w("State.head", SPUN.but(*m(("machine.spindles.0.spin_up", 30.0))), CUT, "state.head", 1)
w("State.head", ROOM, NEAR, "state.head", 1)
w("State.boundaries", WINCNC, "G0 X61", "state.boundaries", ())
w("State.boundaries", WINCNC, "G0 X10", "state.boundaries", (Boundary(0, 0.0, 5.0, 0.0, ()),))
w("State.tip", MADE, DEEP.replace("Z-2.5", "Z-1.5"), "state.tip", (TipOffset(2, 46.0),))
LOW = m(("machine.keep_out.0.work", 1), ("machine.keep_out.0.box", ((20.0, 40.0), (-50.0, 400.0), (-150.0, 4.0))))
w("State.tip", ZONED.but(*LOW), "G0 G43 H1 X0 Y0 Z5; X30; M30", "state.tip", (TipOffset(2, 46.0),))
FIXED = MADE.with_setup(workpiece=dataclasses.replace(
    SOLID, fixtures=(Placed(name="post", body=Cylinder(x=140.0, y=160.0, radius=5.0, low=-120.0, high=-98.0), work=0),),
    part=(dataclasses.replace(SOLID.part[0], work=0),),
))  # fmt: skip
w("State.machine_tip", FIXED, "G0 G43 H1 X-12 Y40 Z13; M30", "state.machine_tip", (TipOffset(2, 46.0),))
w(
    "State.machine_tip",
    ZONED.but(*m(("machine.keep_out.0.box", ((20.0, 40.0), (-50.0, 400.0), (-150.0, -10.0))))),
    "G53 G0 X30; M30",
    "state.machine_tip",
    (TipOffset(2, 46.0),),
)
w("State.machine_tip", FIXED, "G43 H1; G53 G0 X18 Y40 Z0; M30", "state.machine_tip", (TipOffset(2, 10.0),))
w("State.retimed", EDING, CUT, "state.retimed", ("L5",))
w("State.backlash", EDING, CUT, "state.backlash", ((0, 500.0),))

# -- beside zone, part, fixture and stock: a gap of 1 mm

BODY = Box(low=(200.0, 0.0, -140.0), high=(220.0, 380.0, -1.0))
PLACED = (Placed(name="body", body=BODY, work=0),)
FLAT = Tool(number=1, length=40.0, shape="flat", diameter=6.0, flute_length=200.0, shank_diameter=6.0, stickout=200.0)
BESIDE = {
    "eding": (EDING, "G21; G53 G0 Z-50; G53 G0 X196 Y10; G53 G0 Y100; M30"),
    "wincnc": (WINCNC, "G22; G53 Z-50; G53 Y10; G53 X196; G53 Y100"),
}
for row, dialect, path, value in (
    ("Axis.backlash", "eding", "machine.axes.0.backlash", 1.5),
    ("Slave.backlash", "eding", "machine.axes.0.slaves.0.backlash", 1.5),
    ("Settings.backlash", "wincnc", "machine.settings.backlash", (("x", 1.5),)),
    ("State.backlash", "eding", "state.backlash", ((0, 1.5),)),
):
    world, program = BESIDE[dialect]
    world = world.but(*m(("machine.tools", (FLAT,))))
    if row == "Slave.backlash":
        world = world.but(*m(("machine.axes.0.slaves", (Slave(joint="a"),))))
    zone = Area(name="body", box=((200.0, 220.0), (0.0, 380.0), (-140.0, -1.0)))
    for stated in (
        {"keep_out": (zone,)},
        {"workpiece": Workpiece(part=PLACED)},
        {"workpiece": Workpiece(fixtures=PLACED)},
    ):
        w(row, world.with_setup(**stated), program, path, value)
