"""The whole runtime on a faulty link, judged by the board's own log; the table of outcomes is printed (-s)."""

from __future__ import annotations

import copy
import random
import time
from collections.abc import Callable
from dataclasses import replace

import pytest
from backend.boards.emulator.emulated_line import EmulatedLine, FrailHost
from backend.boards.emulator.link_campaign import (
    OF_BOARD,
    OF_HOST,
    PINS,
    WIRING,
    Schedule,
    jobs,
    judged,
    outcome_table,
    proved,
    ran,
    table,
)  # fmt: skip
from backend.streams import FREQUENCY
from support.campaigns import sizes

from gproof.backend.boards.emulator.emulator import Emulator, Options
from gproof.backend.boards.emulator.log_reader import Told, read
from gproof.backend.boards.klipper.connection import Connection
from gproof.backend.boards.klipper.driver import KlipperBoard
from gproof.backend.boards.klipper.wiring import OutputPin
from gproof.backend.control import Control
from gproof.backend.job import CertifiedJob
from gproof.backend.operators import AutoContinue, HoldRequest
from gproof.backend.record import parse_record, problems
from gproof.backend.record_data import ExecutionRecord, Result
from gproof.backend.record_proof import Proof, proofs
from gproof.backend.runtime import Hold, walk
from gproof.ir.machine import Pin, WiredOutput


@pytest.mark.parametrize("count", sizes(24, 5000))
def test_no_fault_makes_a_wrong_step_or_a_record_that_claims_one(count: int) -> None:
    found = {certified: table(range(count), certified=certified) for certified in (False, True)}
    print(f"\n{2 * count} schedules\n\n" + "\n".join(outcome_table(found[False] + found[True])))
    if count >= 1000:
        wanted = {" ".join(kind.split()[: 2 if "to-" in kind else 1]) for kind in OF_BOARD if kind} | {*OF_HOST}
        assert {name for counts in found.values() for name, _ in counts} >= wanted


def once(at: float, request: Callable[[], None]) -> Callable[[float], None]:
    """Makes a request when so much is done."""
    left = [request]
    return lambda part: left.pop()() if left and part >= at else None


class Held(AutoContinue):
    """Continues after a feed hold, or not."""

    def __init__(self, resume: bool) -> None:
        self.resume = resume

    def held(self, request: HoldRequest) -> bool:
        return self.resume


@pytest.mark.parametrize("many", sizes(8, 400))
def test_feed_holds_and_overrides_end_as_asked_and_every_step_is_proved(many: int) -> None:
    for seed in range(many):
        chance = random.Random(seed)
        one, control = jobs()[seed % len(jobs())], Control()
        at, resume = chance.random(), chance.random() < 0.7
        planned = [Hold(at=chance.randrange(500_000), rest=chance.randrange(1000, 50_000)) for _ in range(seed % 3)]
        board = Emulator(Options(frequency=FREQUENCY, baud=1_000_000))
        record = walk(
            one,
            KlipperBoard(EmulatedLine(board).connect, WIRING, pulse=2, direction_setup=5),
            operator=Held(resume),
            control=control,
            on_progress=once(at, control.hold),
            hold_at=planned,
            override=chance.choice([1, 0.5, 0.33]),
        )
        board.advance(board.now + 10**10)
        board.finish()
        told = read(board.log.held)
        assert record.result in (Result.COMPLETED, Result.STOPPED), (seed, record.reason)
        assert resume <= (record.result is Result.COMPLETED), seed
        assert list(record.steps) == [len(told.steps.of(pin)[0]) for pin in PINS], seed
        proved(one, record, list(record.steps))
        assert all(known.proof is Proof.PROVED for known in proofs(record, one)), seed


MISTED = replace(WIRING, outputs={"mist": OutputPin(pin="PB0")})
"""What the jobs switch has a pin: where the operator does it, a section rests, and no override changes before that."""


def wired(one: CertifiedJob) -> CertifiedJob:
    """A job for a machine with these pins."""
    board = replace(one.machine.board, outputs=(WiredOutput(output="mist", pin=Pin(name="PB0")),))
    return replace(one, machine=replace(one.machine, board=board))


REST = 0.003
"""Seconds of a report of progress."""


@pytest.mark.parametrize("many", sizes(6, 200))
def test_an_override_that_changes_on_the_way_is_made_and_every_step_is_proved(many: int) -> None:
    """The board's clock goes on while a change is worked out: what is not sent by then comes at the new rate."""
    made = 0
    for seed in range(many):
        chance, control, told = random.Random(seed), Control(), []
        wishes = sorted((chance.random() * 0.6, chance.choice([0.1, 0.3, 0.5, 1])) for _ in range(3))

        def wish(part: float, wishes: list = wishes, control: Control = control) -> None:
            while wishes and part >= wishes[0][0]:
                control.override(wishes.pop(0)[1])
            # Simulated time waits for nobody: without a rest now and then a run is over before a change is worked out.
            time.sleep(REST)

        one, board = wired(jobs()[seed % len(jobs())]), Emulator(Options(frequency=FREQUENCY, baud=1_000_000))
        record = walk(
            one,
            KlipperBoard(EmulatedLine(board).connect, MISTED, pulse=2, direction_setup=5),
            control=control,
            on_progress=wish,
            on_override=lambda factor, seconds, told=told: told.append((factor, seconds)),
            override=chance.choice([1, 0.5, 0.2]),
        )
        board.finish()
        log = read(board.log.held)
        assert record.result is Result.COMPLETED, (seed, record.reason)
        assert list(record.steps) == [len(log.steps.of(pin)[0]) for pin in PINS], seed
        proved(one, record, list(record.steps))
        assert all(known.proof is Proof.PROVED for known in proofs(record, one)), seed
        assert all(seconds is not None for _, seconds in told), (seed, told)
        made += sum(r.kind == "change" for section in record.sections for r in section.retimings)
    assert made


def test_a_board_that_lost_step_is_found() -> None:
    for rubbish in (b"\xff\xff\xff", b"\x20\x10", b"\x7e\x00", bytes(range(200))):
        board = Emulator(Options())
        board.write(rubbish)
        board.advance(10**9)
        connection = Connection(EmulatedLine(board), lambda _: None)
        connection.synchronise()
        assert connection.identify().version


def calm(one: CertifiedJob, *, certified: bool) -> tuple[Told, ExecutionRecord]:
    """A job without a fault."""
    (run,) = ran(one, Schedule("none", Options(certified=certified, frequency=FREQUENCY, baud=1_000_000), FrailHost()))
    assert run.record is not None and run.record == run.from_journal
    return run.told, run.record


def test_the_judge_sees_what_is_wrong() -> None:
    one = jobs()[0]
    told, record = calm(one, certified=False)
    assert judged(one, told, record) == "completed, position known"
    late, turned, extra = (copy.deepcopy(told) for _ in range(3))
    late.steps.tick[100] += 1
    turned.steps.direction[100] *= -1
    for name in ("motor", "tick", "direction", "boot"):
        column = getattr(extra.steps, name)
        setattr(extra.steps, name, column[[*range(len(column)), len(column) - 1]])
    claimed = replace(record, steps=(record.steps[0] + 1, record.steps[1]))
    moved = replace(record, position=(1, 1))
    for log, told_record, why in (
        (late, record, "not at their ticks"),
        (turned, record, "a wrong direction"),
        (extra, record, "does not have"),
        (told, claimed, "were claimed"),
        (told, moved, "not that of the board"),
    ):
        with pytest.raises(AssertionError, match=why):
            judged(one, log, told_record)


def test_a_count_or_crc_that_the_stream_does_not_give_is_seen() -> None:
    one = jobs()[0]
    told, record = calm(one, certified=True)
    assert judged(one, told, record) == "completed, position known"
    assert all(known.proof is Proof.PROVED for known in proofs(record, one))
    first = record.sections[0]
    x, y = first.executed
    for what, executed in {
        "another CRC": (replace(x, crc=x.crc ^ 1), y),
        "another count": (replace(x, steps=x.steps - 1), y),
        "exchanged": (y, x),
        "one motor": (x,),
    }.items():
        forged = replace(record, sections=(replace(first, executed=executed), *record.sections[1:]))
        assert parse_record(forged.to_json()) == forged, what
        assert list(problems(forged, one)), what
    other = replace(record, board=replace(record.board, counting=replace(record.board.counting, levels=(0, 1))))
    assert list(problems(other, one))
    silent = replace(record, sections=tuple(replace(section, executed=()) for section in record.sections))
    assert not list(problems(silent, one))
    assert {known.proof for known in proofs(silent, one)} == {Proof.ACKNOWLEDGED}


def test_a_host_that_slept_reads_first_and_then_judges() -> None:
    for where in ("before it writes", "before it reads", "after it has read"):
        line, heard = EmulatedLine(Emulator(Options())), []
        connection = Connection(line, heard.append)
        connection.synchronise()
        connection.identify()
        connection.pump(line.now() + 0.01)
        connection.send("get_uptime")
        if where != "before it writes":
            connection.pump(line.now())
        # In the middle of an answer on the line, or before anything is on it.
        line.stalls.append((line.now() + (0.0001 if where == "after it has read" else 0), 5.0))
        for _ in range(3):
            connection.pump(line.now() + 0.002)
        assert [answer.name for answer in heard] == ["uptime"], where


def test_a_host_that_slept_for_long_in_a_section_knows_where_its_motors_are() -> None:
    for k in range(8):
        plan = Schedule("", Options(frequency=FREQUENCY, baud=1_000_000, certified=k % 2 == 0), FrailHost())
        plan.stalls.append((0.4 + 0.2 * k, 5.0))
        (run,) = ran(jobs()[k % 2], plan)
        assert run.record is not None, k
        assert run.record.position is not None, (k, run.record.reason)
        assert not any(section.losses for section in run.record.sections), (k, run.record.reason)
        judged(run.job, run.told, run.record)


@pytest.mark.parametrize("made", [False, True])
def test_a_section_that_a_host_left_is_none_of_the_next_one(made: bool) -> None:
    """The board rests in a section of the same stream and number; what it made there is nobody's of the next run."""
    one = jobs()[0]
    emulator = Emulator(Options(frequency=FREQUENCY, baud=1_000_000))
    line = EmulatedLine(emulator)
    first = KlipperBoard(line.connect, WIRING, pulse=2, direction_setup=5)
    first.open()
    first.present(bytes.fromhex(one.certificate))
    section = one.stream.sections[0]
    base = first.start_section(0, section.start, 1000)
    if made:
        for motor, runs in enumerate(section.runs):
            first.queue_runs(motor, runs)
    first.commit(None)
    first.wait(base + section.duration + 1000)
    emulator.finish()
    before = [len(read(emulator.log.held).steps.of(pin)[0]) for pin in PINS]
    assert (sum(before) > 0) == made
    record = walk(one, KlipperBoard(EmulatedLine(emulator).connect, WIRING, pulse=2, direction_setup=5))
    emulator.finish()
    now = [len(read(emulator.log.held).steps.of(pin)[0]) for pin in PINS]
    assert list(record.steps) == [b - a for a, b in zip(before, now, strict=True)]
    assert record.result is Result.COMPLETED
    proved(one, record, list(record.steps))
