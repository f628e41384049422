"""Random programs of lines, arcs and helices together with the path they mean, by formulas of this file alone.

Nothing here comes from gproof: positions follow from the words that are printed (manual 3.4.1 to 3.4.3, 3.4.5,
3.4.7, 3.4.12, 3.4.14, 3.4.15, 3.4.21 to 3.4.23), arcs from their angle. Lengths are mm in machine coordinates.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

Points = npt.NDArray[np.float64]
Piece = Callable[[Points], Points]
"""From t in 0 ... 1, shape (n,), to positions, shape (n, 3)."""

AXES = "XYZ"
PAIRS = {"G17": (0, 1), "G18": (2, 0), "G19": (1, 2)}
"""The plane's axes in the order in which G3 turns the first towards the second."""

ARC_SAMPLES = 1500


@dataclass
class Offsets:
    """What the machine adds to program coordinates, mm: work by coordinate system, G92, tool length."""

    work: dict[int, list[float]] = field(default_factory=lambda: {1: [0.0] * 3, 2: [0.0] * 3})
    g92: list[float] = field(default_factory=lambda: [0.0] * 3)
    tool: float = 0.0


class RandomPath:
    """A program that grows move by move; ``text`` is the program and ``pieces`` the path it means."""

    def __init__(self, rng: random.Random, start: list[float], offsets: Offsets, tool_1: float = 0.0) -> None:
        self.rng = rng
        self.at = list(start)
        self.offsets = offsets
        self.tool_1 = tool_1
        self.unit = 1.0
        self.absolute = True
        self.plane = "G17"
        self.active = 1
        self.feed_known = False
        self.guard = True
        self.lines = ["G21 G90 G17 G94 G40 G49 G54"]
        self.pieces: list[Piece] = [_still(start)]
        self.guarded: list[bool] = [True]

    @property
    def text(self) -> str:
        return "".join(f"{line}\n" for line in [*self.lines, "M30"])

    def origin(self, axis: int) -> float:
        """Where the program's zero lies."""
        tool = self.offsets.tool if axis == 2 else 0.0
        return self.offsets.work[self.active][axis] + self.offsets.g92[axis] + tool

    # -- state changes

    def change_state(self) -> None:
        """One line of settings, now and then."""
        rng = self.rng
        kind = rng.randrange(10)
        if kind == 9:
            self.guard = not self.guard
            self.lines.append(f"TCAGuard {'on' if self.guard else 'off'}")
        elif kind == 0:
            self.absolute = not self.absolute
            self.lines.append("G90" if self.absolute else "G91")
        elif kind == 1:
            self.unit = 25.4 if self.unit == 1.0 else 1.0
            self.lines.append("G21" if self.unit == 1.0 else "G20")
            self.feed_known = False
        elif kind in (2, 3):
            self.plane = rng.choice(sorted(PAIRS))
            self.lines.append(self.plane)
        elif kind == 4:
            self.active = 3 - self.active
            self.lines.append(f"G{53 + self.active}")
        elif kind == 5:
            axis = rng.randrange(3)
            word, value = self.word(rng.uniform(-20, 20))
            system = rng.choice((1, 2))
            self.offsets.work[system][axis] = value
            self.lines.append(f"G10 L2 P{system} {AXES[axis]}{word}")
        elif kind == 6:
            axis = rng.randrange(3)
            word, value = self.word(rng.uniform(-20, 20))
            self.offsets.g92[axis] = 0.0
            self.offsets.g92[axis] = self.at[axis] - value - self.origin(axis)
            self.lines.append(f"G92 {AXES[axis]}{word}")
        elif kind == 7:
            self.offsets.g92 = [0.0] * 3
            self.lines.append("G92.1")
        else:
            self.offsets.tool = 0.0 if self.offsets.tool else self.tool_1
            self.lines.append("G43 H1" if self.offsets.tool else "G49")

    # -- words

    def word(self, length: float) -> tuple[str, float]:
        """The text of a length in mm, in the active unit, and the length that the text means."""
        text = f"{length / self.unit:.{7 if self.unit == 1.0 else 9}f}".rstrip("0")
        return text, float(text) * self.unit

    def place(self, axis: int, goal: float) -> tuple[str, float]:
        """An axis word that goes near ``goal`` (machine), and where it goes."""
        base = self.origin(axis) if self.absolute else self.at[axis]
        text, value = self.word(goal - base)
        return f"{AXES[axis]}{text}", base + value

    def feed(self) -> str:
        """`` F500`` when this move needs it, or now and then."""
        if self.feed_known and self.rng.random() < 0.8:
            return ""
        self.feed_known = True
        return f" F{self.rng.randrange(1, 2000)}"

    # -- moves

    def line_to(self, axes: list[int], goal: list[float]) -> None:
        """G0, G1 or G53 G0 with words for some axes."""
        code = self.rng.choice(("G0", "G1", "G1", "G53 G0"))
        words, end = [], list(self.at)
        for axis in axes:
            if code == "G53 G0":
                text, end[axis] = self.word(goal[axis])
                words.append(f"{AXES[axis]}{text}")
            else:
                word, end[axis] = self.place(axis, goal[axis])
                words.append(word)
        self.lines.append(f"{code} {' '.join(words)}{self.feed() if code == 'G1' else ''}")
        self._go(_straight(self.at, end), end)

    def arc(self) -> None:
        """G2 or G3 by centre or radius, flat or helical, full circles included."""
        rng = self.rng
        u, v = PAIRS[self.plane]
        w = 3 - u - v
        ccw = rng.random() < 0.5
        radius = rng.choice((rng.uniform(0.5, 5), rng.uniform(5, 60)))
        angle = rng.uniform(0, 2 * math.pi)
        if rng.random() < 0.3:
            angle = rng.randrange(4) * math.pi / 2  # starts on an extreme
        by_radius = rng.random() < 0.35
        center_words, center = [], [0.0, 0.0]
        for k, axis in enumerate((u, v)):
            text, value = self.word(-radius * (math.cos(angle), math.sin(angle))[k])
            center[k] = self.at[axis] + value
            center_words.append(f"{'IJK'[axis]}{text}")
        words, end = [], list(self.at)
        full = not by_radius and rng.random() < 0.25
        turn = rng.uniform(0.05, 2 * math.pi - 0.05)
        if rng.random() < 0.2:
            turn = rng.choice((0.5, 1.0, 1.5)) * math.pi
        if by_radius and abs(turn - math.pi) < 0.05:
            turn = 3.0  # by its radius, the centre of a half circle rests on the last digits
        r0 = math.hypot(self.at[u] - center[0], self.at[v] - center[1])
        a0 = math.atan2(self.at[v] - center[1], self.at[u] - center[0])
        for k, axis in enumerate((u, v)):
            goal = center[k] + r0 * (math.cos, math.sin)[k](a0 + (turn if ccw else -turn))
            word, end[axis] = self.place(axis, self.at[axis] if full else goal)
            words.append(word)
        if rng.random() < 0.4:
            word, end[w] = self.place(w, self.at[w] + rng.uniform(-10, 10))
            words.append(word)
        if by_radius:
            # Of the two circles through both ends, R > 0 means the one with the shorter way.
            chord = math.hypot(end[u] - self.at[u], end[v] - self.at[v])
            size = max(r0, chord / 2 * (1 + 1e-6))
            text, value = self.word(size if turn <= math.pi else -size)
            center_words = [f"R{text}"]
            center = _center_by_radius(self.at, end, u, v, value, ccw)
        self.lines.append(f"{'G3' if ccw else 'G2'} {' '.join(words)} {' '.join(center_words)}{self.feed()}")
        if full or math.hypot(end[u] - self.at[u], end[v] - self.at[v]) < 1e-6:
            end[u], end[v] = self.at[u], self.at[v]
        self._go(_arc(self.at, end, center, u, v, ccw), end)

    def drill(self) -> None:
        """G81 or G73 with its moves: over the hole, to R, to the depth, back to where it came from or to R."""
        u, v = PAIRS[self.plane]
        w = 3 - u - v
        if not self.absolute:
            self.absolute = True
            self.lines.append("G90")
        words, end = [], list(self.at)
        for axis in (u, v):
            word, end[axis] = self.place(axis, self.rng.uniform(-40, 40))
            words.append(word)
        r_word, r = self.place(w, self.at[w] + self.rng.uniform(-10, 10))
        depth_word, depth = self.place(w, r - self.rng.uniform(0.5, 20))
        back = self.rng.choice((98, 99))
        code = self.rng.choice(("G81", "G73 Q50"))
        self.lines.append(f"G{back} {code} {' '.join(words)} {depth_word} R{r_word[1:]}{self.feed()}")
        clear = r if back == 99 else max(self.at[w], r)
        for axis, to in ((w, max(self.at[w], r)), (u, end[u]), (w, r), (w, depth), (w, clear)):
            goal = list(self.at)
            goal[axis] = to
            if axis == u:
                goal[v] = end[v]
            self._go(_straight(self.at, goal), goal)

    def _go(self, piece: Piece, end: list[float]) -> None:
        self.pieces.append(piece)
        self.guarded.append(self.guard)
        self.at = end

    def random_move(self, reach: float = 60.0) -> None:
        """A line or an arc, after a change of state now and then."""
        while self.rng.random() < 0.35:
            self.change_state()
        kind = self.rng.random()
        if kind < 0.5:
            self.arc()
        elif kind < 0.6:
            self.drill()
        else:
            axes = sorted(self.rng.sample(range(3), self.rng.randrange(1, 4)))
            self.line_to(axes, [self.rng.uniform(-reach, reach) for _ in range(3)])

    def samples(self, count: int = ARC_SAMPLES) -> Points:
        """(n, 3) points of the whole path, close to one another."""
        t = np.linspace(0.0, 1.0, count)
        return np.concatenate([piece(t) for piece in self.pieces])


def _still(at: list[float]) -> Piece:
    return lambda t: np.tile(np.array(at), (len(t), 1))


def _straight(start: list[float], end: list[float]) -> Piece:
    a, b = np.array(start), np.array(end)
    return lambda t: a + np.outer(t, b - a)


def _arc(start: list[float], end: list[float], center: list[float], u: int, v: int, ccw: bool) -> Piece:
    """A turn about ``center``; start and end at one place: all around."""
    a0 = math.atan2(start[v] - center[1], start[u] - center[0])
    a1 = math.atan2(end[v] - center[1], end[u] - center[0])
    sweep = (a1 - a0) % (2 * math.pi) if ccw else -((a0 - a1) % (2 * math.pi))
    if (start[u], start[v]) == (end[u], end[v]):
        sweep = 2 * math.pi if ccw else -2 * math.pi
    r0 = math.hypot(start[u] - center[0], start[v] - center[1])
    r1 = math.hypot(end[u] - center[0], end[v] - center[1])
    w = 3 - u - v

    def piece(t: Points) -> Points:
        out = np.empty((len(t), 3))
        radius, angle = r0 + (r1 - r0) * t, a0 + sweep * t
        out[:, u] = center[0] + radius * np.cos(angle)
        out[:, v] = center[1] + radius * np.sin(angle)
        out[:, w] = start[w] + (end[w] - start[w]) * t
        return out

    return piece


def _center_by_radius(start: list[float], end: list[float], u: int, v: int, radius: float, ccw: bool) -> list[float]:
    """Both candidates are tried; the one whose sweep fits the sign of R is meant (manual 3.4.3.1)."""
    du, dv = end[u] - start[u], end[v] - start[v]
    chord = math.hypot(du, dv)
    height = math.sqrt(max(0.0, radius * radius - chord * chord / 4))
    candidates = []
    for side in (1.0, -1.0):
        center = [
            (start[u] + end[u]) / 2 - side * height * dv / chord,
            (start[v] + end[v]) / 2 + side * height * du / chord,
        ]
        a0 = math.atan2(start[v] - center[1], start[u] - center[0])
        a1 = math.atan2(end[v] - center[1], end[u] - center[0])
        sweep = (a1 - a0) % (2 * math.pi) if ccw else (a0 - a1) % (2 * math.pi)
        candidates.append((sweep, center))
    candidates.sort(key=lambda found: found[0])
    return candidates[0 if radius > 0 else 1][1]


def nearest(path: RandomPath, low: Points, high: Points) -> float:
    """How far the guarded path stays from a box (negative: how deep it goes in), the largest over the axes.

    Coarse samples first, then ever finer ones around the best places of each piece.
    """

    def distance(points: Points) -> Points:
        return np.maximum(low - points, points - high).max(axis=1)

    best = math.inf
    for piece in (p for p, guarded in zip(path.pieces[1:], path.guarded[1:], strict=True) if guarded):
        t, step = np.linspace(0.0, 1.0, 401), 1 / 400
        for _ in range(5):
            found = distance(piece(t))
            best = min(best, float(found.min()))
            chosen = t[np.argsort(found)[:8]]
            t = np.clip((chosen[:, None] + np.linspace(-step, step, 41)).ravel(), 0.0, 1.0)
            step /= 20
    return best
