"""A McuWIN machine's own file, ``McuWIN.ini``, as a Machine.

Source: APCI-8001 G-code manual, McuWIN V 2.5.3.133; ``ini_keys`` has the keys that it names. The file says nothing that
gproof may use of the axes: those are in the system data of mcfg, which a TOML file states over this one
(``base = "McuWIN.ini"``). A key that is not known is reported (GP602). It may hold a setting for which gproof takes the
usual value, and so may one whose name says so: the answer is UNKNOWN (GP605) until ``[din]`` states these settings.
"""

from __future__ import annotations

import re
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

from gproof.frontend.mcuwin.ini_keys import SETTINGS, IniSetting, kept, setting_of
from gproof.frontend.mcuwin.ini_text import Entry, IniText
from gproof.frontend.mcuwin.tool_comp import DEFAULT_NAME, beside, load_tools
from gproof.ir import codes
from gproof.ir.dialects.mcuwin.settings import NO_MCUWIN_SETTINGS, McuWinSettings, RadiusTool
from gproof.ir.finding import Findings
from gproof.ir.machine import Controller, Machine, Unmodelled

Files = list[tuple[str, str]]

FILE_NAME = "mcuwin.ini"

_MARK = re.compile(rb"^[ \t]*\[[ \t]*(?:MCU|Project data|FEHLERTEXTE\w*|Tools(?:XY|YZ|ZX))[ \t]*\]", re.I | re.M)
_TOOLS = re.compile(r"tools(?:xy|yz|zx)")


def is_mcuwin_ini(path: Path) -> bool:
    """True for a file of that name, and for an .ini with a section that only McuWIN's files have."""
    if path.name.lower() == FILE_NAME:
        return True
    try:
        return _MARK.search(path.read_bytes()) is not None
    except (OSError, ValueError):
        return False


def load_mcuwin_ini(path: Path, findings: Findings, *, alone: bool = True) -> tuple[Machine | None, Files]:
    """The machine, and (name, sha256) of the files read; None, with findings, when one is bad.

    alone: no file refines this one, so the tool table is the usual file next to it, in mm, or there is none.
    """
    file = IniText(path, findings)
    tools_at = next((file.names[section][1] for section in file.sections if _TOOLS.fullmatch(section)), 0)
    if tools_at:
        what = "is a tool table; give McuWIN.ini, or a TOML file with this file as its tool_file"
        file.add(codes.FILE_UNREADABLE, tools_at, what=f"{path.name} {what}")
        return None, file.files
    texts: list[tuple[str, str]] = []
    not_modelled: list[Unmodelled] = []
    strange: list[Entry] = []
    for section, entries in file.sections.items():
        for key, entry in entries.items():
            setting = None if kept(section, key) else setting_of(key)
            if kept(section, key) or (setting is not None and not setting.usual):
                texts.append((entry.shown, entry.text))
            elif setting is not None:
                not_modelled.append(_may_hold(path.name, entry.line, entry.shown, (setting,)))
            else:
                file.report_unknown(entry)
                strange.append(entry)
    settled = {one.stated_by for one in not_modelled}
    hidden = tuple(row for row in SETTINGS if row.usual and row.stated_by not in settled)
    if strange and hidden:
        not_modelled.append(_may_hold(path.name, strange[0].line, strange[0].shown, hidden))
    usual = beside(path.parent, DEFAULT_NAME) if alone else None
    tools, more = (() if alone else None, []) if usual is None else load_tools(usual, findings, Fraction(1))
    files = file.files + more
    if file.errors or (usual is not None and tools is None):
        return None, files
    return (
        Machine(
            name=path.name,
            axes=(),
            controller=Controller(dialect="mcuwin"),
            settings=_with_tools(tools),
            not_modelled=tuple(not_modelled),
            unknown_keys=tuple(file.unknown),
            kept=tuple(texts),
        ),
        files,
    )


def _with_tools(tools: tuple[RadiusTool, ...] | None) -> McuWinSettings:
    """Settings that state nothing but a tool table, where there is one."""
    left = tuple(key for key in NO_MCUWIN_SETTINGS.unstated if not tools or key != "tool_file")
    return replace(NO_MCUWIN_SETTINGS, tools=tools, unstated=left)


def _may_hold(file: str, line: int, key: str, settings: tuple[IniSetting, ...]) -> Unmodelled:
    """A key that may hold a setting: by its name, or because its name is not known."""
    names = " ".join(row.stated_by for row in settings)
    what = ", ".join(row.what for row in settings)
    why = f"state {names.replace(' ', ', ')} in [din] of a TOML file: this file may hold {what}"
    return Unmodelled(key, why, "", file, line, names)


def without_stated(machine: Machine, stated: set[str]) -> Machine:
    """The machine without the settings that a file over it states, by the names of their keys."""
    left: list[Unmodelled] = []
    for one in machine.not_modelled:
        names = one.stated_by.split()
        if not stated.isdisjoint(names):
            rows = tuple(row for row in SETTINGS if row.stated_by in names and row.stated_by not in stated)
            if not rows:
                continue
            one = _may_hold(one.file, one.line, one.what, rows)
        left.append(one)
    return replace(machine, not_modelled=tuple(left))
