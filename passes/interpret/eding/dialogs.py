"""Dialogs: what the operator answers is not known before the job runs. Eding CNC manual 4.2.

After OK the variables hold what the setup states of them. What they hold after Cancel the manual does not say: what
they held before, or what was typed. Where that makes a difference, OK and Cancel are followed apart.
"""

from __future__ import annotations

import copy
from collections.abc import Iterable
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.dialects.accepts import SHOWN_TOOLS
from gproof.ir.finding import Refusal
from gproof.ir.program import DIALOG_ANSWER as ANSWER
from gproof.ir.program import Message, Text
from gproof.ir.symbolic import Unknown, Value, between, bounds, hull
from gproof.ir.trace import Wait
from gproof.passes.interpret.core.call_stack import Path
from gproof.passes.interpret.core.outcomes import Asked
from gproof.passes.interpret.core.run import ProgramEnd
from gproof.passes.interpret.eding.written_variables import NEW_TOOL, TOOL, write_setting, write_tool

if TYPE_CHECKING:
    from gproof.passes.interpret.core.run import Run

OK, CANCEL = 1.0, -1.0
_CAUSE = "the answer of a dialog"

Settings = list[tuple[float, Value]]


def run_dialog(run: Run, node: Message) -> None:
    """Execute one; parts of the node: its title, then names and numbers of variables."""
    s = run.modal
    if s.rendering:
        s.parameters[ANSWER] = OK
        return
    pressed = bounds(s.stated_range(ANSWER, Unknown(_CAUSE, CANCEL, OK)))
    typed: Settings = []
    kept: Settings = []
    tools: list[int] = []
    for part in node.parts[1:]:
        if isinstance(part, Text):
            continue
        number = run.evaluator.value(part)
        if isinstance(number, Unknown):
            raise Refusal(codes.UNKNOWN_CONDITION.at(node.span, cause=number.cause))
        if round(number) in (TOOL, NEW_TOOL):
            tools.append(round(number))
            continue
        answer = s.stated_range(round(number), Unknown(f"the operator's answer in #{number:g}"))
        typed.append((number, answer))
        kept.append(
            (number, between(f"the value of #{number:g} after a dialog", hull(s.read(number, node.span), answer)))
        )
    for shown in tools:
        if not run.takes(SHOWN_TOOLS):
            write_tool(run, shown, Unknown("the operator's answer"), node.span, SHOWN_TOOLS)
    alike = all(bounds(old) == bounds(new) for (_, old), (_, new) in zip(kept, typed, strict=True))
    if not alike and pressed[0] <= 0 < pressed[1]:
        key = run.flow.paths.state_key(("dialog", id(node)))
        if key in run.flow.seen:
            run.close_section(run.flow.seen[key])
            raise ProgramEnd
        if run.branches + 2 <= run.max_branches:
            _fork(run, node, key, [(ANSWER, OK), *typed], [(ANSWER, CANCEL), *kept])
            return
    _set(run, node, [(ANSWER, between(_CAUSE, pressed)), *(typed if alike or pressed[0] > 0 else kept)])
    run.end_section(Wait.OPERATOR, "dialog answered", None, node.span)


def _set(run: Run, node: Message, values: Iterable[tuple[float, Value]]) -> None:
    for number, value in values:
        write_setting(run, number, value, node.span)


def _fork(run: Run, node: Message, key: object, ok: Settings, cancelled: Settings) -> None:
    """Follow "OK" now and "Cancel" later, each in a section of its own."""
    run.branches += 2
    first, second = run.rows.new_section(), run.rows.new_section()
    edges = tuple(
        run.edge(Wait.OPERATOR, outcome, target, node.span) for outcome, target in (("OK", first), ("Cancel", second))
    )
    title = f" '{node.parts[0].value}'" if node.parts and isinstance(node.parts[0], Text) else ""
    run.asked.update(
        (edge.target, Asked(span=node.span, what=f"the dialog{title}", answer=f"ends with {edge.outcome}"))
        for edge in edges
    )
    run.flow.seen[key] = edges
    run.close_section(edges)
    for frame in run.flow.stack:
        if frame.group is not None:
            frame.group.open += 1
    before = run.modal.copy()
    _set(run, node, cancelled)
    place = run.file, run.call, list(run.flow.called), run.moved, run.flow.nesting
    run.flow.waiting.append(Path([copy.copy(frame) for frame in run.flow.stack], run.modal, second, place))
    run.modal = before
    _set(run, node, ok)
    run.state_changed()
    run.begin_section(first)
