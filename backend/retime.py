"""Retiming: the same steps in the same order, later.

Takes a StreamSection and a TimeMap, gives the StreamSection whose steps and events lie where the map puts
them. Stretches that are only shifted keep their runs; others get new runs, in which a step may leave its
mapped tick by at most ``Spacing.tolerance`` ticks and by less wherever order across motors, the shortest
interval or the direction set-up would suffer. What is right about it is proved again: the runtime validates
every retimed section before it sends a step of it.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

import numpy as np
import numpy.typing as npt

from gproof.backend.boards.board import ticks_up
from gproof.backend.control import GREATEST_FACTOR, LEAST_FACTOR
from gproof.backend.retime_kernels import fit
from gproof.backend.runs import Ints, cut, expand, join, table
from gproof.backend.time_map import MapBuilder, TimeMap
from gproof.ir.columns import Columns
from gproof.ir.machine import Machine
from gproof.ir.record import record
from gproof.ir.stream import EVENT, RUN, StreamSection
from gproof.ir.trace import Op

CHUNK = 1 << 19
"""Steps of all motors that are expanded at a time."""

TOLERANCE = 1e-6
"""Seconds by which new runs may move a step, at most."""

SHARE = 64
"""... and this part of its distance to the motor's neighbouring steps."""


@record(frozen=True, slots=True, kw_only=True)
class Spacing:
    """Ticks: shortest time between steps of a motor, before a step in the other direction, room for runs."""

    gap: int
    setup: int
    tolerance: int

    @classmethod
    def of(cls, machine: Machine, tick_frequency: int, *, exact: bool = False) -> Spacing:
        """What the machine file requires; ``exact``: every step on its mapped tick."""
        gap = 2 * ticks_up(machine.board.step_pulse, tick_frequency)
        if machine.controller.max_step_frequency:
            gap = max(gap, ticks_up(1 / machine.controller.max_step_frequency, tick_frequency))
        return cls(
            gap=gap,
            setup=max(gap, ticks_up(machine.board.direction_setup, tick_frequency)),
            tolerance=0 if exact else int(TOLERANCE * tick_frequency),
        )


def retime(section: StreamSection, times: TimeMap, spacing: Spacing) -> StreamSection:
    """The section with every tick moved by ``times``."""
    events = dict(section.events.arrays)
    events["tick"] = times.at(section.events["tick"])
    motors = [_Motor(runs) for runs in section.runs]
    for begin, end, shifted in times.pieces(max(section.duration, begin_of_end(section))):
        if shifted:
            late = times.after(begin) - begin
            for motor in motors:
                motor.shift(end, late)
            continue
        while begin < end:
            stop = _chunk_end(motors, end)
            _warp(motors, events["tick"], (times.after(begin), stop, times), spacing)
            begin = stop
    return StreamSection(
        number=section.number,
        start=section.start,
        runs=tuple(motor.result() for motor in motors),
        events=Columns(EVENT, events),
        duration=times.after(section.duration),
    )


def dwells(section: StreamSection, tick_frequency: int) -> Iterator[tuple[int, int]]:
    """The ticks between which the program waits for a time."""
    for tick, _, op, arg in section.events.rows():
        if op == Op.DWELL:
            yield tick, tick + -(-int(arg[0]) * tick_frequency // 1000)


def begin_of_end(section: StreamSection) -> int:
    """The tick of the section's last step, 0 when it has none."""
    return max((int(expand_last(runs)) for runs in section.runs), default=0)


def expand_last(runs: Columns) -> int:
    """The tick of a motor's last step, 0 when it has none."""
    n = runs["count"]
    return int((n * runs["interval"] + runs["add"] * (n * (n - 1) // 2)).sum())


class _Motor:
    """One motor's runs on their way: what is left of the source, what is done of the result."""

    def __init__(self, runs: Columns) -> None:
        self.left = runs
        self.last = 0  # source tick of the last step taken
        self.laid = 0  # target tick of the last step given
        self.parts: list[Columns] = []

    def take(self, end: int) -> tuple[Columns, int]:
        """The runs up to source tick ``end``, and the source tick that they count from."""
        begin = self.last
        taken, self.left, passed = cut(self.left, end - begin)
        self.last = begin + passed
        return taken, begin

    def shift(self, end: int, late: int) -> None:
        """Steps up to ``end``, all ``late`` ticks later."""
        taken, begin = self.take(end)
        if not len(taken):
            return
        extra = begin + late - self.laid
        if extra:
            first, rest = cut(taken, int(taken["interval"][0]))[:2]
            first = table(first["interval"] + extra, first["count"], first["add"] * 0, first["direction"])
            taken = join([first, rest])
        self.parts.append(taken)
        self.laid = self.last + late

    def give(self, rows: Ints, laid: int) -> None:
        """New runs, the last of whose steps is at ``laid``."""
        if len(rows):
            interval, count, add = (np.ascontiguousarray(rows[:, k]) for k in range(3))
            self.parts.append(table(interval, count, add, rows[:, 3].astype(np.int8)))
            self.laid = laid

    def result(self) -> Columns:
        return join(self.parts) if self.parts else Columns(RUN)


def _chunk_end(motors: list[_Motor], end: int) -> int:
    """The source tick up to which about CHUNK steps come, at most ``end``."""
    stop = end
    for motor in motors:
        share = max(1, CHUNK // len(motors))
        counted = np.cumsum(motor.left["count"])
        place = int(np.searchsorted(counted, share))
        if place < len(counted):
            # Up to the end of the run that holds step number ``share``, or of that step in a long run.
            before = int(counted[place - 1]) if place else 0
            head = motor.left.slice(0, place)
            first, add = int(motor.left["interval"][place]), int(motor.left["add"][place])
            k = min(int(motor.left["count"][place]), share - before)
            stop = min(stop, motor.last + expand_last(head) + k * first + add * (k * (k - 1) // 2))
    return stop


def _warp(motors: list[_Motor], events: Ints, stretch: tuple[int, int, TimeMap], spacing: Spacing) -> None:
    """New runs for the steps of all motors up to a source tick."""
    begin, stop, times = stretch
    end = int(times.at(np.array([stop], dtype=np.int64))[0])
    taken = [motor.take(stop) for motor in motors]
    expanded = [expand(runs, after) for runs, after in taken]
    ticks = [times.at(source) for source, _ in expanded]
    around = events[(events >= begin) & (events <= end)]
    marks, counts = np.unique(np.concatenate([*ticks, around, [begin, end + 1]]), return_counts=True)
    seen = np.zeros(len(marks), dtype=np.int64)
    for motor, at, (_, direction) in zip(motors, ticks, expanded, strict=True):
        if not len(at):
            continue
        low, high = _windows(at, direction, motor.laid, spacing)
        place = np.searchsorted(marks, at)
        room_before = (at - marks[place - 1] - 1) // 2
        room_after = (marks[np.minimum(place + 1, len(marks) - 1)] - at - 1) // 2
        # Steps at the same tick keep the order of their motors: the first may only come sooner, the last later.
        low = np.maximum(low, at - np.where(seen[place] == 0, room_before, 0))
        seen[place] += 1
        high = np.minimum(high, at + np.where(seen[place] == counts[place], room_after, 0))
        out = np.empty((len(at), 4), dtype=np.int64)
        rows = fit.pick(float(len(at)))(low, high, direction, motor.laid, out)
        motor.give(out[:rows], int(at[-1]))


def _windows(at: Ints, direction: npt.NDArray[np.int8], laid: int, spacing: Spacing) -> tuple[Ints, Ints]:
    """Low and high tick of each step that keep its motor's intervals; the last step has no room."""
    intervals = np.diff(at, prepend=laid)
    turns = np.diff(direction, prepend=direction[:1]) != 0
    turns[0] = True  # what came before is not known here
    need = np.where(turns, spacing.setup, spacing.gap)
    room = np.minimum((intervals - need) // 2, intervals // SHARE)
    room = np.minimum(room, spacing.tolerance)
    room[:-1] = np.minimum(room[:-1], room[1:])
    room[-1] = 0
    room = np.maximum(room, 0)
    return at - room, at + room


def slow_map(section: StreamSection, tick_frequency: int, factor: Fraction) -> TimeMap:
    """The map of a feed override: everything at ``factor`` of its speed, dwells as long as they were.

    A section starts and ends at rest, so no ramp is needed: velocities scale by the factor, accelerations
    by its square.
    """
    if not LEAST_FACTOR <= factor <= GREATEST_FACTOR:
        raise ValueError(f"override {factor}: outside {LEAST_FACTOR} to {GREATEST_FACTOR}")
    build = MapBuilder()
    for begin, end in dwells(section, tick_frequency):
        build.slow(begin, factor)
        build.shift(min(section.duration, end))
    build.slow(max(section.duration, begin_of_end(section)), factor)
    return build.done()
