"""What a dialect's folder gives to print its programs: ``backend/emit/<dialect>/__init__.py`` exports a ``Printer``."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from gproof.ir.record import record

if TYPE_CHECKING:
    from gproof.ir.machine import Machine
    from gproof.ir.program import Program


class Unprintable(Exception):
    """The dialect has no text for this; the argument says for what."""


def _nothing(before: Program, after: Program, machine: Machine) -> str:
    return ""


@record(frozen=True, slots=True, kw_only=True)
class Printer:
    """How programs of a dialect are printed; machine: whose settings say how their lines are read.

    emit: (program, machine, lines that stay as they are) -> the text of the program's own file, piece by piece, each of
    whole lines. emit_less: the same with what changes no other program that is read with this one's help, as far as
    that can be; None: there is no such thing. judge: (program, program of what was printed, machine) -> what shows,
    besides a comparison of both, that they are not the same; "" for nothing.
    """

    emit: Callable[[Program, Machine, frozenset[int]], Iterable[bytes]]
    emit_less: Callable[[Program, Machine], Iterable[bytes]] | None = None
    judge: Callable[[Program, Program, Machine], str] = _nothing
