"""Programs in which a stated fact can be seen: the answers differ when it changes, and in which targets.

Each is (row, world, program, path of the fact, another value). The program and the world are chosen so that the fact
matters; the values that the answers change to are no expectation here, only that they change.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any, NamedTuple

from reach.changes import Path
from reach.worlds import BLOCK, EDING, HOME, MCUWIN, WINCNC, World, exactly

from gproof.ir.controls import Changer, HomingLine, KnifeMode, MeasureSwitch, SawMode, TorchControl, Workspace
from gproof.ir.din import RadiusTool, TaskCode
from gproof.ir.machine import Area, Axis, AxisKind, Knife, PitchTable, Slave, Spindle, Unmodelled

ROTARY = AxisKind.ROTARY
from gproof.ir.setup import CylinderMap, HeightMap, InForce, Interval, StoredPosition
from gproof.ir.workpiece import Cylinder, Placed, Prism, Workpiece


class Witness(NamedTuple):
    """See the module's text."""

    row: str
    world: World
    program: str
    path: Path
    value: Any


WITNESSES: list[Witness] = []


def w(row: str, world: World, program: str, path: str, value: Any) -> None:
    """One more; the path is dotted, with numbers as places in a tuple: ``machine.axes.0.lower``."""
    steps = tuple(int(step) if step.lstrip("-").isdigit() else step for step in path.split("."))
    WITNESSES.append(Witness(row, world, program.replace("; ", "\n") + "\n", steps, value))


def m(*changes: tuple[str, Any]) -> tuple[tuple[Path, Any], ...]:
    """Changes of a world by dotted paths."""
    return tuple(
        (tuple(int(s) if s.isdigit() else s for s in path.split(".")), value) for path, value in changes
    )


CUT = "G21 G90 G17; M3 S1000; G0 G43 H1 X10 Y10 Z5; G1 Z-1 F200; G1 X50; G2 X60 Y20 I10 J0; G0 Z5; M5; M30"
BLOCKED = EDING.with_setup(workpiece=BLOCK)

ROUTER = tuple(
    Axis(
        name=name, kind=AxisKind.LINEAR, steps_per_unit=Fraction(320), lower=low, upper=high, travel_lower=low - 4.0,
        travel_upper=high + 4.0, max_velocity=100.0, max_acceleration=500.0,
    )
    for name, low, high in (("x", 0.0, 600.0), ("y", 0.0, 400.0), ("z", -150.0, 0.0))
)
ROTARY_A = Axis(
    name="a", kind=ROTARY, steps_per_unit=Fraction(10), lower=-400.0, upper=400.0, max_velocity=50.0,
    max_acceleration=100.0,
)

# -- Axis, Slave, PitchTable

for side in ("lower", "upper"):
    w(f"Axis.{side}", EDING, CUT, f"machine.axes.0.{side}", 180.0)
    off = EDING.but(*m(("machine.axes.0.upper", 170.0)))
    w(f"Axis.travel_{side}", off, "mcaguard off; M3 S100; G0 X-152; G0 X25; M30", f"machine.axes.0.travel_{side}", 10.0)
w("Axis.max_velocity", EDING, CUT.replace("F200", "F5000"), "machine.axes.0.max_velocity", 20.0)
w("Axis.max_acceleration", EDING, CUT, "machine.axes.0.max_acceleration", 20.0)
w("Axis.max_acceleration", WINCNC, "G0 X1", "machine.axes.0.max_acceleration", None)
w("Axis.backlash", EDING, CUT, "machine.axes.0.backlash", 0.1)
w("Axis.backlash", EDING, "G53 G0 X0; G53 G0 X5; G53 G0 X0; M30", "machine.axes.0.backlash", 0.1)
w("Axis.slaves", EDING, CUT, "machine.axes.0.slaves", (Slave(joint="a", lower=100.0, upper=170.0),))
w("Axis.pitch", EDING, CUT, "machine.axes.0.pitch", PitchTable(machine=(0.0, 600.0), calibrated=(0.0, 400.0)))
w("Axis.pitch", EDING, "G53 G0 X590; M30", "machine.axes.0.pitch", PitchTable(machine=(0.0, 600.0), calibrated=(0.0, 580.0)))
w("Axis.steps_per_unit", EDING, CUT, "machine.axes.0.steps_per_unit", Fraction(100))
w("Axis.steps_per_unit", EDING.but(*m(("machine.controller.max_step_frequency", 1000.0))), CUT, "machine.axes.0.steps_per_unit", Fraction(100))
w("Axis.tip_feed", EDING, CUT, "machine.axes.0.tip_feed", True)
w("Axis.letter", WINCNC, "G0 X1", "machine.axes.0.letter", "A")
w("Axis.vertical", WINCNC, "G53; G0 Z-1; G28", "machine.axes.2.vertical", False)
w("Axis.vertical", WINCNC.with_setup(measures={}), "G0 X1 Z-1", "machine.axes.2.vertical", False)
for side in ("lower", "upper"):
    w(f"Axis.boundary_{side}", WINCNC, "G0 X1 Y2", f"machine.axes.0.boundary_{side}", 30.0 if side == "lower" else 10.0)
w("Axis.feed_velocity", WINCNC, "M11C1; G1 X1", "machine.axes.0.feed_velocity", 20.0)
w("Axis.position_unit", MCUWIN, "G90 G71; G00 X10; M30", "machine.axes.0.position_unit", 2.0)
w("Axis.home_place", MCUWIN.but(*m(("machine.controller.din.tasks", (TaskCode(code="G74", action="home"),)))), "G74 X0; G91 G00 X5; M30", "machine.axes.0.home_place", 50.0)
ZONED = EDING.but(*m(("machine.keep_out", (Area(name="post", box=((20.0, 40.0), (-50.0, 400.0), (-150.0, 10.0))),))))
w("Axis.home_position", EDING, "home x; G53 G0 X5; M30", "machine.axes.0.home_position", 50.0)
w("Axis.home_velocity", ZONED, "home x; M30", "machine.axes.0.home_velocity", -10.0)
GANTRY = EDING.but(*m(("machine.axes.0.slaves", (Slave(joint="a"),))))
w("Slave.lower", GANTRY, CUT, "machine.axes.0.slaves.0.lower", 180.0)
w("Slave.upper", GANTRY, CUT, "machine.axes.0.slaves.0.upper", 180.0)
for side in ("lower", "upper"):
    off = GANTRY.but(*m(("machine.axes.0.upper", 170.0)))
    w(f"Slave.travel_{side}", off, "mcaguard off; G0 X-152; G0 X25; M30", f"machine.axes.0.slaves.0.travel_{side}", 10.0)
w("Slave.steps_per_unit", GANTRY, CUT, "machine.axes.0.slaves.0.steps_per_unit", Fraction(100))
w("Slave.max_velocity", GANTRY, CUT.replace("F200", "F5000"), "machine.axes.0.slaves.0.max_velocity", 20.0)
w("Slave.max_acceleration", GANTRY, CUT, "machine.axes.0.slaves.0.max_acceleration", 20.0)
w("Slave.backlash", GANTRY, CUT, "machine.axes.0.slaves.0.backlash", 0.1)
w("Slave.backlash", GANTRY, "G53 G0 X0; G53 G0 X5; G53 G0 X0; M30", "machine.axes.0.slaves.0.backlash", 0.1)
w("Slave.pitch", GANTRY, CUT, "machine.axes.0.slaves.0.pitch", PitchTable(machine=(0.0, 600.0), calibrated=(0.0, 400.0)))
PITCHED = EDING.but(*m(("machine.axes.0.pitch", PitchTable(machine=(0.0, 590.0), calibrated=(0.0, 600.0)))))
for name in ("machine", "calibrated"):
    w(f"PitchTable.{name}", PITCHED, "G53 G0 X590; M30", f"machine.axes.0.pitch.{name}", (0.0, 580.0))

# -- Area, Tool, Spindle, Knife, Board, Controller, Machine

w("Area.box", ZONED, "G53 G0 X5; G53 G0 X10; M30", "machine.keep_out.0.box", ((7.0, 9.0), (-50.0, 400.0), (-150.0, 10.0)))
w("Area.rings", ZONED, "G53 G0 X30; M30", "machine.keep_out.0.rings", (((39.0, 10.0), (40.0, 10.0), (40.0, 40.0)),))
w("Area.work", ZONED, "G53 G0 X30; M30", "machine.keep_out.0.work", 1)
SOLID = Workpiece(
    stock=BLOCK.stock,
    part=(Placed(name="part", body=Prism(outline=((20.0, 20.0), (100.0, 20.0), (100.0, 60.0), (20.0, 60.0)), low=-15.0, high=-2.0)),),
    fixtures=(Placed(name="pin", body=Cylinder(x=-20.0, y=40.0, radius=5.0, low=0.0, high=12.0)),),
)
MADE = EDING.with_setup(workpiece=SOLID)
DEEP = "G21 G90 G17; M3 S1000; G0 G43 H1 X10 Y40 Z5; G1 Z-2.5 F200; G1 X30; G0 Z5; G0 X-10; G1 Z6; M5; M30"
w("Tool.diameter", MADE, DEEP, "machine.tools.0.diameter", 0.5)
w("Tool.diameter", ZONED, "G53 G0 X16; M30", "machine.tools.0.diameter", 16.0)
w("Tool.diameter", EDING, "M3 S100; G43 H1; G41 D1 G1 X10 Y10 F200; X60; Y40; G40 X70; M30", "machine.tools.0.diameter", 2.0)
w("Tool.length", MADE, DEEP, "machine.tools.0.length", 60.0)
w("Tool.number", EDING, CUT, "machine.tools.0.number", 7)
w("Tool.shape", MADE, DEEP, "machine.tools.0.shape", "ball")
w("Tool.x_offset", EDING, "G43 H1; G0 X10; M30", "machine.tools.0.x_offset", 5.0)
w("Tool.orientation", EDING.but(*m(("machine.controller.turning", True))), "G18; G43 H1; G0 X50 Z0; G41 D1 G1 X40 Z-1 F100; Z-20; X45; G40 X60; M30", "machine.tools.0.orientation", 3)
BULL = MADE.but(*m(("machine.tools.0.shape", "bull"), ("machine.tools.0.corner_radius", 0.1)))
SLOPE = DEEP.replace("Z-2.5", "Z-2.2").replace("X30", "X16")
w("Tool.corner_radius", BULL, DEEP.replace("X30", "X17.9"), "machine.tools.0.corner_radius", 2.9)
VEE = MADE.but(*m(("machine.tools.0.shape", "vee"), ("machine.tools.0.tip_angle", 60.0), ("machine.tools.0.tip_diameter", 0.2)))
w("Tool.tip_angle", VEE, DEEP.replace("X30", "X19"), "machine.tools.0.tip_angle", 150.0)
w("Tool.tip_diameter", VEE, DEEP.replace("X30", "X19"), "machine.tools.0.tip_diameter", 5.0)
for name, value in (("flute_length", 1.0), ("shank_diameter", 30.0), ("stickout", 3.0), ("holder", ((80.0, 90.0, 20.0),))):
    w(f"Tool.{name}", MADE, DEEP.replace('G1 Z6;', 'G1 Z6; G0 X-13;'), f"machine.tools.0.{name}", value)
w("Tool.holder", ZONED, "G53 G0 X10; M30", "machine.tools.0.holder", ((40.0, 40.0, 20.0),))
w("Tool.shank_diameter", ZONED, "G53 G0 X10; M30", "machine.tools.0.shank_diameter", 40.0)
w("Tool.min_rpm", EDING, CUT, "machine.tools.0.min_rpm", 5000.0)
w("Tool.max_rpm", EDING, CUT, "machine.tools.0.max_rpm", 500.0)
w("Tool.max_feed", EDING, CUT, "machine.tools.0.max_feed", 1.0)
w("Tool.max_plunge", EDING, CUT, "machine.tools.0.max_plunge", 1.0)
w("Tool.max_depth", MADE, DEEP, "machine.tools.0.max_depth", 1.0)
SPUN = EDING.but(*m(("machine.spindles", (Spindle(number=0, min_rpm=100.0, max_rpm=24000.0), Spindle(number=1, offset=(10.0, 0.0, 0.0))))))
w("Spindle.min_rpm", SPUN, CUT, "machine.spindles.0.min_rpm", 3000.0)
w("Spindle.max_rpm", SPUN, CUT, "machine.spindles.0.max_rpm", 300.0)
w("Spindle.spin_up", SPUN, CUT, "machine.spindles.0.spin_up", 30.0)
w("Spindle.ramp_time", SPUN, CUT, "machine.spindles.0.ramp_time", 3.0)
w("Spindle.number", SPUN, "M91; G0 X10; M30", "machine.spindles.1.number", 2)
w("Spindle.offset", SPUN, "M91; G0 X10; M30", "machine.spindles.1.offset", (20.0, 0.0, 0.0))
w("Spindle.unsigned", SPUN, "M91; G0 X10; M30", "machine.spindles.1.unsigned", True)
w("Spindle.pwm", SPUN, CUT, "machine.spindles.0.pwm", ((0.0, 0.0), (24000.0, 100.0)))
w("Spindle.oriented_stop", SPUN, "M3 S500; G43 H1; G0 X10 Y10 Z5; G87 X10 Y10 Z-5 R2 I1 J0 K1 F100; M30", "machine.spindles.0.oriented_stop", True)
ROUTED = WINCNC.but(*m(("machine.spindles", (Spindle(number=0, output=1, max_rpm=20000.0),))))
w("Spindle.output", ROUTED, "M11C1; G1 Z-1 F60; M12C1", "machine.spindles.0.output", 3)
KNIVED = EDING.but(*m(("machine.knife", Knife(axis="a", angle=10.0, lift=3.0, blend_angle=5.0, blend_distance=1.0))))


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
w("Controller.thread_peak", LATHE, "M3 S300; G18; G0 X50 Z5; G76 P1 Z-20 I-2 J0.3 K1 R1.5 Q29 H2 E0 L0; M30", "machine.controller.thread_peak", "position")
w("Controller.straight_traverse", ZONED, "G53 G0 X10 Y50; G53 G0 X50 Y-60; M30", "machine.controller.straight_traverse", False)
w("Controller.homing_mandatory", EDING.with_setup(homed=()), CUT, "machine.controller.homing_mandatory", True)
w("Controller.super_long_file", EDING, CUT + "; if [1 == 2]; endif", "machine.controller.super_long_file", 0.01)
w("Controller.safety_feed", EDING.with_setup(homed=()), CUT, "machine.controller.safety_feed", 1.0)
w("Controller.home_is_stop", EDING, CUT, "machine.controller.home_is_stop", True)
w("Controller.fifo_time", EDING, CUT, "machine.controller.fifo_time", 0.01)
w("Controller.dialect", EDING, CUT, "machine.controller.dialect", None)
w("Controller.macro_file", EDING, CUT, "machine.controller.macro_file", "no-such-file.cnc")
w("Board.name", EDING, CUT, "machine.board.name", "other")
w("Board.tick_frequency", EDING, CUT, "machine.board.tick_frequency", 1_000_000)
w("Board.step_pulse", EDING, CUT, "machine.board.step_pulse", 1e-5)
w("Board.step_pulse", EDING, CUT, "machine.board.step_pulse", 1e-3)
w("Board.direction_setup", EDING, CUT, "machine.board.direction_setup", 1e-3)
w("Machine.name", EDING, CUT, "machine.name", "other")
w("Machine.axes", EDING, CUT, "machine.axes", ())
w("Machine.tool_change_area", EDING, CUT, "machine.tool_change_area", Area(name="rack", box=((155.0, 170.0), (100.0, 400.0), (-150.0, 0.0))))
w("Machine.keep_out", EDING, CUT, "machine.keep_out", (Area(name="post", box=((155.0, 170.0), (100.0, 400.0), (-150.0, 0.0))),))
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
w("Unmodelled.line", STRANGE, CUT, "machine.not_modelled.0.line", 7)
w("Unmodelled.axis", STRANGE, CUT, "machine.not_modelled.0.axis", "y")
w("Machine.kinematics", EDING, CUT, "machine.kinematics", "scara")
w("Machine.spindle_started", EDING, CUT.replace("M3 S1000; ", "").replace("; M5", ""), "machine.spindle_started", True)
w("Machine.tool_change_clearance", EDING, "G43 H1; G0 Z5; T2 M6; G0 X10; M30", "machine.tool_change_clearance", -1.0)
w("Machine.clearance_at_start", EDING.but(*m(("machine.tool_change_clearance", -1.0))).with_setup(start=exactly(x=0.0, y=0.0, z=-5.0)), "G53 G0 X10; T2 M6; M30", "machine.clearance_at_start", True)
w("Machine.knife", EDING.but(*m(("machine.axes", (*ROUTER, ROTARY_A)))).with_setup(start=exactly(a=0.0, **HOME)), "tanknife on; G0 X1; G1 X5 F100; G1 Y5; M30", "machine.knife", Knife(axis="a", angle=10.0, lift=3.0))
TURNED = EDING.but(*m(("machine.axes", (*ROUTER, ROTARY_A)), ("machine.knife", Knife(axis="a", angle=10.0, lift=3.0)))).with_setup(
    start=exactly(a=0.0, **HOME), g92=exactly(a=0.0, **HOME), homed=("x", "y", "z", "a"),
    work={(1, n): Interval(v, v) for n, v in (("x", 150.0), ("y", 120.0), ("z", -110.0), ("a", 0.0))},
)
SLIT = "tanknife on; G0 X1; G1 X5 F100; G1 Y5; G1 X2 Y7; G1 X0 Y7.1; M30"
for name, value in (("angle", 170.0), ("lift", 9.0), ("blend_angle", 80.0), ("blend_distance", 30.0)):
    w(f"Knife.{name}", TURNED, SLIT, f"machine.knife.{name}", value)
w("Axis.kind", TURNED.but(*m(("machine.knife", None))), "G20; G0 A1; M30", "machine.axes.3.kind", AxisKind.LINEAR)

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
    start=exactly(a=0.0, **HOME), homed=("x", "y", "z", "a"), cylinder=CylinderMap(radius=30.0, y=150.0, z=-120.0, zero=100.0)
)
w("Setup.cylinder", ROLLED, CUT.replace("X50", "Y30"), "setup.cylinder", None)
for name, value in (("radius", 10.0), ("y", 170.0), ("z", -100.0), ("zero", 20.0)):
    w(f"CylinderMap.{name}", ROLLED, CUT, f"setup.cylinder.{name}", value)
    w(f"CylinderMap.{name}", ROLLED, CUT, f"setup.cylinder.{name}", None)
GRID = HeightMap(x=150.0, y=120.0, size=40.0, heights=((0.0, 1.0, 2.0), (0.0, 0.5, 3.0)), name="map")
WARPED = EDING.with_setup(height_map=GRID)
w("Setup.height_map", EDING, CUT, "setup.height_map", GRID)
for name, value in (("x", 100.0), ("y", 100.0), ("size", 10.0), ("heights", ((0.0, 0.0), (0.0, 200.0))), ("on", False), ("name", "other")):
    w(f"HeightMap.{name}", WARPED, CUT, f"setup.height_map.{name}", value)
w("Setup.heads", SPUN.but(*m(("machine.spindles.1.offset", (None, None, None)))), "M91; G0 X10; M30", "setup.heads", {(1, "x"): Interval(30.0, 30.0)})
w("Setup.transform", EDING, CUT, "setup.transform", InForce(angle=30.0))
TILTED = EDING.with_setup(transform=InForce(angle=30.0, factor_x=1.0, factor_y=1.0))
for name, value in (("angle", 80.0), ("factor_x", 2.0), ("factor_y", 2.0), ("x", 30.0), ("y", 30.0)):
    w(f"InForce.{name}", TILTED, CUT, f"setup.transform.{name}", value)
w("Setup.positions", WINCNC, "G53 P4", "setup.positions", {"P4": StoredPosition(axes={"x": 100.0})})
PARKED = WINCNC.with_setup(positions={"P4": StoredPosition(axes={"x": 100.0})})
for name, value in (("axes", {"x": 300.0}), ("lift", True), ("clearance", -20.0)):
    w(f"StoredPosition.{name}", PARKED.with_setup(start=exactly(x=0.0, y=0.0, z=-50.0)), "G53 P4", f"setup.positions.P4.{name}", value)
LIFTED = WINCNC.with_setup(positions={"P4": StoredPosition(axes={"x": 100.0}, lift=True)}, start=exactly(x=0.0, y=0.0, z=-50.0))
w("StoredPosition.clearance", LIFTED, "G53 P4", "setup.positions.P4.clearance", -20.0)
w("Setup.inputs", WINCNC, "M17.1 C6; G0 X90; G0 X1", "setup.inputs", {6: 0.0})
w("Setup.inputs", EDING, "M56 P6; if [#5399 == 1]; G0 X900; endif; M30", "setup.inputs", {6: 1.0})
w("Setup.outputs", WINCNC, "M18.2 C6; G0 X90; G0 X1", "setup.outputs", {6: 0.0})
w("Setup.outputs", WINCNC, "M17.2 C6; G0 X90; G0 X1", "setup.outputs", {6: 1.0})
w("Setup.virtual", WINCNC, "M17.3 C3; G0 X90; G0 X1", "setup.virtual", {3: 1.0})
w("Setup.registers", WINCNC, "L101 T2 R3; G0 X1 Z0", "setup.registers", {3: 10.0})
w("Setup.answers", WINCNC, "G5 T1; G0 X90; G0 X1", "setup.answers", {1: 0.0})
w("Setup.measures", WINCNC, "G0 X1 Z0", "setup.measures", {})
w("Setup.contacts", WINCNC, "L91 G1 Z-5 F10 M28 G31; G0 X1", "setup.contacts", exactly(z=-50.0))
w("Setup.keep_out", EDING, CUT, "setup.keep_out", (Area(name="post", box=((155.0, 170.0), (100.0, 400.0), (-150.0, 0.0))),))
w("Setup.workpiece", BLOCKED, DEEP, "setup.workpiece", None)
w("Interval.low", EDING.with_setup(start={"x": Interval(0.0, 100.0), **exactly(y=0.0, z=0.0)}), "G91 G0 X-20; M30", "setup.start.x.low", 30.0)
w("Interval.high", EDING.with_setup(start={"x": Interval(0.0, 100.0), **exactly(y=0.0, z=0.0)}), "G91 G0 X520; M30", "setup.start.x.high", 30.0)
FULL = DEEP.replace("G1 Z6", "G0 X-12; G1 Z6")
for name, value in (("stock", ()), ("part", ()), ("fixtures", ()), ("tolerance", 3.0), ("clearance", 9.0), ("cell", 2.0)):
    w(f"Workpiece.{name}", MADE, FULL, f"setup.workpiece.{name}", value)
w("Placed.body", MADE, FULL, "setup.workpiece.part.0.body.high", -8.0)
w("Placed.work", MADE, FULL, "setup.workpiece.part.0.work", 0)
w("Placed.work", MADE, FULL, "setup.workpiece.fixtures.0.work", 0)
w("Placed.name", MADE, DEEP.replace("X-10", "X-18"), "setup.workpiece.fixtures.0.name", "post")
for name, value in (("outline", ((120.0, 20.0), (140.0, 20.0), (140.0, 60.0))), ("holes", (((10.0, 30.0), (40.0, 30.0), (40.0, 50.0), (10.0, 50.0)),)), ("low", -2.1), ("high", -8.0), ("error", 3.0)):
    w(f"Prism.{name}", MADE, FULL, f"setup.workpiece.part.0.body.{name}", value)
w("Prism.low", MADE, FULL, "setup.workpiece.part.0.body.low", -2.2)
for name, value in (("x", -10.0), ("y", 140.0), ("radius", 25.0), ("low", 6.5), ("high", 3.0)):
    w(f"Cylinder.{name}", MADE, DEEP.replace("X-10", "X-18"), f"setup.workpiece.fixtures.0.body.{name}", value)
w("Cylinder.x", MADE, FULL, "setup.workpiece.fixtures.0.body.x", -10.0)
w("Cylinder.radius", MADE, FULL, "setup.workpiece.fixtures.0.body.radius", 25.0)
for name, value in (("low", (0.0, 0.0, -1.0)), ("high", (120.0, 80.0, -3.0))):
    w(f"Box.{name}", MADE, FULL, f"setup.workpiece.stock.0.body.{name}", value)

# -- Controls

K = "machine.controller.controls"
PLASMA = World("wincnc", "wincnc/plasma/WINCNC.INI", WINCNC.setup)
FEED = "M11C1; G1 X1 Y1 F60; G1 X2; M12C1"
w("Lexical.comment_signs", WINCNC, "G0 X1 ; G0 X2".replace(";", "!"), f"{K}.lexical.comment_signs", "!")
w("Lexical.skips", WINCNC, "/G0 X900; G0 X1", f"{K}.lexical.skips", (("/", 1),))
w("Lexical.comma", WINCNC, "G0 X1,5", f"{K}.lexical.comma", True)
w("Controls.start", WINCNC, "G0 X1", f"{K}.start", "G0 X2")
w("Controls.end", WINCNC, "G0 X1", f"{K}.end", "G0 X2")
w("Controls.abort", WINCNC, "G5 T1; G0 X1", f"{K}.abort", "G0 X2")
w("Controls.unit_stated", WINCNC, "G0 X1", f"{K}.unit_stated", False)
w("Controls.coolant", WINCNC, FEED, f"{K}.coolant", (1,))
w("Controls.absolute", WINCNC, "G0 X1; X1", f"{K}.absolute", None)
ARC = "M11C1; G0 X1 Y1; G2 X2 Y2 I1 J0.0001 F60; M12C1"
w("Controls.arc_tolerance", WINCNC, ARC, f"{K}.arc_tolerance", 1e-9)
w("Controls.smallest_arc", WINCNC, ARC, f"{K}.smallest_arc", 100.0)
w("Controls.arcs_modal", WINCNC, ARC.replace("; M12C1", "; X3 Y1 I0 J-1"), f"{K}.arcs_modal", True)
w("Controls.feed_groups", WINCNC, "M11C1; G1 X1 Z0 F60; G1 Z-.01", f"{K}.feed_groups", ("xyz",))
w("Controls.command_group", WINCNC, "M11C1; F60; G1 X1", f"{K}.command_group", "z")
w("Controls.soft_limits", WINCNC, "G0 X90", f"{K}.soft_limits", False)
w("Controls.limits_available", WINCNC, "L22; G0 X90", f"{K}.limits_available", False)
w("Controls.limits_available", WINCNC, "L20; G0 X90", f"{K}.limits_available", False)
w("Controls.adjust_boundary", WINCNC, "G0 X61", f"{K}.adjust_boundary", True)
w("Controls.adjust_vertical", WINCNC, "G0 Z-2", f"{K}.adjust_vertical", True)
w("Controls.forced", WINCNC, "G0 X-.2", f"{K}.forced", ((0.0, None), (None, None)))
w("Controls.shift_sign", WINCNC.but(*m((f"{K}.workspaces", (Workspace(number=55, x=100.0, moves=False),)))), "G55; G0 X1", f"{K}.shift_sign", 1)
w("Controls.helical_arcs", WINCNC, ARC.replace("F60", "Z-.01 F60"), f"{K}.helical_arcs", False)
w("Controls.arcs_share_feed", WINCNC, ARC.replace("M12C1", "G1 X3"), f"{K}.arcs_share_feed", False)
w("Controls.inputs", WINCNC, "M17 C6; G0 X1", f"{K}.inputs", (1,))
w("Controls.outputs", WINCNC, "M11 C5; G0 X1", f"{K}.outputs", (1,))
w("Controls.unsteady_outputs", WINCNC, "M11 C5; M17.2 C5; G0 X90", f"{K}.unsteady_outputs", (5,))
w("Controls.drill_banks", WINCNC, "M11 D1; M17.2 C5; G0 X90", f"{K}.drill_banks", ((5, 2),))
w("Controls.devices", PLASMA, "L38; G0 X1; L39", f"{K}.devices", ())
w("Controls.positions", WINCNC, "L500 P4; G0 X1; G53 P4", f"{K}.positions", 2)
w("Controls.homes", WINCNC, "L500 H4; G0 X1; G53 H4", f"{K}.homes", 2)
w("Controls.tool_positions", WINCNC, "L500 T4; G0 X1; G53 T4", f"{K}.tool_positions", 2)
w("Controls.nesting", WINCNC, "M98 PARK.MAC; G0 X1", f"{K}.nesting", 0)
w("Controls.around_files", WINCNC.but(*m((f"{K}.start", "G91"))), "G90; M98 PARK.MAC; G0 X1", f"{K}.around_files", True)
w("Controls.array_order", WINCNC, "L10 X2 R2 Y3 C2; G0 X1; G1 Z-.01 F20; G0 Z0", f"{K}.array_order", "rows")
w("Controls.highest_channel", WINCNC, "M11 C5; G0 X1", f"{K}.highest_channel", 3)
w("Controls.highest_channel", WINCNC.but(*m((f"{K}.outputs", None))), "M11 C5; G0 X1", f"{K}.highest_channel", 3)
w("Controls.rotation_sign", WINCNC, "G52 A30; G0 X2 Y5", f"{K}.rotation_sign", -1)
w("Controls.virtual_on", WINCNC, "L61 C3; M17.3 C3; G0 X90; G0 X1", f"{K}.virtual_on", 60)
w("Controls.workspaces", WINCNC, "G55; G0 X1", f"{K}.workspaces", (Workspace(number=55, x=100.0, moves=False),))
SHIFTED = WINCNC.but(*m((f"{K}.workspaces", (Workspace(number=55, x=100.0, y=10.0, moves=False),)), (f"{K}.shift_sign", 1)))
for name, value in (("number", 56), ("x", 300.0), ("y", 30.0), ("kind", 3), ("moves", True)):
    w(f"Workspace.{name}", SHIFTED, "G55; G0 X1 Y1", f"{K}.workspaces.0.{name}", value)
SPUN_ABOUT = SHIFTED.but(*m((f"{K}.workspaces.0.kind", 3), (f"{K}.workspaces.0.radius", 5.0)))
w("Workspace.radius", SPUN_ABOUT, "G55; G0 X1 Y1", f"{K}.workspaces.0.radius", 500.0)
w("Workspace.offset", SPUN_ABOUT, "G55; G0 X1 Y1", f"{K}.workspaces.0.offset", 50.0)
w("Controls.changers", WINCNC, "L101 T2; G43; G0 X1 Z0", f"{K}.changers", ())
for name, value in (("number", 2), ("height", 30.0), ("sensor", 3.0), ("spindle_height", 5.0), ("axis", "y"), ("in_library", True)):
    w(f"Changer.{name}", WINCNC, "L101 T2; G43; G0 X1 Z0", f"{K}.changers.0.{name}", value)
    w(f"Changer.{name}", WINCNC, "M37 Z1 T2; G43; G0 X1 Z0", f"{K}.changers.0.{name}", value)
for name, value in (("x", 10.0), ("y", 10.0), ("i", 10.0), ("j", 10.0), ("descent", -5.0), ("feed", 1.0)):
    w(f"MeasureSwitch.{name}", WINCNC, "G53 X{TMX} Y{TMY}; L91 G1 Z-1 F{TMF}; L91 G0 Z{TMD}; G0 X1", f"{K}.measure.{name}", value)
    w(f"MeasureSwitch.{name}", WINCNC, "G53 X{TMI} Y{TMJ}; L91 G0 Z{TMD}; G0 X1", f"{K}.measure.{name}", value)
w("Controls.measure", WINCNC, "G53 X{TMX} Y{TMY}; L91 G1 Z-1 F{TMF}; L91 G0 Z{TMD}; G0 X1", f"{K}.measure", None)
DRILL = "M11C1; G0 X1 Z.2; G83 X1 Z-.01 R.1 Q.01 F20; G80; M12C1"
w("Controls.drill", WINCNC, DRILL.replace("G83", "G81"), f"{K}.drill.dwell", 5.0)
for name, value in (("dwell", 5.0), ("other_dwell", 5.0), ("approach", 2.0), ("lift", 2.0)):
    for cycle in ("G81", "G82", "G83", "G73"):
        w(f"DrillSettings.{name}", WINCNC, DRILL.replace("G83", cycle), f"{K}.drill.{name}", value)
AUTO = WINCNC.but(*m((f"{K}.auto_output", 4), (f"{K}.auto_output_on", True), (f"{K}.auto_dwell", (0.1, 0.1))))
w("Controls.auto_output", AUTO, FEED, f"{K}.auto_output", 5)
w("Controls.auto_output_on", AUTO, FEED, f"{K}.auto_output_on", False)
w("Controls.auto_dwell", AUTO, FEED, f"{K}.auto_dwell", (1.0, 2.0))
w("Controls.auto_pausing", AUTO, FEED, f"{K}.auto_pausing", False)
w("Controls.axis_order", WINCNC, "L300 X; G0 X1 Y1", f"{K}.axis_order", "yxz")
w("Controls.smoothing", WINCNC.with_setup(keep_out=(Area(name="post", box=((30.0, 40.0), (0.0, 9.0), (-150.0, 9.0))),)), "M11C1; G1 Y1 F60; X3; Y0", f"{K}.smoothing", False)
HOMER = WINCNC.with_setup(keep_out=(Area(name="post", box=((30.0, 40.0), (-50.0, 9.0), (-150.0, -9.0))),))
w("Controls.homing", HOMER, "G28; G0 X1", f"{K}.homing", ())
for name, value in (("distances", (("y", 5.0),)), ("retreat", 20.0), ("feed", 1.0), ("second_feed", 1.0), ("longest", 5.0), ("alternate", True), ("singly", True)):
    w(f"HomingLine.{name}", HOMER, "G28; G0 X1", f"{K}.homing.0.{name}", value)
w("Controls.probe_input", WINCNC, "L91 G1 Z-5 F10 M28 G31; G0 X1", f"{K}.probe_input", 3)
w("Controls.probe_axis", WINCNC, "L82 Z0; G0 X1", f"{K}.probe_axis", "x")
w("Controls.compensation_entry", WINCNC, "M11C1; G41 O0; G1 X1 F60; G1 Y1; G40", f"{K}.compensation_entry", True)
w("Controls.compensation_swapped", WINCNC, "M11C1; G41 O0; G1 X1 F60; G1 Y1; G40", f"{K}.compensation_swapped", True)
w("Controls.override", WINCNC, "L40 P20; " + FEED, f"{K}.override", (50.0, 60.0))
w("Controls.override_enabled", WINCNC, "L40 P50; " + FEED, f"{K}.override_enabled", False)
w("Controls.places", WINCNC, FEED, f"{K}.places", ())
NC = World("wincnc", "wincnc/knife-twohead/WINCNC.INI", WINCNC.setup).with_setup(
    homed=("x", "y", "z", "w", "c"), start=exactly(x=0.0, y=0.0, z=0.0, a=0.0, c=0.0, b=0.0), measures=exactly(z=0.0),
    work={}, default_start=0.0,
)  # fmt: skip
KNIFE = "G90; L30; G0 X10 Y10; G0 Z0; G92 X0 Y0 Z0; G1 X20 F600; G1 Y20; G1 X25 Y26; G2 X35 Y26 I5 J0; L31; G0 X0"
w("Controls.knife", NC, KNIFE, f"{K}.knife", None)
for name, value in (
    ("axis", "z"), ("target", True), ("angle", 170.0), ("blend", 1.0), ("lifted", 1.0), ("lowered", -1.0), ("vertical", ""),
    ("output", 4), ("dwell", 2.0), ("automatic", True), ("lifts_in_arcs", False), ("blade", 10.0), ("both_ways", True),
    ("x", 3.0), ("y", 3.0),
):  # fmt: skip
    w(f"KnifeMode.{name}", NC, KNIFE, f"{K}.knife.{name}", value)
w("Controls.knife_positions", NC, KNIFE, f"{K}.knife_positions", "work")
SAWN = NC.but(*m((f"{K}.saw", SawMode(axis="c", radius=100.0)), (f"{K}.devices", ("saw",))))
w("Controls.saw", SAWN, "L32; G0 X1", f"{K}.saw", None)

for name, value in (("axis", "z"), ("radius", 5.0), ("offset", 90.0), ("lift", 30.0)):
    w(f"SawMode.{name}", SAWN, "L32; G0 X10; G1 X20 F600; G1 Y20; L33; G0 X0", f"{K}.saw.{name}", value)

TORCH = TorchControl(axis="z", feed=10.0, output=1, input=3, start_delay=0.5, end_delay=0.5, compression=2.0, lift=5.0)
TORCHED = PLASMA.but(*m((f"{K}.torch", TORCH), (f"{K}.devices", ("thc",))))
BURN = "L36; L38; G1 X10 F600; L39; L37; G0 X0; G0 Z-10"
BURN_OFF = "L37; L38; G1 X10 F600; L39; G0 X0; G91; G0 Z-1"
w("Controls.torch", TORCHED, BURN_OFF, f"{K}.torch", None)
for name, value in (("axis", "y"), ("feed", 1.0), ("output", 2), ("input", 2), ("start_delay", 3.0), ("end_delay", 3.0), ("compression", 9.0), ("lift", 60.0)):
    w(f"TorchControl.{name}", TORCHED, BURN_OFF, f"{K}.torch.{name}", value)
    w(f"TorchControl.{name}", TORCHED, BURN, f"{K}.torch.{name}", value)

# -- Din

D = "machine.controller.din"
MOVE = "G90 G71; M3 S1000; G00 X10 Y10; G01 X30 F300; G02 X40 Y20 I40 J10; M30"
KNOWN = MCUWIN.with_setup(g92=exactly(x=0.0, y=0.0, z=0.0, c=0.0), default_offset=0.0)
w("Controller.din", KNOWN, MOVE, D, None)
w("Controller.controls", WINCNC, "G0 X61", f"{K}.adjust_boundary", True)
for name, value in (
    ("version", "2.5.3.32"), ("case_sensitive", False), ("line_numbers", True), ("position_unit", 25.4), ("time_unit", 1.0),
    ("absolute_centers", False), ("interpolation_axes", "XY"), ("tools", ()), ("tasks", ()), ("arc_tolerance", 1e-12),
    ("program_size", 3), ("pre_include", "no-such.src"), ("post_include", "no-such.src"), ("unstated", ("shortest_path",)),
):  # fmt: skip
    w(f"Din.{name}", KNOWN, MOVE, f"{D}.{name}", value)
w("Din.version", KNOWN, "G90 G71; G54; G00 X10; M30", f"{D}.version", "2.5.3.32")
w("Din.version", KNOWN, "G90 G71; G151; G00 X10; G01 Y5 F100; M30", f"{D}.version", "2.5.3.32")
w("Din.case_sensitive", KNOWN, "g90 g71; g00 x10; m30", f"{D}.case_sensitive", False)
w("Din.interpolation_axes", KNOWN, "G90 G71; G01 Z50 F100; M30", f"{D}.interpolation_axes", "XY")
w("Din.zero_offsets", KNOWN, "G90 G71; G54; G00 X10; M30", f"{D}.zero_offsets", ((90.0, 0.0, 0.0, 0.0, 0.0, 0.0),))
w("Din.angle_unit", KNOWN, "G90 G71; CD600 := sin(1.0) * 100; G00 X(CD600); M30", f"{D}.angle_unit", "degrees")
w("Din.wait_unit", KNOWN, "G90 G71; G00 X10; $ wt(500)\x3b G00 X20; M30", f"{D}.wait_unit", 1.0)
w("Din.keeps_over_codes", KNOWN, "G90 G71; G00 X10; G04 P100; X20; M30", f"{D}.keeps_over_codes", True)
w("Din.keeps_over_codes", KNOWN, "G90 G71; G00 X10; G71; X20; M30", f"{D}.keeps_over_codes", True)
w("Din.unstated", KNOWN, "G90 G71; G00 C500; M30", f"{D}.unstated", ("shortest_path",))
TASKED = KNOWN.but(*m((f"{D}.tasks", (TaskCode(code="M210", action="spindle_cw", breaks=False, parameters=0), TaskCode(code="M30", action="end")))))
for name, value in (("code", "M211"), ("action", "unknown"), ("breaks", None), ("parameters", 2)):
    w(f"TaskCode.{name}", TASKED, "G90 G71; G60 X Y; G00 X10; G01 X20 F100; M210; G01 Y10; M30", f"{D}.tasks.0.{name}", value)
CORRECTED = KNOWN.but(*m((f"{D}.tools", (RadiusTool(plane="xy", number=1, radius=3.0, length=0.0),))))
for name, value in (("plane", "zx"), ("number", 2), ("radius", 150.0), ("length", 20.0)):
    w(f"RadiusTool.{name}", CORRECTED, "G90 G71; T1; G00 X10 Y10; G41 G01 X30 F100; Y50; X90; G40 X100; M30", f"{D}.tools.0.{name}", value)
