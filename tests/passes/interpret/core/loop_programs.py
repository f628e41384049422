"""Random programs of loops, printed for two controllers, and a second reading of them that runs every pass.

A program is a tree of tuples (see ``Maker``); ``print_mcuwin`` and ``print_eding`` write it as text, ``Run`` executes
it with given inputs and shares no code with gproof. Numbers are doubles; those of McuWIN whose name begins with ``i``
or ``n`` are whole, of 32 bits.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

Tree = tuple[Any, ...]
Body = list[Tree]
INTS, DOUBLES = ("i0", "i1", "i2", "i3"), ("d0", "d1", "d2")
COUNTERS = ("i4", "i5", "d3")
"""Most often nothing but other counters and messages read them."""
COMPARE: dict[str, Callable[[float, float], bool]] = {
    "<": lambda a, b: a < b, "<=": lambda a, b: a <= b, ">": lambda a, b: a > b, ">=": lambda a, b: a >= b,
    "==": lambda a, b: a == b, "<>": lambda a, b: a != b,
}  # fmt: skip


@dataclass
class Tale:
    """A program: what is set first, its statements, its subprograms, and how far the axes may go."""

    start: dict[str, float]
    body: Body
    subs: dict[str, Body]
    room: float


class Maker:
    """Random programs. pascal: counted loops, jumps and subprograms that come again; else ``#[...]``."""

    def __init__(self, rng: random.Random, *, pascal: bool, inputs: bool) -> None:
        self.rng, self.pascal, self.inputs = rng, pascal, inputs
        self.counted = 0
        self.labels = 100
        self.subs: dict[str, Body] = {}
        self.open: list[str] = []
        self.in_sub = False
        self.budget = 22
        # Most moves of a quiet program go where another pass has been.
        self.quiet = rng.choice([0.0, 0.0, 0.6, 0.9])
        self.shown = (*INTS, *DOUBLES, *COUNTERS) if rng.random() < 0.3 else (*INTS, *DOUBLES)

    def tale(self) -> Tale:
        rng = self.rng
        start = {name: float(rng.choice([0, 0, 1, 2, 5, -3, 40])) for name in INTS}
        start |= {name: rng.choice([0.0, 1.0, 0.5, 7.25, -2.5]) for name in DOUBLES}
        start |= dict.fromkeys(COUNTERS, 0.0)
        if self.pascal and rng.random() < 0.3:
            start[rng.choice(["i0", "i1", "i4", "i5"])] = float(
                rng.choice([2_147_483_600, -2_147_483_000, 2_000_000_000])
            )
        if rng.random() < 0.6:
            self.in_sub = True
            for name in ("900", "901")[: rng.randint(1, 2)]:
                body = self.block(1, rng.randint(1, 3))
                self.subs[name] = body
            self.in_sub = False
        body = self.block(3, rng.randint(1, 3))
        if not any(node[0] in ("while", "repeat", "for", "again", "call") for node in body):
            body.append(self.loop(2))
        # What is left of each whole number is seen.
        body += [("move", 0, {rng.choice("XY"): ("*", ("v", name), ("n", 0.1))}) for name in INTS if rng.random() < 0.7]
        body.append(("move", 0, {"X": ("n", float(rng.randint(-9, 9)))}))
        return Tale(start, body, self.subs, rng.choice([12.0, 30.0, 100.0, 400.0, 5000.0]))

    # ---- statements

    def block(self, depth: int, size: int) -> Body:
        return [self.statement(depth) for _ in range(size)]

    def statement(self, depth: int) -> Tree:
        rng = self.rng
        self.budget -= 1
        if depth > 0 and self.budget > 0 and rng.random() < 0.35 - 0.2 * self.quiet:
            return self.loop(depth - 1)
        draw = rng.random()
        if draw < self.quiet:
            draw = rng.random()
            if draw < 0.4:
                return self.count()
            if draw < 0.6 and depth > 0:
                return ("if", self.test(), [self.statement(depth - 1)], [])
            return ("move", 0, {rng.choice("XY"): ("n", float(rng.randint(-3, 4)))}) if draw < 0.9 else ("say", "i4")
        draw = rng.random()
        if draw < 0.30:
            return self.set()
        if draw < 0.52:
            return self.move()
        if draw < 0.56:
            return ("mode", rng.random() < 0.6)
        if draw < 0.62:
            return self.rare()
        if draw < 0.66:
            return ("shift", rng.choice("XY"), rng.choice([("n", 1.0), ("n", -0.5), self.value()]))
        if draw < 0.70:
            return ("say", rng.choice((*INTS, *DOUBLES, *COUNTERS)))
        if draw < 0.74 and self.subs and not self.in_sub:
            count = rng.choice([None, 2, 3, 20, 60, 700]) if self.pascal else None
            return ("call", rng.choice(sorted(self.subs)), count)
        if draw < 0.78 and self.open and self.pascal:
            return ("if", self.test(), [("jump", rng.choice(self.open))], [])
        if draw < 0.80 and self.in_sub and self.pascal:
            return ("if", self.test(), [("return",)], [])
        if draw < 0.83 and self.pascal:
            return (rng.choice(["keep", "bring"]), rng.choice((*INTS, *DOUBLES)))
        if draw < 0.86 and not self.pascal:
            return ("poke", ("+", ("n", 30.0), ("v", rng.choice(INTS))), self.value())
        if depth > 0:
            other = self.block(depth - 1, 1) if rng.random() < 0.5 else []
            return ("if", self.test(), self.block(depth - 1, rng.randint(1, 2)), other)
        return self.set()

    def rare(self) -> Tree:
        """Arcs whose radii differ where a counter is not 0, zeros, units, procedures, values that are asked for."""
        rng = self.rng
        draw = rng.random()
        if draw < 0.2:
            return ("arc", ("v", rng.choice(["i4", "i5", *INTS])))
        if draw < 0.4:
            return ("zero", rng.randint(0, 1), rng.choice("XY"), self.value())
        if draw < 0.6 and self.inputs:
            return ("asked", rng.choice((*INTS, "i4")))
        if not self.pascal:
            return ("unit", rng.random() < 0.3)
        by: Tree = (
            ("v", rng.choice((*INTS, "i4"))) if rng.random() < 0.3 else ("n", float(rng.choice([1, 2, 50_000_000])))
        )
        if draw < 0.75:
            return ("bump", rng.choice((*INTS, "i4", "i5")), by)
        return ("half", rng.choice((*DOUBLES, "d3")), self.value()) if draw < 0.9 else ("tally",)

    def loop(self, depth: int) -> Tree:
        rng = self.rng
        counter = rng.choice(INTS)
        count = rng.choice([2, 3, 7, 18, 37, 40, 150, 600])
        leaving = self.label() if self.pascal and rng.random() < 0.4 else None
        if leaving:
            self.open.append(leaving)
        kind = rng.choice(["for", "for", "downto", "repeat", "while", "while", "again"] if self.pascal else ["while"])
        found: Tree
        if kind in ("for", "downto") and self.counted < 6:
            name, self.counted = "n" + "abcdef"[self.counted], self.counted + 1
            body = [self.count()] if rng.random() < 0.2 else self.block(depth, rng.randint(1, 3))
            if rng.random() < 0.3:
                body.append(("move", 0, {rng.choice("XY"): ("*", ("v", name), ("n", 0.25))}))
            low, high = rng.choice([0, 1, -4]), 0
            high = low + count - 1
            ends: tuple[Any, Any] = (("n", float(low)), ("n", float(high)))
            if rng.random() < 0.15:
                ends = ends[0], ("v", rng.choice(INTS))
            found = ("for", name, *(reversed(ends) if kind == "downto" else ends), kind == "downto", body)
        else:
            kind = kind if kind in ("repeat", "again") else "while"
            draw = rng.random()
            step = rng.choice([1, 1, 1, 2, 5])
            more: Body = [("set", counter, ("+", ("v", counter), ("n", float(step))))] if draw < 0.75 else []
            test: Tree = ("<", ("v", counter), ("n", float(count))) if draw < 0.6 else self.test()
            if self.inputs and draw > 0.45:
                test = ("input",) if rng.random() < 0.6 else ("both", ("input",), test)
            body = [*self.block(depth, rng.randint(0 if more else 1, 3)), *more]
            if more and rng.random() < 0.2:
                body = [self.count(), *more][rng.randint(0, 1) :]
            if kind == "repeat" and test[0] == "<":
                # It ends where its test holds.
                test = (">=", *test[1:])
            found = (kind, test, body)
        if leaving:
            self.open.remove(leaving)
            return ("labelled", leaving, found)
        return found

    def label(self) -> str:
        self.labels += 1
        return str(self.labels)

    def count(self) -> Tree:
        rng = self.rng
        name = rng.choice(COUNTERS)
        if name == "d3":
            return ("set", name, (rng.choice("+-"), ("v", name), ("n", rng.choice([0.1, 1.0, 40.0]))))
        step = ("n", float(rng.choice([1, 1, 2, 999, 30_000, 20_000_000, 500_000_000])))
        draw = rng.random()
        if draw < 0.7:
            return ("set", name, (rng.choice("++-"), ("v", name), step))
        if draw < 0.8:
            return ("set", rng.choice([name, name, *INTS]), ("+", ("v", rng.choice(("i4", "i5"))), step))
        if draw < 0.9:
            return ("set", name, (rng.choice("*+"), ("v", rng.choice(INTS)), ("v", rng.choice((*INTS, "i4")))))
        return ("set", name, ("n", float(rng.choice([0, 0, 2_147_000_000]))))

    def set(self) -> Tree:
        rng = self.rng
        if rng.random() < 0.6:
            name = rng.choice(INTS)
            step = rng.choice([1, 1, 1, 2, 7, 1000, 100_000_000])
            draw = rng.random()
            if draw < 0.5:
                return ("set", name, (rng.choice("+-"), ("v", name), ("n", float(step))))
            if draw < 0.7:
                return ("set", name, (rng.choice("+-"), ("v", rng.choice(INTS)), ("n", float(rng.randint(0, 3)))))
            if draw < 0.85:
                return ("set", name, ("n", float(rng.choice([0, 0, 1, 3, -2]))))
            return ("set", name, (rng.choice("+-*"), ("v", rng.choice(INTS)), ("v", rng.choice(INTS))))
        name = rng.choice(DOUBLES)
        draw = rng.random()
        if draw < 0.4:
            return ("set", name, (rng.choice("+-"), ("v", name), ("n", rng.choice([0.1, 0.25, 1.0, 3.3]))))
        if draw < 0.55:
            return ("set", name, ("n", rng.choice([0.0, 1.0, -2.5])))
        return ("set", name, self.value())

    def move(self) -> Tree:
        rng = self.rng
        words = {axis: self.value() if rng.random() < 0.6 else ("n", float(rng.randint(-3, 4)))
                 for axis in rng.choice(["X", "Y", "XY"])}  # fmt: skip
        return ("move", rng.choice([0, 1]), words)

    # ---- expressions

    def value(self) -> Tree:
        rng = self.rng
        name: Tree = ("v", rng.choice(self.shown))
        draw = rng.random()
        if draw < 0.25:
            return name
        if draw < 0.5:
            return (rng.choice("+-"), name, ("n", rng.choice([0.5, 1.0, 3.0])))
        if draw < 0.7:
            return ("*", name, ("n", rng.choice([0.1, 0.5, 2.0])))
        if draw < 0.8:
            return (rng.choice("+-"), name, ("v", rng.choice(DOUBLES)))
        if draw < 0.87:
            return ("/", ("n", 4.0), ("-", ("n", float(rng.choice([3, 20, 41]))), name))
        if draw < 0.94:
            return ("sqrt", ("-", ("n", float(rng.choice([5, 30, 90]))), name))
        if not self.pascal:
            return ("peek", ("+", ("n", 30.0), ("v", rng.choice(INTS))))
        return ("n", rng.choice([0.0, 2.0, 5.5]))

    def test(self) -> Tree:
        rng = self.rng
        if self.inputs and rng.random() < 0.4:
            return ("input",)
        left: Tree = ("v", rng.choice(INTS)) if rng.random() < 0.7 else ("v", rng.choice(DOUBLES))
        right = ("n", float(rng.choice([0, 1, 5, 30, 36, 100]))) if rng.random() < 0.8 else ("v", rng.choice(INTS))
        return (rng.choice(["<", "<=", ">", ">=", "<>", "=="]), left, right)


# ---- texts


def print_mcuwin(tale: Tale) -> str:
    names = {f"i{k}": f"CI{600 + k}" for k in range(10)} | {f"d{k}": f"CD{600 + k}" for k in range(10)}
    names |= {f"n{k}": f"n{k}" for k in "abcdef"}
    signs = {"==": "=", "both": "and"}
    out = ["$DINEND", "var", "  na, nb, nc, nd, ne, nf : integer;"]
    out += ["procedure bump(var many : integer; by : integer);", "begin", "  many := many + by;", "end;"]
    out += ["procedure half(var all : double; part : double);", "begin", "  all := all + part * 0.5;", "end;"]
    out += ["procedure tally;", "begin", "  CI605 := CI605 + 3;", "end;"]
    out += ["{$DINSTART}", "%JOB", "G17", "G54", "G90", "G01 F100"]

    def text(e: Tree) -> str:
        match e:
            case ("n", value):
                number = f"{value:g}" if abs(value) < 1e5 else str(int(value))
                return f"({number})" if value < 0 else number
            case ("v", name):
                return names[name]
            case ("input",):
                return "X.digib.1"
            case ("sqrt", one):
                return f"sqrt({text(one)})"
            case (sign, one, other):
                return f"({text(one)} {signs.get(sign, sign)} {text(other)})"
        raise AssertionError(e)

    def lines(body: Body) -> None:
        for node in body:
            match node:
                case ("set", name, value):
                    out.append(f"{names[name]} := {text(value)}")
                case ("move", code, words):
                    out.append(f"G0{code} " + " ".join(f"{a}({text(v)})" for a, v in words.items()))
                case ("mode", absolute):
                    out.append("G90" if absolute else "G91")
                case ("shift", axis, value):
                    out.extend(["G91", f"G92 {axis}({text(value)})", "G90"])
                case ("arc", wrong):
                    out.extend(["G91", f"G02 X10 Y0 I(5 + {text(wrong)}) J0", "G90"])
                case ("zero", number, _, _):
                    out.append(f"G{54 + number}")
                case ("asked", name):
                    out.append("$if (X.digib.1) then begin")
                    out.extend([f"{names[name]} := 1", "$end else begin", f"{names[name]} := 0", "$end;"])
                case ("bump" | "half", name, value):
                    out.append(f"${node[0]}({names[name]}, {text(value)});")
                case ("tally",):
                    out.append("$tally;")
                case ("say", name):
                    out.append(f'WRITELN "{name} " {names[name]}')
                case ("call", name, count):
                    out.append(f"M98 L{name}" + (f" O{count}" if count else ""))
                case ("jump", label):
                    out.append(f"M96 L{label}")
                case ("return",):
                    out.append("M17")
                case ("keep" | "bring", name):
                    code = (901 if name[0] == "i" else 903) + (node[0] == "bring")
                    out.append(f"M{code} {names[name][2:]}")
                case ("if", test, then, other):
                    out.append(f"$if ({text(test)}) then begin")
                    lines(then)
                    if other:
                        out.append("$end else begin")
                        lines(other)
                    out.append("$end;")
                case ("while", test, inner):
                    out.append(f"$while ({text(test)}) do begin")
                    lines(inner)
                    out.append("$end;")
                case ("repeat", test, inner):
                    out.append("$repeat begin")
                    lines(inner)
                    out.append(f"$end until ({text(test)});")
                case ("for", name, first, last, down, inner):
                    out.append(f"$for {name} := {text(first)} {'downto' if down else 'to'} {text(last)} do begin")
                    lines(inner)
                    out.append("$end;")
                case ("again", test, inner):
                    number = 500 + len(out)
                    out.append(f"L{number}")
                    lines(inner)
                    out.extend([f"$if ({text(test)}) then begin", f"M96 L{number}", "$end;"])
                case ("labelled", label, loop):
                    lines([loop])
                    out.append(f"L{label}")
                case _:
                    raise AssertionError(node)

    out += [f"{names[name]} := {text(('n', value))}" for name, value in tale.start.items()]
    tree = str((tale.body, tale.subs))
    kept = [name for name in tale.start if f"('bring', '{name}')" in tree]
    out += [f"M{901 if name[0] == 'i' else 903} {names[name][2:]}" for name in kept]
    lines(tale.body)
    out += ["M30", "%"]
    for name, body in tale.subs.items():
        out.append(f"%{name}")
        lines(body)
        out += ["M17", "%"]
    return "\n".join(out) + "\n"


def print_eding(tale: Tale) -> str:
    names = {f"i{k}": f"#{10 + k}" for k in range(10)} | {f"d{k}": f"#{20 + k}" for k in range(10)}
    out = ["G21 G17 G90 G94 G54 G40 G49 G80 G98", "F100"]
    for name, body in tale.subs.items():
        out.append(f"sub s{name}")
        mark = len(out)
        out += _eding(body, names)
        assert mark <= len(out)
        out.append("endsub")
    out += [f"{names[name]} = {value:.15g}" for name, value in tale.start.items()]
    out += [*(f"#{n} = 0" for n in range(30, 60)), *_eding(tale.body, names), "M30"]
    return "\n".join(out) + "\n"


def _eding(body: Body, names: dict[str, str]) -> list[str]:
    out: list[str] = []

    def text(e: Tree) -> str:
        match e:
            case ("n", value):
                return f"{value:.15g}"
            case ("v", name):
                return names[name]
            case ("input",):
                return "[#5399 == 1]"
            case ("peek", one):
                return f"#{text(one)}"
            case ("sqrt", one):
                return f"sqrt{wrapped(one)}"
            case (sign, one, other):
                return f"[{text(one)} {'and' if sign == 'both' else sign} {text(other)}]"
        raise AssertionError(e)

    def wrapped(e: Tree) -> str:
        one = text(e)
        return one if one[0] == "[" else f"[{one}]"

    def ask(test: Tree) -> None:
        if "input" in str(test):
            out.append("M56 P3")

    for node in body:
        match node:
            case ("set", name, value):
                out.append(f"{names[name]} = {wrapped(value)}")
            case ("poke", place, value):
                out.append(f"#{wrapped(place)} = {wrapped(value)}")
            case ("move", code, words):
                out.append(f"G{code} " + " ".join(a + wrapped(v) for a, v in words.items()))
            case ("mode", absolute):
                out.append("G90" if absolute else "G91")
            case ("shift", axis, value):
                out.extend([f"G92 {axis}[#{5001 + 'XY'.index(axis)} - {text(value)}]", "G90"])
            case ("arc", wrong):
                out.extend(["G91", f"G2 X10 Y0 I[5 + {text(wrong)}] J0", "G90"])
            case ("zero", 0, _, _):
                out.append("G54")
            case ("zero", _, axis, value):
                out.extend(["G54", f"G10 L2 P2 {axis}{wrapped(value)}", "G55"])
            case ("unit", inch):
                out.append("G20" if inch else "G21")
            case ("asked", name):
                out.extend(["M56 P3", f"{names[name]} = #5399"])
            case ("say", name):
                out.append(f'msg "{name} " {names[name]}')
            case ("call", name, _):
                out.append(f"gosub s{name}")
            case ("if", test, then, other):
                ask(test)
                out.append(f"if {wrapped(test)}")
                out.extend(_eding(then, names))
                if other:
                    out.extend(["else", *_eding(other, names)])
                out.append("endif")
            case ("while", test, inner):
                ask(test)
                out.append(f"while {wrapped(test)}")
                out.extend(_eding(inner, names))
                ask(test)
                out.append("endwhile")
            case _:
                raise AssertionError(node)
    return out


# ---- the second reading


class Wrong(Exception):
    """The controller stops with an error."""


class TooLong(Exception):
    """More statements than anybody waits for."""


class NotRead(Exception):
    """A variable that this reading does not have."""


class _Jump(Exception):
    pass


class _Back(Exception):
    pass


@dataclass
class Run:
    """One run. pascal: whole numbers of 32 bits; most: statements; answer: gives each input."""

    tale: Tale
    pascal: bool
    answer: Callable[[], bool]
    most: int = 6_000
    low: dict[str, float] = field(default_factory=lambda: {"X": math.inf, "Y": math.inf})
    high: dict[str, float] = field(default_factory=lambda: {"X": -math.inf, "Y": -math.inf})
    steps: int = 0

    def go(self) -> str:
        """ "done", "wrong: ..." or "long"; extents are those of what was done."""
        self.v = dict(self.tale.start)
        self.kept = dict(self.v)
        self.cells = {float(n): 0.0 for n in range(30, 60)}
        self.at, self.zero, self.absolute = {"X": 0.0, "Y": 0.0}, {"X": 0.0, "Y": 0.0}, True
        self.work, self.second, self.unit = {"X": 0.0, "Y": 0.0}, {"X": 0.0, "Y": 0.0}, 1.0
        try:
            self.body(self.tale.body)
        except Wrong as wrong:
            return f"wrong: {wrong}"
        except TooLong:
            return "long"
        except NotRead:
            return "not read"
        return "done"

    def outside(self) -> bool:
        return any(self.high[a] > self.tale.room or self.low[a] < -self.tale.room for a in "XY")

    def is_whole(self, e: Tree) -> bool:
        if not self.pascal:
            return False
        if e[0] == "n":
            return float(e[1]).is_integer()
        if e[0] == "v":
            return e[1][0] in "in"
        return e[0] in "+-*" and self.is_whole(e[1]) and self.is_whole(e[2])

    def value(self, e: Tree) -> float:
        match e:
            case ("n", value):
                return float(value)
            case ("v", name):
                return self.v[name]
            case ("peek", one):
                return self.cells[self.cell(one)]
            case ("sqrt", one):
                x = self.value(one)
                if x < 0:
                    raise Wrong("sqrt")
                return math.sqrt(x)
        x, y = self.value(e[1]), self.value(e[2])
        if e[0] == "/":
            if y == 0:
                raise Wrong("division")
            return x / y
        found = x + y if e[0] == "+" else x - y if e[0] == "-" else x * y
        if math.isinf(found) or (self.is_whole(e) and not -(2**31) <= found < 2**31):
            raise Wrong("too large")
        return found

    def cell(self, e: Tree) -> float:
        number = self.value(e)
        if number not in self.cells:
            raise NotRead
        return number

    def holds(self, e: Tree) -> bool:
        if e[0] == "input":
            return self.answer()
        if e[0] == "both":
            # Both are asked.
            one, other = self.holds(e[1]), self.holds(e[2])
            return one and other
        return COMPARE[e[0]](self.value(e[1]), self.value(e[2]))

    def go_to(self, axis: str, place: float) -> None:
        self.at[axis] = place
        self.low[axis] = min(self.low[axis], place)
        self.high[axis] = max(self.high[axis], place)

    def arc(self, wrong: float) -> None:
        """Half a circle clockwise of radius 5 over its upper side; the radii at its ends differ by twice ``wrong``."""
        self.absolute = True
        if abs(wrong) * 2 > 1:
            if abs(abs(5 + wrong) - abs(5 - wrong)) < 1:
                raise NotRead
            raise Wrong("radii")
        if wrong:
            raise NotRead
        x, y, size = self.at["X"], self.at["Y"], 5 * self.unit
        for axis, place in (("X", x), ("Y", y + size), ("Y", y), ("X", x + 2 * size)):
            self.go_to(axis, place)

    def use_zero(self, number: int, axis: str, value: Tree) -> None:
        """G54 or G55: of a table, in place of all other offsets, or G55 as G10 has set it, beside those of G92."""
        if self.pascal:
            self.zero = {"X": 3.0, "Y": -2.0} if number else {"X": 0.0, "Y": 0.0}
            return
        if number:
            self.second[axis] = self.value(value) * self.unit
        self.work = dict(self.second) if number else {"X": 0.0, "Y": 0.0}

    def whole(self, value: float) -> float:
        if not -(2**31) <= value < 2**31:
            raise Wrong("too large")
        return value

    def body(self, body: Body) -> None:
        for node in body:
            self.statement(node)

    def spend(self) -> None:
        self.steps += 1
        if self.steps > self.most:
            raise TooLong

    def statement(self, node: Tree) -> None:
        self.spend()
        match node:
            case ("set", name, value):
                self.v[name] = self.value(value)
            case ("poke", place, value):
                self.cells[self.cell(place)] = self.value(value)
            case ("move", _, words):
                for axis, to in {a: self.value(v) * self.unit for a, v in words.items()}.items():
                    from_here = self.zero[axis] + self.work[axis] if self.absolute else self.at[axis]
                    self.go_to(axis, to + from_here)
            case ("mode", absolute):
                self.absolute = absolute
            case ("shift", axis, value):
                self.zero[axis] += self.value(value) * self.unit
                self.absolute = True
            case ("arc", wrong):
                self.arc(self.value(wrong))
            case ("zero", number, axis, value):
                self.use_zero(number, axis, value)
            case ("unit", inch):
                self.unit = 25.4 if inch else 1.0
            case ("asked", name):
                self.v[name] = float(self.answer())
            case ("bump", name, value):
                self.v[name] = self.whole(self.v[name] + self.value(value))
            case ("half", name, value):
                self.v[name] += self.value(value) * 0.5
            case ("tally",):
                self.v["i5"] = self.whole(self.v["i5"] + 3)
            case ("keep", name):
                self.kept[name] = self.v[name]
            case ("bring", name):
                self.v[name] = self.kept[name]
            case ("call", name, count):
                for _ in range(count or 1):
                    self.spend()
                    try:
                        self.body(self.tale.subs[name])
                    except _Back:
                        continue
            case ("jump", label):
                raise _Jump(label)
            case ("return",):
                raise _Back
            case ("if", test, then, other):
                self.body(then if self.holds(test) else other)
            case ("while", test, inner):
                while self.holds(test):
                    self.spend()
                    self.body(inner)
            case ("repeat", test, inner):
                while True:
                    self.spend()
                    self.body(inner)
                    if self.holds(test):
                        break
            case ("again", test, inner):
                while True:
                    self.spend()
                    self.body(inner)
                    if not self.holds(test):
                        break
            case ("for", name, first, last, down, inner):
                step = -1 if down else 1
                here, end = self.value(first), self.value(last)
                while here * step <= end * step:
                    self.spend()
                    self.v[name] = here
                    self.body(inner)
                    here += step
            case ("labelled", label, loop):
                try:
                    self.statement(loop)
                except _Jump as jump:
                    if jump.args[0] != label:
                        raise
