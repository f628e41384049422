"""Dialogs: what the operator answers is not known before the job runs. Eding CNC manual 4.2.

Behind OK the variables hold what the setup states of them. What they hold behind Cancel the manual does not say: what
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
from gproof.passes.interpret.core.assigned_numbers import NEW_TOOL, TOOL, write_setting, write_tool
from gproof.passes.interpret.core.call_stack import Path
from gproof.passes.interpret.core.outcomes import Asked
from gproof.passes.interpret.core.trace_writer import ProgramEnd

if TYPE_CHECKING:
    from gproof.passes.interpret.core.path_exploration import Branches

OK, CANCEL = 1.0, -1.0
_CAUSE = "the answer of a dialog"

Settings = list[tuple[float, Value]]


def run_dialog(ex: Branches, node: Message) -> None:
    """Execute one; parts of the node: its title, then names and numbers of variables."""
    s = ex.modal
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
        number = ex.evaluator.value(part)
        if isinstance(number, Unknown):
            raise Refusal(codes.UNKNOWN_CONDITION.at(node.span, cause=number.cause))
        if round(number) in (TOOL, NEW_TOOL):
            tools.append(round(number))
            continue
        answer = s.stated_range(round(number), Unknown(f"the operator's answer in #{number:g}"))
        typed.append((number, answer))
        kept.append(
            (number, between(f"what #{number:g} holds behind a dialog", hull(s.read(number, node.span), answer)))
        )
    for shown in tools:
        if not ex.takes(SHOWN_TOOLS):
            write_tool(ex, shown, Unknown("the operator's answer"), node.span, SHOWN_TOOLS)
    alike = all(bounds(old) == bounds(new) for (_, old), (_, new) in zip(kept, typed, strict=True))
    if not alike and pressed[0] <= 0 < pressed[1]:
        key = ex._state_key(("dialog", id(node)))
        if key in ex._seen:
            ex._close(ex._seen[key])
            raise ProgramEnd
        if ex.branches + 2 <= ex.max_branches:
            _fork(ex, node, key, [(ANSWER, OK), *typed], [(ANSWER, CANCEL), *kept])
            return
    _set(ex, node, [(ANSWER, between(_CAUSE, pressed)), *(typed if alike or pressed[0] > 0 else kept)])
    ex._end_section(Wait.OPERATOR, "dialog answered", None, node.span)


def _set(ex: Branches, node: Message, values: Iterable[tuple[float, Value]]) -> None:
    for number, value in values:
        write_setting(ex, number, value, node.span)


def _fork(ex: Branches, node: Message, key: object, ok: Settings, cancelled: Settings) -> None:
    """Follow "OK" now and "Cancel" later, each in a section of its own."""
    ex.branches += 2
    first, second = ex.rows.new_section(), ex.rows.new_section()
    edges = tuple(
        ex._edge(Wait.OPERATOR, outcome, target, node.span) for outcome, target in (("OK", first), ("Cancel", second))
    )
    title = f" '{node.parts[0].value}'" if node.parts and isinstance(node.parts[0], Text) else ""
    ex.asked.update(
        (edge.target, Asked(span=node.span, what=f"the dialog{title}", answer=f"ends with {edge.outcome}"))
        for edge in edges
    )
    ex._seen[key] = edges
    ex._close(edges)
    for frame in ex._stack:
        if frame.group is not None:
            frame.group.open += 1
    before = ex.modal.copy()
    _set(ex, node, cancelled)
    place = ex._file, ex._call, list(ex._depth), ex._moved, ex._nesting
    ex._waiting.append(Path([copy.copy(frame) for frame in ex._stack], ex.modal, second, place))
    ex.modal = before
    _set(ex, node, ok)
    ex._state_changed()
    ex._begin(first)
