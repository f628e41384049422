"""The pins of a modelled board: edges made from runs, kept until the clock has passed them, handed to who records them.

Levels here are logical (1: pulse, counting up, output on); ``PinNames`` says how a pin shows them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from gproof.backend.boards.models import pin_kernels as pk
from gproof.backend.runs import Ints
from gproof.ir.record import record

AT_ONCE = 1 << 15
"""Edges made in one go."""

SLACK_BIN = 10e-6
"""Seconds: how finely slack is counted."""

SLACK_BINS = 100_000


@record(frozen=True, slots=True, kw_only=True)
class PinNames:
    """step, direction: by motor; outputs: further pins by name; low: those that show a logical 1 as a low level."""

    step: tuple[str, ...]
    direction: tuple[str, ...]
    outputs: tuple[str, ...] = ()
    low: frozenset[str] = frozenset()

    @property
    def all(self) -> tuple[str, ...]:
        """By number: step and direction of each motor, then the outputs."""
        pairs = zip(self.step, self.direction, strict=True)
        return (*(name for pair in pairs for name in pair), *self.outputs)


class Recorder(Protocol):
    """Who gets the edges: tick, number of the pin, level of the pin; ticks never go back."""

    def write(self, ticks: Ints, pins: Ints, levels: Ints) -> None:
        """Edges in order."""

    def close(self) -> None:
        """No more come."""


class Slack:
    """How long before its time each edge was ready, in real time."""

    def __init__(self) -> None:
        self.counts = np.zeros(SLACK_BINS, dtype=np.int64)
        self.late = 0

    def add(self, seconds: np.ndarray) -> None:
        """Some edges, each with the time that was left."""
        self.late += int((seconds < 0).sum())
        bins = np.clip(seconds / SLACK_BIN, 0, SLACK_BINS - 1).astype(np.int64)
        self.counts += np.bincount(bins, minlength=SLACK_BINS)

    def at(self, share: float) -> float:
        """Seconds that this share of all edges had at least."""
        total = int(self.counts.sum())
        under = np.cumsum(self.counts)
        return float(np.searchsorted(under, total - int(share * total), side="right")) * SLACK_BIN if total else 0.0


class Pins:
    """Edges of all pins of a board; times in ticks of its clock."""

    def __init__(self, names: PinNames, form: pk.Form) -> None:
        self.names = names
        self.form = form
        motors = len(names.step)
        self.motors = np.zeros((motors, pk.FIELDS), dtype=np.int64)
        self.motors[:, pk.FACING] = -1
        self.motors[:, pk.RISE] = -pk.NEVER
        self.motors[:, (pk.DUE, pk.TURN, pk.FALL)] = pk.NEVER
        self._low = np.array([name in names.low for name in names.all], dtype=np.int64)
        self._level = np.zeros(len(names.all), dtype=np.int64)
        self._room = pk.Edges(*(np.zeros(AT_ONCE, dtype=np.int64) for _ in range(3)))
        self._made: list[tuple[Ints, Ints, Ints]] = []
        self._switched: list[tuple[int, int, int]] = []
        self._since = 0
        self._recorders: list[Recorder] = []
        self._number = {name: k for k, name in enumerate(names.all)}

    @property
    def idle_levels(self) -> list[int]:
        """The level of each pin when it is logically 0."""
        found: list[int] = self._low.tolist()
        return found

    def record(self, recorder: Recorder) -> None:
        """Hand all edges from now on to a recorder, too."""
        self._recorders.append(recorder)

    @property
    def recorded(self) -> bool:
        """Whether anybody gets the edges."""
        return bool(self._recorders)

    def reset(self) -> None:
        """Count anew."""
        self.motors[:, (pk.SHORT, pk.STEPS)] = 0

    def compile(self, rings: Ints) -> None:
        """Compile now what is called later."""
        pk.edges.compiled()(rings, self.motors, -1, 0, self.form, self._room)

    def begin(self, base: int) -> None:
        """A section: its intervals count from ``base``."""
        self._forget()
        self.motors[:, pk.LAST] = base

    def stored(self, motor: int, runs: int) -> None:
        """So many more runs are in a motor's ring."""
        self.motors[motor, pk.SIZE] += runs

    def make(self, rings: Ints, until: int) -> tuple[int, list[Ints]]:
        """Make all edges up to ``until``: the first one's tick (``pk.NEVER``: none), and the ticks of all."""
        until = until // self.form.grid * self.form.grid
        work = pk.edges.pick(float(self.motors[:, pk.SIZE].sum()) + 1)
        made: list[Ints] = []
        while True:
            n = work(rings, self.motors, until, self._since, self.form, self._room)
            if n:
                self._made.append((self._room.tick[:n].copy(), self._room.pin[:n].copy(), self._room.level[:n].copy()))
                made.append(self._made[-1][0])
            if n < AT_ONCE:
                break
        self._since = max(self._since, until)
        return (int(made[0][0]) if made else pk.NEVER), made

    def switch(self, name: str, tick: int, on: bool) -> None:
        """An output goes on or off; one that the board does not have is left out."""
        number = self._number.get(name)
        if number is not None:
            self._switched.append((tick, number, int(on)))

    def play(self, until: int) -> None:
        """The clock shows ``until``: what came by then goes to the recorders."""
        parts = []
        while self._made and self._made[0][0][0] <= until:
            ticks, pins, levels = self._made[0]
            n = int(np.searchsorted(ticks, until, side="right"))
            parts.append((ticks[:n], pins[:n], levels[:n]))
            if n < len(ticks):
                self._made[0] = ticks[n:], pins[n:], levels[n:]
                break
            self._made.pop(0)
        now = [switched for switched in self._switched if switched[0] <= until]
        if now:
            self._switched = [switched for switched in self._switched if switched[0] > until]
            columns = np.array(now, dtype=np.int64).T
            parts.append((columns[0], columns[1], columns[2]))
        if not parts:
            return
        ticks, pins, levels = (np.concatenate(column) for column in zip(*parts, strict=True))
        if now:
            order = np.argsort(ticks, kind="stable")
            ticks, pins, levels = ticks[order], pins[order], levels[order]
        self._out(ticks, pins, levels)

    def _out(self, ticks: Ints, pins: Ints, levels: Ints) -> None:
        self._level[pins] = levels
        for recorder in self._recorders:
            recorder.write(ticks, pins, levels ^ self._low[pins])

    def stop(self, at: int) -> None:
        """No step comes after ``at``; pulses that have begun are still to be completed."""
        self.play(at)
        dropped = self._made
        self._made, self._switched = [], []
        self._forget()
        self._since = at
        motors = self.motors
        for m in range(len(motors)):
            pin = 2 * m
            if self.form.quadrature:
                a, b = self._level[pin : pin + 2].tolist()
                motors[m, pk.PHASE] = (0, 3, 1, 2)[2 * a + b]
                continue
            motors[m, pk.FACING] = 1 if self._level[pin + 1] else -1
            first = [int(ticks[pins == pin][0]) for ticks, pins, _ in dropped if (pins == pin).any()]
            if not self._level[pin]:
                motors[m, pk.FALL] = pk.NEVER
            elif first:
                motors[m, pk.FALL] = first[0]

    def complete(self, rings: Ints) -> None:
        """The pulses that have begun, where no further step is stored."""
        since = self._since
        _, made = self.make(rings, pk.NEVER - 1)
        self.play(pk.NEVER)
        self._since = max(since, int(made[-1][-1])) if made else since

    def _forget(self) -> None:
        """Runs that are stored, and steps that are known."""
        self.motors[:, (pk.HEAD, pk.SIZE, pk.DONE)] = 0
        self.motors[:, (pk.DUE, pk.TURN)] = pk.NEVER

    def follow(self, steps: Sequence[tuple[Ints, Ints]], base: int) -> None:
        """These steps instead of the runs that are stored: (tick, direction) by motor."""
        most = max([len(ticks) for ticks, _ in steps] + [1])
        rings = np.zeros((len(steps), most, 4), dtype=np.int64)
        self._forget()
        self.motors[:, pk.LAST] = base
        for m, (ticks, ways) in enumerate(steps):
            n = len(ticks)
            rings[m, :n, 0] = np.diff(ticks, prepend=base)
            rings[m, :n, 1] = 1
            rings[m, :n, 3] = ways
            self.motors[m, pk.SIZE] = n
        self.complete(rings)
        self._forget()

    def finish(self, rings: Ints) -> None:
        """All that is left, and the recorders' end."""
        self.complete(rings)
        for recorder in self._recorders:
            recorder.close()
        self._recorders = []

    @property
    def steps(self) -> tuple[int, ...]:
        """Steps made, by motor."""
        return tuple(self.motors[:, pk.STEPS].tolist())

    @property
    def short(self) -> tuple[int, ...]:
        """Direction changes nearer to their step than the set-up time, by motor."""
        return tuple(self.motors[:, pk.SHORT].tolist())
