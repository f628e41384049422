"""Which pins of a board drive what, and the commands that tell it so.

A board keeps its configuration until it is reset, and states the checksum of what it was given; one that was configured
for another machine is refused. Source: Klipper's MCU_Commands.md, "Low-level micro-controller configuration".
"""

from __future__ import annotations

import zlib
from collections.abc import Mapping, Sequence

from gproof.backend.boards.board import BoardError
from gproof.backend.boards.klipper.connection import Connection, Shutdown
from gproof.backend.boards.klipper.dictionary import DictionaryError
from gproof.backend.boards.outputs import Switched, pins_of
from gproof.ir.record import field, record


@record(frozen=True, slots=True, kw_only=True)
class MotorPins:
    """Pins of one motor, by the names of the board's dictionary.

    inverted_step: a step is a falling edge; inverted_direction: the pin is low for steps that count up.
    """

    step: str
    direction: str
    inverted_step: bool = False
    inverted_direction: bool = False


@record(frozen=True, slots=True, kw_only=True)
class OutputPin:
    """An output; inverted: the pin is low when it is on; idle: how it is after power-up and in a shutdown;
    while_open: on as long as a host has the board, as the enable pin of a drive is; where: the key of the machine file
    that names it."""

    pin: str
    inverted: bool = False
    idle: bool = False
    while_open: bool = False
    where: str = ""


class UnknownPin(DictionaryError):
    """A pin that the board does not have. where: the key of the machine file that names it, below ``[board]``."""

    def __init__(self, where: str, pin: str, chip: str) -> None:
        super().__init__(f"{where}: the board ({chip}) has no pin {pin}")
        self.where = where


@record(frozen=True, slots=True, kw_only=True)
class Wiring:
    """The pins of a machine.

    motors: in the stream's order; names: theirs, where they have some; outputs: by name; an event switches those that
    have the names of ``outputs.py``; switches: what an event switches instead, by its op and first argument as the
    stream has it (thousandths); inputs: pins that are there and that nothing here reads.
    """

    motors: Sequence[MotorPins]
    names: tuple[str, ...] = ()
    outputs: Mapping[str, OutputPin] = field(default_factory=dict)
    switches: Mapping[tuple[int, int], Switched] = field(default_factory=dict)
    inputs: Mapping[str, str] = field(default_factory=dict)

    def switched(self, op: int, arg: tuple[int, int]) -> Switched:
        """What an event switches."""
        known = self.switches.get((op, arg[0]))
        return pins_of(op, arg, self.outputs) if known is None else known

    def unknown(self, pins: Mapping[str, int]) -> list[tuple[str, str]]:
        """(what for, pin) of those that a board does not have; pins: of its dictionary."""
        named = [(f"motor {k}", pin) for k, motor in enumerate(self.motors) for pin in (motor.step, motor.direction)]
        if self.names:
            named = [
                (f"motors.{name.lower()}.{key}", pin)
                for name, motor in zip(self.names, self.motors, strict=True)
                for key, pin in (("step", motor.step), ("direction", motor.direction))
            ]
        named += [(output.where or f"outputs.{name}.pin", output.pin) for name, output in self.outputs.items()]
        return [(where, pin) for where, pin in (*named, *self.inputs.items()) if pin not in pins]

    def problems(self) -> list[str]:
        """Pins named twice, and outputs that nothing has."""
        named = [(pin, f"motor {k}") for k, motor in enumerate(self.motors) for pin in (motor.step, motor.direction)]
        named += [(output.pin, f"output {name}") for name, output in self.outputs.items()]
        first: dict[str, str] = {}
        found = []
        for pin, what in named:
            if pin in first:
                found.append(f"pin {pin} of {what} is also a pin of {first[pin]}")
            first.setdefault(pin, what)
        for switched in self.switches.values():
            found += [f"there is no output {name}" for name, _ in switched if name not in self.outputs]
        return found

    def oid(self, output: str) -> int:
        """The number of an output's object; motors come first."""
        return len(self.motors) + list(self.outputs).index(output)

    def level(self, output: str, on: bool) -> int:
        """The pin's level, 0 or 1, when an output is on or off."""
        return int(on is not self.outputs[output].inverted)

    def commands(self, connection: Connection, pulse: int) -> list[bytes]:
        """What configures a board; pulse: ticks. BoardError for a pin that it does not have."""
        if found := self.problems():
            raise BoardError(found[0])
        dictionary = connection.dictionary
        if unknown := self.unknown(dictionary.enumerations.get("pin", {})):
            raise UnknownPin(*unknown[0], str(dictionary.constants.get("MCU", "of no name")))
        listed = dictionary.listed
        made = [connection.command("allocate_oids", count=len(self.motors) + len(self.outputs))]
        for oid, motor in enumerate(self.motors):
            made.append(
                connection.command(
                    "config_stepper",
                    oid=oid,
                    step_pin=listed("pin", motor.step),
                    dir_pin=listed("pin", motor.direction),
                    invert_step=int(motor.inverted_step),
                    step_pulse_ticks=pulse,
                )
            )
        for name, output in self.outputs.items():
            made.append(
                connection.command(
                    "config_digital_out",
                    oid=self.oid(name),
                    pin=listed("pin", output.pin),
                    value=self.level(name, output.idle),
                    default_value=self.level(name, output.idle),
                    max_duration=0,
                )
            )
        return made


def configure(connection: Connection, commands: Sequence[bytes]) -> None:
    """Send a configuration and its checksum; BoardError where the board has another one."""
    checksum = zlib.crc32(b"".join(commands))
    before = connection.query("get_config", "config").fields
    if not before["is_config"]:
        for command in commands:
            connection.transport.send(command)
        connection.send("finalize_config", crc=checksum)
        before = connection.query("get_config", "config").fields
        if before["is_shutdown"]:
            raise Shutdown("the board is in a shutdown")
    if not before["is_config"] or before["crc"] != checksum:
        raise BoardError(
            "the board is configured for another machine, pins or pulse: reset it (switch it off and on) and try again"
        )
