"""Random programs in the language that gproof's Eding dialect and LinuxCNC share; the seed decides all.

`random_program(seed)` gives the text and where the machine stands at its end. The generator keeps its own
small model of position, units, offsets and modes (`Model`), because it must know where it is to write arcs
that close and cycles that go down. What the two do not share (see README.md) is left out: among others cutter
compensation, a second line of a cycle in incremental mode, G83 and G85 that return above R, G53 in
incremental mode, M6 or a change of units while a tool length is active, M6 right after an arc, rounding of
halves and remainders of negative numbers.

`python -m differential.random_programs SEED` (in `tests/`) prints a program.
"""

from __future__ import annotations

import math
import random
import sys
from collections.abc import Callable
from dataclasses import dataclass, field

AXES = "XYZABC"
LINEAR = "XYZ"
MM_PER_INCH = 25.4
REACH = 400.0  # mm: targets stay inside
NEAR = 0.05  # mm or degrees: a move that is meant goes at least this far
PLANES = {
    17: ("X", "Y", "Z"),
    18: ("Z", "X", "Y"),
    19: ("Y", "Z", "X"),
}  # first, second axis of the right-handed pair, and the third
CENTRE = {"X": "I", "Y": "J", "Z": "K"}
SYSTEMS = ["54", "55", "56", "57", "58", "59", "59.1", "59.2", "59.3"]
TOOLS = {1: 12.5, 2: 40.25, 3: 0.0, 4: 7.75}  # lengths in machine.toml


def zeros() -> dict[str, float]:
    return dict.fromkeys(AXES, 0.0)


@dataclass
class Model:
    """Where the machine is and in which modes, lengths in mm. Program = (machine - offsets) / unit."""

    machine: dict[str, float] = field(default_factory=zeros)
    work: list[dict[str, float]] = field(default_factory=lambda: [zeros() for _ in SYSTEMS])
    system: int = 0
    g92: dict[str, float] = field(default_factory=zeros)
    g92_kept: dict[str, float] = field(default_factory=zeros)
    length: float = 0.0  # tool length in effect
    unit: float = 1.0
    absolute: bool = True
    plane: int = 17
    old_level: bool = True  # G98
    motion: str | None = None  # the motion mode in force
    inverse: bool = False
    fed: bool = False  # an F in the present units is in force
    turning: bool = False
    tool_asked: int = 0
    straight: bool = False  # the last move was straight, and nothing moved the origin since

    def scale(self, axis: str) -> float:
        return self.unit if axis in LINEAR else 1.0

    def offset(self, axis: str) -> float:
        return self.work[self.system][axis] + self.g92[axis] + (self.length if axis == "Z" else 0.0)

    def at(self, axis: str) -> float:
        """The coordinate of an axis in the program's words."""
        return (self.machine[axis] - self.offset(axis)) / self.scale(axis)

    def go(self, axis: str, coordinate: float) -> None:
        self.machine[axis] = coordinate * self.scale(axis) + self.offset(axis)


@dataclass(frozen=True)
class Program:
    """A random program, and where the model says that the machine is at its end (mm, degrees)."""

    seed: int
    text: str
    end: dict[str, float]


class Generator:
    """Writes one program."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)
        self.seed = seed
        self.model = Model()
        self.lines: list[str] = []
        self.parameters: dict[int, float] = {}  # in the order of their last assignment
        self.assigned = 0
        self.top = 0.0  # R of the cycle in force, a program coordinate
        self.lower = self.random.random() < 0.15
        self.numbered = self.random.random() < 0.3

    # Words and lines

    def line(self, *words: str) -> None:
        """Write words as a line, with whatever a writer may put between and around them."""
        pick = self.random
        gap = pick.choice(["", " ", " ", " ", "\t"])
        text = gap.join(words)
        if self.numbered:
            text = f"N{(10 * len(self.lines)) % 100000}{pick.choice(['', ' '])}{text}"
        if pick.random() < 0.05:
            text += pick.choice([" (G0 X99)", "(note)", " ; rest of the line", "  "])
        if pick.random() < 0.03:
            text = "/" + text
        self.lines.append(text.lower() if self.lower else text)

    def number(self, value: float, decimals: int) -> tuple[str, float]:
        """A plain number in one of its forms, and the value that it has when read."""
        plain = f"{value:.{decimals}f}"
        form = self.random.randrange(6)
        if form == 0 and value > 0:
            plain = "+" + plain
        if form == 1 and "." in plain:
            plain = plain.rstrip("0")
        if form == 2 and abs(value) < 1 and "." in plain:
            plain = plain.replace("0.", ".", 1)
        if form == 3 and not plain.startswith(("-", "+")):
            plain = "0" + plain
        if form == 4:
            cut = self.random.randrange(len(plain) + 1)
            plain = plain[:cut] + " " + plain[cut:]
        return plain, float(plain.replace(" ", ""))

    def real(self, value: float, decimals: int | None = None) -> tuple[str, float]:
        """A number, expression, function or parameter near a value, and the value that it has when read."""
        pick = self.random
        if decimals is None:
            decimals = 4 if self.model.unit == 1.0 else 5
        form = pick.randrange(12)
        if form == 0:
            part = round(pick.uniform(-9.0, 9.0), 3)
            left, right = self.number(value - part, decimals), self.number(part, 3)
            return f"[{left[0]}+{right[0]}]", left[1] + right[1]
        if form == 1:
            factor = pick.choice([2.0, 4.0, 8.0])
            left = self.number(value * factor, decimals)
            return f"[{left[0]}/{factor:g}]", left[1] / factor
        if form == 2:
            left = self.number(value / 2, decimals)
            return f"[2*[{left[0]}]-[0 * 3 ** 2]]", 2 * left[1]
        if form == 3:
            inner, read = self.number(abs(value), decimals)
            return (f"[0 - {inner}]", -read) if value < 0 else (f"abs[{inner}]", read)
        if form == 4 and self.parameters:
            index, known = pick.choice(list(self.parameters.items())[-500:])
            rest = self.number(value - known, decimals)
            return f"[#{index} + {rest[0]}]", known + rest[1]
        if form == 5:
            text, read = self.number(value, decimals)
            return f"#{self.assign(text, read)}", read
        return self.number(value, decimals)

    def assign(self, text: str, value: float) -> int:
        """A line that sets a parameter not lately used (a line in preparation may already use the others)."""
        index = 100 + self.assigned % 3000
        self.assigned += 1
        self.parameters.pop(index, None)
        self.line(f"#{index}{self.random.choice(['=', ' = '])}{text}")
        self.parameters[index] = value
        return index

    # Values

    def target(self, axis: str) -> float:
        """A program coordinate that is a real move away from here."""
        model, pick = self.model, self.random
        while True:
            wanted = pick.uniform(-90.0, 90.0) if pick.random() < 0.9 else pick.uniform(-REACH, REACH)
            if abs(wanted - model.machine[axis]) > 2 * NEAR:
                return (wanted - model.offset(axis)) / model.scale(axis)

    def axis_word(self, axis: str, coordinate: float, decimals: int | None = None) -> tuple[str, float]:
        """The word that brings an axis to a program coordinate in the present mode; what it reaches."""
        here = self.model.at(axis)
        given = coordinate if self.model.absolute else coordinate - here
        text, read = self.real(given, decimals)
        return axis + text, read if self.model.absolute else here + read

    def feed_words(self, *, always: bool = False) -> list[str]:
        """F where a cutting move needs one, and sometimes where it does not."""
        model = self.model
        if model.inverse:
            return [f"F{self.random.choice(['60', '200.5', '099.', '[1+80]'])}"]  # see README.md on slow ones
        if always or not model.fed or self.random.random() < 0.1:
            model.fed = True
            return [f"F{self.random.choice(['100', '250.5', '0600', '[3*40]', '12.'])}"]
        return []

    # Moves

    def straight(self) -> None:
        model, pick = self.model, self.random
        code = pick.choice(["G0", "G1", "G1", "G1"])
        axes = [axis for axis in LINEAR if pick.random() < 0.5] or [pick.choice(LINEAR)]
        if pick.random() < 0.15 and not model.inverse:
            axes += [axis for axis in "ABC" if pick.random() < 0.5]
        ends = {axis: self.axis_word(axis, self.target(axis)) for axis in axes}
        words = [word for word, _ in ends.values()]
        if code == "G1":
            words += self.feed_words()
        if model.motion != code or pick.random() < 0.4:
            words.append(code)
        pick.shuffle(words)
        self.line(*words)
        for axis, (_, end) in ends.items():
            model.go(axis, end)
        model.motion, model.straight = code, True

    def arc(self) -> None:
        model, pick = self.model, self.random
        first, second, third = PLANES[model.plane]
        clockwise = pick.random() < 0.5
        code = "G2" if clockwise else "G3"
        radius = 10 ** pick.uniform(0.0, 2.0) / model.unit
        turn, begin = pick.uniform(0.3, 5.9), pick.uniform(0.0, math.tau)
        decimals = 5 if model.unit == 1.0 else 6
        p, q = model.at(first), model.at(second)
        i, j = (round(-radius * f(begin), decimals) for f in (math.cos, math.sin))
        stop = math.atan2(-j, -i) + (-turn if clockwise else turn)
        size = math.hypot(i, j)
        ends = {
            first: self.axis_word(first, p + i + size * math.cos(stop), decimals),
            second: self.axis_word(second, q + j + size * math.sin(stop), decimals),
        }
        if pick.random() < 0.3:
            ends[third] = self.axis_word(third, self.target(third))
        words = [word for word, _ in ends.values()]
        if pick.random() < 0.3 and abs(turn - math.pi) > 0.2:
            sign = "-" if turn > math.pi else ""
            words.append(f"R{sign}{self.radius(ends, first, second, size):.{decimals}f}")
        else:
            words += [f"{CENTRE[a]}{v:.{decimals}f}" for a, v in ((first, i), (second, j))]
        words += self.feed_words()
        if model.motion != code or pick.random() < 0.4:
            words.append(code)
        pick.shuffle(words)
        self.line(*words)
        for axis, (_, end) in ends.items():
            model.go(axis, end)
        model.motion, model.straight = code, False

    def radius(self, ends: dict[str, tuple[str, float]], first: str, second: str, size: float) -> float:
        """A radius that reaches the end as it was written, clear of half a circle."""
        half = math.hypot(ends[first][1] - self.model.at(first), ends[second][1] - self.model.at(second)) / 2
        return max(size, 1.001 * half)

    def whole_circle(self) -> None:
        """A circle, or a turn of a helix, back to the start: exact in increments only."""
        model, pick = self.model, self.random
        if model.absolute:
            self.line("G91")
            model.absolute = False
        first, second, third = PLANES[model.plane]
        code = pick.choice(["G2", "G3"])
        words = [code, f"{first}0", f"{second}0"][: pick.choice([2, 3])]
        words.append(f"{CENTRE[first]}{pick.uniform(1.0, 30.0):.4f}")
        words.append(f"{CENTRE[second]}{pick.uniform(-9.0, 9.0):.4f}")
        words += self.feed_words()
        if pick.random() < 0.4:
            text, read = self.real(pick.choice([-2.5, -0.5, 1.25]))
            words.append(third + text)
            model.go(third, model.at(third) + read)
        pick.shuffle(words)
        self.line(*words)
        model.motion, model.straight = code, False

    def machine_move(self) -> None:
        model, pick = self.model, self.random
        if not model.absolute:
            self.line("G90")
            model.absolute = True
        code = pick.choice(["G0", "G1"])
        words = ["G53", code]
        for axis in pick.sample(LINEAR, pick.randrange(1, 4)):
            text, read = self.real(pick.uniform(-50.0, 50.0) / model.unit)
            words.append(axis + text)
            model.machine[axis] = read * model.unit
        words += self.feed_words() if code == "G1" else []
        self.line(*words)
        model.motion, model.straight = code, True

    def home(self) -> None:
        self.line(self.random.choice(["G28", "G30"]))
        self.model.machine = zeros()
        self.model.straight = True

    # Canned cycles

    def cycle(self) -> None:
        """A cycle of some lines, then G80. Levels are whole numbers apart, so that none is nearly another."""
        model, pick = self.model, self.random
        codes = ["G81", "G82", "G83", "G85", "G89"] + (["G86"] if model.turning else [])
        code = pick.choice(codes)
        down = PLANES[model.plane][2]
        model.old_level = pick.random() < 0.5 and code not in {"G83", "G85"}
        level = "G98" if model.old_level else "G99"
        feed = self.feed_words(always=True) if not model.fed else []
        for k in range(pick.randrange(1, 4) if model.absolute else 1):
            words = [code, level, *feed] if k == 0 else ([code] if pick.random() < 0.3 else [])
            words += self.hole(code, down, k == 0)
            pick.shuffle(words)
            self.line(*words)
            feed = []
        self.line("G80")
        model.motion, model.straight = None, True

    def hole(self, code: str, down: str, first: bool) -> list[str]:
        """The words of one line of a cycle; moves the model."""
        model, pick = self.model, self.random
        beside = [axis for axis in PLANES[model.plane][:2] if pick.random() < 0.8]
        old = model.at(down)
        rise = round(pick.choice([-3, -2, 2, 3]) * 1.5 / model.unit, 4)
        depth = round(pick.uniform(1, 9) / model.unit, 4)
        repeats = pick.choice([2, 3]) if pick.random() < 0.25 else 1
        words = [f"L{repeats}"] if repeats > 1 else []
        if model.absolute:
            if first:
                top_word, top = self.number(round(old, 3) + rise, 4)
                words += [f"R{top_word}", f"{down}{self.number(top - depth, 4)[0]}"]
                self.top = top
            elif not beside or pick.random() < 0.3:
                words.append(f"{down}{self.number(self.top - depth, 4)[0]}")
            top = self.top
        else:
            rise_word, rise = self.number(rise, 4)
            words += [f"R{rise_word}", f"{down}{self.number(-depth, 4)[0]}"]
            top = old + rise
        ends: dict[str, float] = {}
        for axis in beside:
            word, end = self.axis_word(axis, self.target(axis))
            words.append(word)
            step = end - model.at(axis)
            ends[axis] = end if model.absolute else model.at(axis) + repeats * step
        if code == "G83":
            words.append(f"Q{2.5 / model.unit:.3f}")
        if code in {"G82", "G86", "G89"}:
            words.append(f"P{pick.choice(['0.5', '1', '[1/4]'])}")
        for axis, end in ends.items():
            model.go(axis, end)
        model.go(down, max(old, top) if model.old_level else top)
        return words

    # Offsets and modes

    def offsets(self) -> None:
        model, pick = self.model, self.random
        axes = pick.sample(AXES, pick.randrange(1, 4))
        values = {axis: self.real(pick.uniform(-40.0, 40.0) / model.scale(axis)) for axis in axes}
        words = [axis + text for axis, (text, _) in values.items()]
        plain = model.length == 0.0 and not any(model.g92.values())
        kind = pick.choice(["G92", "G10 L2", "G10 L20" if plain else "G10 L2"])
        if kind == "G92":
            self.line("G92", *words)
            for axis, (_, read) in values.items():
                model.g92[axis] += model.at(axis) * model.scale(axis) - read * model.scale(axis)
            model.g92_kept = dict(model.g92)
        else:
            system = pick.randrange(len(SYSTEMS))
            self.line(*pick.sample([*kind.split(), f"P{system + 1}", *words], len(words) + 3))
            for axis, (_, read) in values.items():
                placed = read * model.scale(axis)
                model.work[system][axis] = placed if kind == "G10 L2" else model.machine[axis] - placed
        model.straight = False

    def cancel_g92(self) -> None:
        model = self.model
        code = self.random.choice(["G92.1", "G92.2", "G92.3"])
        self.line(code)
        if code == "G92.1":
            model.g92_kept = zeros()
        model.g92 = dict(model.g92_kept) if code == "G92.3" else zeros()
        model.straight = False

    def system(self) -> None:
        self.model.system = self.random.randrange(len(SYSTEMS))
        self.line(f"G{SYSTEMS[self.model.system]}")
        self.model.straight = False

    def tool_length(self) -> None:
        tool = self.random.choice([0, *TOOLS])
        self.line(*([f"G43 H{tool}"] if tool else ["G49"]))
        self.model.length = TOOLS.get(tool, 0.0)
        self.model.straight = False

    def units(self) -> None:
        model = self.model
        if model.length:
            self.line("G49")
            model.length = 0.0
        model.unit = MM_PER_INCH if model.unit == 1.0 else 1.0
        self.line("G20" if model.unit != 1.0 else "G21")
        model.fed, model.straight = False, False

    def distance(self) -> None:
        self.model.absolute = not self.model.absolute
        self.line("G90" if self.model.absolute else "G91")

    def plane(self) -> None:
        self.model.plane = self.random.choice(list(PLANES))
        self.line(f"G{self.model.plane}")

    def inverse_time(self) -> None:
        """Some moves under inverse time feed, each with its own F."""
        self.line("G93")
        self.model.inverse = True
        for _ in range(self.random.randrange(1, 4)):
            self.random.choice([self.straight, self.arc])()
        self.line("G94")
        self.model.inverse, self.model.fed = False, False

    def path(self) -> None:
        self.line(self.random.choice(["G61", "G64", "G64 P0.05", "G61.1"]))

    # Events

    def event(self) -> None:
        model, pick = self.model, self.random
        code = pick.choice("M3 M4 M5 S1000 S[500+50] M7 M8 M9 M48 M0 M1 G4".split())
        words = [code]
        if code in {"M3", "M4"}:
            words.append(pick.choice(["S800", "S1200.5"]))
        if code in {"M3", "M4", "M5"}:
            model.turning = code != "M5"
        if code == "G4":
            words.append(pick.choice(["P0.5", "P[3/4]"]))
        self.line(*words)

    def change(self) -> None:
        model, pick = self.model, self.random
        if model.length:
            self.line("G49")
            model.length, model.straight = 0.0, False
        if pick.random() < 0.4:
            model.tool_asked = pick.choice(list(TOOLS))
            self.line(f"T{model.tool_asked}")
        if not model.straight:
            self.straight()
        words = ["M6"]
        if not model.tool_asked or pick.random() < 0.7:
            model.tool_asked = pick.choice(list(TOOLS))
            words.insert(pick.randrange(2), f"T{model.tool_asked}")
        model.turning = False
        self.line(*words)

    def parameter(self) -> None:
        """An assignment whose expression uses what was assigned before."""
        pick = self.random
        text, read = self.real(round(pick.uniform(-20.0, 20.0), 3), 3)
        forms: list[tuple[str, float]] = [
            (f"[{text}*2]", read * 2),
            (f"fix[{text}]", float(math.floor(read))),
            (f"fup[{text}]", float(math.ceil(read))),
            (f"[10*sin[{text}]]", 10 * math.sin(math.radians(read))),
            (f"atan[{text}]/[2]", math.degrees(math.atan2(read, 2.0))),
            (f"sqrt[abs[{text}]]", math.sqrt(abs(read))),
            (f"[[{text}] ** 2 / 8]", read**2 / 8),
            ("[17 mod 5 + [1 and 0.5]]", 3.0),
        ]
        self.assign(*pick.choice(forms))

    def note(self) -> None:
        self.lines.append(self.random.choice(["", "(a note)", "; a note", "   ", "( G0 X1 )"]))

    def program(self, steps: int) -> Program:
        self.lines.append(f"(random program of seed {self.seed})")
        self.lines.append("G21 G17 G40 G49 G54 G80 G90 G94 G98")
        kinds: list[tuple[Callable[[], None], int]] = [
            (self.straight, 12),
            (self.arc, 8),
            (self.whole_circle, 1),
            (self.machine_move, 1),
            (self.home, 1),
            (self.cycle, 4),
            (self.offsets, 3),
            (self.cancel_g92, 1),
            (self.system, 2),
            (self.tool_length, 1),
            (self.units, 2),
            (self.distance, 3),
            (self.plane, 3),
            (self.inverse_time, 1),
            (self.path, 1),
            (self.event, 4),
            (self.change, 1),
            (self.parameter, 2),
            (self.note, 1),
        ]
        writers, weights = zip(*kinds, strict=True)
        for write in self.random.choices(writers, weights, k=steps):
            write()
        self.lines.append(self.random.choice(["M2", "M30"]))
        return Program(self.seed, "\n".join(self.lines) + "\n", dict(self.model.machine))


def random_program(seed: int, statements: int | None = None) -> Program:
    """The program of a seed, of some ten to some fifty statements if it is not said how many."""
    generator = Generator(seed)
    return generator.program(generator.random.randrange(10, 50) if statements is None else statements)


def shrink(text: str, fails: Callable[[str], bool], tries: int = 200) -> str:
    """A smaller program that still fails: leave out lines, halves first, as long as the failure stays."""
    lines = text.splitlines()
    size = len(lines) // 2
    while size and tries:
        k = 2  # title and first line stay
        while k < len(lines) - 1 and tries:
            shorter = lines[:k] + lines[min(k + size, len(lines) - 1) :]
            tries -= 1
            if len(shorter) < len(lines) and fails("\n".join(shorter) + "\n"):
                lines = shorter
            else:
                k += size
        size //= 2
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    sys.stdout.write(random_program(int(sys.argv[1])).text)
