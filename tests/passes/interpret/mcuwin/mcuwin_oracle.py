"""A second reading of DIN programs: a small interpreter of their text, written from the manual and sharing no code.

It knows the moves, modes and coordinates of chapter 3 with calls, jumps and counted loops, on axes X Y Z (mm) and C
(degrees). Where the manual is open it stops (``Stop``), as gproof must; ``random_program`` makes programs for it, most
lines of which have a meaning. Sections: APCI-8001 G-code manual, McuWIN V 2.5.3.133.
"""

from __future__ import annotations

import math
import random
import re
from dataclasses import dataclass, field
from typing import Any

AXES = "XYZC"
OLD = "2.5.3.32"


class Stop(Exception):
    """Line, and whether it is an error, "open", or either of them ("no")."""

    def __init__(self, line: int, kind: str, why: str) -> None:
        super().__init__(f"line {line}: {kind}, {why}")
        self.line, self.kind, self.why = line, kind, why


@dataclass
class Shop:
    """Settings of a machine: see docs/machine-files.md. own_x: mm in the unit that mcfg has for X."""

    version: str = "2.5.3.133"
    inch: bool = False
    seconds: float = 60.0
    absolute: bool | None = False
    axes: str = AXES
    keep: bool = False
    tools: bool = True
    own_x: float = 1.0
    table: tuple[tuple[float, ...], ...] = ((10.0, 20.0, -5.0, 45.0), (-4.0, 7.5, 0.0, 0.0))


@dataclass
class Oracle:
    """Runs a text; rows: (line, what, place by axis, centre and turns or None, feed or None)."""

    text: list[str]
    shop: Shop = field(default_factory=Shop)

    def __post_init__(self) -> None:
        s = self.shop
        self.rows: list[tuple[Any, ...]] = []
        self.at = dict.fromkeys(AXES, 0.0)
        self.zero = dict.fromkeys(AXES, 0.0)
        self.absolute, self.mode_open = True, False
        self.unit = 25.4 if s.inch else 1.0
        self.mirror: set[str] = set()
        self.factor = {"X": -1.0, "Y": -1.0}
        self.factor_open: set[str] = set()
        self.radius: dict[str, float | None] = {}
        self.plane = 17
        self.plane_open = False
        self.interpolating = set(s.axes)
        self.feed: float | None = None
        self.ask = False
        self.seconds = s.seconds
        self.centre = s.absolute
        self.last_centre: tuple[float, float] | None = None
        self.low: dict[str, tuple[float, float]] = {}
        self.high: dict[str, tuple[float, float]] = {}
        """Limits as counted from machine zero and from the zero offset: 3.29 does not say which."""
        self.outside: list[int] = []
        self.doubtful_limit = False
        self.values: dict[str, float] = {}
        self.stored: dict[str, float] | None = None
        self.budget = 2000
        self.persist, self.distances = self._source_order()
        self.labels = {m[1]: n for n, t in enumerate(self.text) if (m := re.match(r"(?:L|%)(\d+)", t))}
        self.main = next((n for n, t in enumerate(self.text) if re.match(r"%\d+$", t) and n), len(self.text))

    # ---- what the order of the source decides (3.1)

    def _source_order(self) -> tuple[list[str], list[str]]:
        persist, distances = [], []
        state, mode = "", "G90"
        old = self.shop.version == OLD
        for text in self.text:
            persist.append(state)
            if text.startswith("%"):
                state = "?" if state else ""
            if text.startswith("$") and state and not self.shop.keep:
                state = "?"
            for letter, number in re.findall(r"([GM])(\d+)", text) if not text.startswith("$") else ():
                code = int(number)
                if letter == "M":
                    state = "" if old else state
                elif code in (0, 1, 2, 3) or (code == 92 and not old):
                    state = f"G{code}"
                elif code == 4 and not old:
                    state = ""
                elif state and not self.shop.keep:
                    state = "?"
                if code in (90, 91) and letter == "G":
                    mode = f"G{code}"
            distances.append(mode)
        return persist, distances

    # ---- flow

    def run(self) -> Stop | None:
        """None when the program ends at M30."""
        try:
            self._lines(1, self.main)
        except Stop as stop:
            return None if stop.kind == "end" else stop
        return Stop(self.main, "no", "no end")

    def _lines(self, first: int, last: int) -> None:
        n = first
        while n < last:
            self.budget -= 1
            if self.budget < 0:
                raise Stop(n, "long", "too long")
            text = self.text[n]
            if match := re.match(r"\$for (CI\d+) := (\d+) to (\d+) do begin", text):
                end = self._end_of(n)
                for k in range(int(match[2]), int(match[3]) + 1):
                    self.values[match[1]] = float(k)
                    self._lines(n + 1, end)
                n = end + 1
                continue
            if match := re.match(r"\$if (.*) then begin", text):
                end = self._end_of(n)
                if self._value(match[1].replace("=", "=="), n):
                    self._lines(n + 1, end)
                n = end + 1
                continue
            if match := re.fullmatch(r"M96 L(\d+)", text):
                n = self.labels[match[1]]
                continue
            if match := re.fullmatch(r"M98 L(\d+)(?: O(\d+))?", text):
                for _ in range(int(match[2] or 1)):
                    try:
                        self._lines(self.labels[match[1]] + 1, len(self.text))
                    except Stop as stop:
                        if stop.kind != "return":
                            raise
                n += 1
                continue
            if text == "M17":
                raise Stop(n, "return", "")
            if text == "M30":
                raise Stop(n, "end", "")
            if match := re.fullmatch(r"(C[DI]\d+) := (.*)", text):
                self.values[match[1]] = self._value(match[2], n)
            elif not re.fullmatch(r"L\d+|%.*|", text):
                self._block(n, text)
            n += 1

    def _end_of(self, n: int) -> int:
        depth = 0
        for k in range(n, len(self.text)):
            depth += self.text[k].endswith("begin")
            if self.text[k].startswith("$end"):
                depth -= 1
                if depth == 0:
                    return k
        raise AssertionError

    def _value(self, text: str, n: int) -> float:
        names = {**self.values}
        for axis in AXES:
            if f"{axis}.tp" in text:
                # Only where all readings of "target" are one.
                if (
                    self.zero[axis]
                    or axis in self.mirror
                    or axis in self.radius
                    or self.unit != 1.0
                    or self.own(axis) != 1.0
                ):
                    raise Stop(n, "long", "tp")
                text = text.replace(f"{axis}.tp", f"tp_{axis}")
                names[f"tp_{axis}"] = self.at[axis]
        try:
            return float(eval(text, {"__builtins__": {}}, names))
        except NameError:
            raise Stop(n, "no", "no value") from None

    # ---- a line

    def _block(self, n: int, text: str) -> None:
        parts: list[tuple[str, dict[str, float]]] = []
        loose: dict[str, float] = {}
        own: str | None = None
        words: dict[str, float] = {}
        owner = words
        found = re.findall(r"([A-Z])\s*(\((?:[^()]|\([^()]*\))*\)|[-+]?[\d.]+)?", text)
        for letter, value in found:
            if letter in "GM":
                code = f"{letter}{int(value)}"
                if code in ("G0", "G1", "G2", "G3"):
                    own, owner = code, words
                else:
                    parts.append((code, {}))
                    owner = parts[-1][1] if code in ("G39", "G51", "G60", "G92", "G98", "G99") else words
                continue
            number = self._value(value, n) if value else 0.0
            if letter in "FS":
                loose[letter] = number
            elif letter in AXES:
                owner[letter] = number
            else:
                words[letter] = number
        motion = own
        if own is None and words:
            others = [code for code, _ in parts if code[0] == "G"]
            if self.persist[n] == "?" or (others and not self.shop.keep):
                raise Stop(n, "open", "what goes on")
            if not self.persist[n]:
                raise Stop(n, "error", "nothing goes on")
            motion = self.persist[n]
            if motion == "G92" and set(words) & set("IJK"):
                raise Stop(n, "error", "centre")
            if motion == "G92":
                parts.append(("G92", words))
                words, motion = {}, None
        if self.shop.version == OLD:
            self.absolute = self.distances[n] == "G90"
        for code, values in parts:
            self._mode(n, code, values)
        if "F" in loose:
            if loose["F"] < 0:
                raise Stop(n, "error", "F")
            self.feed, self.ask = loose["F"] * self.unit * 60.0 / self.seconds, False
        if motion and words:
            self._move(n, motion, words)

    def _mode(self, n: int, code: str, values: dict[str, float]) -> None:
        number = int(code[1:])
        if code[0] == "M":
            return
        match number:
            case 17 | 18 | 19:
                is_open = number != 17 and not self.shop.tools
                if (number, is_open) != (self.plane, self.plane_open):
                    self.last_centre = None
                self.plane, self.plane_open = number, is_open
            case 21 | 22 | 23:
                self.mirror |= {21: {"Y"}, 22: {"X"}, 23: {"X", "Y"}}[number]
            case 24:
                self.mirror = set()
                self.factor_open |= {a for a in "XY" if self.factor[a] != -1.0}
            case 39:
                if not values:
                    self.factor, self.factor_open = {"X": -1.0, "Y": -1.0}, set()
                for axis, value in values.items():
                    if value == 0.0:
                        raise Stop(n, "error", "factor 0")
                    self.factor[axis] = value
                    self.factor_open -= {axis}
            case 51:
                for axis, value in values.items():
                    self.radius[axis] = value * self.unit
            case 53:
                for axis in self.interpolating:
                    self.zero[axis] = 0.0
                self.mode_open = self.mode_open or not self.absolute
            case 54 | 55:
                axes = set(AXES) if self.shop.version == OLD else self.interpolating
                for axis in axes:
                    self.zero[axis] = self.shop.table[number - 54][AXES.index(axis)]
            case 60:
                self.interpolating = set(values)
            case 70 | 71:
                unit = 25.4 if number == 70 else 1.0
                if unit != self.unit:
                    self.ask = self.feed is not None
                    self.radius = dict.fromkeys(self.radius)
                    self.last_centre = None
                self.unit = unit
            case 90 | 91:
                self.absolute, self.mode_open = number == 90, False
            case 92:
                for axis, value in values.items():
                    doubt = self.unit != self.own(axis) if axis != "C" else axis in self.radius
                    if value and (doubt or axis in self.mirror):
                        raise Stop(n, "open", "G92 counts how")
                    if self.mode_open and self.zero[axis]:
                        raise Stop(n, "open", "G92 behind G53")
                    base = 0.0 if self.absolute or self.mode_open else self.zero[axis]
                    self.zero[axis] = base + value * self.own(axis)
            case 94:
                self.ask = self.ask or (self.seconds != 60.0 and self.feed is not None)
                self.seconds = 60.0
            case 98 | 99:
                for axis, value in values.items():
                    doubt = self.unit != self.own(axis) if axis != "C" else axis in self.radius
                    if not self.absolute or axis in self.mirror or doubt:
                        raise Stop(n, "open", "limit")
                    limit = value * self.own(axis)
                    (self.low if number == 98 else self.high)[axis] = both = (limit, limit + self.zero[axis])
                    here = self.at[axis]
                    past = {each > here + 1e-9 if number == 98 else each < here - 1e-9 for each in both}
                    self.doubtful_limit |= len(past) == 2
                    if past == {True}:
                        self.outside.append(n)
            case 153:
                if self.unit != (25.4 if self.shop.inch else 1.0) or self.radius:
                    raise Stop(n, "long", "unit of CD50")
                for k, axis in enumerate(AXES):
                    self.values[f"CD{50 + k}"] = self.zero[axis] / (1.0 if axis == "C" else self.unit)
            case 154:
                if self.unit != (25.4 if self.shop.inch else 1.0) or self.radius:
                    raise Stop(n, "long", "unit of CD50")
                for k, axis in enumerate(AXES):
                    if f"CD{50 + k}" not in self.values:
                        raise Stop(n, "open", "G154")
                    self.zero[axis] = self.values[f"CD{50 + k}"] * (1.0 if axis == "C" else self.unit)
            case 161:
                self.centre, self.last_centre = True, None
            case 162:
                self.centre, self.last_centre = False, None

    def own(self, axis: str) -> float:
        """mm or degrees in the axis's own unit (3.1)."""
        return self.shop.own_x if axis == "X" else 1.0

    def by(self, axis: str) -> float:
        """What a word of an axis is multiplied by (3.9 to 3.13)."""
        return self.factor[axis] if axis in self.mirror else 1.0

    def scale(self, axis: str, *, rapid: bool) -> float | None:
        """mm or degrees in one of a word (3.1, 3.17, 3.21)."""
        if rapid:
            return self.own(axis)
        if axis != "C":
            return self.unit
        if axis not in self.radius:
            return 1.0
        radius = self.radius[axis]
        return None if radius is None else math.degrees(self.unit / radius)

    def _move(self, n: int, motion: str, words: dict[str, float]) -> None:
        axes = [axis for axis in AXES if axis in words]
        centre = {k: words[k] for k in "IJK" if k in words}
        arc = motion in ("G2", "G3")
        if centre and not arc:
            raise Stop(n, "error", "centre")
        if motion != "G0" and any(axis not in self.interpolating for axis in axes):
            raise Stop(n, "error", "not interpolating")
        if axes and self.mode_open:
            raise Stop(n, "open", "mode behind G53")
        to = dict(self.at)
        for axis in axes:
            scale = self.scale(axis, rapid=motion == "G0")
            if self.absolute and self.by(axis) != 1.0 and self.zero[axis]:
                raise Stop(n, "both", "reflected about")
            if axis in self.mirror and axis in self.factor_open:
                raise Stop(n, "open", "factor")
            if scale is None:
                raise Stop(n, "open", "radius")
            base = self.zero[axis] if self.absolute else self.at[axis]
            to[axis] = base + self.by(axis) * scale * words[axis]
        if arc:
            self._arc(n, motion, axes, centre, to)
            return
        if motion == "G1":
            self._ask(n)
        feed = None if motion == "G0" or self.at["C"] != to["C"] else self.feed
        self._row(n, motion, to, None, feed)

    def _ask(self, n: int) -> None:
        if self.ask:
            raise Stop(n, "no", "feed asked")
        if self.feed == 0.0:
            raise Stop(n, "error", "feed 0")

    def _arc(self, n: int, motion: str, axes: list[str], centre: dict[str, float], to: dict[str, float]) -> None:
        if self.plane_open:
            raise Stop(n, "open", "plane without tools")
        u, v = {17: "XY", 18: "ZX", 19: "YZ"}[self.plane]
        words = {"X": "I", "Y": "J", "Z": "K"}
        if "C" in axes:
            raise Stop(n, "open", "C beside an arc")
        if u not in self.interpolating or v not in self.interpolating:
            raise Stop(n, "error", "plane not interpolating")
        if any(k not in (words[u], words[v]) for k in centre):
            raise Stop(n, "error", "centre out of plane")
        for axis in (u, v):
            if axis in self.mirror and axis in self.factor_open:
                raise Stop(n, "open", "factor")
        if abs(abs(self.by(u)) - abs(self.by(v))) > 1e-9:
            raise Stop(n, "error", "ellipse")
        if not centre:
            raise Stop(n, "error", "no centre")
        given = {a: centre.get(words[a]) for a in (u, v)}
        names = sorted((u, v))
        for k, axis in enumerate(names):
            if given[axis] is None:
                if self.last_centre is not None and self.last_centre[k] != 0.0:
                    raise Stop(n, "open", "centre kept")
                if self.absolute and self.centre is not False:
                    raise Stop(n, "open", "centre left out")
        value = {a: (given[a] or 0.0) * self.unit for a in (u, v)}
        self.last_centre = (value[names[0]], value[names[1]])
        relative = {a: self.at[a] + self.by(a) * value[a] for a in (u, v)}
        place = relative
        if self.absolute and self.centre is not False:
            for a in (u, v):
                if self.by(a) != 1.0 and self.zero[a]:
                    raise Stop(n, "both", "reflected about")
            place = {a: self.zero[a] + self.by(a) * value[a] for a in (u, v)}
            if self.centre is None and any(abs(place[a] - relative[a]) > 1e-6 for a in (u, v)):
                raise Stop(n, "open", "centres places or not")
        start = math.hypot(self.at[u] - place[u], self.at[v] - place[v])
        end = math.hypot(to[u] - place[u], to[v] - place[v])
        if start < 1e-6:
            raise Stop(n, "error", "no radius")
        if abs(start - end) > 1e-3:
            raise Stop(n, "error", "radii")
        turns = 1 if motion == "G3" else -1
        if self.by(u) * self.by(v) < 0:
            turns = -turns
        self._ask(n)
        self._row(n, motion, to, (u, v, place, turns), self.feed)

    def _row(self, n: int, motion: str, to: dict[str, float], arc: Any, feed: float | None) -> None:
        places = [to]
        watched = [axis for axis in AXES if axis in self.low or axis in self.high]
        if arc is not None and watched:
            u, v, place, turns = arc
            a = math.atan2(self.at[v] - place[v], self.at[u] - place[u])
            b = math.atan2(to[v] - place[v], to[u] - place[u])
            sweep = ((b - a) * turns) % (2 * math.pi)
            if sweep < 1e-6 or sweep > 2 * math.pi - 1e-6:
                sweep = 2 * math.pi
            radius = math.hypot(self.at[u] - place[u], self.at[v] - place[v])
            for k in range(1, 720):
                angle = a + turns * sweep * k / 720
                places.append({**to, u: place[u] + radius * math.cos(angle), v: place[v] + radius * math.sin(angle)})
        for axis in watched:
            # A sample of an arc lies up to 1e-5 of its radius inside the extreme.
            least, most = min(p[axis] for p in places), max(p[axis] for p in places)
            for past in (
                {least < low - 1e-3 for low in self.low.get(axis, (-math.inf,))},
                {most > high + 1e-3 for high in self.high.get(axis, (math.inf,))},
            ):
                self.doubtful_limit |= len(past) == 2
                if past == {True}:
                    self.outside.append(n)
        if arc is not None or any(abs(to[a] - self.at[a]) > 1e-9 for a in AXES):
            centre = None if arc is None else (arc[0] + arc[1], arc[2][arc[0]], arc[2][arc[1]], arc[3])
            self.rows.append((n + 1, motion, tuple(to[a] for a in AXES), centre, feed))
        self.at = to


# ---- programs


def _number(rand: random.Random, size: float = 20.0) -> str:
    value = rand.choice([0, 1, 2.5, -3, 7, rand.uniform(-size, size)])
    return f"{value:.4f}".rstrip("0").rstrip(".") if value else "0"


def _axis_words(rand: random.Random, axes: str = "XYZ", most: int = 3) -> str:
    letters = rand.sample(axes, rand.randint(1, min(most, len(axes))))
    return " ".join(f"{a}{_number(rand)}" for a in sorted(letters, key=AXES.index))


def _an_arc(rand: random.Random, o: Oracle, code: str) -> str:
    """An arc that fits where the interpreter now stands."""
    u, v = {17: "XY", 18: "ZX", 19: "YZ"}[o.plane]
    third = next(a for a in "XYZ" if a not in (u, v))
    words = {"X": "I", "Y": "J", "Z": "K"}
    r, s = rand.choice([(3, 4), (5, 0), (0, 2.5), (6, 8), (1, 1)])
    i, j = rand.choice([1, -1]) * r, rand.choice([1, -1]) * s
    du, dv = rand.choice([(2 * i, 2 * j), (i - j, j + i), (i + j, j - i), (0, 0), (i + j, i + j), (0, 2 * j)])
    parts = []
    if (du, dv) != (0, 0) or rand.random() < 0.5:
        for axis, d in ((u, du), (v, dv)):
            if o.absolute:
                d += (o.at[axis] - o.zero[axis]) / (o.by(axis) * o.unit)
            parts.append(f"{axis}{d:.6f}")
    if rand.random() < 0.3:
        parts.append(f"{third}{_number(rand)}")
    for axis, d in ((u, i), (v, j)):
        if o.absolute and o.centre is not False:
            d += (o.at[axis] - o.zero[axis]) / (o.by(axis) * o.unit)
        if d or rand.random() < 0.7:
            parts.append(f"{words[axis]}{d:.6f}")
    return " ".join([*([code] if code else []), *parts])


def _line(rand: random.Random, o: Oracle) -> str:
    draw = rand.random()
    if draw < 0.22:
        return f"{rand.choice(['G00', 'G0', ''])} {_axis_words(rand, AXES)}".strip()
    if draw < 0.42:
        feed = f" F{rand.choice([100, 250, 30.5])}" if rand.random() < 0.3 or o.ask else ""
        return f"{rand.choice(['G01', 'G01', ''])} {_axis_words(rand, rand.choice(['XYZ', AXES]))}{feed}".strip()
    if draw < 0.6:
        return _an_arc(rand, o, rand.choice(["G02", "G03", "G02", "G03", ""]))
    if draw < 0.66:
        target = f"CD{rand.choice([600, 601, 602])}"
        return f"{target} := {rand.choice(['3', '-2.5', 'CD600 + 1', 'CD601 * 2 - CD600', 'X.tp', '(CD602)'])}"
    if draw < 0.72:
        a = rand.choice("XYZ")
        value = rand.choice(["CD600", "CD601 / 2", "2 * CD602", f"{a}.tp + 1", "-CD600", "CI600 * 3"])
        return f"{rand.choice(['G00', 'G01', ''])} {a}({value})".strip()
    words = _axis_words(rand)
    return rand.choice([
        "G17", "G18", "G19", "G21", "G22", "G23", "G24", f"G39 X{_number(rand, 3)}", "G39 X-2 Y-2", "G39 X2 Y-2", "G39",
        "G51 C20", "G51 C12.5", "G53", "G54", "G55", "G60 X Y Z", "G60 X Y Z C", "G60 X Z C", "G70", "G71", "G90",
        "G91", "G90", "G91", f"G92 {words}", f"G92 {words}", f"G92 C{_number(rand)}", "G94", f"G98 {words}",
        f"G99 {words}", "G98 X-9 Y-60 Z-12", "G99 X60 Y9 Z12", "G153", "G154", "G161", "G162", "G04 1", "M26 102",
        "F200", "F60", "M08", f"G90 G00 {words}", f"G91 G01 {words}", f"G54 G00 {words}", f"G70 G01 {words} F10",
        "G71 F90", "G150", "G40",
    ])  # fmt: skip


def random_program(rand: random.Random, shop: Shop, size: int = 25) -> list[str]:
    """Lines; nearly all of them, as the interpreter runs them, have a meaning."""
    text = ["%1", rand.choice(["G90", "G91"]), "F100", "CD600 := 1.5", "CD601 := -4", "CD602 := 2", "CI600 := 1"]
    subs: list[str] = []
    names = iter(range(10, 9999))
    tries = 0

    def fits(more: list[str], library: list[str]) -> bool:
        o = Oracle([*text, *more, "M30", *library], shop)
        stop = o.run()
        if stop is not None and stop.kind == "long":
            return False
        if any(abs(p) > 300 for row in o.rows for p in row[2]):
            return False
        if o.outside and rand.random() < 0.4:
            return False
        return stop is None or rand.random() < 0.03

    def now() -> Oracle:
        o = Oracle([*text, "M30", *subs], shop)
        o.run()
        return o

    while len(text) < size and tries < 12 * size:
        tries += 1
        draw = rand.random()
        if draw < 0.85 or shop.version == OLD:
            line = _line(rand, now())
            if shop.version == OLD and line.startswith("G60"):
                continue  # whether a second one counts is open there, axis by axis
            if fits([line], subs):
                text.append(line)
            continue
        body = [_line(rand, now()) for _ in range(rand.randint(1, 4))]
        library = subs
        name = next(names)
        if draw < 0.9:
            more = [f"$for CI{600 + rand.randint(1, 3)} := 1 to {rand.randint(1, 3)} do begin", *body, "$end;"]
        elif draw < 0.93:
            more = [f"$if CI600 {rand.choice('<>=')} {rand.randint(0, 2)} then begin", *body, "$end;"]
        elif draw < 0.96:
            # The source says what goes on behind a jump, not the way that was taken (3.1).
            more = [f"M96 L{name}", *body, f"L{name}"]
        else:
            more = [f"M98 L{name}" + rand.choice(["", " O2", " O3"])]
            library = [*subs, f"%{name}", *body, "M17"]
        if fits(more, library):
            text, subs = [*text, *more], library
    return [*text, "M30", *subs]
