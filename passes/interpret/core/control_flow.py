"""Jumps, labels, returns, counted loops and calls of languages that have them.

A jump goes to a label in its own list of statements or in one around it, within its subprogram (``ir.program.Jump``).
"""

from __future__ import annotations

import copy
import math

from gproof.ir import codes
from gproof.ir.dialects.mcuwin import COMMON, DECLARED
from gproof.ir.dialects.mcuwin_settings import VERSIONS
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
from gproof.passes.interpret.core.hot_passes import HotPasses
from gproof.passes.interpret.core.loop_acceleration import LEFT
from gproof.passes.interpret.core.modal_state import Modal
from gproof.passes.interpret.core.outcomes import Asked
from gproof.passes.interpret.core.path_exploration import LOOPS
from gproof.passes.interpret.core.trace_writer import ProgramEnd
from gproof.passes.interpret.mcuwin.state import din_of

_OFTEN = "how often the loop runs"
FEW_FIRST = 16
"""So many first values of a loop are followed one by one."""
MAX_NESTED = 200
"""Blocks within blocks, those of calls counted in; a program that nests deeper is not followed."""


class Flow(HotPasses):
    """What changes the order of statements."""

    def _enter(self, span: Span) -> None:
        """One block or call deeper; Refusal GP113 when that goes on for too long."""
        if self._nesting >= MAX_NESTED:
            raise Refusal(codes.UNSUPPORTED_CODE.at(span, code=f"a nesting of more than {MAX_NESTED} blocks"))
        self._nesting += 1

    # ---- jumps

    def _jump(self, node: Jump) -> None:
        """Go on behind a label."""
        self.spend(node.span)
        found = self._label(node.name)
        if found is None:
            raise Refusal(codes.UNSUPPORTED_CODE.at(node.span, code=self._no_label(node.name)))
        self._not_spooled(node.span, f"M96 L{node.name}")
        depth, at = found
        self._came_back = self._came_back or at < self._stack[depth].at
        self._leave_frames(depth, at)
        self._lap((id(node), "jump"), node.span)
        self._hot_jump(self._stack[depth], node, at)

    def _label(self, name: str) -> tuple[int, int] | None:
        """Which frame has the label, and the place behind it."""
        for depth in reversed(range(len(self._stack))):
            frame = self._stack[depth]
            at = self._labels(frame.body).get(name)
            if at is not None:
                return depth, at
            if frame.caller is not None:
                return None
        return None

    def _labels(self, body: tuple[Statement, ...]) -> dict[str, int]:
        key = id(body)
        if key not in self._places:
            self._places[key] = {node.name: n + 1 for n, node in enumerate(body) if isinstance(node, Label)}
        return self._places[key]

    def _no_label(self, name: str) -> str:
        """Why a jump to a label is not followed."""
        bodies = [self.program.body, *(sub.body for sub in self.program.subprograms.values())]
        if any(_has_label(body, name) for body in bodies):
            return f"a jump to label {name}, which stands in a block or a subprogram that is not running,"
        return f"a jump to label {name}, which is nowhere,"

    def _leave_frames(self, depth: int, at: int) -> None:
        """End the blocks inside frame ``depth``, which goes on at ``at``."""
        gone = self._stack[depth + 1 :]
        self._nesting -= sum(frame.node is not None and not isinstance(frame.node, BlockTable) for frame in gone)
        self._loops -= sum(isinstance(frame.node, LOOPS) for frame in gone)
        self._stack = self._stack[: depth + 1]
        self._stack[-1].at = at
        self._out_of(gone)

    def _out_of(self, gone: list[Frame]) -> None:
        """Blocks are left for good: where other outcomes wait behind them, these are one fewer.

        What goes on here is then an outcome like any other, in a section that others in the same state may join.
        """
        if all(frame.group is None for frame in gone):
            return
        self._run_pending()
        key = self._state_key("left")
        target = self._joins.get(key)
        joins = target is not None
        if target is None:
            target = self._joins[key] = self.rows.new_section()
        self._close((Edge(wait=Wait.BRANCH, outcome="", target=target),))
        if not joins:
            place = self._file, self._call, list(self._depth), self._moved, self._nesting
            self._waiting.append(Path(self._stack, self.modal, target, place))
        self._is_parked = True
        around = self._stack
        self._arrived(gone, 1)
        if joins:
            # It goes on as the other one, within the blocks that are around.
            self._arrived(around, 1)
        raise ProgramEnd

    def _not_spooled(self, span: Span, code: str) -> None:
        """GP513: before 2.5.3.41 jumps, calls, returns and labels ended a contour (14)."""
        if not self.program.rules.source_order or din_of(self.machine).version != VERSIONS[1]:
            return
        if self.modal.din.contour:
            self._run_pending()
            self.findings.add(codes.CONTOUR_BREAK.at(span, code=code))
            self.modal.din = self.modal.din.but(contour=False)

    # ---- loops

    def _loops_on(self, frame: Frame, node: While | Repeat | For) -> bool:
        """Behind a pass: whether another one follows, or both outcomes do."""
        self.spend(node.span)
        if isinstance(node, For):
            goes_on = self._next_pass(frame, node)
        else:
            asked = "repeat" if isinstance(node, Repeat) else "while"
            goes_on = self._holds(node.condition, (asked, id(node)))
            goes_on = not goes_on if isinstance(node, Repeat) and goes_on is not None else goes_on
        if goes_on is None:
            leaving = None
            if isinstance(node, For):
                cause = frame.last.cause if isinstance(frame.last, Unknown) else _OFTEN
                self._undecided(("for", id(node)), node.span, cause)
                leaving = self.modal.copy()
                self._after_for(frame, node, leaving)
            self._pass_by((id(node), "loop"), node.span)
            self._split(node, frame, leaving)
            goes_on = True
        elif goes_on and not isinstance(node, For):
            frame.at = 0
            self._lap((id(node), "loop"), node.span)
            if self._passes[id(node), "loop"] > 1:
                # A pass has told what there is to tell.
                self._leap(node)
                self._hot_loop(frame, node)
        if isinstance(node, For):
            if goes_on:
                self._pass(frame, node)
                self._hot_for(frame, node)
            else:
                self._after_for(frame, node, self.modal)
        return goes_on

    def _again(self, frame: Frame) -> bool:
        """Behind a cycle of a call that has several: whether another one follows, or nobody counts them any more."""
        node = frame.node
        assert isinstance(node, Subprogram)
        if frame.again > 0 and self._is_alike((id(node), "call"), node.span, -1, frame.again, sure=True):
            frame.again = ANY
        if frame.again == ANY:
            self._run_pending()
            self._undecided(("call", id(node)), node.span, _OFTEN)
            self._split(node, frame)
            return True
        if frame.again:
            frame.again -= 1
            frame.at = 0
            self._hot_call(frame, node)
            return True
        if frame.more:
            self._run_pending()
            self._undecided(("call", id(node)), node.span, frame.last.cause if isinstance(frame.last, Unknown) else "")
            self._split(node, frame)
            frame.more -= 1
            return True
        return False

    def _begin_for(self, node: For) -> None:
        """Both bounds once; then the first pass, or none."""
        self._run_pending()
        self.spend(node.span)
        first, last = self.evaluator.value(node.first), self.evaluator.value(node.last)
        if isinstance(first, Unknown) and not first.whole:
            raise Refusal(codes.UNKNOWN_CONDITION.at(node.span, cause=first.cause))
        for value in (first, last):
            if not isinstance(value, Unknown) and (math.isinf(value) or value != round(value)):
                raise Refusal(codes.NOT_AN_INTEGER.at(node.span, word="a bound of a for loop", value=value))
        self._enter(node.span)
        self._counted.pop((id(node), "for"), None)
        if not isinstance(first, Unknown):
            self._stack.append(self._for_frame(node, first, last))
        elif first.high - first.low < FEW_FIRST and self.branches + first.high - first.low < self.max_branches:
            self._fork_for(node, first, last)
        else:
            # Any of its values in any pass: more than there can be.
            frame = self._for_frame(node, first.high if node.down else first.low, last)
            frame.counter += -1.0 if node.down else 1.0
            frame.is_open = True
            self._stack.append(frame)
        self._loops += 1

    def _for_frame(self, node: For, first: float, last: Value) -> Frame:
        return Frame(node.body, node, len(node.body), counter=first + (1.0 if node.down else -1.0), last=last)

    def _fork_for(self, node: For, first: Unknown, last: Value) -> None:
        """Follow each first value that a loop may have, in a section of its own."""
        key = self._state_key(("first", id(node)))
        if key in self._seen:
            self._close(self._seen[key])
            raise ProgramEnd
        values = [first.low + n for n in range(round(first.high - first.low) + 1)]
        self.branches += len(values)
        targets = [self.rows.new_section() for _ in values]
        edges = tuple(
            self._edge(Wait.BRANCH, f"{value:g}", target, node.span)
            for value, target in zip(values, targets, strict=True)
        )
        self._seen[key] = edges
        self._close(edges)
        group = Group(len(values))
        for frame in self._stack:
            if frame.group is not None:
                frame.group.open += len(values) - 1
        place = self._file, self._call, list(self._depth), self._moved, self._nesting
        before, stack = self.modal, self._stack
        for value, target in zip(values, targets, strict=True):
            what = "the first value of the for loop"
            self.asked[target] = Asked(span=node.span, what=what, answer=f"is {value:g}")
            self.modal = before.copy()
            if isinstance(node.first, Variable) and self._may_narrow(number := self._number(node.first)):
                self.modal.parameters[number] = value
            own = self.evaluator.value(node.last)
            frame = self._for_frame(node, value, own if isinstance(own, Unknown) or own == round(own) else last)
            frame.group = group
            self._waiting.append(Path([*(copy.copy(one) for one in stack), frame], self.modal, target, place))
        # One of them goes on now.
        path = self._waiting.pop()
        self.modal, self._stack = path.modal, path.stack
        self._state_changed()
        self._begin(path.section)

    def _next_pass(self, frame: Frame, node: For) -> bool | None:
        """To the next value, True; over, False; None: nobody knows."""
        step = -1.0 if node.down else 1.0
        number = self._number(node.variable)
        first = frame.cell == 0
        if not first:
            self._run_pending()
            if not self._is_counted(frame, node, number):
                name = node.variable.name or self.program.rules.name_of(number)
                what = f"a for loop whose variable {name} its body changes"
                raise Refusal(codes.UNSUPPORTED_CODE.at(node.span, code=what))
        if frame.is_open:
            return None
        least, most = self._ends(frame, node)
        there = (frame.counter + step) * step
        if there > most:
            return False
        goes_on = True if there <= least else None
        if not first and least == most:
            frame.counter += step * self._leap(node, most - there - LEFT)
            there = (frame.counter + step) * step
        if not first and self._is_alike((id(node), "for"), node.span, number, most - there, sure=least == most):
            frame.is_open = True
            return None
        return goes_on

    def _counted_value(self, frame: Frame, node: For) -> Value:
        """What the variable holds during a pass."""
        if not frame.is_open:
            return frame.counter
        most = self._ends(frame, node)[1]
        low, high = (-most, frame.counter) if node.down else (frame.counter, most)
        return Unknown(_OFTEN, low, high)

    def _is_counted(self, frame: Frame, node: For, number: int) -> bool:
        """Whether the variable of a loop holds behind a pass what it held in it, or what a guard has told of that."""
        counted, held = self._counted_value(frame, node), self.modal.parameters.get(number)
        if held == counted or held is None or not frame.is_open:
            return held == counted
        (low, high), (least, most) = bounds(held), bounds(counted)
        return low >= least and high <= most and not self._is_set(number)

    def _is_set(self, number: int) -> bool:
        """Whether a statement of the program may set a variable, other than a counted loop."""
        if self._set_by_program is None:
            program = self.program
            bodies = [program.body, program.abort, *(sub.body for sub in program.subprograms.values())]
            self._set_by_program = frozenset().union(*map(_targets, bodies))
        return number in self._set_by_program or ANY in self._set_by_program

    def _pass(self, frame: Frame, node: For) -> None:
        """One more pass."""
        if not frame.is_open:
            frame.counter += -1.0 if node.down else 1.0
        frame.cell = 1
        self.modal.parameters[self._number(node.variable)] = self._counted_value(frame, node)
        frame.at = 0

    def _after_for(self, frame: Frame, node: For, modal: Modal) -> None:
        """What the variable holds behind the loop: its last value, or one more, as Pascal leaves it open (8.3)."""
        number = self._number(node.variable)
        name = node.variable.name or self.program.rules.name_of(number)
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

    def _count(self, node: Call) -> tuple[int, Value]:
        """How often a call runs its subprogram at least, and how often (4.16).

        Refusal for what is no positive whole number, or may be none.
        """
        if node.count is None:
            return 1, 1.0
        value = self.evaluator.value(node.count)
        if isinstance(value, Unknown):
            if value.whole and value.low >= 1.0 and value.high <= self.max_branches:
                return round(value.low), value
            raise Refusal(codes.UNKNOWN_CONDITION.at(node.span, cause=value.cause))
        if math.isinf(value) or value != round(value):
            raise Refusal(codes.NOT_AN_INTEGER.at(node.span, word="O", value=value))
        if value < 0:
            raise Refusal(codes.ILLEGAL_VALUE.at(node.span, word="O", what=f"{value:g} cycles of a subprogram"))
        if value == 0:
            raise Refusal(codes.UNSUPPORTED_CODE.at(node.span, code="O0 (no cycle of the subprogram, or one)"))
        return round(value), value

    def _bind(self, node: Call) -> tuple[tuple[int, int], ...]:
        """Arguments into the variables of a procedure's parameters, and its own variables without a value.

        Gives what the procedure hands back: (parameter, variable of the caller), by their numbers.
        """
        sub = self.program.subprograms.get(node.name)
        if sub is None or sub.is_module:
            return ()
        if sub.parameters and node.name in self._depth:
            raise Refusal(codes.UNSUPPORTED_CODE.at(node.span, code=f"procedure {node.name}, which calls itself,"))
        parameters = self.modal.parameters
        given: list[tuple[int, Value | None, Span]] = []
        back = []
        for (_, type_, number), word in zip(sub.parameters, node.arguments, strict=True):
            if type_.startswith("var "):
                if not isinstance(word.value, Variable):
                    raise Refusal(codes.BAD_EXPRESSION.at(word.span, what="a variable is needed here"))
                target = self._number(word.value)
                back.append((number, target))
                # One that holds nothing yet is what the procedure may be there to set.
                empty = target >= DECLARED and target not in parameters
                given.append((number, None if empty else self.evaluator.value(word.value), word.span))
            else:
                given.append((number, self.evaluator.value(word.value), word.span))
        for number, value, span in given:
            if value is None:
                parameters.pop(number, None)
            else:
                self.modal.write(float(number), value, span)
        for one in sub.body:
            if isinstance(one, Declare) and one.kind == "var":
                for number in range(one.number, one.number + len(one.names)):
                    parameters.pop(number, None)
        return tuple(back)

    def _give_back(self, back: tuple[tuple[int, int], ...]) -> None:
        """What a procedure made of its ``var`` parameters, into the variables that it was called with."""
        for number, target in back:
            value = self.modal.parameters.get(number)
            if value is not None:
                self.modal.parameters[target] = value

    def _return(self, node: Return) -> None:
        """Back to the caller, or on with the next cycle."""
        self._run_pending()
        self.spend(node.span)
        self._not_spooled(node.span, node.code or "M17")
        place = next((n for n in reversed(range(len(self._stack))) if self._stack[n].caller is not None), -1)
        if place < 0:
            hint = "a file of subprograms is no job: check the one that includes it ($I)"
            what = f"{node.code or 'M17'} outside of a subprogram"
            raise Refusal(codes.UNSUPPORTED_CODE.at(node.span, code=what, hint=hint))
        frame = self._stack[place]
        self._leave_frames(place, len(frame.body) + 1)

    def _falls_off(self, frame: Frame) -> bool:
        """Whether the text of a module is over without an end (GP515): what stands behind it is another module."""
        if not self.program.rules.source_order or frame.at > len(frame.body):
            return False
        node = frame.node
        if node is None:
            old = din_of(self.machine).version == VERSIONS[1]
            # Before 2.5.3.90 a program needed no M30, where nothing else stands behind it (14 (2.5.3.30)).
            ends = old and not any(sub.is_module for sub in self.program.subprograms.values())
            return frame.body is self.program.body and not ends
        return isinstance(node, Subprogram) and (node.is_module or node.name[:1].isdigit())

    def _module_end(self, frame: Frame) -> None:
        self._run_pending()
        node = frame.node
        name = f"subprogram {node.name}" if isinstance(node, Subprogram) else "the program"
        last = frame.body[-1] if frame.body else None
        line = 0
        if isinstance(last, BlockTable):
            line = last.last_line
        elif last is not None:
            line = (getattr(last, "end_span", None) or last.span).line
        span = Span(self.trace.files[self._file], line or max(1, self.program.line_count))
        hint = "M17 at its end" if isinstance(node, Subprogram) else "M30 or M02 at its end"
        finding = codes.MODULE_END.at(span, name=name, hint=hint)
        self.refused = True
        self._fail(finding, told=(node.name if isinstance(node, Subprogram) else "") in self.program.unended)
        self._end_section(Wait.UNKNOWN, finding.message, -1, span)
        raise ProgramEnd


def _targets(body: tuple[Statement, ...]) -> set[int]:
    """Numbers of the variables that statements may set, ``ANY`` where that is not told by the text."""
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
            found |= _targets(node.then) | _targets(node.otherwise)
            continue
        elif isinstance(node, While | Repeat | For):
            found |= _targets(node.body)
            continue
        else:
            sets_none = isinstance(node, BlockTable | Label | Jump | Return | Declare | Mode)
            if not sets_none and not (isinstance(node, Message) and node.kind != "dialog"):
                found.add(ANY)
            continue
        for number in given:
            found.update((round(number.value), COMMON + round(number.value)) if isinstance(number, Number) else (ANY,))
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
