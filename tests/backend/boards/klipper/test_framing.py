"""Numbers, checksums and blocks: the published vectors, properties, and bytes that are none of these."""

import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gproof.backend.boards.klipper import vlq
from gproof.backend.boards.klipper.blocks import LONGEST, PAYLOAD, Parser, block, checksum
from gproof.backend.boards.klipper.messages import IDENTIFY, described

WORDS = st.integers(-(1 << 31), (1 << 32) - 1) | st.integers(-5000, 13_000)
PAYLOADS = st.binary(max_size=PAYLOAD)


def test_the_vectors_of_the_protocol() -> None:
    assert checksum(b"123456789") == 0x6F91
    assert block(0, b"") == bytes.fromhex("05 10 9e 81 7e")
    assert block(0, IDENTIFY.encoded({"offset": 0, "count": 40})) == bytes.fromhex("08 10 01 00 28 5e 9f 7e")


def test_numbers_have_the_sizes_that_the_protocol_states() -> None:
    edges = ((-32, 95), (-4096, 12287), (-524288, 1572863), (-67108864, 201326591), (-(2**31), 2**31 - 1))
    for size, (least, most) in enumerate(edges, start=1):
        assert len(vlq.encoded(least)) == len(vlq.encoded(most)) == size
        if size < len(edges):
            assert len(vlq.encoded(least - 1)) == len(vlq.encoded(most + 1)) == size + 1
    assert vlq.encoded(2**32 - 1) == vlq.encoded(-1) == b"\x7f"


@given(st.lists(WORDS, max_size=8))
def test_numbers_come_back_as_the_int32_with_the_same_bits(numbers: list[int]) -> None:
    data, place, found = b"".join(map(vlq.quick, numbers)), 0, []
    while place < len(data):
        number, place = vlq.decoded(data, place)
        found.append(number)
    assert [n & 0xFFFFFFFF for n in found] == [n & 0xFFFFFFFF for n in numbers]
    assert all(-(1 << 31) <= n < 1 << 31 for n in found)


@given(st.binary(max_size=12))
def test_bytes_that_are_no_number_are_malformed_or_one(data: bytes) -> None:
    for read in (vlq.decoded, vlq.string_decoded):
        try:
            _, place = read(data, 0)
        except vlq.Malformed:
            continue
        assert 0 < place <= len(data)


@given(st.binary(min_size=1, max_size=100))
def test_the_checksum_is_the_one_of_the_polynomial(data: bytes) -> None:
    value = 0xFFFF
    for byte in data:
        value ^= byte
        for _ in range(8):
            value = value >> 1 ^ (0x8408 if value & 1 else 0)
    assert checksum(data) == value


@given(st.lists(st.tuples(st.integers(0, 15), PAYLOADS), max_size=20), st.integers(1, 80), st.booleans())
def test_blocks_are_found_however_they_arrive(sent: list[tuple[int, bytes]], size: int, synced: bool) -> None:
    data = b"".join((b"\x7e" if synced else b"") + block(sequence, payload) for sequence, payload in sent)
    parser = Parser()
    found = [b for k in range(0, len(data), size) for b in parser.feed(data[k : k + size])]
    assert found == sent
    assert parser.skipped == 0


@given(st.binary(max_size=200), PAYLOADS)
def test_a_block_is_found_behind_anything(noise: bytes, payload: bytes) -> None:
    parser = Parser()
    parser.feed(noise)
    found = []
    # What is taken for the start of a block ends within its greatest length, or when nothing follows.
    for _ in range(3):
        found += parser.feed(b"\x7e" + block(3, payload))
    while parser._held:
        found += parser.give_up()
    assert (3, payload) in found


def test_a_million_random_bytes_hold_nothing_and_no_memory() -> None:
    rng, parser, found = random.Random(21), Parser(), 0
    for _ in range(250):
        found += len(parser.feed(rng.randbytes(4000)))
        assert len(parser._held) < LONGEST
    assert found < 5  # 4,000 places look like a block's start; each passes a checksum of 16 bits by chance


def test_of_a_hundred_thousand_spoiled_blocks_none_is_taken_for_another() -> None:
    rng, parser = random.Random(22), Parser()
    wrong = 0
    for k in range(100_000):
        payload = k.to_bytes(4, "big")
        data = bytearray(block(k, payload))
        data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
        wrong += sum(b.payload not in (payload, (k - 1).to_bytes(4, "big")) for b in parser.feed(bytes(data)))
        assert len(parser._held) < LONGEST
    assert wrong <= 3


def test_messages_hold_what_their_kinds_hold() -> None:
    message = described("queue_step oid=%c interval=%u count=%hu add=%hi", 5)
    assert message is not None
    good = {"oid": 3, "interval": 2**32 - 1, "count": 65535, "add": -32768}
    fields, place = message.decoded(data := message.encoded(good), 1)
    assert (fields, place) == (good, len(data))
    for name, value in (("oid", 256), ("interval", 2**32), ("interval", -1), ("count", 65536), ("add", 32768)):
        with pytest.raises(ValueError, match=name):
            message.encoded({**good, name: value})
    for other in ({**good, "more": 1}, {"oid": 1}, {**good, "oid": b"x"}):
        with pytest.raises(ValueError, match=r"queue_step|oid"):
            message.encoded(other)
    text = described("tell oid=%c data=%*s", -3)
    assert text is not None
    assert text.decoded(text.encoded({"oid": 1, "data": b"abc"}), 1) == ({"oid": 1, "data": b"abc"}, 6)
    for wrong in ("", "a b", "a b=%x", "a b=%u b=%u", "a  b=%u", "1a", "a b=%u ", "x" * 70):
        assert described(wrong, 1) is None
