"""What the writers of random programs share: numbers, where the axes are, arcs, and which statement comes next.

A program is sound: it sets its modes before it uses them, arcs fit their centres, F comes before the first feed, and a
place that is not known is left by absolute words of all axes. It knows the manuals, and nothing of gproof.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

INCH = 25.4
CENTER = {"X": "I", "Y": "J", "Z": "K"}
PLANES = {"XY": "XY", "ZX": "XZ", "YZ": "YZ"}
"""By the right-handed pair of axes: the name of the plane."""


@dataclass(frozen=True)
class Made:
    """A program of a seed; files: what it calls, by name."""

    dialect: str
    extension: str
    text: str
    files: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Arc:
    """Words of an arc in program units: end and centre from the start, clockwise as in the pair; rise: across it."""

    pair: str
    clockwise: bool
    by: tuple[float, float]
    center: tuple[float, float]
    radius: float
    rise: float
    full: bool

    @property
    def is_long(self) -> bool:
        """More than half a circle."""
        (dx, dy), (cx, cy) = self.by, self.center
        begin, end = math.atan2(-cy, -cx), math.atan2(dy - cy, dx - cx)
        return ((begin - end) if self.clockwise else (end - begin)) % math.tau > math.pi


class Writer:
    """Writes line by line. size: mm of a unit; at: program places in mm, those that are not known left out; without:
    kinds of statements that it does not use."""

    kinds: tuple[tuple[str, int], ...] = ()
    """Names of methods with how often they come."""
    nested: frozenset[str] = frozenset()
    """Kinds that only the top level has."""

    def __init__(self, rng: random.Random, without: frozenset[str]) -> None:
        self.rng = rng
        self.without = without
        self.lines: list[str] = []
        self.size = 1.0
        self.relative = False
        self.at: dict[str, float] = {}
        self.deep = 0
        self.code = ""
        """The motion code that a line without one would have, "" for none."""

    # ---- numbers

    def say(self, line: str) -> None:
        self.lines.append(line)

    def chance(self, part: float) -> bool:
        return self.rng.random() < part

    @property
    def digits(self) -> int:
        return 4 if self.size == INCH else 3

    def length(self, reach: float = 60.0) -> float:
        """A length in program units."""
        return round(self.rng.uniform(-reach, reach) / self.size, self.digits)

    def above(self, least: float, reach: float) -> float:
        """A positive length in program units, given in mm."""
        return round(self.rng.uniform(least, reach) / self.size, self.digits)

    @staticmethod
    def text(value: float, digits: int = 5) -> str:
        """A number as people write it."""
        told = f"{value:.{digits}f}".rstrip("0").rstrip(".")
        return "0" if told in {"", "-0"} else told

    def number(self, value: float) -> tuple[str, bool]:
        """A word's number, and whether it is this value for sure."""
        return self.text(value), True

    # ---- places

    def go(self, axis: str, value: float, *, sure: bool = True) -> None:
        """Remember where a word leads."""
        if not sure:
            self.at.pop(axis, None)
        elif not self.relative:
            self.at[axis] = value * self.size
        elif axis in self.at:
            self.at[axis] += value * self.size

    def known(self, letters: str = "XYZ") -> bool:
        return all(axis in self.at for axis in letters)

    def words(self, letters: str = "XYZ", reach: float = 60.0) -> str:
        """Words of some of the axes."""
        chosen = [a for a in letters if self.chance(0.55)] or [self.rng.choice(letters)]
        found = []
        for axis in chosen:
            value = self.length(reach if axis != "Z" else reach / 3)
            text, sure = self.number(value)
            self.go(axis, value, sure=sure)
            found.append(f"{axis}{text}")
        return " ".join(found)

    def all_words(self) -> str:
        """Literal words of X, Y and Z."""
        found = []
        for axis, reach in (("X", 50.0), ("Y", 50.0), ("Z", 15.0)):
            value = self.length(reach)
            self.go(axis, value)
            found.append(f"{axis}{self.text(value)}")
        return " ".join(found)

    def arc_words(self, planes: tuple[str, ...] = ("XY",)) -> Arc:
        """An arc from the present place in one of the planes, its numbers with so many digits that it is one."""
        rng = self.rng
        pair = rng.choice(planes)
        digits = 5 if self.size == INCH else 4
        radius = self.above(1.0, 30.0)
        begin, sweep = rng.uniform(0, math.tau), rng.uniform(0.2, 6.0)
        # A circle ends where it starts, in all digits.
        exact = all(
            abs(round(self.at.get(axis, 0.0) / self.size, 5) * self.size - self.at.get(axis, 0.0)) < 1e-9
            for axis in pair
        )
        full = self.chance(0.12) and (exact or self.relative)
        if abs(sweep - math.pi) < 0.15:
            sweep = math.pi - 0.3
        clockwise = self.chance(0.5)
        end = begin + (-sweep if clockwise else sweep)
        center = -radius * math.cos(begin), -radius * math.sin(begin)
        by = (0.0, 0.0) if full else (radius * math.cos(end) + center[0], radius * math.sin(end) + center[1])
        rise = self.length(8.0) if self.chance(0.2) else 0.0
        return Arc(
            pair, clockwise, (round(by[0], digits), round(by[1], digits)),
            (round(center[0], digits), round(center[1], digits)), radius, rise, full,
        )  # fmt: skip

    def arc_ends(self, arc: Arc) -> dict[str, str]:
        """Words of where an arc ends, as the distance mode has them."""
        third = next(a for a in "XYZ" if a not in arc.pair)
        found = {}
        for axis, by in (*zip(arc.pair, arc.by, strict=True), *([(third, arc.rise)] if arc.rise else [])):
            base = 0.0 if self.relative else self.at[axis] / self.size
            value = round(base + by, 5)
            self.go(axis, value)
            found[axis] = self.text(value)
        return found

    # ---- statements

    def modes(self) -> object:
        """The modes that statements within a block may change."""
        return self.size, self.relative

    def block(self, count: int, first: Callable[[], None] | None = None) -> None:
        """Statements within a loop, a choice or a subprogram: where it starts and ends is open, its modes are not."""
        before = self.modes()
        self.at, self.code = {}, ""
        self.deep += 1
        if first is not None:
            first()
        for _ in range(count):
            self.any()
        self.deep -= 1
        self.at, self.code = {}, ""
        if self.modes() != before:
            self.restore(before)

    def restore(self, before: Any) -> None:
        """Say the modes that were in force."""
        raise NotImplementedError

    def any(self) -> None:
        """One statement, whatever comes."""
        names = [
            (name, weight) for name, weight in self.kinds
            if name not in self.without and not (self.deep and name in self.nested) and self.deep < 3
        ] or [("move", 1)]  # fmt: skip
        (name,) = self.rng.choices([name for name, _ in names], [weight for _, weight in names])
        getattr(self, name)()

    def captured(self, write: Callable[[], None]) -> list[str]:
        """The lines that something writes, not said."""
        kept, self.lines = self.lines, []
        write()
        found, self.lines = self.lines, kept
        return found
