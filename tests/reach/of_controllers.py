"""Witnesses of what a machine file states of the controller, the board and the machine as a whole."""

from __future__ import annotations

from reach.scenes import CUT, DEEP, MADE, ROTARY_A, ROUTER, SPUN, ZONED
from reach.witness import Witnesses, m
from reach.worlds import EDING, HOME, WINCNC, exactly

from gproof.ir.machine import Area, Knife, Spindle, Unmodelled
from gproof.ir.setup import Interval

w = Witnesses()
# -- Controller, Board, Machine

LATHE = EDING.but(*m(("machine.controller.turning", True)))
TURN = "G18; G0 X50 Z5; G1 X40 Z-1 F100; G3 X30 Z-2 R20; M30"
CORNER = "G64; G43 H1; G0 X10 Y10; G1 X20 F1000; X30 Y10.2; X40; M30"
w("Controller.laf_angle", EDING, CORNER, "machine.controller.laf_angle", 0.1)
w("Controller.interpolation_time", EDING, CUT, "machine.controller.interpolation_time", 0.1)
w("Controller.max_step_frequency", EDING, CUT.replace("F200", "F5000"), "machine.controller.max_step_frequency", 2000.0)
w("Controller.auto_tool_change", EDING, "T2 M6; G0 X1; M30", "machine.controller.auto_tool_change", True)
w("Controller.absolute_arc_centers", EDING, CUT, "machine.controller.absolute_arc_centers", True)
w("Controller.diameter_programming", EDING, TURN, "machine.controller.diameter_programming", True)
w("Controller.extruder", EDING, "G0 X1; G1 X5 E3 F100; M30", "machine.controller.extruder", True)
w("Controller.xz_seen_from", LATHE, TURN, "machine.controller.xz_seen_from", "-y")
w("Controller.turning", EDING, "G0 X50 Z5; G1 X40 F100; G2 X45 Z6 R20; M30", "machine.controller.turning", True)
w("Controller.spindle_ramp_time", EDING, CUT, "machine.controller.spindle_ramp_time", 2.0)
w(
    "EdingSettings.thread_peak",
    LATHE,
    "M3 S300; G18; G0 X50 Z5; G76 P1 Z-20 I-2 J0.3 K1 R1.5 Q29 H2 E0 L0; M30",
    "machine.settings.thread_peak",
    "position",
)
w(
    "Controller.straight_traverse",
    ZONED,
    "G53 G0 X10 Y50; G53 G0 X50 Y-60; M30",
    "machine.controller.straight_traverse",
    False,
)
w("Controller.homing_mandatory", EDING.with_setup(homed=()), CUT, "machine.controller.homing_mandatory", True)
w("EdingSettings.super_long_file", EDING, CUT + "; if [1 == 2]; endif", "machine.settings.super_long_file", 0.01)
w("Controller.safety_feed", EDING.with_setup(homed=()), CUT, "machine.controller.safety_feed", 1.0)
w("Controller.home_is_stop", EDING, CUT, "machine.controller.home_is_stop", True)
w("Controller.fifo_time", EDING, CUT, "machine.controller.fifo_time", 0.01)
w("Controller.dialect", EDING, CUT, "machine.controller.dialect", None)
w("EdingSettings.macro_file", EDING, CUT, "machine.settings.macro_file", "no-such-file.cnc")
w("Controller.version", EDING, CUT, "machine.controller.version", "4.03")
w("Controller.accepts", EDING, "G0 X1; G1; M30", "machine.controller.accepts", ("motion-alone",))
w(
    "Controller.accepts",
    EDING.but(*m(("machine.controller.accepts", ("scaled-z",)))),
    "G51 P2 I0 J0; G0 Z-1; M30",
    "machine.controller.accepts",
    ("unscaled-z",),
)
BACKLASH = EDING.but(*m(("machine.axes.0.backlash", 0.1)))
w(
    "Controller.limits_hold",
    BACKLASH,
    "G53 G0 X0; G53 G0 X5; G53 G0 X0; M30",
    "machine.controller.limits_hold",
    "programmed",
)
w("Board.name", EDING, CUT, "machine.board.name", "other")
w("Board.tick_frequency", EDING, CUT, "machine.board.tick_frequency", 1_000_000)
w("Board.step_pulse", EDING, CUT, "machine.board.step_pulse", 1e-5)
w("Board.step_pulse", EDING, CUT, "machine.board.step_pulse", 1e-3)
w("Board.direction_setup", EDING, CUT, "machine.board.direction_setup", 1e-3)
w("Machine.name", EDING, CUT, "machine.name", "other")
w("Machine.axes", EDING, CUT, "machine.axes", ())
w(
    "Machine.tool_change_area",
    EDING,
    CUT,
    "machine.tool_change_area",
    Area(name="rack", box=((155.0, 170.0), (100.0, 400.0), (-150.0, 0.0))),
)
w(
    "Machine.keep_out",
    EDING,
    CUT,
    "machine.keep_out",
    (Area(name="post", box=((155.0, 170.0), (100.0, 400.0), (-150.0, 0.0))),),
)
w("Machine.tools", MADE, DEEP, "machine.tools", ())
w("Machine.spindles", SPUN, CUT, "machine.spindles", (Spindle(number=0, max_rpm=300.0),))
w("Machine.unit", WINCNC, "G0 X1 Y1", "machine.unit", 1.0)
for made in (
    Unmodelled("strange = 1", "nobody knows"),
    Unmodelled("strange = 1", "nobody knows", axis="x"),
):
    w("Machine.not_modelled", EDING, CUT, "machine.not_modelled", (made,))
STRANGE = EDING.but(*m(("machine.not_modelled", (Unmodelled("strange = 1", "why"),))))
for name in ("what", "why", "file"):
    w(f"Unmodelled.{name}", STRANGE, CUT, f"machine.not_modelled.0.{name}", "other")
w("Unmodelled.touches", STRANGE, CUT, "machine.not_modelled.0.touches", "limits")
w("Unmodelled.line", STRANGE, CUT, "machine.not_modelled.0.line", 7)
w("Unmodelled.axis", STRANGE, CUT, "machine.not_modelled.0.axis", "y")
w("Machine.kinematics", EDING, CUT, "machine.kinematics", "scara")
w("Machine.spindle_started", EDING, CUT.replace("M3 S1000; ", "").replace("; M5", ""), "machine.spindle_started", True)
w("Machine.tool_change_clearance", EDING, "G43 H1; G0 Z5; T2 M6; G0 X10; M30", "machine.tool_change_clearance", -1.0)
w(
    "Machine.clearance_at_start",
    EDING.but(*m(("machine.tool_change_clearance", -1.0))).with_setup(start=exactly(x=0.0, y=0.0, z=-5.0)),
    "G53 G0 X10; T2 M6; M30",
    "machine.clearance_at_start",
    True,
)
w(
    "Machine.knife",
    EDING.but(*m(("machine.axes", (*ROUTER, ROTARY_A)))).with_setup(start=exactly(a=0.0, **HOME)),
    "tanknife on; G0 X1; G1 X5 F100; G1 Y5; M30",
    "machine.knife",
    Knife(axis="a", angle=10.0, lift=3.0),
)
TURNED = EDING.but(
    *m(("machine.axes", (*ROUTER, ROTARY_A)), ("machine.knife", Knife(axis="a", angle=10.0, lift=3.0)))
).with_setup(
    start=exactly(a=0.0, **HOME),
    g92=exactly(a=0.0, **HOME),
    homed=("x", "y", "z", "a"),
    work={(1, n): Interval(v, v) for n, v in (("x", 150.0), ("y", 120.0), ("z", -110.0), ("a", 0.0))},
)
SLIT = "tanknife on; G0 X1; G1 X5 F100; G1 Y5; G1 X2 Y7; G1 X0 Y7.1; M30"
for name, value in (("angle", 170.0), ("lift", 9.0), ("blend_angle", 80.0), ("blend_distance", 30.0)):
    w(f"Knife.{name}", TURNED, SLIT, f"machine.knife.{name}", value)

SHORT = "G0 X0; " + "; ".join(f"G1 X{n / 100} F5000" for n in range(1, 40)) + "; M30"
w("Controller.interpolation_time", BACKLASH, CUT, "machine.controller.interpolation_time", 1.0)
w("Knife.axis", TURNED, SLIT, "machine.knife.axis", "b")
NEARLY = "tanknife on; G0 X1; G1 X5 F100; G1 X5.1 Y0.01; G1 X9 Y0.4; M30"
BLENDING = TURNED.but(*m(("machine.knife.blend_angle", 30.0), ("machine.knife.blend_distance", 5.0)))
BLENDING = BLENDING.but(*m(("machine.knife.angle", 90.0))).with_setup(start=exactly(a=0.0, x=0.0, y=0.0, z=-50.0))
NEARLY = NEARLY.replace("G0 X1;", "G0 X1 Y0;")
for name, value in (("blend_angle", 0.01), ("blend_distance", 0.0)):
    w(f"Knife.{name}", BLENDING, NEARLY, f"machine.knife.{name}", value)
BACK = "G0 X1; " + "G1 X1.01 F5000; G1 X1; " * 9 + "M30"
w("Board.direction_setup", EDING, BACK, "machine.board.direction_setup", 0.01)
