"""The registry of targets of translation: one line each.

A target that gproof reads too is compared by its own front end; the others are read back by ``verify``.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from gproof.ir.record import record

if TYPE_CHECKING:
    from gproof.ir.job import Job
    from gproof.ir.machine import Machine
    from gproof.ir.target import Style, Target


@record(frozen=True, slots=True)
class TargetEntry:
    """target: its table; write: (legal job, table, machine, style) -> text of files by name, "" for the job's own;
    comment: what is around the text of a comment; adapted: the table for a machine."""

    target: Callable[[], Target]
    write: Callable[[Job, Target, Machine, Style], dict[str, bytes]]
    comment: tuple[str, str] = ("(", ")")
    adapted: Callable[[Target, Machine], Target] | None = None


def _eding() -> Target:
    from gproof.ir.dialects.eding.target import TARGET

    return TARGET


def _write_eding(job: Job, target: Target, machine: Machine, style: Style) -> dict[str, bytes]:
    from gproof.backend.emit.eding.from_job import write

    return write(job, target, machine, style)


def _mcuwin() -> Target:
    from gproof.ir.dialects.mcuwin.target import TARGET

    return TARGET


def _write_mcuwin(job: Job, target: Target, machine: Machine, style: Style) -> dict[str, bytes]:
    from gproof.backend.emit.mcuwin.from_job import write

    return write(job, target, machine, style)


def _mcuwin_of(target: Target, machine: Machine) -> Target:
    from gproof.ir.dialects.mcuwin.target import adapted

    return adapted(target, machine)


TARGETS: dict[str, TargetEntry] = {
    "eding": TargetEntry(_eding, _write_eding),
    "mcuwin": TargetEntry(_mcuwin, _write_mcuwin, ("' ", ""), _mcuwin_of),
}
