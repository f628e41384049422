"""A reader gives exactly what the grammar gives, for lines and shapes that were met before too."""

from __future__ import annotations

import copy
import functools
import random
import re
from pathlib import Path
from typing import Any

import pytest
from frontend.eding.programs import load, program_of
from frontend.eding.test_random import random_line, random_program
from frontend.eding.test_tolerance import SAME
from support.campaigns import seeds

from gproof.frontend.eding import line_cache as shapes
from gproof.frontend.eding import load as loading
from gproof.frontend.eding.line_cache import Reader
from gproof.frontend.eding.parse import parse_line
from gproof.frontend.eding.prepare import LineError
from gproof.ir.program import Block, DeferredBlock
from gproof.ir.text import print_ir

NUMBERS = ["0", "1", "7", "42", "100000", "123456", "1.", ".5", "0.25", "3.75000", "00012.50", "99999999999999999999.5"]
COMMENTS = ["", " ", "\t", "a", " a b ", "MSG, hi", " m sg , x", "N10", '"', "12", ";", "[", "\ue000", "é", "%", "msg"]


def outcome(read: Any, line: str, number: int) -> Any:
    """What reading a line gives: its statements, or all of its mistake."""
    try:
        return list(read(line.encode(), "job.cnc", number))
    except LineError as error:
        return (error.code, error.begin, error.end, error.structure, error.values)


def varied(rng: random.Random, line: str) -> str:
    """The same line with other numbers and comments."""
    line = re.sub(r"[0-9.]+", lambda found: rng.choice([*NUMBERS, found.group()]), line)
    return re.sub(r"(?<=\()[^()]*(?=\))|(?<=;).*", lambda found: rng.choice([*COMMENTS, found.group()]), line)


def value(rng: random.Random, depth: int) -> str:
    if depth == 0 or rng.random() < 0.3:
        return rng.choice(["", "", "-", "+", "- "]) + rng.choice(NUMBERS)
    inner = functools.partial(value, rng, depth - 1)
    form = rng.randrange(6)
    if form == 0:
        return f"#{inner()}"
    if form == 1:
        return f"-#{rng.choice(NUMBERS)}"
    if form == 2:
        return f"{rng.choice(['sin', 'ABS', 'sqrt ', 'not'])}[{inner()}]"
    if form == 3:
        return f"atan[{inner()}]/[{inner()}]"
    blank = rng.choice(["", " ", "\t"])
    operator = rng.choice(["+", "-", "*", "/", " mod ", "**", " AND ", "<", "==", "<<", "band"])
    return f"[{inner()}{blank}{operator}{blank}{inner()}]"


def valid_line(rng: random.Random) -> str:
    """A line that the grammar mostly accepts: words, settings, comments, conditions."""
    if rng.random() < 0.15:
        return f"{rng.choice(['if', 'while', 'IF '])}[{value(rng, 2)}]{rng.choice(['', ' ;', ' (c)'])}"
    items = [rng.choice(["", "", "/", "N10 ", "/ n 5", "N1 0 "])]
    for _ in range(rng.randint(1, 5)):
        form = rng.random()
        if form < 0.6:
            items.append(rng.choice("GXYZFxyzij") + rng.choice(["", " "]) + value(rng, rng.randint(0, 3)))
        elif form < 0.8:
            items.append(f"#{rng.choice(NUMBERS)} = {value(rng, 2)}")
        else:
            items.append(f"({rng.choice(COMMENTS)})")
    items.append(rng.choice(["", "", ";", f";{rng.choice(COMMENTS)}", "  "]))
    return rng.choice(["", " "]).join(items)


@pytest.mark.parametrize("seed", seeds(4, 12))
def test_a_reader_gives_what_the_grammar_gives(seed: int) -> None:
    rng = random.Random(seed)
    makers = [valid_line, random_line, lambda rng: rng.choice(SAME)[0]]
    lines = [rng.choice(makers)(rng) for _ in range(40)]
    readers = [Reader(), Reader(held=0)]
    for number in range(1, 400):
        line = varied(rng, rng.choice(lines))
        expected = outcome(parse_line, line, number)
        for reader in readers:
            assert outcome(reader.read, line, number) == expected, (seed, line)
    assert not readers[0]._shapes
    assert len(readers[1]._shapes) > 5
    assert len(readers[1]._lines) > 2


@pytest.mark.parametrize("seed", seeds(3, 6))
def test_whole_programs_are_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, seed: int) -> None:
    """Each program with its lines four times over: deferred, held, and with the grammar alone."""
    rng = random.Random(seed)
    for _ in range(10):
        data = b"\n".join([random_program(rng)] * 4)
        found = []
        for reader in (Reader, functools.partial(Reader, held=0), Grammar):
            monkeypatch.setattr(loading, "Reader", reader)
            program, findings = load(tmp_path, data)
            found.append((print_ir(program) if program is not None else "", findings.kept, findings.counts))
        assert found[0] == found[1] == found[2], data


class Grammar:
    """Reads every line with the grammar."""

    def read(self, raw: bytes, file: str, number: int) -> Any:
        return parse_line(raw, file, number)


SHAPED = [
    "G1 X[#1+{}] Y[#2*-{}] F{}",
    "N{} #3 = [#3 + {}] (pass {})",
    "/x-#{} ; step {}",
    "if [#1 == {}] then",
    "while[#{}<{}] ;c",
    "g1 x#1 y-{}",
    "m6t[#{}]",
]


@pytest.mark.parametrize("form", SHAPED)
def test_expressions_go_without_the_grammar(monkeypatch: pytest.MonkeyPatch, form: str) -> None:
    lines = [form.format(*(NUMBERS[(k + n) % 4] for n in range(3))) for k in range(20)]
    expected = [parse_line(line.encode(), "job.cnc", 4) for line in lines]
    monkeypatch.setattr(shapes, "parse_line", None)
    for held in (100, 0):
        reader = Reader(held)
        assert [list(reader.read(line.encode(), "job.cnc", 4)) for line in lines] == expected


@pytest.mark.parametrize("form", SHAPED[:3] + SHAPED[5:])
def test_blocks_of_a_known_shape_are_read_when_they_run(monkeypatch: pytest.MonkeyPatch, form: str) -> None:
    lines = [form.format(*(NUMBERS[(k + n) % 4] for n in range(3))) for k in range(20)]
    expected = [parse_line(line.encode(), "job.cnc", 4) for line in lines]
    reader = Reader(held=0)
    reader.read(lines[0].encode(), "job.cnc", 1)
    with monkeypatch.context() as only_here:
        only_here.setattr(shapes, "parse_line", None)
        only_here.setattr(shapes, "read_line", None)
        found = [reader.read(line.encode(), "job.cnc", 4) for line in lines]
    assert {type(node) for (node,) in found} == {DeferredBlock}
    assert [list(nodes) for nodes in found] == expected


@pytest.mark.parametrize("number", ["123456", "1.5", ".5", "1.", "1 2 3 4 5 6"])
def test_a_known_shape_with_a_wrong_line_number_is_a_mistake(number: str) -> None:
    for before in ("N", "/n ", " N  "):
        reader = Reader(held=0)
        reader.read(f"{before}12345x#1".encode(), "job.cnc", 1)
        line = f"{before}{number}x#1"
        expected = outcome(parse_line, line, 2)
        assert isinstance(expected, tuple)
        assert outcome(reader.read, line, 2) == expected


def test_a_comment_full_of_brackets_changes_no_shape() -> None:
    reader = Reader(held=0)
    for comment in ("a", "[#" * 100, "a"):
        line = f"x[#1+2] ({comment})"
        assert outcome(reader.read, line, 2) == outcome(parse_line, line, 2)


@pytest.mark.parametrize(
    "line", ["endif", "gosub part1", 'msg "at 5: "#1', "else ; 12", "TCAGuard off", 'dlgmsg "a" b 100', "x 1 0 y#1"]
)
def test_other_lines_are_kept_letter_by_letter(monkeypatch: pytest.MonkeyPatch, line: str) -> None:
    expected = parse_line(line.encode(), "job.cnc", 9)
    reader = Reader()
    for _ in range(4):
        reader.read(line.encode(), "job.cnc", 1)
    monkeypatch.setattr(shapes, "parse_line", None)
    assert list(reader.read(line.encode(), "job.cnc", 9)) == expected


def test_a_reader_that_is_full_starts_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shapes, "KEPT_SHAPES", 3)
    monkeypatch.setattr(shapes, "KEPT_LINES", 3)
    reader = Reader(held=5)
    for number in range(1, 60):
        line = (
            f"x#{number} " + "y#1 " * (number % 7) + "(c)" * (number % 2) if number % 3 else f"gosub part{number % 5}"
        )
        assert list(reader.read(line.encode(), "job.cnc", number)) == parse_line(line.encode(), "job.cnc", number)
        assert len(reader._shapes) <= 3
        assert len(reader._lines) <= 3


def test_a_deferred_block_is_its_block() -> None:
    reader = Reader(held=0)
    line = b"/N5 G1 X[#1 + 2.5] #3=-4 (c)"
    found = [reader.read(line, "job.cnc", number)[0] for number in (1, 2, 7, 8)]
    (expected,) = parse_line(line, "job.cnc", 7)
    deferred = found[2]
    assert isinstance(deferred, DeferredBlock)
    assert isinstance(deferred, Block)
    assert deferred == expected
    assert expected == deferred
    assert deferred == reader.read(line, "job.cnc", 7)[0]
    assert deferred != found[3]
    assert hash(deferred) == hash(expected)
    assert print_ir(deferred) == print_ir(expected)
    for same in (copy.copy(deferred), copy.deepcopy(deferred)):
        assert same == expected
    assert (deferred.words, deferred.assigns, deferred.span) == (expected.words, expected.assigns, expected.span)
    with pytest.raises(AttributeError):
        deferred.nothing  # noqa: B018


def test_lines_beyond_those_held_run_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    lines = [f"g1 x[#1 + {n}.5] f[100 + {n}]" for n in range(40)]
    text = "\n".join(["#1=3", "while [#1 < 5]", *lines, "#1=[#1 + 1]", "endwhile", "m30"])
    held = program_of(tmp_path, text)
    monkeypatch.setattr(loading, "Reader", functools.partial(Reader, held=5))
    deferred = program_of(tmp_path, text)
    kinds = [type(node) for node in deferred.body[1].body]  # type: ignore[union-attr]
    assert kinds.count(DeferredBlock) > 30
    assert deferred == held
    assert print_ir(deferred) == print_ir(held)
