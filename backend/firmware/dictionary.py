"""Makes messages.h and messages.c from messages.txt: numbers, the table of commands, the compressed dictionary.

As a script: ``python dictionary.py messages.txt CHIP PROFILE FOLDER``, PROFILE ``certified`` or ``plain``.
"""

from __future__ import annotations

import json
import re
import sys
import zlib
from dataclasses import dataclass, field
from pathlib import Path

VERSION = "1"
CLOCK_HZ = 16_000_000
RECEIVE_WINDOW = 192
BAUD = 250_000
PORTS = {"328p": "BCD", "2560": "ABCDEFGHJKL"}
MCU = {"328p": "atmega328p", "2560": "atmega2560"}
STEP_RATE = 20_000
"""Steps a second of all motors together that are made within -64 … +640 cycles of their ticks."""
TICKS = {"GPROOF_STEP_TICKS": 600, "GPROOF_RUN_TICKS": 6000}
"""What the processor takes for a step and for a run that comes, with its part of blocks, promises and acknowledgements:
measured as 560 and 5,400 on both chips."""
IDENTIFY = {"identify_response": 0, "identify": 1}
"""The two numbers that a host knows before it has the dictionary."""
ALSO_STOPPED, HAS_BYTES = 0x80, 0x40


@dataclass
class Messages:
    """What messages.txt says: formats and numbers of commands and responses, texts of stops, what a profile has."""

    commands: dict[str, int] = field(default_factory=dict)
    responses: dict[str, int] = field(default_factory=dict)
    also_stopped: set[str] = field(default_factory=set)
    strings: dict[str, str] = field(default_factory=dict)


def read(text: str, *, certified: bool) -> Messages:
    """The messages of a profile, numbered in the order of the page."""
    messages = Messages()
    number = 2
    for line in text.splitlines():
        kind, _, rest = line.partition(" ")
        if not rest or kind == "#":
            continue
        if kind == "string":
            name, _, words = rest.partition(" ")
            messages.strings[name] = words
            continue
        form, _, after = rest.partition(" : ")
        marks = set(after.split())
        name = form.split()[0]
        if "proof" in marks and not certified:
            continue
        assigned = IDENTIFY.get(name, number)
        number += name not in IDENTIFY
        (messages.commands if kind == "command" else messages.responses)[form] = assigned
        if "stopped" in marks:
            messages.also_stopped.add(form)
    if number > 95:
        raise ValueError("a number of more than one byte")
    return messages


def dictionary(messages: Messages, chip: str, *, certified: bool) -> bytes:
    """The dictionary that the board sends, compressed."""
    pins = {f"P{port}0": [8 * (ord(port) - ord("A")), 8] for port in PORTS[chip]}
    page = {
        "version": f"gproof-{VERSION}-{'certified' if certified else 'plain'}",
        "app": "gproof",
        "build_versions": "",
        "commands": messages.commands,
        "responses": messages.responses,
        "enumerations": {
            "pin": pins,
            "static_string_id": {text: number for number, text in enumerate(messages.strings.values(), 1)},
        },
        "config": {
            **({"GPROOF_CERT": 1, "GPROOF_STEP_RATE": STEP_RATE, **TICKS} if certified else {}),
            "MCU": MCU[chip],
            "CLOCK_FREQ": CLOCK_HZ,
            "RECEIVE_WINDOW": RECEIVE_WINDOW,
            "SERIAL_BAUD": BAUD,
            "STATS_SUMSQ_BASE": 256,
        },
    }
    return zlib.compress(json.dumps(page, separators=(",", ":"), sort_keys=True).encode(), 9)


def shape(form: str, *, also_stopped: bool) -> int:
    """How a command's arguments are read: how many numbers, with bytes last, executed in a shutdown."""
    kinds = re.findall(r"=%(\S+)", form)
    strings = [kind for kind in kinds if "s" in kind]
    if len(strings) > 1 or (strings and kinds[-1] != strings[0]):
        raise ValueError(f"bytes have to come last: {form}")
    numbers = len(kinds) - len(strings)
    if numbers + 2 * len(strings) > 8:
        raise ValueError(f"more than eight arguments: {form}")
    return numbers | (HAS_BYTES if strings else 0) | (ALSO_STOPPED if also_stopped else 0)


def header(messages: Messages, compressed: bytes) -> str:
    """The text of messages.h."""
    lines = ["#ifndef MESSAGES_H", "#define MESSAGES_H", "#include <stdint.h>", '#include "command.h"']
    lines += [f"#define RESPONSE_{form.split()[0]} {number}" for form, number in messages.responses.items()]
    lines += [f"#define {name} {number}" for number, name in enumerate(messages.strings, 1)]
    lines += [f"void command_{form.split()[0]}(uint32_t *arguments);" for form in messages.commands]
    lines += [f"#define COMMANDS {max(messages.commands.values()) + 1}", f"#define DICTIONARY_SIZE {len(compressed)}"]
    lines += ["extern const struct command commands[COMMANDS];", "extern const uint8_t dictionary[DICTIONARY_SIZE];"]
    lines += ["extern const uint32_t crc_table[256]; /* CRC-32 of zlib */"]
    return "\n".join([*lines, "#endif", ""])


def source(messages: Messages, compressed: bytes) -> str:
    """The text of messages.c."""
    names = {form: form.split()[0] for form in messages.commands}
    lines = ['#include "messages.h"', "#include <avr/pgmspace.h>"]
    lines += ["const struct command commands[COMMANDS] PROGMEM = {"]
    for form, number in messages.commands.items():
        bits = shape(form, also_stopped=form in messages.also_stopped)
        lines.append(f"    [{number}] = {{command_{names[form]}, {bits:#04x}}},")
    lines += ["};", "const uint32_t crc_table[256] PROGMEM = {"]
    table = [zlib.crc32(bytes([byte]), 0xFFFFFFFF) ^ 0xFFFFFFFF for byte in range(256)]
    lines += [", ".join(map(hex, table[at : at + 8])) + "," for at in range(0, 256, 8)]
    lines += ["};", "const uint8_t dictionary[DICTIONARY_SIZE] PROGMEM = {"]
    lines += [", ".join(map(str, compressed[at : at + 20])) + "," for at in range(0, len(compressed), 20)]
    return "\n".join([*lines, "};", ""])


def main(page: str, chip: str, profile: str, folder: str) -> None:
    """Write both files."""
    certified = profile == "certified"
    messages = read(Path(page).read_text(encoding="utf-8"), certified=certified)
    compressed = dictionary(messages, chip, certified=certified)
    Path(folder, "messages.h").write_text(header(messages, compressed), encoding="utf-8")
    Path(folder, "messages.c").write_text(source(messages, compressed), encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
