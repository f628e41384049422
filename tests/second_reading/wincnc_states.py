"""Where commands of WinCNC that change what numbers mean leave the axes, in pairs: a small model from the guide alone.

`Model` runs lines of words and numbers, one command each, and keeps for each axis where it stands (mm, coordinates of
the machine), or None where the guide leaves it open; `Open` is raised where it leaves open what the line does at all.
Reasons are beginnings of rows in docs/dialects/wincnc.md. Headings of the guide stand beside each command.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field

AXES = "XYZW"
VERTICAL = "ZW"
INCH = 25.4
START = {"X": 10.0, "Y": 20.0, "Z": -20.0, "W": -30.0}
LIMITS = {"X": (-200.0, 200.0), "Y": (-200.0, 200.0), "Z": (-150.0, 0.0), "W": (-150.0, 0.0)}
BOUNDARIES: dict[str, tuple[float | None, float | None]] = {
    "X": (-190.0, 190.0), "Y": (-190.0, 190.0), "Z": (None, None), "W": (None, None),
}  # fmt: skip
SPACES = {54: (0.0, 0.0, False), 55: (20.0, 10.0, False), 56: (20.0, -10.0, True), 57: (15.0, 5.0, None)}
"""Shift in X and Y, and whether axes move (M of the key), None: the key does not say."""
POSITIONS = {
    1: {"X": 2.0, "Y": 3.0}, 2: {"X": 12.0, "Y": 3.0}, 3: {"X": 6.0, "Y": 0.0}, 4: {"X": 6.0, "Y": 10.0},
    5: {"X": 8.0, "Y": 9.0, "Z": -11.0, "W": -12.0},
}  # fmt: skip
MEASURES = {2: -12.0}
FILES = {
    "local.tap": "G92.1 X4 Y6\nG0 Z-12\n",
    "kept.tap": "G92.1 X4 Y6\nL92\n",
    "turned.tap": "G92.1 X4 Y6\nG52 I3 J4 A90\n",
}
NEAR = 1e-9


class Open(Exception):
    """The guide does not say what a line does; the text begins a row of the dialect's page."""


@dataclass
class Model:
    """One program's state. zero: local zeros (G92); measure: of tools; put_aside: measures that G49 took away."""

    at: dict[str, float | None] = field(default_factory=lambda: dict(START))
    zero: dict[str, float] = field(default_factory=lambda: dict.fromkeys(AXES, 0.0))
    base: dict[str, float] = field(default_factory=lambda: dict.fromkeys(AXES, 0.0))
    """Where the controller's machine zero lies (L28), in coordinates of the one at the start."""
    measure: dict[str, float] = field(default_factory=lambda: dict.fromkeys(AXES, 0.0))
    put_aside: dict[str, float] = field(default_factory=dict)
    space: int = 54
    stored_zero: dict[str, float] | None = None
    unit: float = 1.0
    unit_before: float | None = None
    absolute: bool = True
    scales: dict[str, tuple[float, float]] = field(default_factory=dict)
    turn: tuple[float, float, float] | None = None
    programmed: bool = False
    """While turned: both X and Y of the program are known, not those of the machine alone."""
    sends: dict[str, tuple[str, ...]] = field(default_factory=lambda: {a: (a,) for a in AXES})
    shared: str = ""
    follower: tuple[str, str] | None = None
    drift: dict[str, float] = field(default_factory=dict)
    locked: set[str] = field(default_factory=set)
    homes: dict[str, float | None] = field(default_factory=dict)
    low: dict[str, float | None] = field(default_factory=lambda: {a: BOUNDARIES[a][0] for a in AXES})
    high: dict[str, float | None] = field(default_factory=lambda: {a: BOUNDARIES[a][1] for a in AXES})
    soft: bool = True
    bound: bool = True
    measured: bool = True
    """Whether M37 was used: before this job, where the setup states measures."""
    keeps: bool = False
    drilling: bool = False
    unsettled: set[str] = field(default_factory=set)
    """Axes whose zero was restored while they are scaled or turned."""
    over: list[str] = field(default_factory=list)
    unheld: list[str] = field(default_factory=list)
    """Past a soft limit while it is off: how far the axis can travel no file says."""

    # -- coordinates

    def shift(self, axis: str) -> float:
        return SPACES[self.space]["XY".index(axis)] if axis in "XY" else 0.0  # type: ignore[return-value]

    def offset(self, axis: str) -> float:
        return self.base[axis] + self.zero[axis] + self.shift(axis) + self.measure[axis]

    def moulded(self) -> set[str]:
        """Axes that G51 scales or G52 turns."""
        return set(self.scales) | (set("XY") if self.turn else set())

    def set_zero(self, zeros: Mapping[str, float | None]) -> None:
        """New local zeros; None: the line leaves it open."""
        changed = {a for a, value in zeros.items() if value is None or abs(value - self.zero[a]) > NEAR}
        if changed & self.moulded():
            raise Open("G92 and its kin, and L28, while G51 or G52 is on")
        self.zero.update({a: math.nan if v is None else v for a, v in zeros.items()})

    def set_measure(self, axis: str, value: float) -> None:
        if axis in self.scales and not abs(value - self.measure[axis]) <= NEAR:
            self.unsettled.add(axis)
        self.measure[axis] = value

    # -- moves

    def travel(self, target: Mapping[str, float | None], *, own: set[str], places: bool = True) -> None:
        """A move of all these axes; own: those that the line names; places: it sends them to places, not by ways."""
        wanted = {a: v for a, v in target.items() if not _same(v, self.at[a])}
        if self.follower:
            leader, slave = self.follower
            if slave in wanted or (slave in own and leader in wanted):
                raise Open("L13: words of the follower itself")
        if places and any(a in self.drift for a in own):
            raise Open("L13: are the steps of the follower counted")
        moved = {a: v for a, v in wanted.items() if a not in self.locked}
        if self.follower:
            leader, slave = self.follower
            if leader in moved and slave not in self.locked:
                to, here, there = moved[leader], self.at[leader], self.at[slave]
                way = math.nan if to is None or here is None else to - here
                moved[slave] = None if there is None or math.isnan(way) else there + way
                self.drift[slave] = self.drift.get(slave, 0.0) + way
                if abs(self.drift[slave]) < NEAR:
                    del self.drift[slave]
        self.at.update(moved)
        if moved:
            self.check()

    def check(self) -> None:
        """Soft limits and boundaries at the end of a move (Soft Limit / Boundaries)."""
        for axis, place in self.at.items():
            if place is None:
                continue
            low, high = LIMITS[axis]
            # The machine's ends are where they were; what the controller checks counts from its zero.
            if self.soft and not low - NEAR <= place <= high + NEAR:
                self.over.append(f"{axis} at {place:g}")
            if not self.soft and not low - NEAR <= place <= high + NEAR:
                self.unheld.append(f"{axis} at {place:g}")
            if self.soft and not low - NEAR <= place - self.base[axis] <= high + NEAR:
                self.over.append(f"{axis} at {place - self.base[axis]:g} from L28")
            seen = place - self.base[axis] - self.shift(axis) - self.measure[axis]
            if math.isnan(seen):
                continue
            least, most = self.low[axis], self.high[axis]
            if axis in VERTICAL and not self.measured:
                least = None
            if self.bound and (
                (least is not None and seen < least - NEAR) or (most is not None and seen > most + NEAR)
            ):
                self.over.append(f"{axis} at {seen:g} of its workspace")

    def end_of(self, words: Mapping[str, float]) -> dict[str, float | None]:
        """Where axis words send axes, in coordinates of the machine."""
        received: dict[str, tuple[str, float]] = {}
        for letter, value in words.items():
            if letter in self.shared:
                raise Open("L11, L12 with one axis twice")
            for axis in self.sends[letter]:
                received[axis] = letter, value * self.unit
        target: dict[str, float | None] = {}
        for axis, (letter, value) in received.items():
            if axis != letter:
                if {axis, letter} & self.moulded():
                    raise Open("L11, L12 of axes that G51 scales or G52 turns")
                zeros = [self.base[a] + self.zero[a] + self.shift(a) for a in (axis, letter)]
                if self.absolute and abs(zeros[0] - zeros[1]) > NEAR:
                    raise Open("L11, L12 of axes with other local zeros")
            if self.absolute and axis in self.unsettled:
                raise Open("G43, G49, a tool or a workspace that move the zero of an axis while G51 scales it")
            factor, centre = self.scales.get(axis, (1.0, 0.0))
            here = self.at[axis]
            if self.absolute:
                target[axis] = self.offset(axis) + centre + factor * (value - centre)
            else:
                target[axis] = None if here is None else here + factor * value
        if self.turn and received.keys() & {"X", "Y"}:
            target.update(self.turned({a: v for a, (_, v) in received.items() if a in "XY"}))
        return {a: None if v is None or math.isnan(v) else v for a, v in target.items()}

    def turned(self, words: Mapping[str, float]) -> dict[str, float | None]:
        assert self.turn is not None
        angle, i, j = self.turn
        cosine, sine = math.cos(angle), math.sin(angle)
        x, y = self.at["X"], self.at["Y"]
        if not self.absolute:
            if x is None or y is None:
                return {"X": None, "Y": None}
            dx, dy = words.get("X", 0.0), words.get("Y", 0.0)
            return {"X": x + dx * cosine - dy * sine, "Y": y + dx * sine + dy * cosine}
        place = dict(words)
        if len(place) == 1:
            if not self.programmed or x is None or y is None:
                raise Open("one of X and Y alone after G52, before both were named")
            u, v = x - self.offset("X") - i, y - self.offset("Y") - j
            place = {"X": i + u * cosine + v * sine, "Y": j - u * sine + v * cosine} | place
        self.programmed = True
        u, v = place["X"] - i, place["Y"] - j
        return {
            "X": self.offset("X") + i + u * cosine - v * sine, "Y": self.offset("Y") + j + u * sine + v * cosine,
        }  # fmt: skip

    # -- the program

    def run(self, text: str) -> None:
        """All lines; an array is run again for each of its cells (L10)."""
        lines = [line for line in text.splitlines() if line.strip()]
        cell: tuple[int, int, dict[str, float | None], dict[str, float]] | None = None
        n = 0
        while True:
            ends = n >= len(lines) or lines[n].split()[0] == "L10"
            if ends and cell is not None:
                begin, left, first, step = cell
                if left:
                    self.need_own_ways()
                    there = {a: None if first[a] is None else first[a] + step[a] for a in "XY"}  # type: ignore[operator]
                    self.travel(there, own=set("XY"))
                    cell = begin, left - 1, there, step
                    n = begin
                    continue
                cell = None
            if n >= len(lines):
                return
            line = lines[n]
            n += 1
            if line.split()[0] == "L10":
                words = _words(line[3:])
                if words:
                    self.need_own_ways()
                    step = {a: words.get(a, 0.0) * self.unit for a in "XY"}
                    cell = n, int(words["R"] * words["C"]) - 1, {a: self.at[a] for a in "XY"}, step
                continue
            self.line(line)

    def need_own_ways(self) -> None:
        """X and Y of the way from cell to cell go where they are sent."""
        bound = set(self.follower or ()) | self.locked | self.moulded()
        if bound & {"X", "Y"} or self.swaps("XY"):
            raise Open("the path from cell to cell while")

    def swaps(self, letters: str) -> bool:
        return any(self.sends[a] != (a,) or a in self.shared for a in letters)

    def line(self, text: str) -> None:
        if text.startswith("M98"):
            kept, keeps, self.keeps = dict(self.zero), self.keeps, False
            self.run(FILES[text.split()[1]])
            if not self.keeps:
                self.unsettled |= {a for a in kept if kept[a] != self.zero[a]} & self.moulded()
                self.zero = kept
            self.keeps = keeps
            return
        code, _, rest = text.partition(" ")
        if code in {"L11", "L12"}:
            map_words(self, rest, code)
        elif code == "L13":
            couple(self, rest)
        else:
            COMMANDS[code](self, _words(rest), code)


Words = dict[str, float]


def _same(one: float | None, two: float | None) -> bool:
    return one is not None and two is not None and abs(one - two) <= NEAR


def _words(text: str) -> Words:
    """Letters and numbers; a letter without one is 0; letters of L11 to L13 keep their order."""
    return {a: float(v or 0) for a, v in re.findall(r"([A-Z])([-+.\d]*)", text)}


def move(model: Model, words: Words, code: str) -> None:
    """G0, G1."""
    model.drilling = False
    target = model.end_of(words)
    own = {axis for letter in words for axis in model.sends[letter]}
    own |= set("XY") if model.turn and own & {"X", "Y"} else set()
    model.travel(target, own=own, places=model.absolute)
    if model.locked & {"X", "Y"} and model.turn:
        model.programmed = False


def by_machine(model: Model, target: Mapping[str, float | None], own: set[str]) -> None:
    if model.turn and own & {"X", "Y"}:
        model.programmed = False
    model.travel(target, own=own)


def direct(model: Model, words: Words, code: str) -> None:
    """G53: places of the machine; alone it lifts all vertical axes."""
    if not words:
        up = {a: model.base[a] for a in VERTICAL}
        by_machine(model, up, {a for a in VERTICAL if not _same(model.at[a], up[a])})
        return
    if not model.absolute:
        raise Open("G53 in G91")
    if set(words) & model.moulded():
        raise Open("G53 of an axis that G51 scales or G52 turns")
    received = {axis: v * model.unit + model.base[axis] for letter, v in words.items() for axis in model.sends[letter]}
    if set(words) & set(model.shared):
        raise Open("L11, L12 with one axis twice")
    by_machine(model, received, set(received))


def stored(model: Model, words: Words, code: str) -> None:
    """P: Stored Positions."""
    if model.drilling:
        raise Open("P alone after a cycle")
    place = {axis: value + model.base[axis] for axis, value in POSITIONS[int(code[1:])].items()}
    by_machine(model, place, {a for a in place if not _same(place[a], model.at[a])})


def units(model: Model, words: Words, code: str) -> None:
    """G20 to G23."""
    if code == "G23" and model.unit_before is None:
        raise Open("G23: the unit before the last change")
    new = model.unit_before if code == "G23" else {"G20": INCH, "G21": 10.0, "G22": 1.0}[code]
    assert new is not None
    model.unit_before, model.unit = model.unit, new


def distances(model: Model, words: Words, code: str) -> None:
    """G90, G91."""
    model.absolute = code == "G90"


def unmapped(model: Model, words: Words) -> None:
    """Words that do not move mean the axes of their letters, or those that L11 and L12 send them to."""
    if {axis: words[letter] for letter in words for axis in model.sends[letter]} != words or set(words) & set(
        model.shared
    ):
        raise Open("do L11 and L12 change the axes of G92, M37, G28 and other words that do not move")


def local(model: Model, words: Words, code: str) -> None:
    """G92, G92.1, G92.2."""
    unmapped(model, words)
    if code == "G92" and not words:
        model.set_zero(dict.fromkeys(AXES, 0.0))
        return
    new: dict[str, float | None] = {}
    for axis, value in words.items():
        here = model.at[axis]
        if code == "G92":
            seen = None if here is None else here - model.base[axis] - model.shift(axis) - model.measure[axis]
            new[axis] = None if seen is None else seen - value * model.unit
        else:
            new[axis] = (model.zero[axis] if code == "G92.2" else 0.0) + value * model.unit
    if code == "G92" and set(words) & model.moulded():
        raise Open("G92 and its kin, and L28, while G51 or G52 is on")
    model.set_zero(new)


def switched(model: Model, words: Words, code: str) -> None:
    """G92.3: stores and clears, or restores."""
    if model.stored_zero is not None:
        back, model.stored_zero = model.stored_zero, None
        model.set_zero(back)
    elif any(model.zero.values()):
        model.stored_zero = dict(model.zero)
        model.set_zero(dict.fromkeys(AXES, 0.0))


def crossing(model: Model, words: Words, code: str) -> None:
    """G92.4: local X and Y zero where the line through P1 and P2 meets that through P3 and P4: X6 Y3."""
    if model.shift("X") or model.shift("Y"):
        raise Open("G92.4 in a workspace that is shifted")
    model.set_zero({"X": 6.0, "Y": 3.0})


def scaling(model: Model, words: Words, code: str) -> None:
    """G51 X Y Z W about I J K, or C."""
    centres = {"X": "I", "Y": "J", "Z": "K"}
    named = {a: f for a, f in words.items() if a in AXES}
    unmapped(model, named)
    if model.turn:
        raise Open("G51 and G52 together")
    left_out = set(model.scales) - set(named)
    if left_out & {"X", "Y"}:
        raise Open("G51 that names other axes than the one before")
    common = words.get("C", 0.0)
    model.scales = {
        a: (f, words.get(centres.get(a, "C"), common) * model.unit) for a, f in named.items() if f != 1.0
    } | dict.fromkeys(left_out, (math.nan, 0.0))  # fmt: skip


def turning(model: Model, words: Words, code: str) -> None:
    """G52: about I and J by A degrees; G52.1: about the local zero to the direction from P3 to P4, 90 degrees."""
    if model.scales:
        raise Open("G51 and G52 together")
    if code == "G52.1":
        words = {"I": 0.0, "J": 0.0, "A": 90.0}
    i, j = words["I"] * model.unit, words["J"] * model.unit
    u, v = (math.nan if model.at[a] is None else model.at[a] - model.offset(a) for a in "XY")  # type: ignore[operator]
    model.programmed = abs(u - i) < NEAR and abs(v - j) < NEAR
    model.turn = math.radians(words["A"]), i, j
    model.unsettled -= {"X", "Y"}


def moulds_off(model: Model, words: Words, code: str) -> None:
    """G50."""
    model.scales, model.turn, model.unsettled = {}, None, set()


def workspace(model: Model, words: Words, code: str) -> None:
    """G54 to G59."""
    number = int(code[1:])
    if number == 58:
        raise Open("type 3, a turning spindle")
    x, y, moves = SPACES[number]
    old = {a: model.shift(a) for a in "XY"}
    changes = {a: s - old[a] for a, s in zip("XY", (x, y), strict=True)}
    if any(changes.values()) and {"X", "Y"} & model.moulded():
        raise Open("G92 and its kin, and L28, while G51 or G52 is on")
    model.space = number
    if moves is False or not any(changes.values()):
        return
    there = {a: None if model.at[a] is None else model.at[a] + c for a, c in changes.items()}  # type: ignore[operator]
    by_machine(model, there, set(changes))
    if moves is None:
        model.at.update(dict.fromkeys([a for a, c in changes.items() if c and a not in model.locked], None))


def lengths(model: Model, words: Words, code: str) -> None:
    """G43, G49."""
    unmapped(model, words)
    for axis in words or VERTICAL:
        if code == "G49":
            model.put_aside.setdefault(axis, model.measure[axis])
            model.set_measure(axis, 0.0)
        elif code == "G43" and axis in model.put_aside:
            model.set_measure(axis, model.put_aside.pop(axis))
    if code == "G43":
        model.measured = True


def measuring(model: Model, words: Words, code: str) -> None:
    """M37: the place reads so from now on."""
    unmapped(model, words)
    for axis, value in words.items():
        here = model.at[axis]
        if axis in model.scales:
            raise Open("G92 and its kin, and L28, while G51 or G52 is on")
        # Under a local zero: with it or without it (docs: M37 while its axis has a local zero).
        is_open = model.zero[axis] or axis in model.drift or here is None
        model.measure[axis] = math.nan if is_open or here is None else here - model.base[axis] - value * model.unit
        model.put_aside.pop(axis, None)
    # It "turns on G43 mode": of its axis, or of all (docs: M37 while G49 puts measures of other axes aside).
    model.measure.update({axis: math.nan for axis, value in model.put_aside.items() if value})
    model.measured = True


def tool(model: Model, words: Words, code: str) -> None:
    """L101, L110: the stored measure of the tool, for the changer's axis Z."""
    measure = MEASURES[int(words.get("R", words["T"]))]
    if "Z" in model.put_aside:
        # docs: L110 and its like while G49 is in force
        model.put_aside["Z"] = measure
        model.set_measure("Z", math.nan)
    else:
        model.set_measure("Z", measure)
    model.measured = True


def map_words(model: Model, letters: str, code: str) -> None:
    """L11, L12: axes that receive the words of X Y Z W, or Z W, in this order."""
    order = "XYZW" if code == "L11" else "ZW"
    if code == "L12" and model.swaps("XY"):
        raise Open("L12 while L11 maps X or Y")
    model.sends, model.shared = {a: (a,) for a in AXES}, ""
    if letters.endswith("ZZ"):
        model.sends["Z"], model.shared = ("Z", "W"), "W"
    elif letters:
        model.sends.update({a: (b,) for a, b in zip(order, letters, strict=True)})


def couple(model: Model, letters: str) -> None:
    """L13: the second follows the first."""
    if not letters:
        model.follower = None
    elif model.follower not in (None, tuple(letters)):
        raise Open("L13 while another one is in force")
    else:
        model.follower = letters[0], letters[1]


def lock(model: Model, words: Words, code: str) -> None:
    """L300, L301."""
    unmapped(model, words)
    model.locked = model.locked | set(words) if code == "L300" else model.locked - set(words)


def guards(model: Model, words: Words, code: str) -> None:
    """L20, L21."""
    which = words.get("X") if code == "L20" else None
    model.soft, model.bound = code == "L20" and which != 1.0, code == "L20" and which != 2.0


def boundary(model: Model, words: Words, code: str) -> None:
    """L22, L23 and .1."""
    unmapped(model, words)
    side, values = (0, model.low) if code.startswith("L22") else (1, model.high)
    for axis in words or AXES:
        values[axis] = BOUNDARIES[axis][side] if code.endswith(".1") or not words else words[axis] * model.unit


def home(model: Model, words: Words, code: str) -> None:
    """G28: the axes stand at machine zero."""
    unmapped(model, words)
    axes = set(words) or set(AXES)
    if axes & (model.locked | set(model.follower or ())):
        raise Open("homing an axis that L300 locks or L13 couples")
    if any(model.base[axis] for axis in axes & model.moulded()):
        # It takes back what L28 has moved.
        raise Open("G92 and its kin, and L28, while G51 or G52 is on")
    for axis in axes:
        model.at[axis] = model.base[axis] = 0.0
        model.drift.pop(axis, None)
    if model.turn and axes & {"X", "Y"}:
        model.programmed = False


def keep_home(model: Model, words: Words, code: str) -> None:
    """L3."""
    unmapped(model, words)
    model.homes.update({a: model.at[a] for a in words})
    if set(words) & set(model.drift):
        raise Open("L13: are the steps of the follower counted")


def go_home(model: Model, words: Words, code: str) -> None:
    """L4."""
    unmapped(model, words)
    by_machine(model, {a: model.homes[a] for a in words}, {a for a in words if not _same(model.homes[a], model.at[a])})


def machine_zero(model: Model, words: Words, code: str) -> None:
    """L28: the place is called so, and nothing moves; what counts from machine zero does from now on."""
    unmapped(model, words)
    if set(words) & model.moulded():
        raise Open("G92 and its kin, and L28, while G51 or G52 is on")
    for axis, value in words.items():
        here = model.at[axis]
        if axis in model.drift:
            raise Open("L28 of an axis that has followed another one")
        before = model.base[axis]
        model.base[axis] = math.nan if here is None else here - value * model.unit
        if axis in model.homes and model.base[axis] != before:
            model.homes[axis] = None


def level(model: Model, words: Words, code: str) -> None:
    """L53: tips at one height, as high as possible; the place of a tip is that of its axis less the measure."""
    if any(model.base[a] for a in VERTICAL):
        raise Open("L53 after an L28 of a head")
    if any(model.put_aside.values()):
        raise Open("L53 while G49 is in force")
    if any(math.isnan(model.measure[a]) for a in VERTICAL):
        raise Open("L53 with several heads whose measures are not known")
    tip = min(-model.measure[a] for a in VERTICAL)
    there = {a: tip + model.measure[a] for a in VERTICAL}
    by_machine(model, there, {a for a in VERTICAL if not _same(there[a], model.at[a])})


def hole(model: Model, words: Words, code: str) -> None:
    """G81: over, down to R, to Z, back to R."""
    if not model.absolute:
        raise Open("Z and R in G91")
    if model.swaps("Z") or "Z" in {b for a in "XYW" for b in model.sends[a]} or model.shared:
        raise Open("a hole while L11 or L12 maps Z")
    move(model, {a: words[a] for a in "XY"}, code)
    for letter in "RZR":
        move(model, {"Z": words[letter]}, code)
    model.drilling = True


def nothing(model: Model, words: Words, code: str) -> None:
    """L92 in the job itself, G80, L40: no place depends on it."""
    model.keeps = model.keeps or code == "L92"
    model.drilling = model.drilling and code != "G80"


COMMANDS = {
    "G0": move, "G1": move, "G53": direct, "P5": stored, "G20": units, "G21": units, "G22": units, "G23": units,
    "G90": distances, "G91": distances, "G92": local, "G92.1": local, "G92.2": local, "G92.3": switched,
    "G92.4": crossing, "G51": scaling, "G52": turning, "G52.1": turning, "G50": moulds_off, "G43": lengths,
    "G49": lengths, "M37": measuring, "L101": tool, "L110": tool, "L300": lock, "L301": lock, "L20": guards,
    "L21": guards, "L22": boundary, "L22.1": boundary, "L23": boundary, "L23.1": boundary, "G28": home,
    "L3": keep_home, "L4": go_home, "L53": level, "L28": machine_zero, "G81": hole, "L92": nothing, "G80": nothing,
    **{f"G{number}": workspace for number in (54, 55, 56, 57, 58)},
}  # fmt: skip
