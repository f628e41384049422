"""Programs as text of Eding CNC."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from gproof.backend.emit.printer import Printer

if TYPE_CHECKING:
    from gproof.ir.machine import Machine
    from gproof.ir.program import Program


def _emit(program: Program, machine: Machine, as_is: frozenset[int]) -> Iterable[bytes]:
    from gproof.backend.emit.eding.program import emit

    return emit(program)


PRINTER = Printer(emit=_emit)
