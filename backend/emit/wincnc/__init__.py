"""Programs as text of WinCNC."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from gproof.backend.emit.printer import Printer

if TYPE_CHECKING:
    from gproof.ir.machine import Machine
    from gproof.ir.program import Program


def _emit(program: Program, machine: Machine, as_is: frozenset[int]) -> Iterable[bytes]:
    from gproof.backend.emit.wincnc.program import emit
    from gproof.ir.dialects.wincnc.settings import wincnc_settings

    return emit(program, wincnc_settings(machine).lexical)


def _emit_same_length(program: Program, machine: Machine) -> Iterable[bytes]:
    from gproof.backend.emit.wincnc.program import emit
    from gproof.ir.dialects.wincnc.settings import wincnc_settings

    return emit(program, wincnc_settings(machine).lexical, same_length=True)


PRINTER = Printer(emit=_emit, emit_less=_emit_same_length)
