"""The reference firmware on a simulated AVR, and a client of the boards' protocol that shares no code with the host's.

The protocol is Klipper's public one (docs/boards.md); formats come from the dictionary that the board sends.
"""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import time
import zlib
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
import serial

RUNNER = Path(__file__).resolve().parent.parent / "firmware" / "runner.c"
MCU = {"328p": "atmega328p", "2560": "atmega2560"}
HZ = 16_000_000
MISSING = (
    ""
    if shutil.which("gcc") and shutil.which("avr-gcc") and Path("/usr/include/simavr").is_dir()
    else "no AVR compiler or simulator (Debian: gcc-avr avr-libc libsimavr-dev)"
)


def build_runner(folder: Path) -> Path:
    """The program that simulates; simavr's headers stand in a folder of their own."""
    program = folder / "runner"
    command = [
        "gcc",
        "-O2",
        "-I/usr/include/simavr",
        str(RUNNER),
        "-o",
        str(program),
        "-lsimavr",
        "-lpthread",
        "-lutil",
    ]
    subprocess.run(command, check=True, capture_output=True)
    return program


def crc16(data: bytes) -> int:
    """Reflected polynomial 0x8408, initial 0xFFFF, no final exclusive or."""
    crc = 0xFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0x8408 if crc & 1 else 0)
    return crc


def vlq(number: int) -> bytes:
    """Seven bits a byte, the highest first; uint32 as its int32 image."""
    number = (number + 2**31) % 2**32 - 2**31
    groups = [number & 0x7F]
    while not -32 <= number < 96:
        number >>= 7
        groups.append(0x80 | number & 0x7F)
    return bytes(reversed(groups))


def unvlq(data: bytes, at: int) -> tuple[int, int]:
    """A number and where the next one begins."""
    number = data[at] & 0x7F
    if number & 0x60 == 0x60:
        number -= 0x80
    while data[at] & 0x80:
        at += 1
        number = number << 7 | data[at] & 0x7F
    return number, at + 1


def block(sequence: int, payload: bytes) -> bytes:
    head = bytes([len(payload) + 5, 0x10 | sequence & 15]) + payload
    return head + crc16(head).to_bytes(2, "big") + b"\x7e"


@dataclass(frozen=True)
class Form:
    """A message of the dictionary: its number, its names and kinds of values."""

    number: int
    values: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Answer:
    """What the board said; `values` by name."""

    name: str
    values: dict[str, Any] = field(default_factory=dict)

    def __getitem__(self, name: str) -> Any:
        return self.values[name]


def forms(section: dict[str, int]) -> dict[str, Form]:
    found = {}
    for text, number in section.items():
        name, *values = text.split()
        found[name] = Form(number, tuple((value.split("=%")[0], value.split("=%")[1]) for value in values))
    return found


FIRST = (forms({"identify offset=%u count=%c": 1}), forms({"identify_response offset=%u data=%.*s": 0}))


class Client:
    """Talks with a board: blocks with sequence, retransmission, answers in the order of arrival."""

    def __init__(self, port: str) -> None:
        self.line = serial.Serial(port, 250_000, timeout=0, exclusive=True)
        self.commands, self.responses = FIRST
        self.by_number = {form.number: (name, form) for name, form in self.responses.items()}
        self.received = b""
        self.sequence = 0
        """Of the next block to send."""
        self.acknowledged = 0
        self.flying: list[tuple[int, bytes]] = []
        self.sent_at = 0.0
        self.answers: list[Answer] = []
        self.resent = 0
        self.config: dict[str, Any] = {}
        self.enumerations: dict[str, dict[str, int]] = {}

    # Blocks

    def take(self, wait: float = 0.0) -> bool:
        """Read what came; True when something did. After an acknowledgement the blocks before it are forgotten."""
        self.line.timeout = wait
        data = self.line.read(1) if wait else b""
        data += self.line.read(self.line.in_waiting)
        self.received += data
        while self.received:
            if self.received[0] == 0x7E:
                self.received = self.received[1:]
                continue
            length = self.received[0]
            if len(self.received) < max(length, 2):
                break
            whole, rest = self.received[:length], self.received[length:]
            if not 5 <= length <= 64 or whole[-1] != 0x7E or block(whole[1], whole[2:-3]) != whole:
                cut = self.received.find(b"\x7e")
                self.received = self.received[cut + 1 :] if cut >= 0 else b""
                continue
            self.received = rest
            self.read_block(whole[1] & 15, whole[2:-3])
        return bool(data)

    def read_block(self, sequence: int, payload: bytes) -> None:
        passed = (sequence - self.acknowledged) % 16
        if 0 < passed <= len(self.flying):
            del self.flying[:passed]
            self.acknowledged = sequence
            self.sent_at = time.monotonic()
        at = 0
        while at < len(payload):
            number, at = unvlq(payload, at)
            name, form = self.by_number[number]
            values: dict[str, Any] = {}
            for key, kind in form.values:
                if "s" in kind:
                    values[key], at = payload[at + 1 : at + 1 + payload[at]], at + 1 + payload[at]
                else:
                    value, at = unvlq(payload, at)
                    values[key] = value if kind in ("i", "hi") else value % 2**32
            self.answers.append(Answer(name, values))

    def synchronise(self) -> None:
        """Find the sequence that the board expects: an empty block with the right one is answered by the next."""
        deadline = time.monotonic() + 10
        while time.monotonic() < deadline:
            self.line.write(b"\x7e" + block(self.sequence, b""))
            heard: list[int] = []
            until = time.monotonic() + 0.2
            while time.monotonic() < until and not heard:
                time.sleep(0.005)
                self.received += self.line.read(self.line.in_waiting)
                heard = [part[1] & 15 for part in re.findall(rb"\x05.{3}\x7e", self.received, re.S)]
            self.received = b""
            if heard and heard[-1] == (self.sequence + 1) % 16:
                self.sequence = self.acknowledged = heard[-1]
                return
            if heard:
                self.sequence = heard[-1]
        raise TimeoutError("the board does not answer")

    def send_blocks(self, payloads: list[bytes], window: int = 190, most: int = 12) -> None:
        """Send payloads of at most 59 bytes; returns when the last was acknowledged."""
        deadline = time.monotonic() + 60
        waiting = list(payloads)
        self.sent_at = time.monotonic()
        while waiting or self.flying:
            while (
                waiting
                and len(self.flying) < most
                and sum(len(data) for _, data in self.flying) + len(waiting[0]) + 5 <= window
            ):
                data = block(self.sequence, waiting.pop(0))
                self.flying.append((self.sequence, data))
                self.sequence = (self.sequence + 1) % 16
                self.line.write(data)
                self.sent_at = time.monotonic()
            if not self.take(0.02) and self.flying and time.monotonic() - self.sent_at > 0.5:
                self.line.write(b"\x7e" + b"".join(data for _, data in self.flying))
                self.sent_at = time.monotonic()
                self.resent += 1
            if time.monotonic() > deadline:
                raise TimeoutError("no acknowledgement")

    # Messages

    def encode(self, command: str, **values: Any) -> bytes:
        form = self.commands[command]
        if [name for name, _ in form.values] != list(values):
            raise TypeError(f"{command} takes {form.values}")
        data = vlq(form.number)
        for (name, kind), value in zip(form.values, values.values(), strict=True):
            if "s" in kind:
                data += bytes([len(value)]) + value
            else:
                data += vlq(self.enumerations.get("pin", {}).get(value, 0) if isinstance(value, str) else value)
            if isinstance(value, str) and value not in self.enumerations["pin"]:
                raise KeyError(name, value)
        return data

    def send(self, command: str, **values: Any) -> None:
        self.send_blocks([self.encode(command, **values)])

    def send_many(self, messages: list[bytes]) -> None:
        """Encoded messages, as many a block as fit."""
        blocks = [b""]
        for message in messages:
            if len(blocks[-1]) + len(message) > 59:
                blocks.append(b"")
            blocks[-1] += message
        self.send_blocks(blocks)

    def wait(self, name: str, timeout: float = 30.0, where: Callable[[Answer], bool] = lambda _: True) -> Answer:
        """The next answer of that name; those before it stay."""
        deadline = time.monotonic() + timeout
        while True:
            for index, answer in enumerate(self.answers):
                if answer.name == name and where(answer):
                    return self.answers.pop(index)
            if time.monotonic() > deadline:
                raise TimeoutError(f"no {name}; {self.answers[-5:]}")
            self.take(0.02)

    def ask(self, command: str, answer: str, **values: Any) -> Answer:
        self.answers = [known for known in self.answers if known.name != answer]
        self.send(command, **values)
        return self.wait(answer)

    def identify(self) -> bytes:
        """Read the dictionary, and use it from now on."""
        data = b""
        while True:
            part = self.ask("identify", "identify_response", offset=len(data), count=40)["data"]
            if not part:
                break
            data += part
        page = json.loads(zlib.decompress(data))
        self.commands, self.responses = forms(page["commands"]), forms(page["responses"])
        self.by_number = {form.number: (name, form) for name, form in self.responses.items()}
        self.config = page["config"]
        for kind, names in page["enumerations"].items():
            self.enumerations[kind] = spread(names)
        return data

    def reason(self, number: int) -> str:
        """The text of a shutdown."""
        return next(text for text, value in self.enumerations["static_string_id"].items() if value == number)

    def clock(self) -> int:
        return int(self.ask("get_clock", "clock")["clock"])


def spread(names: dict[str, Any]) -> dict[str, int]:
    """An enumeration's names with their numbers; ``"PB0": [8, 8]`` are eight names."""
    found: dict[str, int] = {}
    for name, value in names.items():
        if isinstance(value, list):
            stem, digit = name[:-1], int(name[-1])
            found |= {f"{stem}{digit + step}": value[0] + step for step in range(value[1])}
        else:
            found[name] = value
    return found


class Simulation:
    """A firmware that runs on a simulated chip: its terminal and its pins. folder: for the edges; speed: times real
    time, 0 as fast as it goes, "told" only as `until` says."""

    def __init__(self, runner: Path, chip: str, firmware: Path, folder: Path, speed: float | str = 0.0) -> None:
        self.chip, self.edges_file = chip, folder / "edges"
        command = [str(runner), MCU[chip], str(firmware), str(self.edges_file), str(speed)]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.port = self.line("port")
        self.written = 0
        """Bytes that the host has sent in all, by a line that counts them."""

    def line(self, word: str) -> str:
        """The rest of the next line that begins with the word; the simulator prints others too."""
        assert self.process.stdout is not None
        for line in self.process.stdout:
            if line.startswith(f"{word} "):
                return line.split(maxsplit=1)[1].strip()
        raise RuntimeError(f"the simulation ended with {self.process.wait()}")

    def say(self, line: str) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(f"{line}\n")
        self.process.stdin.flush()

    def until(self, cycle: int, sent: int) -> tuple[int, int]:
        """Let time pass (told); cycle now, bytes that the board has said in all. sent: bytes to it in all."""
        self.say(f"until {cycle} {sent}")
        now, said = map(int, self.line("at").split())
        return now, said

    def end(self) -> None:
        assert self.process.stdin is not None and self.process.stdout is not None
        self.process.stdin.close()
        self.process.stdout.close()
        try:
            self.process.wait(5)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()

    def flush(self) -> tuple[int, int, int]:
        """Write out the edges; cycle now, cycle at which the clock was 0, bytes of RAM never touched."""
        self.say("flush")
        now, began, spare = map(int, self.line("flushed").split())
        return now, began, spare

    def edges(self) -> np.ndarray:
        """Rows (tick, pin, level) since the start; ticks of the board's clock, not cut to 32 bits."""
        began = self.flush()[1]
        rows = np.fromfile(self.edges_file, dtype="<u8").astype(np.int64)
        return np.column_stack(((rows >> 16) - began, rows >> 8 & 0xFF, rows & 1))


class Board(Simulation):
    """A firmware that runs; its client and its pins."""

    def __init__(self, runner: Path, chip: str, firmware: Path, folder: Path, speed: float = 0.0) -> None:
        super().__init__(runner, chip, firmware, folder, speed)
        self.client: Client = None  # type: ignore[assignment]

    def __enter__(self) -> Board:
        self.client = Client(self.port)
        self.client.synchronise()
        self.client.identify()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.client.line.close()
        self.end()

    def rush(self) -> None:
        """From now on as fast as the simulation goes: all that has to come in time was sent."""
        self.say("speed 0")

    def changes(self, name: str, level: int = 1) -> np.ndarray:
        """Ticks at which a pin changed to a level."""
        edges = self.edges()
        return edges[(edges[:, 1] == self.pin(name)) & (edges[:, 2] == level), 0]

    def pin(self, name: str) -> int:
        return self.client.enumerations["pin"][name]
