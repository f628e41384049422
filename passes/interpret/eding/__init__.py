"""How programs of Eding CNC are executed: what differs from other controllers."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gproof.ir.program import Program
    from gproof.passes.interpret.eding.semantics import EdingDialect


def semantics(program: Program) -> EdingDialect:
    """What decides how a program is executed: one object a run."""
    from gproof.passes.interpret.eding.semantics import EdingDialect

    return EdingDialect(program)
