"""The registry of checks: which of them judge what is judged where somebody asks.

That is ``--also``, ``properties`` of a policy, ``also`` of a job file. A property has one line in ``CHECKS``, in the
order in which answers name them. A maker imports its check when it is called: a start of the command pays for none.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gproof.ir.finding import Findings
    from gproof.ir.machine import Machine
    from gproof.ir.program import Program
    from gproof.ir.setup import Setup
    from gproof.passes.checks.base import Check, ZeroAt

Maker = Callable[["Program", "Machine", "Setup", "Findings", "ZeroAt"], "Check"]
"""Makes a new check of a job; the last: where zeros are when it starts, as the language has it."""


def _feeds(program: Program, machine: Machine, setup: Setup, findings: Findings, zero: ZeroAt) -> Check:
    from gproof.passes.checks.cutting.feeds import Feeds

    return Feeds(program, machine, setup, findings)


def _cutting(program: Program, machine: Machine, setup: Setup, findings: Findings, zero: ZeroAt) -> Check:
    from gproof.passes.checks.cutting.cutting import Cutting

    return Cutting(program, machine, setup, findings)


def _sense(program: Program, machine: Machine, setup: Setup, findings: Findings, zero: ZeroAt) -> Check:
    from gproof.passes.checks.lint.lint import Sense

    return Sense(program, machine, setup, findings)


def _cutter_and_part(program: Program, machine: Machine, setup: Setup, findings: Findings, zero: ZeroAt) -> Check:
    from gproof.passes.checks.collisions.collisions import Distance

    return Distance("gouges", program, machine, setup, findings, zero)


def _tool_and_bodies(program: Program, machine: Machine, setup: Setup, findings: Findings, zero: ZeroAt) -> Check:
    from gproof.passes.checks.collisions.collisions import Distance

    return Distance("collisions", program, machine, setup, findings, zero)


def _stock_left(program: Program, machine: Machine, setup: Setup, findings: Findings, zero: ZeroAt) -> Check:
    from gproof.passes.checks.stock.stock import StockLeft

    return StockLeft(program, machine, setup, findings, zero)


CHECKS: dict[str, tuple[Maker, ...]] = {
    "feeds": (_feeds,),
    "cutting": (_cutting,),
    "sense": (_sense,),
    "gouges": (_cutter_and_part,),
    "collisions": (_tool_and_bodies, _stock_left),
}
"""By property what makes its checks. With none, no check of this version decides it."""


def added() -> tuple[str, ...]:
    """The properties of the registry."""
    return tuple(CHECKS)


def every_property() -> tuple[str, ...]:
    """Every property a policy may require."""
    from gproof.ir.verdict import DEFAULT_POLICY

    return (*DEFAULT_POLICY, *CHECKS)


def decided(name: str) -> bool:
    """Whether this version has a check for a property."""
    from gproof.ir.verdict import DEFAULT_POLICY

    return name in DEFAULT_POLICY or bool(CHECKS[name])


def not_judged(judged: Iterable[str]) -> tuple[str, ...]:
    """What is left open where the properties ``judged`` are answered."""
    known = set(judged)
    return tuple(name for name in CHECKS if name not in known)


def added_checks(
    wanted: Iterable[str], program: Program, machine: Machine, setup: Setup, findings: Findings, zero: ZeroAt
) -> list[Check]:
    """A new check of each kind that the properties ``wanted`` need beyond those of the default policy.

    zero: where zeros lie when the job starts, see ``base.ZeroAt``.
    """
    names = set(wanted)
    made = [make for name in CHECKS if name in names for make in CHECKS[name]]
    return [make(program, machine, setup, findings, zero) for make in made]
