"""The data dictionary that a board sends: its commands, responses, enumerations and constants.

It is JSON, compressed with zlib. A board is a stranger: size, nesting, types and numbers are checked, and whatever is
wrong with them is one DictionaryError. Source: Klipper's Protocol.md, "Data Dictionary".
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Mapping
from typing import Any

from gproof.backend.boards.board import BoardError
from gproof.backend.boards.klipper import vlq
from gproof.backend.boards.klipper.messages import IDENTIFIED, IDENTIFY, Fields, Message, Value, described
from gproof.ir.record import record

LARGEST = 1 << 16
"""Bytes of a compressed dictionary: no firmware has a twentieth of it."""

LARGEST_TEXT = 1 << 20
"""Bytes of its text: what compresses better than that is made to fill a memory."""

_LARGEST_RANGE = 1 << 16


class DictionaryError(BoardError):
    """What a board sent as its dictionary is none, or lacks what is needed."""


@record(frozen=True, slots=True, kw_only=True)
class Dictionary:
    """What a board says that it understands.

    commands, responses: by name; replies: responses by number; enumerations: numbers by field and name; constants:
    by name; version: of the firmware.
    """

    commands: Mapping[str, Message]
    responses: Mapping[str, Message]
    replies: Mapping[int, Message]
    enumerations: Mapping[str, Mapping[str, int]]
    constants: Mapping[str, int | str]
    version: str

    def command(self, name: str, fields: tuple[str, ...]) -> Message:
        """The command of that name and those fields; DictionaryError when the firmware has none."""
        found = self.commands.get(name)
        if found is None:
            raise DictionaryError(f"the firmware has no command {name}")
        if set(found.names) != set(fields):
            raise DictionaryError(f"{name} of the firmware has the fields {list(found.names)}, not {list(fields)}")
        return found

    def response(self, name: str, fields: tuple[str, ...]) -> Message:
        """The response of that name, with at least those fields; DictionaryError when the firmware has none."""
        found = self.responses.get(name)
        if found is None or not set(fields) <= set(found.names):
            raise DictionaryError(f"the firmware has no response {name} with {list(fields)}")
        return found

    def number(self, name: str) -> int:
        """A constant that is a positive number; DictionaryError when there is none."""
        found = self.constants.get(name)
        if not isinstance(found, int) or found <= 0:
            raise DictionaryError(f"the firmware does not state {name}")
        return found

    def listed(self, field: str, name: str) -> int:
        """The number of a name in an enumeration, a pin's for one; DictionaryError for a name it does not have."""
        found = self.enumerations.get(field, {}).get(name)
        if found is None:
            raise DictionaryError(f"the board has no {field} {name}")
        return found

    def text(self, number: int) -> str:
        """A text that the firmware sends as a number: why it shut down."""
        for name, value in self.enumerations.get("static_string_id", {}).items():
            if value == number:
                return name
        return f"reason {number}"

    def read(self, payload: bytes) -> list[tuple[str, Fields]]:
        """The messages of a block; what follows one that is unknown or broken is left out."""
        found: list[tuple[str, Fields]] = []
        place = 0
        try:
            while place < len(payload):
                number, place = vlq.decoded(payload, place)
                message = self.replies.get(number)
                if message is None:
                    break
                fields, place = message.decoded(payload, place)
                found.append((message.name, fields))
        except vlq.Malformed:
            pass
        return found


BARE = Dictionary(
    commands={IDENTIFY.name: IDENTIFY},
    responses={IDENTIFIED.name: IDENTIFIED},
    replies={IDENTIFIED.number: IDENTIFIED},
    enumerations={},
    constants={},
    version="",
)
"""What every board understands: how to ask for its dictionary."""


def unpacked(data: bytes) -> Dictionary:
    """The dictionary in the bytes that ``identify`` gave; DictionaryError."""
    if len(data) > LARGEST:
        raise DictionaryError(f"the dictionary has more than {LARGEST} bytes")
    packed = zlib.decompressobj()
    try:
        text = packed.decompress(data, LARGEST_TEXT)
        if not packed.eof:
            more = bool(packed.unconsumed_tail)
            raise DictionaryError(
                f"the dictionary unpacks to more than {LARGEST_TEXT} bytes" if more else "the dictionary is cut short"
            )
        told = json.loads(text)
    except zlib.error:
        raise DictionaryError("the dictionary is not compressed as it should be") from None
    except (ValueError, RecursionError):
        raise DictionaryError("the dictionary is not JSON") from None
    return parsed(told)


def parsed(told: Any) -> Dictionary:
    """The dictionary that decoded JSON says; DictionaryError."""
    if not isinstance(told, dict):
        raise DictionaryError("the dictionary is not a JSON object")
    commands, responses = _messages(told, "commands"), _messages(told, "responses")
    for fixed, among in ((IDENTIFY, commands), (IDENTIFIED, responses)):
        if among.get(fixed.name, fixed).number != fixed.number:
            raise DictionaryError(f"{fixed.name} has another number than {fixed.number}")
    version = told.get("version", "")
    return Dictionary(
        commands={IDENTIFY.name: IDENTIFY} | commands,
        responses={IDENTIFIED.name: IDENTIFIED} | responses,
        replies={IDENTIFIED.number: IDENTIFIED} | {message.number: message for message in responses.values()},
        enumerations=_enumerations(_table(told, "enumerations")),
        constants={
            name: value
            for name, value in _table(told, "config").items()
            if isinstance(value, int | str) and not isinstance(value, bool)
        },
        version=version[:200] if isinstance(version, str) else "",
    )


def _table(told: dict[str, Any], name: str) -> dict[str, Any]:
    found = told.get(name, {})
    if not isinstance(found, dict):
        raise DictionaryError(f"{name} of the dictionary is not an object")
    return found


def _messages(told: dict[str, Any], name: str) -> dict[str, Message]:
    found: dict[str, Message] = {}
    numbers: set[int] = set()
    for text, number in _table(told, name).items():
        if isinstance(number, bool) or not isinstance(number, int) or not -(1 << 31) <= number < 1 << 31:
            raise DictionaryError(f"{name}: {text[:60]!r} has no number of 32 bits")
        if number in numbers:
            raise DictionaryError(f"{name}: two have the number {number}")
        numbers.add(number)
        message = described(text, number)
        if message is None:
            continue  # of a kind that nothing here sends or reads
        if message.name in found:
            raise DictionaryError(f"{name}: {message.name} is declared twice")
        found[message.name] = message
    return found


def _enumerations(told: dict[str, Any]) -> dict[str, dict[str, int]]:
    """Numbers by name; ``"PC0": [16, 8]`` is eight names, PC0 to PC7."""
    found: dict[str, dict[str, int]] = {}
    total = 0
    for field, names in told.items():
        if not isinstance(names, dict):
            raise DictionaryError(f"enumeration {field[:60]!r} is not an object")
        values = found.setdefault(field, {})
        for name, value in names.items():
            match value:
                case bool():
                    raise DictionaryError(f"enumeration {field[:60]!r}: {name[:60]!r} is no number")
                case int():
                    values[name] = value
                    total += 1
                case [int(first), int(count)] if 0 <= count <= _LARGEST_RANGE - total:
                    stem = name.rstrip("0123456789")
                    start = int(name[len(stem) :][:9] or 0)
                    values |= {f"{stem}{start + k}": first + k for k in range(count)}
                    total += count
                case _:
                    raise DictionaryError(f"enumeration {field[:60]!r}: {name[:60]!r} is no number or range")
            if total > _LARGEST_RANGE:
                raise DictionaryError(f"the enumerations have more than {_LARGEST_RANGE} names")
    return found


class Collected:
    """A dictionary that arrives in parts; ``offset`` is where the next part starts."""

    def __init__(self) -> None:
        self._data = bytearray()

    @property
    def offset(self) -> int:
        """Bytes collected."""
        return len(self._data)

    def add(self, fields: Mapping[str, Value]) -> bool:
        """Take an answer; True when it was the last. One for another offset is an old one. DictionaryError."""
        data = fields["data"]
        if fields["offset"] != self.offset or not isinstance(data, bytes):
            return False
        self._data += data
        if len(self._data) > LARGEST:
            raise DictionaryError(f"the dictionary has more than {LARGEST} bytes")
        return not data

    def dictionary(self) -> Dictionary:
        """What was collected; DictionaryError."""
        return unpacked(bytes(self._data))
