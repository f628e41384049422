"""Random programs of McuWIN; sections are those of the manual of V 2.5.3.133."""

from __future__ import annotations

import random
from typing import Any

from .writer import CENTER, INCH, Made, Writer

CODES = {"XY": "G17", "ZX": "G18", "YZ": "G19"}


class McuWin(Writer):
    """Lines of DIN 66025, and structures of rw_SymPas; a line without a code only after a move."""

    kinds = (
        ("move", 30), ("contour", 10), ("arc", 14), ("plane_arc", 3), ("unit", 2), ("distance", 4), ("centers", 2),
        ("feed", 3), ("dwell", 3), ("spindle", 4), ("coolant", 3), ("tool", 2), ("stop", 2), ("output", 4),
        ("comment", 4), ("message", 1), ("work", 5), ("shifted", 4), ("placed", 3), ("off", 1), ("kept", 2),
        ("mirrored", 3), ("assign", 4), ("loop", 7), ("choice", 4), ("asked", 4), ("called", 6), ("jump", 2),
    )  # fmt: skip
    nested = frozenset({"tool", "jump", "work", "placed", "off"})

    def __init__(self, rng: random.Random, without: frozenset[str], *, planes: bool) -> None:
        super().__init__(rng, without | (frozenset() if planes else {"plane_arc"}))
        self.pair = "XY"
        self.places = False
        """Whether centres are places (G161)."""
        self.subs: list[tuple[int, list[str]]] = []
        self.counter = 620
        self.label = 10
        self.named = self.chance(0.4)

    # ---- numbers

    def number(self, value: float) -> tuple[str, bool]:
        rng = self.rng
        if self.chance(0.85) or "expression" in self.without:
            return self.text(value), True
        name = rng.choice(self.variables)
        return rng.choice((
            f"({name} * {rng.choice((0.5, 1.5, 2))})", f"({name} - {abs(value):.2f})",
            f"({abs(value):.3f} * sin({name}))", f"(sqrt({abs(value):.2f}) + abs({name}))",
        )), False  # fmt: skip

    @property
    def variables(self) -> list[str]:
        return ["CD601", "CD602", *(["depth"] if self.named else [])]

    def modes(self) -> object:
        return self.size, self.relative, self.pair, self.places

    def restore(self, before: Any) -> None:
        self.size, self.relative, self.pair, self.places = before
        self.say(f"{'G70' if self.size == INCH else 'G71'} F{self.text(300 / self.size)}")
        self.say("G91" if self.relative else "G90")
        self.say(CODES[self.pair])
        self.say("G161" if self.places else "G162")
        self.code = ""

    def mode(self, line: str) -> None:
        """A line after which a code has to be said again."""
        self.say(line)
        self.code = ""

    def rapid(self, words: str) -> None:
        self.say(f"G00 {words}" if self.code != "G00" or self.chance(0.4) else words)
        self.code = "G00"

    def place(self) -> None:
        if self.relative:
            self.relative = False
            self.mode("G90")
        size, self.size = self.size, 1.0  # G00 has the unit of the axes (3.1)
        words = self.all_words()
        self.size = size
        self.rapid(words)

    # ---- motion

    def move(self) -> None:
        rng = self.rng
        if self.chance(0.35):
            size, self.size = self.size, 1.0
            words = self.words()
            self.size = size
            self.rapid(words)
            return
        feed = f" F{self.text(rng.choice((100, 250, 480)) / self.size, 2)}" if self.chance(0.15) else ""
        shown = "" if self.code == "G01" and self.chance(0.6) else "G01 "
        self.say(f"{shown}{self.words()}{feed}")
        self.code = "G01"

    def contour(self) -> None:
        if not self.known() and not self.relative:
            self.place()
        for _ in range(self.rng.randrange(3, 9)):
            (self.move if self.chance(0.6) or self.pair != "XY" else self.one_arc)()

    def arc(self) -> None:
        if self.pair != "XY":
            self.pair = "XY"
            self.mode("G17")
        self.one_arc()

    def plane_arc(self) -> None:
        self.pair = self.rng.choice(("ZX", "YZ"))
        self.mode(CODES[self.pair])
        self.one_arc()
        if self.chance(0.7):
            self.pair = "XY"
            self.mode("G17")

    def one_arc(self) -> None:
        if not self.relative and not self.known():
            self.place()
        begin = {axis: self.at.get(axis, 0.0) / self.size for axis in "XYZ"}
        arc = self.arc_words((self.pair,))
        ends = self.arc_ends(arc)
        words = []
        for axis, by in zip(arc.pair, arc.center, strict=True):
            value = by + (begin[axis] if self.places and not self.relative else 0.0)
            words.append(f"{CENTER[axis]}{self.text(value)}")
        shown = " ".join([*(f"{axis}{text}" for axis, text in ends.items()), *words])
        self.say(f"{'G02' if arc.clockwise else 'G03'} {shown}")
        self.code = ""

    def mirrored(self) -> None:
        """Reflections add up until G24 (3.9 to 3.12)."""
        rng = self.rng
        for code in rng.sample(["G21", "G22", "G23"], rng.randrange(1, 3)):
            self.mode(code)
        # About which zero places are mirrored is open (3.9), distances are clear.
        if not self.relative:
            self.distance()
        self.at = {}
        for _ in range(rng.randrange(1, 5)):
            (self.move if self.chance(0.6) else self.arc)()
        self.mode("G24")
        self.distance()
        self.at = {}
        self.place()

    # ---- modes

    def unit(self) -> None:
        self.size = INCH if self.size == 1.0 else 1.0
        self.mode(f"{'G70' if self.size == INCH else 'G71'} F{self.text(250 / self.size, 2)}")

    def distance(self) -> None:
        self.relative = not self.relative
        self.mode("G91" if self.relative else "G90")

    def centers(self) -> None:
        self.places = not self.places
        self.mode("G161" if self.places else "G162")

    def feed(self) -> None:
        self.say(f"F{self.text(self.rng.choice((90, 300, 720)) / self.size, 2)}")

    # ---- zeros

    def offset(self, words: list[tuple[str, float]]) -> str:
        """Words of G92, in mm."""
        return " ".join(f"{axis}{self.text(value)}" for axis, value in words)

    def millimetres(self) -> None:
        if self.size != 1.0:
            self.unit()

    def work(self) -> None:
        self.mode(self.rng.choice(("G54", "G55", "G56", "G57", "G58")))
        self.at = {}
        self.place()

    def shifted(self) -> None:
        """G92 among distances is added (3.26)."""
        self.millimetres()
        words = [(axis, self.length(15)) for axis in "XYZ" if self.chance(0.5)] or [("X", self.length(15))]
        relative = self.relative
        if not relative:
            self.mode("G91")
        self.mode(f"G92 {self.offset(words)}")
        if not relative:
            self.mode("G90")
        for axis, value in words:
            if axis in self.at:
                self.at[axis] -= value
        if self.deep or self.chance(0.5):
            for _ in range(self.rng.randrange(1, 3)):
                self.move()
            self.millimetres()
            if not self.relative:
                self.mode("G91")
            self.mode(f"G92 {self.offset([(axis, -value) for axis, value in words])}")
            if not self.relative:
                self.mode("G90")
            self.at = {}

    def placed(self) -> None:
        """G92 among places is a place of the machine (3.26)."""
        self.millimetres()
        if self.relative:
            self.distance()
        words = [(axis, self.length(40)) for axis in "XYZ" if self.chance(0.6)] or [("Y", self.length(40))]
        self.mode(f"G92 {self.offset(words)}")
        self.at = {}
        self.place()
        if self.chance(0.6):
            self.move()
            self.work()

    def off(self) -> None:
        """No offset (3.18); it means G90."""
        self.mode("G53")
        self.mode("G90")
        self.relative, self.at = False, {}
        self.place()
        self.move()
        if self.chance(0.8):
            self.work()

    def kept(self) -> None:
        """The zero is read and set again (3.33, 3.34)."""
        self.millimetres()
        if self.relative:
            self.distance()
        self.mode("G153")
        self.mode(self.rng.choice((f"G92 X{self.length(20)}", f"G92 Z{self.length(5)}", "G53")))
        self.mode("G90")
        self.at = {}
        self.place()
        self.move()
        self.mode("G154")
        self.at = {}
        self.place()

    # ---- devices

    def dwell(self) -> None:
        self.mode(f"G04 {self.rng.choice((0.5, 1, 0.25))}")

    def spindle(self) -> None:
        line = self.rng.choice(("S6000 M03", "M04", "M05", "S8000", "M03"))
        if "reverse" in self.without and line != "S8000":
            self.say("M05")
        self.say(line)

    def coolant(self) -> None:
        self.say(self.rng.choice(("M08", "M09")))

    def tool(self) -> None:
        number = self.rng.randrange(1, 4)
        for line in (f"T{number}", "M06") if self.chance(0.5) else (f"T{number} M06",):
            self.mode(line)
        self.at = {}
        self.place()

    def stop(self) -> None:
        self.say("M00" if "optional" in self.without else self.rng.choice(("M00", "M00", "M01")))

    def output(self) -> None:
        """A channel of axis 1 (4.11)."""
        self.say(f"{self.rng.choice(('M26', 'M27'))} 10{self.rng.randrange(5, 8)}")

    def comment(self) -> None:
        self.say(self.rng.choice(("' pocket", "(a side)", "' two words")))

    def message(self) -> None:
        self.mode('WRITELN "side done"')

    # ---- structure

    def assign(self) -> None:
        self.say(f"{self.rng.choice(self.variables)} := {self.text(self.length(20))}")

    def loop(self) -> None:
        rng = self.rng
        self.counter += 1
        name, count = f"CI{self.counter}", rng.randrange(1, 4)
        kind = rng.randrange(4)

        def by_pass() -> None:
            if self.relative:
                self.distance()
            self.say(f"G00 X({name} * {self.text(round(rng.uniform(1, 20), 2))}) Y(5 - {name})")
            self.code = "G00"

        computed = by_pass if "expression" not in self.without and self.chance(0.5) else None
        inside = rng.randrange(1, 4)
        if kind < 2:
            first, way, last = rng.choice(((1, "to", count), (count, "downto", 1)))
            self.say(f"$for {name} := {first} {way} {last} do begin")
            self.block(inside, computed)
            self.say("$end;")
        else:
            self.say(f"{name} := 0")
            self.say(f"$while ({name} < {count}) do begin" if kind == 2 else "$repeat begin")
            self.block(inside, computed)
            self.say(f"{name} := {name} + 1")
            self.say("$end;" if kind == 2 else f"$end until ({name} >= {count});")
        self.code = ""

    def choice(self) -> None:
        rng = self.rng
        one = f"({rng.choice(self.variables)} {rng.choice(('<', '>', '<=', '>='))} {round(rng.uniform(-9, 9), 2)})"
        self.ways(f"({one} {rng.choice(('and', 'or'))} (CD601 > 0))" if self.chance(0.2) else one)

    def asked(self) -> None:
        """By an input (7)."""
        text = f"X.digib.{self.rng.randrange(1, 4)}"
        self.ways(f"(not ({text}))" if self.chance(0.3) else f"({text})")

    def ways(self, condition: str) -> None:
        self.say(f"$if {condition} then begin")
        self.block(self.rng.randrange(1, 3))
        if self.chance(0.4) and "else" not in self.without:
            self.say("$end else begin")
            self.block(self.rng.randrange(1, 3))
        self.say("$end;")
        self.code = ""

    def called(self) -> None:
        number = 100 + len(self.subs)
        body: list[str] = []
        self.subs.append((number, body))

        def by_arguments() -> None:
            if self.relative:
                self.distance()
            self.say("G00 X(CD610 + 5) Y(CD610 * 2)")
            self.code = "G00"

        computed = "expression" not in self.without and self.chance(0.5)
        body += self.captured(lambda: self.block(self.rng.randrange(1, 4), by_arguments if computed else None))
        for _ in range(self.rng.randrange(1, 3)):
            if computed:
                self.say(f"CD610 := {self.text(round(self.rng.uniform(1, 20), 2))}")
            self.say(f"M98 L{number}{f' O{self.rng.choice((2, 3))}' if self.chance(0.3) else ''}")
        self.at, self.code = {}, ""

    def jump(self) -> None:
        """What lies between does not run (4.15)."""
        self.label += 1
        self.say(f"M96 L{self.label}")
        self.say("G01 X999")
        self.say(f"L{self.label}")
        self.code = ""

    # ---- the whole

    def program(self) -> str:
        rng = self.rng
        head = ["$DINEND", "var", "  depth : double;", "{$DINSTART}"] if self.named else []
        for line in rng.sample(["G90", "G71", "G17", "G162", "G94"], 5):
            self.say(line)
        self.say("F300 S3000")
        if self.chance(0.7):
            self.say("G54")
        for name in self.variables:
            self.say(f"{name} := {self.text(self.length(9))}")
        if self.chance(0.4) and "tool" not in self.without:
            self.tool()
        self.place()
        for _ in range(rng.randrange(4, 15)):
            self.any()
        self.say(rng.choice(("M30", "M02")))
        subs = [line for number, body in self.subs for line in (f"%{number}", *body, "M17", "%")]
        return "\n".join([*head, "%JOB", *self.lines, "%", *subs]) + "\n"


def program(rng: random.Random, without: frozenset[str] = frozenset(), *, planes: bool = True) -> Made:
    """A random program; planes: the machine has a tool table, so that G18 and G19 are there (2.7)."""
    return Made("mcuwin", ".src", McuWin(rng, without, planes=planes).program())
