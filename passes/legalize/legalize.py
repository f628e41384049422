"""Bring a Job to what a target has, after the fashion of MLIR's dialect conversion.

An operation is legal when all its features are in the target's table. Otherwise the patterns for its highest feature
that is not are tried in order; what one of them gives is looked at again. Each pattern gives features of a lower rank
than the one it removes (or spends operations of a bounded number), so that this ends. Where none applies, the
construct is refused with its line and the patterns that were tried.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from gproof.ir.columns import Array
from gproof.ir.finding import Span
from gproof.ir.job import (
    ArcTo,
    ChangeTool,
    Choice,
    CountLoop,
    DrillHole,
    EndJob,
    Job,
    LoopWhile,
    Moves,
    MoveTo,
    Node,
    Nodes,
    NotRaised,
    OptionalPart,
    ParkAt,
    PauseJob,
    Remark,
    RepeatGrid,
    Routine,
    RunRoutine,
    SetFrame,
    SwitchCoolant,
    SwitchGuard,
    SwitchOutput,
    TurnSpindle,
    UseLength,
    bodies,
    used_routines,
    walk,
)
from gproof.ir.job_features import expressions, features, parts_of_expression, row_features
from gproof.ir.program import Binary, Number, Unary
from gproof.ir.record import field, record
from gproof.ir.target import FEATURES, RANK, Target
from gproof.passes.legalize.at_rest import at_rest, zero_changes
from gproof.passes.legalize.context import Context, TooLong
from gproof.passes.legalize.feeds import goes_on
from gproof.passes.legalize.kept import count_kept
from gproof.passes.legalize.options import Lowered, Options
from gproof.passes.legalize.pattern import Pattern
from gproof.passes.legalize.patterns.constants import fold
from gproof.passes.legalize.patterns.lengths import merged
from gproof.passes.legalize.patterns.straight_rapids import rests, straight_rows
from gproof.passes.legalize.registry import PATTERNS
from gproof.passes.legalize.structured import structured
from gproof.passes.legalize.transform import SAME, Transform

_TURNED = (Moves, MoveTo, ArcTo, DrillHole, ParkAt)
_IN_NUMBERS = frozenset(
    ("frame_rotate", "frame_scale", "frame_mirror", "frame_zero_at", "frame_zero_shift", "frame_zero_keep",
     "frame_zero_recall")
)  # fmt: skip
SAME_CLEARANCE = 1e-9
"""mm that two clearances differ by rounding."""


@record(frozen=True, slots=True)
class NotLegal:
    """A construct that the target does not have. tried: names of the patterns that did not apply."""

    construct: str
    why: str
    span: Span
    tried: tuple[str, ...] = ()


@record(slots=True, kw_only=True)
class Legal:
    """job: everything is legal in it but what is ``refused``, of which it has marks; spare_used: the spare work offset
    of the target holds zeros in machine places; kept: how often the source has each feature that stays as it is;
    lengths: mm of tools that are in the numbers; only: by axis the work offset that the target's only zero is."""

    job: Job
    lowered: list[Lowered] = field(default_factory=list)
    refused: list[NotLegal] = field(default_factory=list)
    assumed: list[str] = field(default_factory=list)
    spare_used: bool = False
    kept: Counter[str] = field(default_factory=Counter)
    lengths: dict[int, float] = field(default_factory=dict)
    only: dict[str, int] = field(default_factory=dict)


def legalize(job: Job, target: Target, options: Options) -> Legal:
    """The whole job. Where something is refused in a subprogram or a loop, because what is in force there is not the
    same in each run, these are opened: what they do stands one after the other."""
    if "jump" not in target.legal:
        job = structured(job)
    if any(isinstance(node, SwitchOutput) and node.moving for node in _everything(job)):
        before = "output_moving" not in target.legal
        zeros = zero_changes(job) if options.zeros_end_contours else None
        job = at_rest(job, before=before, zeros=zeros)
        found = _legalized(job, target, options)
        # More is certain of what is unrolled, and of choices that are decided.
        if not found.refused and zeros is not None and "output" in target.legal:
            found.job = at_rest(found.job, before=False, zeros=zeros)
        return found
    return _legalized(job, target, options)


def _legalized(job: Job, target: Target, options: Options) -> Legal:
    opened = Opened()
    legalizer = _Legalizer(job, target, options, opened)
    found = legalizer.run()
    for _ in range(MOST_ROUNDS):
        more = legalizer.to_open()
        if not more.routines | more.loops and more.choices <= opened.choices:
            break
        opened = Opened(opened.routines | more.routines, opened.loops | more.loops, more.choices or opened.choices)
        legalizer = _Legalizer(job, target, options, opened)
        again = legalizer.run()
        if not again.refused:
            return again
    return found


MOST_ROUNDS = 8
"""How often subprograms and loops are opened, each time deeper."""


@record(frozen=True, slots=True)
class Opened:
    """Subprograms by name, and loops by the key of their place, that are not kept; choices: nor those choices whose
    condition is known."""

    routines: frozenset[str] = frozenset()
    loops: frozenset[tuple[str, int]] = frozenset()
    choices: bool = False


def _everything(job: Job) -> Iterator[Node]:
    for body in (job.body, *(routine.body for routine in job.routines.values())):
        yield from walk(body)


def before_refusal(legal: Legal) -> Job:
    """What comes before the first construct that is refused, and a stop: each left a ``NotRaised`` in its place."""
    job = legal.job
    body: list[Node] = []
    span = legal.refused[0].span
    for node in job.body:
        lost = next((one for one in _all_within((node,), job) if isinstance(one, NotRaised)), None)
        if lost is not None:
            span = lost.span
            break
        body.append(node)
    text = f"the translation ends here: {legal.refused[0].construct}"
    body += [Remark(text=text, span=span), PauseJob(span=span), EndJob(span=span)]
    kept = used_routines(tuple(body), job.routines)
    return Job(source=job.source, files=job.files, body=tuple(body), routines=kept)


def _all_within(body: Nodes, job: Job) -> Iterator[Node]:
    """Operations of a body and of the routines that it runs."""
    yield from walk(body)
    for routine in used_routines(body, job.routines).values():
        yield from walk(routine.body)


class _Legalizer:
    def __init__(self, job: Job, target: Target, options: Options, opened: Opened) -> None:
        self.job = job
        self.target = target
        self.options = options
        self.opened = opened
        self.context = Context(job, target, options)
        self.refused: list[NotLegal] = []
        self.around: list[tuple[str, int]] = []
        self.in_routine = ""
        self.is_lost = False
        self.lost_in: set[str | tuple[str, int]] = set()
        self.patterns: dict[str, list[Pattern]] = {}
        for pattern in PATTERNS:
            for feature in pattern.removes:
                self.patterns.setdefault(feature, []).append(pattern)
        self.routines: dict[str, Routine] = {}
        self.kept: Counter[str] = Counter()

    def run(self) -> Legal:
        """The body first: it says which routines stay."""
        try:
            body = self.body(self.job.body)
            body = merged(body, self.context)
            for name in self._reached(body):
                self.context.begin_routine(name)
                self.in_routine = name
                routine = self.job.routines[name]
                self.routines[name] = replace(routine, body=self.body(routine.body))
        except TooLong:
            body = ()
            span = self.context.lowered[-1].span if self.context.lowered else Span(self.job.files[0], 1)
            why = "unrolled, it has more operations than can be written"
            self.refused.append(NotLegal("a loop or a subprogram", why, span))
            self.is_lost = True
        legal = Job(source=self.job.source, files=self.job.files, body=body, routines=self.routines)
        if not self.refused:
            legal.verify()
        return Legal(
            job=legal, lowered=self.context.lowered, refused=self.refused, assumed=list(self.context.assumed),
            spare_used=self.context.spare_used, lengths=dict(self.context.lengths_used), kept=self.kept,
            only=self.context.only,
        )  # fmt: skip

    def _refuse(self, found: NotLegal, *, for_good: bool = False) -> None:
        """for_good: nothing that is known besides would help."""
        self.refused.append(found)
        self.is_lost |= for_good
        closed = [loop for loop in self.around if loop not in self.opened.loops]
        if closed:
            self.lost_in.add(closed[-1])
        elif self.in_routine:
            self.lost_in.add(self.in_routine)

    def to_open(self) -> Opened:
        """Subprograms and loops that keep something from being known; nothing where that does not help."""
        if self.is_lost or not self.refused:
            return Opened(choices=self.opened.choices)
        names = {one for one in self.lost_in if isinstance(one, str)}
        loops = frozenset(one for one in self.lost_in if not isinstance(one, str))
        if not self.lost_in:
            kinds = (SetFrame, UseLength, ChangeTool, TurnSpindle, SwitchCoolant)
            names = {
                name for name in self.routines
                if any(isinstance(one, kinds) for one in self.context.routine_nodes(name))
            }  # fmt: skip
        return Opened(frozenset(names) - self.opened.routines, loops, bool(self.context.uneven))

    def _reached(self, body: Nodes) -> list[str]:
        """Routines that legal operations run, each after those that it runs itself were found."""
        found: dict[str, None] = {}
        rest = [body]
        while rest:
            for node in _runs(rest.pop()):
                if node.name not in found:
                    found[node.name] = None
                    rest.append(self.job.routines[node.name].body)
        return [name for name in self.job.routines if name in found]

    def missing(self, node: Node) -> list[str]:
        """Features that the target does not have, the highest first."""
        found = {feature for feature in features(node) if feature not in self.target.legal}
        if isinstance(node, SetFrame) and node.number is not None and node.action in {"select", "store", "store_here"}:
            number = self.context.value(node.number)
            if number is not None and number > self.target.offsets:
                found.add("frame_beyond")
        if self.target.operators and self._has_operator(node):
            found.add("operator")
        if isinstance(node, RunRoutine) and "variable" not in self.target.legal and self._is_computed(node):
            found.add("routine_arguments")
        if isinstance(node, RunRoutine) and (
            node.name in self.opened.routines or self._moves_zero(node) or self.context.transform != SAME
        ):
            found.add("routine")
        if self.opened.choices and isinstance(node, Choice) and self.context.value(node.condition) is not None:
            found.add("choice")
        if self.opened.loops and isinstance(node, LoopWhile | CountLoop) and _place(node) in self.opened.loops:
            found |= {"count_loop" if isinstance(node, CountLoop) else "repeat" if node.first else "while"}
        if isinstance(node, SetFrame) and self.context.loses_local(node):
            found.add("frame_select_local")
        if isinstance(node, SetFrame | ChangeTool) and self.context.loses_length(node):
            found.add("frame_length")
        if isinstance(node, SetFrame) and self.context.turns.get(_kind(node), SAME) != SAME:
            found.add(f"frame_{_kind(node)}")  # it is in the numbers, although the target has the operation
        if isinstance(node, DrillHole) and not self.target.cycle_returns and self._returns(node):
            found.add("cycle_return")
        if isinstance(node, SwitchGuard) and node.name not in self.target.guards:
            found.add("guard")
        if isinstance(node, Choice) and node.otherwise and not self.target.two_ways:
            found.add("choice_else")
        if isinstance(node, TurnSpindle) and node.direction in self.target.one_way and self.context.may_reverse(node):
            found.add("spindle_reverse")
        if isinstance(node, EndJob) and not node.rests and self.context.may_run:
            found |= {"end_reset_running" if node.reset else "end_running"} - self.target.legal.keys()
        if self.options.straight_rapids:
            found |= self._bent(node)
        if isinstance(node, DrillHole) and node.clearance is not None:
            own, given = self.target.peck_clearance, self.context.mm(node.clearance)
            if own is not None and given is not None and abs(given - own) < SAME_CLEARANCE:
                found.discard("cycle_clearance")
        return sorted(found, key=lambda feature: -RANK[feature])

    def _bent(self, node: Node) -> set[str]:
        """What an operation has where its rapids are not straight on one side, and have to be."""
        if self.context.feed_lost and goes_on(node):
            return {"rapid_straight"}
        if isinstance(node, Moves):
            return {"rapid_straight"} if straight_rows(node, self.context).any() else set()
        if isinstance(node, ParkAt):
            return {"rapid_straight"}
        if isinstance(node, MoveTo):
            several = len(node.to) if node.frame == "machine" else sum(not rests(one, self.context) for one in node.to)
            return {"rapid_straight"} if node.kind == "rapid" and several > 1 else set()
        several = sum(not rests(one, self.context) for one in node.at) if isinstance(node, DrillHole) else 0
        return {"cycle_straight"} if several > 1 else set()

    def _returns(self, node: DrillHole) -> bool:
        """Whether a hole moves to heights to which a cycle that only knows its top does not: after it, or first up."""
        top, before = self.context.mm(node.top.at), self.context.place.get(node.top.axis)
        is_below = top is not None and before is not None and not node.top.relative and before < top
        return node.back == "before" or is_below

    def _has_operator(self, node: Node) -> bool:
        """Whether an expression has an operator that the target's expressions do not have."""
        return any(
            isinstance(part, Unary | Binary) and part.operator not in self.target.operators
            for expr in expressions(node) if not isinstance(expr, Number) for part in parts_of_expression(expr)
        )  # fmt: skip

    def _is_computed(self, node: RunRoutine) -> bool:
        """Whether a routine works with variables, so that each of its runs is another list of moves."""
        return any("variable" in features(one) for one in self.context.routine_nodes(node.name))

    def _moves_zero(self, node: RunRoutine) -> bool:
        """Whether a routine sets what becomes numbers: what is in force before each of its runs counts."""
        return any(
            isinstance(one, SetFrame) and any(name not in self.target.legal for name in features(one) & _IN_NUMBERS)
            for one in self.context.routine_nodes(node.name)
        )

    def body(self, nodes: Nodes) -> Nodes:
        """A list of operations, legal."""
        found: list[Node] = []
        # With each operation whether its places are already those behind the transform in force, and whether the
        # source has it.
        rest = [(node, False, True) for node in reversed(nodes)]
        while rest:
            node, done, own = rest.pop()
            if not done and self.context.transform != SAME and isinstance(node, _TURNED):
                turned = self._turned(node)
                if turned is None:
                    found.append(self._lost_to_transform(node))
                    continue
                node, done, own = turned, True, False
            missing = self.missing(node)
            if not missing:
                if own:
                    count_kept(node, self.kept)
                inside = self._inside(node)
                self.context.after(inside)
                found.append(inside)
                continue
            instead = self._rewritten(node, missing[0])
            if instead is None:
                found += self._lost(node, missing[0])
                self.context.forget((node,))
            else:
                rest += [(one, done, False) for one in reversed(instead)]
        return tuple(found)

    def _turned(self, node: Node) -> Node | None:
        """A move behind the rotation, scaling or mirroring in force; None where a number is not known."""
        folded = fold(node, "", self.context)
        return self.context.through(node if folded is None else folded[0])

    def _lost_to_transform(self, node: Node) -> Node:
        why = "under a rotation, scaling or mirror, a number that it needs is not known"
        self._refuse(NotLegal("a move", why, node.span))
        self.context.forget((node,))
        return NotRaised(construct="a move", why=why, span=node.span)

    def _rewritten(self, node: Node, feature: str) -> list[Node] | None:
        tried = []
        self.context.why = ""
        for pattern in self.patterns.get(feature, ()):
            instead = pattern.apply(node, feature, self.context)
            if instead is not None:
                self._check_rank(pattern, feature, instead)
                self.context.lowered.append(Lowered(pattern.name, feature, self._place_of(node, feature)))
                return instead
            tried.append(pattern.name)
        if isinstance(node, NotRaised):
            self._refuse(NotLegal(node.construct, node.why, node.span), for_good=True)
        else:
            why = self.context.why or self.target.why_not(feature)
            where = self._place_of(node, feature)
            self._refuse(NotLegal(FEATURES[feature], why, where, tuple(tried)), for_good=not tried)
        return None

    def _rows_with(self, node: Moves, feature: str) -> Array | None:
        """The rows of a table that have a feature, where it is one of rows."""
        return straight_rows(node, self.context) if feature == "rapid_straight" else row_features(node).get(feature)

    def _place_of(self, node: Node, feature: str) -> Span:
        """The line of an operation, of a table that of its first row with a feature."""
        rows = self._rows_with(node, feature) if isinstance(node, Moves) else None
        if rows is None or not rows.any() or not isinstance(node, Moves):
            return node.span
        return replace(node.span, line=int(node.rows["line"][int(np.argmax(rows))]))

    def _lost(self, node: Node, feature: str) -> list[Node]:
        """What stands for a refused operation: the rows of a table before it, and a mark."""
        lost = NotRaised(construct=self.refused[-1].construct, why=self.refused[-1].why, span=self.refused[-1].span)
        if not isinstance(node, Moves):
            return [lost]
        rows = self._rows_with(node, feature)
        first = 0 if rows is None else int(np.argmax(rows))
        lost = replace(lost, span=replace(lost.span, line=int(node.rows["line"][first])))
        return [replace(node, rows=node.rows.slice(0, first)), lost] if first else [lost]

    def _check_rank(self, pattern: Pattern, feature: str, instead: list[Node]) -> None:
        if pattern.unrolls:
            self.context.spend(max(1, len(instead)))
            return
        high = [
            one for node in instead for one in features(node)
            if one not in self.target.legal and RANK[one] >= RANK[feature]
        ]  # fmt: skip
        if high:
            raise ValueError(f"pattern {pattern.name} gives {high[0]} for {feature}")

    def _inside(self, node: Node) -> Node:
        """An operation with what is within it legal too."""
        if not bodies(node):
            return node
        before = self.context
        if isinstance(node, Choice):
            entry = before.snapshot()
            then = self.body(node.then)
            after = before.snapshot()
            before.restore(entry)
            otherwise = self.body(node.otherwise)
            turned: dict[str, Transform] = after["turns"]
            before.join(after)
            self._same_turns(turned, node)
            return replace(node, then=then, otherwise=otherwise)
        assert isinstance(node, LoopWhile | CountLoop | OptionalPart | RepeatGrid)
        before.forget((node,))
        turns = dict(before.turns)
        before.program_place = {}
        is_loop = isinstance(node, LoopWhile | CountLoop)
        if is_loop:
            self.around.append(_place(node))
        body = self.body(node.body)
        if is_loop:
            self.around.pop()
        before.program_place = {}
        self._same_turns(turns, node)
        return replace(node, body=body)

    def _same_turns(self, turns: dict[str, Transform], node: Node) -> None:
        """Rotations that are in numbers are the same on every way to a place, or what follows is refused."""
        if {k: t for k, t in turns.items() if t != SAME} != {k: t for k, t in self.context.turns.items() if t != SAME}:
            why = "it is switched in a loop or on one way of a choice"
            is_loop = isinstance(node, LoopWhile | CountLoop)
            if is_loop:
                self.around.append(_place(node))
            self._refuse(NotLegal("rotation, scaling or mirror", why, node.span))
            if is_loop:
                self.around.pop()


def _place(node: Node) -> tuple[str, int]:
    return node.span.file, node.span.line


def _kind(node: SetFrame) -> str:
    """Of an action that has two ways, without the way: ``scale`` of ``scale_off``."""
    return node.action.partition("_")[0]


def _runs(body: Nodes) -> list[RunRoutine]:
    return [node for node in walk(body) if isinstance(node, RunRoutine)]
