"""How programs of WinCNC are executed: what differs from other controllers."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gproof.ir.program import Program
    from gproof.passes.interpret.wincnc.semantics import WinCncDialect


def semantics(program: Program) -> WinCncDialect:
    """What decides how a program is executed: one object a run."""
    from gproof.passes.interpret.wincnc.semantics import WinCncDialect

    return WinCncDialect(program)
