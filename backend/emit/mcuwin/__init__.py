"""Programs as text of McuWIN."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from gproof.backend.emit.printer import Printer

if TYPE_CHECKING:
    from gproof.ir.machine import Machine
    from gproof.ir.program import Program


def _emit(program: Program, machine: Machine, as_is: frozenset[int]) -> Iterable[bytes]:
    from gproof.backend.emit.mcuwin.program import emit
    from gproof.ir.dialects.mcuwin.settings import mcuwin_settings

    return emit(program, mcuwin_settings(machine), as_is=as_is)


def _judge(before: Program, after: Program, machine: Machine) -> str:
    from gproof.backend.emit.mcuwin.compare import said_otherwise

    return said_otherwise(before, after, machine)


PRINTER = Printer(emit=_emit, judge=_judge)
