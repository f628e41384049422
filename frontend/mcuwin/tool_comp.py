"""The tool table of McuWIN, ``ToolComp.INI``: radius and length of tools, of each plane.

A section a plane (``[ToolsXY]``, ``[ToolsYZ]``, ``[ToolsZX]``, whatever the machine's axes are called), in it ``R5=``
and ``L5=`` for tool 5, with a decimal comma or point. Source: APCI-8001 G-code manual, McuWIN V 2.5.3.133, 2.7 and
14 (2.5.3.108); what it leaves open is in docs/machine-files.md.
"""

from __future__ import annotations

import re
from fractions import Fraction
from pathlib import Path

from gproof.frontend.common.paths import is_file
from gproof.frontend.mcuwin.ini_text import Entry, IniText
from gproof.ir.dialects.mcuwin.settings import RadiusTool
from gproof.ir.finding import Findings

DEFAULT_NAME = "ToolComp.INI"
SECTIONS = {"toolsxy": "xy", "toolsyz": "yz", "toolszx": "zx"}
HIGHEST_TOOL = 9999

Files = list[tuple[str, str]]
Values = dict[tuple[str, int], dict[str, float | None]]
"""R and L by plane and number."""

_KEY = re.compile(r"(?P<letter>[RL])(?P<number>0|[1-9][0-9]{0,8})", re.ASCII | re.IGNORECASE)


def load_tools(path: Path, findings: Findings, unit: Fraction | None) -> tuple[tuple[RadiusTool, ...] | None, Files]:
    """The tools by plane and number, and (name, sha256) of the file; None, with findings, when it is bad.

    unit: mm in one unit of the file; None: not known, and then of what is not 0 nothing is.
    """
    file = IniText(path, findings)
    values: Values = {}
    for section, entries in file.sections.items():
        plane = SECTIONS.get(section)
        if plane is None:
            if section in file.names:
                file.report_unknown_section(section)
            for entry in entries.values() if section not in file.names else ():
                file.report_unknown(entry)
            continue
        for entry in entries.values():
            _enter(file, entry, plane, values, unit)
    if file.errors:
        return None, file.files
    order = sorted(values, key=lambda one: (list(SECTIONS.values()).index(one[0]), one[1]))
    tools = tuple(
        RadiusTool(plane=plane, number=number, radius=found.get("R"), length=found.get("L"))
        for plane, number, found in ((*one, values[one]) for one in order)
    )
    return tools, file.files


def beside(folder: Path, name: str) -> Path | None:
    """The file of that name in a folder, in any case; the exact name first."""
    if is_file(folder / name):
        return folder / name
    try:
        found = sorted(entry for entry in folder.iterdir() if entry.name.lower() == name.lower())
    except OSError:
        return None
    return next((entry for entry in found if is_file(entry)), None)


def _enter(file: IniText, entry: Entry, plane: str, values: Values, unit: Fraction | None) -> None:
    """One line R or L."""
    key = _KEY.fullmatch(entry.key)
    if key is None:
        file.report_unknown(entry)
        return
    letter, number = key["letter"].upper(), int(key["number"])
    if number > HIGHEST_TOOL:
        file.bad(entry, f"tools are numbered from 0 to {HIGHEST_TOOL}")
        return
    value = file.number(entry)
    if value is None:
        return
    if letter == "R" and value < 0:
        file.bad(entry, f"the radius {entry.text} is below 0")
        return
    known = unit is not None or value == 0
    values.setdefault((plane, number), {})[letter] = float(value * (unit or 1)) if known else None
