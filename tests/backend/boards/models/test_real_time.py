"""Modelled boards in real time at their highest rates, each edge compared with the stream as it goes out.

In every run five seconds, without a verdict on how much time was left: the host may have other things to do. In a soak
ten minutes, alone on the machine: no edge late behind a buffer of 50 ms.
"""

from __future__ import annotations

import numpy as np
import pytest
from backend.streams import events_of
from support.campaigns import SOAK

from gproof.backend.boards.board import BoardState, Capabilities
from gproof.backend.boards.models.apci import ApciSpooler
from gproof.backend.boards.models.model import BUFFER, ModelBoard
from gproof.backend.boards.models.pci7200 import Pci7200
from gproof.backend.boards.models.segment_cpu import SegmentCpu
from gproof.backend.control import Control
from gproof.backend.operators import AutoContinue
from gproof.backend.record_data import Result
from gproof.backend.runs import Ints, table
from gproof.backend.section_run import Pace, SectionRun
from gproof.ir.stream import StreamSection

FREQUENCY = 16_000_000
MOTORS = 6
TURN = 1000
"""Steps after which a motor turns back."""
PULSES = {213: (80, 80), 128: (32, 80)}
"""By interval (75.1 and 125 kHz) pulse and set-up: 5 and 5 µs, 2 and 5 µs."""
SECONDS = [5, *([pytest.param(600, marks=pytest.mark.soak)] if SOAK else [])]


def made(name: str, interval: int) -> ModelBoard:
    pulse, setup = PULSES[interval]
    is_ = Capabilities(
        name=name, motors=MOTORS, tick_frequency=FREQUENCY, fifo_runs=4096, step_pulse=pulse, direction_setup=setup,
        min_interval=interval, real_time=True,
    )  # fmt: skip
    if name == "pci7200":
        return Pci7200(is_)
    return ApciSpooler(is_) if name == "apci8001" else SegmentCpu(is_, segment=80_000, places=50)


def section_of(interval: int, seconds: float) -> StreamSection:
    """Runs of 200 steps, motor by motor a little later."""
    count = int(seconds * FREQUENCY / interval / 200) - 1
    ways = np.where(np.arange(count) // (TURN // 200) % 2, -1, 1).astype(np.int8)
    tables = []
    for m in range(MOTORS):
        intervals = np.full(count, interval, dtype=np.int64)
        intervals[0] += 16_000 + 35 * m
        steps = np.full(count, 200, dtype=np.int64)
        steps[0] = 1
        tables.append(table(intervals, steps, np.zeros(count, dtype=np.int64), ways))
    return StreamSection(
        number=0, start=(0,) * MOTORS, runs=tuple(tables), events=events_of([]), duration=int(seconds * FREQUENCY)
    )


class Judge:
    """Compares step edges with the stream as they come: motor m's step n is due at first + n intervals."""

    def __init__(self, interval: int, grid: int) -> None:
        self.interval, self.grid = interval, grid
        self.base = 0
        self.steps = [0] * MOTORS
        self.wrong = 0
        self.turns = 0
        self.last = 0

    def write(self, ticks: Ints, pins: Ints, levels: Ints) -> None:
        self.wrong += int((np.diff(ticks, prepend=self.last) < 0).sum())
        self.last = int(ticks[-1])
        self.turns += int((pins % 2 == 1).sum())
        for m in range(MOTORS):
            found = ticks[(pins == 2 * m) & (levels == self.active)]
            number = self.steps[m] + np.arange(len(found))
            due = self.base + 16_000 + 35 * m + self.interval * (number + 1)
            self.wrong += int((found != -(-due // self.grid) * self.grid).sum())
            self.steps[m] += len(found)

    active = 1

    def close(self) -> None:
        """Nothing to close."""


@pytest.mark.parametrize("seconds", SECONDS)
@pytest.mark.parametrize(("name", "interval"), [("pci7200", 213), ("eding-cpu", 128), ("apci8001", 128)])
def test_real_time(name: str, interval: int, seconds: float, capsys: pytest.CaptureFixture[str]) -> None:
    section = section_of(interval, seconds)
    board = made(name, interval)
    judge = Judge(interval, board.pins.form.grid)
    judge.active = int(name != "pci7200")
    board.pins.record(judge)
    is_ = board.open()
    pace = Pace(lookahead=FREQUENCY // 4, lead=FREQUENCY // 20, preparing=0)
    run = SectionRun(
        board, is_, section, pace=pace, prepare=lambda *_: None, operator=AutoContinue(), control=Control(),
        estop_at=None, on_tick=lambda _: setattr(judge, "base", run.base),
    )  # fmt: skip
    ended = run.run()
    status = board.status()
    steps = board.pins.steps
    board.close()
    left = board.slack.at(0.9999)
    with capsys.disabled():
        print(f"\n{name}: {sum(status.steps)} steps in {ended.ticks / FREQUENCY:.1f} s, {ended.outcome.value}")
        print(f"of a buffer of {BUFFER * 1000:g} ms 99.99 % of the edges had {left * 1000:.2f} ms left")
    assert judge.wrong == 0
    assert tuple(judge.steps) == status.steps
    if ended.outcome is Result.COMPLETED:
        assert status.state is BoardState.IDLE
        assert status.steps == steps == tuple(int(runs["count"].sum()) for runs in section.runs)
        assert judge.turns >= MOTORS * (status.steps[0] // TURN)
    if seconds > 5:
        assert ended.outcome is Result.COMPLETED, ended.reason
        assert board.slack.late == 0
        assert left > 0
