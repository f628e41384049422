"""The reference firmware on a simulated ATmega328P and ATmega2560: messages, pin edges, counts and CRCs.

Expected ticks and CRCs are worked out here from docs/boards.md, not by code of the firmware or the host.
"""

from __future__ import annotations

import time
import zlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from support.campaigns import seeds
from support.simulated_board import HZ, MISSING, Answer, Board, Client, block, build_runner, crc16, vlq

from gproof.backend.firmware import CHIPS, build, image

pytestmark = pytest.mark.skipif(bool(MISSING), reason=MISSING)

EARLIEST, LATEST = -64, 640
"""Cycles of 16 MHz in which an edge comes about its tick, at up to 20,000 steps a second of all motors."""
STEP_PINS, DIRECTION_PINS = ("PB0", "PB2", "PC0", "PC2"), ("PB1", "PB3", "PC1", "PC3")
OUTPUT, INPUT = "PD4", "PD5"
IDENTITY = bytes(range(32))
FLASH, RAM = 28 * 1024, 1800
RAM_OF_CHIP = {"328p": 2048, "2560": 8192}

Start = Callable[..., Board]


@dataclass(frozen=True)
class Run:
    """A run of steps as queue_step has it; forward: counts up."""

    interval: int
    count: int
    add: int = 0
    forward: bool = True

    def ticks(self, last: int) -> np.ndarray:
        """Ticks of its steps after the motor's last one."""
        return last + np.cumsum(self.interval + self.add * np.arange(self.count))


def planned(runs: Sequence[Run]) -> np.ndarray:
    """Ticks of all steps after the base."""
    last, parts = 0, [np.zeros(0, np.int64)]
    for run in runs:
        parts.append(run.ticks(last))
        last = int(parts[-1][-1])
    return np.concatenate(parts)


def crc_of(runs: Sequence[Run], made: int, section: int, base: int | None = 0) -> int:
    """What docs/boards.md says a motor's CRC is after so many steps; base: ticks from the section to its clock."""
    text = IDENTITY + section.to_bytes(4, "little")
    if base is not None:
        text += b"B" + (base % 2**32).to_bytes(4, "little")
    records: list[list[int]] = []
    for run in runs:
        count = min(run.count, made)
        made -= count
        if count == 0:
            break
        if records:
            interval, so_far, add, forward = records[-1]
            if (add, forward) == (run.add, run.forward) and run.interval == interval + so_far * add:
                records[-1][1] += count
                continue
        records.append([run.interval, count, run.add, int(run.forward)])
    for interval, count, add, forward in records:
        text += b"R" + interval.to_bytes(4, "little") + count.to_bytes(4, "little")
        text += add.to_bytes(2, "little", signed=True) + bytes([forward])
    return zlib.crc32(text)


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Runner and firmware, by name."""
    folder = tmp_path_factory.mktemp("firmware")
    found = {"runner": build_runner(folder)}
    for name, chip, certified in (("328p", "328p", True), ("2560", "2560", True), ("plain", "328p", False)):
        (folder / name).mkdir()
        found[name] = build.build(chip, folder / name, certified=certified)
    return found


@pytest.fixture
def start(built: dict[str, Path], tmp_path: Path) -> Iterator[Start]:
    """Starts a board; `config` says how many motors it has."""
    running: list[Board] = []

    def begin(chip: str = "328p", *, motors: int = 2, pulse: int = 32, speed: float = 1, plain: bool = False) -> Board:
        firmware = built["plain"] if plain else built[chip].with_suffix(".hex")
        running.append(Board(built["runner"], chip, firmware, tmp_path, speed))
        board = running[-1].__enter__()
        configure(board.client, motors, pulse)
        return board

    yield begin
    for board in running:
        board.__exit__(None, None, None)


def configure(client: Client, motors: int, pulse: int) -> None:
    """Motors from oid 0 on, then an output, an endstop and a trsync."""
    client.send("allocate_oids", count=motors + 3)
    for motor in range(motors):
        step, direction = STEP_PINS[motor], DIRECTION_PINS[motor]
        client.send(
            "config_stepper", oid=motor, step_pin=step, dir_pin=direction, invert_step=0, step_pulse_ticks=pulse
        )
    client.send("config_digital_out", oid=motors, pin=OUTPUT, value=0, default_value=0, max_duration=0)
    client.send("config_endstop", oid=motors + 1, pin=INPUT, pull_up=0)
    client.send("config_trsync", oid=motors + 2)
    client.send("finalize_config", crc=0x89ABCDEF)


def open_section(client: Client, motors: int, *, ahead: float = 1.0, number: int = 7) -> int:
    """Identity, section and bases; the clock of its tick 0. The promise is at rest."""
    client.send("cert_begin", identity=IDENTITY)
    base = (client.clock() + int(ahead * HZ)) % 2**32
    messages = [client.encode("cert_section", number=number, clock=base), client.encode("cert_rest")]
    messages += [client.encode("reset_step_clock", oid=motor, clock=base) for motor in range(motors)]
    client.send_many(messages)
    return base


def messages_of(client: Client, motor: int, runs: Sequence[Run]) -> list[bytes]:
    """A message a run, with its direction where that changes."""
    found, forward = [], None
    for run in runs:
        turn = client.encode("set_next_step_dir", oid=motor, dir=int(run.forward)) if run.forward != forward else b""
        forward = run.forward
        found.append(turn + client.encode("queue_step", oid=motor, interval=run.interval, count=run.count, add=run.add))
    return found


def feed(client: Client, base: int, motors: Sequence[Sequence[Run]]) -> None:
    """Send runs of all motors in the order in which they begin, never more than the board has places for."""
    rows: list[tuple[int, int, bytes]] = []
    for motor, runs in enumerate(motors):
        begin = 0
        for run, message in zip(runs, messages_of(client, motor, runs), strict=True):
            end = int(run.ticks(begin)[-1])
            rows.append((begin, end, message))
            begin = end
    rows.sort(key=lambda row: row[:2])
    places = client.ask("get_config", "config")["move_count"] - 2
    stored: list[int] = []
    while rows:
        now = (client.clock() - base + 2**31) % 2**32 - 2**31
        stored = [end for end in stored if end > now - 1000]
        sent, rows = rows[: min(20, places - len(stored))], rows[min(20, places - len(stored)) :]
        stored += [end for _, end, _ in sent]
        client.send_many([message for *_, message in sent])


def at_rest(board: Board, motors: int, steps: Sequence[int]) -> list[Answer]:
    """What the motors say once each has made so many steps; nothing more has to come in time."""
    client = board.client
    board.rush()
    deadline = time.monotonic() + 60
    while True:
        found = [client.ask("cert_get_motor", "cert_motor", oid=motor) for motor in range(motors)]
        if [answer["steps"] for answer in found] == list(steps):
            return found
        assert time.monotonic() < deadline, (found, client.answers)


def stopped(client: Client) -> tuple[str, int]:
    """Reason and clock of a shutdown that comes."""
    answer = client.wait("shutdown")
    return client.reason(answer["static_string_id"]), answer["clock"]


def made(board: Board, motor: int) -> int:
    return len(board.changes(STEP_PINS[motor]))


def agree(board: Board, motor: int, base: int, runs: Sequence[Run]) -> tuple[int, int]:
    """All steps of a motor come on their ticks and in their direction; the least and greatest difference, cycles."""
    steps, ticks = board.changes(STEP_PINS[motor]), base + planned(runs)
    assert len(steps) == len(ticks)
    errors = steps - ticks
    assert errors.min() >= EARLIEST and errors.max() <= LATEST, (motor, errors.min(), errors.max())
    turns = board.edges()
    turns = turns[turns[:, 1] == board.pin(DIRECTION_PINS[motor])]
    # The level that the direction pin has at each step, against the level it had before the first.
    level = np.concatenate(([0], turns[:, 2]))[np.searchsorted(turns[:, 0], steps)]
    assert (level == np.concatenate([np.full(run.count, run.forward) for run in runs])).all()
    return int(errors.min()), int(errors.max())


# The line


def test_the_client_of_these_tests_knows_the_vectors_of_the_protocol() -> None:
    assert crc16(b"123456789") == 0x6F91
    assert block(0, b"") == bytes.fromhex("05109e817e")
    assert block(0, vlq(1) + vlq(0) + vlq(40)) == bytes.fromhex("0810010028 5e9f7e".replace(" ", ""))
    for number, size in ((-32, 1), (95, 1), (-33, 2), (96, 2), (-4096, 2), (12287, 2), (12288, 3), (2**32 - 1, 1)):
        assert len(vlq(number)) == size


@pytest.mark.parametrize("chip", CHIPS)
def test_shipped_images_are_what_the_sources_give_and_small(chip: str, built: dict[str, Path]) -> None:
    assert built[chip].with_suffix(".hex").read_bytes() == image(chip), "python -m gproof.backend.firmware.build"
    flash, _ = build.sizes(built[chip])
    assert flash <= FLASH
    with pytest.raises(ValueError, match="no firmware for 'm32'"):
        image("m32")


def test_blocks_that_were_spoilt_are_asked_for_again(start: Start) -> None:
    client = start().client
    good = block(client.sequence, client.encode("get_clock"))
    for spoilt in (good[:-1] + b"\x00", good[:3], b"\xff" * 40, bytes([good[0], good[1] ^ 1]) + good[2:], good[1:]):
        client.answers.clear()
        client.line.write(spoilt)
        client.send("get_clock")
        client.take(0.05)
        assert [answer.name for answer in client.answers] == ["clock"], spoilt
    # A block that comes twice is executed once, and acknowledged.
    twice = block(client.sequence, client.encode("get_clock"))
    client.answers.clear()
    client.line.write(twice)
    client.send("get_clock")
    client.take(0.05)
    assert [answer.name for answer in client.answers] == ["clock"]
    rng = np.random.default_rng(21)
    for _ in range(20):
        client.line.write(rng.integers(0, 256, 60, np.uint8).tobytes() + b"\x7e")
    time.sleep(0.2)
    client.synchronise()
    found = client.ask("get_config", "config").values
    assert (found["is_config"], found["crc"], found["is_shutdown"]) == (1, 0x89ABCDEF, 0)


# Steps


def random_runs(rng: np.random.Generator, runs: int, rate: float, most: int = 80) -> list[Run]:
    """Runs of a motor at about so many steps a second, of 10 to `most` steps."""
    found = [Run(20_000, 1)]
    for _ in range(runs):
        count, add = int(rng.integers(10, most)), int(rng.integers(-4, 5))
        interval = int(HZ / rate * rng.uniform(1, 1.06)) - min(0, add * count)
        found.append(Run(interval, count, add, bool(rng.integers(2))))
    return found


@pytest.mark.parametrize(("chip", "motors"), [("328p", 1), ("328p", 2), ("328p", 4), ("2560", 2), ("2560", 4)])
def test_steps_come_on_their_ticks_at_20_kHz_of_all_motors(chip: str, motors: int, start: Start) -> None:
    board = start(chip, motors=motors, pulse=80)
    client = board.client
    rng = np.random.default_rng(motors)
    runs = [random_runs(rng, 60 // motors, 20_000 / motors) for _ in range(motors)]
    base = open_section(client, motors)
    for motor in range(motors):
        client.send_many(messages_of(client, motor, runs[motor]))
    totals = [sum(run.count for run in one) for one in runs]
    answers = at_rest(board, motors, totals)
    for motor in range(motors):
        agree(board, motor, base, runs[motor])
        assert answers[motor]["crc"] == crc_of(runs[motor], totals[motor], 7)
        assert answers[motor]["pos"] == sum(run.count if run.forward else -run.count for run in runs[motor])
        assert client.ask("stepper_get_position", "stepper_position", oid=motor)["pos"] == answers[motor]["pos"]
    pulses = board.changes(STEP_PINS[0], 0) - board.changes(STEP_PINS[0])
    assert pulses.min() >= 80
    assert RAM_OF_CHIP["328p"] - board.flush()[2] <= RAM or chip != "328p"


@pytest.mark.parametrize("chip", CHIPS)
def test_a_processor_with_hardly_any_time_left_still_counts_the_overflows_of_its_clock(chip: str, start: Start) -> None:
    """Steps every 600 cycles leave the clock's own interrupt no turn for longer than half its period of 65,536."""
    board = start(chip, motors=1)
    runs = [Run(20_000, 1), Run(600, 2500), Run(40_000, 3)]
    base = open_section(board.client, 1)
    board.client.send_many(messages_of(board.client, 0, runs))
    at_rest(board, 1, [2504])
    agree(board, 0, base, runs)


@pytest.mark.parametrize("chip", CHIPS)
def test_motors_that_step_at_the_same_ticks(chip: str, start: Start) -> None:
    board = start(chip, motors=4)
    runs = [Run(20_000, 1), Run(3200, 500)]
    base = open_section(board.client, 4)
    for motor in range(4):
        board.client.send_many(messages_of(board.client, motor, runs))
    at_rest(board, 4, [501] * 4)
    for motor in range(4):
        agree(board, motor, base, runs)


@pytest.mark.parametrize("pulse", [16, 200, 1600])
def test_pulses_are_as_long_as_the_machine_file_says(pulse: int, start: Start) -> None:
    board = start("328p", motors=1, pulse=pulse)
    runs = [Run(20_000, 1), Run(4000, 200), Run(5000, 100, 3, False)]
    base = open_section(board.client, 1)
    board.client.send_many(messages_of(board.client, 0, runs))
    at_rest(board, 1, [301])
    agree(board, 0, base, runs)
    pulses = board.changes(STEP_PINS[0], 0) - board.changes(STEP_PINS[0])
    assert pulse <= pulses.min() and pulses.max() <= pulse + 640


@pytest.mark.parametrize("chip", CHIPS)
def test_a_stream_longer_than_the_board_stores_comes_while_it_steps(chip: str, start: Start) -> None:
    board = start(chip, motors=4, speed=0.5)
    client, rng = board.client, np.random.default_rng(5)
    runs = [random_runs(rng, 45, 5000, 160) for _ in range(4)]
    base = open_section(client, 4, ahead=0.5)
    feed(client, base, runs)
    totals = [sum(run.count for run in one) for one in runs]
    answers = at_rest(board, 4, totals)
    for motor in range(4):
        agree(board, motor, base, runs[motor])
        assert answers[motor]["crc"] == crc_of(runs[motor], totals[motor], 7)


def test_a_new_base_after_a_rest_and_an_interval_that_is_too_long(start: Start) -> None:
    board = start(motors=1)
    client = board.client
    base = open_section(client, 1)
    client.send_many(messages_of(client, 0, [Run(20_000, 10)]))
    at_rest(board, 1, [10])
    board.say("speed 1")
    again = (client.clock() + HZ // 2) % 2**32
    client.send("reset_step_clock", oid=0, clock=again)
    client.send_many(messages_of(client, 0, [Run(30_000, 5)]))
    (answer,) = at_rest(board, 1, [15])
    expected = np.concatenate((base + 20_000 * np.arange(1, 11), again + 30_000 * np.arange(1, 6)))
    errors = board.changes(STEP_PINS[0]) - expected
    assert errors.min() >= EARLIEST and errors.max() <= LATEST
    text = IDENTITY + (7).to_bytes(4, "little") + b"B" + bytes(4)
    text += b"R" + (20_000).to_bytes(4, "little") + (10).to_bytes(4, "little") + b"\0\0\1"
    text += b"B" + ((again - base) % 2**32).to_bytes(4, "little")
    text += b"R" + (30_000).to_bytes(4, "little") + (5).to_bytes(4, "little") + b"\0\0\1"
    assert answer["crc"] == zlib.crc32(text)
    client.send("queue_step", oid=0, interval=2**31, count=1, add=0)
    assert stopped(client)[0] == "Timer too close"
    assert made(board, 0) == 15


# Certification


def test_the_vector_of_the_page_about_counts_and_crcs(start: Start) -> None:
    board = start(motors=1)
    client = board.client
    runs = [Run(2000, 3, 10), Run(2030, 2, 10), Run(5000, 1, 0, False)]
    known = [crc_of(runs, steps, 7) for steps in (0, 2, 5, 6)]
    assert known == [0x90ADB27D, 0x8028D150, 0x458FEFDE, 0x8E12422E]
    assert crc_of(runs, 0, 7, None) == 0x24CED456
    assert client.ask("cert_get_identity", "cert_identity")["identity"] == b""
    assert client.ask("cert_get_motor", "cert_motor", oid=0).values == {"oid": 0, "steps": 0, "pos": 0, "crc": 0}
    client.send("cert_begin", identity=IDENTITY)
    base = (client.clock() + HZ) % 2**32
    client.send("cert_section", number=7, clock=base)
    state = client.ask("cert_get_state", "cert_state").values
    assert state == {"state": 2, "section": 7, "promise": base, "stopped": 0}
    client.send("cert_rest")
    assert client.ask("cert_get_motor", "cert_motor", oid=0)["crc"] == 0x24CED456
    client.send("reset_step_clock", oid=0, clock=base)
    assert client.ask("cert_get_motor", "cert_motor", oid=0)["crc"] == 0x90ADB27D
    client.send_many(messages_of(client, 0, runs))
    (answer,) = at_rest(board, 1, [6])
    board.say("speed 1")
    assert answer["crc"] == 0x8E12422E and answer["pos"] == 4
    assert client.ask("cert_get_identity", "cert_identity")["identity"] == IDENTITY
    client.send("cert_finish", clock=(client.clock() + 1000) % 2**32)
    while client.ask("cert_get_state", "cert_state")["state"] != 1:
        pass
    assert client.ask("cert_get_motor", "cert_motor", oid=0)["crc"] == 0x8E12422E
    client.send("cert_section", number=8, clock=(client.clock() + HZ) % 2**32)
    assert client.ask("cert_get_motor", "cert_motor", oid=0)["steps"] == 0


@pytest.mark.parametrize("chip", CHIPS)
def test_all_motors_stop_together_where_the_promise_ends(chip: str, start: Start) -> None:
    board = start(chip, motors=3)
    client = board.client
    runs = [[Run(20_000, 1), Run(3000, 400, 1)], [Run(20_000, 2), Run(2000, 400, -1)], [Run(40_000, 1), Run(7000, 90)]]
    base = open_section(client, 3)
    # The promise ends at a tick at which two of the motors have a step: that is still made.
    end = 40_000 + 7000 * 60
    for motor in range(3):
        client.send_many(messages_of(client, motor, runs[motor]))
    client.send("cert_commit", clock=(base + end) % 2**32)
    board.rush()
    reason, clock = stopped(client)
    assert reason == "Promise expired" and end - 64 <= (clock - base) % 2**32 <= end + 640
    state = client.ask("cert_get_state", "cert_state")
    assert (state["state"], state["promise"], state["stopped"]) == (3, (base + end) % 2**32, clock)
    counts = [int((planned(one) <= end).sum()) for one in runs]
    for motor, count in enumerate(counts):
        answer = client.ask("cert_get_motor", "cert_motor", oid=motor)
        assert made(board, motor) == count == answer["steps"] == answer["pos"]
        assert answer["crc"] == crc_of(runs[motor], count, 7)
    client.send("stepper_get_position", oid=0)
    assert client.wait("is_shutdown").name == "is_shutdown"
    client.send("clear_shutdown")
    assert [client.ask("stepper_get_position", "stepper_position", oid=motor)["pos"] for motor in range(3)] == counts
    assert client.ask("cert_get_state", "cert_state")["state"] == 0
    client.send("cert_section", number=8, clock=client.clock())
    assert stopped(client)[0] == "Not certified"
    assert [made(board, motor) for motor in range(3)] == counts


def test_an_emergency_stop_leaves_what_was_executed_known(start: Start) -> None:
    board = start(motors=2)
    client = board.client
    runs = [[Run(20_000, 1), Run(1800, 30_000)], [Run(20_000, 1), Run(2500, 9, 1), Run(2509, 20_000, 0, False)]]
    open_section(client, 2)
    for motor in range(2):
        client.send_many(messages_of(client, motor, runs[motor]))
    middle = []
    while not middle or middle[-1]["steps"] < 300:
        middle.append(client.ask("cert_get_motor", "cert_motor", oid=1))
    assert all(answer["crc"] == crc_of(runs[1], answer["steps"], 7) for answer in middle)
    client.send("emergency_stop")
    assert stopped(client)[0] == "Command request"
    for motor in range(2):
        answer = client.ask("cert_get_motor", "cert_motor", oid=motor)
        assert 300 < answer["steps"] == made(board, motor) < 20_000
        assert answer["crc"] == crc_of(runs[motor], answer["steps"], 7)
    client.send("clear_shutdown")
    assert client.ask("stepper_get_position", "stepper_position", oid=1)["pos"] == 10 - (made(board, 1) - 10)
    base = open_section(client, 2, number=9)
    client.send_many(messages_of(client, 0, [Run(20_000, 7)]))
    (answer, _) = at_rest(board, 2, [7, 0])
    assert answer["crc"] == crc_of([Run(20_000, 7)], 7, 9)
    assert (board.changes(STEP_PINS[0])[-7:] - base - 20_000 * np.arange(1, 8)).max() <= LATEST


NOT_CERTIFIED: dict[str, Callable[[Client], list[bytes]]] = {
    "a run without an identity": lambda c: [c.encode("queue_step", oid=0, interval=20_000, count=5, add=0)],
    "a run without a section": lambda c: [
        c.encode("cert_begin", identity=IDENTITY), c.encode("queue_step", oid=0, interval=20_000, count=5, add=0)
    ],
    "a section without an identity": lambda c: [c.encode("cert_section", number=0, clock=c.clock() + HZ)],
    "half an identity": lambda c: [c.encode("cert_begin", identity=IDENTITY[:16])],
    "a promise without a section": lambda c: [c.encode("cert_commit", clock=c.clock() + HZ)],
    "a rest without a section": lambda c: [c.encode("cert_rest")],
    "an end without a section": lambda c: [c.encode("cert_begin", identity=IDENTITY), c.encode("cert_finish", clock=0)],
    "a section within a section": lambda c: [
        c.encode("cert_begin", identity=IDENTITY),
        *[c.encode("cert_section", number=n, clock=c.clock() + HZ) for n in (0, 1)],
    ],
    "a run after the end": lambda c: [
        c.encode("cert_begin", identity=IDENTITY), c.encode("cert_section", number=0, clock=c.clock() + HZ),
        c.encode("cert_finish", clock=c.clock() + 2 * HZ), c.encode("reset_step_clock", oid=0, clock=c.clock() + HZ),
        c.encode("queue_step", oid=0, interval=20_000, count=5, add=0),
    ],
}  # fmt: skip


def test_without_identity_and_section_no_motor_moves(start: Start) -> None:
    board = start(motors=1)
    client = board.client
    for name, messages in NOT_CERTIFIED.items():
        client.send("reset_step_clock", oid=0, clock=(client.clock() + HZ // 4) % 2**32)
        client.send_many(messages(client))
        assert stopped(client)[0] == "Not certified", name
        client.send("clear_shutdown")
    time.sleep(0.2)
    assert made(board, 0) == 0


def test_the_plain_profile_is_that_protocol_and_no_more(start: Start) -> None:
    board = start(plain=True, motors=1)
    client = board.client
    assert not [name for name in [*client.commands, *client.responses] if name.startswith("cert")]
    assert "GPROOF_CERT" not in client.config and client.config["CLOCK_FREQ"] == HZ
    base = (client.clock() + HZ) % 2**32
    client.send("reset_step_clock", oid=0, clock=base)
    runs = [Run(20_000, 3), Run(1000, 300, 2, False)]
    client.send_many(messages_of(client, 0, runs))
    board.rush()
    while client.ask("stepper_get_position", "stepper_position", oid=0)["pos"] != 3 - 300:
        pass
    agree(board, 0, base, runs)


# Inputs, outputs, refusals


def test_outputs_change_at_their_ticks_and_rest_in_a_shutdown(start: Start) -> None:
    board = start("2560", motors=1)
    client = board.client
    base = (client.clock() + HZ) % 2**32
    ticks = [0, 5000, 9000, 20_000, 20_001 + 2**16, 400_000]
    client.send_many(
        [
            client.encode("queue_digital_out", oid=1, clock=(base + tick) % 2**32, on_ticks=1 - n % 2)
            for n, tick in enumerate(ticks)
        ]
    )
    board.rush()
    while (client.clock() - base) % 2**32 > 2**31 or client.clock() - base < 500_000:
        pass
    edges = board.edges()
    edges = edges[edges[:, 1] == board.pin(OUTPUT)]
    errors = edges[:, 0] - base - np.array(ticks)
    assert errors.min() >= EARLIEST and errors.max() <= LATEST
    client.send("update_digital_out", oid=1, value=1)
    assert len(board.changes(OUTPUT)) == 4
    client.send("emergency_stop")
    assert stopped(client)[0] == "Command request"
    assert len(board.changes(OUTPUT, 0)) == 4
    client.send("clear_shutdown")
    client.send("queue_digital_out", oid=1, clock=(client.clock() - 1) % 2**32, on_ticks=1)
    assert stopped(client)[0] == "Timer too close"


@pytest.mark.parametrize("chip", CHIPS)
def test_homing_stops_on_the_edge_and_keeps_the_position(chip: str, start: Start) -> None:
    board = start(chip, motors=2)
    client = board.client
    base = open_section(client, 2, number=0x80000000)
    runs = [[Run(20_000, 1), Run(4000, 2000)], [Run(20_000, 1), Run(5000, 2000, 0, False)]]
    board.say(f"after {board.pin(STEP_PINS[0])} 137 {board.pin(INPUT)} 1")
    messages = [client.encode("trsync_start", oid=4, report_clock=0, report_ticks=0, expire_reason=2)]
    messages += [client.encode("stepper_stop_on_trigger", oid=motor, trsync_oid=4) for motor in range(2)]
    messages += [client.encode("endstop_home", oid=3, clock=base, sample_ticks=240, sample_count=4, rest_ticks=1600,
                               pin_value=1, trsync_oid=4, trigger_reason=1)]  # fmt: skip
    client.send_many(messages + messages_of(client, 0, runs[0]) + messages_of(client, 1, runs[1]))
    board.rush()
    state = client.wait("trsync_state")
    assert (state["can_trigger"], state["trigger_reason"]) == (0, 1)
    board.say("speed 1")
    rest = client.ask("endstop_query_state", "endstop_state", oid=3)
    assert (rest["homing"], rest["pin_value"]) == (0, 1)
    # Seen at most a look after the edge, and stopped three samples later.
    edge, seen = board.changes(STEP_PINS[0])[136], rest["next_clock"] - 1600
    assert 0 <= seen - edge + LATEST <= 1600 + 2 * LATEST, (seen, edge, base, made(board, 0))
    for motor in range(2):
        steps = int((planned(runs[motor]) <= seen + 3 * 240 - base).sum())
        answer = client.ask("cert_get_motor", "cert_motor", oid=motor)
        assert answer["steps"] == made(board, motor) == steps
        assert answer["crc"] == crc_of(runs[motor], steps, 0x80000000)
        assert client.ask("stepper_get_position", "stepper_position", oid=motor)["pos"] == (
            -steps + 2 if motor else steps
        )
        client.send("queue_step", oid=motor, interval=20_000, count=5, add=0)
    assert client.ask("cert_get_state", "cert_state")["state"] == 2
    before = [made(board, motor) for motor in range(2)]
    client.send("reset_step_clock", oid=0, clock=(client.clock() + HZ) % 2**32)
    client.send("queue_step", oid=0, interval=20_000, count=5, add=0)
    board.rush()
    while client.ask("stepper_get_position", "stepper_position", oid=0)["pos"] != before[0] + 5:
        pass
    assert [made(board, motor) for motor in range(2)] == [before[0] + 5, before[1]]


def test_a_move_to_an_endstop_that_does_not_come_ends_by_the_clock(start: Start) -> None:
    board = start(motors=1)
    client = board.client
    base = open_section(client, 1)
    end = 20_000 + 300_001
    client.send_many(
        [
            client.encode("trsync_start", oid=3, report_clock=base, report_ticks=100_000, expire_reason=2),
            client.encode("trsync_set_timeout", oid=3, clock=(base + end) % 2**32),
            client.encode("stepper_stop_on_trigger", oid=0, trsync_oid=3),
            *messages_of(client, 0, [Run(20_000, 1), Run(3000, 5000)]),
        ]
    )
    board.rush()
    state = client.wait("trsync_state", where=lambda answer: not answer["can_trigger"])
    assert state["trigger_reason"] == 2 and abs(state["clock"] - base - end) <= LATEST
    assert made(board, 0) == 101


def clear(client: Client) -> None:
    client.send("clear_shutdown")
    client.answers.clear()


def test_what_is_wrong_stops_the_board_with_a_reason(start: Start) -> None:
    board = start(motors=1)
    client = board.client
    step = {"interval": 20_000, "count": 1, "add": 0}
    base = 0
    for name, send, reason in (
        ("an identity of no motor", lambda: client.send("queue_step", oid=1, **step), "Invalid oid type"),
        ("an oid that does not exist", lambda: client.send("set_next_step_dir", oid=77, dir=1), "Invalid oid type"),
        ("configuration again", lambda: client.send("config_trsync", oid=3), "Already finalized"),
        ("oids again", lambda: client.send("allocate_oids", count=2), "oids already allocated"),
        ("nothing to clear", lambda: client.send("clear_shutdown"), "Shutdown cleared when not shutdown"),
        ("reset without a stop", lambda: client.send("config_reset"), "config_reset only available when shutdown"),
        ("a number of no command", lambda: client.send_blocks([vlq(94)]), "Invalid command"),
        ("a message cut short", lambda: client.send_blocks([vlq(1)]), "Command parser error"),
        ("no steps", lambda: client.send("queue_step", oid=0, interval=9, count=0, add=0), "Invalid count parameter"),
    ):  # fmt: skip
        send()
        assert stopped(client)[0] == reason, name
        clear(client)
    base = open_section(client, 1)
    client.send("queue_step", oid=0, **step)
    client.send("reset_step_clock", oid=0, clock=base)
    assert stopped(client)[0] == "Can't reset time when stepper active"
    clear(client)
    open_section(client, 1, ahead=4)
    client.send_many(
        [client.encode("queue_step", oid=0, **step)] * (client.ask("get_config", "config")["move_count"] + 1)
    )
    assert stopped(client)[0] == "Move queue overflow"
    clear(client)
    open_section(client, 1)
    client.send("reset_step_clock", oid=0, clock=(client.clock() - 30_000) % 2**32)
    client.send("queue_step", oid=0, **step)
    assert stopped(client)[0] == "Timer too close"
    assert made(board, 0) == 0


def test_a_configuration_can_be_undone_in_a_shutdown(start: Start) -> None:
    board = start(motors=2)
    client = board.client
    client.send("emergency_stop")
    client.send("config_reset")
    assert client.ask("get_config", "config")["is_config"] == 0
    configure(client, 1, 32)
    base = open_section(client, 1)
    client.send_many(messages_of(client, 0, [Run(20_000, 20)]))
    at_rest(board, 1, [20])
    agree(board, 0, base, [Run(20_000, 20)])


# Long ones


@pytest.mark.soak
@pytest.mark.parametrize("chip", CHIPS)
def test_the_clock_goes_on_after_its_32_bits(chip: str, start: Start) -> None:
    """268 s and more of machine time, with steps before, over and after the wrap, and a dwell of 130 s."""
    board = start(chip, motors=2)
    client = board.client
    base = open_section(client, 2)
    runs = [[Run(20_000, 1)] + [Run(2_000_000_000, 1)] * 2 + [Run(5_000, 2000)], [Run(16_000_000, 290)]]
    for motor in range(2):
        client.send_many(messages_of(client, motor, runs[motor]))
    board.rush()
    deadline = time.monotonic() + 900
    while client.ask("cert_get_motor", "cert_motor", oid=1)["steps"] < 290 and time.monotonic() < deadline:
        time.sleep(1)
    for motor in range(2):
        agree(board, motor, base, runs[motor])
    assert client.ask("get_uptime", "uptime")["high"] == 1


@pytest.mark.soak
@pytest.mark.parametrize("chip", CHIPS)
@pytest.mark.parametrize("seed", seeds(0, 20))
def test_random_streams_of_any_number_of_motors(chip: str, seed: int, start: Start) -> None:
    rng = np.random.default_rng(seed)
    motors = int(rng.integers(1, 5))
    board = start(chip, motors=motors, pulse=int(rng.integers(16, 160)), speed=0.5)
    client = board.client
    runs = [random_runs(rng, 400 // motors, 20_000 / motors) for _ in range(motors)]
    base = open_section(client, motors, ahead=0.3)
    feed(client, base, runs)
    totals = [sum(run.count for run in one) for one in runs]
    answers = at_rest(board, motors, totals)
    for motor in range(motors):
        agree(board, motor, base, runs[motor])
        assert answers[motor]["crc"] == crc_of(runs[motor], totals[motor], 7)
