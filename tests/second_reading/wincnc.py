"""A plain interpreter of WinCNC programs, written from the user's guide and from nothing else.

`read` walks a program with the facts of a machine and gives one `Walk` for each reading of what the guide leaves open.
Positions are machine coordinates (MZ), mm and degrees.
"""

from __future__ import annotations

import contextlib
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from .walked import Limits, NotRead, Point, Questions, Refused, Walk, centre_of, every_reading, swept

SIZES = {"in": 25.4, "cm": 10.0, "mm": 1.0}
UNITS = {20: "in", 21: "cm", 22: "mm"}
DRILLS = {73, 81, 82, 83}
STEPS = 20_000
MAPPINGS = ([("L", "11")], [("L", "12")], [("L", "13")])
SILENT_L = {5, 6, 7, 8, 9, 40, 60, 61, 910, 911}


@dataclass
class Facts:
    """What is known of the machine and the moment; mm except `arc_err`, `arc_min`, in the unit of the ini.

    bounds: the workspace boundaries; measures: by axis, the machine position at which its workspace is 0;
    files: subprograms by name.
    """

    limits: Limits
    start: Point
    bounds: Limits = field(default_factory=dict)
    unit: str = "in"
    relative: bool = False
    modal_arcs: bool = False
    local: Point = field(default_factory=dict)
    measures: Point = field(default_factory=dict)
    files: dict[str, str] = field(default_factory=dict)
    positions: dict[int, Point] = field(default_factory=dict)
    arc_err: float = 0.01
    arc_min: float = 0.002


class Returned(Exception):
    """M99."""


@dataclass
class Line:
    """One command: its code with the letter, modes that stand with it, and words in order."""

    number: int
    codes: list[tuple[str, str]]
    words: dict[str, float]
    empty: bool
    called: str = ""
    letters: tuple[str, ...] = ()
    """Those of the words, in order, doubles kept: what L11 to L13 take."""


def value_of(text: str) -> float:
    """A word's number; none is 0; `{a+b}` is computed with numbers (braces)."""
    if not text:
        return 0.0
    if text.startswith("{"):
        found = re.fullmatch(r"\{([\d.]+)([*/+-])([\d.]+)\}", text)
        if found is None:
            raise NotRead(f"braces {text}")
        a, b = float(found[1]), float(found[3])
        if found[2] == "/" and b == 0:
            raise NotRead("division by zero")
        return {"*": a * b, "/": a / b if b else 0.0, "+": a + b, "-": a - b}[found[2]]
    return float(text)


def line_of(number: int, raw: str) -> Line:
    text = raw.strip()
    if text.startswith(("%", "(", "'", ";")):
        if text.startswith(("'", ";")):
            raise NotRead("a character that opens no comment")
        return Line(number, [], {}, empty=True)
    text, bracket, after = text.partition("[")
    if bracket and after.partition("]")[2].strip():
        raise NotRead("text after a comment")
    text = text.strip()
    if not text:
        return Line(number, [], {}, empty=True)
    if found := re.fullmatch(r"(?i)m98(\.1)?\s*([A-Za-z_][\w.]*)", text):
        return Line(number, [("M", "98")], {}, empty=False, called=found[2].lower())
    text = re.sub(r"\s", "", text).upper()
    codes: list[tuple[str, str]] = []
    words: dict[str, float] = {}
    letters: list[str] = []
    at = 0
    while at < len(text):
        piece = re.compile(r"([A-Z])([+-]?(?:\d+\.?\d*|\.\d+)|\{[^}]*\}|)").match(text, at)
        if piece is None:
            raise NotRead(f"what is {text[at:]!r}")
        at = piece.end()
        letter, value = piece.groups()
        if letter in "GLM" and not (
            letter == "L" and codes and codes[-1][0] == "G" and codes[-1][1].lstrip("0") in {"1", "2", "3"}
        ):
            codes.append((letter, plain(value)))
        elif letter in words and codes[:1] not in MAPPINGS:
            raise NotRead("a word twice")
        else:
            letters.append(letter)
            words[letter] = value_of(value)
    return Line(number, codes, words, empty=False, letters=tuple(letters))


def plain(code: str) -> str:
    """`01` is `1`, `92.0` is `92`."""
    number = float(code or "-1")
    return str(int(number)) if number == int(number) else str(number)


class Run:
    """One reading of one program."""

    def __init__(self, program: str, facts: Facts, questions: Questions) -> None:
        self.facts, self.pick = facts, questions.pick
        self.main = [line_of(n, raw) for n, raw in enumerate(program.splitlines(), start=1)]
        self.axes = list(facts.start)
        self.bounds = {a: facts.bounds.get(a, (None, None)) for a in self.axes}
        self.walk = Walk(dict(facts.start), dict(facts.limits))
        zero = dict.fromkeys(self.axes, 0.0)
        self.local = {**zero, **facts.local}
        self.stored: Point | None = None
        self.tool = {**zero, **facts.measures}
        self.measured = dict(self.tool)
        self.vertical_used = set(facts.measures)
        self.unit = self.last_unit = facts.unit
        self.relative = facts.relative
        self.motion: int | None = None
        self.center: tuple[float, float] | None = None
        self.cycle: dict[str, float] = {}
        self.drilling = 0
        self.scaled: dict[str, tuple[float, float]] | None = None
        self.turned: tuple[float, float, float] | None = None
        self.sends: dict[str, tuple[str, ...]] | None = None
        self.unsent: set[str] = set()
        self.follows: tuple[str, str] | None = None
        self.locked: set[str] = set()
        self.home: Point = {}
        self.home_local: Point = {}
        self.keep92 = False
        self.depth = 0
        self.steps = 0
        self.last = self.programmed()
        self.check_bounds()

    # -- coordinates

    def programmed(self) -> Point:
        """Where the machine stands in local coordinates, turned back."""
        at = {a: self.walk.at[a] - self.local[a] - self.tool[a] for a in self.axes}
        if self.turned:
            angle, x, y = self.turned
            dx, dy = at["X"] - x, at["Y"] - y
            at["X"], at["Y"] = (
                x + dx * math.cos(angle) + dy * math.sin(angle),
                y - dx * math.sin(angle) + dy * math.cos(angle),
            )
        if self.scaled:
            for axis, (factor, centre) in self.scaled.items():
                at[axis] = centre + (at[axis] - centre) / factor
        return at

    def machine(self, place: Point) -> Point:
        """Machine coordinates of a programmed place: scaled, turned, then local zero and tool measure."""
        at = dict(place)
        if self.scaled:
            for axis, (factor, centre) in self.scaled.items():
                at[axis] = centre + factor * (at[axis] - centre)
        if self.turned:
            angle, x, y = self.turned
            dx, dy = at["X"] - x, at["Y"] - y
            at["X"], at["Y"] = (
                x + dx * math.cos(angle) - dy * math.sin(angle),
                y + dx * math.sin(angle) + dy * math.cos(angle),
            )
        return {a: at[a] + self.local[a] + self.tool[a] for a in self.axes}

    def size(self, axis: str) -> float:
        return SIZES[self.unit] if axis not in "ABC" else 1.0

    def check_bounds(self) -> None:
        """Soft limits and boundaries together, as limits of the machine: boundaries see tool measures, not G92."""
        limits = dict(self.facts.limits)
        for axis, (low, high) in self.bounds.items():
            if axis in "ZW" and axis not in self.vertical_used:
                low = None
            one, two = limits.get(axis, (None, None))
            shift = self.tool[axis]
            lows = [v for v in (one, None if low is None else low + shift) if v is not None]
            highs = [v for v in (two, None if high is None else high + shift) if v is not None]
            limits[axis] = (max(lows, default=None), min(highs, default=None))
        self.walk.limits = limits

    def travel(self, target: Point) -> None:
        """A straight move in machine coordinates; locked axes stay, a follower goes with its leader."""
        end = {a: v for a, v in target.items() if a not in self.locked}
        self.walk.go(self.followed(end))

    def followed(self, end: Point) -> Point:
        if self.follows is None:
            return end
        leader, slave = self.follows
        if abs(end.get(slave, self.walk.at[slave]) - self.walk.at[slave]) > 1e-9:
            raise NotRead("a follower's own word")
        return {**end, slave: self.walk.at[slave] + end.get(leader, self.walk.at[leader]) - self.walk.at[leader]}

    # -- the run

    def all(self) -> Walk:
        try:
            self.file(self.main)
        except Returned:
            pass
        except Refused as stop:
            self.walk.refused = f"line {self.walk.line}: {stop}"
        return self.walk

    def file(self, lines: list[Line]) -> None:
        at = 0
        array: tuple[int, list[Point], int, Point, bool] | None = None
        while True:
            if at >= len(lines) or (array and lines[at].codes[:1] == [("L", "10")] and at != array[0]):
                if array is None:
                    return
                begin, places, n, start, stays = array
                if n < len(places):
                    step = {a: self.walk.at[a] + places[n][a] - (places[n - 1] if n else start)[a] for a in "XY"}
                    ended = self.pick("L10: cells from the first start, from where the last ended")
                    self.travel(step if ended else places[n])
                    self.last = self.programmed()
                    array = (begin, places, n + 1, start, stays)
                    at = begin + 1
                    continue
                if not stays:
                    self.travel({"X": start["X"], "Y": start["Y"]})
                    self.last = self.programmed()
                array = None
                continue
            line = lines[at]
            self.steps += 1
            if self.steps > STEPS:
                raise NotRead("too many steps")
            self.walk.line = line.number if not self.depth else self.walk.line
            if line.empty:
                at += 1
                continue
            if line.codes[:1] == [("L", "10")]:
                array = self.array(at, line)
                at += 1
                continue
            skip = self.condition(line)
            if skip is None:
                self.command(line)
                at += 1
                continue
            if at + 1 >= len(lines) or lines[at + 1].empty:
                raise NotRead("a condition before no command")
            at += 2 if skip else 1

    def condition(self, line: Line) -> bool | None:
        """Whether the next line is skipped; None where the line is no condition (M17.x, M18.x, L113)."""
        if len(line.codes) != 1:
            return None
        code = "".join(line.codes[0])
        if code in {"M17.4", "M18.4"}:
            value = line.words.get("C")
            if value not in {0.0, 1.0}:
                raise NotRead("C")
            return (value == 1.0) == (code == "M18.4")
        if code in {"M17.1", "M18.1", "M17.2", "M18.2", "M17.3", "M18.3"}:
            return bool(self.pick(f"condition {self.steps} in line {line.number}"))
        return None

    def array(self, at: int, line: Line) -> tuple[int, list[Point], int, Point, bool] | None:
        """L10: where each cell begins; the first is where the machine stands."""
        if self.depth:
            raise Refused("L10 in a subprogram")
        words = line.words
        if not words or set(words) == {"E"}:
            return None
        if not {"R", "C"} <= set(words) or any(words[n] != int(words[n]) or words[n] < 1 for n in "RC"):
            raise NotRead("L10")
        if self.turned or self.scaled or self.sends:
            raise NotRead("L10 under another mode")
        rows, columns = int(words["R"]), int(words["C"])
        start = dict(self.walk.at)
        x, y = words.get("X", 0.0) * self.size("X"), words.get("Y", 0.0) * self.size("Y")
        cells = [(r, c) for r in range(rows) for c in range(columns)]
        if rows > 1 and columns > 1:
            raise NotRead("the order of a grid")
        places = [{"X": start["X"] + c * x, "Y": start["Y"] + r * y} for r, c in cells[1:]]
        return at, places, 0, start, "E" in words

    def command(self, line: Line) -> None:
        """One line: modes with at most one other command."""
        others = []
        once: bool | None = None
        for letter, number in line.codes:
            code = letter + number
            if code in {"G90", "G91"}:
                self.relative = code == "G91"
            elif code in {"L90", "L91"}:
                once = code == "L91"
            else:
                others.append(code)
        if len(others) > 1:
            if all(code in {"G20", "G21", "G22", "G17", "G40", "G49", "G80", "G94"} for code in others):
                raise NotRead("several modes in a line")
            raise Refused("more than one command")
        kept = self.relative
        if once is not None:
            self.relative = once
        try:
            self.one(others[0] if others else "", line)
        finally:
            if once is not None:
                self.relative = kept

    def one(self, code: str, line: Line) -> None:
        words = dict(line.words)
        if code and code[0] == "L":
            self.l_code(code[1:], words, list(line.letters))
        elif code and code[0] == "M":
            self.m_code(code[1:], words, line)
        elif code in {"G20", "G21", "G22", "G23"}:
            if words:
                raise NotRead("words beside a unit")
            if self.scaled or self.turned or self.drilling:
                raise NotRead("a unit under another mode")
            self.unit, self.last_unit = (self.last_unit if code == "G23" else UNITS[int(code[1:])]), self.unit
            self.center = None
        elif code in {"G4", "G5", "G9", "G94"} or (code in {"G40", "G54"} and not words):
            return
        elif code in {"G43", "G49"}:
            self.lengths(code, words)
        elif code in {"G50", "G51", "G52"}:
            self.form(code, words)
        elif code in {"G92", "G92.1", "G92.2", "G92.3"}:
            self.shift(code, words)
        elif code == "G53":
            self.direct(words)
        elif code == "G80":
            if words:
                raise NotRead("words after G80")
            self.drilling, self.motion = 0, None
        elif code == "" and not words:
            return
        else:
            self.move(code, words)

    # -- L and M codes

    def l_code(self, code: str, words: dict[str, float], letters: list[str]) -> None:
        axes = [a for a in words if a in self.axes]
        if code in {"11", "12", "13"}:
            self.mapping(code, letters)
        elif code == "3" and axes:
            self.home.update({a: self.walk.at[a] for a in axes})
            self.home_local.update({a: self.walk.at[a] - self.local[a] - self.tool[a] for a in axes})
        elif code == "4" and axes:
            if any(a not in self.home for a in axes):
                raise NotRead("L4 without L3")
            place = {a: self.home[a] for a in axes}
            if self.pick("L3 stores places of the machine, local places"):
                place = {a: self.home_local[a] + self.local[a] + self.tool[a] for a in axes}
            self.travel(place)
            self.last = self.programmed()
        elif code in {"22", "23"}:
            self.boundary(0 if code == "22" else 1, words)
        elif code in {"22.1", "23.1"}:
            for axis in axes or self.axes:
                ini = self.facts.bounds.get(axis, (None, None))
                low, high = self.bounds[axis]
                self.bounds[axis] = (ini[0], high) if code == "22.1" else (low, ini[1])
            self.check_bounds()
        elif code in {"300", "301"} and axes:
            self.locked = self.locked | set(axes) if code == "300" else self.locked - set(axes)
        elif code == "92" and not words:
            self.keep92 = True
        elif code.isdigit() and int(code) in SILENT_L:
            return
        else:
            raise NotRead(f"L{code}")

    def boundary(self, side: int, words: dict[str, float]) -> None:
        named = {a: v * self.size(a) for a, v in words.items() if a in self.axes}
        if not words:
            named_or_ini = {a: self.facts.bounds.get(a, (None, None))[side] for a in self.axes}
        else:
            named_or_ini = dict(named)
        for axis, value in named_or_ini.items():
            low, high = self.bounds[axis]
            self.bounds[axis] = (value, high) if side == 0 else (low, value)
        self.check_bounds()

    def mapping(self, code: str, letters: list[str]) -> None:
        if code == "13":
            if self.follows and letters:
                raise NotRead("a second L13")
            if letters and (len(letters) != 2 or any(a not in self.axes for a in letters)):
                raise NotRead("L13")
            if letters and (self.turned or self.scaled or self.sends):
                raise NotRead("L13 under another mode")
            self.follows = (letters[0], letters[1]) if letters else None
            return
        if self.turned or self.scaled or self.follows or self.drilling:
            raise NotRead("a mapping under another mode")
        order = "XYZW" if code == "11" else "ZW"
        self.unsent = set()
        if not letters:
            self.sends = None
            return
        if len(letters) != len(order) or any(a not in self.axes for a in [*letters, *order]):
            raise NotRead("L11, L12")
        self.sends = {a: (b,) for a, b in zip(order, letters, strict=True)}
        doubled = [a for a in letters if letters.count(a) == 2]
        if doubled:
            if set(doubled) - {"Z"} or letters[-2:] != ["Z", "Z"] or letters[:-2] != list(order[:-2]):
                raise NotRead("an axis twice")
            # the rule sends W's words to Z; the examples say that Z and W move together when Z is given
            self.sends = {**{a: (a,) for a in order}, "Z": ("Z", "W")}
            self.unsent = {"W"}

    def m_code(self, code: str, words: dict[str, float], line: Line) -> None:
        if line.called:
            self.call(line.called)
        elif code == "99":
            raise Returned
        elif code in {"11", "12", "13", "14"}:
            return
        elif code == "37":
            self.measure(words)
        else:
            raise Refused(f"M{code}")

    def call(self, name: str) -> None:
        if name not in self.facts.files:
            raise Refused("no file")
        if self.depth > 3:
            raise NotRead("nested calls")
        kept, keep92 = dict(self.local), self.keep92
        self.keep92 = False
        self.depth += 1
        with contextlib.suppress(Returned):
            self.file([line_of(n, raw) for n, raw in enumerate(self.facts.files[name].splitlines(), start=1)])
        self.depth -= 1
        if not self.keep92 and self.local != kept:
            if self.scaled or self.turned:
                raise NotRead("G92 restored under another mode")
            self.local = kept
            self.last = self.programmed()
        self.keep92 = keep92

    def measure(self, words: dict[str, float]) -> None:
        """M37: the tip is at a known place; from now on Z counts from there."""
        if set(words) - {"Z", "W"} or not words or self.scaled or self.turned or self.drilling:
            raise NotRead("M37")
        for axis, value in words.items():
            if axis not in self.axes:
                raise NotRead("M37 of no axis")
            at = self.walk.at[axis]
            if self.local[axis] and self.pick("M37 under G92: its value is in the workspace, in local coordinates"):
                at -= self.local[axis]
            self.tool[axis] = self.measured[axis] = at - value * self.size(axis)
            self.vertical_used.add(axis)
        self.last = self.programmed()
        self.check_bounds()

    def lengths(self, code: str, words: dict[str, float]) -> None:
        if self.scaled or self.turned or self.drilling:
            raise NotRead("lengths under another mode")
        for axis in words or "ZW":
            if axis in self.axes:
                self.tool[axis] = self.measured[axis] if code == "G43" else 0.0
        self.last = self.programmed()
        self.check_bounds()

    # -- coordinates set by the program

    def form(self, code: str, words: dict[str, float]) -> None:
        if self.drilling or self.sends or self.follows:
            raise NotRead("rotation or scaling under another mode")
        before = self.last
        if code == "G50":
            self.scaled = self.turned = None
        elif self.scaled or self.turned:
            raise NotRead("a second rotation or scaling")
        elif code == "G52":
            if set(words) != {"I", "J", "A"}:
                raise NotRead("G52")
            sign = (1, -1)[self.pick("G52: A turns counter-clockwise, clockwise")]
            self.turned = (sign * math.radians(words["A"]), words["I"] * self.size("X"), words["J"] * self.size("Y"))
        else:
            centre = {"X": "I", "Y": "J", "Z": "K"}
            if not words or set(words) - {"X", "Y", "Z", "I", "J", "K"}:
                raise NotRead("G51")
            self.scaled = {}
            for axis, letter in centre.items():
                if axis in words:
                    if letter not in words or words[axis] == 0:
                        raise NotRead("G51 without its centre")
                    self.scaled[axis] = (words[axis], words[letter] * self.size(axis))
        kept = self.pick(
            "the program's place when rotation or scaling changes: that of the machine, the last programmed"
        )
        self.last = before if kept else self.programmed()

    def shift(self, code: str, words: dict[str, float]) -> None:
        if self.scaled or self.turned or self.sends:
            raise NotRead("G92 under another mode")
        named = {a: v * self.size(a) for a, v in words.items()}
        if any(a not in self.axes for a in named):
            raise NotRead("G92 words")
        if code == "G92" and not named:
            self.local = dict.fromkeys(self.axes, 0.0)
        elif code == "G92":
            for axis, value in named.items():
                self.local[axis] = self.walk.at[axis] - self.tool[axis] - value
        elif code == "G92.1":
            self.local.update(named)
        elif code == "G92.2":
            for axis, value in named.items():
                self.local[axis] += value
        elif words:
            raise NotRead("G92.3 with words")
        elif any(self.local.values()):
            if self.stored is not None:
                raise NotRead("G92.3 with two")
            self.stored, self.local = self.local, dict.fromkeys(self.axes, 0.0)
        elif self.stored is not None:
            self.local, self.stored = self.stored, None
        self.last = self.programmed()

    # -- moves

    def direct(self, words: dict[str, float]) -> None:
        if not words or any(a not in self.axes for a in words):
            raise NotRead("G53 alone")
        if self.sends or self.drilling:
            raise NotRead("G53 under another mode")
        if self.relative and self.pick("G53 under G91: places, distances"):
            self.travel({a: self.walk.at[a] + v * self.size(a) for a, v in words.items()})
        else:
            self.travel({a: v * self.size(a) for a, v in words.items()})
        self.last = self.programmed()

    def move(self, code: str, words: dict[str, float]) -> None:
        if not code and set(words) == {"P"}:
            if self.drilling or int(words["P"]) not in self.facts.positions or self.turned or self.scaled or self.sends:
                raise NotRead("P")
            self.travel(dict(self.facts.positions[int(words["P"])]))
            self.last = self.programmed()
            return
        if not code:
            if not any(a in words for a in [*self.axes, "I", "J"]):
                if set(words) <= {"F", "S"}:
                    return
                raise NotRead("words for nothing")
            motion = self.drilling or self.motion
            if motion is None:
                raise NotRead("no mode stated")
        elif code in {"G0", "G1", "G2", "G3", "G73", "G81", "G82", "G83"}:
            motion = int(code[1:])
        else:
            raise NotRead(code)
        words.pop("F", None)
        if motion in DRILLS:
            self.drill(motion, words)
            return
        if code:
            self.drilling = 0
        if motion in {2, 3}:
            if self.facts.modal_arcs:
                self.motion = motion
            self.arc(words, clockwise=motion == 2)
            return
        self.motion = motion
        if any(a not in self.axes for a in words):
            raise NotRead("words of a line")
        self.straight(words)

    def straight(self, words: dict[str, float]) -> None:
        targets: dict[str, float] = {}
        if self.unsent & set(words):
            raise NotRead("a word that both readings of a mapping send elsewhere")
        for axis, value in words.items():
            for receiver in self.sends.get(axis, (axis,)) if self.sends else (axis,):
                targets[receiver] = value
        if self.sends and len({r for a in words for r in self.sends.get(a, (a,))}) < len(words):
            raise NotRead("two words for one axis")
        end = self.programmed() if self.relative else dict(self.last)
        for axis, value in targets.items():
            distance = value * self.size(axis)
            end[axis] = end[axis] + distance if self.relative else distance
        at = self.machine(end)
        named = set(targets)
        if self.turned and named & {"X", "Y"}:
            if len(named & {"X", "Y"}) == 1 and not self.relative:
                pass
            named |= {"X", "Y"}
        self.travel({a: at[a] for a in named})
        self.last = end if not self.locked and not self.follows else self.programmed()

    def arc(self, words: dict[str, float], *, clockwise: bool) -> None:
        words.pop("L", None)
        if self.sends or self.locked or self.follows:
            raise (
                Refused("an arc under a mapping") if self.sends and not self.locked else NotRead("an arc under a lock")
            )
        if self.scaled and {"X", "Y"} & set(self.scaled):
            raise Refused("an arc under scaling")
        if set(words) - {*self.axes, "I", "J", "R"}:
            raise NotRead("words of an arc")
        radius = words.pop("R", None)
        size = self.size("X")
        given = {n: words.pop(n) * size for n in "IJ" if n in words}
        start, end = dict(self.last), dict(self.last)
        for axis, value in words.items():
            distance = value * self.size(axis)
            end[axis] = end[axis] + distance if self.relative else distance
        begin, finish = (start["X"], start["Y"]), (end["X"], end["Y"])
        flat = "X" in words or "Y" in words
        ini = SIZES[self.facts.unit]
        if radius is not None:
            radius *= size
            apart = math.dist(begin, finish)
            if given or radius <= 0 or apart < 1e-6:
                raise NotRead("R")
            if apart / 2 > radius + self.facts.arc_err * ini:
                raise Refused("radius")
            if apart / 2 > radius - 1e-6:
                raise NotRead("a radius at its limit")
            if radius < self.facts.arc_min * ini * 1.5:
                raise NotRead("a small radius")
            centre = centre_of(begin, finish, radius, clockwise=clockwise)
        else:
            centre = self.middle(begin, given)
            if math.dist(begin, centre) < self.facts.arc_min * ini * 1.5:
                raise NotRead("a small radius")
            apart = abs(math.dist(begin, centre) - math.dist(finish, centre))
            if flat and apart > self.facts.arc_err * ini * 1.001:
                raise Refused("radius")
            if flat and apart > 1e-3:
                raise NotRead("radii that differ a little")
            if flat and math.dist(begin, finish) < 1e-3:
                raise NotRead("a full circle with X and Y")
        angle = swept(begin, finish, centre, clockwise=clockwise) if flat else (-math.tau if clockwise else math.tau)
        middle = self.machine({**start, "X": centre[0], "Y": centre[1]})
        if max(abs(self.machine(start)[a] - self.walk.at[a]) for a in self.axes) > 1e-6:
            raise NotRead("an arc from a place that the machine has not")
        self.walk.turn(("X", "Y"), (middle["X"], middle["Y"]), angle, self.machine(end))
        self.last = end

    def middle(self, begin: tuple[float, float], given: dict[str, float]) -> tuple[float, float]:
        """The centre: I and J from the start; those that are not given are kept from before."""
        if len(given) < 2 and self.center is None:
            if not given:
                raise NotRead("an arc without centre")
            self.center = (0.0, 0.0)
        kept = self.center or (0.0, 0.0)
        if len(given) == 1 and self.pick("a centre with one word: the other is kept, is 0"):
            kept = (0.0, 0.0)
        offset = (given.get("I", kept[0]), given.get("J", kept[1]))
        self.center = offset
        return begin[0] + offset[0], begin[1] + offset[1]

    def drill(self, motion: int, words: dict[str, float]) -> None:
        if self.relative or self.sends or self.follows or self.locked:
            raise NotRead("a cycle under another mode")
        if set(words) - {"X", "Y", "Z", "R", "Q", "P"}:
            raise NotRead("words of a cycle")
        if motion != self.drilling:
            self.cycle = {}
        self.drilling = motion
        for name in ("Z", "R", "Q"):
            if name in words:
                self.cycle[name] = words[name]
        if "Z" not in self.cycle or "R" not in self.cycle or (motion in {73, 83} and self.cycle.get("Q", 0.0) <= 0):
            raise NotRead("a cycle without Z, R, Q")
        size = self.size("Z")
        if self.cycle["Z"] >= self.cycle["R"]:
            raise Refused("depth must be lower than retract")
        places = [{a: words[a] * size for a in "XY" if a in words}]
        top, bottom = self.cycle["R"] * size, self.cycle["Z"] * size
        peck = top - self.cycle["Q"] * size if motion in {73, 83} else bottom
        places.append({"Z": top})
        if peck > bottom:
            # up by 0.05" after a peck (G73), from R to 0.05" above it (G83): above R where pecks are small
            lift = peck + 0.05 * 25.4
            asked = "G83 with pecks below .05 inch: from R it stays, goes up to .05 inch above the last peck"
            if motion == 73 or lift <= top or self.pick(asked):
                places += [{"Z": peck}, {"Z": lift}]
        places += [{"Z": bottom}, {"Z": top}]
        for named in places:
            end = {**self.last, **named}
            self.travel(self.machine(end))
            self.last = end


def read(program: str, facts: Facts, settled: Mapping[str, int] | None = None) -> Iterator[Walk]:
    """Every reading of a program: `NotRead` where this interpreter makes no statement."""
    return every_reading(lambda questions: Run(program, facts, questions).all(), settled)
