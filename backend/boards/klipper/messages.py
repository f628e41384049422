"""Messages by their descriptions: a name, then ``field=%kind`` each; numbers and byte strings.

Kinds: ``%c`` %hu %hi %u %i for 8 to 32 bits, which all travel as VLQ integers; ``%*s``, ``%.*s`` and ``%s`` for byte
strings. Source: Klipper's Protocol.md, "Declaring commands". What is out of its kind's range is an error here: the
firmware would cut it without a word.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

from gproof.backend.boards.klipper import vlq
from gproof.ir.record import record

Value = int | bytes
Fields = dict[str, Value]

RANGES = {
    "%c": (-(1 << 7), (1 << 8) - 1),
    "%hu": (0, (1 << 16) - 1),
    "%hi": (-(1 << 15), (1 << 15) - 1),
    "%u": (0, (1 << 32) - 1),
    "%i": (-(1 << 31), (1 << 31) - 1),
}
"""The least and greatest number of each kind."""

STRINGS = frozenset({"%*s", "%.*s", "%s"})
_UNSIGNED = {"%u": (1 << 32) - 1, "%hu": (1 << 16) - 1, "%c": (1 << 8) - 1}
_FIELD = re.compile(r"([A-Za-z_]\w{0,63})=(%[.*a-z]{1,4})", re.ASCII)
_NAME = re.compile(r"[A-Za-z_]\w{0,63}", re.ASCII)


@record(frozen=True, slots=True)
class Message:
    """A command or response of the dictionary: name, number, and its fields with their kinds, in order."""

    name: str
    number: int
    fields: tuple[tuple[str, str], ...]

    @property
    def names(self) -> tuple[str, ...]:
        """The names of its fields."""
        return tuple(name for name, _ in self.fields)

    def encoded(self, values: Mapping[str, Value]) -> bytes:
        """The message with these values; ValueError where they are not its fields or not within their kinds."""
        if len(values) != len(self.fields) or any(name not in values for name in self.names):
            raise ValueError(f"{self.name} has the fields {list(self.names)}, not {list(values)}")
        parts = [vlq.quick(self.number)]
        for name, kind in self.fields:
            value = values[name]
            if isinstance(value, bytes):
                if kind not in STRINGS:
                    raise ValueError(f"{self.name}: {name} is a number")
                parts.append(vlq.string_encoded(value))
                continue
            least, most = RANGES.get(kind, (0, -1))
            if not least <= value <= most:
                raise ValueError(f"{self.name}: {name}={value} is not within {least} to {most}")
            parts.append(vlq.quick(value))
        return b"".join(parts)

    def decoded(self, data: bytes, place: int) -> tuple[Fields, int]:
        """The fields' values, from after the number, and where the next message starts; vlq.Malformed."""
        found: Fields = {}
        for name, kind in self.fields:
            if kind in STRINGS:
                found[name], place = vlq.string_decoded(data, place)
            else:
                number, place = vlq.decoded(data, place)
                found[name] = number & _UNSIGNED[kind] if kind in _UNSIGNED else number
        return found, place


def described(text: str, number: int) -> Message | None:
    """The message that a description declares; None when it is none that can be read field by field."""
    name, *rest = text.split(" ") if text else [""]
    fields = []
    for word in rest:
        found = _FIELD.fullmatch(word)
        if found is None or (found[2] not in RANGES and found[2] not in STRINGS):
            return None
        fields.append((found[1], found[2]))
    if _NAME.fullmatch(name) is None or len({name for name, _ in fields}) != len(fields):
        return None
    return Message(name, number, tuple(fields))


IDENTIFY = Message("identify", 1, (("offset", "%u"), ("count", "%c")))
IDENTIFIED = Message("identify_response", 0, (("offset", "%u"), ("data", "%.*s")))
"""The only messages whose numbers are fixed: everything else is in the dictionary that they carry."""
