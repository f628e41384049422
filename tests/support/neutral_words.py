"""Operations of a neutral job as short texts, for tests that write by hand what a program must say.

A place is ``x5``, a distance ``x+5``; lengths without a unit are millimetres, ``F`` counts a minute. Rows of a table
are what they would be as operations of their own. A centre that is a place is ``x=5``.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from gproof.ir import job as j
from gproof.ir.program import Binary, Constant, Expr, Input, Named, Number, Text, Unary, Variable

KINDS = {j.RAPID: "rapid", j.STRAIGHT: "feed", j.ARC_CW: "cw", j.ARC_CCW: "ccw"}


def words_of(body: Sequence[j.Node]) -> list[str]:
    """A text for each operation, and for each row of a table."""
    return [text for node in body for text in _texts(node)]


def _texts(node: j.Node) -> Iterator[str]:
    if isinstance(node, j.Moves):
        yield from _rows(node)
    else:
        yield " ".join(_node(node).split())


def expression(value: Expr) -> str:
    """A value; compound ones in brackets."""
    match value:
        case Number():
            return f"{value.value:g}"
        case Text():
            return repr(value.value)
        case Variable():
            return value.name or _numbered(value)
        case Constant() | Named():
            return value.name
        case Input():
            return f"input {expression(value.number)}"
        case Unary():
            return f"({value.operator} {expression(value.operand)})"
        case Binary():
            return f"({expression(value.left)} {value.operator} {expression(value.right)})"


def _numbered(value: Variable) -> str:
    if isinstance(value.number, Number) and 600 <= value.number.value < 1000:
        return f"CD{value.number.value:g}"
    if isinstance(value.number, Number) and 1600 <= value.number.value < 2000:
        return f"CI{value.number.value - 1000:g}"
    return f"#{expression(value.number)}"


def _amount(value: j.Quantity, usual: str = "mm") -> str:
    text = expression(value.value)
    if isinstance(value.value, Variable) and usual == "mm":
        text = f"({text})"
    return text + ("" if value.unit == usual else value.unit)


def _places(places: Sequence[j.AxisPlace], *, center: bool = False) -> str:
    found = []
    for one in places:
        text = _amount(one.at)
        sign = "" if text.startswith("-") else "+"
        found.append(f"{one.axis}{sign if one.relative else '=' if center else ''}{text}")
    return " ".join(found)


def _feed(feed: j.Feed | None) -> str:
    return "" if feed is None else f"F{_amount(feed.amount)}" + ("" if feed.per == "minute" else f"/{feed.per}")


def _rows(table: j.Moves) -> Iterator[str]:
    unit = "" if table.unit == "mm" else table.unit
    for row in range(len(table.rows)):
        values = {name: table.rows[name][row] for name in ("kind", "axes", "to", "centred", "center", "feed", "radius")}
        sign = "+" if table.relative else ""
        kind = int(values["kind"])
        parts = [KINDS[kind]] + ([table.plane] if kind >= j.ARC_CW else [])
        for n, axis in enumerate("xyzabc"):
            if int(values["axes"]) >> n & 1:
                parts.append(f"{axis}{_signed(values['to'][n], sign)}{unit}")
        if int(values["centred"]):
            parts.append("about")
        for n, axis in enumerate("xyz"):
            if int(values["centred"]) >> n & 1:
                parts.append(f"{axis}{_signed(values['center'][n], '+')}{unit}")
        if values["radius"]:
            parts.append(f"R{values['radius']:g}{unit}")
        if not np.isnan(values["feed"]):
            feed = f"F{values['feed']:g}{unit}" + ("" if table.per == "minute" else f"/{table.per}")
            if kind == j.RAPID:
                yield feed
            else:
                parts.append(feed)
        yield " ".join(parts)


def _signed(value: float, sign: str) -> str:
    return f"{value:g}" if value < 0 else f"{sign}{value:g}"


def _inner(body: Sequence[j.Node]) -> str:
    return "{" + "; ".join(words_of(body)) + "}"


def _node(node: j.Node) -> str:
    match node:
        case j.MoveTo():
            machine = "" if node.frame == "work" else node.frame
            return f"{node.kind} {machine} {_places(node.to)} {_feed(node.feed)}"
        case j.ArcTo():
            center = f"about {_places(node.center, center=True)}" if node.center else ""
            radius = "" if node.radius is None else f"R{_amount(node.radius)}"
            turns = "" if node.turns is None else f"turns {expression(node.turns)}"
            sense = "cw" if node.clockwise else "ccw"
            return f"{sense} {node.plane} {_places(node.to)} {center} {radius} {turns} {_feed(node.feed)}"
        case j.SetFeed():
            return _feed(node.feed)
        case j.DwellFor():
            return f"dwell {expression(node.time.value)}{node.time.unit}"
        case j.SetFrame():
            number = "" if node.number is None else expression(node.number)
            factors = f"by {' '.join(p.axis + expression(p.at.value) for p in node.factors)}" if node.factors else ""
            some = f"of {' '.join(node.axes)}" if node.axes else ""
            signed = node.action == "zero_shift"
            places = " ".join(
                f"{p.axis}{'+' if signed and not _amount(p.at).startswith('-') else ''}{_amount(p.at)}"
                for p in node.places
            )
            return f"{node.action} {number} {places} {factors} {some}"
        case j.Choice():
            otherwise = f"else {_inner(node.otherwise)}" if node.otherwise else ""
            return f"if {expression(node.condition)} {_inner(node.then)} {otherwise}"
        case j.LoopWhile():
            return f"{'first' if node.first else ''} while {expression(node.condition)} {_inner(node.body)}"
        case j.CountLoop():
            way = "downto" if node.down else "to"
            ends = f"{expression(node.first)} {way} {expression(node.last)}"
            return f"for {expression(node.variable)} = {ends} {_inner(node.body)}"
        case j.RunRoutine():
            given = " ".join(f"{expression(a)} = {expression(v)}" for a, v in node.arguments)
            count = "" if node.count is None else f"{expression(node.count)} times"
            return f"run {node.name} {f'with {given}' if given else ''} {count}"
        case _:
            return _event(node)


def _event(node: j.Node) -> str:
    match node:
        case j.TurnSpindle():
            return f"spindle {node.direction} {'' if node.speed is None else _amount(node.speed)}"
        case j.SwitchCoolant():
            states = {"mist": node.mist, "flood": node.flood}
            return " ".join(f"{name} {'on' if on else 'off'}" for name, on in states.items() if on is not None)
        case j.ChangeTool():
            number = "" if node.number is None else expression(node.number)
            done = {(True, False): "selected", (False, True): "change", (True, True): "changed"}
            return f"tool {number} {done[node.select, node.change]}"
        case j.SwitchOutput():
            moving = "moving" if node.moving else ""
            return f"output {expression(node.channel)} := {expression(node.value)} {moving}"
        case j.PauseJob():
            return f"pause {'optional' if node.optional else ''}"
        case j.HomeAxes():
            return f"home {' '.join(node.axes)}"
        case j.Compensate():
            return f"correct {node.side}"
        case j.ShowText():
            return f"text {' '.join(expression(part) for part in node.parts)}"
        case j.EndJob():
            return f"end {'reset' if node.reset else ''}"
        case j.Remark():
            return repr(node.text)
        case j.SetVariable():
            return f"{expression(node.target)} := {expression(node.value)}"
        case j.LeaveRoutine():
            return "leave"
        case j.Mark():
            return f"mark {node.name}"
        case j.GoTo():
            return f"goto {node.name}"
        case j.NotRaised():
            return f"NOT {node.construct}"
        case _:
            return type(node).__name__
