"""Random programs of Eding CNC; sections are those of its manual."""

from __future__ import annotations

import random
from typing import Any

from .writer import CENTER, INCH, PLANES, Made, Writer

CODES = {"XY": "G17", "ZX": "G18", "YZ": "G19"}
VARIABLES = (1, 2, 3)


class Eding(Writer):
    """Blocks in one order of execution (3.7), numbered variables, structures of 4.1."""

    kinds = (
        ("move", 30), ("contour", 8), ("arc", 12), ("plane_arc", 4), ("unit", 3), ("distance", 3), ("feed", 3),
        ("dwell", 3),
        ("spindle", 4), ("coolant", 3), ("tool", 2), ("stop", 2), ("output", 3), ("comment", 3), ("message", 1),
        ("wait", 1), ("work", 4), ("local", 4), ("stored", 2), ("machine", 2), ("cycle", 6), ("rotated", 3),
        ("scaled", 1), ("assign", 4), ("loop", 5), ("choice", 4), ("asked", 3), ("called", 5), ("inverse", 2),
        ("path", 1), ("bored", 1),
    )  # fmt: skip
    nested = frozenset({"tool"})

    def __init__(self, rng: random.Random, without: frozenset[str]) -> None:
        super().__init__(rng, without)
        self.pair = "XY"
        self.subs: list[list[str]] = []
        self.counter = 210

    # ---- numbers

    def number(self, value: float) -> tuple[str, bool]:
        rng = self.rng
        roll = rng.random()
        if roll < 0.8 or "expression" in self.without:
            return self.text(value), True
        if roll < 0.88:
            part = round(rng.uniform(0.5, 5), 2)
            return f"[{self.text(value - part)} + {part}]", True
        return rng.choice((
            f"[#{rng.choice(VARIABLES)} * {rng.choice((0.5, 1.5, 2))}]", f"#{rng.choice(VARIABLES)}",
            f"[{abs(value):.3f} * sin[{rng.choice((30, 90, 200))}]]", f"[#1 + #2 - {abs(value):.2f}]",
            f"[sqrt[{abs(value):.3f}] + abs[#3]]",
        )), False  # fmt: skip

    def modes(self) -> object:
        return self.size, self.relative, self.pair

    def restore(self, before: Any) -> None:
        self.size, self.relative, self.pair = before
        unit, mode = "G20" if self.size == INCH else "G21", "G91" if self.relative else "G90"
        self.say(f"{unit} {mode} {CODES[self.pair]} F{self.text(300 / self.size)}")

    def place(self) -> None:
        """All axes at literal places."""
        self.relative = False
        self.say(f"G90 G0 {self.all_words()}")
        self.code = "G0"

    # ---- motion

    def move(self) -> None:
        rng = self.rng
        code = rng.choice(("G0", "G1", "G1"))
        shown = "" if code == self.code and self.chance(0.6) else f"{code} "
        feed = f" F{self.text(rng.choice((100, 250, 480.5)) / self.size, 2)}" if self.chance(0.15) else ""
        devices = f" {rng.choice(('M8', 'S4000', 'M9', 'S2500'))}" if self.chance(0.05) else ""
        self.say(f"{shown}{self.words()}{feed}{devices}")
        self.code = code

    def contour(self) -> None:
        if not self.known() and not self.relative:
            self.place()
        for _ in range(self.rng.randrange(3, 9)):
            (self.move if self.chance(0.6) or self.pair != "XY" else self.one_arc)()

    def arc(self) -> None:
        if self.pair != "XY":
            self.pair = "XY"
            self.say("G17")
        self.one_arc()

    def plane_arc(self) -> None:
        self.pair = self.rng.choice(("ZX", "YZ"))
        self.say(CODES[self.pair])
        self.one_arc()
        if self.chance(0.7):
            self.pair = "XY"
            self.say("G17")

    def one_arc(self) -> None:
        if self.chance(0.15) and not self.relative:
            self.relative = True
            self.say("G91")
        if not self.relative and not self.known():
            self.place()
        arc = self.arc_words((self.pair,))
        ends = self.arc_ends(arc)
        code = "G2" if arc.clockwise else "G3"
        if not arc.full and self.chance(0.3):
            center = f"R{self.text(-arc.radius if arc.is_long else arc.radius)}"
        else:
            words = [
                f"{CENTER[axis]}{self.text(by)}" for axis, by in zip(arc.pair, arc.center, strict=True)
                if by or arc.full or self.chance(0.7)
            ]  # fmt: skip
            center = " ".join(words)
        shown = "" if code == self.code and self.chance(0.6) else f"{code} "
        self.say(f"{shown}{' '.join(f'{axis}{text}' for axis, text in ends.items())} {center}")
        self.code = code

    def inverse(self) -> None:
        """F in every block that moves with feed (3.4.24)."""
        if not self.known():
            self.place()
        self.say("G93")
        for _ in range(self.rng.randrange(1, 4)):
            self.say(f"G1 {self.words()} F{self.rng.choice((2, 4, 12.5))}")
        self.say(f"G94 F{self.text(300 / self.size)}")
        self.code = ""

    def machine(self) -> None:
        """A rapid in machine coordinates (3.4.14)."""
        axis = self.rng.choice("ZZXY")
        if self.relative:
            self.distance()
        self.say(f"G53 G0 {axis}{self.text(self.length(20))}")
        self.at.pop(axis, None)
        self.code = ""

    def cycle(self) -> None:
        self.drill(("G81", "G82", "G83", "G73"))

    def bored(self) -> None:
        self.drill(("G85", "G89"))

    def drill(self, codes: tuple[str, ...]) -> None:
        """A series of holes (3.4.21)."""
        rng = self.rng
        if self.pair != "XY":
            self.pair = "XY"
            self.say("G17")
        if not self.known():
            self.place()
        if self.relative:
            self.relative = False
            self.say("G90")
        code = rng.choice(codes)
        top = round(self.at["Z"] / self.size - self.above(0.0, 8.0), self.digits)
        if self.chance(0.2):
            top = round(self.at["Z"] / self.size + self.above(1.0, 8.0), self.digits)
        bottom = round(top - self.above(2.0, 12.0), self.digits)
        extra = {"G82": " P0.4", "G89": " P0.2", "G83": f" Q{self.above(1, 4)}", "G73": f" Q{self.above(1, 4)}"}
        back = rng.choice(("", "G98 ", "G99 "))
        repeats = f" L{rng.choice((2, 3))}" if self.chance(0.06) and "repeats" not in self.without else ""
        self.say(f"{back}{code} X{self.length(30)} Y{self.length(30)} Z{bottom} R{top}{extra.get(code, '')}{repeats}")
        for _ in range(rng.randrange(0, 4)):
            self.say(self.words("XY", 30))
        self.say("G80")
        self.at, self.code = {}, ""

    def rotated(self) -> None:
        """About a point, counter-clockwise (3.4.18)."""
        rng = self.rng
        self.usual()
        self.say(f"G68 R{rng.choice((90, 45, -30, 12.5, 180))} X{self.length(20)} Y{self.length(20)}")
        self.turned()
        self.say("G69")
        self.place()

    def scaled(self) -> None:
        """Of X and Y alike (3.4.13)."""
        self.usual()
        self.say(f"G51 P{self.rng.choice((2, 0.5, 1.5))} I{self.length(20)} J{self.length(20)}")
        self.turned()
        self.say("G50")
        self.place()

    def usual(self) -> None:
        if self.relative or self.pair != "XY":
            self.relative, self.pair = False, "XY"
            self.say("G90 G17")

    def turned(self) -> None:
        self.place()
        for _ in range(self.rng.randrange(1, 5)):
            (self.move if self.chance(0.6) else self.arc)()
        self.usual()

    # ---- modes

    def unit(self) -> None:
        self.size = INCH if self.size == 1.0 else 1.0
        code = "G20" if self.size == INCH else "G21"
        for line in (code, f"F{self.text(200 / self.size, 2)}") if self.chance(0.8) else (f"{code} F250",):
            self.say(line)

    def distance(self) -> None:
        self.relative = not self.relative
        self.say("G91" if self.relative else "G90")

    def feed(self) -> None:
        self.say(f"F{self.text(self.rng.choice((90, 300, 720)) / self.size, 2)}")

    def path(self) -> None:
        self.say(self.rng.choice(("G61", "G64 P0.1", "G64")))

    # ---- zeros

    def work(self) -> None:
        self.say(self.rng.choice(("G54", "G55", "G56", "G57", "G58")))
        self.at = {}
        self.place()

    def local(self) -> None:
        """Names the present place, until G92.1 (3.4.23)."""
        if not self.known():
            self.place()
        words = []
        for axis in "XYZ":
            if self.chance(0.5):
                value = self.length(20)
                self.at[axis] = value * self.size
                words.append(f"{axis}{self.text(value)}")
        self.say(f"G92 {' '.join(words) or 'X0'}")
        if not words:
            self.at["X"] = 0.0
        self.code = ""
        if self.chance(0.75):
            for _ in range(self.rng.randrange(1, 4)):
                self.move()
            self.say("G92.1")
            self.at, self.code = {}, ""
            self.place()

    def stored(self) -> None:
        """Numbers of a coordinate system, which is then used (3.4.5)."""
        number = self.rng.randrange(2, 6)
        words = " ".join(f"{axis}{self.length(30)}" for axis in "XYZ")
        self.say(f"G10 L2 P{number} {words}")
        self.say(f"G{53 + number}")
        self.at = {}
        self.place()
        self.move()
        if self.chance(0.7):
            self.say("G54")
            self.at = {}
            self.place()

    # ---- devices

    def dwell(self) -> None:
        self.say(f"G4 P{self.rng.choice((0.5, 1, 0.25))}")

    def spindle(self) -> None:
        line = self.rng.choice(("S6000 M3", "M4 S3000", "M5", "S8000", "M3"))
        if "reverse" in self.without and line != "S8000":
            self.say("M5")
        self.say(line)

    def coolant(self) -> None:
        self.say(self.rng.choice(("M8", "M9", "M8") if "mist" in self.without else ("M7", "M8", "M9")))

    def tool(self) -> None:
        number = self.rng.randrange(1, 4)
        self.say(f"T{number} M6")
        if "length" not in self.without and self.chance(0.6):
            self.say("G43")
        self.at, self.code = {}, ""
        self.place()

    def stop(self) -> None:
        self.say(self.rng.choice(("M0", "M0 (turn it)", "M0") if "optional" in self.without else ("M0", "M1")))

    def output(self) -> None:
        self.say(f"{self.rng.choice(('M54', 'M55'))} P{self.rng.randrange(5, 8)}")

    def wait(self) -> None:
        """Until an input is on or off (3.5.9)."""
        limit = " Q30" if self.chance(0.3) and "limit" not in self.without else ""
        self.say(f"M56 P{self.rng.randrange(1, 4)} L{self.rng.choice((1, 2))}{limit}")

    def comment(self) -> None:
        self.say(self.rng.choice(("(pocket)", "; a side", "(two words)")))

    def message(self) -> None:
        self.say('msg "side done"')

    # ---- structure

    def assign(self) -> None:
        rng = self.rng
        number = rng.choice(VARIABLES)
        self.say(f"#{number} = {rng.choice((self.length(20), f'[#{rng.choice(VARIABLES)} / 2 + {self.above(1, 9)}]'))}")

    def loop(self) -> None:
        self.counter += 1
        name, count = self.counter, self.rng.randrange(1, 4)
        self.say(f"#{name} = 0")
        self.say(f"while [#{name} < {count}]")

        def by_pass() -> None:
            self.say(f"G90 G0 X[#{name} * {self.above(1, 20)}] Y[5 - #{name}]")
            self.relative, self.code = False, "G0"

        computed = "expression" not in self.without and self.chance(0.5)
        self.block(self.rng.randrange(1, 4), by_pass if computed else None)
        self.say(f"#{name} = [#{name} + 1]")
        self.say("endwhile")

    def choice(self) -> None:
        rng = self.rng
        one = f"[#{rng.choice(VARIABLES)} {rng.choice(('<', '>', '<=', '>='))} {round(rng.uniform(-9, 9), 2)}]"
        two = f" {rng.choice(('and', 'or'))} [#{rng.choice(VARIABLES)} > 0]" if self.chance(0.2) else ""
        self.ways(f"if [{one}{two}]" if two else f"if {one}")

    def asked(self) -> None:
        """By an input (3.5.9)."""
        self.say(f"M56 P{self.rng.randrange(1, 4)}")
        self.ways(f"if [#5399 == {self.rng.choice((1, 0))}]")

    def ways(self, condition: str) -> None:
        self.say(condition)
        self.block(self.rng.randrange(1, 3))
        if self.chance(0.4) and "else" not in self.without:
            self.say("else")
            self.block(self.rng.randrange(1, 3))
        self.say("endif")

    def called(self) -> None:
        """A subprogram, whose arguments are variables (4.1)."""
        name = len(self.subs)
        body: list[str] = []
        self.subs.append(body)

        def by_arguments() -> None:
            self.say("G90 G0 X[#20 + 5] Y[#20 * 2]")
            self.say("G1 Z[-#21]")
            self.relative, self.code = False, "G1"

        computed = "expression" not in self.without and self.chance(0.5)
        body += self.captured(lambda: self.block(self.rng.randrange(1, 4), by_arguments if computed else None))
        for _ in range(self.rng.randrange(1, 3)):
            self.say(f"#20 = {self.above(1, 30)}")
            self.say(f"#21 = {self.above(1, 9)}")
            self.say(f"gosub part_{name}")
        self.at, self.code = {}, ""

    # ---- the whole

    def program(self) -> str:
        rng = self.rng
        head = ["G17 G21 G90 G94 G54", "G40 G49 G80"]
        rng.shuffle(head)
        for line in head:
            self.say(line)
        for number in VARIABLES:
            self.say(f"#{number} = {self.length(20)}")
        self.say("F300 S3000")
        if self.chance(0.4) and "tool" not in self.without:
            self.tool()
        self.place()
        for _ in range(rng.randrange(4, 15)):
            self.any()
        self.say(rng.choice(("M30", "M2")))
        subs = [
            line for n, body in enumerate(self.subs) for line in (f"sub part_{n}", *body, "endsub", "")
        ]  # fmt: skip
        return "\n".join([*subs, *self.lines]) + "\n"


def program(rng: random.Random, without: frozenset[str] = frozenset()) -> Made:
    """A random program."""
    return Made("eding", ".cnc", Eding(rng, without).program())


assert set(PLANES) == set(CODES)
