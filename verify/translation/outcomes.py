"""Waits and their outcomes, side by side: what ends a stretch, and which outcome of one is which of the other."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from gproof.ir.trace import Edge, Trace, Wait
from gproof.verify.translation.comparison import Comparison, divergence
from gproof.verify.translation.sides import Side
from gproof.verify.translation.stretches import Stretch, is_joint
from gproof.verify.translation.words import facts, meanings

__all__ = ["is_joint", "is_same_wait", "matched", "say_assumptions", "waits_agree", "ways_into"]

ALIASES = {"ok": "yes", "cancel": "no"}
"""Answers of dialogs by the words of a question."""
PASSED = "come"
"""How the wait for an input ends where it has no time limit."""


def ways_into(trace: Trace) -> set[int]:
    """Sections that several edges lead to, loops and places where outcomes come together."""
    counts = Counter(edge.target for section in trace.sections for edge in section.edges)
    return {target for target, count in counts.items() if count > 1 and target >= 0} | {0}


def is_same_wait(one: Stretch, other: Stretch) -> bool:
    """Whether two stretches end with the same kind of wait, with as many outcomes."""
    a, b = one.edges, other.edges
    return len(a) == len(b) and (not a or (a[0].wait is b[0].wait and is_joint(a) == is_joint(b)))


def waits_agree(one: Stretch, other: Stretch, result: Comparison) -> bool:
    """Whether the waits are of one kind and can be followed; what is not is kept."""
    places = one.last_place, other.last_place
    waits = [stretch.edges[0].wait if stretch.edges else Wait.UNKNOWN for stretch in (one, other)]
    if Wait.UNKNOWN in waits:
        result.open(divergence("not followed", places))
        return False
    if is_same_wait(one, other):
        return True
    names = waits[0].value, waits[1].value
    if Wait.BRANCH in waits:
        # A condition that is open on one side may be decided on the other.
        result.open(divergence("branch", places, names=names))
    else:
        result.differs(divergence("wait", places, names=names))
    return False


def matched(one: Stretch, other: Stretch, result: Comparison) -> Iterator[tuple[Edge, Edge]]:
    """Edges that belong together."""
    wait = one.edges[0].wait
    places = one.last_place, other.last_place
    if len(one.edges) == 1:
        a, b = one.edges[0], other.edges[0]
        if wait is Wait.END and a.outcome != b.outcome:
            result.differs(divergence("outcome", places, names=(a.outcome, b.outcome)))
            return
        if wait is Wait.INPUT and a.outcome != b.outcome:
            result.open(divergence("timeout", places, names=(a.outcome, b.outcome)))
            return
        yield a, b
        return
    swapped = False
    asked = one.side.trace.questions.get(one.sections[-1])
    is_answered = wait is Wait.OPERATOR or (asked is not None and asked.kind == "answer")
    if is_answered and one.question != other.question:
        # What the operator answers rests on what is asked.
        result.open(divergence("question", places, names=(one.question, other.question)))
        return
    if wait is Wait.BRANCH:
        same = _same_question(one, other)
        if same is None:
            result.open(divergence("condition", places))
            return
        swapped = not same
    theirs = {_name(edge.outcome, swapped=swapped): edge for edge in other.edges}
    if {_name(edge.outcome) for edge in one.edges} != set(theirs):
        result.differs(divergence("outcome", places, names=(_listed(one.edges), _listed(other.edges))))
        return
    yield from ((edge, theirs[_name(edge.outcome)]) for edge in one.edges)


def _listed(edges: tuple[Edge, ...]) -> str:
    return ", ".join(edge.outcome for edge in edges)


def _name(outcome: str, *, swapped: bool = False) -> str:
    name = ALIASES.get(outcome.lower(), outcome.lower())
    return {"true": "false", "false": "true"}.get(name, name) if swapped else name


def _same_question(one: Stretch, other: Stretch) -> bool | None:
    """True: both ask the same; False: one asks the opposite; None: nobody can say."""
    a, b = (stretch.side.trace.questions.get(stretch.sections[-1]) for stretch in (one, other))
    if a is None or b is None or a.kind != b.kind:
        return None
    channels = one.side.inputs if a.kind == "input" else one.side.channels if a.kind == "output" else {}
    if channels.get(a.channel, a.channel) != b.channel:
        return None
    return a.on == b.on


def say_assumptions(sides: tuple[Side, Side], result: Comparison) -> None:
    """What the answer rests on whatever the rows say."""
    terms = sides[0].terms
    if terms.source != terms.target:
        result.assume("where a program sets no path mode, corners are as each controller takes them by itself")
    if any(state.compensation for side in sides for state in side.trace.states):
        result.assume("the radius of each tool is the one in the machine files")
    if terms.filter_left_out:
        result.assume("short moves are not joined (Q of G61, G64); how fast small angles are passed (R) is a setting")
    if terms.tool_by_stop:
        result.assume("at a stop that names a tool the operator puts in that tool")
    if any(side.polls for side in sides):
        result.assume("an input that a program reads again and again is noticed in time")
    if terms.left_out:
        result.assume(f"not compared, because one of the controllers does not have it: {facts(terms.left_out)}")
    for mine, side in (("source", sides[0]), ("target", sides[1])):
        for text in meanings(mine, side.meanings.values(), terms.axes):
            result.assume(text)
