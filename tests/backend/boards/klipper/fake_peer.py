"""A board for tests of the host: a few commands of the protocol, in simulated time, with a line that spoils bytes.

Written from the protocol's description alone: it uses nothing of the host. Times are the host's seconds.
"""

from __future__ import annotations

import json
import zlib
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field

COMMANDS = {
    "identify offset=%u count=%c": 1,
    "get_config": 2,
    "get_clock": 3,
    "get_uptime": 4,
    "allocate_oids count=%c": 5,
    "config_stepper oid=%c step_pin=%c dir_pin=%c invert_step=%c step_pulse_ticks=%u": 6,
    "finalize_config crc=%u": 7,
    "queue_step oid=%c interval=%u count=%hu add=%hi": -3,
    "set_next_step_dir oid=%c dir=%c": 9,
    "reset_step_clock oid=%c clock=%u": 10,
    "stepper_get_position oid=%c": 11,
    "emergency_stop": 12,
    "clear_shutdown": 100,
    "config_digital_out oid=%c pin=%u value=%c default_value=%c max_duration=%u": 14,
    "queue_digital_out oid=%c clock=%u on_ticks=%u": 15,
}
RESPONSES = {
    "identify_response offset=%u data=%.*s": 0,
    "config is_config=%c crc=%u is_shutdown=%c move_count=%hu": 20,
    "clock clock=%u": 21,
    "uptime high=%u clock=%u": 22,
    "stepper_position oid=%c pos=%i": 23,
    "shutdown clock=%u static_string_id=%hu": 24,
    "is_shutdown static_string_id=%hu": 25,
    "starting": 26,
}
REASONS = {"Command request": 1, "Timer too close": 2, "Move queue overflow": 3, "Not in shutdown": 4, "Not idle": 5}
DICTIONARY = {
    "commands": COMMANDS,
    "responses": RESPONSES,
    "enumerations": {"pin": {"PA0": [0, 8], "PB0": [8, 8]}, "static_string_id": REASONS},
    "config": {"CLOCK_FREQ": 16_000_000, "MCU": "fake", "RECEIVE_WINDOW": 192},
    "version": "fake-1",
}
NAMES = {number: text.split(" ")[0] for text, number in COMMANDS.items()}
NUMBERS = {text.split(" ")[0]: number for text, number in RESPONSES.items()}
COUNTS = {text.split(" ")[0]: text.count("=") for text in COMMANDS}


def crc(data: bytes) -> int:
    value = 0xFFFF
    for byte in data:
        value ^= byte
        for _ in range(8):
            value = value >> 1 ^ (0x8408 if value & 1 else 0)
    return value


def number(value: int) -> bytes:
    value = (value + 2**31) % 2**32 - 2**31
    out = [value & 0x7F]
    while not -(2 ** (7 * len(out) - 2)) <= value < 3 * 2 ** (7 * len(out) - 2):
        out.insert(0, value >> (7 * len(out)) & 0x7F | 0x80)
    return bytes(out)


def numbers(data: bytes) -> list[int]:
    found, value, first = [], 0, True
    for byte in data:
        if first and byte & 0x60 == 0x60:
            value = -1
        value, first = value << 7 | byte & 0x7F, False
        if not byte & 0x80:
            found.append(value)
            value, first = 0, True
    return found


@dataclass
class Stepper:
    last: int = 0
    direction: int = 0
    position: int = 0
    runs: deque[list[int]] = field(default_factory=deque)
    edges: list[tuple[int, int]] = field(default_factory=list)

    def until(self, clock: int) -> None:
        while self.runs and self.last + self.runs[0][0] <= clock:
            run = self.runs[0]
            self.last += run[0]
            sign = 1 if run[3] else -1
            self.position += sign
            self.edges.append((self.last, sign))
            run[0] += run[2]
            run[1] -= 1
            if not run[1]:
                self.runs.popleft()


class FakePeer:
    """A line with a board at its end.

    spoil: called with each piece of bytes and whether it goes to the board; what it returns arrives. rate: ticks a
    host second.
    """

    def __init__(
        self,
        *,
        rate: float = 16e6,
        origin: int = 5_000_000_000,
        places: int = 678,
        baud: int = 250_000,
        delay: float = 0.0005,
        spoil: Callable[[bytes, bool], bytes] = lambda data, _: data,
    ) -> None:
        self.t = 0.0
        self.rate, self.origin, self.places, self.byte, self.delay = rate, origin, places, 10 / baud, delay
        self.spoil = spoil
        self.dictionary = zlib.compress(json.dumps(DICTIONARY).encode())
        self.there: deque[tuple[float, int]] = deque()
        self.back: deque[tuple[float, bytes]] = deque()
        self.busy = self.busy_back = 0.0
        self.buffer = b""
        self.expected = 0
        self.crc: int | None = None
        self.shutdown: int | None = None
        self.steppers: dict[int, Stepper] = {}
        self.outputs: list[tuple[int, int, int]] = []
        self.commands: list[tuple[str, list[int]]] = []
        self.answering = self.open = True
        self.most_flying = 0

    # The line, as the host has it.

    def now(self) -> float:
        return self.t

    def write(self, data: bytes) -> None:
        if not self.open:
            raise self.gone()
        begin = max(self.t, self.busy)
        for k, byte in enumerate(self.spoil(data, True)):
            self.there.append((begin + (k + 1) * self.byte + self.delay, byte))
        self.busy = begin + len(data) * self.byte
        self.most_flying = max(self.most_flying, len(self.there))

    def read(self, until: float) -> bytes:
        if not self.open:
            raise self.gone()
        while True:
            if self.back and self.back[0][0] <= self.t:
                return self.back.popleft()[1]
            nxt = min([until] + [q[0][0] for q in (self.there, self.back) if q])
            self.t = max(self.t, nxt)
            while self.there and self.there[0][0] <= self.t:
                self._byte(self.there.popleft()[1])
            if self.t >= until and not (self.back and self.back[0][0] <= self.t):
                return b""

    def close(self) -> None:
        pass

    def gone(self) -> Exception:
        from gproof.backend.boards.klipper.lines import LineLost

        return LineLost("unplugged")

    # The board.

    def clock(self) -> int:
        clock = self.origin + int(self.t * self.rate)
        if self.shutdown is None:
            for stepper in self.steppers.values():
                stepper.until(clock)
        return clock

    def made(self) -> tuple[int, ...]:
        """Steps made by now, by motor."""
        self.clock()
        return tuple(len(stepper.edges) for stepper in self.steppers.values())

    def reset(self) -> None:
        """Power off and on."""
        self.origin, self.expected, self.crc, self.shutdown = -int(self.t * self.rate), 0, None, None
        self.steppers, self.buffer = {}, b""

    def _byte(self, byte: int) -> None:
        self.buffer += bytes([byte])
        while self.buffer:
            if self.buffer[0] == 0x7E:
                self.buffer = self.buffer[1:]
                continue
            size = self.buffer[0]
            good = 5 <= size <= 64 and (len(self.buffer) < 2 or self.buffer[1] & 0xF0 == 0x10)
            if good and len(self.buffer) < size:
                return
            if good:
                good = self.buffer[size - 1] == 0x7E and crc(self.buffer[: size - 3]) == int.from_bytes(
                    self.buffer[size - 3 : size - 1], "big"
                )
            if not good:
                cut = self.buffer.find(b"\x7e")
                if cut < 0:
                    self.buffer = b""
                    return
                self.buffer = self.buffer[cut + 1 :]
                self._send(b"")
                continue
            frame, self.buffer = self.buffer[:size], self.buffer[size:]
            if frame[1] & 15 == self.expected:
                self.expected = (self.expected + 1) & 15
                self._dispatch(frame[2:-3])
            self._send(b"")

    def _send(self, payload: bytes) -> None:
        if not self.answering:
            return
        head = bytes([5 + len(payload), 0x10 | self.expected]) + payload
        data = self.spoil(head + crc(head).to_bytes(2, "big") + b"\x7e", False)
        self.busy_back = max(self.t, self.busy_back) + len(data) * self.byte
        if data:
            self.back.append((self.busy_back + self.delay, data))

    def say(self, name: str, *values: int) -> None:
        self._send(number(NUMBERS[name]) + b"".join(map(number, values)))

    def stop(self, reason: str) -> None:
        if self.shutdown is None:
            clock = self.clock()
            self.shutdown = REASONS[reason]
            for stepper in self.steppers.values():
                stepper.runs.clear()
            self.say("shutdown", clock & 0xFFFFFFFF, self.shutdown)

    def _dispatch(self, payload: bytes) -> None:
        words = numbers(payload)
        while words:
            name = NAMES[words.pop(0)]
            args = [words.pop(0) for _ in range(COUNTS[name])]
            self.commands.append((name, args))
            clock = self.clock()
            if self.shutdown is not None and name not in ("identify", "get_config", "clear_shutdown", "emergency_stop"):
                self.say("is_shutdown", self.shutdown)
                continue
            getattr(self, f"do_{name}")(clock, *(a & 0xFFFFFFFF if name != "queue_step" else a for a in args))

    def do_identify(self, _: int, offset: int, count: int) -> None:
        part = self.dictionary[offset : offset + count]
        self._send(number(0) + number(offset) + number(len(part)) + part)

    def do_get_config(self, _: int) -> None:
        config = (self.crc is not None, self.crc or 0, self.shutdown is not None, self.places)
        self.say("config", *map(int, config))

    def do_get_clock(self, clock: int) -> None:
        self.say("clock", clock & 0xFFFFFFFF)

    def do_get_uptime(self, clock: int) -> None:
        self.say("uptime", clock >> 32, clock & 0xFFFFFFFF)

    def do_allocate_oids(self, _: int, count: int) -> None:
        pass

    def do_config_stepper(self, _: int, oid: int, *pins: int) -> None:
        self.steppers[oid] = Stepper()

    def do_config_digital_out(self, _: int, *pins: int) -> None:
        pass

    def do_finalize_config(self, _: int, crc: int) -> None:
        self.crc = crc

    def do_queue_step(self, clock: int, oid: int, interval: int, count: int, add: int) -> None:
        stepper, interval = self.steppers[oid], interval & 0xFFFFFFFF
        if not stepper.runs and not clock < stepper.last + interval < clock + 2**31:
            self.stop("Timer too close")
        elif sum(len(s.runs) for s in self.steppers.values()) >= self.places:
            self.stop("Move queue overflow")
        else:
            stepper.runs.append([interval, count, add, stepper.direction])

    def do_set_next_step_dir(self, _: int, oid: int, direction: int) -> None:
        self.steppers[oid].direction = direction

    def do_reset_step_clock(self, clock: int, oid: int, word: int) -> None:
        if self.steppers[oid].runs:
            self.stop("Not idle")
        else:
            self.steppers[oid].last = clock + (word - clock + 2**31) % 2**32 - 2**31

    def do_stepper_get_position(self, _: int, oid: int) -> None:
        self.say("stepper_position", oid, self.steppers[oid].position)

    def do_emergency_stop(self, _: int) -> None:
        self.stop("Command request")

    def do_clear_shutdown(self, _: int) -> None:
        if self.shutdown is None:
            self.stop("Not in shutdown")
        else:
            self.shutdown = None

    def do_queue_digital_out(self, clock: int, oid: int, word: int, on: int) -> None:
        self.outputs.append((oid, clock + (word - clock + 2**31) % 2**32 - 2**31, on))
