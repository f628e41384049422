"""Variables that a job reads and never sets: they hold on its own controller what somebody else has put there.

Another controller has nothing there, or something else. What the setup states is set at the start of the job; the
others are refused by name.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from gproof.ir.finding import Span
from gproof.ir.job import CountLoop, Job, Node, NotRaised, Remark, RunRoutine, SetVariable, walk
from gproof.ir.job_features import expressions, parts_of_expression
from gproof.ir.program import Expr, Number, Variable


def with_stated(job: Job, values: Mapping[int, float], users: Sequence[range]) -> Job:
    """The job with settings of what it reads and never sets; NotRaised at the first use of what nobody states.

    users: numbers of the variables that are the programs' own.
    """
    read, written = _used(job)
    if written is None:
        return job
    missing = {
        number: span for number, span in read.items()
        if number not in written and any(number in one for one in users)
    }  # fmt: skip
    settings: list[Node] = []
    for number, span in sorted(missing.items()):
        if number in values:
            target = Variable(Number(float(number), span), span)
            settings.append(SetVariable(target=target, value=Number(values[number], span), span=span))
        else:
            why = "the job does not set it, and no setup file says what it holds"
            settings.append(NotRaised(construct=f"variable #{number}", why=why, span=span))
    place = next((n for n, node in enumerate(job.body) if not isinstance(node, Remark)), len(job.body))
    return replace(job, body=(*job.body[:place], *settings, *job.body[place:])) if settings else job


def _used(job: Job) -> tuple[dict[int, Span], set[int] | None]:
    """(first place where each variable is read, variables that something sets; None: any)."""
    read: dict[int, Span] = {}
    written: set[int] = set()
    for routine in job.routines.values():
        written |= {number for one in routine.parameters if (number := _number(one)) is not None}
    for body in (job.body, *(routine.body for routine in job.routines.values())):
        for node in walk(body):
            for target in _targets(node):
                number = _number(target)
                if number is None:
                    return {}, None
                written.add(number)
            for part in _read(node):
                if isinstance(part, Variable) and (number := _number(part)) is not None:
                    read.setdefault(number, node.span)
                elif isinstance(part, Variable):
                    return {}, None
    return read, written


def _targets(node: Node) -> Iterator[Variable]:
    if isinstance(node, SetVariable):
        yield node.target
    elif isinstance(node, CountLoop):
        yield node.variable
    elif isinstance(node, RunRoutine):
        yield from (target for target, _ in node.arguments)


def _read(node: Node) -> Iterator[Expr]:
    """The expressions of an operation and what is in them, but for what it sets."""
    own = set(map(id, _targets(node)))
    for expr in expressions(node):
        if id(expr) not in own:
            yield from parts_of_expression(expr)


def _number(variable: Variable) -> int | None:
    return round(variable.number.value) if isinstance(variable.number, Number) else None
