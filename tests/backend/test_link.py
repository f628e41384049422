"""Whether a section can be sent in time: worked by hand, and against a host that is simulated message by message."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from backend.boards.klipper.fake_peer import DICTIONARY as SENT
from backend.jobs import job
from backend.streams import FREQUENCY
from hypothesis import given
from hypothesis import strategies as st
from support.campaigns import examples

from gproof.backend.boards.board import BoardState, Capabilities
from gproof.backend.boards.klipper.dictionary import parsed
from gproof.backend.boards.klipper.wire_size import run_bytes
from gproof.backend.boards.virtual import VirtualBoard
from gproof.backend.link import Link, link_plan
from gproof.backend.record import Result
from gproof.backend.runs import Ints, table
from gproof.backend.runtime import RunRefused, walk
from gproof.ir.columns import Columns
from gproof.ir.stream import EVENT, StreamSection

DICTIONARY = parsed(SENT)
KHZ = 1000
"""Ticks a second of these tests: a tick is a millisecond."""


def section(*motors: list[tuple[int, int]]) -> StreamSection:
    """Runs of each motor as (interval, count)."""
    runs = []
    for motor in motors:
        interval, count = (np.array(column, dtype=np.int64) for column in zip(*motor, strict=True))
        runs.append(table(interval, count, 0 * count, np.ones(len(count), dtype=np.int8)))
    duration = max(sum(interval * count for interval, count in motor) for motor in motors)
    return StreamSection(number=0, start=(0,) * len(motors), runs=tuple(runs), events=Columns(EVENT), duration=duration)


def sizes(motor: int, runs: Columns) -> Ints:
    """10 bytes a run, and 10 to set a direction."""
    return np.where(np.r_[True, np.diff(runs["direction"]) != 0], 20, 10)


def link(**other: float) -> Link:
    """A wire of 1000 bytes a second, 10 ticks a run; a host that looks all the time."""
    usual = {"tick_frequency": KHZ, "rate": 1000.0, "sizes": sizes, "event_bytes": 10, "places": 100, "latency": 0,
             "ahead": 1000, "turn": 0}  # fmt: skip
    return Link(**usual | other)  # type: ignore[arg-type]


def test_a_wire_that_is_fast_enough() -> None:
    """A run each 20 ticks takes 10 on the wire (20 the first, which sets the direction): the first one is due at tick
    20, so that sending has to begin at tick 0."""
    plan = link_plan(section([(20, 1)] * 50), link())
    assert (plan.lead, plan.slack, plan.shortage) == (0, 0, None)


def test_a_lead_that_makes_up_for_a_slow_wire() -> None:
    """A run each 8 ticks takes 10: of 100 the last one is due at 800 and 1010 ticks of the wire after the first."""
    plan = link_plan(section([(8, 1)] * 100), link())
    assert (plan.lead, plan.slack, plan.shortage) == (210, 0, None)


def test_a_wire_that_is_too_slow() -> None:
    """Of 2000 such runs none is sent more than 1000 before it is due: the first, due at 8, at -992. Run k (from 0)
    comes at 10 k + 20 - 992 and is due at 8 k + 8: of those with 2 k > 980, run 491 is the first, 2 ticks late."""
    plan = link_plan(section([(8, 1)] * 2000), link())
    assert plan.lead == 1000 and plan.shortage is not None and not plan.shortage.places
    found = plan.shortage
    assert (found.due, found.late, found.begin, found.messages, found.bytes) == (8 * 492, 2, -992, 492, 10 * 493)


def test_a_board_without_places() -> None:
    """Four places less one for cuts: the fourth run may go when the first has ended, at 100; it is due at 104."""
    runs = [(100, 1), (1, 1), (1, 1), (2, 1), (100, 1)]
    plan = link_plan(section(runs), link(places=4))
    assert plan.shortage is not None and plan.shortage.places
    assert (plan.shortage.due, plan.shortage.late, plan.shortage.begin) == (104, 6, 100)


def simulated(part: StreamSection, link: Link, lead: int) -> int:
    """The least ticks by which a message comes early, where a host sends one message after the other, as soon as the
    wire is free, the message is near enough and the board has a place."""
    todo = []
    for runs in part.runs:
        at, before = 0, 0
        for interval, count, direction in zip(
            runs["interval"].tolist(), runs["count"].tolist(), runs["direction"].tolist(), strict=True
        ):
            todo.append((at + interval, at + interval * count, 2 if direction != before else 1))
            at, before = at + interval * count, direction
    todo.sort(key=lambda one: one[0])
    clock, least, stored = -lead, 10**9, []
    for due, finish, messages in todo:
        stored.sort()
        if len(stored) >= link.places - len(part.runs):
            clock = max(clock, stored[len(stored) - (link.places - len(part.runs))] + link.latency)
        clock = max(clock, due - link.ahead if due - link.ahead > -lead else -lead)
        clock += -(-messages * 10 * link.tick_frequency // int(link.rate))
        least = min(least, due - clock - link.latency)
        stored.append(finish)
    return least


RUNS = st.lists(st.tuples(st.integers(1, 60), st.integers(1, 4)), min_size=1, max_size=40)


@examples(60, 5000)
@given(motors=st.lists(RUNS, min_size=1, max_size=3), places=st.integers(4, 20), ahead=st.integers(50, 400),
       latency=st.integers(0, 5))  # fmt: skip
def test_a_simulated_host(motors: list[list[tuple[int, int]]], places: int, ahead: int, latency: int) -> None:
    """A plan without a shortage is one that the host keeps, with its slack; one with a shortage is late."""
    part, this = section(*motors), link(places=places, ahead=ahead, latency=latency)
    plan = link_plan(part, this)
    early = simulated(part, this, plan.lead)
    assert early == plan.slack if plan.shortage is None else early < 0 and plan.slack < 0


class Wired(VirtualBoard):
    """The virtual board behind a line that carries so many bytes a second, 10 a run."""

    def __init__(self, rate: int, **more: int) -> None:
        super().__init__(2, tick_frequency=FREQUENCY, step_pulse=2, direction_setup=5, **more)
        self.rate = rate

    def open(self) -> Capabilities:
        return replace(super().open(), link_rate=self.rate, event_bytes=10)

    def wire_bytes(self, motor: int, runs: Columns) -> Ints:
        return np.full(len(runs), 10, dtype=np.int64)


WAY = job([(10.0, 0.0), (10.0, 7.0)], [(0.0, 0.0)])


def test_a_job_that_the_line_cannot_carry_is_refused_before_it_moves() -> None:
    """With a fast line it runs; what a slow one lacks is named with section, time and figure."""
    assert walk(WAY, Wired(1_000_000, fifo_runs=50_000)).result is Result.COMPLETED
    board = Wired(700, fifo_runs=50_000)
    with pytest.raises(RunRefused) as refused:
        walk(WAY, board)
    (first, *_) = refused.value.findings
    assert first.code.label == "GP840"
    assert "section 0" in first.message and "the link carries 700 bytes a second" in first.message
    assert board.status().state is BoardState.CLOSED and not any(board.status().steps)


def test_a_board_with_too_few_places_is_refused_before_it_moves() -> None:
    with pytest.raises(RunRefused) as refused:
        walk(WAY, Wired(1_000_000, fifo_runs=3))
    assert "the board has no place for them in time" in refused.value.findings[0].message


@given(st.lists(st.tuples(st.integers(1, 2**40), st.integers(1, 65535), st.integers(-(2**15), 2**15 - 1),
                          st.sampled_from((1, -1))), min_size=1, max_size=30))  # fmt: skip
def test_runs_are_no_longer_on_the_line_than_was_said(rows: list[tuple[int, int, int, int]]) -> None:
    """Klipper's messages one after the other, in blocks that are full but for the longest message."""
    interval_, count_, add_, direction_ = (np.array(column, dtype=np.int64) for column in zip(*rows, strict=True))
    runs = table(interval_, count_, add_, direction_.astype(np.int8))
    said = run_bytes(3, runs, DICTIONARY.commands)
    before = 0
    for (interval, count, add, direction), most in zip(rows, said.tolist(), strict=True):
        messages = [("queue_step", {"oid": 3, "interval": min(interval, 1 << 16), "count": count, "add": add})]
        if interval < 1 << 30:
            messages[0][1]["interval"] = interval
        else:
            messages.append(("reset_step_clock", {"oid": 3, "clock": 2**31 - 1}))
        if direction != before:
            messages.append(("set_next_step_dir", {"oid": 3, "dir": 1}))
        before = direction
        assert sum(len(DICTIONARY.commands[name].encoded(fields)) for name, fields in messages) < most


def test_a_processor_that_is_busy_with_steps_takes_runs_more_slowly() -> None:
    """40 runs of 5 steps, each 20 ticks long, no wire: 200 steps of 2 ticks in 800 are half of the processor's time, so
    that a message of 8 ticks takes 16, in time; one of 12 takes 24, too long for runs 20 ticks apart."""
    steps = section([(4, 5)] * 400)
    fast = link(rate=0.0, ahead=200, places=1000, run_ticks=8, step_ticks=2)
    assert link_plan(steps, fast).shortage is None
    slow = replace(fast, run_ticks=12)
    found = link_plan(steps, slow).shortage
    assert found is not None and found.late > 0 and not found.places
    # With hardly a step it is in time: a run each 20 ticks, 12 of them for the message.
    assert link_plan(section([(20, 1)] * 400), replace(slow, step_ticks=0)).shortage is None
