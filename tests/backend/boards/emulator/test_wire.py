"""The emulator's side of the line: vectors of docs/boards.md, blocks, acknowledgements, dictionary."""

from __future__ import annotations

import json
import random
import zlib

import pytest
from support.emulated import Host, ready

from gproof.backend.boards.emulator.emulator import Options
from gproof.backend.boards.emulator.wire import Receiver, Short, crc16, frame, number, signed, take_number

NUMBERS = {
    # The first and last of each length in Klipper's Protocol.md; groups by hand.
    0: "00",
    95: "5f",
    96: "8060",
    -32: "60",
    -33: "ff5f",
    12287: "df7f",
    12288: "80e000",
    -4096: "e000",
    -4097: "ffdf7f",
    1572863: "dfff7f",
    -524288: "e08000",
    201326591: "dfffff7f",
    -67108864: "e0808000",
    2147483647: "87ffffff7f",
    -2147483648: "f880808000",
}


def test_vectors() -> None:
    assert crc16(b"123456789") == 0x6F91
    assert frame(0).hex(" ") == "05 10 9e 81 7e"
    assert frame(0, bytes((1, 0, 40))).hex(" ") == "08 10 01 00 28 5e 9f 7e"


def test_numbers_have_the_groups_that_the_protocol_gives_them() -> None:
    for value, text in NUMBERS.items():
        assert number(value).hex() == text, value
        assert signed(take_number(bytes.fromhex(text), 0)[0]) == value
    # An unsigned word travels as its signed image.
    assert number(0xFFFFFFFF) == number(-1) == b"\x7f"
    assert take_number(b"\x7f", 0) == (0xFFFFFFFF, 1)
    with pytest.raises(Short):
        take_number(b"\x87\xff", 0)


def test_a_block_is_found_in_pieces_and_after_rubbish() -> None:
    receiver = Receiver(192)
    for byte in b"\x7e" + frame(3, b"ab"):
        assert receiver.next() is None
        receiver.held.append(byte)
    block = receiver.next()
    assert block == (3, b"ab")
    wrong = bytearray(frame(4, b"cd"))
    wrong[2] ^= 1
    receiver.held += wrong + frame(4, b"cd")
    # One nak, then the block.
    assert receiver.next() == (0, None)
    assert receiver.next() == (4, b"cd") and receiver.next() is None


def test_random_bytes_are_survived_in_bounded_memory() -> None:
    random.seed(21)
    host = ready()
    for _ in range(300):
        host.board.write(random.randbytes(random.randrange(400)))
        host.listen(0.01)
        assert len(host.board._receiver.held) <= 192 and host.board._inbound_bytes <= 1 << 16
    host.listen(5)
    host.board.write(b"\x7e" * 64)
    host.listen()
    found = host.ask(("get_config",))
    assert found[0][:3] == ("config", 1, 77)


def test_random_payloads_end_in_a_shutdown_at_most() -> None:
    random.seed(22)
    host = ready()
    for _ in range(400):
        host.board.write(frame(host.sequence, random.randbytes(random.randrange(60))))
        host.sequence = host.sequence + 1 & 15
        host.listen(0.003)
    host.listen()
    assert [name for name, *_ in host.ask(("get_clock",))] in (["clock"], ["shutdown", "clock"])


def test_acknowledgements_carry_the_next_sequence_and_strangers_are_refused() -> None:
    host = Host()
    host.board.write(bytes.fromhex("08 10 01 00 28 5e 9f 7e"))
    (answer,) = host.listen()
    assert answer[:2] == ("identify_response", 0) and isinstance(answer[2], bytes) and len(answer[2]) == 40
    # The response has the sequence of the acknowledgement that follows it.
    assert [sequence for sequence, _ in host.blocks] == [1, 1] and host.blocks[1][1] == b""
    host.blocks.clear()
    host.board.write(frame(0, b"\x03"))  # seen already
    host.board.write(frame(5, b"\x03"))  # too early
    assert host.listen() == [] and host.blocks == [(1, b""), (1, b"")]


def test_the_dictionary_says_what_the_profile_has() -> None:
    def told(options: Options) -> dict[str, dict[str, int]]:
        host, data = Host(options), b""
        while True:
            ((_, offset, part),) = host.ask(("identify", len(data), 40), seconds=0.01)
            assert offset == len(data) and isinstance(part, bytes)
            if not part:
                found: dict[str, dict[str, int]] = json.loads(zlib.decompress(data))
                return found
            data += part

    certified, plain = told(Options()), told(Options(certified=False, chip="atmega328p", without=frozenset({"reset"})))
    assert certified["config"] == {
        "CLOCK_FREQ": 16_000_000, "MCU": "atmega2560", "SERIAL_BAUD": 250_000, "RECEIVE_WINDOW": 192, "GPROOF_CERT": 1,
    }  # fmt: skip
    assert "GPROOF_CERT" not in plain["config"] and not any("cert" in text for text in plain["commands"])
    assert certified["commands"]["identify offset=%u count=%c"] == 1
    assert min(certified["commands"].values()) < 0  # some are, on real boards
    assert "reset" in certified["commands"] and "reset" not in plain["commands"]
    assert plain["enumerations"]["pin"] == {"PB0": [8, 8], "PC0": [16, 8], "PD0": [24, 8]}


def test_answers_that_find_no_room_are_lost() -> None:
    host = ready()
    # 50 answers of 6 to 9 bytes in one block: the board has room for 96 bytes.
    found = host.ask(*[("get_clock",)] * 50)
    assert 8 <= len(found) <= 20 and {name for name, *_ in found} == {"clock"}


def test_the_line_has_its_speed() -> None:
    host = ready()
    began = host.board.now
    host.send(("get_clock",))  # six bytes, then nine or ten and five back: 40 µs each
    while not (found := host.heard()):
        host.board.advance(host.board.now + 1000)
    assert found[0][0] == "clock"
    assert 6 * 40_000 + 9 * 40_000 <= host.board.now - began <= 6 * 40_000 + 11 * 40_000
