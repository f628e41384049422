"""Properties that are judged where somebody asks: ``--also``, ``properties`` of a policy, ``also`` of a job file.

Each is what some checks of ``passes`` decide together, imported when they are wanted.
"""

from __future__ import annotations

from collections.abc import Iterable
from importlib import import_module

from gproof.ir.finding import Findings
from gproof.ir.machine import Machine
from gproof.ir.program import Program
from gproof.ir.setup import Setup
from gproof.ir.verdict import DEFAULT_POLICY
from gproof.passes.checks.base import Check

CHECKS: dict[str, tuple[str, ...]] = {
    "feeds": ("checks.cutting.feeds:feeds",),
    "cutting": ("checks.cutting.cutting:cutting",),
    "sense": ("checks.lint.lint:sense",),
    "gouges": ("checks.collisions.collisions:gouge_check",),
    "collisions": ("checks.collisions.collisions:collision_check", "checks.stock.stock:stock_left"),
}
"""By property the functions ``module:name`` in ``gproof.passes`` that make its checks: of program, machine, setup and
findings. With none, no check of this version decides it."""
ADDED = tuple(CHECKS)
ALL = (*DEFAULT_POLICY, *ADDED)
"""Every property a policy may ask for."""


def decided(name: str) -> bool:
    """Whether this version has a check for a property."""
    return name in DEFAULT_POLICY or bool(CHECKS[name])


def not_judged(judged: Iterable[str]) -> tuple[str, ...]:
    """What is left open where the properties ``judged`` are answered."""
    known = set(judged)
    return tuple(name for name in ADDED if name not in known)


def added_checks(
    wanted: Iterable[str], program: Program, machine: Machine, setup: Setup, findings: Findings
) -> list[Check]:
    """A new check of each kind that the properties ``wanted`` need beyond those of the default policy."""
    names = set(wanted)
    made = []
    for name in ADDED:
        for place in CHECKS[name] if name in names else ():
            module, function = place.split(":")
            made.append(getattr(import_module(f"gproof.passes.{module}"), function)(program, machine, setup, findings))
    return made
