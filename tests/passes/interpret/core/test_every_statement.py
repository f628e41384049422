"""No statement is passed over because the executor does not know it."""

from __future__ import annotations

import dataclasses
from typing import Any, get_args

import pytest

from gproof.driver.running import execute
from gproof.ir.dialects import rules_named
from gproof.ir.finding import Findings, Span
from gproof.ir.machine import NO_MACHINE
from gproof.ir.program import (
    STATEMENTS,
    Array,
    Block,
    BlockTable,
    Call,
    Declare,
    DeferredBlock,
    Definition,
    Device,
    For,
    Guard,
    If,
    Include,
    Jump,
    Label,
    Message,
    Mistake,
    Mode,
    Number,
    Program,
    Repeat,
    Replaced,
    Return,
    SourceFile,
    Statement,
    Unsupported,
    Variable,
    While,
)
from gproof.ir.setup import ZERO as ZERO_SETUP

AT = Span("job", 1)
ZERO = Number(value=0.0, span=AT)
ONE = Number(value=1.0, span=AT)
HASH = Variable(number=ONE, span=AT)
TOLD = Mistake(code=101, message="inside", span=AT, text="inside")
EMPTY = Block(words=(), assigns=(), span=AT)

EXAMPLES: dict[type, tuple[Statement, set[int]]] = {
    # an example of each, and what running it tells; nothing for those that do nothing, or nothing by themselves
    Block: (EMPTY, set()),
    DeferredBlock: (DeferredBlock(lambda raw, file, line: EMPTY, b"", "job", 1), set()),
    BlockTable: (BlockTable(file=0, first_line=1, last_line=1, begin=0, end=0), set()),
    If: (If(condition=ZERO, then=(), otherwise=(TOLD,), span=AT), {101}),
    While: (While(condition=ZERO, body=(TOLD,), span=AT), set()),
    Repeat: (Repeat(condition=ONE, body=(TOLD,), span=AT), {101}),
    For: (For(variable=HASH, first=ZERO, last=ZERO, down=False, body=(TOLD,), span=AT), {101}),
    Array: (Array(words=(), body=(TOLD,), span=AT), {101}),
    Replaced: (Replaced(written="X", body=(TOLD,), span=AT), {101}),
    Definition: (Definition(name="X", label="X", written="", span=AT), {113}),
    Call: (Call(name="none", span=AT), {115}),
    Label: (Label(name="a", span=AT), set()),
    Jump: (Jump(name="none", span=AT), {113}),
    Return: (Return(span=AT), {113}),
    Declare: (Declare(kind="var", names=("a",), span=AT), set()),
    Include: (Include(name="a", span=AT), set()),
    Mode: (Mode(name="din", span=AT), set()),
    Message: (Message(kind="error", parts=(), span=AT), {245}),
    Guard: (Guard(name="machine_area", on=False, span=AT), set()),
    Device: (Device(name="home", arguments=(), span=AT), {295}),
    Unsupported: (Unsupported(what="X", span=AT), {113}),
    Mistake: (TOLD, {101}),
}


def told(node: Statement) -> set[int]:
    findings = Findings()
    files = [SourceFile(name="job", data=b"", sha256="", line_count=1)]
    # Arrays are WinCNC's alone; all other statements run in RS274NGC too.
    name = "wincnc" if isinstance(node, Array) else "eding"
    program = Program(dialect=name, rules=rules_named(name), files=files, body=(node,), line_count=1)
    execute(program, ZERO_SETUP, NO_MACHINE, findings)
    return set(findings.counts)


def test_there_is_an_example_of_every_statement() -> None:
    assert set(EXAMPLES) == STATEMENTS == {*get_args(Statement), DeferredBlock}


@pytest.mark.parametrize("kind", sorted(STATEMENTS, key=str), ids=lambda kind: kind.__name__)
def test_every_statement_is_run(kind: type) -> None:
    node, expected = EXAMPLES[kind]
    assert told(node) == expected


@dataclasses.dataclass(frozen=True)
class New:
    """A statement that nobody has taught the executor."""

    span: Span = AT


def test_what_the_executor_does_not_know_is_not_passed_over() -> None:
    new: Any = New()
    assert told(new) == {113}
    program = Program(dialect="eding", rules=rules_named("eding"), body=(new,))
    with pytest.raises(ValueError, match="New is not a statement"):
        program.verify()
