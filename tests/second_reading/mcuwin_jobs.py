"""Random McuWIN programs over much of the language, with a machine and a setup that state everything they rest on."""

from __future__ import annotations

import math
import random
from collections.abc import Iterator

from . import mcuwin
from .comparing import Job
from .walked import Limits, Point, Walk

AXES = ("X", "Y", "Z", "A")


class Writer:
    """Writes one program line by line; knows enough of the modes that arcs can be right."""

    def __init__(self, rng: random.Random, *, absolute_centres: bool, table: bool) -> None:
        self.rng = rng
        self.lines: list[str] = []
        self.inch = self.relative = False
        self.absolute_centres = absolute_centres
        self.table = table
        self.subs: list[tuple[int, list[str]]] = []
        self.deep = 0
        self.bare = False
        self.counter = 620
        self.label = 10
        self.names = rng.random() < 0.4
        self.plane = "XY"

    def length(self, reach: float = 60.0) -> float:
        value = self.rng.uniform(-reach, reach)
        return round(value / 25.4, 4) if self.inch else round(value, 3)

    def number(self, value: float) -> str:
        rng = self.rng
        text = f"{value:.4f}".rstrip("0").rstrip(".") or "0"
        text = "0" if text == "-0" else text
        roll = rng.random()
        if roll < 0.78:
            return text
        if roll < 0.83:
            return f"+{text}" if value >= 0 else text
        known = ["CD601", "CD602", "CI601", *(["step", "Depth"] if self.names else [])]
        a = rng.choice(known)
        return rng.choice(
            (
                a if a[0] == "C" else f"({a})",
                f"({a} {rng.choice('+-*')} {abs(value) / 4:.2f})",
                f"{abs(value):.2f}*{rng.choice(('0.5', 'CD602', '(-1)'))}",
                f"({text} + sin(CD601))",
                f"(sqrt({abs(value):.2f}) - abs({a}))",
                f"-({a})",
                "(CI601 div 2)",
                f"({text})",
            )
        )

    def axis_words(self, letters: str = "XYZ", reach: float = 60.0) -> str:
        rng = self.rng
        chosen = [a for a in letters if rng.random() < 0.55] or [rng.choice(letters)]
        words = [f"{a}{self.number(self.length(reach if a != 'Z' else reach / 2))}" for a in chosen]
        if rng.random() < 0.05:
            words.append(f"A{round(rng.uniform(-90, 90), 2)}")
        return " ".join(words)

    def say(self, line: str, *, bare: bool = False) -> None:
        self.lines.append(line)
        self.bare = bare

    def move(self) -> None:
        rng = self.rng
        code = rng.choice(("G00 ", "G01 ", "G0 ", "G1 ", "", "")) if self.bare else rng.choice(("G00 ", "G01 "))
        rapid = code.strip() in {"G00", "G0"}
        inch, self.inch = self.inch, self.inch and not rapid
        mode = ""
        if rng.random() < 0.06 and code:
            mode = rng.choice(("G90 ", "G91 "))
            self.relative = mode == "G91 "
        feed = f" F{rng.choice((200, 500))}" if rng.random() < 0.1 else ""
        self.say(f"{mode}{code}{self.axis_words()}{feed}", bare=True)
        self.inch = inch

    def straight_there(self) -> tuple[float, float]:
        one, two = self.plane
        a, b = self.length(40), self.length(40)
        self.say("G90")
        self.say(f"G01 {one}{a} {two}{b}", bare=True)
        self.relative = False
        return a, b

    def arc(self) -> None:
        rng = self.rng
        one, two = self.plane
        first, second = {"X": "I", "Y": "J", "Z": "K"}[one], {"X": "I", "Y": "J", "Z": "K"}[two]
        begin, sweep = rng.uniform(0, math.tau), rng.uniform(0.1, 6.2)
        radius = abs(self.length(30)) + (0.1 if self.inch else 1.0)
        code = rng.choice(("G02", "G03"))
        sign = -1 if code == "G02" else 1
        cx, cy = -radius * math.cos(begin), -radius * math.sin(begin)
        end = begin + sign * sweep
        dx, dy = radius * math.cos(end) + cx, radius * math.sin(end) + cy
        if rng.random() < 0.3:
            self.say("G91")
            self.relative = True
        if self.relative:
            a = b = 0.0
        else:
            a, b = self.straight_there()
        if self.absolute_centres and not self.relative:
            cx, cy = cx + a, cy + b
        third = next(n for n in "XYZ" if n not in self.plane)
        helix = f" {third}{self.number(self.length(15))}" if rng.random() < 0.2 else ""
        place = "" if rng.random() < 0.15 else f"{one}{a + dx:.5f} {two}{b + dy:.5f} "
        if not place and helix:
            place = f"{one}{a} {two}{b} "
        if not place:
            place = f"{one}{a} "
        self.say(f"{code} {place}{first}{cx:.5f} {second}{cy:.5f}{helix}")

    def offsets(self) -> None:
        rng = self.rng
        words = " ".join(f"{a}{self.number(self.length(20))}" for a in "XYZ" if rng.random() < 0.5) or "X0"
        self.say(
            rng.choice((f"G92 {words}", f"G92 {words}", "G53", "G54", "G55", "G56", "G153", "G90", "G92 X0 Y0 Z0"))
        )
        if self.lines[-1] == "G153" and rng.random() < 0.7:
            self.say(f"G92 {words}")
            self.say("G154")
        elif self.lines[-1] == "G53":
            self.say("G90")
            self.relative = False

    def modes(self) -> None:
        rng = self.rng
        code = rng.choice(
            ("G90", "G91", "G90", "G70", "G71", "G71", "G161", "G162", "G17", "G94 F300", "G18", "G19", "G150", "G40")
        )
        if code in {"G18", "G19"} and not self.table:
            code = "G17"
        if code in {"G90", "G91"}:
            self.relative = code == "G91"
        elif code in {"G70", "G71"}:
            self.inch = code == "G70"
            code += " F400" if rng.random() < 0.95 else ""
        elif code in {"G161", "G162"}:
            self.absolute_centres = code == "G161"
        elif code in {"G17", "G18", "G19"}:
            self.plane = {"G17": "XY", "G18": "ZX", "G19": "YZ"}[code]
        self.say(code)

    def mirrored(self) -> None:
        rng = self.rng
        uneven = rng.random() < 0.5
        if rng.random() < 0.4:
            self.say(rng.choice(("G39 X2 Y2", "G39 X-0.5", "G39", "G39 X-1 Y-1", "G39 X2 Y-2")))
        if rng.random() < 0.5:
            self.say("G53")
        self.say(rng.choice(("G21", "G22", "G23")))
        self.say("G91" if rng.random() < 0.3 else "G90")
        self.relative = self.lines[-1] == "G91"
        for _ in range(rng.randrange(1, 4)):
            (self.move if rng.random() < 0.65 or uneven else self.arc)()
        self.say("G24")

    def limits(self) -> None:
        rng = self.rng
        if self.relative and rng.random() < 0.9:
            self.say("G90")
            self.relative = False
        self.say(
            rng.choice(
                (
                    f"G98 X{-abs(self.length(120))}",
                    f"G99 X{abs(self.length(120))} Z{abs(self.length(80))}",
                    f"G98 Y{-100 - abs(self.length(40))}",
                )
            )
        )

    def assign(self) -> None:
        rng = self.rng
        left = rng.choice(("CD601", "CD602", *(["step", "Depth"] if self.names else [])))
        dollar = "$" if rng.random() < 0.3 else ""
        self.say(
            f"{dollar}{left} := {self.number(self.length(8))}{';' if dollar else ''}", bare=self.bare and not dollar
        )

    def loop(self) -> None:
        rng = self.rng
        self.counter += 1
        name, count = f"CI{self.counter}", rng.randrange(1, 4)
        kind = rng.randrange(3)
        if kind == 0:
            self.say(
                f"$for {name} := {rng.choice(('1', '(2 - 1)'))} to {count} do begin"
                if rng.random() < 0.7
                else f"$for {name}:={count} downto 1 do begin"
            )
            self.inside()
            self.say("$end;")
        elif kind == 1:
            self.say(f"{name} := 0")
            self.say(f"$while ({name} < {count}) do begin")
            self.inside()
            self.say(f"{name} := {name} + 1")
            self.say("$end;")
        else:
            self.say(f"{name} := 0")
            self.say("$repeat begin")
            self.inside()
            self.say(f"{name} := {name} + 1")
            self.say(f"$end until ({name} >= {count});")

    def choice(self) -> None:
        rng = self.rng
        name, sign = rng.choice(("CD601", "CD602", "CI601")), rng.choice(("<", ">", "<=", ">="))
        test = f"({name} {sign} {round(rng.uniform(-5, 5), 1)})"
        if rng.random() < 0.2:
            test = f"({test} {rng.choice(('and', 'or'))} (CI601 <> 3))"
        self.say(f"$if {test} then begin")
        self.inside()
        roll = rng.random()
        if roll < 0.3:
            self.say("$end else begin")
            self.inside()
        elif roll < 0.45:
            self.say("$end else if (CD601 > 0) begin")
            self.inside()
            self.say("$end else begin")
            self.inside()
        self.say("$end")

    def inside(self) -> None:
        self.deep += 1
        before = self.inch, self.relative, self.absolute_centres, self.plane
        for _ in range(self.rng.randrange(1, 4)):
            self.any()
        self.deep -= 1
        if (self.inch, self.relative, self.absolute_centres, self.plane) != before:
            self.again()

    def again(self) -> None:
        """Modes are said again where they depend on what ran."""
        for line in ("G71 F500", "G90", "G162", "G17"):
            self.say(line)
        self.inch = self.relative = self.absolute_centres = False
        self.plane = "XY"

    def called(self) -> None:
        if self.deep:
            return
        number = 100 + len(self.subs)
        kept, self.lines = self.lines, []
        body: list[str] = self.lines
        self.subs.append((number, body))
        self.inside()
        self.lines = kept
        times = f" O{self.rng.choice((2, 3, '(1 + 1)'))}" if self.rng.random() < 0.4 else ""
        self.say(f"M98 L{number}{times}")
        self.again()

    def jump(self) -> None:
        if self.deep:
            return
        self.label += 1
        self.say(f"M96 L{self.label}")
        self.move()
        self.say(f"L{self.label}")

    def small(self) -> None:
        rng = self.rng
        line = rng.choice(
            (
                "M03",
                "M05",
                "M08",
                "M09",
                "G04 0.5",
                "(comment)",
                "' rest",
                "S1000",
                "F300",
                "M26 102",
                "M00",
                "G60 X Y Z",
                "",
            )
        )
        keeps = line[:1] in {"", "M", "(", "'", "S", "F"} and self.bare
        self.say(line, bare=keeps)
        if line == "G60 X Y Z" and rng.random() < 0.9:
            self.say("G60 X Y Z A")

    def wrong(self) -> None:
        self.say(
            self.rng.choice(
                (
                    "G123",
                    "G02 X5 Y5 I50 J0",
                    "M98 L999",
                    "M96 L998",
                    "G93",
                    "G01 X",
                    "G01 Q5",
                    "CD601 := 1/0",
                    "$end",
                    "G92",
                    "M98",
                    "G01 X(5",
                    "G01 X5 X6",
                    "X5",
                    "G39 Q1",
                    "G59",
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
                self.mirrored,
                self.limits,
                self.assign,
                self.loop,
                self.choice,
                self.called,
                self.jump,
                self.small,
            ),
            (32, 14, 10, 9, 4, 3, 6, 3, 4, 3, 2, 7),
        )[0]
        if self.deep > 2 and chosen in {self.loop, self.choice, self.mirrored}:
            chosen = self.move
        chosen()

    def program(self) -> str:
        rng = self.rng
        head: list[str] = []
        if self.names:
            head = [
                "$DINEND",
                "// what the program keeps",
                "var",
                "  step, Depth : double; { in mm }",
                "const",
                "  Deep = 5;",
                "{$DINSTART}",
            ]
        self.lines = []
        for line in rng.sample(["G90", "G71", "G17", "G162"], rng.randrange(2, 5)):
            self.say(line)
            self.absolute_centres = self.absolute_centres and line != "G162"
        self.say("F500")
        self.say(f"CD601 := {round(rng.uniform(-9, 9), 2)}")
        self.say(f"CD602 := {round(rng.uniform(-9, 9), 2)}")
        self.say(f"CI601 := {rng.randrange(-5, 9)}")
        if self.names:
            self.say(f"step := {round(rng.uniform(-9, 9), 2)}")
            self.say("Depth := step / 2")
        self.say(f"G00 X{self.length(30)} Y{self.length(30)} Z{self.length(15)}", bare=True)
        for _ in range(rng.randrange(3, 15)):
            self.any()
        if rng.random() < 0.1:
            self.wrong()
            self.move()
        self.say(rng.choice(("M30", "M02")))
        main = [*(["%JOB"] if rng.random() < 0.8 else []), *self.lines, "%"]
        if not main[0].startswith("%") and head:
            main.insert(0, "%JOB")
        for number, body in self.subs:
            by_name = rng.random() < 0.5
            main += (
                [f"%{number}" if by_name else f"%SUB_{'abcdefgh'[number % 8]}"]
                + ([] if by_name else [f"L{number}"])
                + [*body, "M17", "%"]
            )
        self.count = 0
        self.numbered = rng.random() < 0.5
        return "\n".join([*head, *(self.dressed(line) for line in main)]) + "\n"

    def dressed(self, line: str) -> str:
        rng = self.rng
        self.count += 10
        special = not line or line[0] in "%('"
        if rng.random() < 0.12 and "$" not in line and ":=" not in line and not special:
            line = line.lower()
        if rng.random() < 0.1 and "$" not in line and ":=" not in line and not special:
            line += (
                " ' G00 X900" if rng.random() < 0.6 or line[0] in "MmLl$" or line[:3] in {"G60", "g60"} else " (rest)"
            )
        if self.numbered and not special:
            line = f"N{self.count:04d} {line}"
        return line


def job(rng: random.Random) -> Job:
    """A random job."""
    absolute = rng.random() < 0.3
    table = rng.random() < 0.3
    writer = Writer(rng, absolute_centres=absolute, table=table)
    program = writer.program()
    start = {a: round(rng.uniform(-30, 30), 3) for a in AXES}
    offset = {a: round(rng.uniform(-20, 20), 3) if rng.random() < 0.3 else 0.0 for a in AXES}
    records = [{a: round(rng.uniform(-30, 30), 3) for a in AXES} for _ in range(5)]
    interpolated = rng.choice(("XYZ", "XYZA"))

    spread = (
        {a: round(rng.uniform(0, 3), 3) if rng.random() < 0.4 else 0.0 for a in "XYZ"} if rng.random() < 0.15 else {}
    )

    def read(limits: Limits) -> Iterator[Walk]:
        for part in (0.0, 0.5, 1.0) if spread else (0.0,):
            yield from read_one(limits, {a: v + part * spread.get(a, 0.0) for a, v in offset.items()})

    def read_one(limits: Limits, offset: Point) -> Iterator[Walk]:
        facts = mcuwin.Facts(limits, start, interpolated, offset, records, absolute_centres=absolute, tool_table=table)
        return mcuwin.read(program, facts)

    def files(limits: Limits) -> dict[str, str]:
        text = ['schema = "gproof-machine/1"', 'units = "mm"']
        for axis, (low, high) in limits.items():
            unit = "deg" if axis == "A" else "mm"
            text += [
                f"[axes.{axis.lower()}]",
                f"min = {low}",
                f"max = {high}",
                "travel_min = -5000.0",
                "travel_max = 5000.0",
            ]
            text += ["max_velocity = 80.0", "max_acceleration = 400.0", f'position_unit = "{unit}"']
        text += [
            "[controller]",
            'dialect = "mcuwin"',
            "[din]",
            "case_sensitive = false",
            'position_unit = "mm"',
            'time_unit = "min"',
        ]
        text += [
            f"absolute_centers = {str(absolute).lower()}",
            f'interpolation_axes = "{interpolated}"',
            "shortest_path = false",
        ]
        text += [f"zero_offsets = {[list(r.values()) for r in records]}", 'pre_include = ""', 'post_include = ""']
        text += ['tool_file = "ToolComp.INI"' if table else 'tool_file = ""']
        text += [
            "[din.task0]",
            *(f'M{n} = "nothing"' for n in (3, 5, 6, 8, 9)),
            'M0 = "stop"',
            'M2 = "end"',
            'M30 = "end"',
            'S = "nothing"',
        ]
        setup = [
            'schema = "gproof-setup/1"',
            'homed = ["x", "y", "z", "a"]',
            f"start = {row(start)}",
            f"g92 = {row(offset, spread)}",
        ]
        tools = "".join(f"[Tools{p}]\nR0=0,0\nL0=0,0\nR1=1,0\nL1=0,0\n" for p in ("XY", "YZ", "ZX"))
        return {
            "machine.toml": "\n".join(text) + "\n",
            "setup.toml": "\n".join(setup) + "\n",
            **({"ToolComp.INI": tools} if table else {}),
        }

    words = ("--machine", "machine.toml", "--setup", "setup.toml")
    return Job("mcuwin", program, "src", AXES, start, read, files, words)


def row(place: Point, spread: Point | None = None) -> str:
    """A table of a setup; spread: by how much a value may be more."""
    more = spread or {}
    values = {a: f"[{v}, {v + more[a]}]" if more.get(a) else str(v) for a, v in place.items()}
    return "{" + ", ".join(f"{a.lower()} = {v}" for a, v in values.items()) + "}"
