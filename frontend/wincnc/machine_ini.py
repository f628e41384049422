"""A WinCNC machine's own file, ``WINCNC.INI``, as a Machine.

Source: WinCNC manual, "System Configuration: WINCNC.INI Settings". ``ini_keys`` says for every key what gproof makes of
it, docs/dialects/wincnc.md where the manual is open. Keys without a bearing on a job are kept as text; one that is not
known at all is kept and reported (GP602); one that is on and that gproof cannot follow goes into
``Machine.not_modelled`` (GP605). Any other mistake is reported at its line and column, and there is no Machine.
"""

from __future__ import annotations

import hashlib
import re
from fractions import Fraction
from pathlib import Path

from gproof.frontend.common.source import UTF8_MARK, decode
from gproof.frontend.wincnc.ini_axes import read_axes
from gproof.frontend.wincnc.ini_check import Sheet
from gproof.frontend.wincnc.ini_controls import absolute_centers, read_controls
from gproof.frontend.wincnc.ini_file import IniFile
from gproof.frontend.wincnc.ini_keys import KEYS
from gproof.ir import codes
from gproof.ir.finding import Findings, Span
from gproof.ir.machine import Board, Controller, Machine, Spindle

Files = list[tuple[str, str]]

STEP_FREQUENCY = 30000.0
"""Pulses a second without maxstepv=."""
PULSE = 5.0
"""Microseconds of a pulse, and of the direction before it, without steppulse=."""

_MARK = re.compile(rb"^[^\S\n]*axis(?:char|spec)\s*=", re.IGNORECASE | re.MULTILINE)


def is_wincnc_ini(path: Path) -> bool:
    """True for a file of that name, and for an .ini with lines of its axes."""
    if path.name.lower() == "wincnc.ini":
        return True
    try:
        return _MARK.search(path.read_bytes()) is not None
    except (OSError, ValueError):
        return False


def load_wincnc_ini(
    path: Path, findings: Findings, stated: frozenset[tuple[str, ...]] = frozenset()
) -> tuple[Machine | None, Files]:  # fmt: skip
    """The machine, and (name, sha256) of the file read; None, with findings, when it is bad.

    stated: what a file that refines this one states again (``replaced``), so that it is not judged here.
    """
    name = str(path)
    try:
        raw = path.read_bytes()
    except OSError as error:
        findings.add(codes.FILE_UNREADABLE.at(Span(name, 0), what=f"{name}: {error.strerror or error}"))
        return None, []
    files = [(name, hashlib.sha256(raw).hexdigest())]
    if b"\0" in raw or raw[:2] in (b"\xff\xfe", b"\xfe\xff"):
        findings.add(codes.FILE_UNREADABLE.at(Span(name, 0), what=f"{name}: not a text file"))
        return None, files
    ini = IniFile(name, findings, stated)
    ini.parse(decode(raw.removeprefix(UTF8_MARK)))
    sheet = Sheet(ini)
    machine = _machine(sheet, path)
    if ini.errors:
        return None, files
    machine.verify()
    return machine, files


def _machine(sheet: Sheet, path: Path) -> Machine:
    axes = read_axes(sheet)
    settings = read_controls(sheet)
    setting = sheet.one("spinchar")
    if setting is not None and setting.text.upper() != "S":
        sheet.open(setting, "another letter than S sets the spindle")
    highest = sheet.bare("maxstepv")
    return Machine(
        name=path.name,
        axes=axes,
        spindles=_spindles(sheet),
        controller=Controller(
            dialect="wincnc",
            max_step_frequency=STEP_FREQUENCY if highest is None else float(highest),
            absolute_arc_centers=absolute_centers(sheet),
        ),
        settings=settings,
        board=Board(step_pulse=_microseconds(sheet, "P"), direction_setup=_microseconds(sheet, "D")),
        unit=float(sheet.unit),
        not_modelled=tuple(sheet.not_modelled),
        unknown_keys=tuple(sheet.ini.unknown),
        kept=_kept(sheet),
    )


def _microseconds(sheet: Sheet, letter: str) -> float:
    """A letter of steppulse=, in seconds."""
    value = sheet.value("steppulse", letter)
    return float((Fraction(PULSE) if value is None else value) / 1_000_000)


def _spindles(sheet: Sheet) -> tuple[Spindle, ...]:
    """The spindle of spindle=, with its highest speed."""
    setting = sheet.one("spindle")
    if setting is None:
        return ()
    highest = sheet.value("spindle", "R")
    if highest is not None and highest <= 0:
        sheet.ini.bad(setting, f"{highest} is not greater than 0", setting.word("R"))
        return ()
    return (Spindle(number=0, max_rpm=None if highest is None else float(highest)),)


def _kept(sheet: Sheet) -> tuple[tuple[str, str], ...]:
    """Settings without a bearing on where the axes go, as they are written."""
    rules = ((setting, KEYS.get(setting.key)) for setting in sheet.ini.settings)
    return tuple(
        (setting.shown, setting.text)
        for setting, rule in rules
        if rule is not None and rule.treatment in ("kept", "checked")
    )
