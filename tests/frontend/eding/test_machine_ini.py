"""The controller's cnc.ini: axes, units, areas, tools, what is not modelled, and mistakes at their lines."""

from __future__ import annotations

import hashlib
import math
import re
from fractions import Fraction
from pathlib import Path

import pytest

from gproof.driver.dialects import load_machine
from gproof.ir.dialects.eding.settings import eding_settings
from gproof.ir.finding import Findings
from gproof.ir.machine import AxisKind, Knife, Machine, PitchTable, Slave
from gproof.ir.text import parse_ir, print_ir

WHOLE = """\
;a mill
[GENERAL]
units = mm
maxStepFrequency = 90000

[userinterface]
autoToolChange = 1
homingMandatory = 1

[INTERPRETER]
diameterProgramming = 0
absoluteCenterCoords = 1

[TRAJECTORY]
lafMinimumAngle = 2.5
interpolationTime = 0.0050 ; seconds
fifoTime = 0.2500

[JOINT_0]
visible = 1
portID = 1
resolution = 320.5000
positiveLimit = 600.0
negativeLimit = -10.0
maxVelocity = 100.0
maxAcceleration = 500.0
homeVelocity = -20.0
homePosition = 0.0
backLash = 0.0200
pitchCompensationOn = 0
pitchCompensationFileName = "Joint-X-pitchCompTable.txt"

[JOINT_1]
visible = 1
portID = 2
stepsPerAppUnit = -320
[JOINT_2]
visible = 0
portID = 3
[JOINT_3]
visible = 0
portID = 4
mode = ROT
resolution = 44.4444
[JOINT_4]
visible = 0
portID = 0
[JOINT_5]
visible = 0
portID = -1

[TCA]
xNegativeLimit = 500.0
xPositiveLimit = 600.0
yNegativeLimit = 0.0
yPositiveLimit = 0.0
zNegativeLimit = -100
zPositiveLimit = 0
zDownToolLength = 0.0000

[SPINDLE_0]
spindleRampUpTime = 1.00
spindleNmax = 24000.00
[GPIO_NAMES]
gp_output_101_name = "Vacuum; valve" ; text
[TOOL_2]
zOffset = 61.4
xOffset = 0
diameter = 5
orientation = 0
"""


def loaded(folder: Path, text: str) -> tuple[Machine | None, list[tuple[str, int, str]]]:
    path = folder / "cnc.ini"
    path.write_bytes(text.encode("cp1252"))
    findings = Findings()
    machine, files = load_machine(path, findings)
    assert files[0] == (str(path), hashlib.sha256(path.read_bytes()).hexdigest())
    if machine is not None:
        assert parse_ir(print_ir(machine)) == machine
    return machine, [(f.code.label, f.span.line, f.message) for f in findings.kept]


def machine_of(folder: Path, text: str) -> Machine:
    machine, findings = loaded(folder, text)
    assert findings == []
    assert machine is not None
    return machine


def test_every_key(tmp_path: Path) -> None:
    machine = machine_of(tmp_path, WHOLE)
    assert [axis.name for axis in machine.axes] == ["x", "y", "z", "a"]
    x, y, z, a = machine.axes
    assert (x.steps_per_unit, x.lower, x.upper, x.max_velocity) == (Fraction(641, 2), -10.0, 600.0, 100.0)
    assert (x.max_acceleration, x.backlash, x.kind) == (500.0, 0.02, AxisKind.LINEAR)
    assert (y.steps_per_unit, y.lower) == (Fraction(-320), None)
    assert (z.steps_per_unit, a.kind, a.steps_per_unit) == (None, AxisKind.ROTARY, Fraction(111111, 2500))
    controller = machine.controller
    assert (controller.dialect, controller.laf_angle, controller.max_step_frequency) == ("eding", 2.5, 90000.0)
    assert (controller.auto_tool_change, controller.absolute_arc_centers) == (True, True)
    assert controller.spindle_ramp_time == 1.0
    assert machine.tool_change_area is not None
    assert machine.tool_change_area.box == ((500.0, 600.0), (-math.inf, math.inf), (-100.0, 0.0))
    (tool,) = machine.tools
    assert (tool.number, tool.length, tool.x_offset, tool.diameter, tool.orientation) == (2, 61.4, 0.0, 5.0, 0)
    assert machine.not_modelled == ()


def test_no_area_when_all_its_limits_are_zero(tmp_path: Path) -> None:
    text = "[JOINT_0]\nvisible=1\n[TCA]\nxNegativeLimit = 0.0\nxPositiveLimit = 0\n"
    assert machine_of(tmp_path, text).tool_change_area is None


def test_inches(tmp_path: Path) -> None:
    text = "[GENERAL]\nunits=inch\n[JOINT_0]\nvisible=1\nresolution=8128\npositiveLimit=10\n"
    text += "[JOINT_3]\nvisible=1\nresolution=10\n"
    machine = machine_of(tmp_path, text)
    assert (machine.axes[0].steps_per_unit, machine.axes[0].upper, machine.unit) == (320, 254.0, 25.4)
    assert machine.axes[1].steps_per_unit == 10


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("[JOINT_0]\nvisible=1\npitchCompensationOn=1\n",
         ("[JOINT_0] pitchCompensationFileName = nothing (there is no such file)",)),
        ("[JOINT_0]\nvisible=1\n[SPINDLE_0]\npwmCompensationOn=1\npwmCompensationFileName=\"pwm.txt\"\n",
         ("[SPINDLE_0] pwmCompensationFileName = pwm.txt (there is no such file)",)),
        ("[JOINT_0]\nvisible=1\npitchCompensationOn=1\npitchCompensationFileName=" + "n" * 300 + "\n",
         ("[JOINT_0] pitchCompensationFileName = " + "n" * 60 + " (there is no such file)",)),
        ("[JOINT_3]\nvisible=1\nmode = Foam Cut\n",
         ("[JOINT_3] mode = FOAM CUT (A is the other side of the wire, and the manual does not say how it moves with "
          "them)",)),
        ("[JOINT_3]\nvisible=1\nmode = 2nd  Z\n",
         ("[JOINT_3] mode = 2ND Z (A is a second Z, and the manual does not say what tool lengths do to it)",)),
        ("[JOINT_3]\nvisible=1\nmode = Tangential Knife\n",
         ("[JOINT_3] mode = TANGENTIAL KNIFE (only B and C can turn a knife)",)),
        ("[JOINT_3]\nvisible=1\nmode = 2\n", ("[JOINT_3] mode = 2 (not one of the modes of 2.1.3)",)),
        ("[JOINT_5]\nvisible=1\nmode = Tangential Knife\n", ()),
        ("[JOINT_3]\nvisible=1\nmode = 4th MILL\n", ()),
        ("[JOINT_0]\n[INTERPRETER]\ndiameterProgramming=1\nis3DPrinter=1\n",
         ("[INTERPRETER] is3DPrinter (A is the extruder, which words E move)",)),
        ("[JOINT_0]\n[KINEMATICS]\nkinematicsDLLName = delta.dll\n",
         ("[KINEMATICS] kinematicsDLLName = delta.dll (the manual does not describe it)",)),
        ("[JOINT_0]\n[KINEMATICS]\nkinType = 3\n",
         ("[KINEMATICS] kinType = 3 (virtual C (the manual gives only its name))",)),
        ("[JOINT_0]\n[KINEMATICS]\ntype = trivial\n", ()),
    ],
)  # fmt: skip
def test_what_is_on_and_not_modelled(tmp_path: Path, text: str, names: tuple[str, ...]) -> None:
    machine, _ = loaded(tmp_path, text)
    assert machine is not None
    assert tuple(setting.text for setting in machine.not_modelled) == names
    for setting in machine.not_modelled:
        assert setting.file == "cnc.ini"
        name = setting.what.partition("] ")[2].partition(" =")[0]
        assert text.splitlines()[setting.line - 1].lower().startswith(name.lower()) or setting.line == 0
    # only what A does is open of these: a job without A is judged
    alone = {s.what for s in machine.not_modelled if s.axis}
    assert alone == {s.what for s in machine.not_modelled if re.search("FOAM|2ND|KNIFE|3D", s.what)}


def test_a_slave_is_a_motor_of_its_master(tmp_path: Path) -> None:
    machine = machine_of(tmp_path, "[JOINT_0]\nvisible=1\n[JOINT_3]\nvisible=0\nportID=4\nmode = slave x\n")
    (x,) = machine.axes
    assert (x.name, x.slaves) == ("x", (Slave(joint="a"),))


GANTRY = """\
[JOINT_0]
visible = 1
resolution = 320
positiveLimit = 600
negativeLimit = 0
maxVelocity = 100
maxAcceleration = 500
backLash = 0.02
homePosition = -2.5
homeVelocity = -20
pitchCompensationOn = 1
pitchCompensationFileName = "C:\\CNC4.01\\x.txt"
[JOINT_3]
portID = 4
mode = SLAVE X
resolution = -160
positiveLimit = 598
negativeLimit = 1
maxVelocity = 80
maxAcceleration = 400
homePosition = -2.0
homeVelocity = -10
"""


def test_a_slave_has_a_motor_section_of_its_own_and_both_may_have_tables(tmp_path: Path) -> None:
    (tmp_path / "x.txt").write_text("; as measured\n  0.0 0.0\n\n100 100.02 ; end\n")
    (tmp_path / "cnc.ini").write_text(GANTRY)
    findings = Findings()
    machine, files = load_machine(tmp_path / "cnc.ini", findings)
    assert findings.kept == [] and machine is not None
    assert [Path(name).name for name, _ in files] == ["cnc.ini", "x.txt"]
    assert files[1][1] == hashlib.sha256((tmp_path / "x.txt").read_bytes()).hexdigest()
    (x,) = machine.axes
    own, second = x.drives()
    table = PitchTable(machine=(0.0, 100.0), calibrated=(0.0, 100.02))
    assert own == ("X", 320, 0.0, 600.0, None, None, 100.0, 500.0, 0.02, table)
    flat = PitchTable(machine=(0.0,), calibrated=(0.0,))
    assert second == ("X2", -160, 1.0, 598.0, None, None, 80.0, 400.0, 0.02, flat)
    assert (x.home_position, x.home_velocity) == (-2.5, -20.0)
    assert (x.slaves[0].joint, x.slaves[0].home_position, x.slaves[0].home_velocity) == ("a", -2.0, -10.0)


@pytest.mark.parametrize(
    ("table", "line", "what"),
    [
        ("0 0\n1 2 3\n", 2, "two numbers on each line"), ("0 0\n1 one\n", 2, "two numbers on each line"),
        ("; nothing\n", 0, "has no numbers"), ("0 0\n1 1\n1 2\n", 12, "machine positions must rise"),
        ("0 0\n1 1\n2 1\n", 12, "calibrated positions must rise"),
    ],
)  # fmt: skip
def test_mistakes_in_a_pitch_table(tmp_path: Path, table: str, line: int, what: str) -> None:
    (tmp_path / "x.txt").write_text(table)
    (tmp_path / "cnc.ini").write_text(GANTRY)
    findings = Findings()
    machine, _ = load_machine(tmp_path / "cnc.ini", findings)
    assert machine is None
    (finding,) = findings.kept
    assert (finding.span.line, what in finding.message) == (line, True), finding.message


def test_tables_of_a_machine_in_inches_are_inches(tmp_path: Path) -> None:
    (tmp_path / "x.txt").write_text("0 0\n10 10.001\n")
    machine = machine_of(tmp_path, "[GENERAL]\nunits = inch\n" + GANTRY)
    table = machine.axes[0].pitch
    assert table is not None
    assert (table.machine, table.calibrated) == ((0.0, 254.0), (0.0, 254.0254))


def test_the_other_setup_pages(tmp_path: Path) -> None:
    text = """\
[JOINT_0]
visible = 1
[JOINT_5]
visible = 1
mode = Tangential Knife
[TANKNIFE]
tanKnifeAngle = 20
tanKnifeZUpDistance = 4.5
tanKnifeBlendAngle = 6
tanKnifeBlendDistance = 0.5
[USERINTERFACE]
homingMandatory = 1
isTurningMachine = 1
invertJogKeys = 1
[SAFETY]
homeSensorIsEStop = 1
homeInputSenseLevel = 1
safetyFeed = 25
[INTERPRETER]
macroFileName = "D:\\mill\\mine.cnc"
[TCA]
zDownToolLength = 35.5
[GPIO_NAMES]
gp_output_101_name = "Vacuum; valve"
[PROBING]
storeProbePoints = 1
"""
    machine = machine_of(tmp_path, text)
    controller = machine.controller
    assert machine.knife == Knife(axis="c", angle=20.0, lift=4.5, blend_angle=6.0, blend_distance=0.5)
    assert (controller.homing_mandatory, controller.home_is_stop, controller.safety_feed) == (True, True, 25.0)
    assert (eding_settings(machine).macro_file, controller.turning, machine.z_down_tool_length) == (
        "mine.cnc",
        True,
        35.5,
    )
    assert machine.kept == (
        ("[USERINTERFACE] invertJogKeys", "1"),
        ("[SAFETY] homeSensorIsEStop", "1"),
        ("[SAFETY] homeInputSenseLevel", "1"),
        ("[SAFETY] safetyFeed", "25"),
        ("[GPIO_NAMES] gp_output_101_name", "Vacuum; valve"),
        ("[PROBING] storeProbePoints", "1"),
    )
    assert machine.not_modelled == machine.unknown_keys == ()


def test_names_of_other_releases_and_other_sections(tmp_path: Path) -> None:
    text = "[JOINT_0]\nisVisible=0\ncpuPortIndex=0\n[JOINT_1]\ncpuPortIndex=-1\nisVisible=0\n"
    text += "[SAFETY]\nmandatoryHoming=1\n[INTERPRETER]\ninchModeActive=1\nnoHaltForToolChange=1\n"
    text += "tanKnifeAngleForLiftUp=3\n[TRAJECTORY]\nlafAngle=2\n"
    machine = machine_of(tmp_path, text)
    assert [axis.name for axis in machine.axes] == ["x"]
    assert (machine.unit, machine.controller.laf_angle, machine.controller.auto_tool_change) == (25.4, 2.0, True)
    assert (machine.controller.homing_mandatory, machine.knife) == (True, None)


def test_two_places_that_disagree(tmp_path: Path) -> None:
    text = "[JOINT_0]\nvisible=1\n[SAFETY]\nmandatoryHoming=1\n[USERINTERFACE]\nhomingMandatory=0\n"
    machine, findings = loaded(tmp_path, text)
    assert machine is None
    assert [(label, line) for label, line, _ in findings] == [("GP603", 4)]


def test_a_slave_without_a_master(tmp_path: Path) -> None:
    machine, findings = loaded(tmp_path, "[JOINT_0]\nvisible=1\n[JOINT_3]\nportID=4\nmode = SLAVE Z\n")
    assert machine is None
    assert [(label, line, "no axis Z" in text) for label, line, text in findings] == [("GP603", 5, True)]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", [("GP604", 0, "JOINT_0")]),
        ("[JOINT_0]\nvisible=1\nresolution = abc\n", [("GP603", 3, "[JOINT_0] resolution: 'abc' is not a number")]),
        ("[JOINT_0]\nvisible=1\nresolution = 0.0\n", [("GP603", 3, "no steps per unit")]),
        ("[JOINT_0]\nvisible=1\nresolution = 1600/5\n", [("GP603", 3, "is not a number")]),
        ("[JOINT_0]\nvisible=1\nnegativeLimit=2\npositiveLimit=1\n", [("GP603", 3, "is above positiveLimit")]),
        ("[JOINT_0]\nvisible=1\nmaxVelocity=0\n", [("GP603", 3, "0 is not greater than 0")]),
        ("[JOINT_0]\nvisible=1\nbackLash=-1\n", [("GP603", 3, "-1 is below 0")]),
        ("[JOINT_0]\nvisible=yes\n", [("GP603", 2, "'yes' is not a number")]),
        ("[JOINT_0]\nvisible=1\nvisible=0\n", [("GP603", 3, "than in line 2")]),
        ("[JOINT_0]\nvisible=1\nvisible=1\n", []),
        ("[JOINT_0]\nnonsense\n", [("GP601", 2, "neither")]),
        ("[JOINT_0\n", [("GP601", 1, "neither")]),
        ("[GENERAL]\nunits = cm\n[JOINT_0]\n", [("GP603", 2, "'cm' is not one of mm, inch")]),
        ("[JOINT_0]\n[TCA]\nxNegativeLimit=3\nxPositiveLimit=2\n", [("GP603", 3, "wrong order")]),
        ("[JOINT_0]\n[TOOL_1]\ndiameter=1\n[TOOL_01]\ndiameter=2\n", [("GP603", 5, "tool 1 is given twice")]),
        ("[JOINT_0]\n[TOOL_1]\norientation=12\n", [("GP603", 3, "orientations")]),
        ("[JOINT_0]\nspeed = 3\nsped = 4\n", [("GP602", 2, "'[JOINT_0] speed'"), ("GP602", 3, "'[JOINT_0] sped'")]),
        ("[JOINT_0]\n[UNHEARD]\na=1\nb=2\n", [("GP602", 3, "'[UNHEARD]'")]),
        ("[JOINT_0]\n[CAMERA]\na=1\n", []),
    ],
)
def test_mistakes_have_their_line(tmp_path: Path, text: str, expected: list[tuple[str, int, str]]) -> None:
    machine, findings = loaded(tmp_path, text)
    assert [f[:2] for f in findings] == [e[:2] for e in expected]
    for (_, _, message), (_, _, wanted) in zip(findings, expected, strict=True):
        assert wanted in message
    assert (machine is None) == any(code != "GP602" for code, _, _ in findings)


def test_files_that_can_not_be_read(tmp_path: Path) -> None:
    (tmp_path / "binary.ini").write_bytes(b"\x00\x01")
    findings = Findings()
    for name in ("binary.ini", "none.ini"):
        assert load_machine(tmp_path / name, findings)[0] is None
    assert [f.code.label for f in findings.kept] == ["GP601", "GP601"]


def test_the_voltage_table_of_a_spindle(tmp_path: Path) -> None:
    text = "[JOINT_0]\nvisible=1\n[SPINDLE_0]\npwmCompensationOn=1\npwmCompensationFileName=pwm.txt\n"
    (tmp_path / "pwm.txt").write_text("; speed, percent\n0 0\n720 8.0\n24000 100\n")
    (spindle,) = machine_of(tmp_path, text).spindles
    assert spindle.pwm == ((0.0, 0.0), (720.0, 8.0), (24000.0, 100.0))
    (tmp_path / "pwm.txt").write_text("0 0\n0 8.0\n")
    assert [(label, line) for label, line, _ in loaded(tmp_path, text)[1]] == [("GP603", 5)]
