"""Loading small McuWIN programs in tests."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

from gproof.frontend.mcuwin.load import load_program
from gproof.frontend.mcuwin.machine import NO_MCUWIN
from gproof.ir.dialects.mcuwin.settings import NO_MCUWIN_SETTINGS
from gproof.ir.finding import Findings
from gproof.ir.machine import Machine
from gproof.ir.program import (
    Block,
    BlockTable,
    Call,
    Constant,
    Expr,
    For,
    If,
    Input,
    Jump,
    Label,
    Message,
    Mode,
    Named,
    Number,
    Program,
    Repeat,
    Return,
    Statement,
    Text,
    Unary,
    Variable,
    While,
)


def machine(**din: Any) -> Machine:
    """Six axes of which nothing is known, with these settings of ``[din]``."""
    return dataclasses.replace(NO_MCUWIN, settings=dataclasses.replace(NO_MCUWIN_SETTINGS, **din))


OLD = machine(version="2.5.3.32")


def load(
    folder: Path, text: str | bytes, on: Machine = NO_MCUWIN, *, tables: bool = True, name: str = "job.din"
) -> tuple[Program | None, Findings]:
    """The program in a file of that content, with findings without a cap."""
    path = folder / name
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    findings = Findings(limit=100_000)
    program = load_program(path, findings, on, folder / "machine.toml", tables=tables)
    if program is not None:
        program.verify()
    return program, findings


def program_of(folder: Path, text: str, on: Machine = NO_MCUWIN) -> Program:
    """A program of blocks that must have no finding."""
    program, findings = load(folder, text, on, tables=False)
    assert [(f.code.label, f.span.line, f.message) for f in findings.kept] == []
    assert program is not None
    return program


def found(folder: Path, text: str | bytes, on: Machine = NO_MCUWIN) -> list[tuple[str, int, int, int]]:
    """(code, line, column, end column) of each finding."""
    _, findings = load(folder, text, on)
    return [(f.code.label, f.span.line, f.span.column, f.span.end_column) for f in findings.kept]


def value(node: Expr) -> str:
    """An expression in a short form."""
    match node:
        case Number():
            return f"{node.value:g}"
        case Text():
            return repr(node.value)
        case Variable():
            return node.name or f"#{value(node.number)}"
        case Constant() | Named():
            return node.name
        case Input():
            return f"{node.kind}{value(node.number)}"
        case Unary():
            return f"{node.operator}({value(node.operand)})"
    return f"({value(node.left)} {node.operator} {value(node.right)})"


def short(node: Statement) -> str:
    """A statement in a short form: ``G1 X5 | G0`` is a block that would go on with G0."""
    match node:
        case Block():
            words = [word.letter + ("" if word.bare else value(word.value)) for word in node.words]
            words += [f"{value(a.target)} := {value(a.value)}" for a in node.assigns]
            return " ".join(words) + (f" | {node.continued}" if node.continued else "")
        case Label():
            return f"L{node.name}:"
        case Jump():
            return f"jump {node.name}"
        case Return():
            return "return"
        case Call():
            arguments = "".join(f" {value(word.value)}" for word in node.arguments)
            return f"call {node.name}{arguments}" + (f" x {value(node.count)}" if node.count is not None else "")
        case Mode():
            return f"mode {node.name}"
        case Message():
            return f"{node.kind} " + ", ".join(value(part) for part in node.parts)
        case If():
            parts = f"if {value(node.condition)} [{listed(node.then)}]"
            return parts + (f" else [{listed(node.otherwise)}]" if node.otherwise else "")
        case While():
            return f"while {value(node.condition)} [{listed(node.body)}]"
        case Repeat():
            return f"repeat [{listed(node.body)}] until {value(node.condition)}"
        case For():
            way = "downto" if node.down else "to"
            return f"for {value(node.variable)} {value(node.first)} {way} {value(node.last)} [{listed(node.body)}]"
        case BlockTable():
            return f"table {node.first_line}-{node.last_line}"
    return type(node).__name__


def listed(body: tuple[Statement, ...]) -> str:
    """Statements in a short form."""
    return "; ".join(short(node) for node in body)
