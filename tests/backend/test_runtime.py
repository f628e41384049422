"""The runtime on the virtual board: what is executed, and that the record says so."""

import dataclasses
import os
import random
import signal
import threading
import time
from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest
from backend.jobs import job
from backend.streams import FREQUENCY, SPU, merged
from backend.test_virtual_board import reference
from hypothesis import given, settings
from hypothesis import strategies as st

from gproof.backend import runtime
from gproof.backend.boards.board import BoardError
from gproof.backend.boards.virtual import HostDelay, VirtualBoard
from gproof.backend.control import Control
from gproof.backend.job import CertifiedJob
from gproof.backend.operators import AutoContinue, HoldRequest, RefuseAll, WaitRequest
from gproof.backend.record import Result, parse_record, problems
from gproof.backend.runtime import Hold, RunFailed, RunRefused
from gproof.ir.trace import Wait

TWO = job([(10.0, 0.0), (10.0, 7.0)], [(0.0, 0.0)], [(3.0, 0.5)])


class Tap(VirtualBoard):
    """A virtual board that remembers every run it accepted."""

    def __init__(self, motors: int, **more) -> None:
        super().__init__(motors, tick_frequency=FREQUENCY, step_pulse=2, direction_setup=5, **more)
        self.seen: list[list[tuple[int, int, int, int]]] = [[] for _ in range(motors)]

    def queue_runs(self, motor: int, runs) -> None:
        before = self._accepted[motor]
        super().queue_runs(motor, runs)
        if self._accepted[motor] > before:
            self.seen[motor] += runs.rows()


def run(what: CertifiedJob, board: VirtualBoard, **more):
    """``runtime.run`` past the package, and the record read back and compared."""
    walk = runtime.walk(what, board, **more)
    assert parse_record(walk.to_json()) == walk
    assert list(problems(walk, what)) == []
    assert walk.position == board.status().position
    return walk


def test_a_job_runs_to_its_end() -> None:
    parts: list[float] = []
    board = Tap(2)
    record = run(TWO, board, on_progress=parts.append)
    assert record.result is Result.COMPLETED
    assert record.position == TWO.stream.sections[-1].end()
    assert sum(record.steps) == TWO.stream.steps()
    assert [s.number for s in record.sections] == [0, 1, 2]
    assert [s.target for s in record.sections] == [1, 2, -1]
    assert [len(s.events) for s in record.sections] == [2, 2, 1]
    assert parts == sorted(parts)
    assert parts[-1] == 1.0
    assert record.findings() == []
    assert record.observed.clean


def test_the_same_run_gives_the_same_bytes() -> None:
    more = {"hold_at": 100_000, "override": 0.7}
    assert run(TWO, Tap(2), **more).to_json() == run(TWO, Tap(2), **more).to_json()


@settings(max_examples=30)
@given(st.integers(0, 2_500_000), st.sampled_from([24, 1024]), st.sampled_from([1.0, 0.5]))
def test_an_emergency_stop_leaves_exactly_the_steps_due(tick: int, depth: int, override: float) -> None:
    record = run(TWO, Tap(2, fifo_runs=depth), estop_at=tick, override=override)
    done = sum(s.ticks for s in record.sections)
    if record.result is Result.COMPLETED:
        assert done <= tick
        return
    assert record.result is Result.EMERGENCY_STOP
    assert done == tick
    if override == 1.0:
        last = record.sections[-1]
        assert record.position == reference(TWO.stream.sections[last.number], last.ticks)
    assert [f.code.number for f in record.findings()] == [831]


@settings(max_examples=15)
@given(
    st.lists(
        st.tuples(st.integers(0, 2_000_000), st.integers(1, 700_000)).map(lambda h: Hold(at=h[0], rest=h[1])),
        min_size=1,
        max_size=3,
    ),
    st.sampled_from([1, Fraction(1, 3), 0.8]),
)
def test_holds_and_override_execute_the_same_steps(holds: list[Hold], override: float) -> None:
    plain, board = Tap(2), Tap(2)
    run(TWO, plain)
    record = run(TWO, board, hold_at=holds, override=override)
    assert record.result is Result.COMPLETED
    assert [way(rows) for rows in board.seen] == [way(rows) for rows in plain.seen]
    rests = [r for s in record.sections for r in s.retimings if r.kind == "hold"]
    assert len(rests) == len([f for f in record.findings() if f.code.number == 832])
    whole = sum(section.duration for section in TWO.stream.sections)
    if override == 1 and len(holds) == 1 and holds[0].at < whole:
        (rest,) = rests
        assert rest.rest == holds[0].rest


def way(rows: list[tuple[int, int, int, int]]) -> list[int]:
    return [d for _, count, _, d in rows for _ in range(count)]


def test_a_late_host_with_a_small_fifo_runs_dry_and_the_record_says_so() -> None:
    for guarded in (True, False):
        board = Tap(2, fifo_runs=40, delay=HostDelay(latency=50, hiccup=200_000, every=60), guarded=guarded)
        record = run(TWO, board)
        assert record.result is Result.UNDERRUN
        assert [f.code.number for f in record.findings()] == [830]
        assert sum(record.steps) < TWO.stream.steps()
        assert record.sections[-1].outcome is Result.UNDERRUN
        assert "promised" in record.reason if guarded else "arrived" in record.reason
    calm = Tap(2, fifo_runs=40, delay=HostDelay(latency=50))
    assert run(TWO, calm).result is Result.COMPLETED


@settings(max_examples=25)
@given(
    st.lists(st.tuples(st.floats(0, 1), st.sampled_from([0.1, 0.25, Fraction(1, 3), 0.8, 1])), min_size=1, max_size=5),
    st.sampled_from([1, 0.5]),
)
def test_an_override_that_changes_on_the_way_executes_the_same_steps(
    wishes: list[tuple[float, float]], first: float
) -> None:
    plain, board, control = Tap(2), Tap(2), Control()
    run(TWO, plain)
    waiting, told = sorted(wishes), []

    def wish(part: float) -> None:
        while waiting and part >= waiting[0][0]:
            control.override(waiting.pop(0)[1])

    record = run(TWO, board, override=first, control=control, on_progress=wish, on_override=lambda *a: told.append(a))
    assert record.result is Result.COMPLETED
    assert [way(rows) for rows in board.seen] == [way(rows) for rows in plain.seen]
    assert all(seconds is not None and 0 <= seconds <= 0.25 for _, seconds in told)
    changes = [r for s in record.sections for r in s.retimings if r.kind == "change"]
    assert len(changes) <= len(told)
    # No faster than planned, and no slower than at the least of the overrides, with the ramps between them.
    whole = sum(section.duration for section in TWO.stream.sections)
    least = min([first, *(factor for _, factor in wishes)])
    assert whole <= sum(s.ticks for s in record.sections) <= whole / least + len(changes) * FREQUENCY


def test_speeds_follow_the_override_within_the_acceleration_of_the_axis() -> None:
    """60 mm straight on at 60 mm/s, 600 mm/s2, at half the speed from somewhere in it on."""
    control, told = Control(), []

    def wish(part: float) -> None:
        if part > 0.2:
            control.override(0.5)

    one, board = job([(60.0, 0.0)], []), Tap(2)
    run(one, board, control=control, on_progress=wish, on_override=lambda *a: told.append(a))
    (asked,) = told
    assert asked[0] == Fraction(1, 2)
    ticks = np.cumsum(np.concatenate([i + a * np.arange(n) for i, n, a, _ in board.seen[0]])) / FREQUENCY
    speed = np.diff(ticks[::20]) ** -1 * 20 / SPU
    near = ticks[::20][1:]
    full, half = speed[np.argmin(abs(near - 0.2))], speed[len(speed) * 3 // 4]
    assert full == pytest.approx(60, rel=0.02)
    assert half == pytest.approx(30, rel=0.02)
    slowing = np.diff(speed) / np.diff(near)
    assert slowing.min() > -600 * 1.15


def test_a_section_without_overrides_leaves_them_to_the_next() -> None:
    fixed = job([(10.0, 0.0)], [(0.0, 0.0)], overrides=False)
    control = Control()
    record = run(fixed, Tap(2), control=control, on_progress=lambda part: control.override(0.5) and None)
    assert record.result is Result.COMPLETED
    assert not [r for s in record.sections for r in s.retimings]
    assert (control.override(7), control.override(0)) == (1, Fraction(1, 10))


def test_a_feed_hold_and_overrides_in_one_section() -> None:
    plain = Tap(2)
    run(TWO, plain)
    for seed in range(6):
        board, control, rng = Tap(2), Control(), random.Random(seed)
        wishes = [(rng.random() * 0.4, 0.3), (rng.random() * 0.4, None), (rng.random() * 0.4, 0.9)]
        wishes.sort(key=lambda wish: wish[0])

        def wish(part: float, wishes: list = wishes, control: Control = control) -> None:
            while wishes and part >= wishes[0][0]:
                factor = wishes.pop(0)[1]
                control.hold() if factor is None else control.override(factor)

        record = run(TWO, board, control=control, on_progress=wish, operator=AutoContinue(resume=True))
        assert record.result is Result.COMPLETED, record.reason
        kinds = {r.kind for s in record.sections for r in s.retimings}
        assert {"hold", "change"} <= kinds or {"hold", "override"} <= kinds
        assert [way(rows) for rows in board.seen] == [way(rows) for rows in plain.seen]


class Person:
    """Answers from a list, and what was asked."""

    def __init__(self, *answers: object) -> None:
        self.answers = list(answers)
        self.asked: list[WaitRequest | HoldRequest] = []

    def _next(self) -> object:
        answer = self.answers.pop(0)
        if isinstance(answer, BaseException):
            raise answer
        return answer

    def wait(self, request: WaitRequest):
        self.asked.append(request)
        return self._next()

    def held(self, request: HoldRequest):
        self.asked.append(request)
        return self._next()


@pytest.mark.parametrize("answer", [None, "nonsense", KeyboardInterrupt()])
def test_a_refused_wait_ends_the_job_at_rest(answer: object) -> None:
    record = run(TWO, Tap(2), operator=Person("on", answer))
    assert record.result is Result.STOPPED
    assert [s.number for s in record.sections] == [0, 1]
    assert record.sections[-1].outcome is Result.COMPLETED
    assert "waiting" in record.reason


def test_the_operator_is_told_what_is_waited_for() -> None:
    person = Person("on", "on")
    assert run(TWO, Tap(2), operator=person).result is Result.COMPLETED
    first = person.asked[0]
    assert isinstance(first, WaitRequest)
    assert (first.wait, first.section, first.line, first.outcomes) == (Wait.OPERATOR, 0, 4, ("on",))


def test_nobody_guesses_what_a_machine_would_answer() -> None:
    waits = (Wait.OPERATOR, Wait.INPUT)
    asks = job([(1.0, 0.0)], [(2.0, 0.0)], [(0.0, 0.0)], waits=waits)
    record = run(asks, Tap(2), operator=AutoContinue())
    assert record.result is Result.STOPPED
    assert record.sections[-1].number == 1
    assert run(asks, Tap(2), operator=RefuseAll()).sections[-1].number == 0


def at_part(part: float, do: Callable[[], None]) -> Callable[[float], None]:
    """Calls ``do`` once, when the progress reaches ``part``."""
    left = [do]

    def progress(now: float) -> None:
        if now >= part and left:
            left.pop()()

    return progress


@settings(max_examples=15)
@given(st.floats(0, 1), st.booleans(), st.sampled_from([30, 1024]))
def test_an_interrupt_is_a_feed_hold(part: float, resume: bool, depth: int) -> None:
    def interrupt() -> None:
        raise KeyboardInterrupt

    plain, board = Tap(2), Tap(2, fifo_runs=depth)
    run(TWO, plain)
    person = AutoContinue(resume=resume)
    record = run(TWO, board, operator=person, on_progress=at_part(part, interrupt))
    if resume:
        assert record.result is Result.COMPLETED
        assert [way(rows) for rows in board.seen] == [way(rows) for rows in plain.seen]
    elif record.result is not Result.COMPLETED:
        assert record.result is Result.STOPPED
        assert "feed hold" in record.reason


def test_a_second_interrupt_is_an_emergency_stop() -> None:
    control = Control()

    def twice() -> None:
        control.interrupt()
        control.interrupt()

    record = run(TWO, Tap(2), control=control, on_progress=at_part(0.3, twice))
    assert record.result is Result.EMERGENCY_STOP
    assert 0.25 < sum(record.steps) / TWO.stream.steps() < 0.75


def test_a_signal_is_heard_in_the_main_thread() -> None:
    before = signal.getsignal(signal.SIGINT)
    record = run(TWO, Tap(2), on_progress=at_part(0.2, lambda: os.kill(os.getpid(), signal.SIGINT)))
    assert record.result is Result.STOPPED
    assert record.sections[-1].retimings[-1].kind == "hold"
    assert signal.getsignal(signal.SIGINT) is before


def test_an_interrupt_ends_a_question() -> None:
    class Asked(Person):
        def wait(self, request: WaitRequest):
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(5)
            return "on"

    assert run(TWO, Tap(2), operator=Asked()).result is Result.STOPPED


def test_a_retiming_that_the_validator_refuses_is_not_sent(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(runtime._Walk, "_accept", lambda self, section: False)
    record = runtime.walk(TWO, Tap(2), override=0.5)
    assert record.result is Result.REFUSED
    assert record.sections == ()
    assert sum(record.steps) == 0
    record = runtime.walk(TWO, Tap(2), hold_at=TWO.stream.sections[0].duration + 10)
    assert record.result is Result.REFUSED
    assert [s.number for s in record.sections] == [0]
    control = Control()
    record = run(TWO, Tap(2), control=control, on_progress=at_part(0.3, control.hold))
    assert record.result is Result.EMERGENCY_STOP
    assert "stream checker" in record.reason


def test_gentler_ramps_are_tried_when_one_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[object] = []

    def third(self, section) -> bool:
        asked.append(section)
        return len(asked) >= 3

    monkeypatch.setattr(runtime._Walk, "_accept", third)
    record = run(TWO, Tap(2), hold_at=100_000)
    assert record.result is Result.COMPLETED
    assert len(asked) == 3


def test_a_section_without_overrides_keeps_its_speed() -> None:
    fixed = job([(5.0, 0.0)], overrides=False)
    record = run(fixed, Tap(2), override=0.5)
    assert record.sections[0].ticks == fixed.stream.sections[0].duration
    assert record.sections[0].retimings == ()
    with pytest.raises(ValueError, match="override"):
        runtime.walk(fixed, Tap(2), override=1.2)


def test_a_board_that_does_not_fit_moves_nothing() -> None:
    for board in (Tap(3), VirtualBoard(2, tick_frequency=5), Tap(2)):
        if isinstance(board, Tap) and board._is.motors == 2:
            board._is = dataclasses.replace(board._is, step_pulse=3, direction_setup=6)
        with pytest.raises(RunRefused) as refused:
            runtime.walk(TWO, board)
        assert {f.code.number for f in refused.value.findings} == {823}


class Broken(Tap):
    """A board whose line breaks after some calls."""

    calls = 60

    def commit(self, tick: int | None) -> None:
        self.calls -= 1
        if self.calls < 0:
            raise BoardError("the line is dead")
        super().commit(tick)


def test_a_broken_line_ends_in_a_truthful_record() -> None:
    board = Broken(2, fifo_runs=40)
    record = run(TWO, board)
    assert record.result is Result.FAULT
    assert "line is dead" in record.reason
    assert 0 < sum(record.steps) < TWO.stream.steps()


def test_an_unexpected_error_stops_the_board() -> None:
    board = Tap(2)

    def oops() -> None:
        raise RuntimeError("progress bar broke")

    with pytest.raises(RunFailed) as failed:
        runtime.walk(TWO, board, on_progress=at_part(0.3, oops))
    record = failed.value.record
    assert record.result is Result.FAULT
    assert "progress bar broke" in record.reason
    assert record.steps == board.status().steps
    assert list(problems(record, TWO)) == []
    assert board.status().steps != (0, 0)
    assert sum(board.status().steps) < TWO.stream.steps()


def test_real_time_keeps_the_time() -> None:
    short = job([(4.0, 1.0)])
    seconds = short.stream.sections[0].duration / FREQUENCY
    begin = time.monotonic()
    record = run(short, Tap(2, real_time=True, speed=0.5, fifo_runs=50_000))
    taken = time.monotonic() - begin
    assert record.result is Result.COMPLETED
    assert 2 * seconds < taken < 2 * seconds + 20


def test_a_feed_hold_in_real_time_goes_on_feeding_while_it_is_worked_out() -> None:
    long = job([(30.0, 9.0), (0.0, 0.0)])
    control = Control()
    timer = threading.Timer(0.3, control.hold)
    timer.start()
    record = run(
        long, Tap(2, real_time=True, speed=0.5, fifo_runs=50_000), control=control, operator=AutoContinue(resume=True)
    )
    assert record.result is Result.COMPLETED
    assert [r.kind for r in record.sections[0].retimings] == ["hold"]
    assert merged(long.stream.sections[0])
