"""Random WinCNC programs over much of the language; WINCNC.INI and setup state everything that they rest on."""

from __future__ import annotations

import math
import random
from collections.abc import Iterator

from . import wincnc
from .comparing import Job
from .walked import Limits, Point, Walk

AXES = ("X", "Y", "Z", "W")
SETTLED = {
    "L10: cells from the first start, from where the last ended": 0,  # the page: from where the array began
    "L3 stores places of the machine, local places": 0,  # the page: machine positions
    # the page: within .05" of the last peck there is nothing to move
    "G83 with pecks below .05 inch: from R it stays, goes up to .05 inch above the last peck": 0,
    # as for Eding CNC: a coordinate that a line does not name is that of where the axes are
    "the program's place when rotation or scaling changes: that of the machine, the last programmed": 0,
    "G52: A turns counter-clockwise, clockwise": 0,  # docs/dialects/wincnc.md: a setting, rotation_sign
}
"""Where the page of the dialect follows one reading of an open place."""


class Writer:
    """Writes one program line by line; knows the unit and the last absolute place so that arcs can be right."""

    def __init__(self, rng: random.Random, unit: str, *, relative: bool, modal_arcs: bool) -> None:
        self.rng = rng
        self.lines: list[str] = []
        self.unit, self.before = unit, unit
        self.relative, self.modal_arcs = relative, modal_arcs
        self.files: dict[str, str] = {}
        self.bare = False
        self.deep = 0

    def length(self, reach: float = 60.0) -> float:
        return round(self.rng.uniform(-reach, reach) / wincnc.SIZES[self.unit], 4 if self.unit != "mm" else 3)

    def number(self, value: float) -> str:
        rng = self.rng
        text = f"{value:.4f}".rstrip("0").rstrip(".") or "0"
        text = "0" if text == "-0" else text
        roll = rng.random()
        if roll < 0.03:
            return ""
        if roll < 0.07:
            return f"{{{abs(value):.2f}{rng.choice('+-*/')}{rng.choice((1, 2, 0.5))}}}"
        return text

    def axis_words(self, letters: str = "XYZW", reach: float = 60.0) -> str:
        rng = self.rng
        chosen = [a for a in letters if rng.random() < (0.55 if a in "XY" else 0.3)] or [rng.choice(letters)]
        return " ".join(f"{a}{self.number(self.length(reach if a in 'XY' else reach / 2))}" for a in chosen)

    def say(self, line: str) -> None:
        self.lines.append(line)

    def move(self) -> None:
        rng = self.rng
        code = rng.choice(("G0 ", "G1 ", "G00 ", "G01 ", "", "") if self.bare else ("G0 ", "G1 "))
        once = rng.choice(("L91 ", "L90 ")) if rng.random() < 0.06 else ""
        mode = ""
        if rng.random() < 0.06:
            mode = rng.choice(("G90 ", "G91 "))
            self.relative, once = mode == "G91 ", ""
        feed = f" F{rng.choice((60, 100.5))}" if rng.random() < 0.1 else ""
        self.bare = True
        self.say(f"{once}{mode}{code}{self.axis_words()}{feed}")

    def straight_there(self) -> tuple[float, float]:
        a, b = self.length(40), self.length(40)
        self.say(f"{'G90 ' if self.relative else ''}{self.rng.choice(('G0', 'G1'))} X{a} Y{b}")
        self.relative, self.bare = False, True
        return a, b

    def arc(self) -> None:
        rng = self.rng
        begin, sweep = rng.uniform(0, math.tau), rng.uniform(0.1, 6.2)
        radius = abs(self.length(30)) + 2.0 / wincnc.SIZES[self.unit]
        code = rng.choice(("G2", "G3", "G02", "G03"))
        sign = -1 if code[-1] == "2" else 1
        cx, cy = -radius * math.cos(begin), -radius * math.sin(begin)
        end = begin + sign * sweep
        dx, dy = radius * math.cos(end) + cx, radius * math.sin(end) + cy
        helix = f" {rng.choice('ZW')}{self.number(self.length(15))}" if rng.random() < 0.2 else ""
        if rng.random() < 0.3 and not self.relative:
            self.say("G91")
            self.relative = True
        full = rng.random() < 0.2
        a, b = (0.0, 0.0) if self.relative or full else self.straight_there()
        if full:
            words = f"I{cx:.5f} J{cy:.5f}"
        elif rng.random() < 0.3 and 0.3 < sweep < 3.0:
            words = f"X{a + dx:.5f} Y{b + dy:.5f} R{radius:.5f}"
        else:
            words = f"X{a + dx:.5f} Y{b + dy:.5f} I{cx:.5f} J{cy:.5f}"
        self.say(f"{code} {words}{helix}")
        if rng.random() < 0.1:
            self.say(rng.choice((code, f"{code} I{cx:.4f}")))
        self.bare = self.bare and not self.modal_arcs

    def offsets(self) -> None:
        rng = self.rng
        words = " ".join(f"{a}{self.number(self.length(20))}" for a in AXES if rng.random() < 0.5) or "X"
        self.say(
            rng.choice((f"G92 {words}", "G92", f"G92.1 {words}", f"G92.2 {words}", "G92.3", "G92 X Y", "G92.1 X0"))
        )

    def modes(self) -> None:
        rng = self.rng
        code = rng.choice(("G90", "G91", "G90", "G20", "G21", "G22", "G23", "G40", "G54", "G94"))
        if code in {"G90", "G91"}:
            self.relative = code == "G91"
        elif code in {"G20", "G21", "G22"}:
            self.unit, self.before = wincnc.UNITS[int(code[1:])], self.unit
        elif code == "G23":
            self.unit, self.before = self.before, self.unit
        self.say(code)

    def lengths(self) -> None:
        self.say(self.rng.choice((f"M37 Z{self.length(20)}", "M37 Z0", "G43", "G49", "G43 Z", "G49 Z", "M37 W0 Z0")))

    def away(self) -> None:
        rng = self.rng
        chosen = rng.choice(
            (
                (f"G53 {self.axis_words()}",),
                (f"G53 Z{abs(self.length(5))}",),
                ("L3 XYZ", self.axis(), "L4 XY"),
                ("L3 X", self.axis(), "L4 X"),
                (f"P{rng.choice((1, 2))}",),
                (f"P{rng.choice((1, 2))}", self.axis()),
            )
        )
        for line in chosen:
            self.say(line)

    def axis(self) -> str:
        return f"G0 {self.axis_words()}"

    def cycle(self) -> None:
        rng = self.rng
        if self.relative:
            self.say("G90")
            self.relative = False
        code = rng.choice(("G81", "G82", "G83", "G73"))
        bottom = self.length(15)
        top = bottom + abs(self.length(12)) + 0.1
        extra = {
            "G82": " P200",
            "G83": f" Q{abs(self.length(3)) + 0.01:.4f}",
            "G73": f" Q{abs(self.length(3)) + 0.01:.4f}",
        }.get(code, "")
        self.say(f"{code} X{self.length(30)} Y{self.length(30)} Z{bottom} R{top:.4f}{extra}")
        for _ in range(rng.randrange(0, 3)):
            self.say(
                f"X{self.length(30)} Y{self.length(30)}"
                if rng.random() < 0.6
                else f"{rng.choice('XY')}{self.length(30)}"
            )
        self.say("G80")
        self.bare = False

    def formed(self) -> None:
        rng = self.rng
        x, y, z = self.length(20), self.length(20), self.length(5)
        if rng.random() < 0.5:
            self.say(f"G52 I{x} J{y} A{rng.choice((90, 45, -30, 12.5, 180))}")
            allowed = (self.move, self.arc)
        else:
            self.say(
                rng.choice(
                    (
                        f"G51 X2 Y{rng.choice((2, 0.5))} I{x} J{y}",
                        f"G51 Z{rng.choice((2, 0.5))} K{z}",
                        f"G51 X{rng.choice((0.5, -1))} Y2 Z2 I{x} J{y} K{z}",
                    )
                )
            )
            allowed = (self.move, self.move) if " X" in self.lines[-1] else (self.move, self.arc)
        if rng.random() < 0.8:
            self.straight_there()
        for _ in range(rng.randrange(1, 4)):
            rng.choice(allowed)()
        if rng.random() < 0.15:
            rng.choice((self.cycle, self.away, self.offsets))()
        self.say("G50")
        if rng.random() < 0.7:
            self.straight_there()

    def mapped(self) -> None:
        rng = self.rng
        code = rng.choice(("L11", "L12", "L12", "L13", "L300"))
        if code == "L300":
            self.say(f"L300 {rng.choice(('X', 'Z', 'W', 'XY'))}")
            for _ in range(rng.randrange(1, 4)):
                self.move()
            self.say(f"L301 {''.join(AXES)}")
            return
        words = {"L11": ("YXZW", "XYWZ", "XYZZ"), "L12": ("WZ", "ZZ", "WZ"), "L13": ("ZW", "WZ", "XY")}[code]
        chosen = rng.choice(words)
        self.say(f"{code} {chosen}")
        for _ in range(rng.randrange(1, 4)):
            if code == "L13":
                free = "".join(a for a in "XYZW" if a != chosen[1])
                self.say(f"{rng.choice(('G0', 'G1'))} {self.axis_words(free)}")
            elif "ZZ" in chosen:
                self.say(f"G1 {self.axis_words('XYZ')}")
            else:
                self.move()
        self.say(code)

    def array(self) -> None:
        rng = self.rng
        count = rng.randrange(2, 4)
        shape = f"R1 C{count} X{self.length(20)} Y0" if rng.random() < 0.5 else f"R{count} C1 X0 Y{self.length(20)}"
        self.say(f"L10 {shape}{' E' if rng.random() < 0.3 else ''}")
        self.say("G92 X0 Y0")
        for _ in range(rng.randrange(1, 5)):
            (self.move if rng.random() < 0.7 else self.arc)()
        self.say("L10")
        self.say("G92")

    def called(self) -> None:
        if self.deep:
            return
        name = f"part{len(self.files)}.tap"
        kept, self.lines = self.lines, []
        before = self.unit, self.before, self.relative
        self.deep += 1
        for _ in range(self.rng.randrange(1, 5)):
            self.any()
        self.deep -= 1
        if self.rng.random() < 0.3:
            self.say("L92")
        if self.rng.random() < 0.3:
            self.say("M99")
            self.say("G0 X900")
        self.files[name] = "\n".join(self.lines) + "\n"
        self.lines = kept
        self.say(f"M98 {name}")
        if (self.unit, self.before, self.relative) != before:
            self.say("G22")
            self.say("G90")
            self.unit, self.before, self.relative = "mm", self.unit, False

    def bounds(self) -> None:
        rng = self.rng
        self.say(
            rng.choice(
                (
                    f"L22 X{-abs(self.length(90))}",
                    f"L23 Y{abs(self.length(90))} X{abs(self.length(90))}",
                    "L22",
                    "L23",
                    "L22.1 X",
                    "L23.1 XY",
                    f"L22 Z{-abs(self.length(60))}",
                )
            )
        )

    def condition(self) -> None:
        rng = self.rng
        self.say(
            f"{rng.choice(('M17.4', 'M18.4'))} C{rng.choice((0, 1))}"
            if rng.random() < 0.7
            else rng.choice(("M17.1 C3", "M18.1 C4"))
        )
        self.say(f"G1 {self.axis_words()}")
        self.bare = False

    def small(self) -> None:
        self.say(
            self.rng.choice(
                (
                    "M11 C1",
                    "M12C1",
                    "G4 X0.5",
                    "[a comment]",
                    "[open comment",
                    "",
                    "G9 S40",
                    "L5 X100",
                    "L40 P90",
                    "L8",
                    "L9",
                    "S1000",
                    "F100",
                    "L91 G1 X1 Y1",
                )
            )
        )

    def wrong(self) -> None:
        self.say(
            self.rng.choice(
                (
                    "G0 G1 X1",
                    "M6",
                    "G123 X1",
                    "G2 X5 Y5 I50 J0",
                    "M3",
                    "L999",
                    "G2 X1 Y1 R0.001",
                    "G0 Q5",
                    "M98 nowhere.tap",
                    "G81 X1 Y1 Z5 R1",
                    "N10 G0 X1",
                    "G53 Q1",
                    "G92 Q1",
                )
            )
        )

    def any(self) -> None:
        rng = self.rng
        chosen = rng.choices(
            (
                self.move,
                self.arc,
                self.offsets,
                self.modes,
                self.lengths,
                self.away,
                self.cycle,
                self.formed,
                self.mapped,
                self.array,
                self.called,
                self.bounds,
                self.condition,
                self.small,
            ),
            (30, 14, 10, 8, 4, 6, 7, 5, 5, 0 if self.deep else 2, 3, 2, 4, 7),
        )[0]
        chosen()

    def program(self) -> str:
        rng = self.rng
        if rng.random() < 0.9:
            code = rng.choice((20, 21, 22, 22))
            self.say(f"G{code}")
            self.unit, self.before = wincnc.UNITS[code], self.unit
        if rng.random() < 0.9:
            self.say("G90")
            self.relative = False
        if rng.random() < 0.5:
            self.say("G92")
        self.say(f"G0 X{self.length(30)} Y{self.length(30)} Z{self.length(15)}")
        self.bare = True
        for _ in range(rng.randrange(3, 16)):
            self.any()
        if rng.random() < 0.1:
            self.wrong()
            self.move()
        return "\n".join(self.dressed(line) for line in self.lines) + "\n"

    def dressed(self, line: str) -> str:
        rng = self.rng
        if rng.random() < 0.2 and "M98" not in line:
            line = "".join(rng.choice((c.lower(), c.upper())) for c in line)
        if rng.random() < 0.15 and "M98" not in line and "[" not in line:
            line = line.replace(" ", "")
        if rng.random() < 0.1 and line and "[" not in line:
            line += rng.choice((" [rest]", "[rest", " [G0 X900]"))
        return line


def job(rng: random.Random) -> Job:
    """A random job."""
    unit = rng.choice(("in", "mm", "mm", "cm"))
    size = wincnc.SIZES[unit]
    modal = rng.random() < 0.3
    nmode = rng.choice((90, 91))
    writer = Writer(rng, unit, relative=nmode == 91, modal_arcs=modal)
    program = writer.program()
    start = {a: round(rng.uniform(-30, 30), 3) for a in AXES}
    local = {a: round(rng.uniform(-20, 20), 3) if rng.random() < 0.3 else 0.0 for a in AXES}
    bounded = rng.random() < 0.3
    measures = {a: round(rng.uniform(-30, 30), 3) for a in "ZW"} if rng.random() < 0.5 else {}

    def bounds(limits: Limits) -> Limits:
        """Boundaries of X and Y where there are some: as the limits, the limits themselves further out."""
        return {a: limits[a] for a in "XY"} if bounded else {}

    spread = (
        {a: round(rng.uniform(0, 3), 3) if rng.random() < 0.4 else 0.0 for a in "XYZ"}
        if measures and rng.random() < 0.3
        else {}
    )

    def read(limits: Limits) -> Iterator[Walk]:
        for part in (0.0, 0.5, 1.0) if spread else (0.0,):
            yield from read_one(limits, {a: v + part * spread.get(a, 0.0) for a, v in local.items()})

    positions = {n: {a: round(rng.uniform(-30, 30), 2) for a in AXES} for n in (1, 2)}

    def read_one(limits: Limits, local: Point) -> Iterator[Walk]:
        facts = wincnc.Facts(
            limits,
            start,
            bounds(limits),
            unit,
            relative=nmode == 91,
            modal_arcs=modal,
            local=local,
            measures=measures,
            files=writer.files,
            positions=positions,
        )
        return wincnc.read(program, facts, SETTLED)

    def files(limits: Limits) -> dict[str, str]:
        ini = [f"unit={unit}", "axischar=XYZW"]
        for n, kind in enumerate((1, 2, 3, 3)):
            ini.append(f"axisspec=p0 s{n} d{n} r100 a500 t{kind}")
            ini.append("axisvel=r400 f200 s10 m100 h200")

        def words(table: Limits, side: int, out: float = 0.0) -> str:
            return " ".join(f"{a.lower()}{(v[side] + out) / size!r}" for a, v in table.items() if v[side] is not None)  # type: ignore[operator]

        ini += [f"auxin=c{n} p3 b{n} o0 d10" for n in range(1, 5)] + ["auxout=c1 p0 b0 o0"]
        ini += ["vgroup=FXY", "vgroup=XY", "vgroup=Z", "vgroup=W"]
        ini += [f"lolim={words(limits, 0)}", f"hilim={words(limits, 1)}"]
        if bounded:
            ini += [f"lobound={words(bounds(limits), 0)}", f"hibound={words(bounds(limits), 1)}"]
        ini += ["softlim=T1", f"nmode={nmode}", f"g2modal={int(modal)}", "g54=x0 y0 t0 m0"]
        setup = [
            'schema = "gproof-setup/1"',
            'homed = ["x", "y", "z", "w"]',
            f"start = {row(start)}",
            f"g92 = {row(local, spread)}",
            "active_work = 1",
            "tool = 0",
        ]
        stored = [f"positions.P{n} = {row(place)[:-1]}, lift = false}}" for n, place in positions.items()]
        setup += stored
        setup += [f"measures = {row(measures)}"] if measures else []
        return {
            "WINCNC.INI": "\n".join(ini) + "\n",
            "CNC.MAC": "\n",
            "setup.toml": "\n".join(setup) + "\n",
            **writer.files,
        }

    words = ("--machine", "WINCNC.INI", "--setup", "setup.toml")
    return Job("wincnc", program, "tap", AXES, start, read, files, words, {"tool.": 0.0})


def row(place: Point, spread: Point | None = None) -> str:
    """A table of a setup; spread: by how much a value may be more."""
    more = spread or {}
    values = {a: f"[{v}, {v + more[a]}]" if more.get(a) else str(v) for a, v in place.items()}
    return "{" + ", ".join(f"{a.lower()} = {v}" for a, v in values.items()) + "}"
