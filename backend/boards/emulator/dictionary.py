"""What the board says that it understands: commands, responses, pins, reasons of a shutdown."""

from __future__ import annotations

import json
import zlib
from dataclasses import dataclass

from gproof.backend.boards.emulator.wire import Short, number, signed, take_number

VERSION = "gproof-emulator-1"

PLAIN = """
identify offset=%u count=%c
get_config
get_clock
get_uptime
emergency_stop
clear_shutdown
reset
config_reset
allocate_oids count=%c
finalize_config crc=%u
config_stepper oid=%c step_pin=%c dir_pin=%c invert_step=%c step_pulse_ticks=%u
queue_step oid=%c interval=%u count=%hu add=%hi
set_next_step_dir oid=%c dir=%c
reset_step_clock oid=%c clock=%u
stepper_get_position oid=%c
stepper_stop_on_trigger oid=%c trsync_oid=%c
config_digital_out oid=%c pin=%u value=%c default_value=%c max_duration=%u
queue_digital_out oid=%c clock=%u on_ticks=%u
update_digital_out oid=%c value=%c
set_digital_out pin=%u value=%c
config_endstop oid=%c pin=%c pull_up=%c
endstop_home oid=%c clock=%u sample_ticks=%u sample_count=%c rest_ticks=%u pin_value=%c trsync_oid=%c trigger_reason=%c
endstop_query_state oid=%c
config_trsync oid=%c
trsync_start oid=%c report_clock=%u report_ticks=%u expire_reason=%c
trsync_set_timeout oid=%c clock=%u
trsync_trigger oid=%c reason=%c
""".split("\n")[1:-1]

CERTIFIED = """
cert_begin identity=%*s
cert_section number=%u clock=%u
cert_commit clock=%u
cert_rest
cert_finish clock=%u
cert_get_state
cert_get_motor oid=%c
cert_get_identity
""".split("\n")[1:-1]

ANSWERS = """
identify_response offset=%u data=%.*s
config is_config=%c crc=%u is_shutdown=%c move_count=%hu
clock clock=%u
uptime high=%u clock=%u
shutdown clock=%u static_string_id=%hu
is_shutdown static_string_id=%hu
starting
stepper_position oid=%c pos=%i
endstop_state oid=%c homing=%c next_clock=%u pin_value=%c
trsync_state oid=%c can_trigger=%c trigger_reason=%c clock=%u
""".split("\n")[1:-1]

CERTIFIED_ANSWERS = """
cert_state state=%c section=%u promise=%u stopped=%u
cert_motor oid=%c steps=%u pos=%i crc=%u
cert_identity identity=%*s
""".split("\n")[1:-1]

IN_SHUTDOWN = frozenset(
    "identify get_config get_clock get_uptime emergency_stop clear_shutdown reset config_reset "
    "cert_get_state cert_get_motor cert_get_identity".split()
)
"""Commands that are executed in a shutdown too."""

REASONS = (
    "Timer too close",
    "Move queue overflow",
    "Can't reset time when stepper active",
    "Invalid count parameter",
    "Invalid oid type",
    "Command request",
    "Shutdown cleared when not shutdown",
    "Already finalized",
    "Not finalized",
    "oids already allocated",
    "Can't assign oid",
    "Not a free pin",
    "Invalid command",
    "Command parser error",
    "config_reset only available when shutdown",
    "Missed scheduling of next digital out event",
    "Requested by a fault schedule",
    "Not certified",
    "Promise expired",
)

_FIRST_REASON = 2


@dataclass(frozen=True, slots=True)
class Chip:
    """A chip: the places of its move pool and the letters of its ports, eight pins each; Hz."""

    name: str
    moves: int
    ports: str
    most_oids: int
    frequency: int


CHIPS = {
    chip.name: chip
    for chip in (Chip("atmega2560", 678, "ABCDEFGHJKL", 64, 16_000_000), Chip("atmega328p", 122, "BCD", 24, 16_000_000))
}


@dataclass(frozen=True, slots=True)
class Form:
    """A message: its number, its name, its fields; text: fields that are bytes; signs: bits of signed fields."""

    number: int
    name: str
    fields: tuple[str, ...]
    kinds: tuple[str, ...]

    def encoded(self, *values: int | bytes) -> bytes:
        """The bytes of it."""
        parts = [number(self.number)]
        for value in values:
            if isinstance(value, bytes):
                parts.append(number(len(value)))
                parts.append(value)
            else:
                parts.append(number(value))
        return b"".join(parts)

    def decoded(self, data: bytes, place: int) -> tuple[list[int | bytes], int]:
        """The values of the fields after its number, cut to the widths that it states; Short."""
        values: list[int | bytes] = []
        for kind in self.kinds:
            value, place = take_number(data, place)
            if kind.endswith("s"):
                if place + value > len(data):
                    raise Short
                values.append(data[place : place + value])
                place += value
            elif kind == "%c":
                values.append(value & 0xFF)
            elif kind == "%hu":
                values.append(value & 0xFFFF)
            elif kind == "%hi":
                values.append(signed(value, 16))
            elif kind == "%i":
                values.append(signed(value))
            else:
                values.append(value)
        return values, place


def form(text: str, told: int) -> Form:
    """A message from its description."""
    name, *fields = text.split()
    pairs = [field.split("=") for field in fields]
    return Form(told, name, tuple(p[0] for p in pairs), tuple(p[1] for p in pairs))


class Language:
    """The messages of one board. without: commands that it does not have."""

    def __init__(self, chip: Chip, *, certified: bool, baud: int, window: int, without: frozenset[str] = frozenset()):
        texts = [*PLAIN, *(CERTIFIED if certified else ())]
        if unknown := without - {text.split()[0] for text in texts}:
            raise ValueError(f"no command {', '.join(sorted(unknown))} to leave out")
        texts = [text for text in texts if text.split()[0] not in without]
        # identify is 1 and its answer 0; some numbers are negative, as real dictionaries have them.
        numbers = [1, *(k if k < 24 else 24 - k - 1 for k in range(2, len(texts) + 1))]
        told = dict(zip(texts, numbers, strict=True))
        answers = {text: k for k, text in enumerate([*ANSWERS, *(CERTIFIED_ANSWERS if certified else ())])}
        answers = {text: k if k == 0 else 64 + k for text, k in answers.items()}
        self.commands = {found.number: found for found in (form(*pair) for pair in told.items())}
        self.answers = {found.name: found for found in (form(*pair) for pair in answers.items())}
        self.reasons = {text: k for k, text in enumerate(REASONS, _FIRST_REASON)}
        config: dict[str, int | str] = {
            "CLOCK_FREQ": chip.frequency,
            "MCU": chip.name,
            "SERIAL_BAUD": baud,
            "RECEIVE_WINDOW": window,
        }
        if certified:
            config["GPROOF_CERT"] = 1
        text = json.dumps(
            {
                "app": "gproof",
                "version": VERSION,
                "build_versions": "",
                "commands": told,
                "responses": answers,
                "output": {},
                "enumerations": {
                    "pin": {f"P{port}0": [8 * (ord(port) - 65), 8] for port in chip.ports},
                    "static_string_id": self.reasons,
                },
                "config": config,
            },
            separators=(",", ":"),
        )
        self.packed = zlib.compress(text.encode(), 9)

    def answer(self, name: str, *values: int | bytes) -> bytes:
        """A response as bytes."""
        return self.answers[name].encoded(*values)
