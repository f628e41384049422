"""The host on the board emulator, which shares nothing with it: what it claims against the emulator's own log."""

from __future__ import annotations

import random
import subprocess
import sys
from collections import Counter

import pytest
from backend.boards.klipper.emulated_line import MOTORS, SECOND, TICKS, WIRING, EmulatedLine, feed, section_of
from backend.streams import runs_of, steps_of
from support.campaigns import sizes

from gproof.backend.boards.board import BoardError, BoardState, Known, Status
from gproof.backend.boards.emulator.emulator import Options
from gproof.backend.boards.emulator.faults import QUIET, Fault, Noise
from gproof.backend.boards.klipper import driver
from gproof.backend.boards.klipper.driver import KlipperBoard
from gproof.backend.boards.klipper.executed import RunSum
from gproof.backend.boards.klipper.lines import SerialLine
from gproof.backend.feed import Words
from gproof.ir.columns import Columns

IDENTITY = bytes(range(32))


def random_tables(rng: random.Random, most: int = 200) -> list[Columns]:
    """Runs of about a second."""
    return [
        runs_of(
            [
                (rng.randrange(16_000, 40_000), rng.randrange(1, 30), rng.randrange(-300, 300), rng.choice((1, 1, -1)))
                for _ in range(rng.randrange(most // 4, most))
            ]
        )
        for _ in range(MOTORS)
    ]


def test_the_sum_of_executed_runs_is_the_one_of_the_vector() -> None:
    made = RunSum(IDENTITY, 7)
    sums = [made.crc]
    made.base(0)
    sums.append(made.crc)
    made.run(2000, 2, 10, 1)
    sums.append(made.crc)
    made.run(2020, 1, 10, 1)
    made.run(2030, 2, 10, 1)
    sums.append(made.crc)
    made.run(5000, 1, 0, 0)
    assert [*sums, made.crc] == [0x24CED456, 0x90ADB27D, 0x8028D150, 0x458FEFDE, 0x8E12422E]


@pytest.mark.parametrize("certified", [False, True])
def test_every_step_is_made_on_its_tick(certified: bool) -> None:
    line = EmulatedLine(Options(certified=certified, drift=-180_000, jitter=300_000, start=2**32 - 10_000_000))
    board = KlipperBoard(line.connect, WIRING)
    words = Words.of(board.open())
    board.present(IDENTITY)
    tables = random_tables(random.Random(3), 150)
    steps = [steps_of(runs) for runs in tables]
    bases: list[int] = []
    status = feed(board, section_of(tables, max(s[-1][0] for s in steps) + 50), words, base=bases.append)
    assert status.state is BoardState.IDLE, status.reason
    assert line.made(bases[0]) == steps
    assert status.steps == tuple(map(len, steps))
    assert len(board.executed()) == MOTORS * certified


def test_without_an_identity_no_motor_moves() -> None:
    line = EmulatedLine(Options())
    board = KlipperBoard(line.connect, WIRING)
    words = Words.of(board.open())
    status = feed(board, section_of([runs_of([(20_000, 5, 0, 1)])] * MOTORS, 200_000), words)
    assert status.state is BoardState.FAULT
    assert "Not certified" in status.reason
    assert not any(line.made(0))


def test_a_dwell_longer_than_the_clock_has_bits() -> None:
    line = EmulatedLine(Options())
    board = KlipperBoard(line.connect, WIRING)
    words = Words.of(board.open())
    board.present(IDENTITY)
    long = 2**32 + 2**31 + 7
    table = runs_of([(20_000, 2, 0, 1), (long, 1, 0, -1), (2**31, 2, 0, -1), (900, 3, 0, -1)])
    bases: list[int] = []
    section = section_of([table, runs_of([(long, 1, 0, 1)])] * 2, long + 2**32 + 1_000_000)
    status = feed(board, section, words, pause=TICKS, base=bases.append)
    assert status.state is BoardState.IDLE, status.reason
    assert line.made(bases[0]) == [steps_of(table), [(long, 1)]] * 2


BYTES = ("drop", "flip", "double")
KINDS = (*BYTES, "delay", "close", "stall", "shutdown", "reset", "brown-out", "host sleeps", "emergency stop", "noise")


def spoiled(rng: random.Random, kind: str, seed: int) -> Options:
    """A board with one fault after motion began, or a noisy line."""
    amounts = {
        "close": rng.randrange(SECOND // 100, 5 * SECOND),
        "stall": rng.randrange(SECOND // 100, SECOND),
        "brown-out": rng.randrange(SECOND // 100, 2 * SECOND),
        "delay": rng.randrange(1, SECOND // 2),
    }
    noise, faults = QUIET, []
    if kind == "noise":
        noise = Noise(**{rng.choice(BYTES): 10 ** rng.uniform(-5, -2.3)})
    elif not kind.startswith(("host", "emergency")):
        to = rng.choice(("to-board", "to-host")) if kind in (*BYTES, "delay") else ""
        amount = rng.randrange(1, 400) if kind in BYTES else amounts.get(kind, 0)
        faults = [Fault(rng.randrange(2 * SECOND), True, kind, amount, to)]
    return Options(
        certified=rng.random() < 0.5,
        drift=rng.randrange(-200_000, 200_001),
        jitter=rng.choice((0, 200_000, 2_000_000)),
        start=rng.choice((0, 2**32 - TICKS, 2**40)),
        seed=seed,
        noise=noise,
        faults=tuple(faults),
    )


def one(seed: int) -> tuple[str, str]:
    """One schedule: what it was, and how the run ended; what the host claims holds."""
    rng = random.Random(seed)
    kind = KINDS[seed % len(KINDS)]
    line = EmulatedLine(spoiled(rng, kind, seed))
    board = KlipperBoard(line.connect, WIRING)
    try:
        words = Words.of(board.open())
    except BoardError:
        return kind, "not opened"
    board.present(rng.randbytes(32))
    tables = random_tables(rng)
    steps = [steps_of(runs) for runs in tables]
    duration = max(s[-1][0] for s in steps) + 50
    at, rounds, bases = rng.randrange(duration), 0, []

    def each(status: Status, now: int) -> None:
        nonlocal at, rounds
        rounds += 1
        assert rounds < 4000, "it does not end"
        if rounds % 40 == 0:
            assert all(n <= len(m) for n, m in zip(status.steps, line.made(0), strict=True)), "a step is claimed"
        if kind == "emergency stop" and now >= at:
            board.emergency_stop()
        elif kind == "host sleeps" and now >= at:
            at = duration * 100
            line.pass_time(rng.uniform(0.1, 5))

    try:
        status = feed(board, section_of(tables, duration), words, base=bases.append, each=each)
    except BoardError:
        assert not any(line.made(0))
        return kind, "not started"
    lost = status.state is BoardState.LOST
    if lost:
        status = board.find()
    line.pass_time(10.0)
    made = line.made(bases[0])
    assert all(m == s[: len(m)] for m, s in zip(made, steps, strict=True)), "another step"
    counts = [len(m) for m in made]
    if status.state is BoardState.IDLE:
        assert counts == [len(s) for s in steps]
    most = status.most or status.steps
    assert all(a <= n <= b for a, n, b in zip(status.steps, counts, most, strict=True)), "steps are claimed"
    if status.known is Known.EXACT:
        assert status.position == tuple(sum(d for _, d in m) for m in made), "the position is claimed"
    return kind, f"{'lost, then ' if lost else ''}{status.state.value}, position {status.known.value}"


@pytest.mark.parametrize("schedules", sizes(24, 2000))
def test_what_is_claimed_after_a_fault_holds(schedules: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(driver.time, "sleep", lambda _: None)
    outcomes: Counter[tuple[str, str]] = Counter()
    for seed in range(schedules):
        try:
            outcomes[one(seed)] += 1
        except AssertionError as error:
            raise AssertionError(f"schedule {seed}: {error}") from error
    for (kind, outcome), count in sorted(outcomes.items()):
        print(f"{kind:16}{outcome:40}{count:6}")
    assert {kind for kind, _ in outcomes} == set(KINDS)


def test_through_a_serial_port_of_another_process() -> None:
    command = [sys.executable, "-m", "gproof.backend.boards.emulator", "--drift", "150", "--linger", "1"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            port = process.stdout.readline().partition(": ")[2].strip()
            board = KlipperBoard(lambda: SerialLine(port), WIRING, baud=250_000)
            is_ = board.open()
            assert (is_.identity, is_.fifo_runs, is_.watched, is_.link_rate) == ("atmega2560", 678, True, 25_000)
            if "://" not in port:
                with pytest.raises(BoardError, match="another program uses it"):
                    SerialLine(port)
            board.present(IDENTITY)
            tables = [runs_of([(40_000, 100, 0, 1), (40_000, 50, 10, -1)])] * MOTORS
            status = feed(board, section_of(tables, 6_100_000), Words.of(is_))
            assert (status.state, status.position) == (BoardState.IDLE, (50,) * MOTORS), status.reason
            board.close()
        finally:
            process.kill()
    with pytest.raises(BoardError, match=r"no such port|cannot be opened"):
        SerialLine(port)
