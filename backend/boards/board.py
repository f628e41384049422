"""What the runtime needs of a board: the ``Board`` protocol and the data that crosses it.

A board counts ticks of its own clock and keeps a first-in-first-out store of runs, shared by all motors.
The host opens a section, sends runs and events in order, says up to which tick nothing is missing, closes
the section, and requests the status in between. ``docs/boards.md`` says how to add a board.
"""

from __future__ import annotations

import enum
import math
from fractions import Fraction
from typing import Protocol

from gproof.backend.runs import Ints
from gproof.ir.columns import Columns
from gproof.ir.record import record

VIRTUAL, EMULATOR = "virtual", "emulator"
PCI7200, FIFO_CPU, APCI8001 = MODELLED = "pci7200", "eding-cpu", "apci8001"
MOVES_NOTHING = frozenset({VIRTUAL, EMULATOR, *MODELLED})
"""The boards that move nothing: those inside this process, and one in a process that it starts itself. An emulator,
model or simulator on a port that somebody names is a board as others: what hangs there is known to nobody here."""


def ticks_up(seconds: float, tick_frequency: int) -> int:
    """Whole ticks that last at least ``seconds``; what a float adds to a round number does not count."""
    return max(0, math.ceil(Fraction(seconds) * tick_frequency - Fraction(1, 10**6)))


class BoardState(enum.Enum):
    """IDLE: no section. RUNNING: in a section, also while it waits for its first tick.

    STOPPED: after an emergency stop. UNDERRUN: a step was due before it arrived. FAULT: the host broke the
    protocol (FIFO overflow, malformed run). LOST: nothing is heard of it. From the last four a board moves nothing
    until it is opened again; what it had stored when it was lost it may still carry out.
    """

    CLOSED = "closed"
    IDLE = "idle"
    RUNNING = "running"
    STOPPED = "stopped"
    UNDERRUN = "underrun"
    FAULT = "fault"
    LOST = "lost"

    @property
    def over(self) -> bool:
        """True when the board takes nothing any more."""
        return self not in (BoardState.IDLE, BoardState.RUNNING)


class Known(enum.Enum):
    """How well a board's steps are known.

    EXACT: as counted. BETWEEN: at least those stated, and at most others. UNKNOWN: the board was reset, or counts what
    it was not sent.
    """

    EXACT = "exact"
    BETWEEN = "between"
    UNKNOWN = "unknown"


class BoardError(Exception):
    """The board does not answer, or refused what the host asked."""


@record(frozen=True, slots=True, kw_only=True)
class Counting:
    """How a board that counts what it executed was given its runs; without it a CRC cannot be derived again.

    levels: of the direction pins for steps that count up, by motor, 0 or 1; rest: ticks of rest from which a step gets
    a new clock base, ``lead`` ticks before it (0: never).
    """

    levels: tuple[int, ...]
    rest: int = 0
    lead: int = 0


@record(frozen=True, slots=True, kw_only=True)
class Capabilities:
    """What a board is.

    motors: how many; tick_frequency: Hz; fifo_runs: runs it stores for all motors together;
    step_pulse, direction_setup: ticks; max_count: steps in one run; max_add, max_interval:
    the greatest growth of its intervals, signs aside, and the longest interval, ticks; max_rest: the longest interval
    of a run of one step (0: as of others); min_interval: the shortest time between two steps of a motor that it makes
    (0: any); real_time: its clock follows ours; step_rate: steps a second of all motors together that it makes on
    their ticks (0: no limit is known); step_ticks, run_ticks: what its processor takes for a step and for a run that
    comes (0: not known); link_rate: bytes a second to it (0: no
    limit is known); event_bytes: of an event on it, at most; watched: it watches the host's promises; identity,
    firmware: what tells it from others, and the version it runs; motor_names: those of the motors that are wired, in
    order, none where any will do; acts_alone: it carries out every event, False: those that the machine file has pins
    for, and the operator the others; counting:
    set when it counts what it executed.
    """

    name: str
    motors: int
    tick_frequency: int
    fifo_runs: int
    step_pulse: int
    direction_setup: int
    max_count: int = 2**31 - 1
    max_add: int = 2**61
    max_interval: int = 2**61
    max_rest: int = 0
    min_interval: int = 0
    real_time: bool = True
    link_rate: int = 0
    step_rate: int = 0
    step_ticks: int = 0
    run_ticks: int = 0
    event_bytes: int = 0
    watched: bool = True
    identity: str = ""
    firmware: str = ""
    motor_names: tuple[str, ...] = ()
    acts_alone: bool = True
    counting: Counting | None = None


@record(frozen=True, slots=True, kw_only=True)
class Status:
    """The board's answer at one moment.

    tick: the board's clock; state; free: runs the FIFO can take; accepted: runs acknowledged, by motor;
    steps: pulses given since it was opened, by motor; position: in steps, by motor; events: how many were
    carried out; stopped_at: clock tick at which motion stopped for good: the steps due by then were made, no others (a
    board that slows down along the path is at rest later); reason: why. known: how well the
    position is known; most: steps by motor that it made at most, where they are not known exactly. While a section
    runs, a board that does not report its steps states those that it has certainly made.
    """

    tick: int
    state: BoardState
    free: int
    accepted: tuple[int, ...]
    steps: tuple[int, ...]
    position: tuple[int, ...]
    events: int = 0
    stopped_at: int | None = None
    reason: str = ""
    known: Known = Known.EXACT
    most: tuple[int, ...] = ()


@record(frozen=True, slots=True)
class EventDone:
    """An event the board carried out: clock tick, trace row, op."""

    tick: int
    row: int
    op: int


@record(frozen=True, slots=True, kw_only=True)
class Observed:
    """What the board measured at its own outputs, by motor.

    min_interval: the shortest time between two steps in ticks (0: fewer than two steps);
    overlaps: steps nearer than two pulse widths to the one before; setups: direction changes nearer than the
    direction set-up time.
    """

    min_interval: tuple[int, ...] = ()
    overlaps: tuple[int, ...] = ()
    setups: tuple[int, ...] = ()

    @property
    def clean(self) -> bool:
        """True when no pulse or direction change came too early."""
        return not any(self.overlaps) and not any(self.setups)


@record(frozen=True, slots=True)
class Executed:
    """What a board reports of one motor's last section: steps made, and a CRC-32 of the runs they were made of."""

    steps: int
    crc: int


class Board(Protocol):
    """A board that makes steps. Ticks are the board's clock unless said otherwise; motors count from 0."""

    def open(self) -> Capabilities:
        """Connect, forget any stop, give what the board is; BoardError when it cannot."""

    def close(self) -> None:
        """Let go of the board; it must be at rest or is stopped."""

    def present(self, identity: bytes) -> None:
        """Say which certified stream follows: 32 bytes. Firmware that asks for it moves nothing without."""

    def start_section(self, number: int, start: tuple[int, ...], lead: int) -> int:
        """Start a section ``lead`` ticks from now and give the clock tick of its tick 0.

        start: where the host takes the motors to be, in steps; BoardError when the board counted otherwise.
        """

    def queue(self, motor: int, interval: int, count: int, add: int, direction: int) -> None:
        """Store one run; its first step is due ``interval`` ticks after the motor's last one."""

    def queue_runs(self, motor: int, runs: Columns) -> None:
        """Store many runs, in order."""

    def wire_bytes(self, motor: int, runs: Columns) -> Ints:
        """Bytes that each run takes on the link at most, with what goes before it; 0 where there is no link."""

    def queue_event(self, tick: int, row: int, op: int, arg: tuple[int, int]) -> None:
        """Store an event; ``tick`` counts from the section's start."""

    def commit(self, tick: int | None) -> None:
        """Promise that everything due up to ``tick`` of the section has been sent.

        Past it the board stops all motors together (an underrun) unless more was promised. None: nothing is
        due until further notice. A board that cannot watch this ignores it.
        """

    def finish_section(self, duration: int) -> None:
        """Say that nothing follows; the section is over ``duration`` ticks after its start."""

    def wait(self, tick: int) -> None:
        """Let time pass until the clock shows ``tick``, or motion stopped."""

    def status(self) -> Status:
        """The present state, with what has been acknowledged."""

    def take_events(self) -> list[EventDone]:
        """Events carried out since the last call, in order."""

    def find(self) -> Status:
        """Try to reach a board that is LOST and to learn where its motors are; it stays over until it is opened.

        Of any other, the status. The state after it was found is STOPPED; LOST when it was not.
        """

    def executed(self) -> tuple[Executed, ...]:
        """What the board executed of the last section, by motor; empty from a board that does not count it."""

    def observed(self) -> Observed:
        """Measurements since the board was opened; empty from a board that makes none."""

    def emergency_stop(self) -> None:
        """Stop all motors now; positions stay known as executed, nothing more is accepted."""
