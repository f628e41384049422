"""Dictionaries that boards send, and boards that are none or mean harm: whatever comes over the line, opening it ends
in a board or in one error."""

from __future__ import annotations

import contextlib
import json
import random
import tracemalloc
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import pytest
from backend.boards.emulator.emulated_line import EmulatedLine
from backend.boards.klipper.fake_peer import DICTIONARY
from hypothesis import given
from hypothesis import strategies as st
from support.campaigns import sizes

from gproof.backend.boards.board import BoardError
from gproof.backend.boards.emulator.emulator import Emulator, Options
from gproof.backend.boards.emulator.log_reader import read
from gproof.backend.boards.klipper.blocks import PAYLOAD, block
from gproof.backend.boards.klipper.connection import Connection
from gproof.backend.boards.klipper.dictionary import LARGEST, Collected, DictionaryError, parsed, unpacked
from gproof.backend.boards.klipper.driver import KlipperBoard
from gproof.backend.boards.klipper.messages import IDENTIFIED
from gproof.backend.boards.klipper.wiring import MotorPins, Wiring

JSON = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**40), 2**40) | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=12), inner, max_size=3),
    max_leaves=8,
)
PARTS = ("commands", "responses", "enumerations", "config", "version")


def packed(told: Any) -> bytes:
    return zlib.compress(json.dumps(told).encode())


def test_a_dictionary_says_what_the_board_understands() -> None:
    found = unpacked(packed(DICTIONARY))
    assert found.command("queue_step", ("oid", "interval", "count", "add")).number == -3
    assert found.response("config", ("move_count",)).names == ("is_config", "crc", "is_shutdown", "move_count")
    assert (found.listed("pin", "PA0"), found.listed("pin", "PB7")) == (0, 15)
    assert found.number("CLOCK_FREQ") == 16_000_000
    assert found.text(2) == "Timer too close"
    assert found.version == "fake-1"
    for wrong in (
        lambda: found.command("trsync_start", ()),
        lambda: found.command("queue_step", ("oid",)),
        lambda: found.response("config", ("more",)),
        lambda: found.listed("pin", "PB8"),
        lambda: found.number("NONE"),
    ):
        with pytest.raises(DictionaryError):
            wrong()


def test_answers_are_read_as_far_as_they_are_known() -> None:
    found = unpacked(packed(DICTIONARY))
    config = found.responses["config"].encoded({"is_config": 1, "crc": 2**32 - 1, "is_shutdown": 0, "move_count": 678})
    clock = found.responses["clock"].encoded({"clock": 3_000_000_000})
    assert found.read(config + clock + b"\x5f" + clock) == [
        ("config", {"is_config": 1, "crc": 2**32 - 1, "is_shutdown": 0, "move_count": 678}),
        ("clock", {"clock": 3_000_000_000}),
    ]
    assert found.read(clock[:-1]) == []


HOSTILE = {
    "no compression": b"{}",
    "nothing": b"",
    "cut short": packed(DICTIONARY)[:-5],
    "no JSON": zlib.compress(b"{"),
    "no text": zlib.compress(b"\xff\xfe"),
    "deep": zlib.compress(b"[" * 60_000),
    "deep objects": zlib.compress(b'{"a":' * 60_000),
    "bomb": zlib.compress(b"[" + b" " * 50_000_000 + b"]", 9),
    "too long": bytes(LARGEST + 1),
    "long number": zlib.compress(b'{"config": {"a": ' + b"9" * 10_000 + b"}}"),
    "list": packed([]),
    "commands": packed({"commands": []}),
    "text for a number": packed({"commands": {"a": "1"}}),
    "fraction": packed({"commands": {"a": 1.5}}),
    "truth": packed({"responses": {"a": True}}),
    "33 bits": packed({"responses": {"a": 1 << 31}}),
    "one number twice": packed({"responses": {"a": 7, "b": 7}}),
    "one name twice": packed({"responses": {"a": 7, "a b=%u": 8}}),
    "identify moved": packed({"commands": {"identify offset=%u count=%c": 2}}),
    "enumeration": packed({"enumerations": {"pin": 3}}),
    "range": packed({"enumerations": {"pin": {"P0": [0, 1 << 40]}}}),
    "negative range": packed({"enumerations": {"pin": {"P0": [0, -1]}}}),
    "many ranges": packed({"enumerations": {"pin": {f"P{k}X0": [0, 60_000] for k in range(5)}}}),
    "range of texts": packed({"enumerations": {"pin": {"P0": ["a", "b"]}}}),
    "endless digits": packed({"enumerations": {"pin": {"P" + "9" * 5000: [0, 2]}}, "config": 1}),
}


def test_what_is_no_dictionary_is_one_error() -> None:
    for name, data in HOSTILE.items():
        with pytest.raises(DictionaryError) as error:
            unpacked(data)
        assert "\n" not in str(error.value), name
        assert len(str(error.value)) < 160, name


@given(st.dictionaries(st.sampled_from(PARTS), JSON) | JSON)
def test_any_json_is_a_dictionary_or_an_error(told: Any) -> None:
    with contextlib.suppress(DictionaryError):
        parsed(told)


def test_a_dictionary_without_end_is_given_up() -> None:
    collected = Collected()
    with pytest.raises(DictionaryError, match="more than"):
        while True:
            collected.add({"offset": collected.offset, "data": b"x" * 40})
    assert collected.offset < LARGEST + 41


def test_parts_that_come_twice_count_once() -> None:
    data, collected, over = packed(DICTIONARY), Collected(), False
    while not over:
        k = collected.offset
        part = {"offset": k, "data": data[k : k + 40]}
        over = collected.add(part)
        assert over == (k == len(data))
        assert over or not collected.add(part)
    assert collected.dictionary().version == "fake-1"


# Boards that are none.

MEMORY = 64 << 20
"""Bytes that no stranger may make the host take: a dictionary's text may have one megabyte."""

PATIENCE = 600.0
"""Seconds of the line's time in which opening a board has to end, whatever it is."""


@dataclass
class Stranger:
    """A line with something at its other end. answer: what comes for what was written ("": on its own)."""

    answer: Callable[[bytes], bytes]
    time: float = 0.0
    waiting: bytes = b""

    def connect(self) -> Stranger:
        return self

    def now(self) -> float:
        return self.time

    def write(self, data: bytes) -> None:
        self.waiting += self.answer(data)

    def read(self, until: float) -> bytes:
        assert self.time < PATIENCE, "it does not end"
        self.waiting += self.answer(b"")
        data, self.waiting = self.waiting[:4096], self.waiting[4096:]
        self.time = self.time + 0.0005 if data else max(until, self.time + 0.0005)
        return data

    def close(self) -> None:
        pass


@dataclass
class Talker:
    """A board that is in step and answers each block with what it likes."""

    says: Callable[[bytes], list[bytes]]
    sequence: int = 0

    def __call__(self, data: bytes) -> bytes:
        out = b""
        for part in data.split(b"\x7e"):
            if len(part) >= 4:
                if part[1] & 15 != self.sequence:
                    out += block(self.sequence, b"")
                    continue
                self.sequence = self.sequence + 1 & 15
                out += b"".join(block(self.sequence, payload) for payload in self.says(part[2:-2]))
                out += block(self.sequence, b"")
        return out


def opened(answer: Callable[[bytes], bytes]) -> None:
    """Opens it; nothing but one BoardError of one line may come of it."""
    wiring = Wiring(motors=[MotorPins(step="PA0", direction="PA1")])
    with pytest.raises(BoardError) as error:
        KlipperBoard(Stranger(answer).connect, wiring).open()
    assert "\n" not in str(error.value)
    assert len(str(error.value)) < 250


def part(offset: int, data: bytes) -> bytes:
    return IDENTIFIED.encoded({"offset": offset, "data": data})


def test_what_answers_and_is_no_board_is_one_error() -> None:
    rng = random.Random(1)
    offsets = iter(range(0, 1 << 30, 40))
    for answer in (
        lambda data: b"",
        lambda data: b"\x7e" * 4096,
        lambda data: rng.randbytes(4096),
        lambda data: bytes(4096),
        lambda data: data,
        lambda data: block(rng.randrange(16), rng.randbytes(rng.randrange(PAYLOAD))),
        lambda data: block(0, b"") * 50,
        # Boards that are in step: without a dictionary, with one that never ends or never goes on, in a shutdown.
        Talker(lambda data: []),
        Talker(lambda data: [part(next(offsets), b"x" * 40)]),
        Talker(lambda data: [part(0, b"x" * 40)]),
        Talker(lambda data: [part(7, b"x")] * 5),
        Talker(lambda data: [rng.randbytes(30)]),
        Talker(lambda data: [part(0, b"")]),
    ):
        opened(answer)


@pytest.mark.parametrize(("count", "blocks"), sizes((40_000, 2_000), (1_000_000, 100_000)))
def test_whatever_a_board_sends_the_host_ends_it(count: int, blocks: int) -> None:
    """Random bytes and spoiled answers to a host that is in step with a board."""
    rng = random.Random(5)
    board = Emulator(Options())
    line = EmulatedLine(board)
    connection = Connection(line, lambda answer: None)
    connection.synchronise()
    dictionary = connection.identify()
    heard = list(dictionary.responses.values())
    transport, now = connection.transport, 1000.0
    for _ in range(count // 500):
        for payload, _ in transport.feed(rng.randbytes(500), now):
            dictionary.read(payload)
    for k in range(blocks):
        message = rng.choice(heard)
        values = {
            name: rng.randbytes(rng.randrange(30)) if "s" in kind else rng.randrange(100)
            for name, kind in message.fields
        }
        payload = message.encoded(values)[:PAYLOAD]
        made = spoiled(rng, block(k & 15, spoiled(rng, payload)[:PAYLOAD]) if k % 2 else block(k & 15, payload))
        for received, _ in transport.feed(made, now):
            dictionary.read(received)
        assert len(transport.parser._held) < 64


def spoiled(rng: random.Random, data: bytes) -> bytes:
    """One to three changes: a bit, a byte lost, doubled, put in, the end cut off."""
    made = bytearray(data)
    for _ in range(rng.randint(1, 3)):
        at = rng.randrange(len(made) + 1)
        match rng.randrange(5):
            case 0 if at < len(made):
                made[at] ^= 1 << rng.randrange(8)
            case 1:
                del made[at : at + 1]
            case 2:
                made[at:at] = made[at : at + 1]
            case 3:
                made[at:at] = rng.randbytes(1)
            case _:
                del made[at + rng.randrange(30) :]
    return bytes(made)


@pytest.mark.parametrize(("count", "blocks"), sizes((20_000, 1_000), (1_000_000, 100_000)))
@pytest.mark.parametrize("certified", [False, True])
def test_whatever_a_host_sends_the_emulator_makes_no_step(count: int, blocks: int, certified: bool) -> None:
    rng = random.Random(6)
    board = Emulator(Options(certified=certified, baud=100_000_000))
    for _ in range(count // 500):
        board.write(rng.randbytes(500))
        board.advance(board.now + 10**6)
        board.taken()
    names = ("queue_step", "reset_step_clock", "set_next_step_dir", "get_config", "config_stepper", "emergency_stop")
    commands = [form for form in board._language.commands.values() if form.name in names]
    for k in range(blocks):
        form = rng.choice(commands)
        payload = form.encoded(*(rng.randrange(100) for _ in form.kinds))
        board.write(spoiled(rng, block(k & 15, payload)))
        board.advance(board.now + 10**5)
        board.taken()
    board.finish()
    told = read(board.log.held)
    # Nothing was configured: a block that came through whole meets no motor.
    assert not len(told.steps.tick)


def text_of(told: object) -> bytes:
    return zlib.compress(json.dumps(told).encode(), 9)


def nested(rng: random.Random, depth: int) -> Any:
    """JSON of some depth, of any types."""
    kinds: list[Callable[[], Any]] = [
        lambda: rng.choice((None, True, 1.5, -(2**70), "x" * rng.randrange(50), 10**300)),
        lambda: [nested(rng, depth - 1) for _ in range(rng.randrange(4))],
        lambda: {f"k{k}": nested(rng, depth - 1) for k in range(rng.randrange(4))},
    ]
    return rng.choice(kinds if depth else kinds[:1])()


def bombs() -> dict[str, bytes]:
    """Dictionaries of up to 64 kB that unpack to much more, or to what takes much more memory than its text."""
    return {
        "spaces": zlib.compress(b" " * 20_000_000, 9),
        "lists": zlib.compress(b"[" + b"[]," * 340_000 + b"[]]", 9),
        "objects": zlib.compress(b'{"config":[' + b"{}," * 340_000 + b"{}]}", 9),
        "numbers": zlib.compress(b'{"enumerations":[' + b"1," * 500_000 + b"1]}", 9),
        "long number": zlib.compress(b'{"config":{"a":' + b"9" * 1_000_000 + b"}}", 9),
        "numbers of 4,000 digits": zlib.compress(
            b'{"config":{' + b",".join(b'"a%d":' % k + b"9" * 4_000 for k in range(250)) + b"}}", 9
        ),
        "names": zlib.compress(
            json.dumps({"commands": {f"c{k} a=%u": k for k in range(12_000)}}, separators=(",", ":")).encode(), 9
        ),
        "ranges": text_of({"enumerations": {"pin": {f"{'P' * 400}{k}X0": [0, 65_000] for k in range(1)}}}),
        "long text": zlib.compress(b'{"version":"' + b"x" * 1_000_000 + b'"}', 9),
        "bomb in a bomb": zlib.compress(zlib.compress(b" " * 20_000_000, 9) * 3, 9),
    }


@pytest.mark.parametrize("one_in", sizes(4, 1))
def test_no_dictionary_takes_more_memory_than_a_bound(one_in: int) -> None:
    for name, data in list(bombs().items())[::one_in]:
        assert len(data) <= LARGEST, name
        tracemalloc.start()
        try:
            with contextlib.suppress(DictionaryError):
                unpacked(data)
            assert tracemalloc.get_traced_memory()[1] < MEMORY, name
        finally:
            tracemalloc.stop()


@pytest.mark.parametrize("count", sizes(300, 20_000))
def test_dictionaries_of_wrong_types_are_one_error_or_a_dictionary(count: int) -> None:
    rng, good = random.Random(9), zlib.compress(json.dumps(DICTIONARY).encode())
    parts = ("commands", "responses", "enumerations", "config", "version")
    for k in range(count):
        told = {**DICTIONARY, rng.choice(parts): nested(rng, 5)}
        if k % 3 == 0:
            table = dict(DICTIONARY[name := rng.choice(parts[:4])])
            table[rng.choice(list(table))] = nested(rng, 3)
            told = {**DICTIONARY, name: table}
        for data in (text_of(told), spoiled(rng, good), rng.randbytes(rng.randrange(200))):
            try:
                unpacked(data)
            except DictionaryError as error:
                assert "\n" not in str(error)
                assert len(str(error)) < 250
