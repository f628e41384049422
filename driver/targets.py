"""The registry of targets of translation: one line each.

A target that gproof reads too is compared by its own front end; the others are read back by ``verify``.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from gproof.ir.record import record

if TYPE_CHECKING:
    from pathlib import Path

    from gproof.ir.job import Job
    from gproof.ir.machine import Machine
    from gproof.ir.target import Style, Target
    from gproof.verify.translation.rs274_reader import ReadBack


@record(frozen=True, slots=True)
class TargetEntry:
    """target: its table; write: (legal job, table, machine, style) -> text of files by name, "" for the job's own;
    comment: what is around the text of a comment; adapted: the table for a machine, its files and the language of the
    source; read: (texts, name of the job's own, machine, work offset at the start) -> what they do, for a language
    without a front end; machine_file: name of the controller's own machine file, "" where gproof reads none;
    diameters: X of its programs may be one, as the machine file says."""

    target: Callable[[], Target]
    write: Callable[[Job, Target, Machine, Style], dict[str, bytes]]
    comment: tuple[str, str] = ("(", ")")
    adapted: Callable[[Target, Machine, Sequence[Path], str], Target] | None = None
    read: Callable[[dict[str, bytes], str, Machine, int], ReadBack] | None = None
    machine_file: str = ""
    diameters: bool = False


def _eding() -> Target:
    from gproof.ir.dialects.eding.target import TARGET

    return TARGET


def _eding_of(target: Target, machine: Machine, files: Sequence[Path], source: str) -> Target:
    from gproof.ir.dialects.eding.target import adapted

    return adapted(target, source)


def _write_eding(job: Job, target: Target, machine: Machine, style: Style) -> dict[str, bytes]:
    from gproof.backend.emit.eding.from_job import write

    return write(job, target, machine, style)


def _mcuwin() -> Target:
    from gproof.ir.dialects.mcuwin.target import TARGET

    return TARGET


def _write_mcuwin(job: Job, target: Target, machine: Machine, style: Style) -> dict[str, bytes]:
    from gproof.backend.emit.mcuwin.from_job import write

    return write(job, target, machine, style)


def _mcuwin_of(target: Target, machine: Machine, files: Sequence[Path], source: str) -> Target:
    from gproof.ir.dialects.mcuwin.target import adapted

    return adapted(target, machine, source)


def _linuxcnc() -> Target:
    from gproof.ir.dialects.linuxcnc.target import TARGET

    return TARGET


def _write_linuxcnc(job: Job, target: Target, machine: Machine, style: Style) -> dict[str, bytes]:
    from gproof.backend.emit.linuxcnc.from_job import write

    return write(job, target, machine, style)


def _read_linuxcnc(files: dict[str, bytes], name: str, machine: Machine, work: int) -> ReadBack:
    from gproof.verify.translation.rs274_reader import LINUXCNC, read_back

    return read_back(files, name, LINUXCNC, machine, work)


def _grbl() -> Target:
    from gproof.ir.dialects.grbl.target import TARGET

    return TARGET


def _write_grbl(job: Job, target: Target, machine: Machine, style: Style) -> dict[str, bytes]:
    from gproof.backend.emit.grbl.from_job import write

    return write(job, target, machine, style)


def _read_grbl(files: dict[str, bytes], name: str, machine: Machine, work: int) -> ReadBack:
    from gproof.verify.translation.rs274_reader import GRBL, read_back

    return read_back(files, name, GRBL, machine, work)


def _wincnc() -> Target:
    from gproof.ir.dialects.wincnc.target import TARGET

    return TARGET


def _wincnc_of(target: Target, machine: Machine, files: Sequence[Path], source: str) -> Target:
    from gproof.frontend.wincnc.load import one_way_next_to
    from gproof.frontend.wincnc.mac_file import commands_next_to
    from gproof.ir.dialects.wincnc.target import adapted

    return adapted(target, machine, commands_next_to(files, machine), one_way_next_to(files, machine))


def _write_wincnc(job: Job, target: Target, machine: Machine, style: Style) -> dict[str, bytes]:
    from gproof.backend.emit.wincnc.from_job import write

    return write(job, target, machine, style)


TARGETS: dict[str, TargetEntry] = {
    "eding": TargetEntry(_eding, _write_eding, adapted=_eding_of, machine_file="cnc.ini", diameters=True),
    "wincnc": TargetEntry(_wincnc, _write_wincnc, ("[", "]"), _wincnc_of, machine_file="WINCNC.INI"),
    "mcuwin": TargetEntry(_mcuwin, _write_mcuwin, ("' ", ""), _mcuwin_of, machine_file="McuWIN.ini"),
    "linuxcnc": TargetEntry(_linuxcnc, _write_linuxcnc, read=_read_linuxcnc),
    "grbl": TargetEntry(_grbl, _write_grbl, read=_read_grbl),
}
