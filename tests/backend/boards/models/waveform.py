"""A value change dump read back, by the format alone: levels of pins by tick, and the steps that a drive would see."""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

SECONDS = {"s": 1, "ms": 10**3, "us": 10**6, "ns": 10**9, "ps": 10**12, "fs": 10**15}


@dataclass
class Waveform:
    """first: levels at the start; changes: (tick, level) by pin."""

    first: dict[str, int]
    changes: dict[str, list[tuple[int, int]]]

    def edges(self, pin: str, level: int) -> list[int]:
        """Ticks at which a pin goes to a level."""
        return [tick for tick, to in self.changes[pin] if to == level]

    def level(self, pin: str, tick: int) -> int:
        """The level that a pin has had since a tick or before."""
        return next((to for at, to in reversed(self.changes[pin]) if at <= tick), self.first[pin])


def read(path: Path, frequency: int) -> Waveform:
    text = path.read_text(encoding="ascii")
    number, unit = re.search(r"\$timescale\s+(\d+)\s*(\w+)\s+\$end", text).groups()
    names = dict(re.findall(r"\$var wire 1 (\S+) (\S+) \$end", text))
    found = Waveform({}, {name: [] for name in names.values()})
    body = text[text.index("$enddefinitions") :]
    time, last, started = -1, -1, False
    for line in body.splitlines()[1:]:
        if line.startswith("#"):
            time = int(line[1:])
            assert time >= last, "time goes back"
            last = time
        elif line.startswith("$"):
            started |= line.startswith("$end") and bool(found.first)
        elif line:
            pin, level = names[line[1:]], int(line[0])
            tick = round(Fraction(time * int(number), SECONDS[unit]) * frequency)
            if not started:
                found.first[pin] = level
            else:
                found.changes[pin].append((tick, level))
    return found


def steps(wave: Waveform, step: str, direction: str, *, active: int = 1, forward: int = 1) -> list[tuple[int, int]]:
    """(tick, direction) of the pulses of a step pin, as a drive reads them: the direction before the edge."""
    return [(tick, 1 if wave.level(direction, tick - 1) == forward else -1) for tick in wave.edges(step, active)]


def turns(wave: Waveform, a: str, b: str) -> list[tuple[int, int]]:
    """(tick, direction) of the states of two channels, A before B counting up."""
    order = [(0, 0), (1, 0), (1, 1), (0, 1)]
    levels = {a: wave.first[a], b: wave.first[b]}
    found = []
    for tick, pin, level in sorted((t, name, to) for name in (a, b) for t, to in wave.changes[name]):
        before = order.index((levels[a], levels[b]))
        levels[pin] = level
        way = (order.index((levels[a], levels[b])) - before) % 4
        assert way in {1, 3}, "both channels at once"
        found.append((tick, 1 if way == 1 else -1))
    return found
