"""Random Eding CNC programs over much of the language; machine and setup state everything that they rest on."""

from __future__ import annotations

import math
import random
from collections.abc import Iterator

from . import eding
from .comparing import Job
from .walked import Limits, Point, Walk

AXES = ("X", "Y", "Z", "A")
VARIABLES = (1, 2, 3, 100, 101)
SETTLED = {
    # 3.4, "their current value": the coordinate of where the axes are, as the page has it
    "the program's place when rotation or scaling changes: that of the machine, the last programmed": 0,
}
"""Where the page of the dialect follows one reading of an open place."""


class Writer:
    """Writes one program line by line; knows the unit and the last absolute place so that arcs can be right."""

    def __init__(self, rng: random.Random) -> None:
        self.rng = rng
        self.lines: list[str] = []
        self.inch = False
        self.relative = False
        self.plane = "XY"
        self.deep = 0
        self.counter = 200
        self.subs: list[tuple[str, list[str]]] = []
        self.numbers = self.rng.random() < 0.15
        self.bare = True
        """Whether axis words alone are a move."""

    # -- numbers

    def length(self, reach: float = 60.0) -> float:
        value = self.rng.uniform(-reach, reach)
        return round(value / 25.4, 4) if self.inch else round(value, 3)

    def number(self, value: float) -> str:
        """A literal, or something that is worth about as much."""
        rng = self.rng
        text = f"{value:.4f}".rstrip("0").rstrip(".") or "0"
        if text == "-0":
            text = "0"
        roll = rng.random()
        if roll < 0.75:
            return text
        if roll < 0.8:
            return f"+{text}" if value >= 0 else text
        if roll < 0.88:
            part = round(rng.uniform(-5, 5), 2)
            return f"[{value - part:.4f}{'+' if part >= 0 else '-'}{abs(part)}]"
        if roll < 0.92:
            return f"[#{rng.choice(VARIABLES)}{rng.choice('+-*')}{abs(round(rng.uniform(0, 2), 1))}]"
        if roll < 0.95:
            return f"#{rng.choice(VARIABLES)}"
        return rng.choice(
            (
                f"[{abs(value):.3f}*sin[{rng.choice((0, 30, 90, 200))}]]",
                f"sqrt[{abs(value):.3f}]",
                f"[abs[#{rng.choice(VARIABLES)}] mod 7 + 1]",
                f"fix[{value:.3f}]",
                f"round[{value:.3f}]",
                f"[2**{rng.choice((1, 2, 3))} - {rng.choice((1, 2))}/2]",
                f"-#{rng.choice(VARIABLES)}",
                "[#1 > 2]",
                f"##{rng.choice((110, 111))}",
                f"#[{rng.choice((100, 101))} + 0]",
                f"[atan[{value:.2f}]/[{abs(value) + 1:.2f}] / 9]",
                f"[{value:.3f} - -#{rng.choice(VARIABLES)}]",
                f"fup[#{rng.choice(VARIABLES)} / 2]",
                f"[not[#{rng.choice(VARIABLES)}] + cos[60]]",
            )
        )

    def axis_words(self, most: int = 3, reach: float = 60.0) -> str:
        chosen = [a for a in "XYZ" if self.rng.random() < 0.55][:most] or [self.rng.choice("XYZ")]
        words = [f"{a}{self.number(self.length(reach if a != 'Z' else reach / 2))}" for a in chosen]
        if self.rng.random() < 0.06:
            words.append(f"A{self.number(round(self.rng.uniform(-90, 90), 2))}")
        self.rng.shuffle(words)
        return " ".join(words)

    def say(self, line: str) -> None:
        self.lines.append(line)

    # -- statements

    def move(self) -> None:
        code = self.rng.choice(("G0 ", "G1 ", "G01 ", "G00 ", "", "") if self.bare else ("G0 ", "G1 "))
        self.bare = True
        line = code + self.axis_words()
        if self.rng.random() < 0.1:
            line += f" F{self.rng.choice((200, 500.5, '[100*3]'))}"
        self.say(line)

    def straight_there(self) -> tuple[float, float]:
        """G90 with both axes of the plane, literal, so that an arc has a known start."""
        one, two = self.plane
        a, b = self.length(40), self.length(40)
        self.say(f"G90 {self.rng.choice(('G0', 'G1'))} {one}{a} {two}{b}")
        self.relative = False
        return a, b

    def arc(self) -> None:
        rng = self.rng
        one, two = self.plane
        first, second = {"X": "I", "Y": "J", "Z": "K"}[one], {"X": "I", "Y": "J", "Z": "K"}[two]
        begin, sweep = rng.uniform(0, math.tau), rng.uniform(0.1, 6.2)
        radius = abs(self.length(30)) + (0.1 if self.inch else 1.0)
        code = rng.choice(("G2", "G3"))
        sign = -1 if code == "G2" else 1
        # the centre lies at the origin of this computation; the right-handed pair of G18 is Z X
        hand = -1 if self.plane == "XZ" else 1
        cx, cy = -radius * math.cos(begin), -radius * math.sin(begin)
        end = begin + sign * hand * sweep
        dx, dy = radius * math.cos(end) + cx, radius * math.sin(end) + cy
        third = next(a for a in "XYZ" if a not in self.plane)
        helix = f" {third}{self.number(self.length(15))}" if rng.random() < 0.25 else ""
        if rng.random() < 0.3:
            self.say("G91")
            self.relative = True
        a, b = (0.0, 0.0) if self.relative else self.straight_there()
        if rng.random() < 0.2:
            words = f"{one}{a:.4f} {two}{b:.4f} {first}{cx:.4f} {second}{cy:.4f}"
        elif rng.random() < 0.35 and 0.3 < sweep < 5.9 and abs(sweep - math.pi) > 0.1:
            words = f"{one}{a + dx:.4f} {two}{b + dy:.4f} R{radius if sweep < math.pi else -radius:.4f}"
        else:
            digits = 5 if self.inch else 4
            words = f"{one}{a + dx:.{digits}f} {two}{b + dy:.{digits}f} {first}{cx:.{digits}f} {second}{cy:.{digits}f}"
        self.say(f"{code} {words}{helix}")
        self.bare = self.rng.random() < 0.02

    def offsets(self) -> None:
        rng = self.rng
        axes = " ".join(f"{a}{self.number(self.length(20))}" for a in "XYZ" if rng.random() < 0.6) or "X1"
        self.say(
            rng.choice(
                (
                    rng.choice(("G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3")),
                    f"G10 L2 P{rng.randrange(1, 10)} {axes}",
                    f"G10 L20 P{rng.randrange(1, 4)} {axes}",
                    f"G92 {axes}",
                    rng.choice(("G92.1", "G92.2", "G92.3")),
                    f"G55 G0 {axes}",
                )
            )
        )

    def lengths(self) -> None:
        rng = self.rng
        self.say(
            rng.choice(
                (
                    "G43",
                    f"G43 H{rng.randrange(1, 5)}",
                    "G49",
                    f"M6 T{rng.randrange(0, 5)}",
                    f"T{rng.randrange(1, 5)} M6",
                    f"#540{rng.randrange(1, 5)} = {rng.uniform(5, 40):.2f}",
                    f"G43 G0 Z{self.length(20)}",
                    f"T{rng.randrange(1, 4)}",
                )
            )
        )

    def modes(self) -> None:
        rng = self.rng
        code = rng.choice(("G90", "G91", "G90", "G20", "G21", "G17", "G18", "G19", "G98", "G99", "G61", "G64 P0.1"))
        tail = f" G0 {self.axis_words()}" if rng.random() < 0.2 and code in {"G90", "G91"} else ""
        self.say(code + tail)
        if code in {"G90", "G91"}:
            self.relative = code == "G91"
        elif code in {"G20", "G21"}:
            self.inch = code == "G20"
        elif code in {"G17", "G18", "G19"}:
            self.plane = {"G17": "XY", "G18": "XZ", "G19": "YZ"}[code]

    def away(self) -> None:
        rng = self.rng
        words = self.axis_words()
        self.say(
            rng.choice(
                (
                    f"G53 G0 {words}",
                    f"G0 G53 {words}",
                    f"G1 G53 {words}",
                    f"G28 {words}",
                    "G28",
                    "G30",
                    f"G30 Z{self.length(10)}",
                    "G91 G28 Z0",
                    f"M9{rng.choice('012')}",
                    "M90",
                    f"#{rng.choice((5161, 5162, 5183))} = {self.length(30)}",
                )
            )
        )
        if self.lines[-1].startswith("G91"):
            self.relative = True

    def cycle(self) -> None:
        rng = self.rng
        across = [a for a in "XYZ" if a in self.plane]
        deep = next(a for a in "XYZ" if a not in self.plane)
        code = rng.choice(("G81", "G82", "G83", "G73", "G85", "G89", "G81", "G86", "G88"))
        bottom = self.length(15)
        up = abs(self.length(12))
        top = up if self.relative else bottom + up
        extra = {"G82": " P0.2", "G89": " P0.1", "G83": " Q2.5", "G73": " Q1.5", "G86": " P0.1", "G88": " P0.1"}.get(
            code, ""
        )
        depth = -abs(bottom) if self.relative else bottom
        repeat = f" L{rng.choice((2, 3))}" if rng.random() < 0.15 else ""
        place = " ".join(f"{a}{self.length(30)}" for a in across if rng.random() < 0.8)
        modes = rng.choice(("", "", "G98 ", "G99 "))
        if code == "G86" and rng.random() < 0.8:
            self.say("M3 S1000")
        self.say(f"{modes}{code} {place} {deep}{depth:.3f} R{top:.3f}{extra}{repeat}")
        for _ in range(rng.randrange(0, 3)):
            self.say(" ".join(f"{a}{self.length(30)}" for a in across if rng.random() < 0.7) or f"{across[0]}5")
        self.say(rng.choice(("G80", "G80", f"G0 {self.axis_words()}")))
        self.bare = "G80" not in self.lines[-1]

    def formed(self) -> None:
        rng = self.rng
        x, y = self.length(20), self.length(20)
        lines, even = [], True
        if rng.random() < 0.7:
            lines.append(f"G68 R{rng.choice((90, 45, -30, 12.5, 180))} X{x} Y{y}")
        if not lines or rng.random() < 0.4:
            even = rng.random() < 0.7
            lines.append(
                f"G51 P{rng.choice((2, 0.5, 1.5))} I{x} J{y}"
                if even
                else rng.choice((f"G51 X{rng.choice((2, -1, 0.5))} Y{rng.choice((1, 2))} I{x} J{y}",))
            )
        for line in lines:
            self.say(line)
        if self.plane == "XY" and rng.random() < 0.8:
            self.straight_there()
        for _ in range(rng.randrange(1, 4)):
            (self.move if rng.random() < 0.6 or not even else self.arc)()
        if rng.random() < 0.3:
            rng.choice((self.away, self.offsets, self.cycle))()
        self.say("G69")
        self.say("G50")
        if rng.random() < 0.6:
            self.straight_there()

    def assign(self) -> None:
        rng = self.rng
        number = rng.choice(VARIABLES)
        value = rng.choice((self.number(self.length(20)), "#5001", "#5222", "[#5003 + 1]", "#5211", "#5072"))
        self.say(f"#{number} = {value}")

    def loop(self) -> None:
        self.counter += 1
        name, count = self.counter, self.rng.randrange(1, 4)
        self.say(f"#{name} = 0")
        self.say(f"while [#{name} < {self.rng.choice((str(count), f'[{count}*1]', f'{count}.5'))}]")
        self.inside(self.rng.randrange(1, 4))
        self.say(f"#{name} = [#{name} + 1]")
        self.say(self.rng.choice(("endwhile", "EndWhile")))

    def choice(self) -> None:
        rng = self.rng
        name, sign = rng.choice(VARIABLES), rng.choice(("<", ">", "==", "<>", ">=", "<="))
        test = f"#{name} {sign} {round(rng.uniform(-5, 5), 1)}"
        if rng.random() < 0.2:
            test = f"[{test}] {rng.choice(('and', 'or', 'xor'))} [#{rng.choice(VARIABLES)} > 0]"
        self.say(f"if [{test}]")
        self.inside(rng.randrange(1, 3))
        if rng.random() < 0.5:
            self.say("else")
            self.inside(rng.randrange(1, 3))
        self.say("endif")

    def inside(self, count: int) -> None:
        """Statements within a block; what the modes are after it is not known, so they are said again."""
        self.deep += 1
        before = self.inch, self.relative, self.plane
        for _ in range(count):
            self.any()
        self.deep -= 1
        self.bare = False
        if (self.inch, self.relative, self.plane) != before:
            self.inch, self.relative, self.plane = False, False, "XY"
            self.say("G21 G90 G17")

    def sub(self) -> None:
        name = f"part_{len(self.subs)}"
        kept, self.lines = self.lines, []
        body_modes = self.inch, self.relative, self.plane
        self.subs.append((name, self.lines))
        self.inside(self.rng.randrange(1, 4))
        self.lines = kept
        self.inch, self.relative, self.plane = body_modes
        self.say(f"gosub {name}")
        self.say("G21 G90 G17")
        self.inch, self.relative, self.plane = False, False, "XY"

    def small(self) -> None:
        self.say(
            self.rng.choice(
                (
                    "M3 S1000",
                    "M5",
                    "M8",
                    "M9",
                    "G4 P0.5",
                    'msg "at "#5001',
                    "(a comment)",
                    "; another",
                    "",
                    "M3",
                    "/ G0 X5",
                    f"/ G1 {self.axis_words()}",
                    "M0",
                    "F300 S900",
                    "M48",
                    "G0 X1",
                    "M101 X5",
                )
            )
        )

    def wrong(self) -> None:
        self.say(
            self.rng.choice(
                (
                    "G0",
                    "G1 X5 X6",
                    "G0 G1 X3",
                    "G2 X5 Y5",
                    "G81 X1",
                    "G92",
                    "G10 L2 P12 X1",
                    "G0 X[1",
                    "G43 H0",
                    "G123",
                    "G53 G2 X1 Y1 R4",
                    "G2 X10 Y0 I2 J0",
                    "G0 X1 (open",
                    "G28 G0 X1",
                    "M6 T-1",
                    "G0 Xabc",
                    "#9999 = 1",
                    "G80 X3",
                    "G83 X1 Z-1 R1 Q0",
                    "G4 P-1",
                    "G3 X1 Y1 R0.1",
                    "gosub nowhere",
                    'errmsg "stop"',
                    "Q5",
                    "G1 X2 P3",
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
                self.lengths,
                self.modes,
                self.away,
                self.cycle,
                self.formed,
                self.assign,
                self.loop,
                self.choice,
                self.sub,
                self.small,
            ),
            (30, 14, 9, 6, 8, 6, 7, 4, 6, 3, 4, 3, 8),
        )[0]
        if self.deep > 2 and chosen in {self.loop, self.choice, self.sub, self.formed}:
            chosen = self.move
        chosen()

    def program(self) -> str:
        rng = self.rng
        head = ["G21", "G90", "G17", "G40", "G80", "G98", "F500"]
        if rng.random() < 0.85:
            head.append("G49")
        if rng.random() < 0.7:
            head.append("G54")
        rng.shuffle(head)
        self.say(" ".join(head))
        for number in VARIABLES:
            if rng.random() < 0.99:
                self.say(f"#{number} = {round(rng.uniform(-15, 15), rng.choice((0, 1, 2)))}")
        self.say("#110 = 1 #111 = 100")
        self.say(f"G0 X{self.length(30)} Y{self.length(30)} Z{self.length(15)}")
        for _ in range(rng.randrange(3, 16)):
            self.any()
        if rng.random() < 0.12:
            self.wrong()
            self.move()
        self.say(rng.choice(("M30", "M2", "m30")))
        subs = [line for name, body in self.subs for line in (f"sub {name}", *body, "endsub")]
        whole = [*subs, *self.lines] if rng.random() < 0.5 else [*self.lines, *subs]
        return "\n".join(self.dressed(line, n) for n, line in enumerate(whole, start=1)) + "\n"

    def dressed(self, line: str, number: int) -> str:
        """Other letters, blanks, comments and line numbers, which mean nothing."""
        rng = self.rng
        plain = not any(word in line for word in ("msg", "sub", "(", ";"))
        if plain and rng.random() < 0.2:
            line = "".join(rng.choice((c.lower(), c.upper())) for c in line)
        if plain and rng.random() < 0.1:
            line = line.replace(" ", rng.choice(("", "  ", "\t")) if "mod" not in line.lower() else " ")
        if plain and rng.random() < 0.1 and line:
            line += rng.choice((" (rest)", " ; rest", "(G0 X900)"))
        if plain and self.numbers and line and line[0] not in "/#iIeEwW":
            line = f"N{number} {line}"
        return line


def job(rng: random.Random) -> Job:
    """A random job."""
    writer = Writer(rng)
    program = writer.program()
    start = {a: round(rng.uniform(-30, 30), 3) for a in AXES}
    work = {n: {a: round(rng.uniform(-40, 40), 3) if rng.random() < 0.9 else 0.0 for a in AXES} for n in range(1, 10)}
    g92 = {a: round(rng.uniform(-10, 10), 3) if rng.random() < 0.2 else 0.0 for a in AXES}
    lengths = {n: round(rng.uniform(5, 45), 2) for n in range(1, 5)}
    park = [{a: round(rng.uniform(-50, 50), 2) for a in AXES} for _ in range(2)]
    active, tool, deleted = rng.randrange(1, 10), rng.randrange(0, 5), rng.random() < 0.5
    # What the shop states of G51 P: nothing, or one of the readings.
    stated = rng.choice((None, None, 0, 1))
    settled = SETTLED if stated is None else {**SETTLED, eding.HEIGHTS: stated}
    macros = "sub m101\n g91 g1 x#24\n g90\nendsub\n"

    heads = {n: {a: round(rng.uniform(-15, 15), 2) for a in "XYZ"} for n in (1, 2)}
    spread = (  # of Z none: with a tool length that nobody states a condition would rest on both
        {a: round(rng.uniform(0, 3), 3) if rng.random() < 0.6 else 0.0 for a in "XY"} if rng.random() < 0.15 else {}
    )

    def read(limits: Limits) -> Iterator[Walk]:
        for part in (0.0, 0.5, 1.0) if spread else (0.0,):
            moved = {a: v + part * spread.get(a, 0.0) for a, v in work[active].items()}
            yield from read_one(limits, {**work, active: moved})

    def read_one(limits: Limits, work: dict[int, Point]) -> Iterator[Walk]:
        facts = eding.Facts(
            limits,
            start,
            work,
            active,
            g92,
            dict(lengths),
            tool,
            dict(park[0]),
            dict(park[1]),
            {},
            block_delete=deleted,
            macros=macros,
            heads=heads,
        )
        return eding.read(program, facts, settled)

    def files(limits: Limits) -> dict[str, str]:
        setup = ['schema = "gproof-setup/1"', 'homed = ["x", "y", "z", "a"]', f"start = {row(start)}", f"tool = {tool}"]
        setup += [
            f"active_work = {active}",
            f"block_delete = {str(deleted).lower()}",
            "optional_stop = false",
            f"g92 = {row(g92)}",
        ]
        for n, place in work.items():
            setup.append(f"work.{n} = {row(place, spread if n == active else {})}")
        setup.append("[parameters]")
        setup += [
            f"{first + i} = {place[a]}"
            for first, place in ((5161, park[0]), (5181, park[1]))
            for i, a in enumerate(AXES)
        ]
        return {
            "machine.toml": machine_file(limits, lengths, heads, stated),
            "setup.toml": "\n".join(setup) + "\n",
            "macro.cnc": macros,
        }

    words = ("--machine", "machine.toml", "--setup", "setup.toml")
    return Job("eding", program, "cnc", AXES, start, read, files, words, {"tool.": 0.0})


def row(place: Point, spread: Point | None = None) -> str:
    """A table of a setup; spread: by how much a value may be more."""
    more = spread or {}
    values = {a: f"[{v}, {v + more[a]}]" if more.get(a) else str(v) for a, v in place.items()}
    return "{" + ", ".join(f"{a.lower()} = {v}" for a, v in values.items()) + "}"


def machine_file(limits: Limits, lengths: dict[int, float], heads: dict[int, Point], scaled: int | None) -> str:
    text = ['schema = "gproof-machine/1"', 'units = "mm"']
    for axis, (low, high) in limits.items():
        text += [
            f"[axes.{axis.lower()}]",
            f"min = {low}",
            f"max = {high}",
            "max_velocity = 100.0",
            "max_acceleration = 500.0",
        ]
    for number, length in lengths.items():
        text += [f"[tools.{number}]", f"length = {length}", "diameter = 4.0"]
    for number, offset in heads.items():
        text += [f"[spindles.{number}]", *(f"{a.lower()} = {v}" for a, v in offset.items())]
    text += ["[controller]", 'dialect = "eding"', "auto_tool_change = false"]
    if scaled is not None:
        text.append(f'accepts = ["{("unscaled-z", "scaled-z")[scaled]}"]')
    return "\n".join(text) + "\n"
