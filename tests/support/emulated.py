"""A small host for tests of the board emulator: commands by name, answers as tuples, in the emulator's own time."""

from __future__ import annotations

from gproof.backend.boards.emulator.emulator import Emulator, Options
from gproof.backend.boards.emulator.log_reader import Told, read
from gproof.backend.boards.emulator.wire import Receiver, frame, take_number

Answer = tuple[int | bytes | str, ...]

IDENTITY = bytes(range(32))
X_STEP, X_DIRECTION, Y_STEP, Y_DIRECTION, FAN, LIMIT = 0, 1, 2, 3, 8, 9
"""Pins PA0 … PA3, PB0, PB1."""

SETUP = (
    ("allocate_oids", 5),
    ("config_stepper", 0, X_STEP, X_DIRECTION, 0, 32),
    ("config_stepper", 1, Y_STEP, Y_DIRECTION, 0, 32),
    ("config_digital_out", 2, FAN, 0, 0, 0),
    ("config_endstop", 3, LIMIT, 1),
    ("config_trsync", 4),
    ("finalize_config", 77),
)


class Host:
    """Sends blocks in order and never again; listens for a time."""

    def __init__(self, options: Options | None = None) -> None:
        self.board = Emulator(options or Options())
        self.sequence = 0
        self.blocks: list[tuple[int, bytes]] = []
        self._commands = {form.name: form for form in self.board._language.commands.values()}
        self._answers = {form.number: form for form in self.board._language.answers.values()}
        self._received = Receiver(1 << 20)

    def frames(self, *commands: tuple[object, ...]) -> list[bytes]:
        """Commands in as few blocks as hold them."""
        payloads = [b""]
        for name, *values in commands:
            made = self._commands[str(name)].encoded(*values)  # type: ignore[arg-type]
            if len(payloads[-1]) + len(made) > 59:
                payloads.append(b"")
            payloads[-1] += made
        made_frames = []
        for payload in payloads:
            made_frames.append(frame(self.sequence, payload))
            self.sequence = self.sequence + 1 & 15
        return made_frames

    def send(self, *commands: tuple[object, ...]) -> None:
        for data in self.frames(*commands):
            self.board.write(data)

    def listen(self, seconds: float = 0.05) -> list[Answer]:
        """Responses that come within a time; all blocks are in ``blocks``."""
        self.board.advance(self.board.now + round(seconds * 1e9))
        return self.heard()

    def heard(self) -> list[Answer]:
        self._received.held += self.board.taken()
        found: list[Answer] = []
        while (block := self._received.next()) is not None:
            if block.payload is None:
                continue
            self.blocks.append((block.sequence, block.payload))
            if block.payload:
                number, place = take_number(block.payload, 0)
                form = self._answers[number]
                found.append((form.name, *form.decoded(block.payload, place)[0]))
        return found

    def ask(self, *commands: tuple[object, ...], seconds: float = 0.05) -> list[Answer]:
        self.send(*commands)
        return self.listen(seconds)

    def until(self, tick: int) -> list[Answer]:
        """Listen until the clock shows a tick."""
        at = self.board._clock.when(tick)
        self.board.advance(max(at, self.board.now))
        return self.heard()

    def log(self) -> Told:
        """The emulator's log up to now."""
        self.board.finish()
        return read(self.board.log.held)

    def steps(self, pin: int) -> list[tuple[int, int]]:
        """Ticks and directions of a motor's steps, from the log."""
        ticks, directions = self.log().steps.of(pin)
        return list(zip(ticks.tolist(), directions.tolist(), strict=True))


def ready(options: Options | None = None) -> Host:
    """A host with a configured board."""
    host = Host(options)
    assert host.ask(*SETUP) == []
    return host


def in_section(base: int, options: Options | None = None) -> Host:
    """A host with a section that starts at a clock, nothing promised yet but that; X and Y have it as base."""
    host = ready(options)
    host.send(("cert_begin", IDENTITY), ("cert_section", 7, base), ("cert_rest",))
    host.send(("reset_step_clock", 0, base), ("reset_step_clock", 1, base))
    host.send(("set_next_step_dir", 0, 1), ("set_next_step_dir", 1, 1))
    assert host.listen() == []
    return host
