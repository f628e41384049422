"""A board with Klipper's protocol as a machine file describes it: pins, line, times."""

from __future__ import annotations

from gproof.backend.boards.board import BoardError, ticks_up
from gproof.backend.boards.klipper.driver import KlipperBoard
from gproof.backend.boards.klipper.lines import BAUD, Line, SerialLine
from gproof.backend.boards.klipper.wiring import MotorPins, OutputPin, Wiring
from gproof.ir.machine import Machine, Pin


class NotWired(BoardError):
    """The machine file does not say how a motor is wired. where: the key that is missing, below ``[board]``."""

    def __init__(self, what: str, where: str = "") -> None:
        super().__init__(what)
        self.where = where


def motor_names(machine: Machine) -> tuple[str, ...]:
    """The motors of a machine's streams, in their order."""
    return tuple(
        drive.name
        for axis in machine.axes
        for drive in axis.drives()
        if all(one.steps_per_unit is not None for one in axis.drives())
    )


def wiring_of(machine: Machine) -> Wiring:
    """The pins of a machine; NotWired."""
    board, names = machine.board, motor_names(machine)
    wired = {motor.motor: motor for motor in board.motors}
    for name in names:
        if name not in wired:
            raise NotWired(f"the machine file has no pins for motor {name}", f"motors.{name.lower()}")
    motors, outputs, inputs = [], {}, {}
    for name in names:
        motor, where = wired[name], f"motors.{name.lower()}"
        motors.append(
            MotorPins(
                step=motor.step.name, direction=motor.direction.name, inverted_step=motor.step.inverted,
                inverted_direction=motor.direction.inverted,
            )
        )  # fmt: skip
        if motor.enable is not None and f"enable {motor.enable.name}" not in outputs:
            outputs[f"enable {motor.enable.name}"] = OutputPin(
                pin=motor.enable.name, inverted=motor.enable.inverted, while_open=True, where=f"{where}.enable"
            )
        if motor.limit is not None:
            inputs[f"{where}.limit"] = motor.limit.name
    for output in board.outputs:
        outputs[output.output] = OutputPin(
            pin=output.pin.name, inverted=output.pin.inverted, idle=output.idle, where=f"outputs.{output.output}.pin"
        )
    if board.probe is not None:
        inputs["probe"] = board.probe.name
    return Wiring(motors=motors, names=names, outputs=outputs, inputs=inputs)


def klipper_board(machine: Machine, motors: int) -> KlipperBoard:
    """The board at the machine's port; BoardError where the machine file does not say what it needs."""
    board = machine.board
    if not board.port:
        raise BoardError("no port: give one with --port or as port under [board] of the machine file")
    baud = board.baud or BAUD
    wiring = wiring_of(machine)
    require_motors(wiring, motors)
    # A port that is an address has no rate of its own to be reckoned with; one that is stated counts.
    carried = board.baud if "://" in board.port else baud

    def connect() -> Line:
        return SerialLine(board.port, baud)

    pulse, setup = ticks_of(machine)
    return KlipperBoard(
        connect, wiring, pulse=pulse, direction_setup=setup, baud=carried, frequency=board.tick_frequency
    )


def require_motors(wiring: Wiring, motors: int) -> None:
    """BoardError where a stream has another number of motors than are wired."""
    if len(wiring.motors) != motors:
        raise BoardError(f"the machine file has {len(wiring.motors)} motors with steps_per_unit, the package {motors}")


def ticks_of(machine: Machine) -> tuple[int, int]:
    """Pulse and direction set-up in ticks of the machine's board."""
    board = machine.board
    return ticks_up(board.step_pulse, board.tick_frequency), ticks_up(board.direction_setup, board.tick_frequency)


def own_pins(machine: Machine) -> tuple[Pin, ...]:
    """Every pin that a machine file names."""
    board = machine.board
    of_motors = [pin for m in board.motors for pin in (m.step, m.direction, m.enable, m.limit) if pin is not None]
    return (*of_motors, *(output.pin for output in board.outputs), *((board.probe,) if board.probe else ()))
