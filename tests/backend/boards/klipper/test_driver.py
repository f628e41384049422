"""The driver on a board that is not there: sections, stops, losses, long rests, outputs."""

import copy
import json
import random
import zlib
from collections.abc import Callable
from dataclasses import replace

import pytest
from backend.boards.klipper.fake_peer import DICTIONARY, REASONS, FakePeer
from backend.jobs import job
from backend.streams import runs_of, steps_of

from gproof.backend.boards.board import BoardError, BoardState, EventDone, Known
from gproof.backend.boards.klipper.driver import KlipperBoard
from gproof.backend.boards.klipper.wiring import MotorPins, OutputPin, Wiring
from gproof.backend.feed import Feeder, Words
from gproof.backend.record_data import TRUSTED, Result
from gproof.backend.runtime import walk
from gproof.ir.stream import StreamSection

TICKS = 16_000_000
PINS = Wiring(
    motors=[MotorPins(step="PA0", direction="PA1"), MotorPins(step="PA2", direction="PA3", inverted_direction=True)]
)


def opened(peer: FakePeer, wiring: Wiring = PINS) -> KlipperBoard:
    board = KlipperBoard(lambda: peer, wiring)
    board.open()
    return board


def edges(peer: FakePeer, base: int) -> list[list[tuple[int, int]]]:
    """Steps by motor as (tick of the section, direction in the stream); the second motor's pin is inverted."""
    return [[(t - base, d * sign) for t, d in peer.steppers[k].edges] for k, sign in ((0, 1), (1, -1))]


ROWS = (
    [(20_000, 100, 3, 1), (20_000, 10, 0, -1), (700, 3000, 1, -1), (9_000, 5, -100, 1)],
    [(30_000, 50, -3, -1), (400, 2000, 2, 1)],
)
TABLES = [runs_of(rows) for rows in ROWS]
STEPS = [steps_of(runs) for runs in TABLES]
END = tuple(sum(d for _, d in steps) for steps in STEPS)


def sent(board: KlipperBoard, start: tuple[int, ...] = (5, 7), duration: int = 10_000_000) -> int:
    """Everything of a section at once."""
    base = board.start_section(0, start, 800_000)
    for motor, runs in enumerate(TABLES):
        board.queue_runs(motor, runs)
    board.finish_section(duration)
    return base


def test_a_section_makes_its_steps_on_their_ticks() -> None:
    peer = FakePeer()
    board = opened(peer)
    base = sent(board)
    assert board.status().state is BoardState.RUNNING
    board.wait(base + 10_000_000)
    board.wait(base + 10_100_000)
    status = board.status()
    assert status.state is BoardState.IDLE
    assert status.known is Known.EXACT
    assert status.position == (5 + END[0], 7 + END[1])
    assert status.steps == tuple(map(len, STEPS))
    assert status.accepted == (4, 2)
    assert status.free == 678
    assert edges(peer, base) == STEPS
    assert peer.shutdown is None
    # The next section starts where this one ended, and nowhere else.
    with pytest.raises(BoardError, match="starts at"):
        board.start_section(1, (5, 7), 0)
    base = sent(board, status.position)
    board.wait(base + 11_000_000)
    assert board.status().position == (5 + 2 * END[0], 7 + 2 * END[1])
    board.close()
    # Positions and configuration outlive the connection.
    assert board.open().motors == 2
    with pytest.raises(BoardError, match="starts at"):
        board.start_section(1, (5, 7), 0)
    board.start_section(1, (5 + 2 * END[0], 7 + 2 * END[1]), 0)


def test_runs_go_out_in_the_order_in_which_they_are_due() -> None:
    peer = FakePeer()
    board = opened(peer)
    base = board.start_section(0, (0, 0), 0)
    board.queue_runs(0, runs_of([(10_000, 10, 0, 1)] * 40))
    board.queue_runs(1, runs_of([(10_500, 10, 0, 1)] * 40))
    board.commit(None)
    board.wait(base + 5_000_000)
    motors = [args[0] for name, args in peer.commands if name == "queue_step"]
    assert motors[:8] == [0, 1] * 4
    assert len(motors) == 80


def test_steps_that_are_stated_have_been_made() -> None:
    peer = FakePeer(rate=16e6 * (1 + 150e-6))
    board = opened(peer)
    base = sent(board, (0, 0))
    for k in range(60):
        board.wait(base + k * 150_000)
        status = board.status()
        assert status.tick <= peer.clock()
        made = peer.made()
        assert all(a <= b for a, b in zip(status.steps, made, strict=True))
        if status.state is BoardState.RUNNING:
            assert all(a >= b for a, b in zip(status.most, made, strict=True))
        assert status.position == tuple(
            sum(d for _, d in steps[:n]) for steps, n in zip(STEPS, status.steps, strict=True)
        )


def test_an_emergency_stop_leaves_exact_positions_and_the_board_usable() -> None:
    peer = FakePeer()
    board = opened(peer)
    base = sent(board)
    board.wait(base + 3_000_000)
    board.emergency_stop()
    status = board.status()
    made = peer.made()
    assert (status.state, status.known) == (BoardState.STOPPED, Known.EXACT)
    assert status.steps == made
    assert status.position == tuple(s + sum(d for _, d in e) for s, e in zip((5, 7), edges(peer, base), strict=True))
    assert 3_000_000 <= (status.stopped_at or 0) - base < 3_200_000
    names = [name for name, _ in peer.commands]
    assert names.count("emergency_stop") == names.count("clear_shutdown") == 1
    board.queue(0, 1000, 1, 0, 1)
    board.commit(5)
    board.emergency_stop()
    assert board.status() == status
    board.open()
    board.start_section(1, status.position, 0)
    assert peer.crc is not None


@pytest.mark.parametrize("reason", ["Timer too close", "Move queue overflow"])
def test_a_shutdown_of_the_board_is_a_state_with_its_reason(reason: str) -> None:
    peer = FakePeer()
    board = opened(peer)
    base = sent(board)
    board.wait(base + 3_000_000)
    peer.stop(reason)
    board.wait(base + 3_500_000)
    status = board.status()
    assert status.state is (BoardState.UNDERRUN if reason == "Timer too close" else BoardState.FAULT)
    assert reason in status.reason
    assert status.steps == peer.made()
    assert peer.shutdown is None


def test_a_shutdown_that_was_there_before_is_left_and_none_is_not() -> None:
    peer = FakePeer()
    peer.shutdown = REASONS["Timer too close"]
    opened(peer)
    opened(peer)
    assert [name for name, _ in peer.commands].count("clear_shutdown") == 1
    assert peer.shutdown is None


def test_a_host_that_slept_stops_rather_than_send_late() -> None:
    peer = FakePeer()
    board = opened(peer)
    base = board.start_section(0, (0, 0), 0)
    board.queue(0, 10_000, 100, 0, 1)
    board.commit(1_000_000)
    board.wait(base + 500_000)
    peer.read(peer.t + 0.2)
    board.queue(1, 1_200_000, 100, 0, 1)
    status = board.status()
    assert status.state is BoardState.UNDERRUN
    assert status.steps == (100, 0)
    assert "promised" in status.reason
    assert not peer.steppers[1].edges


def test_a_line_that_is_cut_is_a_state_with_bounds_and_found_again() -> None:
    peer = FakePeer()
    board = opened(peer)
    base = sent(board)
    board.wait(base + 3_000_000)
    peer.open = False
    board.wait(base + 3_500_000)
    status = board.status()
    made = peer.made()
    assert (status.state, status.known) == (BoardState.LOST, Known.BETWEEN)
    assert all(a <= b <= c for a, b, c in zip(status.steps, made, status.most, strict=True))
    assert status.most == tuple(map(len, STEPS))
    peer.open = True
    found = board.find()
    made = peer.made()
    assert (found.state, found.known, found.steps) == (BoardState.STOPPED, Known.EXACT, made)
    assert board.find() == found


def test_a_board_that_was_reset_meanwhile_does_not_know() -> None:
    peer = FakePeer()
    board = opened(peer)
    base = sent(board)
    board.wait(base + 3_000_000)
    made = peer.made()
    peer.reset()
    board.wait(base + 40_000_000)
    found = board.find()
    assert (found.state, found.known) == (BoardState.LOST, Known.UNKNOWN)
    assert all(a <= b <= c for a, b, c in zip(found.steps, made, found.most, strict=True))
    assert board.status().state is BoardState.LOST
    # Opened anew it is told where it is, as after power-up.
    board.open()
    board.start_section(0, (1, 2), 0)


def test_a_long_rest_gets_a_new_clock_base() -> None:
    peer = FakePeer()
    board = opened(peer)
    is_ = board.open()
    long = 2**31 + 12_345
    section = StreamSection(
        number=0,
        start=(0, 0),
        runs=(runs_of([(20_000, 3, 0, 1), (long, 1, 5, 1), (500, 4, 0, -1)]), runs_of([(2**31, 1, 0, 1)])),
        events=job([(1.0, 0.0)]).stream.sections[0].events.slice(0, 0),
        duration=long + 1_000_000,
    )
    feeder = Feeder(section, Words.of(is_))
    base = board.start_section(0, (0, 0), 0)
    while (due := feeder.next_due) is not None:
        now = board.status().tick - base
        feeder.fill(board, board.status().free, now + 4_000_000)
        board.commit((feeder.next_due or due + 1) - 1)
        board.wait(base + (feeder.next_due or now) - 2_000_000)
    board.finish_section(section.duration)
    board.wait(base + section.duration + 100_000)
    assert board.status().state is BoardState.IDLE, board.status().reason
    assert edges(peer, base) == [steps_of(runs) for runs in section.runs]
    assert all(args[1] < 2**31 for name, args in peer.commands if name == "queue_step")


def test_outputs_switch_at_their_tick_and_enable_with_the_board() -> None:
    wiring = Wiring(
        motors=PINS.motors,
        outputs={"spindle": OutputPin(pin="PB0"), "enable": OutputPin(pin="PB1", inverted=True, while_open=True)},
        switches={(11, 1000): (("spindle", True),)},
    )
    peer = FakePeer()
    board = opened(peer, wiring)
    base = board.start_section(0, (0, 0), 0)
    board.queue_event(50_000, 3, 11, (1000, 0))
    board.queue_event(60_000, 4, 12, (1000, 0))
    board.finish_section(100_000)
    board.wait(base + 200_000)
    assert board.take_events() == [EventDone(base + 50_000, 3, 11), EventDone(base + 60_000, 4, 12)]
    assert board.status().state is BoardState.IDLE
    board.close()
    assert peer.outputs[1] == (2, base + 50_000, 1)
    # The spindle is off and the drive is not enabled when the host has gone.
    assert [(oid, on) for oid, _, on in peer.outputs] == [(3, 0), (2, 1), (2, 0), (3, 1)]


@pytest.mark.parametrize("seed", range(6))
def test_a_line_that_spoils_bytes_changes_no_step(seed: int) -> None:
    rng = random.Random(seed)

    def spoil(data: bytes, _: bool) -> bytes:
        if not data or rng.random() > 0.04:
            return data
        at = rng.randrange(len(data))
        match rng.randrange(4):
            case 0:
                return data[:at] + data[at + 1 :]
            case 1:
                return data[:at] + bytes([data[at] ^ 1 << rng.randrange(8)]) + data[at + 1 :]
            case 2:
                return data[:at] + data[at:] * 2
            case _:
                return b""

    peer = FakePeer(spoil=spoil)
    board = opened(peer)
    base = board.start_section(0, (5, 7), 16_000_000)
    for motor, runs in enumerate(TABLES):
        board.queue_runs(motor, runs)
    board.finish_section(10_000_000)
    board.wait(base + 12_000_000)
    status = board.status()
    if status.state is BoardState.IDLE:
        assert edges(peer, base) == STEPS
    else:
        assert status.known is Known.EXACT or status.state is BoardState.LOST
        for made, whole in zip(edges(peer, base), STEPS, strict=True):
            assert made == whole[: len(made)]


def refuses(peer: FakePeer, wiring: Wiring, match: str) -> None:
    with pytest.raises(BoardError, match=match) as error:
        opened(peer, wiring)
    assert "\n" not in str(error.value)
    assert not any(name == "queue_step" for name, _ in peer.commands)


def changed(change: Callable[[dict[str, dict[str, int]]], object]) -> FakePeer:
    told = copy.deepcopy(DICTIONARY)
    change(told)  # type: ignore[arg-type]
    peer = FakePeer()
    peer.dictionary = zlib.compress(json.dumps(told).encode())
    return peer


def test_boards_that_will_not_do_are_refused_with_one_line() -> None:
    mute = FakePeer()
    mute.answering = False
    refuses(mute, PINS, "nobody answers")
    noise = FakePeer(spoil=lambda data, there: data if there else b"\x55" * len(data))
    refuses(noise, PINS, "Klipper's protocol")
    refuses(FakePeer(places=1), PINS, "too few for 2 motors")
    refuses(FakePeer(), Wiring(motors=[MotorPins(step="PA0", direction="PZ9")]), "no pin PZ9")
    refuses(FakePeer(), Wiring(motors=[MotorPins(step="PA0", direction="PA0")]), "also a pin of")
    refuses(changed(lambda d: d["commands"].pop("reset_step_clock oid=%c clock=%u")), PINS, "reset_step_clock")
    refuses(changed(lambda d: d["config"].pop("CLOCK_FREQ")), PINS, "CLOCK_FREQ")
    refuses(changed(lambda d: d["config"].update(GPROOF_CERT=2)), PINS, "version 2 of the extension, and 1 is known")
    refuses(FakePeer(rate=20e6), PINS, "another rate")
    configured = FakePeer()
    opened(configured)
    refuses(configured, Wiring(motors=PINS.motors[:1]), "configured for another machine")


def test_the_runtime_runs_a_job_on_it() -> None:
    certified = replace(
        job([(1.0, 0.5), (0.0, 1.0)], [(2.0, 2.0)]), accepted=TRUSTED, machine_at_hand=True, setup_at_hand=True
    )
    peer = FakePeer(rate=1e6 * (1 - 150e-6))
    told = {**DICTIONARY, "config": {"CLOCK_FREQ": 1_000_000}}
    peer.dictionary = zlib.compress(json.dumps(told).encode())
    wiring = Wiring(motors=[MotorPins(step=f"PA{2 * k}", direction=f"PA{2 * k + 1}") for k in range(2)])
    record = walk(certified, KlipperBoard(lambda: peer, wiring, pulse=2, direction_setup=5))
    assert record.result is Result.COMPLETED, record.reason
    assert record.sections[-1].position == certified.stream.sections[-1].end()
    for k in range(2):
        made = [d for _, d in peer.steppers[k].edges]
        assert made == [d for s in certified.stream.sections for _, d in steps_of(s.runs[k])]
