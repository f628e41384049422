"""Lines that are read without the grammar: exactly what the grammar gives, and nearly every correct line of theirs."""

from __future__ import annotations

import itertools
import random
import re

import pytest
from frontend.eding.programs import without_places
from frontend.eding.test_line_cache import Grammar, outcome, valid_line, varied
from frontend.eding.test_random import random_line
from frontend.eding.test_tolerance import SAME
from support.campaigns import seeds
from support.each import each

from gproof.frontend.eding import line_cache as shapes
from gproof.frontend.eding.build import Structural
from gproof.frontend.eding.fast_reader import DEEPEST, read_line
from gproof.frontend.eding.line_cache import Reader
from gproof.frontend.eding.parse import parse_line
from gproof.frontend.eding.prepare import FUNCTIONS
from gproof.ir.dialects.eding.operators import LEVEL
from gproof.ir.program import Block

LETTERS = "abcdefghijklmnopqrstuvwxyzGXYZNK"
NUMBERS = ["0", "7", "42", "1.", ".5", "0.25", "00012.50", "99999", "123456", "1 0", "1. 5", "-3", "+ 4", "."]
TOKENS = [
    *LETTERS, *NUMBERS, *LEVEL, *FUNCTIONS, *"#[]=()/;%-+", "(c)", "( MSG)", "(a;b[1)", "(\t)", "()", ";d",
    "; e (f", '"', "“t”", "if", "IF[", "then", "while", "else", "e nd", "in", "xor", "ſ", "K", "é",
    "\u2028", "\x85", "²", "٣",
]  # fmt: skip
BLANKS = ["", "", "", "", " ", "\t", "  ", " \t "]


def tokens_in_a_row(rng: random.Random) -> str:
    """Pieces of the language in no order at all: nearly all of it mistakes."""
    return "".join(rng.choice(TOKENS) + rng.choice(BLANKS) for _ in range(rng.randint(1, 9)))


def values(rng: random.Random, depth: int) -> str:
    """A real value: correct but for what blanks inside of numbers and names make of it."""
    blank = rng.choice(BLANKS)
    form = rng.randrange(9) if depth else rng.randrange(3)
    if form < 2:
        return rng.choice(NUMBERS[:8])
    if form == 2:
        return f"#{blank}{rng.choice(NUMBERS[:9])}"
    inner = values(rng, depth - 1)
    if form == 3:
        return f"{rng.choice('+-')}{blank}{inner}"
    if form == 4:
        return f"#{blank}{inner}"
    if form == 5:
        name = rng.choice(sorted(FUNCTIONS - {"atan"}))
        return f"{rng.choice([name, name.upper()])}{blank}[{inner}]"
    if form == 6:
        return f"aTan{blank}[{inner}]{blank}/{rng.choice(BLANKS)}[{values(rng, depth - 1)}]"
    parts = [inner]
    for _ in range(rng.randint(0, 4)):
        operator = rng.choice(list(LEVEL))
        parts += [rng.choice([operator, operator.upper()]), values(rng, depth - 1)]
    return "[" + rng.choice(BLANKS).join(parts) + rng.choice(["]", " ]", "\t]"])


def lines_of_values(rng: random.Random) -> str:
    """A line of words, settings and comments, or a condition."""
    blank = rng.choice(BLANKS)
    if rng.random() < 0.2:
        keyword = rng.choice(["if", "while", "If", "WHILE"])
        behind = rng.choice(["", "", "then", " THEN (c)", " (c) ", ";x", "(a)(b) ;c", " then ; d", "(c) then"])
        ahead = rng.choice(["", "", "N10", "(c)", "n 5 (c) (d)", "/"])
        return f"{blank}{ahead}{blank}{keyword}{blank}[{values(rng, 2)}]{blank}{behind}"
    items = [rng.choice(["", "", "", "/", "N10", "/ n 5", "N1 0", "n123456", "N"])]
    for _ in range(rng.randint(1, 5)):
        form = rng.random()
        if form < 0.65:
            items.append(rng.choice("GXYZFxyzijPqSt") + rng.choice(BLANKS) + values(rng, rng.randint(0, 3)))
        elif form < 0.85:
            items.append(f"#{rng.choice(BLANKS)}{values(rng, rng.randint(0, 1))}{blank}={blank}{values(rng, 2)}")
        else:
            items.append(rng.choice(["(c)", "( a b )", "()", "(é\t)", '(")', "(;)", "(msg)", "(msg, hi)"]))
    items.append(rng.choice(["", "", ";", "; c ", " ", "\t", ";(MSG, x)", ";\u2028 y"]))
    return rng.choice(BLANKS).join(items)


def slipped(rng: random.Random, line: str) -> str:
    """The line after a slip of the fingers or two."""
    for _ in range(rng.randint(1, 2)):
        at = rng.randint(0, len(line))
        line = line[:at] + rng.choice(["", *TOKENS, *BLANKS]) + line[at + rng.randint(0, 2) :]
    return line


MAKERS = [
    tokens_in_a_row,
    lines_of_values,
    lambda rng: slipped(rng, lines_of_values(rng)),
    lambda rng: slipped(rng, valid_line(rng)),
    lambda rng: varied(rng, rng.choice([random_line, valid_line])(rng)),
    lambda rng: slipped(rng, rng.choice(SAME)[0]),
]


def differences(seed: int, count: int) -> list[str]:
    """Of so many random lines those that a reader, or ``read_line``, reads otherwise than the grammar."""
    rng = random.Random(seed)
    found = []
    for number in range(1, count):
        line = rng.choice(MAKERS)(rng)
        expected = outcome(parse_line, line, number)
        readers = (Reader(), Reader(held=0))
        if any(outcome(reader.read, line, number) != expected for reader in readers):
            found.append(line)
    return found


@pytest.mark.parametrize("seed", seeds(3, 6))
def test_lines_read_directly_are_what_the_grammar_gives(seed: int) -> None:
    assert differences(seed, 1000) == []


@pytest.mark.soak
@pytest.mark.parametrize("seed", range(100, 110))
def test_soak(seed: int) -> None:
    assert differences(seed, 20_000) == []


@pytest.mark.parametrize("seed", range(4))
def test_correct_lines_are_read_directly(seed: int) -> None:
    """All of them but numbers, line numbers and slashes that are left to the grammar on purpose."""
    rng = random.Random(seed)
    directly = 0
    for number in range(400):
        line = lines_of_values(rng)
        expected = outcome(parse_line, line, number)
        left = re.search(r"[0-9.][ \t]+[0-9.]|msg,|^[ \t]*/.*(if|while)", line, re.IGNORECASE)
        single = isinstance(expected, list) and len(expected) == 1
        if left or not single:
            continue
        assert isinstance(expected[0], Block | Structural)
        assert read_line(line, "job.cnc", number) == tuple(expected), line
        directly += 1
    assert directly > 100


def test_every_operator_and_function_is_read_directly() -> None:
    shown = [f"x[#1 {operator} -2.5{operator}[3]]" for operator in LEVEL]
    shown += [f"x{name}[#1]" for name in sorted(FUNCTIONS - {"atan"})] + ["x atan [1] / [ #2 ]"]
    for line in [*shown, *map(str.upper, shown)]:
        assert read_line(line, "job.cnc", 3) == tuple(parse_line(line.encode(), "job.cnc", 3)), line


@each("operator,other", list(itertools.product(LEVEL, LEVEL)))
def test_operators_group_alike(operator: str, other: str) -> None:
    """Beside each other, with signs before what they take: by the table, doubts included."""
    for line in (f"x[1{operator}#2 {other} 3]", f"#1=[-#1{operator}-#2{other}-[3]{operator}4]"):
        assert read_line(line, "job.cnc", 3) == tuple(parse_line(line.encode(), "job.cnc", 3)), line


@pytest.mark.parametrize("piece", ["[", "#", "-[", "abs[", "1+["])
def test_depth_is_no_matter(piece: str) -> None:
    for depth in (1, DEEPEST - 2, DEEPEST, DEEPEST + 1, 90):
        line = "x" + piece * depth + "1" + "]" * (depth if "[" in piece else 0)
        assert outcome(Reader().read, line, 3) == outcome(parse_line, line, 3), line


def test_lines_whose_shapes_never_repeat_go_without_the_grammar(monkeypatch: pytest.MonkeyPatch) -> None:
    lines = ["x[" + "+".join(["#1"] * n) + "]" for n in range(1, 30)] + [f"#1=[2]{' ' * n}g1" for n in range(30)]
    expected = [parse_line(line.encode(), "job.cnc", 4) for line in lines]
    monkeypatch.setattr(shapes, "parse_line", None)
    reader = Reader()
    assert [list(reader.read(line.encode(), "job.cnc", 4)) for line in lines] == expected
    deferring = Reader(held=0)
    assert [list(deferring.read(line.encode(), "job.cnc", 4)) for line in lines] == expected


def test_places_are_the_only_difference_that_blanks_make() -> None:
    close, wide = "n10g1x-#1y[#2*3]#4=5(c)", "n10 g 1 x - # 1 y [ # 2 * 3 ] # 4 = 5 (c)"
    assert without_places(read_line(close, "j", 1)) == without_places(read_line(wide, "j", 1))
    assert read_line(wide, "j", 1) == tuple(Grammar().read(wide.encode(), "j", 1))
