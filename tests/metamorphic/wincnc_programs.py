"""Random WinCNC programs whose places are followed, so that one program can be written in many ways.

A program is a list of groups of lines; a line is a list of words. Numbers are millimetres, multiples of 1/16: sums,
halves and quarter turns are exact. Where the axes stand is reckoned by the rules of the manual (Coordinate System,
G90, G91, G92 to G92.3, G52, M37, L3, L4, G73 to G83), to write the same place in another way: by its distance, under
another local zero, turned by hand. Nothing here asks gproof.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace

AXES = "XYZW"
TURNS = {0: (1, 0), 90: (0, 1), 180: (-1, 0), 270: (0, -1)}
"""Cosine and sine."""

Places = dict[str, float]


@dataclass(frozen=True)
class Word:
    """A letter and its number; plain: no length, the same in all units; text: another spelling of the number."""

    letter: str
    value: float
    plain: bool = False
    text: str | None = None


@dataclass(frozen=True)
class Line:
    """A line. before: program coordinates where it begins; kind: what sort of line; text: it is not made of words.

    turned: quarter turns, centre of G52, or None: where a word names a place the machine goes to this place turned.
    """

    words: tuple[Word, ...] = ()
    kind: str = ""
    before: tuple[tuple[str, float], ...] = ()
    text: str = ""
    turned: tuple[int, float, float] | None = None


@dataclass(frozen=True)
class Call:
    """Lines in a file of their own. local: what G92 was before them; keep: L92 stands in them."""

    name: str
    body: tuple[Group, ...]
    local: tuple[tuple[str, float], ...]
    keep: bool


@dataclass(frozen=True)
class Choice:
    """A line that decides about the next one. runs: whether it is executed; None: nobody knows."""

    head: str
    line: Line
    runs: bool | None


Item = Line | Call | Choice
Group = tuple[Item, ...]
Program = list[Group]
Spell = Callable[[Word], str]


def number(value: float) -> str:
    return f"{value:.9f}".rstrip("0").rstrip(".") if value != 0 else "0"


def plain_spell(word: Word) -> str:
    return word.letter + (number(word.value) if word.text is None else word.text)


def code(text: str) -> tuple[Word, ...]:
    """The words of codes such as ``G1``."""
    return tuple(Word(part[0], float(part[1:]), True) for part in text.split())


def show(line: Line, spell: Spell = plain_spell) -> str:
    return line.text or " ".join(spell(word) for word in line.words)


def flat(program: Iterable[Group], files: dict[str, str] | None = None, spell: Spell = plain_spell) -> list[str]:
    """The lines of a program. Files of calls go into ``files``; without it they are written out where they are called,
    with the local coordinates put back behind them as M98 does (L92)."""
    out: list[str] = []
    for group in program:
        for item in group:
            if isinstance(item, Line):
                out.append(show(item, spell))
            elif isinstance(item, Choice):
                out += [item.head, show(item.line, spell)]
            elif files is None:
                out += flat(item.body, None, spell)
                if not item.keep:
                    out.append(show(Line((*code("G92.1"), *(Word(n, v) for n, v in item.local))), spell))
            else:
                files[item.name] = text_of(flat(item.body, files, spell) + (["L92"] if item.keep else []))
                out.append(f"M98 {item.name}")
    return out


def text_of(lines: Iterable[str]) -> str:
    return "".join(f"{line}\n" for line in lines)


def lines_of(program: Iterable[Group]) -> list[Line]:
    """Lines in the order in which they are written, those of calls where they are called."""
    out: list[Line] = []
    for group in program:
        for item in group:
            if isinstance(item, Line):
                out.append(item)
            elif isinstance(item, Choice):
                out.append(item.line)
            else:
                out += lines_of(item.body)
    return out


def mapped(program: Iterable[Group], change: Callable[[Line], tuple[Line, ...]]) -> Program:
    """Every line replaced by what ``change`` makes of it."""
    out: Program = []
    for group in program:
        made: list[Item] = []
        for item in group:
            if isinstance(item, Line):
                made += change(item)
            elif isinstance(item, Choice):
                made.append(replace(item, line=change(item.line)[0]))
            else:
                made.append(replace(item, body=tuple(mapped(item.body, change))))
        out.append(tuple(made))
    return out


def relative(line: Line) -> Line:
    """A move by the distances in place of the places (G91)."""
    if line.kind not in ("go", "arc"):
        return line
    before = dict(line.before)
    words = tuple(
        replace(w, value=w.value - before[w.letter]) if w.letter in AXES and not w.plain else w for w in line.words
    )
    return replace(line, words=words)


def rotated(quarter: int, x: float, y: float) -> tuple[float, float]:
    c, s = TURNS[quarter]
    return c * x - s * y, s * x + c * y


def written_out(line: Line) -> Line:
    """A line under G52 with its numbers turned; X and Y of the whole place."""
    if line.kind in ("turn on", "turn off"):
        return replace(line, words=(), text="[turned by hand]")
    if line.turned is None:
        return line
    quarter, cx, cy = line.turned
    values = {w.letter: w.value for w in line.words}
    before = dict(line.before)
    words: list[Word] = []
    if "X" in values or "Y" in values:
        x, y = rotated(quarter, values.get("X", before["X"]) - cx, values.get("Y", before["Y"]) - cy)
        words += [Word("X", x + cx), Word("Y", y + cy)]
    if "I" in values:
        i, j = rotated(quarter, values["I"], values["J"])
        words += [Word("I", i), Word("J", j)]
    rest = tuple(w for w in line.words if w.letter not in "XYIJ")
    return replace(line, words=(*rest, *words))


@dataclass
class Can:
    """What a program may hold."""

    arcs: bool = True
    radius: bool = True
    cycles: bool = True
    local: bool = True
    machine: bool = True
    homes: bool = True
    measures: bool = True
    turns: bool = True
    calls: bool = True
    events: bool = True
    bare: bool = True
    heads: bool = True
    boundaries: bool = False


@dataclass
class Maker:
    """Makes one program, following the axes.

    at: machine positions; local, tool: what G92 and M37 add; stored: M37 with G49 on; all in mm by letter. Under G52
    ``at`` is where the axes would be without it.
    """

    rng: random.Random
    can: Can = field(default_factory=Can)
    at: Places = field(default_factory=lambda: dict.fromkeys(AXES, 0.0))
    local: Places = field(default_factory=lambda: dict.fromkeys(AXES, 0.0))
    tool: Places = field(default_factory=lambda: dict.fromkeys(AXES, 0.0))
    stored: Places = field(default_factory=lambda: dict.fromkeys(AXES, 0.0))
    homes: Places = field(default_factory=dict)
    size: int = 30 * 16
    motion: str = ""
    kept: tuple[float, float] | None = None
    turned: tuple[int, float, float] | None = None
    made: int = 0

    # ---- numbers and places

    def number(self, most: int | None = None) -> float:
        most = self.size if most is None else most
        return self.rng.randrange(-most, most + 1) / 16

    def positive(self, least: int, most: int) -> float:
        return self.rng.randrange(least, most) / 16

    def base(self, axis: str) -> float:
        return self.local[axis] + self.tool[axis]

    def place(self, axis: str) -> float:
        return self.at[axis] - self.base(axis)

    def before(self) -> tuple[tuple[str, float], ...]:
        return tuple((axis, self.place(axis)) for axis in AXES)

    def some(self, letters: str) -> str:
        chosen = [letter for letter in letters if self.rng.random() < 0.5]
        return "".join(chosen or [self.rng.choice(letters)])

    def axes(self) -> str:
        return self.some(AXES if self.can.heads else "XYZ")

    def line(self, words: Iterable[Word], kind: str = "") -> Line:
        return Line(tuple(words), kind, self.before(), turned=self.turned if kind in ("go", "arc") else None)

    # ---- a program

    def program(self, groups: int) -> Program:
        head = tuple(Line(code(text)) for text in ("G90", "G94"))
        return [head, (self.go("G1", feed=True),), *self.groups(groups)]

    def groups(self, count: int, depth: int = 1) -> list[Group]:
        return [self.group(depth) for _ in range(count)]

    def group(self, depth: int = 1) -> Group:
        can = self.can
        choices: list[Callable[[], Group]] = [lambda: (self.go(),)] * 5
        choices += [lambda: (self.arc(),)] * 4 if can.arcs else []
        choices += [self.cycle] if can.cycles and self.turned is None else []
        if self.turned is None:
            choices += [self.set_local] * 2 if can.local else []
            choices += [self.in_machine] if can.machine else []
            choices += [self.home] if can.homes else []
            choices += [self.measure] if can.measures else []
            choices += [self.turn] if can.turns and depth else []
            choices += [self.call] if can.calls and depth else []
        choices += [self.event] if can.events else []
        choices += [self.boundary] if can.boundaries and self.turned is None else []
        return self.rng.choice(choices)()

    def event(self) -> Group:
        texts = ("M11C1", "M12C1", "M13 C2", "M14 C2", "G4 X1.5", 'G5 M"look"', "M17C1", "M18 C2", "L61 C3", "L60 C3",
                 "L7 P50", "L10")  # fmt: skip
        return (Line(text=self.rng.choice(texts[:-1])),)

    # ---- moves

    def feed(self) -> tuple[Word, ...]:
        return (Word("F", 16.0 * self.rng.randrange(10, 60)),)

    def go(self, motion: str = "", *, axes: str = "", feed: bool = False) -> Line:
        motion = motion or self.rng.choice(("G0", "G1", self.motion if self.can.bare else "G1"))
        letters = axes or self.axes()
        target = {axis: self.number() for axis in letters}
        words = [Word(axis, value) for axis, value in target.items()]
        if feed or self.rng.random() < 0.2:
            words += self.feed()
        if motion != self.motion or self.rng.random() < 0.5 or not self.can.bare:
            words = [*code(motion), *words]
        line = self.line(words, "go")
        self.motion = motion
        self.move(target)
        return line

    def move(self, target: Places) -> None:
        for axis, value in target.items():
            self.at[axis] = value + self.base(axis)

    def arc(self) -> Line:
        """A quarter, a half or a whole turn by I and J, or one by its radius; with Z now and then."""
        rng = self.rng
        ccw = rng.random() < 0.5
        words = list(code("G3" if ccw else "G2"))
        here = {axis: self.place(axis) for axis in AXES}
        target: Places = {}
        kind = rng.randrange(4 if self.can.radius else 3)
        if kind == 3:
            # 3-4-5: half the chord is 0.6 of the radius.
            scale = self.positive(16, 64) * rng.choice((1, -1))
            chord = (6.0 * scale, 0.0) if rng.random() < 0.5 else (0.0, 6.0 * scale)
            target = {"X": here["X"] + chord[0], "Y": here["Y"] + chord[1]}
            centre = [Word("R", 5.0 * abs(scale))]
            self.kept = None
        else:
            quarters = (1, 2, 4)[kind]
            if self.kept is not None and rng.random() < 0.4 and self.turned is None:
                (i, j), centre = self.kept, []
            else:
                r = self.positive(32, 320)
                i, j = rng.choice(((r, 0.0), (-r, 0.0), (0.0, r), (0.0, -r)))
                centre = [Word("I", i), Word("J", j)]
            self.kept = (i, j) if self.turned is None else None
            if quarters < 4:
                u, v = rotated(90 * quarters if ccw else 360 - 90 * quarters, -i, -j)
                target = {"X": here["X"] + i + u, "Y": here["Y"] + j + v}
        if rng.random() < 0.3:
            target["Z"] = self.number()
        words += [Word(axis, value) for axis, value in target.items()]
        words += centre
        words += self.feed()
        line = self.line(words, "arc")
        self.move(target)
        return line

    def cycle(self) -> Group:
        """A hole, then lines with only X and Y, until G80."""
        rng = self.rng
        name = rng.choice(("G81", "G82", "G83", "G73"))
        r = self.number(160)
        words = [Word("Z", r - self.positive(32, 300)), Word("R", r), *self.feed()]
        if name in ("G83", "G73"):
            words.append(Word("Q", self.positive(24, 90)))
        if name == "G82":
            words.append(Word("P", 250.0, True))
        target = {axis: self.number() for axis in self.some("XY")}
        out = [self.line([*code(name), *(Word(axis, value) for axis, value in target.items()), *words], "cycle")]
        self.move(target | {"Z": r})
        for _ in range(rng.randrange(3)):
            target = {axis: self.number() for axis in self.some("XY")}
            out.append(self.line([Word(axis, value) for axis, value in target.items()], "hole"))
            self.move(target)
        self.motion = ""
        return (*out, Line(code("G80")), self.go("G0"))

    # ---- places

    def set_local(self) -> Group:
        rng = self.rng
        kind = rng.randrange(5)
        if kind == 4:
            self.local = dict.fromkeys(AXES, 0.0)
            return (Line(code("G92"), "local"),)
        values = {axis: self.number(160) for axis in self.axes()}
        name = ("G92", "G92", "G92.1", "G92.2")[kind]
        line = self.line([*code(name), *(Word(axis, value) for axis, value in values.items())], "local")
        for axis, value in values.items():
            if name == "G92":
                self.local[axis] = self.at[axis] - self.tool[axis] - value
            elif name == "G92.1":
                self.local[axis] = value
            else:
                self.local[axis] += value
        return (line,)

    def in_machine(self) -> Group:
        if self.rng.random() < 0.2:
            self.at |= {"Z": 0.0, "W": 0.0}
            return (Line(code("G53"), "machine"),)
        target = {axis: self.number() for axis in self.axes()}
        self.at |= target
        return (Line((*code("G53"), *(Word(axis, value) for axis, value in target.items())), "machine"),)

    def home(self) -> Group:
        if self.homes and self.rng.random() < 0.5:
            axes = self.some("".join(self.homes))
            self.at |= {axis: self.homes[axis] for axis in axes}
            return (Line(text="L4 " + "".join(axes)),)
        axes = self.axes()
        self.homes |= {axis: self.at[axis] for axis in axes}
        return (Line(text="L3 " + "".join(axes)),)

    def measure(self) -> Group:
        rng = self.rng
        axis = rng.choice("ZW") if self.can.heads else "Z"
        kind = rng.randrange(4)
        if kind == 0:
            self.tool[axis] = 0.0
            return (Line(text=f"G49 {axis}"),)
        if kind == 1:
            self.tool[axis] = self.stored[axis]
            return (Line(text=f"G43 {axis}"),)
        value = self.number(80)
        self.stored[axis] = self.tool[axis] = self.at[axis] - value
        return (self.line([*code("M37"), Word(axis, value)], "measure"),)

    def boundary(self) -> Group:
        """Boundaries are set anew: far away, or so near that they may be passed."""
        rng = self.rng
        low = rng.random() < 0.5
        words = [Word(axis, (-1 if low else 1) * self.positive(100, 2000)) for axis in self.axes()]
        return (Line((*code("L22" if low else "L23"), *words), "boundary"),)

    def turn(self) -> Group:
        """Some moves under G52."""
        rng = self.rng
        quarter, cx, cy = rng.choice((90, 180, 270)), self.number(160), self.number(160)
        on = self.line([*code("G52"), Word("A", float(quarter), True), Word("I", cx), Word("J", cy)], "turn on")
        self._turn(360 - quarter, cx, cy)
        self.turned = quarter, cx, cy
        self.kept = None
        body: list[Item] = [self.go(axes="XY")]
        for _ in range(rng.randrange(1, 4)):
            body += self.group(0)
        self.turned = None
        self._turn(quarter, cx, cy)
        self.kept = None
        return (on, *body, Line(code("G50"), "turn off"))

    def _turn(self, quarter: int, cx: float, cy: float) -> None:
        x, y = rotated(quarter, self.place("X") - cx, self.place("Y") - cy)
        self.at |= {"X": x + cx + self.base("X"), "Y": y + cy + self.base("Y")}

    def call(self) -> Group:
        """Some groups in a file, which restores the local coordinates of its caller unless L92 stands in it."""
        self.made += 1
        local = dict(self.local)
        keep = self.rng.random() < 0.3
        body = tuple(self.groups(self.rng.randrange(1, 5), 0))
        if not keep:
            self.local = dict(local)
        return (Call(f"PART{self.made}.TAP", body, tuple(local.items()), keep),)

    def everywhere(self) -> Line:
        """To a machine place of all axes: what was before does not count any more."""
        target = {axis: self.number() for axis in AXES}
        self.at |= target
        return Line((*code("G53"), *(Word(axis, value) for axis, value in target.items())), "machine")
