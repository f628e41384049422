"""Dictionaries that boards send: a good one, and what strangers could send instead."""

import contextlib
import json
import zlib
from typing import Any

import pytest
from backend.boards.klipper.fake_peer import DICTIONARY
from hypothesis import given
from hypothesis import strategies as st

from gproof.backend.boards.klipper.dictionary import LARGEST, Collected, DictionaryError, parsed, unpacked

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
