"""Witnesses of the settings of McuWIN machines."""

from __future__ import annotations

from reach.witness import Witnesses, m
from reach.worlds import MCUWIN, exactly

from gproof.ir.dialects.mcuwin.settings import RadiusTool, TaskCode
from gproof.ir.settings import Settings
from gproof.ir.setup import Interval

w = Witnesses()
# -- McuWinSettings

D = "machine.settings"
MOVE = "G90 G71; M3 S1000; G00 X10 Y10; G01 X30 F300; G02 X40 Y20 I40 J10; M30"
KNOWN = MCUWIN.with_setup(g92=exactly(x=0.0, y=0.0, z=0.0, c=0.0), default_offset=0.0)
w("Machine.settings", KNOWN, MOVE, D, Settings())
w("McuWinSettings.foreign", KNOWN, MOVE, f"{D}.foreign", ("controls",))
for name, value in (
    ("version", "2.5.3.32"), ("case_sensitive", False), ("line_numbers", True), ("position_unit", 25.4),
    ("time_unit", 1.0),
    ("absolute_centers", False), ("interpolation_axes", "XY"), ("tools", ()), ("tasks", ()), ("arc_tolerance", 1e-12),
    ("program_size", 3), ("pre_include", "no-such.src"), ("post_include", "no-such.src"),
    ("unstated", ("shortest_path",)),
):  # fmt: skip
    of = "Settings" if name == "position_unit" else "McuWinSettings"
    w(f"{of}.{name}", KNOWN, MOVE, f"{D}.{name}", value)
w("McuWinSettings.version", KNOWN, "G90 G71; G54; G00 X10; M30", f"{D}.version", "2.5.3.32")
w("McuWinSettings.version", KNOWN, "G90 G71; G151; G00 X10; G01 Y5 F100; M30", f"{D}.version", "2.5.3.32")
w("McuWinSettings.case_sensitive", KNOWN, "g90 g71; g00 x10; m30", f"{D}.case_sensitive", False)
w("McuWinSettings.interpolation_axes", KNOWN, "G90 G71; G01 Z50 F100; M30", f"{D}.interpolation_axes", "XY")
w("Settings.zero_offsets", KNOWN, "G90 G71; G54; G00 X10; M30", f"{D}.zero_offsets", ((90.0, 0.0, 0.0, 0.0, 0.0, 0.0),))
w(
    "McuWinSettings.angle_unit",
    KNOWN,
    "G90 G71; CD600 := sin(1.0) * 100; G00 X(CD600); M30",
    f"{D}.angle_unit",
    "degrees",
)
w("McuWinSettings.wait_unit", KNOWN, "G90 G71; G00 X10; $ wt(500)\x3b G00 X20; M30", f"{D}.wait_unit", 1.0)
w("McuWinSettings.keeps_over_codes", KNOWN, "G90 G71; G00 X10; G04 P100; X20; M30", f"{D}.keeps_over_codes", True)
w("McuWinSettings.keeps_over_codes", KNOWN, "G90 G71; G00 X10; G71; X20; M30", f"{D}.keeps_over_codes", True)
w("McuWinSettings.g60", KNOWN, "G90 G71; G60 X Y; G00 X10; G60 X Y Z; G01 Z5 F100; M30", f"{D}.g60", "run")
w("McuWinSettings.channels", KNOWN, "G90 G71; M26 502; G00 X10; M30", f"{D}.channels", 5)
w("Setup.resident", KNOWN, "G90 G71; M904 605; G00 X(CD605); M30", "setup.resident", {605: Interval(5.0, 5.0)})
w("McuWinSettings.unstated", KNOWN, "G90 G71; G00 C500; M30", f"{D}.unstated", ("shortest_path",))
TASKED = KNOWN.but(
    *m(
        (
            f"{D}.tasks",
            (
                TaskCode(code="M210", action="spindle_cw", breaks=False, parameters=0),
                TaskCode(code="M30", action="end"),
            ),
        )
    )
)
for name, value in (("code", "M211"), ("action", "unknown"), ("breaks", None), ("parameters", 2)):
    w(
        f"TaskCode.{name}",
        TASKED,
        "G90 G71; G60 X Y; G00 X10; G01 X20 F100; M210; G01 Y10; M30",
        f"{D}.tasks.0.{name}",
        value,
    )
CORRECTED = KNOWN.but(*m((f"{D}.tools", (RadiusTool(plane="xy", number=1, radius=3.0, length=0.0),))))
for name, value in (("plane", "zx"), ("number", 2), ("radius", 150.0), ("length", 20.0)):
    w(
        f"RadiusTool.{name}",
        CORRECTED,
        "G90 G71; T1; G00 X10 Y10; G41 G01 X30 F100; Y50; X90; G40 X100; M30",
        f"{D}.tools.0.{name}",
        value,
    )

ROUND = "G90 G71; G60 X Y; G00 X10 Y10; G01 X20 F100; M210; G01 Y10; G01 X30; M30"
w("TaskCode.breaks", TASKED, "G90 G71; G01 X20 F100; M210; X30; M30", f"{D}.tasks.0.breaks", True)
w("TaskCode.parameters", TASKED, "G90 G71; G01 X20 F100; M210 5; X30; M30", f"{D}.tasks.0.parameters", 1)
w("McuWinSettings.version", KNOWN, "G90 G71; G00 X10; $if 1 = 1 then; G00 X20; $endif; M30", f"{D}.version", "2.5.3.32")
UNITLESS = KNOWN.but(*m(("machine.axes.0.position_unit", None)))
w("Settings.position_unit", UNITLESS, "G90; G01 X10 F300; M30", f"{D}.position_unit", 25.4)
w("Settings.position_unit", KNOWN, "G90; G01 X10 F300; M30", f"{D}.position_unit", 25.4)
TURNED = "G90 G71; T1; G00 X10 Y10; G41 G01 X30 F100; Y50; X90; G40 X100; M30"
WIDE = (RadiusTool(plane="xy", number=1, radius=6.0, length=0.0),)
w("McuWinSettings.tools", CORRECTED, TURNED, f"{D}.tools", WIDE)
w("McuWinSettings.unstated", KNOWN, TURNED, f"{D}.unstated", ("tool_file",))
w(
    "McuWinSettings.tasks",
    KNOWN,
    "G90 G71; G00 X10; M3 S100; G00 X20; M30",
    f"{D}.tasks",
    (TaskCode(code="M3", action="nothing"),),
)
w("McuWinSettings.version", KNOWN, "G90 G71; G60 X Y; G01 X10 F100; G60 X Y Z; G01 Z5; M30", f"{D}.version", "2.5.3.32")
w("TaskCode.breaks", TASKED, "G90 G71; G01 X20 F100; M210; G01 X30; M30", f"{D}.tasks.0.breaks", True)
