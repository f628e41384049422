"""A board as a machine file describes it: pins in the order of the motors, what is missing, what is too much."""

from __future__ import annotations

from dataclasses import replace

import pytest
from backend.boards.klipper.emulated_line import EmulatedLine
from backend.streams import machine

from gproof.backend.boards.board import BoardError
from gproof.backend.boards.emulated import as_wired
from gproof.backend.boards.emulator.emulator import Options
from gproof.backend.boards.emulator.log_reader import read
from gproof.backend.boards.klipper.driver import KlipperBoard
from gproof.backend.boards.klipper.from_machine import NotWired, klipper_board, wiring_of
from gproof.backend.boards.klipper.wiring import MotorPins, OutputPin, UnknownPin, Wiring
from gproof.ir.machine import Board, Machine, Pin, WiredMotor, WiredOutput

ENABLE = Pin(name="PD7", inverted=True)
X = WiredMotor(
    motor="X", step=Pin(name="PA0", inverted=True), direction=Pin(name="PA1"), enable=ENABLE, limit=Pin(name="PE5")
)
Y = WiredMotor(motor="Y", step=Pin(name="PA2"), direction=Pin(name="PA3", inverted=True), enable=ENABLE)


def _steps(line: EmulatedLine) -> int:
    line.emulator.finish()
    return len(read(line.emulator.log.held).steps.tick)


def wired(*motors: WiredMotor, outputs: tuple[WiredOutput, ...] = (), port: str = "/dev/null") -> Machine:
    return replace(machine("xy"), board=Board(name="klipper", motors=motors, outputs=outputs, port=port))


def test_pins_are_in_the_order_of_the_motors() -> None:
    mist = WiredOutput(output="mist", pin=Pin(name="PB0", inverted=True), idle=True)
    wiring = wiring_of(wired(Y, X, outputs=(mist,)))
    assert wiring.names == ("X", "Y")
    assert wiring.motors == [
        MotorPins(step="PA0", direction="PA1", inverted_step=True),
        MotorPins(step="PA2", direction="PA3", inverted_direction=True),
    ]
    # Motors that share an enable pin have one output.
    assert dict(wiring.outputs) == {
        "enable PD7": OutputPin(pin="PD7", inverted=True, while_open=True, where="motors.x.enable"),
        "mist": OutputPin(pin="PB0", inverted=True, idle=True, where="outputs.mist.pin"),
    }
    assert wiring.inputs == {"motors.x.limit": "PE5"}
    assert wiring.level("mist", True) == 0 and wiring.level("mist", False) == 1


def test_what_is_missing_is_named() -> None:
    with pytest.raises(NotWired, match="no pins for motor Y") as missing:
        klipper_board(wired(X), 2)
    assert missing.value.where == "motors.y"
    with pytest.raises(BoardError, match="no port"):
        klipper_board(wired(X, Y, port=""), 2)
    with pytest.raises(BoardError, match="the machine file has 2 motors with steps_per_unit, the package 3"):
        klipper_board(wired(X, Y), 3)


def test_a_limit_switch_has_to_be_on_a_pin_that_is_there() -> None:
    odd = replace(X, limit=Pin(name="PE9"))
    line = EmulatedLine(Options())
    with pytest.raises(UnknownPin, match=r"motors.x.limit: the board \(atmega2560\) has no pin PE9") as unknown:
        KlipperBoard(line.connect, wiring_of(wired(odd, Y))).open()
    assert unknown.value.where == "motors.x.limit"
    assert _steps(line) == 0


def test_a_board_that_has_no_room_for_all_says_so() -> None:
    """The emulated chip has 64 objects."""
    names = [f"P{port}{bit}" for port in "BCDEFGHJKL" for bit in range(8)]
    outputs = {name: OutputPin(pin=name) for name in names[:70]}
    pins = [MotorPins(step="PA0", direction="PA1"), MotorPins(step="PA2", direction="PA3")]
    line = EmulatedLine(Options())
    with pytest.raises(BoardError) as error:
        KlipperBoard(line.connect, Wiring(motors=pins, outputs=outputs)).open()
    assert str(error.value) == (
        "the board cannot be configured for 2 motors and 70 outputs: Can't assign oid; it has to be reset (switched off"
        " and on)"
    )
    assert _steps(line) == 0


def test_the_emulator_takes_the_pins_of_the_file_where_it_has_them() -> None:
    whole = wired(X, Y)
    assert as_wired(whole) is whole
    other = wired(replace(X, step=Pin(name="gpio2")), Y, outputs=(WiredOutput(output="mist", pin=Pin(name="gpio3")),))
    made = wiring_of(as_wired(other))
    assert [motor.step for motor in made.motors] == ["PA0", "PA2"]
    # Signs stay: they say what a level means.
    assert [motor.inverted_direction for motor in made.motors] == [False, True]
    assert list(made.outputs) == ["mist"] and made.problems() == []
    bare = wiring_of(as_wired(wired()))
    assert bare.names == ("X", "Y") and bare.problems() == []
