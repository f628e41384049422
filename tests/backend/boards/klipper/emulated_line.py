"""The emulator as a line of the host, in the emulator's own time; and feeding a section as the runtime does."""

from __future__ import annotations

from collections.abc import Callable

from backend.streams import events_of

from gproof.backend.boards.board import BoardError, BoardState, Status
from gproof.backend.boards.emulator.emulator import Emulator, Options
from gproof.backend.boards.emulator.log_reader import read
from gproof.backend.boards.klipper.driver import KlipperBoard
from gproof.backend.boards.klipper.lines import LineLost
from gproof.backend.boards.klipper.wiring import MotorPins, Wiring
from gproof.backend.feed import Feeder, Words
from gproof.ir.columns import Columns
from gproof.ir.stream import StreamSection

SECOND = 10**9
TICKS = 16_000_000
MOTORS = 4
WIRING = Wiring(motors=[MotorPins(step=f"PA{2 * k}", direction=f"PA{2 * k + 1}") for k in range(MOTORS)])


class EmulatedLine:
    """A line in simulated time: it passes while the host reads."""

    def __init__(self, options: Options) -> None:
        self.emulator = Emulator(options)

    def now(self) -> float:
        return self.emulator.now / SECOND

    def write(self, data: bytes) -> None:
        self._there()
        self.emulator.write(data)

    def read(self, until: float) -> bytes:
        self._there()
        if data := self.emulator.taken():
            return data
        # Past the moment by what a float leaves off: time would stand still otherwise.
        self.emulator.advance(max(self.emulator.now, int(until * SECOND) + 2), heard=True)
        return self.emulator.taken()

    def _there(self) -> None:
        if not self.emulator.connected:
            raise LineLost("the link is closed")

    def close(self) -> None:
        pass

    def connect(self) -> EmulatedLine:
        """Open it anew: a tenth of a second later."""
        self.pass_time(0.1)
        if not self.emulator.connected:
            raise BoardError("there is no such port")
        return self

    def pass_time(self, seconds: float) -> None:
        """The host sleeps."""
        self.emulator.advance(self.emulator.now + round(seconds * SECOND))

    def made(self, base: int) -> list[list[tuple[int, int]]]:
        """Every step by motor, from the emulator's own log: tick of the section and direction."""
        self.emulator.finish()
        steps = read(self.emulator.log.held).steps
        found = []
        for k in range(MOTORS):
            ticks, directions = steps.of(2 * k)
            found.append(list(zip((ticks - base).tolist(), directions.tolist(), strict=True)))
        return found


def section_of(tables: list[Columns], duration: int) -> StreamSection:
    return StreamSection(
        number=0, start=(0,) * MOTORS, runs=tuple(tables), events=events_of([]), duration=duration
    )  # fmt: skip


def feed(
    board: KlipperBoard,
    section: StreamSection,
    words: Words,
    *,
    ahead: int = TICKS // 4,
    pause: int = TICKS // 20,
    base: Callable[[int], None] = lambda _: None,
    each: Callable[[Status, int], None] = lambda _, __: None,
) -> Status:
    """A section as the runtime feeds it, until the board is done or stopped; each: called in every round."""
    feeder = Feeder(section, words)
    zero, finished = board.start_section(0, section.start, TICKS // 20), False
    base(zero)
    while True:
        status = board.status()
        now = status.tick - zero
        if status.state is not BoardState.RUNNING:
            return status
        each(status, now)
        feeder.fill(board, status.free, max(0, now) + ahead)
        due = feeder.next_due
        if due is not None:
            board.commit(due - 1)
            target = now + max(1, (min(due - 1, now + ahead) - now) // 2)
        else:
            if not finished:
                board.finish_section(section.duration)
                finished = True
            target = max(section.duration, now + 1)
        board.wait(zero + min(target, now + pause))
