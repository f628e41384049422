"""Small programs of DIN blocks for tests of the executor: built of nodes by hand, executed, shown in short forms.

A line of text is a Block, or what it says: ``L5`` a label, ``M96 L5`` a jump, ``M98 L5 O3`` a call, ``M17`` a return,
``CI601 := expression`` an assignment. Expressions are Python's, with names ``CI601``, ``CD600`` and ``IN5`` (an input).
What a bare line goes on with is that of the lines above it, as the manual says (3.1).
"""

from __future__ import annotations

import ast
import dataclasses
import re
from typing import Any

from gproof.driver.running import execute
from gproof.ir.codes import POSITION_UNKNOWN
from gproof.ir.dialects.mcuwin.rules import MCUWIN
from gproof.ir.dialects.mcuwin.settings import USUAL, McuWinSettings, TaskCode
from gproof.ir.finding import Findings, Span
from gproof.ir.machine import NO_MACHINE, Controller, Machine
from gproof.ir.program import (
    PARAMETER,
    Assign,
    Binary,
    Block,
    Call,
    Expr,
    For,
    If,
    Input,
    Jump,
    Label,
    Number,
    Program,
    Repeat,
    Return,
    SourceFile,
    Statement,
    Subprogram,
    Unary,
    Variable,
    While,
    Word,
)
from gproof.ir.setup import ZERO, Setup
from gproof.ir.trace import Op, Trace, chunks
from gproof.passes.checks.limits.soft_limits import Limits

FILE = "job.src"
TASKS = tuple(
    TaskCode(code=code, action=action)
    for code, action in (
        ("M3", "spindle_cw"), ("M4", "spindle_ccw"), ("M5", "spindle_off"), ("M6", "tool_change"), ("T", "tool_select"),
        ("S", "spindle_speed"), ("M8", "coolant_on"), ("M9", "coolant_off"), ("G74", "home"),
    )
)  # fmt: skip
DIN = McuWinSettings(
    position_unit=1.0, time_unit=60.0, absolute_centers=False, interpolation_axes="XYZABC", tasks=TASKS, tools=(),
    unstated=tuple(key for key in USUAL if key != "tool_file"),
    zero_offsets=((10.0, 20.0, 30.0, 0.0, 0.0, 0.0), (1.0, 2.0, 3.0, 0.0, 0.0, 0.0)),
)  # fmt: skip

_OPERATORS: dict[type, str] = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.FloorDiv: "div", ast.Mod: "rem", ast.Lt: "<",
    ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "<>", ast.And: "and", ast.Or: "or",
}  # fmt: skip


def machine(**changes: Any) -> Machine:
    """The usual machine; changes: of its settings."""
    settings = dataclasses.replace(DIN, **changes)
    return dataclasses.replace(NO_MACHINE, controller=Controller(dialect="mcuwin"), settings=settings)


def expr(text: str, line: int = 1) -> Expr:
    """An expression of a Python text."""
    return _expr(ast.parse(text.strip(), mode="eval").body, Span(FILE, line, 1))


def _expr(node: ast.AST, span: Span) -> Expr:
    if isinstance(node, ast.Constant):
        return Number(float(node.value), span)  # type: ignore[arg-type]
    if isinstance(node, ast.Name):
        kind, number = re.fullmatch(r"(CI|CD|V|IN)(\d+)", node.id).groups()  # type: ignore[union-attr]
        if kind == "IN":
            return Input("input", Number(float(number), span), span)
        return variable(node.id, span)
    if isinstance(node, ast.UnaryOp):
        operator = {ast.USub: "neg", ast.Not: "not", ast.UAdd: "pos"}[type(node.op)]  # type: ignore[index]
        return Unary(operator, _expr(node.operand, span), span)
    if isinstance(node, ast.Compare):
        (operator,), (right,) = node.ops, node.comparators
        return Binary(_OPERATORS[type(operator)], _expr(node.left, span), _expr(right, span), span)
    if isinstance(node, ast.BoolOp):
        found = _expr(node.values[0], span)
        for value in node.values[1:]:
            found = Binary(_OPERATORS[type(node.op)], found, _expr(value, span), span)
        return found
    if isinstance(node, ast.Call):
        assert isinstance(node.func, ast.Name)
        return Unary(node.func.id, _expr(node.args[0], span), span)
    assert isinstance(node, ast.BinOp)
    return Binary(_OPERATORS[type(node.op)], _expr(node.left, span), _expr(node.right, span), span)


def variable(name: str, span: Span) -> Variable:
    """``CI601``, ``CD600``, or ``V0``: the first that a program declares."""
    kind, number = re.fullmatch(r"(CI|CD|V)(\d+)", name).groups()  # type: ignore[union-attr]
    base = {"CD": 0, "CI": 1000, "V": 2000}[kind]
    return Variable(Number(float(base + int(number)), span), span, name if kind == "V" else "")


class Builder:
    """Makes statements of texts; a nested structure is a tuple (kind, condition, body ...), see ``statements``."""

    def __init__(self) -> None:
        self.line = 0
        self.continued = ""

    def statements(self, items: list[Any]) -> tuple[Statement, ...]:
        """Texts, and ("if", condition, then, otherwise), ("while", condition, body), ("repeat", body, condition),
        ("for", variable, first, last, down, body)."""
        return tuple(self._statement(item) for item in items)

    def _statement(self, item: Any) -> Statement:
        self.line += 1
        span = Span(FILE, self.line, 1, 80)
        if isinstance(item, str):
            return self._text(item, span)
        kind = item[0]
        if kind == "if":
            then = self.statements(item[2])
            self.line += 1
            otherwise = self.statements(item[3]) if len(item) > 3 else ()
            self.line += 1
            return If(condition=expr(item[1], span.line), then=then, otherwise=otherwise, span=span)
        if kind == "while":
            return While(condition=expr(item[1], span.line), body=self.statements(item[2]), span=span)
        if kind == "repeat":
            body = self.statements(item[1])
            return Repeat(condition=expr(item[2], span.line), body=body, span=span)
        assert kind == "for"
        return For(
            variable=variable(item[1], span), first=expr(item[2]), last=expr(item[3]), down=item[4],
            body=self.statements(item[5]), span=span,
        )  # fmt: skip

    def _text(self, text: str, span: Span) -> Statement:
        if match := re.fullmatch(r"L(\d+)", text):
            return Label(name=match[1], span=span)
        if match := re.fullmatch(r"M96 L(\d+)", text):
            return Jump(name=match[1], span=span)
        if match := re.fullmatch(r"M98 L(\d+)(?: O(.+))?", text):
            return Call(name=match[1], span=span, count=None if match[2] is None else expr(match[2], span.line))
        if text == "M17":
            return Return(span=span, code="M17")
        if ":=" in text:
            target, value = text.split(":=")
            assign = Assign(variable(target.strip(), span), expr(value, span.line), span)
            return Block(words=(), assigns=(assign,), span=span)
        return self._block(text, span)

    def _block(self, text: str, span: Span) -> Block:
        words = []
        own: str | None = None
        for match in re.finditer(r"\S+", text):
            letter, value = ("", match[0]) if not match[0][0].isalpha() else (match[0][0], match[0][1:])
            where = Span(FILE, span.line, match.start() + 1, match.end() + 1)
            number: Expr = Number(0.0, where)
            if value:
                number = expr(value, span.line) if value[0] == "(" else Number(float(value), where)
            words.append(Word(letter or PARAMETER, number, where, bare=not value))
            if letter == "G" and isinstance(number, Number) and number.value in (0.0, 1.0, 2.0, 3.0, 92.0):
                own = f"G{number.value:g}"
            elif letter == "G" and own not in ("G0", "G1", "G2", "G3", "G92"):
                own = "" if isinstance(number, Number) and number.value == 4.0 else "?"
        continued, self.continued = self.continued, self.continued if own is None else own
        return Block(words=tuple(words), assigns=(), span=span, continued=continued)


def program(items: list[Any], *subs: tuple[str, list[Any]]) -> Program:
    """A program of statements and modules (name, statements)."""
    builder = Builder()
    body = builder.statements(items)
    found = {}
    for name, content in subs:
        builder.continued = ""
        span = Span(FILE, builder.line + 1, 1)
        found[name] = Subprogram(name=name, body=builder.statements(content), span=span, is_module=True)
    made = Program(
        dialect="mcuwin", rules=MCUWIN, body=body, subprograms=found, line_count=builder.line + 1,
        files=[SourceFile(name=FILE, sha256="", line_count=builder.line + 1)],
    )  # fmt: skip
    return made


def run(
    items: list[Any], *subs: tuple[str, list[Any]], setup: Setup = ZERO, on: Machine | None = None,
    checked: bool = True, **more: Any,
) -> tuple[Trace, Findings]:  # fmt: skip
    """The verified trace of a program that ends with M30, and what was found.

    checked: the program keeps the rules of its stage.
    """
    findings = Findings()
    made = program([*items, "M30"], *subs)
    if checked:
        made.verify()
    trace = execute(made, setup, on or machine(), findings, **more)
    trace.verify()
    return trace, findings


def never_homed(items: list[Any], setup: Setup, on: Machine) -> list[tuple[str, int]]:
    """(axis, line) of the first moves of axes that are stated to have had no reference run."""
    trace, _ = run(items, setup=setup, on=on)
    findings = Findings()
    check = Limits(on, setup, findings)
    for chunk in chunks(trace):
        check.feed(chunk)
    check.finish()
    told = [f for f in findings.kept if f.code is POSITION_UNKNOWN and "no reference run" in f.message]
    return [(str(f.message.split("position of ")[1][0]), f.span.line) for f in told]


def labels(findings: Findings) -> list[str]:
    """Codes of the findings in order; notes left out."""
    return [f.code.label for f in findings.kept if f.severity.name != "NOTE"]


def moves(trace: Trace, axes: int = 3) -> list[tuple[Any, ...]]:
    """(op, place rounded) of rows that move, sections in order."""
    found = []
    for section in trace.sections:
        rows = section.rows
        for n in range(len(rows)):
            if rows["op"][n] < Op.DWELL:
                place = tuple(round(float(v), 6) + 0.0 for v in rows["to"][n][:axes])
                found.append((Op(int(rows["op"][n])).name, *place))
    return found
