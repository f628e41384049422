"""Random jobs with stock, as a program and as the ways that its tools go.

A scene writes down what it does in many forms (absolute, by increments, in subprograms, with offsets of the program's
own, in expressions, behind questions that nobody can answer) and knows its ways without reading them. Where the tool
table is silent the truth is one of the tools that it may be.
"""

from __future__ import annotations

import math
import random

import numpy as np
from passes.checks.stock.stock_shapes import random_stock, random_tool
from passes.checks.stock.stock_solid import Floats, Way

from passes.checks.stock import stock_solid as solid


class Scene:
    """A random job; ``ways``: for each outcome of its question; ``text``; ``bodies``: stock, and what is true of it."""

    def __init__(self, seed: int) -> None:
        rng = self.rng = random.Random(seed)
        self.seed = seed
        self.top, self.wide, self.deep = self.n(-2, 2), self.n(15, 40), self.n(15, 40)
        self.floor = round(self.top - self.n(4, 20), 3)
        self.bodies = random_stock(rng, (self.wide, self.deep, self.floor, self.top))
        self.tools = [random_tool(rng, k + 1) for k in range(rng.choice((1, 1, 2, 3)))]
        self.cell = rng.choice((0.5, 1.0, 2.0, 5.0))
        self.clearance = rng.choice((0.0, 0.0, 0.5, 1.0))
        self.straight = rng.random() < 0.8
        self.levels = [round(self.top - self.n(0, self.top - self.floor), 3) for _ in range(3)]
        self.lines: list[str] = []
        self.ways: list[list[Way]] = [[], []]
        self.now: tuple[int, ...] = (0, 1)
        self.shift = np.zeros(3)
        self.by_steps = False
        self.at = np.zeros(3)
        self.tool = self.tools[0][1]
        self._write()
        self.text = "\n".join(self.lines) + "\n"

    def n(self, low: float, high: float) -> float:
        return round(self.rng.uniform(low, high), 3)

    # What is written.

    def say(self, text: str) -> int:
        self.lines.append(text)
        return len(self.lines)

    def word(self, letter: str, value: float) -> str:
        value = round(value, 4) + 0.0
        if self.rng.random() < 0.05:
            return f"{letter}[#1+{value - 2.25:.4f}]" if value >= 2.25 else f"{letter}[{value + 1:.4f}-1]"
        return f"{letter}{value:.4f}"

    def words(self, to: Floats) -> str:
        said = []
        for letter, value, was, shift in zip("XYZ", to, self.at, self.shift, strict=True):
            if value != was or self.rng.random() < 0.3:
                said.append(self.word(letter, value - was if self.by_steps else value - shift))
        return " ".join(said)

    def note(self, line: int, steps_: list[solid.Step], *, feed: bool, asked: bool = True) -> None:
        for k in self.now:
            self.ways[k].append(Way(self.tool, line, feed, steps_, asked))

    def go(self, to: Floats, *, feed: bool, asked: bool = True) -> None:
        to = np.round(to, 4) + 0.0
        said = self.words(to)
        if not said:
            return
        line = self.say(("G1 " if feed else "G0 ") + said)
        if feed:
            taken = solid.line(self.at, to, solid.STEPS)
        elif self.straight or not asked:
            taken = solid.line(self.at, to)
        else:
            taken, place = [], self.at
            for axis in self.rng.sample((0, 1, 2), 3):
                corner = place.copy()
                corner[axis] = to[axis]
                taken += solid.line(place, corner)
                place = corner
        self.note(line, taken, feed=feed, asked=asked)
        self.at = to

    def turn(self) -> None:
        """An arc or a helix, mostly level, sometimes standing."""
        rng = self.rng
        u, v, w = rng.choice(((0, 1, 2), (0, 1, 2), (0, 1, 2), (2, 0, 1), (1, 2, 0)))
        i, j = self.n(-8, 8), self.n(-8, 8)
        radius = math.hypot(i, j)
        if radius < 0.2:
            return
        center = self.at.copy()
        center[u] += i
        center[v] += j
        begin = math.atan2(-j, -i)
        sweep = rng.choice((1, -1)) * rng.choice((2 * math.pi, rng.uniform(0.2, 6)))
        to = self.at.copy()
        if abs(sweep) < 6.1:
            to[u], to[v] = center[u] + radius * math.cos(begin + sweep), center[v] + radius * math.sin(begin + sweep)
        to[w] += rng.choice((0.0, 0.0, self.n(-2, 2)))
        to = np.round(to, 4) + 0.0
        if abs(sweep) >= 6.1 and to[u] == self.at[u] and to[v] == self.at[v]:
            sweep = math.copysign(2 * math.pi, sweep)
        else:
            ends = math.atan2(to[v] - center[v], to[u] - center[u]) - begin
            sweep = math.copysign((math.copysign(1.0, sweep) * ends) % (2 * math.pi), sweep)
        letters = {0: "I", 1: "J", 2: "K"}
        plane = {2: "G17", 1: "G18", 0: "G19"}[w]
        if plane != "G17":
            self.say(plane)
        said = " ".join(
            self.word(letter, value - was if self.by_steps else value - shift)
            for letter, value, was, shift in zip("XYZ", to, self.at, self.shift, strict=True)
        )
        code = "G3" if sweep > 0 else "G2"
        line = self.say(f"{code} {said} {letters[u]}{i:.4f} {letters[v]}{j:.4f}")
        self.note(line, solid.arc(self.at, to, center, sweep, (u, v, w)), feed=True)
        if plane != "G17":
            self.say("G17")
        self.at = to

    def change(self) -> None:
        """Another tool, high up."""
        self.go(np.array([self.at[0], self.at[1], self.top + 30]), feed=False)
        if self.by_steps:
            self.manner()
        entry, truth = self.rng.choice(self.tools)
        was = next(each for each, other in self.tools if other is self.tool)
        self.say(f"T{entry.number} M6")
        self.say(f"G43 H{entry.number}")
        assert entry.length is not None
        assert was.length is not None
        self.tool = truth
        self.at = np.round(self.at + np.array([0.0, 0.0, was.length - entry.length]), 4)
        self.go(np.array([self.at[0], self.at[1], self.top + 30]), feed=False)

    def manner(self) -> None:
        """Increments or not."""
        self.by_steps = not self.by_steps
        self.say("G91" if self.by_steps else "G90")

    def offset(self) -> None:
        """An offset of the program's own."""
        shift = np.round([self.n(-20, 20), self.n(-20, 20), self.n(-5, 5)], 3)
        self.shift = shift
        place = self.at - shift
        self.say("G92 " + " ".join(f"{c}{v + 0.0:.4f}" for c, v in zip("XYZ", place, strict=True)))

    def piece(self) -> None:
        """A few moves of one kind."""
        rng, n, top = self.rng, self.n, self.top
        kind = rng.choice(
            ("plunge", "across", "across", "ramp", "turn", "turn", "traverse", "up", "over", "back", "pocket", "down")
        )
        there = np.array([n(-5, self.wide + 5), n(-5, self.deep + 5), self.at[2]])
        x, y, z = self.at
        level = rng.choice(self.levels)
        if kind == "plunge":
            self.go(np.array([x, y, level]), feed=True)
        elif kind == "across":
            self.go(there if rng.random() < 0.5 else np.array([there[0], y, z]), feed=True)
        elif kind == "ramp":
            self.go(np.array([there[0], there[1], level]), feed=True)
        elif kind == "turn":
            self.turn()
        elif kind == "traverse":
            self.go(there, feed=False)
        elif kind == "up":
            self.go(np.array([x, y, top + rng.choice((0, 0.5, 2, 10.0))]), feed=False)
        elif kind == "over":
            self.go(np.array([x, y, top + 5]), feed=False)
            self.go(np.array([there[0], there[1], top + 5]), feed=False)
        elif kind == "back" and self.kept:
            x, y, z = rng.choice(self.kept)
            self.go(np.array([self.at[0], self.at[1], top + 5]), feed=False)
            self.go(np.array([x, y, top + 5]), feed=False)
            self.go(np.array([x, y, z + rng.choice((0, 0.1, 1))]), feed=False)
        elif kind == "pocket":
            if z > top:
                self.go(np.array([x, y, level]), feed=True)
            for k in range(rng.randint(2, 6)):
                self.go(np.array([x + (8 if k % 2 == 0 else 0), self.at[1], self.at[2]]), feed=True)
                self.go(np.array([self.at[0], y + self.tool.cutter.radius * 1.2 * (k + 1), self.at[2]]), feed=True)
            if rng.random() < 0.7:
                self.go(np.array([x + n(0, 8), y + n(0, 4), self.at[2] + rng.choice((0, 0.2))]), feed=False)
        elif kind == "down":
            self.go(np.array([x, y, level]), feed=False)
        if kind in ("plunge", "across", "ramp", "turn"):
            self.kept.append(self.at.copy())

    def _write(self) -> None:
        rng = self.rng
        self.kept: list[Floats] = []
        self.say("#1=2.25")
        sub = rng.random() < 0.3
        if sub:
            self._subprogram()
        self.say("G21 G17 G90 G94 G54 G40 G49 G61")
        self.say("T1 M6")
        self.say("G43 H1")
        self.say("M3 S1000")
        self.say("F600")
        self.go(np.array([self.n(-5, self.wide), self.n(-5, self.deep), self.top + 10.0]), feed=False, asked=False)
        for _ in range(rng.randint(3, 16)):
            form = rng.random()
            if form < 0.06:
                self.manner()
            elif form < 0.1 and not self.by_steps:
                self.offset()
            elif form < 0.18 and len(self.tools) > 1:
                self.change()
            elif form < 0.24 and sub:
                self._call()
            elif form < 0.3 and len(self.now) == 2:
                self._question()
            elif form < 0.33:
                self.say("M0")
            self.piece()
        self.say("M5")
        self.say("M30")

    def _subprogram(self) -> None:
        """Moves by increments that end where they began, written down before anything else."""
        self.say("sub part")
        self.say("G91")
        ring = [np.array([self.n(-8, 8), self.n(-8, 8), 0.0]) for _ in range(3)]
        dips = [(0.0, 0.0, -self.n(5, 12)), *ring]
        self.inside: list[tuple[int, Floats, bool]] = []
        total = np.zeros(3)
        for by in dips:
            delta = np.round(by, 4)
            line = self.say("G1 " + " ".join(f"{c}{v:.4f}" for c, v in zip("XYZ", delta, strict=True)))
            self.inside.append((line, delta, True))
            total = np.round(total + delta, 4)
        for delta in (np.array([0.0, 0.0, -total[2]]), np.array([-total[0], -total[1], 0.0])):
            line = self.say("G0 " + " ".join(f"{c}{v + 0.0:.4f}" for c, v in zip("XYZ", delta, strict=True)))
            self.inside.append((line, delta, False))
        self.say("G90")
        self.say("endsub")

    def _call(self) -> None:
        if self.by_steps:
            self.manner()
        self.say("gosub part")
        straight, self.straight = self.straight, True
        for line, delta, feed in self.inside:
            to = np.round(self.at + delta, 4)
            if feed or straight or (delta != 0.0).sum() == 1:
                self.note(line, solid.line(self.at, to, solid.STEPS if feed else 1), feed=feed)
            else:
                corner = np.array([to[0], self.at[1], to[2]])
                self.note(line, [*solid.line(self.at, corner), *solid.line(corner, to)], feed=feed)
            self.at = to
        self.straight = straight

    def _question(self) -> None:
        """Some moves on one answer, others or none on the other; both end where they began."""
        if self.by_steps:
            self.manner()
        self.say("if [#100 > 0]")
        begin = self.at.copy()
        for k in (0, 1):
            self.now = (k,)
            if k == 1:
                self.say("else")
            for _ in range(self.rng.randint(0, 2)):
                self.piece()
            high = np.array([self.at[0], self.at[1], self.top + 12])
            self.go(high, feed=False)
            self.go(np.array([begin[0], begin[1], self.top + 12]), feed=False)
            self.go(begin, feed=False)
        self.now = (0, 1)
        self.say("endif")
