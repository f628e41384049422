"""Reads the log of a board emulator: every step in columns, and the events; the form is in ``log``."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from gproof.backend.boards.emulator.log import MAGIC, ROW

Ints = npt.NDArray[np.int64]


class Event(NamedTuple):
    """A row that is no steps; what: its index; value: its count; reason: of a shutdown."""

    kind: str
    what: int
    value: int
    tick: int
    at: int
    boot: int
    reason: str = ""


@dataclass(slots=True)
class Steps:
    """Every step made, in columns: motor (its step pin), tick, direction (1, -1), boot; in the order of the log."""

    motor: Ints
    tick: Ints
    direction: Ints
    boot: Ints

    def of(self, motor: int) -> tuple[Ints, Ints]:
        """Ticks and directions of one motor."""
        chosen = self.motor == motor
        return self.tick[chosen], self.direction[chosen]


@dataclass(slots=True)
class Told:
    """A log as it was read; complete: the last row is whole."""

    steps: Steps
    events: list[Event] = field(default_factory=list)
    complete: bool = True

    def stops(self) -> list[Event]:
        """The shutdowns."""
        return [event for event in self.events if event.kind == "X"]


def read(source: Path | bytes | bytearray) -> Told:
    """Read a log; ValueError when it is none. A last row that is not whole is left out."""
    data = source.read_bytes() if isinstance(source, Path) else bytes(source)
    if data[: len(MAGIC)] != MAGIC:
        raise ValueError("no log of the board emulator")
    data = data[len(MAGIC) :]
    complete = len(data) % ROW.size == 0
    rows = list(_rows(data[: len(data) - len(data) % ROW.size]))
    table = np.array([row[1:] for row in rows if row[0] == "S"], dtype=np.int64).reshape(-1, 7)
    motor, direction, count, last, interval, add, boot = table.T
    place = np.arange(int(count.sum()), dtype=np.int64) - np.repeat(np.cumsum(count) - count, count)
    made = place + 1
    ticks = np.repeat(last, count) + made * np.repeat(interval, count) + np.repeat(add, count) * (made * place // 2)
    steps = Steps(np.repeat(motor, count), ticks, np.repeat(direction, count), np.repeat(boot, count))
    return Told(steps, [row for row in rows if isinstance(row, Event)], complete)


def _rows(data: bytes) -> Iterator[tuple[str, int, int, int, int, int, int, int] | Event]:
    """Steps as kind, motor, direction, count, tick, interval, add, boot; events."""
    boot, place = -1, 0
    while place < len(data):
        letter, index, direction, count, tick, interval, add, at = ROW.unpack_from(data, place)
        kind = letter.decode("ascii", "replace")
        place += ROW.size
        boot += kind == "B"
        if kind == "S":
            yield kind, index, direction, count, tick, interval, add, boot
            continue
        text = ""
        if kind == "X":
            text = data[place : place + index].decode("utf-8", "replace")
            place += -(-index // ROW.size) * ROW.size
        yield Event(kind, index, count, tick, at, boot, text)
