"""Jumps, labels, returns, counted loops and calls of languages that have them.

A jump goes to a label in its own list of statements or in one around it, within its subprogram (``ir.program.Jump``).
"""

from __future__ import annotations

import copy
import math
from collections.abc import Callable
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.finding import Refusal, Span
from gproof.ir.program import (
    PARAMETER,
    Block,
    BlockTable,
    Call,
    Declare,
    DeferredBlock,
    For,
    If,
    Jump,
    Label,
    Message,
    Mode,
    Number,
    Repeat,
    Return,
    Statement,
    Subprogram,
    Variable,
    While,
)
from gproof.ir.symbolic import Unknown, Value, behind_loop, bounds, hull
from gproof.ir.trace import Edge, Wait
from gproof.passes.interpret.core.call_stack import ANY, Frame, Group, Path
from gproof.passes.interpret.core.flow_part import FlowPart
from gproof.passes.interpret.core.loop_acceleration import LEFT
from gproof.passes.interpret.core.modal_state import Modal
from gproof.passes.interpret.core.outcomes import Asked
from gproof.passes.interpret.core.path_exploration import LOOPS
from gproof.passes.interpret.core.run import ProgramEnd

if TYPE_CHECKING:
    from gproof.passes.interpret.core.control_flow import ControlFlow

_OFTEN = "the number of loop passes"
FEW_FIRST = 16
"""So many first values of a loop are followed one by one."""
MAX_NESTED = 200
"""Blocks within blocks, those of calls included; a program that nests deeper is not followed."""


class StatementOrder(FlowPart):
    """What changes the order of statements."""

    def __init__(self, flow: ControlFlow) -> None:
        super().__init__(flow)
        self._places: dict[int, dict[str, int]] = {}
        self._set_by_program: frozenset[int] | None = None

    def enter(self, span: Span) -> None:
        """One block or call deeper; Refusal GP113 when that goes on for too long."""
        if self.flow.nesting >= MAX_NESTED:
            raise Refusal(codes.UNSUPPORTED_CODE.at(span, code=f"a nesting of more than {MAX_NESTED} blocks"))
        self.flow.nesting += 1

    # ---- jumps

    def jump(self, node: Jump) -> None:
        """Go on after a label."""
        self.run.spend(node.span)
        found = self._label(node.name)
        if found is None:
            raise Refusal(codes.UNSUPPORTED_CODE.at(node.span, code=self._no_label(node.name)))
        self.run.dialect.at_jump(self.run, node.span, f"M96 L{node.name}")
        depth, at = found
        self.flow.came_back = self.flow.came_back or at < self.flow.stack[depth].at
        self._leave_frames(depth, at)
        self.flow.widening.come_by((id(node), "jump"), node.span)
        self.flow.hot_passes.hot_jump(self.flow.stack[depth], node, at)

    def _label(self, name: str) -> tuple[int, int] | None:
        """Which frame has the label, and the place after it."""
        for depth in reversed(range(len(self.flow.stack))):
            frame = self.flow.stack[depth]
            at = self.labels(frame.body).get(name)
            if at is not None:
                return depth, at
            if frame.caller is not None:
                return None
        return None

    def labels(self, body: tuple[Statement, ...]) -> dict[str, int]:
        """The labels of a list of statements, with the place after each."""
        key = id(body)
        if key not in self._places:
            self._places[key] = {node.name: n + 1 for n, node in enumerate(body) if isinstance(node, Label)}
        return self._places[key]

    def _no_label(self, name: str) -> str:
        """Why a jump to a label is not followed."""
        bodies = [self.run.program.body, *(sub.body for sub in self.run.program.subprograms.values())]
        if any(_has_label(body, name) for body in bodies):
            return f"a jump to label {name}, inside a block or subprogram that is not running,"
        return f"a jump to label {name}, which does not exist,"

    def _leave_frames(self, depth: int, at: int) -> None:
        """End the blocks inside frame ``depth``, which goes on at ``at``."""
        gone = self.flow.stack[depth + 1 :]
        self.flow.nesting -= sum(frame.node is not None and not isinstance(frame.node, BlockTable) for frame in gone)
        self.flow.loops -= sum(isinstance(frame.node, LOOPS) for frame in gone)
        self.flow.stack = self.flow.stack[: depth + 1]
        self.flow.stack[-1].at = at
        self._out_of(gone)

    def _out_of(self, gone: list[Frame]) -> None:
        """Blocks are left for good: where other outcomes wait after them, these are one fewer.

        What goes on here is then an outcome like any other, in a section that others in the same state may join.
        """
        if all(frame.group is None for frame in gone):
            return
        self.flow.hot_blocks.run_pending()
        key = self.flow.paths.state_key("left")
        target = self.flow.joins.get(key)
        joins = target is not None
        if target is None:
            target = self.flow.joins[key] = self.run.rows.new_section()
        self.run.close_section((Edge(wait=Wait.BRANCH, outcome="", target=target),))
        if not joins:
            place = self.run.file, self.run.call, list(self.flow.called), self.run.moved, self.flow.nesting
            self.flow.waiting.append(Path(self.flow.stack, self.run.modal, target, place))
        self.flow.is_parked = True
        around = self.flow.stack
        self.flow.paths.arrived(gone, 1)
        if joins:
            # It goes on as the other one, within the blocks that are around.
            self.flow.paths.arrived(around, 1)
        raise ProgramEnd

    # ---- loops

    def loops_on(self, frame: Frame, node: While | Repeat | For) -> bool:
        """After a pass: whether another one follows, or both outcomes do."""
        self.run.spend(node.span)
        if isinstance(node, For):
            goes_on = self._next_pass(frame, node)
        else:
            asked = "repeat" if isinstance(node, Repeat) else "while"
            goes_on = self.flow.paths.holds(node.condition, (asked, id(node)))
            goes_on = not goes_on if isinstance(node, Repeat) and goes_on is not None else goes_on
        if goes_on is None:
            leaving = None
            if isinstance(node, For):
                cause = frame.last.cause if isinstance(frame.last, Unknown) else _OFTEN
                self.flow.paths.undecided(("for", id(node)), node.span, cause)
                leaving = self.run.modal.copy()
                self._after_for(frame, node, leaving)
            self.flow.widening.pass_by((id(node), "loop"), node.span)
            self.flow.paths.split(node, frame, leaving)
            goes_on = True
        elif goes_on and not isinstance(node, For):
            frame.at = 0
            self.flow.widening.come_by((id(node), "loop"), node.span)
            if self.flow.widening.pass_counts[id(node), "loop"] > 1:
                # A pass has reported what there is to report.
                self.flow.widening.leap_over(node)
                self.flow.hot_passes.hot_loop(frame, node)
        if isinstance(node, For):
            if goes_on:
                self._pass(frame, node)
                self.flow.hot_passes.hot_for(frame, node)
            else:
                self._after_for(frame, node, self.run.modal)
        return goes_on

    def again(self, frame: Frame) -> bool:
        """After a cycle of a call that has several: whether another one follows, or nobody counts them any more."""
        node = frame.node
        assert isinstance(node, Subprogram)
        if frame.again > 0 and self.flow.widening.is_alike((id(node), "call"), node.span, -1, frame.again, sure=True):
            frame.again = ANY
        if frame.again == ANY:
            self.flow.hot_blocks.run_pending()
            self.flow.paths.undecided(("call", id(node)), node.span, _OFTEN)
            self.flow.paths.split(node, frame)
            return True
        if frame.again:
            frame.again -= 1
            frame.at = 0
            self.flow.hot_passes.hot_call(frame, node)
            return True
        if frame.more:
            self.flow.hot_blocks.run_pending()
            self.flow.paths.undecided(
                ("call", id(node)), node.span, frame.last.cause if isinstance(frame.last, Unknown) else ""
            )
            self.flow.paths.split(node, frame)
            frame.more -= 1
            return True
        return False

    def begin_for(self, node: For) -> None:
        """Both bounds once; then the first pass, or none."""
        self.flow.hot_blocks.run_pending()
        self.run.spend(node.span)
        first, last = self.run.evaluator.value(node.first), self.run.evaluator.value(node.last)
        if isinstance(first, Unknown) and not first.whole:
            raise Refusal(codes.UNKNOWN_CONDITION.at(node.span, cause=first.cause))
        for value in (first, last):
            if not isinstance(value, Unknown) and (math.isinf(value) or value != round(value)):
                raise Refusal(codes.NOT_AN_INTEGER.at(node.span, word="a bound of a for loop", value=value))
        self.enter(node.span)
        self.flow.widening.counted.pop((id(node), "for"), None)
        if not isinstance(first, Unknown):
            self.flow.stack.append(self._for_frame(node, first, last))
        elif first.high - first.low < FEW_FIRST and self.run.branches + first.high - first.low < self.run.max_branches:
            self._fork_for(node, first, last)
        else:
            # Any of its values in any pass: more than there can be.
            frame = self._for_frame(node, first.high if node.down else first.low, last)
            frame.counter += -1.0 if node.down else 1.0
            frame.is_open = True
            self.flow.stack.append(frame)
        self.flow.loops += 1

    def _for_frame(self, node: For, first: float, last: Value) -> Frame:
        return Frame(node.body, node, len(node.body), counter=first + (1.0 if node.down else -1.0), last=last)

    def _fork_for(self, node: For, first: Unknown, last: Value) -> None:
        """Follow each first value that a loop may have, in a section of its own."""
        key = self.flow.paths.state_key(("first", id(node)))
        if key in self.flow.seen:
            self.run.close_section(self.flow.seen[key])
            raise ProgramEnd
        values = [first.low + n for n in range(round(first.high - first.low) + 1)]
        self.run.branches += len(values)
        targets = [self.run.rows.new_section() for _ in values]
        edges = tuple(
            self.run.edge(Wait.BRANCH, f"{value:g}", target, node.span)
            for value, target in zip(values, targets, strict=True)
        )
        self.flow.seen[key] = edges
        self.run.close_section(edges)
        group = Group(len(values))
        for frame in self.flow.stack:
            if frame.group is not None:
                frame.group.open += len(values) - 1
        place = self.run.file, self.run.call, list(self.flow.called), self.run.moved, self.flow.nesting
        before, stack = self.run.modal, self.flow.stack
        for value, target in zip(values, targets, strict=True):
            what = "the first value of the for loop"
            self.run.asked[target] = Asked(span=node.span, what=what, answer=f"is {value:g}")
            self.run.modal = before.copy()
            if isinstance(node.first, Variable) and self.flow.paths.may_narrow(
                number := self.flow.widening.number_of(node.first)
            ):
                self.run.modal.parameters[number] = value
            own = self.run.evaluator.value(node.last)
            frame = self._for_frame(node, value, own if isinstance(own, Unknown) or own == round(own) else last)
            frame.group = group
            self.flow.waiting.append(Path([*(copy.copy(one) for one in stack), frame], self.run.modal, target, place))
        # One of them goes on now.
        path = self.flow.waiting.pop()
        self.run.modal, self.flow.stack = path.modal, path.stack
        self.run.state_changed()
        self.run.begin_section(path.section)

    def _next_pass(self, frame: Frame, node: For) -> bool | None:
        """To the next value, True; over, False; None: not known."""
        step = -1.0 if node.down else 1.0
        number = self.flow.widening.number_of(node.variable)
        first = frame.cell == 0
        if not first:
            self.flow.hot_blocks.run_pending()
            if not self._is_counted(frame, node, number):
                name = node.variable.name or self.run.program.rules.name_of(number)
                what = f"a for loop that changes its own variable {name}"
                raise Refusal(codes.UNSUPPORTED_CODE.at(node.span, code=what))
        if frame.is_open:
            return None
        least, most = self.flow.widening.ends_of(frame, node)
        there = (frame.counter + step) * step
        if there > most:
            return False
        goes_on = True if there <= least else None
        if not first and least == most:
            frame.counter += step * self.flow.widening.leap_over(node, most - there - LEFT)
            there = (frame.counter + step) * step
        if not first and self.flow.widening.is_alike(
            (id(node), "for"), node.span, number, most - there, sure=least == most
        ):
            frame.is_open = True
            return None
        return goes_on

    def _counted_value(self, frame: Frame, node: For) -> Value:
        """What the variable holds during a pass."""
        if not frame.is_open:
            return frame.counter
        most = self.flow.widening.ends_of(frame, node)[1]
        low, high = (-most, frame.counter) if node.down else (frame.counter, most)
        return Unknown(_OFTEN, low, high)

    def _is_counted(self, frame: Frame, node: For, number: int) -> bool:
        """Whether the variable of a loop holds after a pass what it held in it, or what a guard has shown of that."""
        counted, held = self._counted_value(frame, node), self.run.modal.parameters.get(number)
        if held == counted or held is None or not frame.is_open:
            return held == counted
        (low, high), (least, most) = bounds(held), bounds(counted)
        return low >= least and high <= most and not self._is_set(number)

    def _is_set(self, number: int) -> bool:
        """Whether a statement of the program may set a variable, other than a counted loop."""
        if self._set_by_program is None:
            program = self.run.program
            bodies = [program.body, program.abort, *(sub.body for sub in program.subprograms.values())]
            self._set_by_program = frozenset().union(*(_targets(body, self.run.dialect.by_number) for body in bodies))
        return number in self._set_by_program or ANY in self._set_by_program

    def _pass(self, frame: Frame, node: For) -> None:
        """One more pass."""
        if not frame.is_open:
            frame.counter += -1.0 if node.down else 1.0
        frame.cell = 1
        self.run.modal.parameters[self.flow.widening.number_of(node.variable)] = self._counted_value(frame, node)
        frame.at = 0

    def _after_for(self, frame: Frame, node: For, modal: Modal) -> None:
        """What the variable holds after the loop: its last value, or one more, as Pascal leaves it open (8.3)."""
        number = self.flow.widening.number_of(node.variable)
        name = node.variable.name or self.run.program.rules.name_of(number)
        cause = behind_loop(name)
        step = -1.0 if node.down else 1.0
        if frame.cell == 0:
            # No pass: as it was, or the first value.
            before: Value = modal.parameters.get(number, Unknown(cause))
            # (``counter`` is still one before the first value, where that is known.)
            first = Unknown(cause, -math.inf, math.inf) if frame.is_open else frame.counter + step
            modal.parameters[number] = Unknown(cause, *hull(before, first))
            return
        low, high = bounds(self._counted_value(frame, node))
        modal.parameters[number] = Unknown(cause, min(low, low + step), max(high, high + step))

    # ---- subprograms

    def give_back(self, back: tuple[tuple[int, int], ...]) -> None:
        """What a procedure made of its ``var`` parameters, into the variables that it was called with."""
        for number, target in back:
            value = self.run.modal.parameters.get(number)
            if value is not None:
                self.run.modal.parameters[target] = value

    def go_back(self, node: Return) -> None:
        """Back to the caller, or on with the next cycle."""
        self.flow.hot_blocks.run_pending()
        self.run.spend(node.span)
        self.run.dialect.at_jump(self.run, node.span, node.code or "M17")
        place = next((n for n in reversed(range(len(self.flow.stack))) if self.flow.stack[n].caller is not None), -1)
        if place < 0:
            hint = "check the job that includes this file ($I): a file of subprograms is not a job"
            what = f"{node.code or 'M17'} outside of a subprogram"
            raise Refusal(codes.UNSUPPORTED_CODE.at(node.span, code=what, hint=hint))
        frame = self.flow.stack[place]
        self._leave_frames(place, len(frame.body) + 1)

    def module_end(self, frame: Frame) -> None:
        """GP515, and the end of the run: what comes next is not said."""
        self.flow.hot_blocks.run_pending()
        node = frame.node
        name = f"subprogram {node.name}" if isinstance(node, Subprogram) else "the program"
        last = frame.body[-1] if frame.body else None
        line = 0
        if isinstance(last, BlockTable):
            line = last.last_line
        elif last is not None:
            line = (getattr(last, "end_span", None) or last.span).line
        span = Span(self.run.trace.files[self.run.file], line or max(1, self.run.program.line_count))
        hint = "end it with M17" if isinstance(node, Subprogram) else "end it with M30 or M02"
        finding = codes.MODULE_END.at(span, name=name, hint=hint)
        self.run.refused = True
        self.run.fail(finding, told=(node.name if isinstance(node, Subprogram) else "") in self.run.program.unended)
        self.run.end_section(Wait.UNKNOWN, finding.message, -1, span)
        raise ProgramEnd


def _targets(body: tuple[Statement, ...], by_number: Callable[[int], tuple[int, ...]]) -> set[int]:
    """Numbers of the variables that statements may set, ``ANY`` where the text does not say that."""
    found: set[int] = set()
    for node in body:
        if isinstance(node, DeferredBlock):
            node = node.made()
        if isinstance(node, Block):
            given = [assign.target.number for assign in node.assigns]
            given += [word.value for word in node.words if word.letter == PARAMETER]
        elif isinstance(node, Call):
            # A procedure may give something back.
            given = [word.value.number for word in node.arguments if isinstance(word.value, Variable)]
        elif isinstance(node, If):
            found |= _targets(node.then, by_number) | _targets(node.otherwise, by_number)
            continue
        elif isinstance(node, While | Repeat | For):
            found |= _targets(node.body, by_number)
            continue
        else:
            sets_none = isinstance(node, BlockTable | Label | Jump | Return | Declare | Mode)
            if not sets_none and not (isinstance(node, Message) and node.kind != "dialog"):
                found.add(ANY)
            continue
        for number in given:
            found.update(by_number(round(number.value)) if isinstance(number, Number) else (ANY,))
    return found


def _has_label(body: tuple[Statement, ...], name: str) -> bool:
    for node in body:
        if isinstance(node, Label) and node.name == name:
            return True
        if isinstance(node, If) and (_has_label(node.then, name) or _has_label(node.otherwise, name)):
            return True
        if isinstance(node, While | Repeat | For) and _has_label(node.body, name):
            return True
    return False
