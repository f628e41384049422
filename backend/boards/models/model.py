"""What modelled boards share: pins, inputs that end motion, stops that run out along the path, losing the position.

A stop that runs out follows the path of the runs that are stored, slower and slower: after t seconds of T the path has
come to t - t² / 2T of its own time, so it is at rest after T/2 of that. Steps, their order and directions stay those of
the stream. ``Status.stopped_at`` is then the tick up to whose steps the path was followed; the clock shows more.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import numpy as np

from gproof.backend.boards import run_kernels as rk
from gproof.backend.boards.board import BoardState, Capabilities, EventDone, Known, Observed, ticks_up
from gproof.backend.boards.models import pin_kernels as pk
from gproof.backend.boards.models.pins import PinNames, Pins, Slack
from gproof.backend.boards.simulated import Halt, HostDelay, SimulatedBoard
from gproof.backend.feed import nearest
from gproof.backend.runs import Ints, cut, expand, table
from gproof.ir.columns import Columns
from gproof.ir.drives import Drive
from gproof.ir.machine import Machine
from gproof.ir.trace import Op

BUFFER = 0.05
"""Seconds that edges are made ahead in real time: what the host may be held up without a late edge."""

TURN = 0.005
"""Seconds between two looks at the pins in real time."""

FIFO_RUNS = 1024

SPARE = 64
"""Places of runs that motion has finished and pins have not: a fraction of a count of the timer."""


def shortest_interval(machine: Machine) -> int:
    """Ticks between two steps that a stream for the machine has at least (``verify/kernel/prove.py``): a period of the
    highest step frequency, of which rounding may take one, and two pulses."""
    ticks, most = machine.board.tick_frequency, machine.controller.max_step_frequency
    pulses = ticks_up(2 * machine.board.step_pulse, ticks)
    return max(1, pulses, math.ceil(Fraction(ticks) / Fraction(most)) - 1 if most else 1)


def drives_of(machine: Machine, motors: int) -> tuple[Drive | None, ...]:
    """The drives in a stream's order; None for each where there are not so many."""
    axes = [axis.drives() for axis in machine.axes]
    found = [drive for drives in axes if all(d.steps_per_unit is not None for d in drives) for drive in drives]
    return tuple(found) if len(found) == motors else (None,) * motors


def capabilities(machine: Machine, name: str, motors: int, *, fifo_runs: int, real_time: bool) -> Capabilities:
    """A board that makes the pulses of a machine file."""
    ticks = machine.board.tick_frequency
    return Capabilities(
        name=name, motors=motors, tick_frequency=ticks, fifo_runs=fifo_runs,
        step_pulse=ticks_up(machine.board.step_pulse, ticks), real_time=real_time,
        direction_setup=ticks_up(machine.board.direction_setup, ticks), min_interval=shortest_interval(machine),
    )  # fmt: skip


class ModelBoard(SimulatedBoard):
    """See the module's text.

    names: of the pins; grid: ticks between two moments at which pins may change; quadrature: two channels a motor
    instead of step and direction.
    """

    def __init__(
        self,
        is_: Capabilities,
        names: PinNames,
        *,
        grid: int = 1,
        quadrature: bool = False,
        delay: HostDelay | None = None,
        speed: float = 1.0,
    ) -> None:
        super().__init__(is_, delay=delay, speed=speed)
        self._rings = np.zeros((is_.motors, is_.fifo_runs + SPARE, 4), dtype=np.int64)
        self._grid = grid
        form = pk.Form(_up(is_.step_pulse, grid), _up(is_.direction_setup, grid), grid, int(quadrature))
        self.pins = Pins(names, form)
        self.slack = Slack()
        self.at_rest: int | None = None
        self._inputs: list[tuple[int, Callable[[], None]]] = []
        self._late: int | None = None

    @property
    def _pinned(self) -> bool:
        """Whether edges are made at all."""
        return self._is.real_time or self.pins.recorded

    def record_vcd(self, path: Path) -> None:
        """Write the pins to a file until the board is closed; OSError."""
        from gproof.backend.boards.models.vcd import VcdRecorder

        self.pins.record(
            VcdRecorder(path, self._is.name, self.pins.names, self.pins.idle_levels, self._is.tick_frequency)
        )

    # The protocol, with pins.

    def open(self) -> Capabilities:
        """See Board."""
        if self._is.real_time:
            self.pins.compile(self._rings)
        self.at_rest = None
        self._inputs = []
        self.pins.reset()
        return super().open()

    def close(self) -> None:
        """See Board; what records the pins is finished."""
        if self.pins.recorded:
            self.pins.finish(self._rings)
        super().close()

    def start_section(self, number: int, start: tuple[int, ...], lead: int) -> int:
        """See Board."""
        base = super().start_section(number, start, _up(lead + self._now, self._grid) - self._now)
        self.pins.begin(base)
        return base

    def queue_runs(self, motor: int, runs: Columns) -> None:
        """See Board; a run with steps nearer to one another than the board can make them is malformed."""
        before, tail = self._accepted[motor], int(self._state[motor, rk.TAIL])
        if len(runs) and self._accepts("run") and (near := self._too_near(motor, runs)) is not None:
            least = self._is.min_interval
            self._stop(BoardState.FAULT, f"motor {motor}: steps {near} ticks apart, the board makes {least} at least")
            return
        super().queue_runs(motor, runs)
        if self._accepted[motor] > before:
            self.pins.stored(motor, len(runs))
            self._stored(motor, runs, tail)

    def _stored(self, motor: int, runs: Columns, tail: int) -> None:
        """Runs have come; tail: tick of the last step that was stored before them."""

    def _too_near(self, motor: int, runs: Columns) -> int | None:
        """The shortest time between two steps where it is shorter than the board can make it."""
        state = self._state[motor]
        near = nearest(runs["interval"], runs["count"], runs["add"])
        if int(state[rk.TAIL]) != self._base:
            near = min(near, int(runs["interval"][0]))
        elif state[rk.FACING]:
            # The first of a section: the step before it was made in another.
            near = min(near, self._base + int(runs["interval"][0]) - int(state[rk.EDGE]))
        return near if 0 < near < self._is.min_interval else None

    def observed(self) -> Observed:
        """See Board; direction changes as the pins had them, where they were made."""
        seen = super().observed()
        pairs = zip(seen.setups, self.pins.short, strict=True)
        return Observed(
            min_interval=seen.min_interval, overlaps=seen.overlaps, setups=tuple(max(pair) for pair in pairs)
        )

    # Time.

    def _sleep(self, until: int) -> None:
        """Real time: make edges ahead meanwhile."""
        frequency = self._is.tick_frequency * self._speed
        while (rest := (until - self._clock()) / frequency) > 0:
            time.sleep(min(rest, TURN))
            self._attended(min(until, self._clock()))

    def _run(self, until: int) -> None:
        running = self._board_state is BoardState.RUNNING
        self._late = self._make_ahead(until) if running and self._is.real_time else None
        super()._run(until)
        self._late = None
        if running and self._board_state is BoardState.IDLE and self._pinned:
            self.pins.complete(self._rings)

    def _make_ahead(self, now: int) -> int | None:
        """Make the edges of the time that the buffer covers; the first one's tick when it is over already."""
        until = now + int(BUFFER * self._is.tick_frequency * self._speed)
        if self._horizon is not None:
            # The direction of a step that was not sent yet may change so long before it.
            until = min(until, self._horizon - self.pins.form.setup)
        first, made = self.pins.make(self._rings, until)
        if not made:
            return None
        clock = self._clock()
        for ticks in made:
            self.slack.add((ticks - clock) / (self._is.tick_frequency * self._speed))
        return first if first <= now else None

    def _halt(self, until: int) -> Halt | None:
        found = [halt for halt in (*self._halts(until), super()._halt(until)) if halt is not None]
        return min(found, key=lambda halt: halt.at, default=None)

    def _halts(self, until: int) -> list[Halt]:
        """What else ends motion."""
        found = [Halt(at, at, act) for at, act in self._inputs[:1]]
        if self._late is not None:
            what = f"the edge of tick {self._late - self._base} was not ready in time"
            found.append(Halt(self._late - 1, self._late, lambda: self._stop(BoardState.UNDERRUN, what)))
        return found

    def _execute(self, until: int) -> None:
        super()._execute(until)
        if self._pinned:
            self.pins.play(until // self._grid * self._grid)

    def _advance(self, until: int) -> None:
        if self._pinned:
            # Before the places of these runs are free.
            self.pins.make(self._rings, until)
        super()._advance(until)

    def _done(self, event: EventDone, arg: tuple[int, int]) -> None:
        super()._done(event, arg)
        for name, on in self._switched(Op(event.op), arg[0] / 1000, arg[1] / 1000):
            self.pins.switch(name, _up(event.tick, self._grid), on)

    def _switched(self, op: Op, first: float, second: float) -> list[tuple[str, bool]]:
        """The outputs that an event switches, by name."""
        return []

    # Ends of motion.

    def _stop(self, state: BoardState, reason: str) -> None:
        if self._pinned:
            self.pins.stop(self._now)
            self.pins.complete(self._rings)
        self._stopped(state, reason)

    def _stopped(self, state: BoardState, reason: str) -> None:
        super()._stop(state, reason)
        self.at_rest = self._now
        self._inputs = []

    def trigger(self, name: str, at: int | None = None) -> None:
        """An input becomes active, now or at a tick of the clock; ValueError when the board has none of that name."""
        act = self._input(name)
        self._pass_time()

        def acts() -> None:
            self._inputs.pop(0)
            act()

        self._inputs.append((_up(max(self._now, self._now if at is None else at), self._grid), acts))
        self._inputs.sort(key=lambda one: one[0])
        self._run(self._now)

    def _input(self, name: str) -> Callable[[], None]:
        """What an input does."""
        raise ValueError(f"board {self._is.name} has no input {name}")

    def _moving(self, within: int) -> bool:
        """Whether a motor stepped so many ticks ago at most, and one steps again in so many, as far as is known."""
        pulsed = (self._state[:, rk.FACING] != 0) & (self._now - self._state[:, rk.EDGE] <= within)
        soon = [runs["interval"][0] - (self._now - last) for runs, last in self._rest() if len(runs)]
        return bool(pulsed.any()) and (any(ticks <= within for ticks in soon) or self._path_known() < within)

    def _rest(self) -> list[tuple[Columns, int]]:
        """By motor the runs that are stored and not made, and the tick that they count from."""
        found = []
        for rings, state in zip(self._rings, self._state, strict=True):
            places = (int(state[rk.HEAD]) + np.arange(int(state[rk.SIZE]))) % self._rings.shape[1]
            interval, count, add, way = (rings[places, k].copy() for k in range(4))
            if len(places):
                interval[0] += add[0] * state[rk.DONE]
                count[0] -= state[rk.DONE]
            found.append((table(interval, count, add, way.astype(np.int8)), int(state[rk.LAST])))
        return found

    def _run_out(self, span: int, state: BoardState, reason: str) -> None:
        """Follow the path for ``span`` more ticks of its time while it slows down to a stop, then be stopped.

        The path must be known so far: ``_path_known``.
        """
        if span <= 0:
            self._stop(state, reason)
            return
        now, whole = self._now, 2 * span
        steps = []
        for runs, last in self._rest():
            ticks, ways = expand(cut(runs, now + span - last)[0], last)
            path = (ticks - now).astype(np.float64)
            warped = np.ceil(whole * (1.0 - np.sqrt(np.maximum(0.0, 1.0 - 2.0 * path / whole))))
            steps.append((_apart(now + warped.astype(np.int64)), ways.astype(np.int64)))
        if self._pinned:
            self.pins.stop(now)
        super()._advance(now + span)
        for event, arg in self._events_by(now + span):
            self._done(event, arg)
        if self._pinned:
            self.pins.follow(steps, now)
        path_end = now + span if self._end is None else min(now + span, max(now, self._end))
        self._now = now + whole
        self._stopped(state, reason)
        self._stopped_at = path_end
        if self._is.real_time:
            time.sleep(max(0.0, (self._now - self._shown()) / (self._is.tick_frequency * self._speed)))

    def _shown(self) -> int:
        """The clock, also where the board's own time is ahead of it."""
        return int((time.monotonic() - self._epoch) * self._is.tick_frequency * self._speed)

    def _path_known(self) -> int:
        """Ticks from now for which everything that is due has come."""
        return pk.NEVER if self._horizon is None else max(0, self._horizon - self._now)

    def _lose(self) -> None:
        """The position is no longer known: the motors have to be told again where they are."""
        self._well = Known.UNKNOWN
        self._known = False


def _apart(ticks: Ints) -> Ints:
    """Ticks that rise, where rounding has put two on one."""
    found: Ints = np.maximum.accumulate(ticks - np.arange(len(ticks))) + np.arange(len(ticks))
    return found


def _up(ticks: int, grid: int) -> int:
    return -(-ticks // grid) * grid
