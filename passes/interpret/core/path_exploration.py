"""Conditions that nobody can decide before the job runs: both outcomes are followed, and come together again.

What is still to do is a stack of frames, not Python's own: a run splits by copying it. Each outcome goes on with
its own stack and state in a section of its own; after the block whose condition was asked, outcomes wait for each
other, and those in the same state go on as one. docs/dialects/eding.md says what counts as not known.
"""

from __future__ import annotations

import copy
from collections.abc import Iterator
from functools import cached_property
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.finding import Refusal, Span
from gproof.ir.program import Binary, Expr, For, If, Number, Repeat, Subprogram, Unary, Variable, While
from gproof.ir.symbolic import Position, Unknown, Value
from gproof.ir.trace import Edge, Wait
from gproof.passes.interpret.core.call_stack import EXACT, NO_PLACE, Followed, Frame, Group, Path, Pending, merged
from gproof.passes.interpret.core.dead_variables import Idle
from gproof.passes.interpret.core.flow_part import FlowPart
from gproof.passes.interpret.core.modal_state import Modal
from gproof.passes.interpret.core.narrowing import Narrowing
from gproof.passes.interpret.core.notes_of_sections import question_of
from gproof.passes.interpret.core.outcomes import Asked, of_condition
from gproof.passes.interpret.core.run import ProgramEnd
from gproof.passes.interpret.core.state_key import NO_NUMBERS

if TYPE_CHECKING:
    from gproof.passes.interpret.core.control_flow import ControlFlow

LOOPS = (While, Repeat, For)
FEW = 16
"""Outcomes that are followed before anybody looks for variables that have no part in what happens."""


MANY = 4
"""One in so many of the outcomes that may be followed are many."""
NEAR = 2.0**24
"""Counters of 32 bits that are farther from 0 keep states apart: they may leave their 32 bits, which is an error."""


class PathExploration(FlowPart):
    """Splitting and joining of runs."""

    def __init__(self, flow: ControlFlow) -> None:
        super().__init__(flow)
        self._key: object = None
        self._followed: dict[object, Followed] = {}
        self._cover: Followed | None = None
        self._asks: dict[int, frozenset[int]] = {}

    @cached_property
    def idle(self) -> Idle:
        """Variables that have no part in what the program does."""
        return self.run.dialect.idle_variables()

    def holds(self, condition: Expr, place: tuple[str, int]) -> bool | None:
        """Whether a condition is true; None when the outcomes are to be explored. ProgramEnd where that is done."""
        known = self.flow.hot_blocks.fast_condition(condition)
        if known is not None:
            return known != 0
        self.flow.hot_blocks.run_pending()
        value = self.run.evaluator.value(condition)
        if not isinstance(value, Unknown):
            return value != 0
        if value.low > 0 or value.high < 0:
            return True
        question = question_of(self.run, condition)
        if question is not None:
            self.run.trace.questions[self.run.rows.section] = question
        self.undecided(place, condition.span, value.cause)
        return None

    def undecided(self, place: tuple[str, int], span: Span, cause: str) -> None:
        """Nobody can decide a question: ProgramEnd where its outcomes are explored, Refusal where they may not be."""
        self._cover = None
        key = self.state_key(place)
        if key in self.flow.seen:
            # The same question in the same state: its outcomes are followed already.
            self.run.close_section(self.flow.seen[key])
            raise ProgramEnd
        if self.run.branches > EXACT and self._is_followed(place):
            raise ProgramEnd
        if self.run.branches + 2 > self.run.max_branches:
            hint = "raise --max-branches to follow more branches" if self.run.max_branches else ""
            raise Refusal(codes.UNKNOWN_CONDITION.at(span, cause=cause, hint=hint))
        # What variables may be is more by now where outcomes are joined.
        self._key = self.state_key(place) if self.run.branches > EXACT else key

    def _is_followed(self, place: object) -> bool:
        """Whether a question was followed where variables may be all that they may be here, and more.

        If not, it is followed for what they may be here and, after some visits, for what they may have been then too.
        """
        without = self.without(self.idle.unread)
        held: dict[int, Unknown] = {}
        sure: list[tuple[int, Value]] = []
        for number, value in self.run.modal.parameters.items():
            if number in without:
                continue
            if isinstance(value, Unknown):
                held[number] = value
            else:
                sure.append((number, value))
        stack = tuple((id(f.body), f.at, id(f.node), f.position(), repr(f.caller)) for f in self.flow.stack)
        rest = self.run.modal.key(parameters=False)
        key = place, stack, tuple(self.flow.called), rest, frozenset(sure), frozenset(held)
        followed = self._followed.setdefault(key, Followed())
        if followed.covers(held):
            self.run.close_section(followed.edges)
            return True
        # There are many left, or bounds that grow with every pass would need all of them.
        far = MANY * self.run.branches > self.run.max_branches
        followed.held, followed.edges = followed.widened(held, far=far), ()
        self.run.modal.parameters.update(followed.held)
        self._cover = followed
        return False

    def state_key(self, place: object, without: frozenset[int] | None = None) -> object:
        """Equal where all that follows is the same; without: variables that have no part in it."""
        if without is None:
            without = self.without(self.idle.unread) if self.run.branches >= FEW else NO_NUMBERS
        # What is left of a calling line belongs to it: its words are values of that moment.
        stack = tuple((id(f.body), f.at, id(f.node), f.position(), repr(f.caller)) for f in self.flow.stack)
        return place, stack, tuple(self.flow.called), self.run.modal.key(without=without)

    def without(self, idle: frozenset[int]) -> frozenset[int]:
        """Those of idle variables that may differ between states now; that they stay what they are is assumed."""
        counters = idle & self.idle.counters
        if not counters:
            return idle
        far = {number for number in counters if self.is_far(number)}
        for number in sorted(counters - far):
            self.run.assumed[f"{self.name(number)} only counts and stays within 32 bits (11)"] = None
        return idle - far

    def is_far(self, number: int) -> bool:
        """Whether a counter is so far from 0 that it may leave its 32 bits."""
        value = self.run.modal.parameters.get(number)
        return isinstance(value, float) and abs(value) > NEAR

    def name(self, number: int) -> str:
        """What the program calls a variable."""
        return self.run.evaluator.names.get(number) or self.run.program.rules.name_of(number)

    def split(
        self, node: If | While | Repeat | For | Subprogram, loop: Frame | None, leaving: Modal | None = None
    ) -> None:
        """Follow the outcome that goes into a block now and the other later, each in a section of its own.

        node: a subprogram where it is open whether it runs once more. leaving: the state of the other outcome, where it
        is not the one that is.
        """
        self.run.branches += 2
        yes, no = self.run.rows.new_section(), self.run.rows.new_section()
        names = (("true", yes), ("false", no))
        if isinstance(node, Repeat):
            names = (("false", yes), ("true", no))
        edges = tuple(self.run.edge(Wait.BRANCH, outcome, target, node.span) for outcome, target in names)
        if isinstance(node, If | While | Repeat):
            answers = [of_condition(node.condition, node.span, truth=outcome == "true") for outcome, _ in names]
        else:
            what = "the for loop" if isinstance(node, For) else f"subprogram {node.name}"
            goes = ("goes on", "ends") if isinstance(node, For) else ("runs again", "does not run again")
            answers = [Asked(span=node.span, what=what, answer=answer) for answer in goes]
        self.run.asked.update((edge.target, answer) for edge, answer in zip(edges, answers, strict=True))
        self.flow.seen[self._key] = edges
        if self._cover is not None:
            self._cover.edges, self._cover = edges, None
        self.run.close_section(edges)
        if loop is not None and loop.group is None:
            loop.group = Group(1)
        for frame in self.flow.stack:
            if frame.group is not None:
                frame.group.open += 1
        other = [copy.copy(frame) for frame in self.flow.stack]
        if loop is None:
            assert isinstance(node, If)
            group = Group(2)
            leaving = self.run.modal.copy()
            group.narrowed = self._narrow(node.condition, leaving)
            self.flow.stack.append(Frame(node.then, node, group=group))
            other.append(Frame(node.otherwise, node, group=group))
            nesting = self.flow.nesting
        else:
            loop.at = 0
            if isinstance(node, While | Repeat):
                leaving = leaving or self.run.modal.copy()
                into, out = (leaving, self.run.modal) if isinstance(node, Repeat) else (self.run.modal, leaving)
                self._narrow(node.condition, out, into)
            if isinstance(node, Subprogram):
                # It still has to go back to its caller.
                other[-1].again, other[-1].more, other[-1].at = 0, 0, len(loop.body) + 1
                nesting = self.flow.nesting
            else:
                other[-1] = Frame((), group=loop.group)
                nesting = self.flow.nesting - 1
        place = self.run.file, self.run.call, list(self.flow.called), self.run.moved, nesting
        self.flow.waiting.append(Path(other, leaving or self.run.modal.copy(), no, place))
        self.run.begin_section(yes)

    def _narrow(
        self, condition: Expr, otherwise: Modal, holds: Modal | None = None
    ) -> dict[int, tuple[Value | None, tuple[Value, ...]]]:
        """What a condition says of variables, into the state where it holds and the one where it does not.

        holds: the state of the run where it is not given. Returns what ``Group.narrowed`` has.
        """
        holds = holds or self.run.modal
        says = Narrowing(self._quietly, self.may_narrow)
        found = [says.narrowed(condition, truth) for truth in (True, False)]
        before = dict(self.run.modal.parameters)
        for state, bounds in zip((holds, otherwise), found, strict=True):
            state.parameters.update(bounds)
        numbers = found[0].keys() | found[1].keys()
        return {
            number: (before.get(number), tuple(one[number] for one in found if number in one)) for number in numbers
        }

    def _quietly(self, number: float, span: Span) -> Value:
        """What a variable holds, without a word about it."""
        return self.run.dialect.of_its_type(round(number), self.run.modal.read(number, span))

    def may_narrow(self, number: int) -> bool:
        """Whether what is known of a variable may be less than what it holds: nobody but the program changes it."""
        _, entry = self.run.modal.range_of(float(number), NO_PLACE)
        return entry.kind in ("free", "persistent") or (entry.kind != "system" and number in self.run.modal.parameters)

    def await_others(self, group: Group) -> None:
        """After a block whose outcomes are explored: wait for the others, unless somebody was here in this state."""
        self.flow.hot_blocks.run_pending()
        wide = self._without_answer(group)
        wide_key = None if wide is None else self._key_of_state(wide)
        same = group.wide.get(wide_key)
        if wide is not None and same is not None:
            # It differs from another one only in what the answer has shown of variables: let that go.
            same.modal = wide
            self.run.close_section((Edge(wait=Wait.BRANCH, outcome="", target=same.section),))
            self.flow.stack = [*self.flow.stack, Frame((), group=group)]
            raise ProgramEnd
        key = self.state_key("join")
        target = self.flow.joins.get(key)
        if target is None:
            target = self.flow.joins[key] = self.run.rows.new_section()
            place = self.run.file, self.run.call, list(self.flow.called), self.run.moved, self.flow.nesting
            path = Path(self.flow.stack, self.run.modal, target, place)
            group.parked.append(path)
            if wide_key is not None:
                group.wide[wide_key] = path
            self.flow.is_parked = True
        self.run.close_section((Edge(wait=Wait.BRANCH, outcome="", target=target),))
        if self.flow.is_parked:
            group.open -= 1
            if not group.open:
                self._release(group)
        else:
            # One outcome less: it goes on as the other one.
            self.flow.stack = [*self.flow.stack, Frame((), group=group)]
        raise ProgramEnd

    def _without_answer(self, group: Group) -> Modal | None:
        """The state with variables that only the answer has narrowed as they were before; None where there are none."""
        if not group.narrowed:
            return None
        modal = self.run.modal.copy()
        for number, (before, answers) in group.narrowed.items():
            if modal.parameters.get(number) in answers:
                if before is None:
                    modal.parameters.pop(number)
                else:
                    modal.parameters[number] = before
        return modal

    def _key_of_state(self, modal: Modal) -> object:
        own, self.run.modal = self.run.modal, modal
        key = self.state_key("join")
        self.run.modal = own
        return key

    def arrived(self, stack: list[Frame], count: int) -> None:
        """So many outcomes fewer are on their way within the blocks of a stack."""
        for frame in reversed(stack):
            group = frame.group
            if group is not None:
                group.open -= count
                if not group.open:
                    self._release(group)

    def _release(self, group: Group) -> None:
        """All outcomes of a question have arrived or ended: those that arrived go on."""
        parked, group.parked = group.parked, []
        group.wide = {}
        exact = self.run.branches <= EXACT
        asked = () if exact or not parked else self._asked_around(parked)
        for path, same in merged(parked, self._anywhere, exact=exact, asked=asked):
            if path.section < 0:
                path.section = self.run.rows.new_section()
                for one in same:
                    # From where each arrived, without a move, to where all go on.
                    self.resume(one)
                    self.run.close_section((Edge(wait=Wait.BRANCH, outcome="", target=path.section),))
                self.arrived(path.stack, len(same) - 1)
            self.flow.waiting.append(path)

    def _anywhere(self, axis: int, low: float, high: float, origin: Position) -> Position:
        """A place whose distance from another one is between two numbers."""
        return self.run.unknown_place("value", axis, (low, high), origin)

    def _asked_around(self, parked: list[Path]) -> set[int]:
        """Variables that the conditions of the loops around some outcomes need."""
        found: set[int] = set()
        for frame in parked[0].stack:
            if isinstance(frame.node, While | Repeat):
                key = id(frame.node)
                if key not in self._asks:
                    self._asks[key] = frozenset(_variables(frame.node.condition))
                found |= self._asks[key]
        return found

    def resume(self, path: Path) -> None:
        """Take up an outcome that waits."""
        self.run.modal, self.flow.stack = path.modal, path.stack
        self.flow.hot_blocks.pending = Pending()
        self.flow.loops = sum(isinstance(frame.node, LOOPS) for frame in self.flow.stack)
        self.run.file, self.run.call, self.flow.called, self.run.moved, self.flow.nesting = path.place
        self.run.ended_by = None
        self.flow.widening.laps = {}
        self.run.state_changed()
        self.run.begin_section(path.section)


def _variables(expr: Expr) -> Iterator[int]:
    """Numbers of the variables that an expression reads, as far as they are written."""
    if isinstance(expr, Variable):
        if isinstance(expr.number, Number):
            yield round(expr.number.value)
    elif isinstance(expr, Unary):
        yield from _variables(expr.operand)
    elif isinstance(expr, Binary):
        yield from _variables(expr.left)
        yield from _variables(expr.right)
