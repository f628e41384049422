"""Neutral jobs in few words, and in few words what one is."""

from __future__ import annotations

from gproof.ir.finding import Span
from gproof.ir.job import (
    ArcTo,
    AxisPlace,
    ChangeTool,
    Choice,
    DrillHole,
    Job,
    LoopWhile,
    MoveTo,
    Node,
    Quantity,
    Remark,
    Routine,
    RunRoutine,
    SetFrame,
    SetPathMode,
    SetVariable,
    SwitchCoolant,
    TurnSpindle,
    WaitFor,
)
from gproof.ir.program import Binary, Expr, Input, Number, Unary, Variable

PLACE = Span("job", 1)


def number(value: float) -> Number:
    """A literal."""
    return Number(float(value), PLACE)


def variable(name: int) -> Variable:
    """``#name``."""
    return Variable(number(name), PLACE)


def mm(value: float | Expr, unit: str = "mm") -> Quantity:
    """A length."""
    return Quantity(number(value) if isinstance(value, int | float) else value, unit)


def at(unit: str = "mm", *, relative: bool = False, **axes: float | Expr) -> tuple[AxisPlace, ...]:
    """Places of axes by name."""
    return tuple(AxisPlace(axis, mm(value, unit), relative) for axis, value in axes.items())


def rapid(unit: str = "mm", *, relative: bool = False, frame: str = "work", **axes: float | Expr) -> MoveTo:
    """A rapid."""
    return MoveTo(to=at(unit, relative=relative, **axes), kind="rapid", frame=frame, span=PLACE)


def cut(**axes: float | Expr) -> MoveTo:
    """A move with feed."""
    return MoveTo(to=at(**axes), span=PLACE)


def run(name: str = "a", count: float | None = None, **arguments: float) -> RunRoutine:
    """A run of a routine; arguments: ``v5 = 2`` for variable 5."""
    given = tuple((variable(int(key[1:])), number(value)) for key, value in arguments.items())
    return RunRoutine(name=name, span=PLACE, arguments=given, count=None if count is None else number(count))


def job(*body: Node, source: str = "eding", **routines: list[Node]) -> Job:
    """A job with routines by name."""
    made = {name: Routine(name=name, body=tuple(nodes), span=PLACE) for name, nodes in routines.items()}
    found = Job(source=source, files=["job"], body=body, routines=made)
    found.verify()
    return found


def text(expr: Expr) -> str:
    """An expression as people write it."""
    if isinstance(expr, Number):
        return f"{round(expr.value, 9):g}"
    if isinstance(expr, Variable):
        return f"#{text(expr.number)}"
    if isinstance(expr, Input):
        return f"{expr.kind} {text(expr.number)}"
    if isinstance(expr, Unary):
        return f"{expr.operator}({text(expr.operand)})"
    if isinstance(expr, Binary):
        return f"({text(expr.left)} {expr.operator} {text(expr.right)})"
    raise TypeError(type(expr).__name__)


def places(found: tuple[AxisPlace, ...]) -> str:
    """``x1 +y2``: relative places have a sign; units other than mm are named."""
    return " ".join(
        f"{'+' * one.relative}{one.axis}{text(one.at.value)}{one.at.unit.removeprefix('mm')}" for one in found
    )


def words(node: Node) -> str:
    """An operation in few words."""
    if isinstance(node, MoveTo):
        kind = {"rapid": "rapid", "feed": "cut", "probe": "probe"}[node.kind]
        feed = "" if node.feed is None else f" f{text(node.feed.amount.value)}"
        return f"{kind} {'machine ' * (node.frame == 'machine')}{places(node.to)}{feed}"
    if isinstance(node, ArcTo):
        how = f"radius {text(node.radius.value)}" if node.radius else f"about {places(node.center)}"
        return f"{'cw' if node.clockwise else 'ccw'} {places(node.to)} {how}".replace("  ", " ")
    if isinstance(node, DrillHole):
        where = f"{places(node.at)} {places((node.top,))} to {places((node.bottom,))}"
        return f"{node.kind} {where} back to {node.back}"
    if isinstance(node, SetVariable):
        return f"{text(node.target)} = {text(node.value)}"
    if isinstance(node, RunRoutine):
        return f"run {node.name}"
    if isinstance(node, LoopWhile):
        return f"{'repeat' if node.first else 'while'} {text(node.condition)} {{{said(node.body)}}}"
    if isinstance(node, Choice):
        return f"if {text(node.condition)} {{{said(node.then)}}} else {{{said(node.otherwise)}}}"
    if isinstance(node, WaitFor):
        return f"read {text(node.channel)}"
    if isinstance(node, SetFrame):
        which = "" if node.number is None else f" {text(node.number)}"
        return f"{node.action}{which} {places(node.places)}".strip()
    if isinstance(node, SetPathMode):
        return f"{node.mode}{' simplified' * (node.simplify is not None)}"
    if isinstance(node, ChangeTool):
        which = "" if node.number is None else f" {text(node.number)}"
        return f"{'change' if node.change else 'select'}{which}{' at rest' * node.rests}"
    if isinstance(node, TurnSpindle):
        return f"spindle {node.direction}"
    if isinstance(node, SwitchCoolant):
        return f"mist {node.mist} flood {node.flood}"
    if isinstance(node, Remark):
        return f"({node.text})"
    return type(node).__name__


def said(nodes: tuple[Node, ...]) -> str:
    """Operations in few words."""
    return "; ".join(words(node) for node in nodes)
