"""Machine files in TOML: values, units, refinement of a controller's file, and every mistake with its line."""

from __future__ import annotations

import hashlib
import math
import random
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.campaigns import examples

from gproof.driver.dialects import load_machine
from gproof.frontend.common.exact_numbers import exact_ratio
from gproof.ir.dialects.eding.settings import EdingSettings, eding_settings
from gproof.ir.dialects.mcuwin.settings import McuWinSettings
from gproof.ir.dialects.wincnc.settings import WinCncSettings
from gproof.ir.finding import Findings
from gproof.ir.machine import AxisKind, Board, Controller, Knife, Machine, PitchTable, Slave
from gproof.ir.settings import Settings
from gproof.ir.text import parse_ir, print_ir

HEAD = 'schema = "gproof-machine/1"\nunits = "mm"\n'
WHOLE = """\
schema = "gproof-machine/1"
name = "Mill"
units = "mm"

[axes.x]
kind = "linear"
steps_per_unit = "1600/5"
min = -10.5
max = 600
travel_min = -12
travel_max = 602.25
max_velocity = 100.0
max_acceleration = 500
backlash = 0.02
slaves = 1

[axes.a]
kind = "rotary"
steps_per_unit = 44.4444

[areas.tool_change]
x = [550, 600]
z = [-150.0, 0.0]

[areas.clamp]
y = [0, 20]

[tools.2]
length = 61.4
diameter = 5
x_offset = -1.5
orientation = 3

[tools.1]
length = 12.5

[controller]
dialect = "eding"
laf_angle = 3.0
interpolation_time = 0.005
fifo_time = 0.5
auto_tool_change = true
absolute_arc_centers = true
diameter_programming = true
max_step_frequency = 125000
spindle_ramp_time = 1.5

[board]
name = "bench"
tick_frequency = 20_000_000
step_pulse = 1e-6
direction_setup = 4e-6
"""


def machine_of(folder: Path, text: str) -> Machine:
    """A machine file that must have no finding."""
    path = folder / "machine.toml"
    path.write_text(text)
    findings = Findings()
    machine, files = load_machine(path, findings)
    assert [f.message for f in findings.kept] == []
    assert machine is not None
    assert files == [(str(path), hashlib.sha256(path.read_bytes()).hexdigest())]
    assert parse_ir(print_ir(machine)) == machine
    return machine


def found(folder: Path, text: str | bytes, name: str = "machine.toml") -> list[tuple[str, int, str]]:
    """(code, line, message) of each finding of a machine file."""
    path = folder / name
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    findings = Findings()
    machine, _ = load_machine(path, findings)
    errors = [f for f in findings.kept if f.code.label != "GP602"]
    assert (machine is None) == bool(errors)
    assert all(f.span.file == str(path) for f in findings.kept)
    return [(f.code.label, f.span.line, f.message) for f in findings.kept]


def test_every_key(tmp_path: Path) -> None:
    machine = machine_of(tmp_path, WHOLE)
    x, a = machine.axes
    assert (x.name, x.kind, x.steps_per_unit, x.lower, x.upper) == ("x", AxisKind.LINEAR, Fraction(320), -10.5, 600.0)
    assert (x.travel_lower, x.travel_upper, x.max_velocity, x.max_acceleration) == (-12.0, 602.25, 100.0, 500.0)
    assert (x.backlash, x.slaves) == (0.02, (Slave(),))
    assert (a.kind, a.steps_per_unit, a.lower) == (AxisKind.ROTARY, Fraction(444444, 10000), None)
    area = machine.tool_change_area
    assert area is not None
    assert area.box == ((550.0, 600.0), (-math.inf, math.inf), (-150.0, 0.0))
    assert [area.name for area in machine.keep_out] == ["clamp"]
    assert machine.not_modelled == ()
    assert [(t.number, t.length, t.diameter, t.x_offset, t.orientation) for t in machine.tools] == [
        (1, 12.5, None, None, None),
        (2, 61.4, 5.0, -1.5, 3),
    ]
    assert machine.controller == Controller(
        dialect="eding", laf_angle=3.0, interpolation_time=0.005, fifo_time=0.5, max_step_frequency=125000.0,
        auto_tool_change=True, absolute_arc_centers=True, diameter_programming=True, spindle_ramp_time=1.5,
    )  # fmt: skip
    assert machine.board == Board(name="bench", tick_frequency=20_000_000, step_pulse=1e-6, direction_setup=4e-6)
    assert (machine.name, machine.unit) == ("Mill", 1.0)


def test_nothing_stated_is_nothing_known(tmp_path: Path) -> None:
    machine = machine_of(tmp_path, HEAD + "[axes.y]\n[axes.b]\n")
    assert machine.name == "machine"
    y, b = machine.axes
    assert (y.kind, b.kind) == (AxisKind.LINEAR, AxisKind.ROTARY)
    assert (y.lower, y.steps_per_unit, y.max_velocity, y.travel_upper) == (None, None, None, None)
    assert machine.tool_change_area is None
    assert machine.controller == Controller()


def test_inches_become_millimetres_exactly(tmp_path: Path) -> None:
    text = WHOLE.replace('units = "mm"', 'units = "inch"').replace('"1600/5"', "8128.5")
    machine = machine_of(tmp_path, text)
    x, a = machine.axes
    assert x.steps_per_unit == Fraction("8128.5") / Fraction("25.4")
    assert (x.lower, x.upper, x.max_velocity, x.backlash) == (-266.7, 15240.0, 2540.0, 0.508)
    assert a.steps_per_unit == Fraction("44.4444")
    assert machine.tools[0].length == 317.5
    assert machine.tool_change_area is not None
    assert machine.tool_change_area.box[0] == (13970.0, 15240.0)
    assert machine.unit == 25.4


@pytest.mark.parametrize(
    ("written", "exact"),
    [
        ("320", Fraction(320)),
        ("320.5", Fraction(641, 2)),
        ("-0.1", Fraction(-1, 10)),
        ("1e3", Fraction(1000)),
        ('"1600/5"', Fraction(320)),
        ('"16000 / 360"', Fraction(400, 9)),
        ('"320.5"', Fraction(641, 2)),
        ('"-200.5/0.25"', Fraction(-802)),
    ],
)
def test_steps_are_exact(tmp_path: Path, written: str, exact: Fraction) -> None:
    assert machine_of(tmp_path, f"{HEAD}[axes.x]\nsteps_per_unit = {written}\n").axes[0].steps_per_unit == exact


@given(st.decimals(allow_nan=False, allow_infinity=False, places=4, min_value=1, max_value=10**6), st.integers(1, 9999))
def test_ratios_are_exact(number: object, divisor: int) -> None:
    assert exact_ratio(f"{number}/{divisor}") == Fraction(str(number)) / divisor


@pytest.mark.parametrize(
    ("text", "code", "line", "message"),
    [
        ("", "GP604", 1, "schema is missing"),
        ('schema = "gproof-machine/1"\n', "GP604", 1, "units is missing"),
        ('schema = "gproof-machine/2"\nunits = "mm"\n', "GP603", 1, "schema: 'gproof-machine/2'"),
        ('schema = 1\nunits = "mm"\n', "GP603", 1, "schema: 1 is not text"),
        (HEAD.replace("mm", "cm"), "GP603", 2, "units: 'cm' is not one of mm, inch"),
        (HEAD + "[axes.x\n", "GP601", 3, "not TOML"),
        (HEAD + "name = \n", "GP601", 3, "not TOML"),
        (HEAD + "[axes.x]\nmin = 1\nmin = 2\n", "GP601", 5, "not TOML"),
        (HEAD + "[axes.x]\nspeed = 1\n", "GP611", 4, "'axes.x.speed'"),
        (HEAD + "[axis.x]\nmin = 1\n", "GP611", 3, "'axis'"),
        (HEAD + "[axes.w]\n", "GP603", 3, "'w' is not an axis"),
        (HEAD + "axes = 3\n", "GP603", 3, "axes: 3 is not a table"),
        (HEAD + "[axes]\nx = 3\n", "GP603", 4, "axes.x: 3 is not a table"),
        (HEAD + '[axes.x]\nkind = "round"\n', "GP603", 4, "axes.x.kind"),
        (HEAD + "[axes.x]\nsteps_per_unit = 0\n", "GP603", 4, "axes.x.steps_per_unit"),
        (HEAD + '[axes.x]\nsteps_per_unit = "1600/0"\n', "GP603", 4, "axes.x.steps_per_unit"),
        (HEAD + '[axes.x]\nsteps_per_unit = "many"\n', "GP603", 4, "axes.x.steps_per_unit"),
        (HEAD + "[axes.x]\nmin = inf\n", "GP603", 4, "axes.x.min: Infinity is not a number"),
        (HEAD + "[axes.x]\nmin = nan\n", "GP603", 4, "axes.x.min"),
        (HEAD + "[axes.x]\nmin = 1e300\n", "GP603", 4, "axes.x.min: 1E+300 is too large"),
        (HEAD + "[axes.x]\nmin = 1e999999\n", "GP603", 4, "axes.x.min"),
        (HEAD + "[axes.x]\nmin = true\n", "GP603", 4, "axes.x.min: true is not a number"),
        (HEAD + '[axes.x]\nmin = "1"\n', "GP603", 4, "axes.x.min: '1' is not a number"),
        (HEAD + "[axes.x]\nmin = 5\nmax = 4\n", "GP603", 4, "axes.x.min: min is above max (5 > 4)"),
        (HEAD + "[axes.x]\ntravel_min = 5\ntravel_max = 4\n", "GP603", 4, "travel_min is above travel_max"),
        (HEAD + "[axes.x]\nmin = -5\ntravel_min = -4\n", "GP603", 5, "min of X is beyond travel_min"),
        (HEAD + "[axes.x]\ntravel_max = 4\nmax = 5\n", "GP603", 4, "max of X is beyond travel_max"),
        (HEAD + "[axes.x]\nmax = 5\nslaves = [{travel_max = 4}]\n", "GP603", 5, "max of X2 is beyond travel_max"),
        (HEAD + "[axes.x]\nmax_velocity = 0\n", "GP603", 4, "axes.x.max_velocity: 0 is not greater than 0"),
        (HEAD + "[axes.x]\nmax_acceleration = -1\n", "GP603", 4, "axes.x.max_acceleration"),
        (HEAD + "[axes.x]\nbacklash = -0.1\n", "GP603", 4, "axes.x.backlash: -0.1 is not 0 or greater than 0"),
        (HEAD + "[axes.x]\nslaves = 1.5\n", "GP603", 4, "axes.x.slaves"),
        (HEAD + "[areas.tool_change]\nx = [5, 4]\n", "GP603", 4, "areas.tool_change.x: the lower end 5"),
        (HEAD + "[areas.tool_change]\nx = [5]\n", "GP603", 4, "areas.tool_change.x"),
        (HEAD + "[areas.tool_change]\n", "GP604", 3, "areas.tool_change"),
        (HEAD + "[areas.tool_change]\nx = [4, 5]\nw = 3\n", "GP611", 5, "areas.tool_change.w"),
        (HEAD + "[tools.100]\nlength = 1\n", "GP603", 3, "'100' is not a number from 1 to 99"),
        (HEAD + "[tools.first]\nlength = 1\n", "GP603", 3, "'first' is not a number"),
        (HEAD + "[tools.1]\nlength = [1, 2]\n", "GP603", 4, "tools.1.length"),
        (HEAD + "[tools.1]\norientation = 10\n", "GP603", 4, "tools.1.orientation"),
        (HEAD + '[controller]\ndialect = "klingon"\n', "GP603", 4, "controller.dialect"),
        (HEAD + "[controller]\nlaf_angle = 200\n", "GP603", 4, "controller.laf_angle"),
        (HEAD + "[controller]\nauto_tool_change = 1\n", "GP603", 4, "controller.auto_tool_change: 1 is not"),
        (HEAD + "[controller]\nfifo_time = 0\n", "GP603", 4, "controller.fifo_time"),
        (HEAD + "[board]\ntick_frequency = 0.5\n", "GP603", 4, "board.tick_frequency"),
        (HEAD + '[board]\nticks = 3\n', "GP611", 4, "board.ticks"),
        (HEAD + 'base = "nothing.ini"\n', "GP601", 0, "nothing.ini"),
        (HEAD + 'base = 3\n', "GP603", 3, "base: 3 is not text"),
    ],
)  # fmt: skip
def test_mistakes_have_their_line(tmp_path: Path, text: str, code: str, line: int, message: str) -> None:
    if "nothing.ini" in text:
        path = tmp_path / "machine.toml"
        path.write_text(text)
        findings = Findings()
        assert load_machine(path, findings)[0] is None
        assert [(f.code.label, Path(f.span.file).name) for f in findings.kept] == [(code, "nothing.ini")]
        return
    first, *others = found(tmp_path, text)
    assert first[:2] == (code, line)
    assert message in first[2]
    assert all(other[0] == "GP604" for other in others)


def test_each_unknown_key_once(tmp_path: Path) -> None:
    path = tmp_path / "machine.toml"
    path.write_text(HEAD + "colour = 1\n[axes.x]\nspeed = 1\nsped = 2\n")
    findings = Findings()
    machine, _ = load_machine(path, findings)
    assert [(f.code.label, f.span.line) for f in findings.kept] == [("GP611", 5), ("GP611", 6), ("GP611", 3)]
    assert machine is None


def test_all_mistakes_are_told_at_once(tmp_path: Path) -> None:
    text = HEAD + "[axes.x]\nmin = true\nmax_velocity = 0\n[board]\nstep_pulse = -1\n"
    assert [(code, line) for code, line, _ in found(tmp_path, text)] == [("GP603", 4), ("GP603", 5), ("GP603", 7)]


def test_files_that_are_no_toml(tmp_path: Path) -> None:
    assert [f[:2] for f in found(tmp_path, HEAD.encode() + b'name = "\xff"\n')] == [("GP601", 3)]
    assert [f[0] for f in found(tmp_path, b"\x00\x01\x02")] == ["GP601"]
    assert [f[0] for f in found(tmp_path, "a = " + "[" * 5000)] == ["GP601"]
    assert [f[0] for f in found(tmp_path, "a = " + "1" * 5000)] == ["GP601"]
    findings = Findings()
    for path in (tmp_path, tmp_path / "none.toml"):
        machine, files = load_machine(path, findings)
        assert (machine, files) == (None, [])
    assert [f.code.label for f in findings.kept] == ["GP601", "GP601"]


def test_dotted_and_inline_keys_have_lines_too(tmp_path: Path) -> None:
    text = HEAD + 'axes.x.min = 3\naxes.x.max = 1\n"board"."ticks" = 1\ncontroller = {laf_angle = -1}\n'
    assert [f[:2] for f in found(tmp_path, text)] == [("GP603", 3), ("GP603", 6), ("GP611", 5)]


def test_a_controller_file_is_refined(tmp_path: Path) -> None:
    (tmp_path / "cnc.ini").write_text(
        "[GENERAL]\nunits = inch\n[JOINT_0]\nvisible = 1\nresolution = 8128\npositiveLimit = 10\nnegativeLimit = 0\n"
        "maxVelocity = 2\n[TOOL_1]\nzOffset = 1\ndiameter = 0.5\n[INTERPRETER]\ndiameterProgramming = 1\nodd = 1\n"
    )
    path = tmp_path / "machine.toml"
    path.write_text(
        HEAD
        + 'base = "cnc.ini"\n[axes.x]\nmax = 250\ntravel_min = -1\n[axes.a]\n'
        + "[tools.1]\nlength = 30\n[tools.2]\nlength = 5\n"
    )
    findings = Findings()
    machine, files = load_machine(path, findings)
    assert machine is not None
    assert [(f.code.label, Path(f.span.file).name, f.span.line) for f in findings.kept] == [("GP602", "cnc.ini", 14)]
    x, a = machine.axes
    assert (x.steps_per_unit, x.lower, x.upper, x.travel_lower, x.max_velocity) == (320, 0.0, 250.0, -1.0, 50.8)
    assert (a.name, a.kind) == ("a", AxisKind.ROTARY)
    assert [(t.number, t.length, t.diameter) for t in machine.tools] == [(1, 30.0, 12.7), (2, 5.0, None)]
    assert machine.controller.dialect == "eding"
    assert machine.controller.diameter_programming
    assert machine.not_modelled == ()
    assert machine.unknown_keys == (("cnc.ini", "[INTERPRETER] odd"),)
    assert (machine.name, machine.unit) == ("cnc.ini", 25.4)
    assert [Path(name).name for name, _ in files] == ["machine.toml", "cnc.ini"]


def test_a_circle_of_bases_ends(tmp_path: Path) -> None:
    text = HEAD + 'base = "machine.toml"\n'
    (circle,) = found(tmp_path, text)
    assert circle[:2] == ("GP603", 3)


def test_random_files_never_raise(tmp_path: Path) -> None:
    rng = random.Random(7)
    lines = WHOLE.splitlines()
    path = tmp_path / "machine.toml"
    for _ in range(500):
        changed = list(lines)
        for _ in range(rng.randint(1, 3)):
            at = rng.randrange(len(changed))
            key, _, value = changed[at].partition("=")
            odd = [
                "-1",
                "0",
                "true",
                '"x"',
                "[1, 2]",
                "[]",
                "{a=1}",
                "1e400",
                "nan",
                "2024-01-01",
                "'''",
                "1/2",
                '"5/3"',
            ]
            changed[at] = rng.choice(
                [f"{key}= {rng.choice(odd)}", f"{value}={key}", changed[rng.randrange(len(changed))], "", key, "]["]
            )
        text = "\n".join(changed).encode()
        if rng.random() < 0.2:
            cut = rng.randrange(len(text))
            text = text[:cut] + rng.randbytes(2) + text[cut:]
        path.write_bytes(text)
        findings = Findings()
        machine, _ = load_machine(path, findings)
        assert (machine is None) == any(f.code.number in (601, 603, 604, 611) for f in findings.kept), text
        if machine is not None:
            machine.verify()


@examples(60, 800)
@given(st.binary(max_size=100))
def test_random_bytes_never_raise(tmp_path_factory: pytest.TempPathFactory, data: bytes) -> None:
    for name in ("machine.toml", "cnc.ini"):
        path = tmp_path_factory.getbasetemp() / name
        path.write_bytes(data)
        findings = Findings()
        machine, _ = load_machine(path, findings)
        assert machine is None or findings.counts.keys() <= {602}


MOTORS = """\
[axes.y]
steps_per_unit = 320
min = 0
max = 600
pitch = [[0, 0], [50, 50.01]]
home_position = -2.0
home_velocity = -20
[[axes.y.slaves]]
joint = "a"
steps_per_unit = "-1600/10"
max = 590
max_velocity = 80
[[axes.y.slaves]]
[axes.a]
tip_feed = true
[knife]
axis = "b"
angle = 20
lift = 4
[controller]
macro_file = "mine.cnc"
homing_mandatory = false
safety_feed = 12.5
home_is_stop = true
turning = true
"""


def test_motors_knife_and_the_other_set_up_pages(tmp_path: Path) -> None:
    machine, findings = loaded_text(tmp_path, HEAD + "z_down_tool_length = 30\n" + MOTORS)
    assert findings == [] and machine is not None
    y, a = machine.axes
    table = PitchTable(machine=(0.0, 50.0), calibrated=(0.0, 50.01))
    assert (y.pitch, y.home_position, y.home_velocity, a.tip_feed) == (table, -2.0, -20.0, True)
    assert y.slaves == (
        Slave(joint="a", steps_per_unit=Fraction(-160), upper=590.0, max_velocity=80.0), Slave()
    )  # fmt: skip
    assert [(d.name, d.steps_per_unit, d.upper, d.pitch) for d in y.drives()] == [
        ("Y", 320, 600.0, table), ("Y2", -160, 590.0, table), ("Y3", 320, 600.0, table)
    ]  # fmt: skip
    assert machine.knife == Knife(axis="b", angle=20.0, lift=4.0)
    controller = machine.controller
    assert (controller.homing_mandatory, controller.turning) == (False, True)
    assert eding_settings(machine).macro_file == "mine.cnc"
    assert (controller.safety_feed, controller.home_is_stop, machine.z_down_tool_length) == (12.5, True, 30.0)


@pytest.mark.parametrize(
    ("text", "line", "what"),
    [
        ("[axes.x]\npitch = [[0, 0], [1]]\n", 4, "two positions on each row"),
        ("[axes.x]\npitch = [[0, 0], [0, 1]]\n", 4, "must rise"), ("[axes.x]\npitch = 3\n", 4, "list of numbers"),
        ("[axes.x]\nmin = 5\n[[axes.x.slaves]]\nmax = 4\n", 5, "lower limit of a motor"),
        ("[axes.x]\n[[axes.x.slaves]]\nmix = 4\n", 5, "mix"),
        ("[axes.x]\nslaves = [1]\n", 4, "not a list of tables"), ("[knife]\naxis = \"x\"\n", 4, "not one of a, b, c"),
    ],
)  # fmt: skip
def test_mistakes_of_motors(tmp_path: Path, text: str, line: int, what: str) -> None:
    _, findings = loaded_text(tmp_path, HEAD + text)
    assert any(at == line and what in message for at, message in findings), findings


def test_other_kinematics_are_not_modelled(tmp_path: Path) -> None:
    machine, _ = loaded_text(tmp_path, HEAD + 'kinematics = "delta"\n[axes.x]\n')
    assert machine is not None
    assert (machine.kinematics, [s.text for s in machine.not_modelled]) == ("delta", ["kinematics = delta"])


def loaded_text(folder: Path, text: str) -> tuple[Machine | None, list[tuple[int, str]]]:
    (folder / "m.toml").write_text(text)
    findings = Findings()
    machine, _ = load_machine(folder / "m.toml", findings)
    return machine, [(f.span.line, f.message) for f in findings.kept]


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        ("[axes.x]\nmn = 0\n", "did you mean 'min'?"),
        ("[tools.1]\ndiamter = 3\n", "did you mean 'diameter'?"),
        ("[axes.x]\nmin = 0\nmim = 0\n", "did you mean 'min', which is there too?"),
        ("[knife]\nsharpness = 1\n", "use one of these keys: angle, axis, blend_angle, blend_distance, lift"),
    ],
)
def test_a_key_that_is_nearly_one_says_which(tmp_path: Path, text: str, hint: str) -> None:
    file = tmp_path / "machine.toml"
    file.write_text(HEAD + text)
    findings = Findings()
    load_machine(file, findings)
    assert [f.hint for f in findings.kept if f.code.label == "GP611"] == [hint]


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("", Settings), ('[controller]\ndialect = "eding"', EdingSettings), ("[controls]\nnesting = 3", WinCncSettings),
        ('[controller]\nthread_peak = "offset"', EdingSettings), ('[controller]\ndialect = "wincnc"', WinCncSettings),
        ('[controller]\ndialect = "wincnc"\nmacro_file = "m.cnc"', WinCncSettings), ("[din]", McuWinSettings),
        ('[controller]\ndialect = "eding"\n[controls]\nnesting = 3', WinCncSettings),
        ('[controller]\ndialect = "mcuwin"', McuWinSettings), ("[controls]\nnesting = 3\n[din]", McuWinSettings),
    ],
)  # fmt: skip
def test_a_machine_has_the_settings_of_its_controller(text: str, kind: type, tmp_path: Path) -> None:
    (tmp_path / "m.toml").write_text(f'schema = "gproof-machine/1"\nunits = "mm"\n{text}\n')
    machine, _ = load_machine(tmp_path / "m.toml", Findings())
    assert machine is not None
    assert type(machine.settings) is kind
    foreign = machine.settings.foreign if isinstance(machine.settings, McuWinSettings) else ()
    assert foreign == (("controls",) if kind is McuWinSettings and "[controls]" in text else ())


@pytest.mark.parametrize("stated", ["super_long_file = 3", 'thread_peak = "offset"', 'macro_file = "m.cnc"'])
def test_settings_of_two_controllers_are_an_error(stated: str, tmp_path: Path) -> None:
    text = f'schema = "gproof-machine/1"\nunits = "mm"\n[controller]\n{stated}\n[controls]\nnesting = 3\n'
    (tmp_path / "m.toml").write_text(text)
    machine, _ = load_machine(tmp_path / "m.toml", findings := Findings())
    assert machine is None
    assert [(f.code.label, f.span.line) for f in findings.kept] == [("GP603", 5)]


@pytest.mark.parametrize(("base", "kind"), [("WINCNC.INI", WinCncSettings), ("McuWIN.ini", McuWinSettings)])
def test_settings_of_the_base_stay_whatever_the_dialect(base: str, kind: type, tmp_path: Path) -> None:
    (tmp_path / base).write_text("[MCU]\nMessageTask0Continue=1\n" if base == "McuWIN.ini" else "axischar=XYZ\n")
    text = f'schema = "gproof-machine/1"\nunits = "mm"\nbase = "{base}"\n[controller]\ndialect = "eding"\n'
    (tmp_path / "m.toml").write_text(text)
    machine, _ = load_machine(tmp_path / "m.toml", Findings())
    assert machine is not None
    assert type(machine.settings) is kind
