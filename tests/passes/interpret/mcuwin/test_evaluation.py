"""Expressions of rw_SymPas from their text to their value, against an evaluator of a few lines over the same trees.

Trees are typed as the manual asks for (7, 8.3, 11); the evaluator here knows Python's whole numbers and nothing of the
product. It gives the least and the greatest value that a Pascal may give, or nothing where it would be a fault.
"""

from __future__ import annotations

import math
import random
from pathlib import Path
from typing import Any

import pytest

from gproof.driver.running import begin
from gproof.frontend.mcuwin.load import load_program
from gproof.ir.finding import Findings
from gproof.ir.setup import ZERO
from gproof.ir.symbolic import Unknown
from passes.interpret.mcuwin import mcuwin_programs as din

Tree = tuple[Any, ...]
Range = tuple[float, float]
WHOLE = range(-(2**31), 2**31)
SHARP = 1e-9


class Fault(Exception):
    """The value of a tree that has none."""


class Open(Exception):
    """A value of which this evaluator only says that it is not known."""


def tree(random_: random.Random, kind: str, depth: int) -> Tree:
    """A tree of that type: i whole, d double, b boolean."""
    if depth == 0 or random_.random() < 0.15:
        if kind == "b":
            return ("lit", random_.choice((True, False)))
        if kind == "i":
            return ("lit", random_.choice((0, 1, 2, 3, 7, 10, 40, 65535, 2147483647, random_.randint(0, 5000))))
        return ("lit", random_.choice((0.0, 0.5, 1.5, 2.25, 100.0, 3.75)))
    if kind == "b":
        word = random_.choice(("and", "or", "xor", "not", "<", "<=", ">", ">=", "=", "<>", "boolean", "odd"))
        if word == "not":
            return ("not", tree(random_, "b", depth - 1))
        if word in ("boolean", "odd"):
            return ("call", word, tree(random_, "i", depth - 1))
        inner = "b" if word in ("and", "or", "xor") else random_.choice("id")
        return (word, tree(random_, inner, depth - 1), tree(random_, inner, depth - 1))
    if kind == "i":
        word = random_.choice(
            ("+", "-", "*", "div", "mod", "shl", "shr", "and", "or", "xor", "neg", "abs", "sqr", "trunc", "round")
        )
    else:
        word = random_.choice(("+", "-", "*", "/", "neg", "abs", "sqr", "sqrt", "int", "frac", "sin", "whole"))
    if word == "whole":
        return tree(random_, "i", depth - 1)
    if word == "neg":
        return ("neg", tree(random_, kind, depth - 1))
    if word in ("abs", "sqr", "sqrt", "int", "frac", "sin", "trunc", "round"):
        inner = "d" if word in ("trunc", "round") else kind
        return ("call", word, tree(random_, inner, depth - 1))
    return (word, tree(random_, kind, depth - 1), tree(random_, kind, depth - 1))


def written(node: Tree, spare: random.Random) -> str:
    """The text, brackets round every part of more than one word; one round the whole now and then."""
    if node[0] == "lit":
        text = str(node[1]).lower() if isinstance(node[1], bool) else repr(node[1])
    elif node[0] == "call":
        text = f"{node[1]}({written(node[2], spare)})"
    elif node[0] in ("neg", "not"):
        text = f"({'-' if node[0] == 'neg' else 'not '}{written(node[1], spare)})"
    else:
        text = f"({written(node[1], spare)} {node[0]} {written(node[2], spare)})"
    return f"({text})" if spare.random() < 0.1 else text


def whole(value: float) -> float:
    if int(value) not in WHOLE:
        raise Fault
    return value


def value(node: Tree) -> Any:
    """The value of a tree: int, float or bool."""
    match node:
        case ("lit", found):
            return found
        case ("neg", operand):
            x = value(operand)
            return whole(-x) if isinstance(x, int) else -x
        case ("not", operand):
            return not value(operand)
        case ("call", name, operand):
            return called(name, value(operand))
    word, left, right = node
    x, y = value(left), value(right)
    if word in ("<", "<=", ">", ">=", "=", "<>"):
        return {"<": x < y, "<=": x <= y, ">": x > y, ">=": x >= y, "=": x == y, "<>": x != y}[word]
    if isinstance(x, bool):
        return {"and": x and y, "or": x or y, "xor": x != y}[word]
    if word in ("+", "-", "*"):
        found = {"+": x + y, "-": x - y, "*": x * y}[word]
        return whole(found) if isinstance(x, int) and isinstance(y, int) else found
    if word in ("/", "div", "mod") and y == 0:
        raise Fault
    if word == "/":
        return x / y
    return of_whole(word, x, y)


def of_whole(word: str, x: int, y: int) -> int:
    if word == "div":
        return int(whole(abs(x) // abs(y) * (1 if (x < 0) == (y < 0) else -1)))
    if word == "mod":
        if (x < 0 or y < 0) and x % y:
            raise Open
        return abs(x) % abs(y)
    if word in ("shl", "shr"):
        if y < 0:
            raise Fault
        if y > 31 or (word == "shr" and x < 0):
            raise Open
        return int(whole(x << y)) if word == "shl" else x >> y
    return {"and": x & y, "or": x | y, "xor": x ^ y}[word]


def called(name: str, x: Any) -> Any:
    if name == "boolean":
        return x != 0
    if name == "odd":
        return x % 2 == 1
    if name == "abs":
        return whole(abs(x)) if isinstance(x, int) else abs(x)
    if name == "sqr":
        return whole(x * x) if isinstance(x, int) else x * x
    if name == "sqrt":
        if x < 0:
            raise Fault
        return math.sqrt(x)
    if name == "sin":
        return math.sin(x)
    if name == "frac":
        return x - math.trunc(x)
    if name == "round":
        if abs(x) % 1 == 0.5:
            raise Open
        return int(whole(math.floor(x + 0.5)))
    return math.trunc(x) if name == "int" else int(whole(math.trunc(x)))


def run(tmp_path: Path, lines: list[str]) -> tuple[dict[int, Any], list[tuple[str, int]]]:
    """What CD600 and on hold behind the lines, and (code, line) of what was found."""
    job = tmp_path / "job.din"
    job.write_text("%\n" + "\n".join(lines) + "\nM30\n%\n")
    findings = Findings(limit=100_000)
    program = load_program(job, findings, din.machine())
    assert program is not None
    executor = begin(program, ZERO, din.machine(), findings)
    for _ in executor.chunks():
        pass
    return executor.modal.parameters, [(f.code.label, f.span.line) for f in findings.kept]


def wanted(node: Tree) -> Any:
    try:
        return value(node)
    except (Fault, Open) as error:
        return type(error)


@pytest.mark.parametrize("seed", range(2))
def test_values_of_random_expressions(tmp_path: Path, seed: int) -> None:
    random_ = random.Random(seed)
    for _ in range(25):
        trees = [(kind, tree(random_, kind, random_.randint(1, 4))) for kind in random_.choices("idb", k=25)]
        sure = [(kind, node, wanted(node)) for kind, node in trees]
        sure = [one for one in sure if one[2] not in (Fault, Open) and math.isfinite(one[2]) and abs(one[2]) < 1e300]
        lines = []
        for n, (kind, node, _) in enumerate(sure):
            text = written(node, random_)
            name = {"i": "CI", "d": "CD", "b": "CI"}[kind]
            lines.append(
                f"{name}{600 + n} := {text}"
                if kind != "b"
                else f"$if {text} then CI{600 + n} := 1 else CI{600 + n} := 0;"
            )
        held, found = run(tmp_path, lines)
        errors = [(code, line) for code, line in found if code in ("GP228", "GP135", "GP101", "GP107")]
        assert errors == [], [lines[line - 2] for _, line in errors]
        for n, (kind, _, right) in enumerate(sure):
            made = held[600 + n + (0 if kind == "d" else 1000)]
            assert isinstance(made, float), (lines[n], made)
            assert made == right or math.isclose(made, right, rel_tol=SHARP), (lines[n], made, right)


@pytest.mark.parametrize("seed", range(2))
def test_what_has_no_value_or_an_open_one(tmp_path: Path, seed: int) -> None:
    random_ = random.Random(100 + seed)
    done = 0
    while done < 25:
        kind = random_.choice("id")
        node = tree(random_, kind, random_.randint(1, 3))
        right = wanted(node)
        if right not in (Fault, Open):
            continue
        done += 1
        text = written(node, random_)
        held, found = run(tmp_path, [f"{'CI' if kind == 'i' else 'CD'}600 := {text}"])
        if right is Fault:
            assert [code for code, _ in found] == ["GP228"], text
            continue
        made = held[1600 if kind == "i" else 600] if found == [] else Unknown("")
        assert isinstance(made, Unknown) or {code for code, _ in found} <= {"GP228", "GP299"}, (text, made)


def plain(node: Tree, way: dict[str, bool]) -> bool:
    match node:
        case ("var", name):
            return way[name]
        case ("not", operand):
            return not plain(operand, way)
        case (word, left, right):
            x, y = plain(left, way), plain(right, way)
            return {"and": x and y, "or": x or y, "xor": x != y}[word]
    raise AssertionError


def condition(random_: random.Random, depth: int) -> Tree:
    if depth == 0:
        return ("var", random_.choice("pqr"))
    word = random_.choice(("and", "or", "xor", "not"))
    if word == "not":
        return ("not", condition(random_, depth - 1))
    return (word, condition(random_, depth - 1), condition(random_, random_.randrange(depth)))


def bare(node: Tree, above: int = 0) -> str:
    """With those brackets only that Pascal's precedence asks for: not, then and, then or and xor."""
    match node:
        case ("var", name):
            return str(name)
        case ("not", operand):
            return f"not {bare(operand, 3)}"
        case (word, left, right):
            level = 2 if word == "and" else 1
            text = f"{bare(left, level)} {word} {bare(right, level + 1)}"
            return f"({text})" if level < above else text
    raise AssertionError


@pytest.mark.parametrize("seed", range(2))
def test_conditions_by_the_precedence_of_pascal(tmp_path: Path, seed: int) -> None:
    random_ = random.Random(seed)
    for _ in range(20):
        way = {name: random_.random() < 0.5 for name in "pqr"}
        trees = [condition(random_, random_.randint(1, 4)) for _ in range(20)]
        head = ["$DINEND", "var p, q, r : boolean;", "{$DINSTART}"]
        head += [f"{name} := {str(on).lower()}" for name, on in way.items()]
        lines = [f"$if {bare(node)} then CI{600 + n} := 1 else CI{600 + n} := 0;" for n, node in enumerate(trees)]
        held, found = run(tmp_path, head + lines)
        assert [code for code, _ in found if code != "GP150"] == []
        for n, node in enumerate(trees):
            assert held[1600 + n] == plain(node, way), (lines[n], way)


def program_text(random_: random.Random, depth: int = 2) -> list[Any]:
    """Statements: a text, or (times from, to, down, body), or (name of a procedure, arguments)."""
    found: list[Any] = []
    for _ in range(random_.randint(1, 3)):
        way = random_.random()
        if way < 0.4 or depth == 0:
            number = random_.choice((1, 2, 3))
            found.append(f"CI{610 + number} := CI{610 + random_.choice((1, 2, 3))} + {random_.randint(-3, 9)}")
        elif way < 0.7:
            first = random_.randint(-2, 3)
            found.append(
                ("for", first, first + random_.randint(-2, 3), random_.random() < 0.3, program_text(random_, depth - 1))
            )
        else:
            found.append(("call", random_.randint(-5, 5), random_.choice((1, 2, 3))))
        if random_.random() < 0.4:
            found.append("G00 X(CI611) Y(CI612) Z(CI613)")
    return found


def looped(items: list[Any], depth: int = 0) -> list[str]:
    """With loops and calls."""
    lines: list[str] = []
    for item in items:
        if isinstance(item, str):
            lines.append(item)
        elif item[0] == "for":
            _, first, last, down, body = item
            if down:
                first, last = last, first
            lines.append(f"$for CI{620 + depth} := {first} {'downto' if down else 'to'} {last} do begin")
            lines += [*looped(body, depth + 1), f"CI614 := CI614 + CI{620 + depth}", "$end;"]
        else:
            lines.append(f"$change({item[1]} + 0, CI{610 + item[2]});")
    return lines


def unrolled(items: list[Any]) -> list[str]:
    """Without: each pass and each call written out."""
    lines: list[str] = []
    for item in items:
        if isinstance(item, str):
            lines.append(item)
        elif item[0] == "for":
            _, first, last, down, body = item
            passes = range(last, first - 1, -1) if down else range(first, last + 1)
            for n in passes:
                lines += [*unrolled(body), f"CI614 := CI614 + {n}"]
        else:
            lines += [f"CI615 := {item[1]} * 2", f"CI{610 + item[2]} := CI{610 + item[2]} - CI615 - 1"]
    return lines


HEAD = [
    "$DINEND", "procedure change(by : integer; var what : integer);", "begin", "by := by * 2;", "CI615 := by;",
    "what := what - by - 1;", "end;", "{$DINSTART}", "%MAIN", "G90", "CI611 := 1", "CI612 := 2", "CI613 := 3",
    "CI614 := 0", "CI615 := 0",
]  # fmt: skip


@pytest.mark.parametrize("seed", range(2))
def test_loops_and_calls_are_what_they_are_written_out(tmp_path: Path, seed: int) -> None:
    random_ = random.Random(seed)
    for _ in range(12):
        items = program_text(random_, 3)
        both = []
        for lines in (looped(items), unrolled(items)):
            job = tmp_path / "job.din"
            job.write_text("\n".join([*HEAD, *lines, "G00 X(CI611) Y(CI612) Z(CI613) A(CI614)", "M30", "%"]))
            findings = Findings()
            program = load_program(job, findings, din.machine())
            assert program is not None
            executor = begin(program, ZERO, din.machine(), findings)
            rows = [tuple(row) for chunk in executor.chunks() for row in chunk.rows["to"].tolist()]
            assert [f.message for f in findings.kept if f.code.label not in ("GP519",)] == [], lines
            both.append(
                ([row for n, row in enumerate(rows) if n == 0 or row != rows[n - 1]], executor.modal.parameters[1615])
            )
        assert both[0] == both[1], looped(items)


def test_the_variable_of_a_loop_behind_it_is_told_once_a_place(tmp_path: Path) -> None:
    loop = ["$for CI600 := 1 to 3 do begin", "G00 X(CI600)", "$end;"]
    around = ["$for CI602 := 1 to 2 do begin", *loop, "CI601 := CI600", "CI603 := CI601", "$end;"]
    assert run(tmp_path, around)[1] == [("GP149", 6)]
    assert run(tmp_path, [*loop, "CI600 := 5", "CI601 := CI600"])[1] == []
    jumped = ["$for CI600 := 1 to 3 do begin", "$if (CI600 = 2) then goto out;", "$end;", "L5", "CI601 := CI600"]
    held, found = run(tmp_path, [line.replace("goto out;", "begin\nM96 L5\n$end") for line in jumped])
    assert (held[1601], found) == (2.0, [])
