"""Random programs of WinCNC; codes are those of its manual's Command Reference."""

from __future__ import annotations

import random
from typing import Any

from .writer import INCH, Made, Writer

UNITS = {"G20": INCH, "G21": 10.0, "G22": 1.0}


class WinCnc(Writer):
    """One command a line; arcs and cycles count for their line, G0 and G1 for those after it."""

    kinds = (
        ("move", 30), ("contour", 10), ("arc", 14), ("unit", 4), ("distance", 4), ("feed", 3), ("dwell", 3),
        ("spindle", 4), ("coolant", 3), ("tool", 2), ("stop", 2), ("output", 4), ("comment", 4), ("wait", 2),
        ("named", 4), ("shifted", 3), ("placed", 2), ("kept", 1), ("machine", 2), ("cycle", 7), ("rotated", 2),
        ("scaled", 1), ("array", 3), ("asked", 5), ("called", 7), ("inverse", 2), ("once", 2),
    )  # fmt: skip
    nested = frozenset({"tool", "array", "kept"})

    def __init__(self, rng: random.Random, without: frozenset[str]) -> None:
        super().__init__(rng, without)
        self.files: dict[str, str] = {}
        self.written_in: dict[str, object] = {}
        """By file: the modes it was written for; in others its arcs are none."""
        self.fed: tuple[bool, frozenset[str]] | None = None
        """Whether the last feed was said on an arc, and the axes of its line: it holds for these (F)."""

    def modes(self) -> object:
        return self.size, self.relative

    def restore(self, before: Any) -> None:
        (self.size, self.relative), self.fed = before, None
        self.say(next(code for code, size in UNITS.items() if size == self.size))
        self.say("G91" if self.relative else "G90")

    def number(self, value: float) -> tuple[str, bool]:
        if self.chance(0.03) and "expression" not in self.without:
            return f"{{{abs(value):.2f}{self.rng.choice('+-*')}{self.rng.choice((1, 2, 0.5))}}}", False
        return self.text(value), True

    def place(self) -> None:
        if self.relative:
            self.relative = False
            self.say("G90")
        self.say(f"G0 {self.all_words()}")
        self.code = "G0"

    # ---- motion

    def move(self) -> None:
        rng = self.rng
        code = rng.choice(("G0", "G1", "G1"))
        shown = "" if code == self.code and self.chance(0.6) else f"{code} "
        words = self.words()
        self.say(f"{shown}{words}{self.with_feed(words) if code == 'G1' else ''}")
        self.code = code

    def with_feed(self, words: str, *, arc: bool = False) -> str:
        """F, where none holds for these axes, or another one is wanted."""
        axes = frozenset(letter for letter in words if letter in "XYZ") or frozenset("XY")
        if self.fed is not None and self.fed[0] == arc and axes <= self.fed[1] and self.chance(0.8):
            return ""
        self.fed = arc, axes
        return f" F{self.text(self.rng.choice((600, 1000, 250)) / self.size, 2)}"

    def once(self) -> None:
        """Distances on one line of a program of places (L91)."""
        if self.relative:
            return
        axis, value = self.rng.choice("XYZ"), self.length(10)
        if axis in self.at:
            self.at[axis] += value * self.size
        self.say(f"L91 G1 {axis}{self.text(value)}{self.with_feed(axis)}")
        self.code = "G1"

    def contour(self) -> None:
        if not self.known() and not self.relative:
            self.place()
        for _ in range(self.rng.randrange(3, 9)):
            (self.move if self.chance(0.6) else self.arc)()

    def arc(self) -> None:
        if not self.relative and not self.known():
            self.place()
        arc = self.arc_words()
        ends = {} if arc.full and self.chance(0.7) else self.arc_ends(arc)
        if arc.full and not ends and arc.rise:
            value = arc.rise if self.relative else self.at["Z"] / self.size + arc.rise
            self.go("Z", round(value, 5))
            ends = {"Z": self.text(value)}
        center = f"I{self.text(arc.center[0])} J{self.text(arc.center[1])}"
        if not arc.full and not arc.is_long and self.chance(0.25):
            center = f"R{self.text(arc.radius)}"
        words = " ".join(f"{axis}{text}" for axis, text in ends.items())
        feed = self.with_feed(words, arc=True)
        self.say(" ".join(part for part in ("G2" if arc.clockwise else "G3", words, center) if part) + feed)
        if self.chance(0.5):
            self.code = ""

    def inverse(self) -> None:
        if not self.known():
            self.place()
        self.say("G93")
        for _ in range(self.rng.randrange(1, 4)):
            self.say(f"G1 {self.words()} F{self.rng.choice((2, 4, 12.5))}")
        self.say("G94")
        self.code, self.fed = "", None

    def machine(self) -> None:
        """A rapid to a place of the machine (G53)."""
        axis = self.rng.choice("ZZXY")
        if self.relative:
            self.relative = False
            self.say("G90")
        self.say(f"G53 {axis}{self.text(self.length(20))}")
        self.at.pop(axis, None)
        self.code = ""

    def cycle(self) -> None:
        rng = self.rng
        if not self.known() or self.relative:
            self.place()
        code = rng.choice(("G81", "G82", "G83", "G73"))
        top = round(self.at["Z"] / self.size - self.above(0.0, 8.0), self.digits)
        if self.chance(0.2):
            top = round(self.at["Z"] / self.size + self.above(1.0, 8.0), self.digits)
        bottom = round(top - self.above(2.0, 12.0), self.digits)
        extra = {"G82": " P400", "G83": f" Q{self.above(1.5, 4)}", "G73": f" Q{self.above(1.5, 4)}"}.get(code, "")
        self.say(
            f"{code} X{self.length(30)} Y{self.length(30)} Z{bottom} R{top}{extra} F{self.text(300 / self.size, 2)}"
        )
        self.fed = None
        for _ in range(rng.randrange(0, 4)):
            self.say(self.words("XY", 30))
        self.say("G80")
        self.at, self.code = {}, ""

    def rotated(self) -> None:
        """About a point (G52); X and Y are both said first."""
        if self.relative:
            self.distance()
        self.say(f"G52 I{self.length(20)} J{self.length(20)} A{self.rng.choice((90, 45, -30, 180))}")
        self.turned(arcs=True)

    def scaled(self) -> None:
        if self.relative:
            self.distance()
        self.say(f"G51 X{self.rng.choice((2, 0.5))} Y{self.rng.choice((2, 0.5))} I{self.length(20)} J{self.length(20)}")
        self.turned(arcs=False)

    def turned(self, *, arcs: bool) -> None:
        self.place()
        for _ in range(self.rng.randrange(1, 5)):
            (self.arc if arcs and self.chance(0.4) else self.move)()
        self.say("G50")
        self.code = ""
        self.place()

    # ---- modes

    def unit(self) -> None:
        code = self.rng.choice([code for code in UNITS if code != "G21" or "cm" not in self.without])
        self.size, self.fed = UNITS[code], None
        self.say(code)

    def distance(self) -> None:
        self.relative = not self.relative
        self.say("G91" if self.relative else "G90")

    def feed(self) -> None:
        self.say(f"F{self.text(self.rng.choice((500, 1000, 720)) / self.size, 2)}")
        self.fed = None

    # ---- zeros

    def named(self) -> None:
        """The present place gets these numbers (G92)."""
        if not self.known():
            self.place()
        words = []
        for axis in "XYZ":
            if self.chance(0.6):
                value = self.length(20)
                self.at[axis] = value * self.size
                words.append(f"{axis}{self.text(value)}")
        if words:
            self.say(f"G92 {' '.join(words)}")

    def shifted(self) -> None:
        """The zero moves (G92.2), for a while or for good."""
        words = [(axis, self.length(15)) for axis in "XYZ" if self.chance(0.5)] or [("X", self.length(15))]
        self.say("G92.2 " + " ".join(f"{axis}{self.text(value)}" for axis, value in words))
        for axis, value in words:
            if axis in self.at:
                self.at[axis] -= value * self.size
        if self.chance(0.6):
            for _ in range(self.rng.randrange(1, 4)):
                self.move()
            self.say("G92.2 " + " ".join(f"{axis}{self.text(-value)}" for axis, value in words))
            self.at = {}

    def placed(self) -> None:
        """The zero of some axes is a place of the machine (G92.1)."""
        words = [f"{axis}{self.text(self.length(30))}" for axis in "XYZ" if self.chance(0.6)] or ["X5"]
        self.say(f"G92.1 {' '.join(words)}")
        self.at = {}
        self.place()

    def kept(self) -> None:
        """Off and on again (G92.3)."""
        self.say("G92.3")
        self.at = {}
        self.place()
        self.move()
        self.say("G92.3")
        self.at = {}
        self.place()

    # ---- devices

    def dwell(self) -> None:
        self.say(f"G4 X{self.rng.choice((0.5, 1, 0.25))}")

    def spindle(self) -> None:
        for line in self.rng.choice((("S6000",), ("M5", "M3"), ("M5",), ("M5", "M4"))):
            self.say(line)

    def coolant(self) -> None:
        self.say(self.rng.choice(("M8", "M9") if "mist" in self.without else ("M7", "M8", "M9")))

    def tool(self) -> None:
        self.say(f"M6 T{self.rng.randrange(1, 4)}")
        self.at, self.code = {}, ""
        self.place()

    def stop(self) -> None:
        self.say(self.rng.choice(("G4", "G4 [turn it over]")))

    def output(self) -> None:
        codes = ("M11", "M12") if "moving" in self.without else ("M11", "M12", "M13", "M14")
        self.say(f"{self.rng.choice(codes)}C{self.rng.randrange(5, 8)}")

    def wait(self) -> None:
        self.say(f"{self.rng.choice(('M17', 'M18'))}C{self.rng.randrange(1, 4)}")

    def comment(self) -> None:
        self.say(self.rng.choice(("[pocket]", "(a side)", "[two words]")))

    # ---- structure

    def array(self) -> None:
        """Cells of one row or one column (L10), each with its own zero."""
        rng = self.rng
        if not self.known() or self.relative:
            self.place()
        count, by = rng.randrange(2, 4), self.length(30)
        shape = f"R1 C{count} X{by} Y0" if self.chance(0.5) else f"R{count} C1 X0 Y{by}"
        self.say(f"L10 {shape}{' E' if self.chance(0.3) else ''}")
        self.say("G92 X0 Y0")
        self.fed = None
        self.block(rng.randrange(2, 5))
        self.say("L10")
        self.say(f"G92 {' '.join(f'{axis}{self.length(20)}' for axis in 'XYZ')}")
        self.code = ""
        self.place()

    def asked(self) -> None:
        """The next line only where an input is on, or off (M17.1, M18.1)."""
        self.say(f"{self.rng.choice(('M17.1', 'M18.1'))}C{self.rng.randrange(1, 4)}")
        if self.chance(0.4):
            self.one_call()
        elif self.relative:
            self.say(f"G1 {self.words()} F{self.text(400 / self.size, 2)}")
        else:
            self.say(f"G1 {self.all_words()} F{self.text(400 / self.size, 2)}")
        self.at, self.code, self.fed = {}, "", None

    def called(self) -> None:
        self.one_call()
        fit = [name for name, modes in self.written_in.items() if modes == self.modes()]
        if self.chance(0.4) and not self.deep:
            self.say(f"M98 {self.rng.choice(fit)}")
            self.at, self.code = {}, ""

    def one_call(self) -> None:
        """A file of its own; it gives the zero of its caller back at its end (L92)."""
        before = self.modes()
        name = f"part{len(self.files)}.tap"
        self.files[name], self.written_in[name] = "", before
        self.fed = None
        body = self.captured(lambda: self.block(self.rng.randrange(1, 5)))
        assert self.modes() == before
        if self.chance(0.3):
            body.append("M99")
        self.files[name] = "\n".join(body) + "\n"
        self.say(f"M98 {name}")
        self.at, self.code, self.fed = {}, "", None

    # ---- the whole

    def program(self) -> str:
        rng = self.rng
        self.unit()
        self.say("G90")
        self.say("S3000")
        if self.chance(0.4) and "tool" not in self.without:
            self.tool()
        self.place()
        for _ in range(rng.randrange(4, 15)):
            self.any()
        return "\n".join(self.lines) + "\n"


def program(rng: random.Random, without: frozenset[str] = frozenset()) -> Made:
    """A random program."""
    writer = WinCnc(rng, without)
    text = writer.program()
    return Made("wincnc", ".tap", text, dict(writer.files))
