"""The APCI-8001 and 8008 of McuWIN, modelled: a spooler of records, contours, emergency input, limits, lag error.

What comes from where in the manual (2.5.3.133) is in ``FIGURES``. The spooler holds runs as its records. A command that
is no spooler command is executed when the contour before it has come to rest; one that meets motors in motion is a
fault: a certified stream has a rest there. The motors follow at once; a motor that is blocked (``block``) lags behind.
How an interpolation record looks is not public.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from gproof.backend.boards import run_kernels as rk
from gproof.backend.boards.board import APCI8001, BoardError, BoardState, Capabilities
from gproof.backend.boards.models.model import FIFO_RUNS, ModelBoard, capabilities, drives_of
from gproof.backend.boards.models.pins import PinNames
from gproof.backend.boards.simulated import Halt, HostDelay
from gproof.backend.runs import Ints, expand, spans
from gproof.ir.columns import Columns
from gproof.ir.machine import Machine
from gproof.ir.trace import Op

FIGURES = {
    "interpolation records, as many as the look-ahead depth": "14 (IniCfg, LookAhead depth)",
    "M26 and M27 are spooler commands: the contour goes on": "4.11, 4.12",
    "S ends the contour; G53 to G58 and G92 too": "5.2; 3.18, 3.19, 3.26",
    "axis number and two digits of an output": "4.11",
    "emergency input: the program ends, drives are off, no start while it is active": "2.1; 13.1.1.9, status 10",
    "referencing may be lost with it": "2.1",
    "maximum lag error of each axis: the program ends": "2.2; 13.1.1.3, error 2",
    "hardware limit switches, once referenced": "2.3; 13.1.1.5, error 4",
    "software limits, once referenced": "2.4; 13.1.1.7, error 8",
}
"""Figures of the manual, and its sections that have them."""

OUTPUTS_OF_AXIS = 8
"""Outputs of one axis channel; the manual gives them two digits and no number of them."""

SPOOLED = frozenset({Op.OUTPUT})
"""Events that are spooler commands."""

AT_REST = 0.5
"""Of the time between two steps around a standstill at full acceleration: less than this is motion (streams keep step
times within a tolerance)."""


class ApciSpooler(ModelBoard):
    """See the module's text.

    limits: lower and upper position in steps by motor, None where there is none; accelerations: steps/s² by motor, None
    where unknown: whether that motor rests is not watched; most_lag: steps by motor, None where none is set;
    referenced: limits are watched. Inputs: ``eo`` (until ``release_eo``), ``limit``.
    """

    def __init__(
        self,
        is_: Capabilities,
        *,
        limits: Sequence[tuple[int | None, int | None]] = (),
        accelerations: Sequence[float | None] = (),
        most_lag: Sequence[int | None] = (),
        referenced: bool = True,
        delay: HostDelay | None = None,
        speed: float = 1.0,
    ) -> None:
        motors = range(1, is_.motors + 1)
        outputs = tuple(f"O{channel}{n:02}" for channel in motors for n in range(1, OUTPUTS_OF_AXIS + 1))
        names = PinNames(
            step=tuple(f"STEP{m}" for m in motors), direction=tuple(f"DIR{m}" for m in motors), outputs=outputs
        )
        super().__init__(is_, names, delay=delay, speed=speed)
        none = (None,) * is_.motors
        self.limits = tuple(limits) or ((None, None),) * is_.motors
        self.accelerations = tuple(accelerations) or none
        self.most_lag = tuple(most_lag) or none
        self.referenced = referenced
        self.contours = 0
        self.eo_active = False
        self._queued = [0] * is_.motors
        self._crossings: list[tuple[int, int, str]] = []
        self._blocked: dict[int, tuple[int, int | None]] = {}

    @classmethod
    def for_machine(cls, machine: Machine, motors: int, *, real_time: bool = False) -> ApciSpooler:
        """A board with the limits and motors of a machine file."""
        limits: list[tuple[int | None, int | None]] = []
        known: list[float | None] = []
        for drive in drives_of(machine, motors):
            if drive is None or drive.steps_per_unit is None:
                limits.append((None, None))
                known.append(None)
                continue
            ends = [None if end is None else float(end * drive.steps_per_unit) for end in (drive.lower, drive.upper)]
            low, high = ends if drive.steps_per_unit > 0 else ends[::-1]
            # A step more: a stream may be rounded so far past a limit that its path keeps.
            limits.append((None if low is None else math.floor(low) - 1, None if high is None else math.ceil(high) + 1))
            top = drive.max_acceleration
            known.append(None if top is None else float(top * abs(drive.steps_per_unit)))
        is_ = capabilities(machine, APCI8001, motors, fifo_runs=FIFO_RUNS, real_time=real_time)
        return cls(is_, limits=limits, accelerations=known)

    def start_section(self, number: int, start: tuple[int, ...], lead: int) -> int:
        """See Board; refused while the emergency input is active."""
        if self.eo_active:
            raise BoardError(f"section {number}: the emergency input is active (status 10)")
        base = super().start_section(number, start, lead)
        self._queued, self._crossings = list(start), []
        self.contours = 1
        return base

    # Limits and lag.

    def _stored(self, motor: int, runs: Columns, tail: int) -> None:
        """Note the first step of these runs that leaves the motor's limits."""
        ways = runs["direction"].astype(np.int64)
        ends: Ints = self._queued[motor] + np.cumsum(runs["count"] * ways)
        starts = ends - runs["count"] * ways
        low, high = self.limits[motor]
        # Only steps that go further out: a motor that is outside may come back.
        for side, past in (
            (
                "right",
                None if high is None else np.where((ends > high) & (ways > 0), ends - np.maximum(starts, high), 0),
            ),
            ("left", None if low is None else np.where((ends < low) & (ways < 0), np.minimum(starts, low) - ends, 0)),
        ):
            if past is None or not past.any():
                continue
            k = int(np.argmax(past > 0))
            n = int(runs["count"][k] - past[k]) + 1
            lengths = spans(runs)
            tick = tail + int(lengths[:k].sum())
            tick += n * int(runs["interval"][k]) + int(runs["add"][k]) * (n * (n - 1) // 2)
            self._crossings.append((tick, motor, side))
        self._queued[motor] = int(ends[-1])

    def block(self, motor: int, at: int | None = None) -> None:
        """From a tick of the clock on the motor stands still, whatever steps it gets."""
        self._blocked[motor] = (self._now if at is None else at, None)

    def release_eo(self) -> None:
        """The emergency input is no longer active."""
        self.eo_active = False

    def _halts(self, until: int) -> list[Halt]:
        found = super()._halts(until)
        if self.referenced and self._crossings:
            tick, motor, side = min(self._crossings)
            what = f"software limit switch, axis {motor + 1} {side} (error 8)"
            found.append(Halt(tick - 1, tick, lambda: self._stop(BoardState.FAULT, what)))
        found += [halt for motor in self._blocked if (halt := self._lagging(motor)) is not None]
        return found

    def _lagging(self, motor: int) -> Halt | None:
        """When a blocked motor lags too far behind."""
        at, place = self._blocked[motor]
        most = self.most_lag[motor]
        state = self._state[motor]
        runs, last = self._rest()[motor]
        ticks, ways = expand(runs, last)
        position = int(state[rk.POSITION])
        if place is None or self._now < at:
            before = int(np.searchsorted(ticks, at, side="right")) if self._now < at else 0
            place = position + int(ways[:before].sum(dtype=np.int64))
            self._blocked[motor] = (at, place)
        if most is None:
            return None
        lag = np.abs(position + np.cumsum(ways, dtype=np.int64) - place)
        over = np.flatnonzero((lag > most) & (ticks > at))
        if not len(over):
            return None
        tick = int(ticks[over[0]])
        return Halt(tick, tick, lambda: self._lag_error(motor))

    def _lag_error(self, motor: int) -> None:
        self._lose()
        self._stop(BoardState.FAULT, f"lag error, axis {motor + 1} (error 2)")

    # Contours.

    def _execute(self, until: int) -> None:
        while self._events and self._events[0][0].tick <= until:
            event = self._events[0][0]
            self._advance(event.tick)
            if Op(event.op) not in SPOOLED:
                if (motor := self._in_motion()) is not None:
                    self._now = event.tick
                    self._lose()
                    what = f"the command of row {event.row} ends the contour while axis {motor + 1} moves"
                    self._stop(BoardState.FAULT, what)
                    return
                self.contours += 1
            super()._execute(event.tick)
        super()._execute(until)

    def _in_motion(self) -> int | None:
        """A motor that cannot stand still now: the steps around are nearer than its acceleration allows."""
        for motor, ((runs, last), acceleration) in enumerate(zip(self._rest(), self.accelerations, strict=True)):
            state = self._state[motor]
            if not acceleration or not len(runs) or not state[rk.FACING] or last == self._base:
                continue
            turned = int(runs["direction"][0]) != int(state[rk.FACING])
            gap = int(runs["interval"][0]) / self._is.tick_frequency
            if not turned and gap < AT_REST * math.sqrt(2 / acceleration):
                return motor
        return None

    # Outputs and stops.

    def _switched(self, op: Op, first: float, second: float) -> list[tuple[str, bool]]:
        # A whole channel at once (M26 100, M80) has no one meaning in a stream: its outputs stay as they are.
        return [(f"O{first:03g}", bool(second))] if op is Op.OUTPUT and first % 100 else []

    def _input(self, name: str) -> Callable[[], None]:
        if name == "eo":
            return lambda: self._emergency("emergency input (status 10)")
        if name == "limit":
            return self._limit_switch
        return super()._input(name)

    def _limit_switch(self) -> None:
        if self.referenced:
            self._stop(BoardState.FAULT, "hardware limit switch (error 4)")

    def emergency_stop(self) -> None:
        """As the emergency input, which is then inactive again."""
        self._pass_time()
        if not self._board_state.over:
            self._emergency("emergency stop")
            self.eo_active = False

    def _emergency(self, why: str) -> None:
        """The program ends and the drives are off: where the axes come to rest is unknown if they move."""
        self.eo_active = True
        if self._moving(self._is.tick_frequency // 100):
            self._lose()
        self._stop(BoardState.STOPPED, why)
