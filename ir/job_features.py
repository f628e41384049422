"""Which features an operation of a Job has: what a target must have to do it as it is."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from gproof.ir.columns import Array
from gproof.ir.job import (
    ARC_CW,
    RAPID,
    AllowOverrides,
    ArcTo,
    ChangeTool,
    Choice,
    Compensate,
    CountLoop,
    DrillHole,
    DwellFor,
    EndJob,
    Feed,
    GoTo,
    HomeAxes,
    LeaveRoutine,
    LoopWhile,
    Mark,
    Moves,
    MoveTo,
    Node,
    NotRaised,
    OptionalPart,
    ParkAt,
    PauseJob,
    Quantity,
    Remark,
    RepeatGrid,
    RunRoutine,
    SetFeed,
    SetFrame,
    SetPathMode,
    SetVariable,
    ShowText,
    SwitchCoolant,
    SwitchGuard,
    SwitchOutput,
    TurnSpindle,
    UseLength,
    WaitFor,
    quantities,
)
from gproof.ir.program import Binary, Constant, Expr, Input, Named, Number, Text, Unary, Variable

_PER = {"minute": (), "move": ("inverse_time",), "revolution": ("per_revolution",)}
_FRAMES = {
    "rotate": "frame_rotate", "rotate_off": "frame_rotate", "scale": "frame_scale", "scale_off": "frame_scale",
    "mirror": "frame_mirror", "mirror_off": "frame_mirror",
}  # fmt: skip


def features(node: Node) -> frozenset[str]:
    """The features of one operation, those of operations within it left out."""
    return frozenset(_features(node))


def expressions(node: Node) -> Iterator[Expr]:
    """The expressions that an operation holds itself."""
    for amount in quantities(node):
        yield amount.value
    if isinstance(node, SetVariable):
        yield node.target
        yield node.value
    elif isinstance(node, Choice):
        asked = node.condition
        # Whether an input is on or off is one question.
        is_off = isinstance(asked, Unary) and asked.operator == "not" and isinstance(asked.operand, Input)
        yield asked.operand if is_off and isinstance(asked, Unary) else asked
    elif isinstance(node, LoopWhile):
        yield node.condition
    elif isinstance(node, CountLoop):
        yield from (node.variable, node.first, node.last)
    elif isinstance(node, RunRoutine):
        for target, value in node.arguments:
            yield from (target, value)
        if node.count is not None:
            yield node.count
    elif isinstance(node, ShowText):
        yield from (part for part in node.parts if not isinstance(part, Text))
    elif isinstance(node, SwitchOutput):
        yield from (node.channel, node.value)
    elif isinstance(node, WaitFor):
        yield node.channel
    elif isinstance(node, SetFrame | ChangeTool) and node.number is not None:
        yield node.number
    elif isinstance(node, Compensate | UseLength | PauseJob) and node.tool is not None:
        yield node.tool
    elif isinstance(node, DrillHole) and node.repeats is not None:
        yield node.repeats
    elif isinstance(node, ArcTo) and node.turns is not None:
        yield node.turns


def parts_of_expression(expr: Expr) -> Iterator[Expr]:
    """An expression and all expressions within it."""
    yield expr
    if isinstance(expr, Variable):
        yield from parts_of_expression(expr.number)
    elif isinstance(expr, Unary):
        yield from parts_of_expression(expr.operand)
    elif isinstance(expr, Binary):
        yield from parts_of_expression(expr.left)
        yield from parts_of_expression(expr.right)
    elif isinstance(expr, Input):
        yield from parts_of_expression(expr.number)


SYSTEM = range(5001, 6000)
"""Numbers of variables of RS274 that a controller sets itself, those apart that programs may use freely."""
_FREE_SYSTEM = frozenset((*range(5015, 5051), 5398, 5399))


def _of_expression(expr: Expr) -> Iterator[str]:
    if isinstance(expr, Number):
        return
    for part in parts_of_expression(expr):
        if isinstance(part, Variable):
            yield "variable"
            if not isinstance(part.number, Number):
                yield "indirect"
            elif part.number.value in SYSTEM and part.number.value not in _FREE_SYSTEM:
                yield "system_variable"
        elif isinstance(part, Input):
            yield "input_value"
        elif isinstance(part, Named):
            yield "system_variable"
        elif isinstance(part, Unary | Binary | Constant):
            yield "expression"


def _features(node: Node) -> Iterator[str]:
    if isinstance(node, Moves):
        yield from moves_features(node)
        return
    for expr in expressions(node):
        yield from _of_expression(expr)
    for amount in quantities(node):
        yield from _unit(amount)
    feed: Feed | None = getattr(node, "feed", None)
    if feed is not None:
        yield from _PER[feed.per]
    yield from _own(node)


def _unit(amount: Quantity) -> Iterator[str]:
    if amount.unit in {"mm", "inch", "cm"}:
        yield f"unit_{amount.unit}"


def _own(node: Node) -> Iterator[str]:
    """Features by the kind of the operation."""
    if isinstance(node, MoveTo):
        yield {"rapid": "rapid", "feed": "straight", "probe": "probe"}[node.kind]
        if node.frame == "machine":
            yield "machine_move" if node.kind == "rapid" else "machine_feed"
        if any(place.relative for place in node.to):
            yield "relative"
    elif isinstance(node, ArcTo):
        yield "arc" if node.radius is None else "arc_radius"
        if any(not place.relative for place in node.center):
            yield "arc_place"
        if node.turns is not None:
            yield "arc_turns"
        if node.plane != "xy":
            yield f"arc_{node.plane}"
        if any(place.axis not in node.plane for place in node.to):
            yield "arc_helix"
        if not any(place.axis in node.plane for place in node.to):
            yield "arc_full"
        if any(place.relative for place in node.to):
            yield "relative"
    elif isinstance(node, DrillHole):
        yield f"cycle_{node.kind}"
        if node.repeats is not None:
            yield "cycle_repeats"
        if node.dwell is not None and node.kind in {"drill", "peck", "chip_break"}:
            yield "cycle_peck_dwell"
        if node.plane != "xy":
            yield "cycle_plane"
        if node.clearance is not None:
            yield "cycle_clearance"
        if node.top.relative or any(place.relative for place in node.at):
            yield "cycle_relative"
    elif isinstance(node, SetFrame):
        if node.action == "scale" and {one.axis for one in node.factors} != {"x", "y"}:
            yield "frame_scale_axis"
        if node.action in {"zero_keep", "zero_recall"} and node.number is not None:
            yield "frame_zero_register"
        yield "frame_select_axes" if node.axes else _FRAMES.get(node.action, f"frame_{node.action}")
    elif isinstance(node, SetPathMode):
        yield f"path_{node.mode}"
        if node.tolerance is not None:
            yield "path_tolerance"
        if node.simplify is not None or node.angle is not None:
            yield "path_filter"
    elif isinstance(node, Compensate):
        yield "compensation"
        if node.plane != "xy":
            yield "compensation_plane"
        if node.open:
            yield "compensation_open"
        if node.diameter is not None:
            yield "compensation_diameter"
    elif isinstance(node, ChangeTool):
        if node.select and not node.change:
            yield "tool_select"
        if node.change:
            yield "tool_change"
            if node.number is None:
                yield "tool_change_selected"
            yield "tool_change_rests" if node.rests else "tool_change_running"
    elif isinstance(node, TurnSpindle):
        yield "spindle_speed" if node.direction == "speed" else "spindle"
        if node.speed is not None:
            yield "spindle_speed"
    elif isinstance(node, SwitchCoolant):
        if node.mist is not None and (node.mist or node.flood is None):
            yield "mist"
        if node.flood is not None:
            yield "flood"
    elif isinstance(node, SwitchOutput):
        yield "output_moving" if node.moving else "output"
    elif isinstance(node, WaitFor):
        unlimited = "wait_open" if node.open else "wait"
        yield "input_read" if node.on is None else unlimited if node.timeout is None else "wait_timeout"
    else:
        yield from _plain(node)


_PLAIN: dict[type, str] = {
    SetFeed: "feed_alone", DwellFor: "dwell", HomeAxes: "home", ParkAt: "park", ShowText: "message",
    AllowOverrides: "overrides", Remark: "comment", SetVariable: "variable", OptionalPart: "optional_part",
    CountLoop: "count_loop", LeaveRoutine: "routine", Mark: "jump", GoTo: "jump", RepeatGrid: "grid",
    NotRaised: "not_raised",
    SwitchGuard: "guard", UseLength: "length",
}  # fmt: skip


def _plain(node: Node) -> Iterator[str]:
    known = _PLAIN.get(type(node))
    if known is not None:
        yield known
    elif isinstance(node, Choice):
        yield "question" if node.question else "choice"
    elif isinstance(node, LoopWhile):
        yield "repeat" if node.first else "while"
    elif isinstance(node, RunRoutine):
        yield "routine"
        if node.arguments:
            yield "routine_arguments"
        if node.count is not None:
            yield "routine_count"
    elif isinstance(node, PauseJob):
        yield "optional_stop" if node.optional else "stop"
    elif isinstance(node, EndJob):
        yield "end_reset" if node.reset else "end"
        if node.rests:
            yield "end_rests"


def row_features(moves: Moves) -> dict[str, Array]:
    """For each feature that only some rows of a table have, which rows."""
    rows = moves.rows
    kind = rows["kind"]
    arcs = kind >= ARC_CW
    found = {"rapid": kind == RAPID, "straight": kind == RAPID + 1}
    if arcs.any():
        by_radius = arcs & (rows["radius"] != 0.0)
        found["arc"] = arcs & ~by_radius
        found["arc_radius"] = by_radius
        in_plane = {"xy": 0b011, "xz": 0b101, "yz": 0b110}[moves.plane]
        found["arc_helix"] = arcs & ((rows["axes"] & np.uint8(0xFF ^ in_plane)) != 0)
        found["arc_full"] = arcs & ((rows["axes"] & np.uint8(in_plane)) == 0)
        if moves.plane != "xy":
            found[f"arc_{moves.plane}"] = arcs
    return found


def moves_features(moves: Moves) -> Iterator[str]:
    """The features of a table: those of its rows, and of all of them."""
    yield f"unit_{moves.unit}"
    yield from _PER[moves.per] if not np.isnan(moves.rows["feed"]).all() else ()
    if moves.relative:
        yield "relative"
    for name, rows in row_features(moves).items():
        if rows.any():
            yield name
