"""``[board]`` of a machine file: pins as they are written, each mistake at its line, and what a package keeps of it."""

from __future__ import annotations

from pathlib import Path

from support.each import each

from gproof.driver.dialects import load_machine
from gproof.ir.finding import Findings
from gproof.ir.machine import Machine, Pin, WiredMotor, WiredOutput
from gproof.ir.text import parse_ir, print_ir

HEAD = """schema = "gproof-machine/1"
units = "mm"
[axes.x]
steps_per_unit = 100
[axes.y]
steps_per_unit = 100
slaves = 1
"""
BOARD = (
    HEAD
    + """[board]
name = "klipper"
port = "/dev/ttyACM0"
baud = 500000
probe = "^PJ1"
[board.motors.y2]
step = "!PA4"
direction = "PA5"
enable = "!PD7"
[board.motors.x]
step = "PA0"
direction = "!PA1"
enable = "!PD7"
limit = "!^PE5"
[board.outputs.3]
pin = "PB1"
[board.outputs.spindle]
pin = "!PB0"
idle = false
speed = 18000
"""
)


def read(folder: Path, text: str) -> tuple[Machine | None, list[tuple[int, str]]]:
    path = folder / "machine.toml"
    path.write_text(text)
    findings = Findings()
    machine, _ = load_machine(path, findings)
    return machine, [(f.span.line, f.message) for f in findings.kept]


def test_pins_are_as_the_file_has_them(tmp_path: Path) -> None:
    machine, found = read(tmp_path, BOARD)
    assert found == [] and machine is not None
    board = machine.board
    assert (board.name, board.port, board.baud, board.probe) == (
        "klipper", "/dev/ttyACM0", 500_000, Pin(name="PJ1", pull_up=True)
    )  # fmt: skip
    enable = Pin(name="PD7", inverted=True)
    # In the order of the machine's motors, not of the file.
    assert board.motors == (
        WiredMotor(
            motor="X", step=Pin(name="PA0"), direction=Pin(name="PA1", inverted=True), enable=enable,
            limit=Pin(name="PE5", inverted=True, pull_up=True),
        ),
        WiredMotor(motor="Y2", step=Pin(name="PA4", inverted=True), direction=Pin(name="PA5"), enable=enable),
    )  # fmt: skip
    assert board.outputs == (
        WiredOutput(output="spindle", pin=Pin(name="PB0", inverted=True), speed=18000.0),
        WiredOutput(output="3", pin=Pin(name="PB1")),
    )


def test_a_package_keeps_the_pins_and_not_the_port(tmp_path: Path) -> None:
    machine, _ = read(tmp_path, BOARD)
    moved, _ = read(tmp_path, BOARD.replace("ttyACM0", "ttyACM1").replace("500000", "250000"))
    swapped, _ = read(tmp_path, BOARD.replace('"PA5"', '"!PA5"'))
    text = print_ir(machine)
    assert text == print_ir(moved) and "ttyACM" not in text
    assert text != print_ir(swapped)
    assert parse_ir(text) == machine


def test_a_file_replaces_the_pins_of_its_base(tmp_path: Path) -> None:
    (tmp_path / "base.toml").write_text(BOARD)
    over = 'schema = "gproof-machine/1"\nunits = "mm"\nbase = "base.toml"\n[board]\nport = "/dev/ttyUSB3"\n'
    machine, found = read(tmp_path, over + '[board.motors.x]\nstep = "PA7"\n[board.outputs.mist]\npin = "PB2"\n')
    assert found == [] and machine is not None
    assert machine.board.port == "/dev/ttyUSB3"
    assert [motor.step.name for motor in machine.board.motors] == ["PA7", "PA4"]
    assert machine.board.motors[0].direction == Pin(name="PA1", inverted=True)
    assert [output.output for output in machine.board.outputs] == ["mist", "spindle", "3"]
    machine, found = read(tmp_path, over + '[board.motors.x]\nstep = "PA4"\n')
    assert machine is None
    assert found == [(7, "board.motors.x.step: pin PA4 is also motors.y2.step")]


MISTAKES = {
    'step = "PA0"\ndirection = "PA0"': [(11, "board.motors.x.direction: pin PA0 is also motors.x.step")],
    'step = "PA0"\ndirection = "pa0"': [(11, "board.motors.x.direction: pin pa0 is also motors.x.step")],
    'step = "PA0"': [(9, "board.motors.x.direction is missing")],
    'step = "!!PA0"\ndirection = "PA1"': [
        (10, "board.motors.x.step: '!!PA0' is not a pin such as \"PB4\", or \"!PB4\" where it is inverted")
    ],
    'step = "^PA0"\ndirection = "PA1"': [
        (10, "board.motors.x.step: '^PA0': only an input has a pull-up resistor (^)")
    ],
    'step = 3\ndirection = "PA1"': [(10, "board.motors.x.step: 3 is not text")],
    'step = "PA0"\ndirection = "PA1"\ndelay = 3': [(12, "there is no key 'board.motors.x.delay'")],
    'step = "PA0"\ndirection = "PA1"\n[board.motors.z]\nstep = "PA2"\ndirection = "PA3"': [
        (12, "board.motors.z: the machine has no motor z; it has: x, y, y2")
    ],
    'step = "PA0"\ndirection = "PA1"\nenable = "PA2"\n[board.motors.y]\nstep = "PA3"\ndirection = "PA4"\n'
    'enable = "!PA2"': [
        (16, "board.motors.y.enable: pin PA2 is also motors.x.enable, with other signs")
    ],
    'step = "PA0"\ndirection = "PA1"\n[board.outputs.fan]\npin = "PA2"': [
        (12, "board.outputs.fan: 'fan' is not one of spindle, spindle_reverse, mist, flood, or the number of an output"
             " channel"),
    ],
    'step = "PA0"\ndirection = "PA1"\n[board.outputs.mist]\npin = "PA1"': [
        (13, "board.outputs.mist.pin: pin PA1 is also motors.x.direction")
    ],
    'step = "PA0"\ndirection = "PA1"\n[board.outputs.mist]\npin = "PA2"\nspeed = 3': [
        (14, "board.outputs.mist.speed: only a spindle has a speed")
    ],
    'step = "PA0"\ndirection = "PA1"\n[board.outputs.mist]\nidle = true': [
        (12, "board.outputs.mist.pin is missing")
    ],
}  # fmt: skip


@each("text", list(MISTAKES))
def test_each_mistake_is_found_at_its_line(text: str, tmp_path: Path) -> None:
    machine, found = read(tmp_path, HEAD + f"[board]\n[board.motors.x]\n{text}\n")
    wanted = MISTAKES[text]
    assert [line for line, _ in found] == [line for line, _ in wanted], found
    assert [said for _, said in found] == [said for _, said in wanted]
    assert machine is None


def test_port_and_baud(tmp_path: Path) -> None:
    assert read(tmp_path, HEAD + '[board]\nport = " "\n')[1] == [(9, "board.port: an empty text")]
    assert read(tmp_path, HEAD + "[board]\nbaud = 50\n")[1] == [
        (9, "board.baud: 50 is not a whole number from 1200 to 10000000")
    ]


@each("name", ["cnc.ini", "WINCNC.INI", "McuWIN.ini"])
def test_a_controllers_own_file_gets_a_board(name: str, tmp_path: Path) -> None:
    """`base`: the file of the controller; its times of the board stay where nothing else is stated."""
    texts = {
        "cnc.ini": "[JOINT_0]\nvisible=1\nresolution=320\n[JOINT_1]\nvisible=1\nresolution=320\n",
        "WINCNC.INI": "unit=mm\naxischar=XY\naxisspec=p0s0d0r100a36000f24000o0\naxisspec=p0s1d1r100a36000f24000o1\n"
        "steppulse=P7 D6\n",
        "McuWIN.ini": "",
    }
    (tmp_path / name).write_text(texts[name])
    head = f'schema = "gproof-machine/1"\nunits = "mm"\nbase = "{name}"\n'
    pins = '[board]\nname = "klipper"\n[board.motors.x]\nstep = "PA0"\ndirection = "PA1"\n'
    axis = "[axes.x]\nsteps_per_unit = 100\n" if name == "McuWIN.ini" else ""
    machine, found = read(tmp_path, head + axis + pins)
    assert machine is not None, found
    assert machine.board.motors == (WiredMotor(motor="X", step=Pin(name="PA0"), direction=Pin(name="PA1")),)
    assert machine.board.name == "klipper"
    if name == "WINCNC.INI":
        assert (machine.board.step_pulse, machine.board.direction_setup) == (7e-6, 6e-6)
