"""How programs of McuWIN are executed: what differs from other controllers."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gproof.ir.program import Program
    from gproof.passes.interpret.mcuwin.semantics import McuWinDialect


def semantics(program: Program) -> McuWinDialect:
    """What decides how a program is executed: one object a run."""
    from gproof.passes.interpret.mcuwin.semantics import McuWinDialect

    return McuWinDialect(program)
