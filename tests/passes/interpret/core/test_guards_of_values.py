"""Guards narrow what they guard: against a plain interpreter of its own, and guards that make a job safe are seen.

The interpreter runs the same random programs with numbers for the unknown variables: wherever it leaves the limits, the
answer for all numbers at once must not be SAFE.
"""

from __future__ import annotations

import contextlib
import math
import random
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
from support.campaigns import seeds

from gproof.driver.judge import Judgement, judge
from gproof.driver.session import Running, open_session
from gproof.ir import intervals as ranges
from gproof.ir.verdict import Verdict

EDING = """schema = "gproof-machine/1"
units = "mm"
name = "m"
[controller]
dialect = "eding"
"""
DIN = """schema = "gproof-machine/1"
units = "mm"
name = "m"
[din]
case_sensitive = false
line_numbers = false
position_unit = "mm"
time_unit = "min"
absolute_centers = false
interpolation_axes = "XYZ"
[din.task0]
M30 = "end"
"""
SETUP = """schema = "gproof-setup/1"
homed = ["x", "y", "z"]
start = {x = 0.0, y = 0.0, z = 0.0}
active_work = 1
tool = 1
tool_length = 0.0
[work.1]
x = 0
y = 0
z = 0
[g92]
x = 0
y = 0
z = 0
[transform]
angle = 0.0
factor = 1.0
"""
HEAD = "G21 G90 G17 G40 G49 G54\nF500\n"
DIN_HEAD = "%P\nG53\nG90\nG94\nG00 X0 Y0 Z0\nG01 Z0.5 F300\n"


def judged(folder: Path, text: str, stated: dict[int, tuple[float, float]], room: float, *, pascal: bool) -> Judgement:
    job = folder / ("job.src" if pascal else "job.cnc")
    job.write_text(text)
    axis = f'kind = "linear"\nmin = {-room}\nmax = {room}\ntravel_min = {-room}\ntravel_max = {room}\n'
    axis += 'position_unit = "mm"\n' if pascal else ""
    machine, setup = folder / "machine.toml", folder / "setup.toml"
    machine.write_text((DIN if pascal else EDING) + "".join(f"[axes.{n}]\n{axis}" for n in "xyz"))
    setup.write_text(SETUP + "[parameters]\n" + "".join(f"{n} = [{a!r}, {b!r}]\n" for n, (a, b) in stated.items()))
    session = open_session(
        job, machine=machine, setup=str(setup), dialect="mcuwin" if pascal else "eding"
    )  # fmt: skip
    return judge(session, running=Running(20_000, 400))


WIDE = {1: (-2000.0, 2000.0), 2: (-2000.0, 2000.0)}


@pytest.mark.parametrize(
    "body",
    [
        "if [[#1 > 0] and [#1 < 100]]\nG1 X#1\nendif\n",
        'if [#1 > 100]\nerrmsg "far"\nendif\nif [#1 < -100]\nerrmsg "near"\nendif\nG1 X#1\n',
        "if [[#1 < -100] or [#1 > 100]]\nG1 X0\nelse\nG1 X#1\nendif\n",
        "if [not [[#1 < -100] or [#1 > 100]]]\nG1 X#1\nendif\n",
        "if [abs[#1] <= 100]\nG1 X#1\nendif\n",
        "if [[#1 + 50] < 100]\nif [[#1 - 20] > -100]\nG1 X#1\nendif\nendif\n",
        "if [100 > #1]\nif [0 <= #1]\nG1 X#1\nendif\nendif\n",
        "if [[0 - #1] > 0]\nif [#1 > -100]\nG1 X#1\nendif\nendif\n",
        "if [#1 > 0]\nif [#2 < 100]\nif [#1 < #2]\nG1 X#1\nendif\nendif\nendif\n",
        "if [[#1 >= 10] and [#1 <= 100]]\nwhile [#1 > 90]\nG1 Y[#1 - 5]\n#1 = [#1 - 5]\nendwhile\nG1 X#1\nendif\n",
        "while [#1 > 100]\n#1 = [#1 - 500]\nendwhile\nif [#1 >= -100]\nG1 X#1\nendif\n",
        "#3 = [#1 * 2]\nif [[#3 > -100] and [#3 < 100]]\nG1 X#3\nendif\n",
        "#3 = #1\nif [#3 > 100]\n#3 = 100\nendif\nif [#3 < -100]\n#3 = -100\nendif\nG1 X#3\n",
        "if [#1 == 50]\nG1 X#1\nendif\n",
    ],
)
def test_guards_of_eding_that_make_a_job_safe(tmp_path: Path, body: str) -> None:
    assert judged(tmp_path, f"{HEAD}{body}M30\n", WIDE, 101.0, pascal=False).verdict is Verdict.SAFE


@pytest.mark.parametrize(
    "body",
    [
        "if [[#1 > 0] or [#1 < 100]]\nG1 X#1\nendif\n",
        "if [#1 > 0]\nG1 X#1\nendif\n",
        "if [[#1 > 0] and [#1 < 100]]\n#1 = [#1 * 5]\nG1 X#1\nendif\n",
        "if [[#1 > 0] and [#1 < 100]]\nG1 X#2\nendif\n",
        "if [[#1 > 0] and [#1 < 100]]\ngosub up\nG1 X#1\nendif\n",
        "#9 = 1\nif [[#1 > 0] and [#1 < 100]]\n#[#9] = 1000\nG1 X#1\nendif\n",
        "#9 = 1\nif [[#[#9] > 0] and [#[#9] < 100]]\nendif\nG1 X#1\n",
        "if [[#1 > 0] and [#1 < 100]]\nG1 Y0\nendif\nG1 X#1\n",
        "if [#1 <> 50]\nG1 X#1\nendif\n",
        "while [#1 > 100]\n#1 = [#1 - 500]\nendwhile\nG1 X#1\n",
        "if [[#1 * #1] < 100]\nG1 X[#1 * 20]\nendif\n",
    ],
)
def test_guards_of_eding_that_do_not(tmp_path: Path, body: str) -> None:
    text = f"sub up\n#1 = [#1 + 1000]\nendsub\n{HEAD}{body}M30\n"
    assert judged(tmp_path, text, WIDE, 101.0, pascal=False).verdict is not Verdict.SAFE


@pytest.mark.parametrize(
    ("body", "room", "safe"),
    [
        ("G01 X(CI606 div 2)", 3.0, True),
        ("G01 X(CI606 div 2)", 2.9, False),
        ("G01 X(CI606 mod 4)", 3.0, True),
        ("G01 X(CI606 mod 4)", 2.9, False),
        ("G01 X(CI606 shl 2)", 28.0, True),
        ("G01 X(CI606 shl 2)", 27.9, False),
        ("G01 X(CI606 - 1)", 6.0, True),
        ("$if CI606 < 3 then begin\nG01 X(CI606)\n$end;", 2.0, True),
        ("$if CI606 < 3 then begin\nG01 X(CI606)\n$end;", 1.9, False),
        ("$if CI606 = 3 then begin\nG01 X(CI606)\n$end;", 3.0, True),
        ("$if CI606 <> 7 then begin\nG01 X(CI606)\n$end;", 6.0, True),
        ("$if CI606 > 5 then begin\nG01 X1\n$end else begin\nG01 X(CI606)\n$end;", 5.0, True),
        ("G91\nM98 L7 O(CI606)\nG90", 7.0, True),
        ("G91\nM98 L7 O(CI606)\nG90", 6.9, False),
        ("CI607 := 0\n$for CI608 := 1 to CI606 do begin\nCI607 := CI607 + 1\nG01 X(CI607)\n$end;", 7.0, True),
        ("CI607 := 0\n$for CI608 := 1 to CI606 do begin\nCI607 := CI607 + 1\nG01 X(CI607)\n$end;", 6.9, False),
    ],
)
def test_whole_numbers_of_mcuwin(tmp_path: Path, body: str, room: float, safe: bool) -> None:
    text = f"{DIN_HEAD}{body}\nM30\n%\n%7\nG01 X1\nM17\n%\n"
    answer = judged(tmp_path, text, {1606: (1.0, 7.0)}, room, pascal=True).verdict
    assert (answer is Verdict.SAFE) is safe


# ---- random programs


class Stopped(Exception):
    """The program ended itself, or did something that has no value."""


@dataclass
class World:
    """A run with numbers. places: where X was, by move."""

    values: dict[int, float]
    pascal: bool
    places: list[float] = field(default_factory=list)
    left: int = 2000

    def value(self, node: Any) -> float:
        match node:
            case float() | int():
                return float(node)
            case ("#", number):
                return self.values[number]
            case ("abs", one):
                return abs(self.value(one))
            case ("not", one):
                return float(self.value(one) == 0)
            case (operator, left, right):
                return self.two(operator, self.value(left), self.value(right))
        raise AssertionError(node)

    def two(self, operator: str, x: float, y: float) -> float:
        match operator:
            case "+":
                return x + y
            case "-":
                return x - y
            case "*":
                return x * y
            case "div":
                return float(math.trunc(x / y)) if y else self.stop()
            case "mod":
                return math.fmod(x, y) if y else self.stop()
            case "<":
                return float(x < y)
            case ">":
                return float(x > y)
            case "<=":
                return float(x <= y)
            case ">=":
                return float(x >= y)
            case "==":
                return float(x == y)
            case "<>":
                return float(x != y)
            case "and":
                return float(x != 0 and y != 0)
            case "or":
                return float(x != 0 or y != 0)
        raise AssertionError(operator)

    def stop(self) -> float:
        raise Stopped

    def run(self, body: list[Any]) -> None:
        for node in body:
            self.left -= 1
            if self.left < 0:
                raise Stopped
            match node:
                case ("set", number, value):
                    self.values[number] = self.value(value)
                    if self.pascal and abs(self.values[number]) >= 2.0**31:
                        raise Stopped
                case ("move", value):
                    self.places.append(self.value(value))
                case ("if", condition, then, otherwise):
                    self.run(then if self.value(condition) else otherwise)
                case ("while", condition, inner):
                    while self.value(condition):
                        self.left -= 1
                        if self.left < 0:
                            raise Stopped
                        self.run(inner)
                case ("stop",):
                    raise Stopped


def make_value(rng: random.Random, depth: int, *, pascal: bool) -> Any:
    if depth == 0 or rng.random() < 0.45:
        constant = rng.randrange(-9, 10) if pascal or rng.random() < 0.6 else round(rng.uniform(-9, 9), 3)
        return rng.choice([("#", rng.randrange(1, 4)), ("#", rng.randrange(1, 4)), constant])
    operators = "+-*" if not pascal else ["+", "-", "*", "div", "mod"]
    if rng.random() < 0.15:
        return ("abs", make_value(rng, depth - 1, pascal=pascal))
    return (rng.choice(operators), *(make_value(rng, depth - 1, pascal=pascal) for _ in range(2)))


def make_condition(rng: random.Random, depth: int, *, pascal: bool) -> Any:
    roll = rng.random()
    if depth and roll < 0.35:
        return (rng.choice(["and", "or"]), *(make_condition(rng, depth - 1, pascal=pascal) for _ in range(2)))
    if depth and roll < 0.45:
        return ("not", make_condition(rng, depth - 1, pascal=pascal))
    left = make_value(rng, 1, pascal=pascal)
    right = make_value(rng, rng.randrange(2), pascal=pascal)
    operator = rng.choice(["<", ">", "<=", ">=", "<", ">", *(["==", "<>"] if pascal else ["<>"])])
    return (operator, left, right)


def make_body(rng: random.Random, depth: int, *, pascal: bool) -> list[Any]:
    body: list[Any] = []
    for _ in range(rng.randrange(1, 4)):
        roll = rng.random()
        if roll < 0.35:
            body.append(("move", make_value(rng, 1, pascal=pascal)))
        elif roll < 0.55:
            body.append(("set", rng.randrange(1, 4), make_value(rng, 2, pascal=pascal)))
        elif roll < 0.9 and depth:
            condition = make_condition(rng, 2, pascal=pascal)
            then, otherwise = (make_body(rng, depth - 1, pascal=pascal) for _ in range(2))
            body.append(("if", condition, then, rng.choice([otherwise, []])))
        elif depth:
            step = ("set", 1, ("-", ("#", 1), rng.randrange(1, 5)))
            condition = (">", ("#", 1), rng.randrange(-9, 9))
            body.append(("while", condition, [*make_body(rng, depth - 1, pascal=pascal), step]))
        elif not pascal and rng.random() < 0.3:
            body.append(("stop",))
    return body


def shown(node: Any, *, pascal: bool) -> str:
    a, b = "()" if pascal else "[]"
    match node:
        case float() | int():
            return f"{a}0 - {-node}{b}" if node < 0 else str(node)
        case ("#", number):
            return f"CI{600 + number}" if pascal else f"#{number}"
        case (("abs" | "not") as name, one):
            return f"{name}{a}{shown(one, pascal=pascal)}{b}"
        case (operator, left, right):
            name = {"==": "="}.get(operator, operator) if pascal else operator
            return f"{a}{shown(left, pascal=pascal)} {name} {shown(right, pascal=pascal)}{b}"
    raise AssertionError(node)


def printed(body: list[Any], *, pascal: bool) -> str:
    lines = ""
    for node in body:
        match node:
            case ("set", number, value):
                text = shown(value, pascal=pascal)
                lines += f"CI{600 + number} := {text}\n" if pascal else f"#{number} = [{text}]\n"
            case ("move", value):
                text = shown(value, pascal=pascal)
                lines += f"G01 X({text})\n" if pascal else f"G1 X[{text}]\n"
            case ("if", condition, then, otherwise):
                test, one, two = (
                    shown(condition, pascal=pascal),
                    *(printed(x, pascal=pascal) for x in (then, otherwise)),
                )
                if pascal:
                    lines += f"$if {test} then begin\n{one}$end" + (f" else begin\n{two}$end;\n" if two else ";\n")
                else:
                    lines += f"if [{test}]\n{one}" + (f"else\n{two}" if two else "") + "endif\n"
            case ("while", condition, inner):
                test, one = shown(condition, pascal=pascal), printed(inner, pascal=pascal)
                lines += f"$while {test} do begin\n{one}$end;\n" if pascal else f"while [{test}]\n{one}endwhile\n"
            case ("stop",):
                lines += 'errmsg "no"\n'
    return lines


@pytest.mark.parametrize("seed", seeds(20, 3000))
def test_random_programs_with_guards(tmp_path: Path, seed: int) -> None:
    rng = random.Random(seed)
    pascal = rng.random() < 0.5
    body = make_body(rng, 3, pascal=pascal)
    ends = {n: tuple(sorted((rng.randrange(-12, 13), rng.randrange(-12, 13)))) for n in (1, 2, 3)}
    room = rng.choice([5.0, 10.0, 20.0, 60.0, 300.0])
    offset = 1600 if pascal else 0
    text = (DIN_HEAD if pascal else HEAD) + printed(body, pascal=pascal) + ("M30\n%\n" if pascal else "M30\n")
    answer = judged(
        tmp_path, text, {n + offset: (float(a), float(b)) for n, (a, b) in ends.items()}, room, pascal=pascal
    )
    safe = answer.verdict is Verdict.SAFE
    for _ in range(40):
        start = {
            n: float(rng.randint(a, b)) if pascal or rng.random() < 0.5 else rng.uniform(a, b)
            for n, (a, b) in ends.items()
        }
        world = World(dict(start), pascal)
        with contextlib.suppress(Stopped):
            world.run(body)
        for place in world.places:
            if not safe:
                continue
            assert abs(place) <= room + 1e-6, f"seed {seed}\n{start} goes to {place}, limits {room}\n{text}"


@pytest.mark.parametrize("operator", ["+", "-", "*", "div", "rem", "mod", "<<", ">>", "shr", "band", "bor", "bxor"])
def test_ranges_of_whole_numbers_hold_their_values(operator: str) -> None:
    """Every pair of numbers of small ranges, by Python's own whole numbers; the ends are met where that is promised."""
    compute: Callable[[int, int], list[int]] = {
        "+": lambda a, b: [a + b],
        "-": lambda a, b: [a - b],
        "*": lambda a, b: [a * b],
        "div": lambda a, b: [math.trunc(a / b)],
        # With the sign of the first, with that of the second, never negative.
        "rem": lambda a, b: [int(math.fmod(a, b)), a % b, a % abs(b)],
        "mod": lambda a, b: [int(math.fmod(a, b)), a % b, a % abs(b)],
        "<<": lambda a, b: [a << b],
        ">>": lambda a, b: [a >> b],
        "shr": lambda a, b: [a >> b],
        "band": lambda a, b: [a & b],
        "bor": lambda a, b: [a | b],
        "bxor": lambda a, b: [a ^ b],
    }[operator]
    rng = random.Random(operator)
    for _ in range(400):
        a, b, c, d = (rng.randrange(-12, 13) for _ in range(4))
        x, y = (float(min(a, b)), float(max(a, b))), (float(min(c, d)), float(max(c, d)))
        found = ranges.whole_binary(operator, x, y)
        if found is None:
            continue
        values = []
        for left in range(int(x[0]), int(x[1]) + 1):
            for right in range(int(y[0]), int(y[1]) + 1):
                try:
                    values += compute(left, right)
                except (ZeroDivisionError, ValueError):
                    assert ranges.whole_may_fail(operator, x, y)
        if not values:
            continue
        assert found[0] <= min(values) and max(values) <= found[1], (operator, x, y)
        if operator in ("+", "-", "*", "div", "<<", ">>", "shr"):
            assert found == (min(values), max(values)), (operator, x, y)
