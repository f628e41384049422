"""Witnesses of what a machine file states of axes, areas, tools and spindles."""

from __future__ import annotations

from fractions import Fraction

from reach.scenes import CUT, DEEP, MADE, SPUN, ZONED
from reach.witness import Witnesses, m
from reach.worlds import EDING, MCUWIN, WINCNC

from gproof.ir.dialects.mcuwin.settings import TaskCode
from gproof.ir.machine import Knife, PitchTable, Slave, Spindle

w = Witnesses()
# -- Axis, Slave, PitchTable

for side in ("lower", "upper"):
    w(f"Axis.{side}", EDING, CUT, f"machine.axes.0.{side}", 180.0)
    off = EDING.but(*m(("machine.axes.0.upper", 170.0)))
    w(f"Axis.travel_{side}", off, "mcaguard off; M3 S100; G0 X-152; G0 X25; M30", f"machine.axes.0.travel_{side}", 10.0)
w("Axis.max_velocity", EDING, CUT.replace("F200", "F2000"), "machine.axes.0.max_velocity", 20.0)
w("Axis.max_acceleration", EDING, CUT, "machine.axes.0.max_acceleration", 20.0)
w("Axis.max_acceleration", WINCNC, "G0 X1", "machine.axes.0.max_acceleration", None)
w("Axis.backlash", EDING, CUT, "machine.axes.0.backlash", 0.1)
w("Axis.backlash", EDING, "G53 G0 X0; G53 G0 X5; G53 G0 X0; M30", "machine.axes.0.backlash", 0.1)
w("Axis.slaves", EDING, CUT, "machine.axes.0.slaves", (Slave(joint="a", lower=100.0, upper=170.0),))
w("Axis.pitch", EDING, CUT, "machine.axes.0.pitch", PitchTable(machine=(0.0, 600.0), calibrated=(0.0, 400.0)))
w(
    "Axis.pitch",
    EDING,
    "G53 G0 X590; M30",
    "machine.axes.0.pitch",
    PitchTable(machine=(0.0, 600.0), calibrated=(0.0, 580.0)),
)
w("Axis.steps_per_unit", EDING, CUT, "machine.axes.0.steps_per_unit", Fraction(100))
w(
    "Axis.steps_per_unit",
    EDING.but(*m(("machine.controller.max_step_frequency", 1000.0))),
    CUT,
    "machine.axes.0.steps_per_unit",
    Fraction(100),
)
w("Axis.tip_feed", EDING, CUT, "machine.axes.0.tip_feed", True)
w("Axis.letter", WINCNC, "G0 X1", "machine.axes.0.letter", "A")
w("Axis.vertical", WINCNC, "G53; G0 Z-1; G28", "machine.axes.2.vertical", False)
w("Axis.vertical", WINCNC.with_setup(measures={}), "G0 X1 Z-1", "machine.axes.2.vertical", False)
for side in ("lower", "upper"):
    w(f"Axis.boundary_{side}", WINCNC, "G0 X1 Y2", f"machine.axes.0.boundary_{side}", 30.0 if side == "lower" else 10.0)
w("Axis.feed_velocity", WINCNC, "M11C1; G1 X1", "machine.axes.0.feed_velocity", 20.0)
w("Axis.position_unit", MCUWIN, "G90 G71; G00 X10; M30", "machine.axes.0.position_unit", 2.0)
w(
    "Axis.home_place",
    MCUWIN.but(*m(("machine.settings.tasks", (TaskCode(code="G74", action="home"),)))),
    "G74 X0; G91 G00 X5; M30",
    "machine.axes.0.home_place",
    50.0,
)
w("Axis.home_position", EDING, "home x; G53 G0 X5; M30", "machine.axes.0.home_position", 50.0)
w("Axis.home_velocity", ZONED, "home x; M30", "machine.axes.0.home_velocity", -10.0)
GANTRY = EDING.but(*m(("machine.axes.0.slaves", (Slave(joint="a"),))))
w("Slave.lower", GANTRY, CUT, "machine.axes.0.slaves.0.lower", 180.0)
w("Slave.upper", GANTRY, CUT, "machine.axes.0.slaves.0.upper", 180.0)
for side in ("lower", "upper"):
    off = GANTRY.but(*m(("machine.axes.0.upper", 170.0)))
    w(
        f"Slave.travel_{side}",
        off,
        "mcaguard off; G0 X-152; G0 X25; M30",
        f"machine.axes.0.slaves.0.travel_{side}",
        10.0,
    )
w("Slave.steps_per_unit", GANTRY, CUT, "machine.axes.0.slaves.0.steps_per_unit", Fraction(100))
w("Slave.max_velocity", GANTRY, CUT.replace("F200", "F5000"), "machine.axes.0.slaves.0.max_velocity", 20.0)
w("Slave.max_acceleration", GANTRY, CUT, "machine.axes.0.slaves.0.max_acceleration", 20.0)
w("Slave.backlash", GANTRY, CUT, "machine.axes.0.slaves.0.backlash", 0.1)
w("Slave.backlash", GANTRY, "G53 G0 X0; G53 G0 X5; G53 G0 X0; M30", "machine.axes.0.slaves.0.backlash", 0.1)
w(
    "Slave.pitch",
    GANTRY,
    CUT,
    "machine.axes.0.slaves.0.pitch",
    PitchTable(machine=(0.0, 600.0), calibrated=(0.0, 400.0)),
)
PITCHED = EDING.but(*m(("machine.axes.0.pitch", PitchTable(machine=(0.0, 590.0), calibrated=(0.0, 600.0)))))
for name in ("machine", "calibrated"):
    w(f"PitchTable.{name}", PITCHED, "G53 G0 X590; M30", f"machine.axes.0.pitch.{name}", (0.0, 580.0))

# -- Area, Tool, Spindle, Knife, Board, Controller, Machine

w(
    "Area.box",
    ZONED,
    "G53 G0 X5; G53 G0 X10; M30",
    "machine.keep_out.0.box",
    ((7.0, 9.0), (-50.0, 400.0), (-150.0, 10.0)),
)
w("Area.rings", ZONED, "G53 G0 X30; M30", "machine.keep_out.0.rings", (((39.0, 10.0), (40.0, 10.0), (40.0, 40.0)),))
w("Area.work", ZONED, "G53 G0 X30; M30", "machine.keep_out.0.work", 1)
w("Tool.diameter", MADE, DEEP, "machine.tools.0.diameter", 0.5)
w("Tool.diameter", ZONED, "G53 G0 X16; M30", "machine.tools.0.diameter", 16.0)
w(
    "Tool.diameter",
    EDING,
    "M3 S100; G43 H1; G41 D1 G1 X10 Y10 F200; X60; Y40; G40 X70; M30",
    "machine.tools.0.diameter",
    2.0,
)
w("Tool.length", MADE, DEEP, "machine.tools.0.length", 60.0)
w("Tool.number", EDING, CUT, "machine.tools.0.number", 7)
w("Tool.shape", MADE, DEEP, "machine.tools.0.shape", "ball")
w("Tool.x_offset", EDING, "G43 H1; G0 X10; M30", "machine.tools.0.x_offset", 5.0)
w(
    "Tool.orientation",
    EDING.but(*m(("machine.controller.turning", True))),
    "G18; G43 H1; G0 X50 Z0; G41 D1 G1 X40 Z-1 F100; Z-20; X45; G40 X60; M30",
    "machine.tools.0.orientation",
    3,
)
BULL = MADE.but(*m(("machine.tools.0.shape", "bull"), ("machine.tools.0.corner_radius", 0.1)))
SLOPE = DEEP.replace("Z-2.5", "Z-2.2").replace("X30", "X16")
w("Tool.corner_radius", BULL, DEEP.replace("X30", "X17.9"), "machine.tools.0.corner_radius", 2.9)
VEE = MADE.but(
    *m(("machine.tools.0.shape", "vee"), ("machine.tools.0.tip_angle", 60.0), ("machine.tools.0.tip_diameter", 0.2))
)
w("Tool.tip_angle", VEE, DEEP.replace("X30", "X19"), "machine.tools.0.tip_angle", 150.0)
w("Tool.tip_diameter", VEE, DEEP.replace("X30", "X19"), "machine.tools.0.tip_diameter", 5.0)
for name, value in (
    ("flute_length", 1.0),
    ("shank_diameter", 30.0),
    ("stickout", 3.0),
    ("holder", ((80.0, 90.0, 20.0),)),
):
    w(f"Tool.{name}", MADE, DEEP.replace("G1 Z6;", "G1 Z6; G0 X-13;"), f"machine.tools.0.{name}", value)
w("Tool.holder", ZONED, "G53 G0 X10; M30", "machine.tools.0.holder", ((40.0, 40.0, 20.0),))
w("Tool.shank_diameter", ZONED, "G53 G0 X10; M30", "machine.tools.0.shank_diameter", 40.0)
w("Tool.min_rpm", EDING, CUT, "machine.tools.0.min_rpm", 5000.0)
w("Tool.max_rpm", EDING, CUT, "machine.tools.0.max_rpm", 500.0)
w("Tool.max_feed", EDING, CUT, "machine.tools.0.max_feed", 1.0)
w("Tool.max_plunge", EDING, CUT, "machine.tools.0.max_plunge", 1.0)
w("Tool.max_depth", MADE, DEEP, "machine.tools.0.max_depth", 1.0)
w("Spindle.min_rpm", SPUN, CUT, "machine.spindles.0.min_rpm", 3000.0)
w("Spindle.max_rpm", SPUN, CUT, "machine.spindles.0.max_rpm", 300.0)
w("Spindle.spin_up", SPUN, CUT, "machine.spindles.0.spin_up", 30.0)
w("Spindle.ramp_time", SPUN, CUT, "machine.spindles.0.ramp_time", 3.0)
w("Spindle.number", SPUN, "M91; G0 X10; M30", "machine.spindles.1.number", 2)
w("Spindle.offset", SPUN, "M91; G0 X10; M30", "machine.spindles.1.offset", (20.0, 0.0, 0.0))
w("Spindle.unsigned", SPUN, "M91; G0 X10; M30", "machine.spindles.1.unsigned", True)
w("Spindle.pwm", SPUN, CUT, "machine.spindles.0.pwm", ((0.0, 0.0), (24000.0, 100.0)))
w(
    "Spindle.oriented_stop",
    SPUN,
    "M3 S500; G43 H1; G0 X10 Y10 Z5; G87 X10 Y10 Z-5 R2 I1 J0 K1 F100; M30",
    "machine.spindles.0.oriented_stop",
    True,
)
ROUTED = WINCNC.but(*m(("machine.spindles", (Spindle(number=0, output=1, max_rpm=20000.0),))))
w("Spindle.output", ROUTED, "M11C1; G1 Z-1 F60; M12C1", "machine.spindles.0.output", 3)
KNIVED = EDING.but(*m(("machine.knife", Knife(axis="a", angle=10.0, lift=3.0, blend_angle=5.0, blend_distance=1.0))))
