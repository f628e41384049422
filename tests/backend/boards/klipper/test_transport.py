"""Windows, acknowledgements, naks and loss: a receiver by the protocol's rules, and a line that spoils bytes."""

import random
from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from gproof.backend.boards.klipper.blocks import Parser, block
from gproof.backend.boards.klipper.transport import MOST_BLOCKS, Transport

EMPTY = [block(k, b"") for k in range(16)]


class Receiver:
    """Takes blocks in order, answers each with what it expects next."""

    def __init__(self, expected: int = 0) -> None:
        self.expected, self.taken, self.parser = expected, b"", Parser()

    def feed(self, data: bytes) -> list[bytes]:
        answers = []
        for sequence, payload in self.parser.feed(data):
            if sequence == self.expected & 15:
                self.expected += 1
                self.taken += payload
            answers.append(EMPTY[self.expected & 15])
        return answers


def test_a_window_holds_twelve_blocks_and_the_receive_buffer() -> None:
    small = Transport(window=10_000)
    for k in range(100):
        small.send(bytes([k]) * 59)
    assert small.out(0.0) == b"".join(block(k, bytes([k]) * 59) for k in range(MOST_BLOCKS))
    narrow = Transport(sequence=14)
    for k in range(10):
        narrow.send(bytes([k]) * 59)
    assert len(narrow.out(0.0)) == 192
    narrow.feed(EMPTY[15], 0.01)
    assert narrow.out(0.01) == block(17, bytes([3]) * 59)
    assert narrow.acknowledged == 1


def test_messages_share_blocks_and_wait_only_for_others_in_flight() -> None:
    line = Transport()
    for _ in range(3):
        line.send(b"ab", now=False)
    assert line.out(0.0) == block(0, b"ababab")
    line.send(b"cd", now=False)
    assert line.out(0.001) == b""
    line.send(b"ef")
    assert line.out(0.002) == block(1, b"cdef")
    line.feed(EMPTY[2], 0.003)
    assert line.idle
    assert line.acknowledged == 5


def test_a_nak_repeats_at_once_and_the_naks_behind_it_do_not() -> None:
    line = Transport(window=1000)
    for k in range(4):
        line.send(bytes([k]) * 40)
    sent = line.out(0.0)
    line.feed(EMPTY[1], 0.01)
    assert line.out(0.01) == b""
    line.feed(EMPTY[1], 0.011)
    again = b"\x7e" + sent[45:]
    assert line.out(0.011) == again
    # Blocks 2 and 3 arrived as well, behind the hole: each is answered so.
    line.feed(EMPTY[1] * 2, 0.012)
    assert line.out(0.012) == b""
    # One more: block 1 was spoiled once more.
    line.feed(EMPTY[1], 0.02)
    assert line.out(0.02) == again
    line.feed(EMPTY[4], 0.03)
    assert line.idle
    assert (line.counts.after_nak, line.counts.after_wait) == (6, 0)


def test_a_response_before_its_acknowledgement_is_no_nak() -> None:
    line = Transport()
    line.send(b"a")
    line.send(b"b" * 59)
    line.out(1.0)
    received = line.feed(block(1, b"xyz") + EMPTY[1] + block(1, b"more"), 1.5)
    assert [(r.payload, r.asked) for r in received] == [(b"xyz", 1.0), (b"more", 1.0)]
    assert line.out(1.5) == b""
    assert not line.idle


def test_without_an_answer_it_waits_longer_each_time() -> None:
    line, now, times = Transport(), 0.0, []
    line.send(b"a")
    first = line.out(now)
    while len(times) < 12:
        now = line.next_time() or 0.0
        assert line.out(now - 1e-6) == b""
        assert line.out(now) == b"\x7e" + first
        times.append(now)
    waits = [b - a for a, b in pairwise(times)]
    assert all(b > a - 1e-9 for a, b in pairwise(waits))
    assert 0.025 <= times[0] <= 0.2
    assert round(waits[-1], 9) == 5.0
    assert line.flying


def test_answers_of_a_board_that_was_reset_acknowledge_nothing() -> None:
    line = Transport(sequence=37)
    line.send(b"a")
    line.out(0.0)
    for k in range(16):
        if k != 38 & 15:
            line.feed(EMPTY[k], 0.01)
    assert line.acknowledged == 0


@given(
    st.integers(0, 2**32),
    st.lists(st.integers(1, 59), min_size=1, max_size=60),
    st.integers(0, 40),
    st.sampled_from([192, 500]),
)
def test_every_message_arrives_once_and_in_order(seed: int, sizes: list[int], faults: int, window: int) -> None:
    rng = random.Random(seed)
    line, board = Transport(sequence=seed % 16, window=window), Receiver(seed % 16)
    messages = [bytes([k % 251]) * size for k, size in enumerate(sizes)]
    for message in messages:
        line.send(message, now=rng.random() < 0.3)
    now = 0.0
    for _ in range(10_000):
        there = line.out(now)
        if there and rng.randrange(100) < faults:
            there = spoiled(rng, there)
        answers = b"".join(board.feed(there))
        if answers and rng.randrange(100) < faults:
            answers = spoiled(rng, answers)
        line.feed(answers, now + 0.001)
        if line.idle:
            break
        now = now + 0.002 if answers else max(now + 0.001, line.next_time() or 0.0)
        if not answers:
            line.give_up(now)
            for _ in range(64):
                board.parser.give_up()
    assert line.idle
    assert board.taken == b"".join(messages)
    assert line.acknowledged == len(messages)


def spoiled(rng: random.Random, data: bytes) -> bytes:
    """A part lost, a bit flipped, or a part twice."""
    at, end = sorted((rng.randrange(len(data)), rng.randrange(len(data))))
    match rng.randrange(3):
        case 0:
            return data[:at] + data[end + 1 :]
        case 1:
            return data[:at] + bytes([data[at] ^ 1 << rng.randrange(8)]) + data[at + 1 :]
        case _:
            return data[: end + 1] + data[at:]
