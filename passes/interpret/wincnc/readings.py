"""What braces and conditions of a program read: names of the controller, inputs, answers (WinCNC Users Guide)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.dialects.wincnc.settings import wincnc_settings
from gproof.ir.finding import Refusal
from gproof.ir.program import Input, Named
from gproof.ir.symbolic import NOWHERE, Position, Unknown, Value, between, bounds
from gproof.passes.interpret.core.channels import value_of
from gproof.passes.interpret.core.expressions import Evaluator

if TYPE_CHECKING:
    from gproof.passes.interpret.wincnc.state import (
        WinCncRun,
    )


def read_named(run: WinCncRun, node: Named) -> Value:
    """The value of a name in braces, in the program's unit; Refusal GP107 for one that is none."""
    s = run.modal
    name = node.name
    if len(name) == 1:
        found = next((value for letter, value in s.own.arguments if letter == name), None)
        if found is None:
            raise Refusal(codes.BAD_EXPRESSION.at(node.span, what=f"{{{name}}}: the call gives no {name}"))
        return found
    if name not in run.program.rules.variables:
        raise Refusal(codes.BAD_EXPRESSION.at(node.span, what=f"{name} is not a variable of WinCNC"))
    value = _internal(run, name)
    if name[:2] in ("TH", "TM", "LZ") and s.unit != run.machine.unit and not _turns(run, name):
        # In the unit of the program or in that of the file: of which, the manual says nothing.
        low, high = bounds(value)
        factor = s.unit / run.machine.unit
        ends = low, high, low * factor, high * factor
        cause = f"{name}, in the unit of the job or of the machine file,"
        return between(
            value.cause if isinstance(value, Unknown) and not value.bounded else cause, (min(ends), max(ends))
        )
    return value


def _turns(run: WinCncRun, name: str) -> bool:
    """Whether a local zero is that of an axis that turns."""
    number = int(name[2]) if name[:2] == "LZ" else 0
    axes = run.machine.axes
    return name[:2] == "LZ" and number < len(axes) and not run.modal.linear[axes[number].index]


def _internal(run: WinCncRun, name: str) -> Value:
    """The value of a variable of the controller, lengths in the program's unit."""
    s = run.modal
    controls = wincnc_settings(run.machine)
    if name in ("TP1", "TP2"):
        return s.own.tools[int(name[2]) - 1]
    if name in ("TN1", "TN2"):
        tool, add = s.own.tools[int(name[2]) - 1], 10.0 * int(name[2])
        return tool if isinstance(tool, Unknown) else tool + add
    if name in ("TM1", "TM2"):
        return s.own.switch_heights[int(name[2]) - 1]
    if name[:2] == "LZ":
        axis = int(name[2])
        there = run.machine.axes[axis].index if axis < len(run.machine.axes) else axis
        return s.plain(s.g92[there], s.scale(there), 0)
    if name in ("TH1", "TH2"):
        return _tool_height(run, int(name[2]))
    switch = controls.measure
    if switch is not None and name[:2] == "TM":
        value = {"X": switch.x, "Y": switch.y, "I": switch.i, "J": switch.j, "D": switch.descent,
                 "F": None if switch.feed is None else switch.feed * 60.0}.get(name[2])  # fmt: skip
        if value is not None:
            return value / s.unit
    return Unknown(name)


def _tool_height(run: WinCncRun, number: int) -> Value:
    """TH1, TH2: the height of atc1= or that of the tool in the library; a number where the two agree."""
    s = run.modal
    changer = next((c for c in wincnc_settings(run.machine).changers if c.number == number), None)
    tool = s.own.tools[number - 1]
    name = f"TH{number}"
    if changer is None or changer.height is None or isinstance(tool, Unknown):
        return Unknown(name)
    measured = dict(s.own.heights).get(round(tool))
    if measured is None:
        known = run.setup.interval(f"tool.{round(tool)}.z")
        measured = Position(known.low) if known is not None and known.exact else NOWHERE
    if measured.form or abs(measured.value - changer.height) > 1e-9:
        return Unknown(f"{name}, the changer's height or the tool's")
    return changer.height / s.unit


def read_input(run: WinCncRun, node: Input, evaluator: Evaluator) -> Value:
    """The state of a channel: by the program, else by the setup, else unknown; Refusal GP128 for one not there."""
    value = evaluator.value(node.number)
    if isinstance(value, Unknown):
        return Unknown(value.cause, 0.0, 1.0)
    if node.kind == "given":
        if value not in (0.0, 1.0):
            raise Refusal(codes.PARAMETER_RANGE.at(node.span, code="a condition", word="C", allowed="0 or 1"))
        return value
    number = round(value)
    controls = wincnc_settings(run.machine)
    there = {"input": controls.inputs, "output": controls.outputs, "virtual": range(1, 65)}.get(node.kind)
    highest = math.inf if controls.highest_channel is None else controls.highest_channel
    beyond = node.kind in ("input", "output") and number > highest
    missing = there is not None and (number not in there or abs(number - value) > run.program.rules.integer_tolerance)
    if missing or beyond:
        allowed = f"there is no {node.kind} channel {value:g}"
        raise Refusal(codes.PARAMETER_RANGE.at(node.span, code="a condition", word="C", allowed=allowed))
    s, setup = run.modal, run.setup
    known: Value | None = None
    if node.kind == "output" and number in controls.unsteady_outputs:
        known = None
    elif node.kind == "output":
        known = value_of(s.outputs, number)
        known = setup.outputs.get(number) if known is None else known
    elif node.kind == "virtual":
        known = value_of(s.own.virtual, number)
        known = setup.virtual.get(number) if known is None else known
    elif node.kind == "input":
        known = setup.inputs.get(number)
    else:
        known = setup.answers.get(number)
    if known is not None:
        return known
    names = {"output": "output", "virtual": "virtual input", "input": "input", "answer": "the operator's answer"}
    return Unknown(f"{names[node.kind]} {number}", 0.0, 1.0)
