"""Invariants of a Program, and which two Programs are the same."""

from __future__ import annotations

import dataclasses
from typing import Any

import pytest

from gproof.ir import program as p
from gproof.ir.columns import Columns
from gproof.ir.dialects import rules_named
from gproof.ir.finding import Span
from gproof.ir.notes import NOTE, Notes
from gproof.ir.same import difference


def at(line: int) -> Span:
    return Span("job", line, 1, 2)


def number(value: float) -> p.Number:
    return p.Number(value, at(1))


COUNTER = p.Variable(number(1600.0), at(1))


def program(*body: Any, **subprograms: p.Subprogram) -> p.Program:
    file = p.SourceFile(name="job", sha256="", line_count=9, notes=Notes(Columns(NOTE), b""))
    return p.Program(
        dialect="eding", rules=rules_named("eding"), files=[file], body=body, subprograms=subprograms, line_count=9
    )


def loop(*body: Any, variable: p.Variable = COUNTER) -> p.For:
    return p.For(variable=variable, first=number(1.0), last=number(3.0), down=False, body=body, span=at(2))


def label(name: str) -> p.Label:
    return p.Label(name=name, span=at(3))


def jump(name: str) -> p.Jump:
    return p.Jump(name=name, span=at(4))


def sub(*body: Any, **fields: Any) -> p.Subprogram:
    return p.Subprogram(name="sub", body=body, span=at(5), **fields)


SOUND = [
    program(label("1"), jump("1")),
    program(jump("1"), label("1")),
    program(label("1"), loop(jump("1"), label("2"), loop(jump("2"), jump("1")))),
    program(p.Repeat(condition=number(1.0), body=(label("1"), jump("1")), span=at(1))),
    program(sub=sub(label("1"), jump("1"))),
    program(sub=sub(parameters=(("a", "double", 2000), ("b", "var integer", 2001)))),
    program(p.Declare(kind="const", names=("a",), span=at(1), value=number(1.0))),
    program(p.Declare(kind="var", names=("a", "b"), span=at(1), type="double"), p.Mode(name="din", span=at(2))),
]
BROKEN = [
    program(jump("1")),
    program(loop(label("1")), jump("1")),
    program(loop(jump("1"))),
    program(label("1"), sub=sub(jump("1"))),
    program(sub=sub(p.While(condition=number(1.0), body=(jump("1"),), span=at(1)))),
    program(p.If(condition=number(1.0), then=(label("1"),), otherwise=(jump("1"),), span=at(1))),
    program(loop(variable=p.Variable(COUNTER, at(1)))),
    program(p.Declare(kind="type", names=("a",), span=at(1))),
    program(p.Declare(kind="var", names=(), span=at(1))),
    program(p.Declare(kind="const", names=("a",), span=at(1))),
    program(p.Declare(kind="var", names=("a",), span=at(1), value=number(1.0))),
    program(p.Mode(name="basic", span=at(1))),
    program(p.Repeat(condition=number(1.0), body=(p.Mode(name="", span=at(1)),), span=at(1))),
    program(sub=sub(parameters=(("a", "real", 2000),))),
]


@pytest.mark.parametrize("one", SOUND)
def test_sound_programs(one: p.Program) -> None:
    one.verify()
    assert difference(one, one) is None


@pytest.mark.parametrize("one", BROKEN)
def test_broken_programs_are_refused(one: p.Program) -> None:
    with pytest.raises(ValueError):
        one.verify()


NODES = [
    (loop(), {"down": True, "first": number(2.0), "body": (jump("1"),), "end_span": at(9), "span": at(7)}),
    (label("1"), {"name": "2", "span": at(7)}),
    (jump("1"), {"name": "2", "span": at(7)}),
    (p.Return(span=at(1), code="M17"), {"code": "M017", "span": at(7)}),
    (p.Include(name="a.inc", span=at(1)), {"name": "b.inc", "span": at(7)}),
    (p.Mode(name="din", span=at(1)), {"name": "pascal"}),
    (p.Declare(kind="var", names=("a",), span=at(1), type="double"), {"names": ("b",), "type": "x", "kind": "label"}),
    (p.Call(name="1", span=at(1), count=number(2.0)), {"count": None, "text": "x"}),
    (p.Repeat(condition=number(1.0), body=(), span=at(1)), {"condition": number(-0.0), "end_span": at(2)}),
    (p.Block(words=(), assigns=(p.Assign(COUNTER, number(1.0), at(1)),), span=at(1)), {
        "continued": "G1", "assigns": (p.Assign(dataclasses.replace(COUNTER, name="k"), number(1.0), at(1)),),
        "words": (p.Word(p.PARAMETER, number(1.0), at(1)),),
    }),
    (p.Message(kind="write", parts=(p.Constant("pi", 3.0, at(1)),), span=at(1)), {
        "kind": "writeln", "parts": (p.Constant("Pi", 3.0, at(1)),), "deleted": True,
    }),
]  # fmt: skip


@pytest.mark.parametrize(("node", "changes"), NODES, ids=lambda one: type(one).__name__)
def test_every_field_makes_a_difference(node: Any, changes: dict[str, Any]) -> None:
    for name, value in changes.items():
        other = dataclasses.replace(node, **{name: value})
        assert difference(program(node), program(other)) is not None, name
        assert difference(program(node), program(dataclasses.replace(node))) is None


def test_what_a_table_goes_on_with_makes_a_difference() -> None:
    tables = [
        p.BlockTable(file=0, first_line=1, last_line=2, begin=0, end=0, words=Columns(p.WORD), continued=code)
        for code in ("G1", "G0")
    ]
    assert difference(program(tables[0]), program(tables[1])) is not None
    assert difference(program(tables[0]), program(tables[0])) is None


def test_columns_make_none() -> None:
    assert difference(program(label("1")), program(p.Label(name="1", span=Span("job", 3, 7, 9)))) is None


def test_modules_and_procedures_are_told_apart() -> None:
    for fields in ({"is_module": True}, {"parameters": (("a", "double", 2000),)}, {"text": "Sub"}):
        assert difference(program(sub=sub()), program(sub=sub(**fields))) is not None
