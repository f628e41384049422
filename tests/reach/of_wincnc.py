"""Witnesses of the settings of WinCNC machines."""

from __future__ import annotations

from reach.witness import Witnesses, m
from reach.worlds import WINCNC, World, exactly

from gproof.ir.machine import Area, AxisKind, Tool
from gproof.ir.settings import KnifeMode, SawMode, TorchControl, Workspace
from gproof.ir.workpiece import Box, Placed, Workpiece

w = Witnesses()
# -- Settings, WinCncSettings

K = "machine.settings"
PLASMA = World("wincnc", "wincnc/plasma/WINCNC.INI", WINCNC.setup)
w("Machine.settings", WINCNC, "G0 X61", f"{K}.adjust_boundary", True)
FEED = "M11C1; G1 X1 Y1 F60; G1 X2; M12C1"
w("Lexical.comment_signs", WINCNC, "G0 X1 ; G0 X2".replace(";", "!"), f"{K}.lexical.comment_signs", "!")
w("Lexical.skips", WINCNC, "/G0 X900; G0 X1", f"{K}.lexical.skips", (("/", 1),))
w("Lexical.continued", WINCNC, "[N5] G0 X1", f"{K}.lexical.continued", True)
w("Lexical.numbered", WINCNC, "N5 G0 X1", f"{K}.lexical.numbered", True)
w("Lexical.comma", WINCNC, "G0 X1,5", f"{K}.lexical.comma", True)
w("WinCncSettings.start", WINCNC, "G0 X1", f"{K}.start", "G0 X2")
w("WinCncSettings.end", WINCNC, "G0 X1", f"{K}.end", "G0 X2")
w("WinCncSettings.abort", WINCNC, "G5 T1; G0 X1", f"{K}.abort", "G0 X2")
w("Settings.unit_stated", WINCNC, "G0 X1", f"{K}.unit_stated", False)
w("Settings.coolant", WINCNC, FEED, f"{K}.coolant", (1,))
w("Settings.absolute", WINCNC, "G0 X1; X1", f"{K}.absolute", None)
ARC = "M11C1; G0 X1 Y1; G2 X2 Y2 I1 J0.0001 F60; M12C1"
w("Settings.arc_tolerance", WINCNC, ARC, f"{K}.arc_tolerance", 1e-9)
w("Settings.smallest_arc", WINCNC, ARC, f"{K}.smallest_arc", 100.0)
w("WinCncSettings.arcs_modal", WINCNC, ARC.replace("; M12C1", "; X3 Y1 I0 J-1"), f"{K}.arcs_modal", True)
w("WinCncSettings.feed_groups", WINCNC, "M11C1; G1 X1 Z0 F60; G1 Z-.01", f"{K}.feed_groups", ("xyz",))
w("WinCncSettings.feed_groups", WINCNC, "M11C1; G1 Z0 F30; G1 Z-.01; G1 X1; G1 X2 Z0", f"{K}.feed_groups", ())
w("WinCncSettings.feed_groups", WINCNC, "M11C1; G1 X1 F60; G1 X2; G1 Z-.01", f"{K}.feed_groups", ("xyz",))
w("WinCncSettings.command_group", WINCNC, "M11C1; F60; G1 X1", f"{K}.command_group", "z")
w("WinCncSettings.soft_limits", WINCNC, "G0 X90", f"{K}.soft_limits", False)
w("WinCncSettings.limits_available", WINCNC, "L22; G0 X90", f"{K}.limits_available", False)
w("WinCncSettings.limits_available", WINCNC, "L20; G0 X90", f"{K}.limits_available", False)
w("WinCncSettings.adjust_boundary", WINCNC, "G0 X61", f"{K}.adjust_boundary", True)
w("WinCncSettings.adjust_vertical", WINCNC, "G0 Z-2", f"{K}.adjust_vertical", True)
w("Settings.forced", WINCNC, "G0 X-.2", f"{K}.forced", ((0.0, None), (None, None)))
w(
    "WinCncSettings.shift_sign",
    WINCNC.but(*m((f"{K}.workspaces", (Workspace(number=55, x=100.0, moves=False),)))),
    "G55; G0 X1",
    f"{K}.shift_sign",
    1,
)
w("WinCncSettings.helical_arcs", WINCNC, ARC.replace("F60", "Z-.01 F60"), f"{K}.helical_arcs", False)
w("Settings.arcs_share_feed", WINCNC, ARC.replace("M12C1", "G1 X3"), f"{K}.arcs_share_feed", False)
w("WinCncSettings.inputs", WINCNC, "M17 C6; G0 X1", f"{K}.inputs", (1,))
w("WinCncSettings.outputs", WINCNC, "M11 C5; G0 X1", f"{K}.outputs", (1,))
w("WinCncSettings.unsteady_outputs", WINCNC, "M11 C5; M17.2 C5; G0 X90", f"{K}.unsteady_outputs", (5,))
w("WinCncSettings.drill_banks", WINCNC, "M11 D1; M17.2 C5; G0 X90", f"{K}.drill_banks", ((5, 2),))
w("Settings.devices", PLASMA, "L38; G0 X1; L39", f"{K}.devices", ())
w("WinCncSettings.positions", WINCNC, "L500 P4; G0 X1; G53 P4", f"{K}.positions", 2)
w("WinCncSettings.homes", WINCNC, "L500 H4; G0 X1; G53 H4", f"{K}.homes", 2)
w("WinCncSettings.tool_positions", WINCNC, "L500 T4; G0 X1; G53 T4", f"{K}.tool_positions", 2)
w("Settings.nesting", WINCNC, "M98 PARK.MAC; G0 X1", f"{K}.nesting", 0)
w(
    "WinCncSettings.around_files",
    WINCNC.but(*m((f"{K}.start", "G91"))),
    "G90; M98 PARK.MAC; G0 X1",
    f"{K}.around_files",
    True,
)
w("WinCncSettings.array_order", WINCNC, "L10 X2 R2 Y3 C2; G0 X1; G1 Z-.01 F20; G0 Z0", f"{K}.array_order", "rows")
w("WinCncSettings.highest_channel", WINCNC, "M11 C5; G0 X1", f"{K}.highest_channel", 3)
w("WinCncSettings.highest_channel", WINCNC.but(*m((f"{K}.outputs", None))), "M11 C5; G0 X1", f"{K}.highest_channel", 3)
w("WinCncSettings.rotation_sign", WINCNC, "G52 A30; G0 X2 Y5", f"{K}.rotation_sign", -1)
w("WinCncSettings.virtual_on", WINCNC, "L61 C3; M17.3 C3; G0 X90; G0 X1", f"{K}.virtual_on", 60)
w("Settings.workspaces", WINCNC, "G55; G0 X1", f"{K}.workspaces", (Workspace(number=55, x=100.0, moves=False),))
SHIFTED = WINCNC.but(
    *m((f"{K}.workspaces", (Workspace(number=55, x=100.0, y=10.0, moves=False),)), (f"{K}.shift_sign", 1))
)
for name, value in (("number", 56), ("x", 300.0), ("y", 30.0), ("kind", 3), ("moves", True)):
    w(f"Workspace.{name}", SHIFTED, "G55; G0 X1 Y1", f"{K}.workspaces.0.{name}", value)
SPUN_ABOUT = SHIFTED.but(*m((f"{K}.workspaces.0.kind", 3), (f"{K}.workspaces.0.radius", 5.0)))
w("Workspace.radius", SPUN_ABOUT, "G55; G0 X1 Y1", f"{K}.workspaces.0.radius", 500.0)
w("Workspace.offset", SPUN_ABOUT, "G55; G0 X1 Y1", f"{K}.workspaces.0.offset", 50.0)
w("WinCncSettings.changers", WINCNC, "L101 T2; G43; G0 X1 Z0", f"{K}.changers", ())
for name, value in (
    ("number", 2),
    ("height", 30.0),
    ("sensor", 3.0),
    ("spindle_height", 5.0),
    ("axis", "y"),
    ("in_library", True),
):
    w(f"Changer.{name}", WINCNC, "L101 T2; G43; G0 X1 Z0", f"{K}.changers.0.{name}", value)
    w(f"Changer.{name}", WINCNC, "M37 Z1 T2; G43; G0 X1 Z0", f"{K}.changers.0.{name}", value)
for name, value in (("x", 10.0), ("y", 10.0), ("i", 10.0), ("j", 10.0), ("descent", -5.0), ("feed", 1.0)):
    w(
        f"MeasureSwitch.{name}",
        WINCNC,
        "G53 X{TMX} Y{TMY}; L91 G1 Z-1 F{TMF}; L91 G0 Z{TMD}; G0 X1",
        f"{K}.measure.{name}",
        value,
    )
    w(f"MeasureSwitch.{name}", WINCNC, "G53 X{TMI} Y{TMJ}; L91 G0 Z{TMD}; G0 X1", f"{K}.measure.{name}", value)
w("WinCncSettings.measure", WINCNC, "G53 X{TMX} Y{TMY}; L91 G1 Z-1 F{TMF}; L91 G0 Z{TMD}; G0 X1", f"{K}.measure", None)
DRILL = "M11C1; G0 X1 Z.2; G83 X1 Z-.01 R.1 Q.01 F20; G80; M12C1"
w("WinCncSettings.drill", WINCNC, DRILL.replace("G83", "G81"), f"{K}.drill.dwell", 5.0)
for name, value in (("dwell", 5.0), ("other_dwell", 5.0), ("approach", 2.0), ("lift", 2.0)):
    for cycle in ("G81", "G82", "G83", "G73"):
        w(f"DrillSettings.{name}", WINCNC, DRILL.replace("G83", cycle), f"{K}.drill.{name}", value)
AUTO = WINCNC.but(*m((f"{K}.auto_output", 4), (f"{K}.auto_output_on", True), (f"{K}.auto_dwell", (0.1, 0.1))))
w("Settings.auto_output", AUTO, FEED, f"{K}.auto_output", 5)
w("WinCncSettings.auto_output_on", AUTO, FEED, f"{K}.auto_output_on", False)
w("WinCncSettings.auto_dwell", AUTO, FEED, f"{K}.auto_dwell", (1.0, 2.0))
w("WinCncSettings.auto_pausing", AUTO, FEED, f"{K}.auto_pausing", False)
w("WinCncSettings.axis_order", WINCNC, "L300 X; G0 X1 Y1", f"{K}.axis_order", "yxz")
w(
    "Settings.smoothing",
    WINCNC.with_setup(keep_out=(Area(name="post", box=((30.0, 40.0), (0.0, 9.0), (-150.0, 9.0))),)),
    "M11C1; G1 Y1 F60; X3; Y0",
    f"{K}.smoothing",
    False,
)
HOMER = WINCNC.but(*m(("machine.tools", (Tool(number=1, diameter=6.0),)))).with_setup(
    tool=1, keep_out=(Area(name="post", box=((30.0, 40.0), (-50.0, 9.0), (-150.0, -9.0))),)
)
w("Settings.homing", HOMER, "G28; G0 X1", f"{K}.homing", ())
for name, value in (
    ("distances", (("y", 5.0),)),
    ("retreat", 20.0),
    ("feed", 1.0),
    ("second_feed", 1.0),
    ("longest", 5.0),
    ("alternate", True),
    ("singly", True),
):
    w(f"HomingLine.{name}", HOMER, "G28; G0 X1", f"{K}.homing.0.{name}", value)
w("WinCncSettings.probe_input", WINCNC, "L91 G1 Z-5 F10 M28 G31; G0 X1", f"{K}.probe_input", 3)
w("WinCncSettings.probe_axis", WINCNC, "L82 Z0; G0 X1", f"{K}.probe_axis", "x")
w("WinCncSettings.compensation_entry", WINCNC, "M11C1; G41 O0; G1 X1 F60; G1 Y1; G40", f"{K}.compensation_entry", True)
w(
    "WinCncSettings.compensation_swapped",
    WINCNC,
    "M11C1; G41 O0; G1 X1 F60; G1 Y1; G40",
    f"{K}.compensation_swapped",
    True,
)
w("WinCncSettings.override", WINCNC, "L40 P20; " + FEED, f"{K}.override", (50.0, 60.0))
w("WinCncSettings.override_enabled", WINCNC, "L40 P50; " + FEED, f"{K}.override_enabled", False)
w("WinCncSettings.rapids_unlocked", WINCNC, "L40 P50; " + FEED, f"{K}.rapids_unlocked", True)
w("WinCncSettings.places", WINCNC, FEED, f"{K}.places", ())
NC = World("wincnc", "wincnc/knife-twohead/WINCNC.INI", WINCNC.setup).with_setup(
    homed=("x", "y", "z", "w", "c"), start=exactly(x=0.0, y=0.0, z=0.0, a=0.0, c=0.0, b=0.0), measures=exactly(z=0.0),
    work={}, default_start=0.0,
)  # fmt: skip
KNIFE = "G90; L30; G0 X10 Y10; G0 Z0; G92 X0 Y0 Z0; G1 X20 F600; G1 Y20; G1 X25 Y26; G2 X35 Y26 I5 J0; L31; G0 X0"
w("Axis.kind", NC, "G90; G20; G0 C3", "machine.axes.4.kind", AxisKind.LINEAR)
w("Settings.knife", NC, KNIFE, f"{K}.knife", None)
for name, value in (
    ("axis", "z"), ("target", True), ("angle", 170.0), ("blend", 1.0), ("lifted", 1.0), ("lowered", -1.0),
    ("vertical", ""),
    ("output", 4), ("dwell", 2.0), ("automatic", True), ("lifts_in_arcs", False), ("blade", 10.0), ("both_ways", True),
    ("x", 3.0), ("y", 3.0),
):  # fmt: skip
    w(f"KnifeMode.{name}", NC, KNIFE, f"{K}.knife.{name}", value)
w("WinCncSettings.knife_positions", NC, KNIFE, f"{K}.knife_positions", "work")
LIFTING = KnifeMode(axis="c", angle=30.0, lifted=1.0, lowered=-0.1, vertical="z")
LIFTED = NC.but(*m((f"{K}.knife", LIFTING)))
CORNERS = "G90; G0 Z1; L30; G0 X10 Y10; G1 X20 F600; G1 Y20; G1 X25 Y26; G2 X35 Y26 I5 J0; L31; G0 X0"
for name, value in (
    ("blend", 3.0), ("lifted", 0.5), ("lowered", -0.05), ("vertical", ""), ("output", 2), ("automatic", True),
    ("lifts_in_arcs", False),
):  # fmt: skip
    w(f"KnifeMode.{name}", LIFTED, CORNERS, f"{K}.knife.{name}", value)
    w(f"KnifeMode.{name}", LIFTED.but(*m((f"{K}.knife.angle", 3.0))), CORNERS, f"{K}.knife.{name}", value)
BY_OUTPUT = NC.but(*m((f"{K}.knife", KnifeMode(axis="c", angle=30.0, vertical="", output=2))))
w("KnifeMode.output", BY_OUTPUT, CORNERS, f"{K}.knife.output", 4)
w("WinCncSettings.knife_positions", LIFTED, CORNERS, f"{K}.knife_positions", "work")
KNIFED = LIFTED.with_setup(
    homed=("x", "y", "z", "a", "b", "c"), start=exactly(x=0.0, y=0.0, z=0.0, a=0.0, b=0.0, c=0.0),
    g92=exactly(x=0.0, y=0.0, z=0.0, a=0.0, b=0.0, c=0.0), default_offset=0.0, default_parameter=0.0,
)  # fmt: skip
CORNER = "G90; G1 Z-.1 F60; L30; G1 X20 F600; G1 X21 Y1; L31; G0 X0"
for name, value in (("blend", 3.0), ("output", 3)):
    w(f"KnifeMode.{name}", KNIFED, CORNER, f"{K}.knife.{name}", value)
w("WinCncSettings.knife_positions", KNIFED, CORNER.replace("L30", "G92 Z0; L30"), f"{K}.knife_positions", "work")
SAWN = NC.but(*m((f"{K}.saw", SawMode(axis="c", radius=100.0)), (f"{K}.devices", ("saw",))))
w("Settings.saw", SAWN, "L32; G0 X1", f"{K}.saw", None)

for name, value in (("axis", "z"), ("radius", 5.0), ("offset", 90.0), ("lift", 30.0)):
    w(f"SawMode.{name}", SAWN, "L32; G0 X10; G1 X20 F600; G1 Y20; L33; G0 X0", f"{K}.saw.{name}", value)

TORCH = TorchControl(axis="z", feed=10.0, output=1, input=3, start_delay=0.5, end_delay=0.5, compression=2.0, lift=5.0)
TORCHED = PLASMA.but(*m((f"{K}.torch", TORCH), (f"{K}.devices", ("thc",))))
BURN = "L36; L38; G1 X10 F600; L39; L37; G0 X0; G0 Z-10"
BURN_OFF = "L37; L38; G1 X10 F600; L39; G0 X0; G91; G0 Z-1"
w("Settings.torch", TORCHED, BURN_OFF, f"{K}.torch", None)
for name, value in (
    ("axis", "y"),
    ("feed", 1.0),
    ("output", 2),
    ("input", 2),
    ("start_delay", 3.0),
    ("end_delay", 3.0),
    ("compression", 9.0),
    ("lift", 60.0),
):
    w(f"TorchControl.{name}", TORCHED, BURN_OFF, f"{K}.torch.{name}", value)
    w(f"TorchControl.{name}", TORCHED, BURN, f"{K}.torch.{name}", value)

WET = "G90; L101 T1; M11C1; M11C5; G0 Z0; G1 Z-.01 F20; G1 X2; G0 Z0; M12C5; L101 T2; G1 Z-.01; G1 X4; G0 Z0; M12C1"
w("Settings.coolant", WINCNC, WET, f"{K}.coolant", (5,))
w("WinCncSettings.feed_groups", WINCNC, "M11C1; G1 X1 F30; G1 Z-.01", f"{K}.feed_groups", ("xyz",))
w("Settings.backlash", WINCNC, "L8; G0 X61.9", f"{K}.backlash", (("x", 12.7),))
BLOCK = Placed(name="block", body=Box(low=(30.0, -50.0, -150.0), high=(40.0, 9.0, -9.0)), work=0)
SHAPED = m(
    ("machine.tools.0.shape", "flat"), ("machine.tools.0.flute_length", 20.0), ("machine.tools.0.stickout", 20.0)
)
for name in ("part", "fixtures"):
    held = HOMER.but(*SHAPED).with_setup(workpiece=Workpiece(**{name: (BLOCK,)}))
    w("Settings.homing", held, "G28; G0 X1", f"{K}.homing", ())
