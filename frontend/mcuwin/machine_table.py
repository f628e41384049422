"""``[din]`` of gproof's own machine file: what controllers of DIN blocks with Pascal inside (McuWIN) are set up to do.

IniCfg, mcfg and Task 0 have these settings, and the manual gives no layout for most of their files.
docs/machine-files.md lists the keys. The tool table is a file of the controller's own, ``ToolComp.INI``.
"""

from __future__ import annotations

import re
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

from gproof.frontend.common.exact_numbers import MILLIMETRES
from gproof.frontend.common.paths import is_file
from gproof.frontend.common.toml_table import TomlTable, show
from gproof.frontend.mcuwin.machine_ini import without_stated
from gproof.frontend.mcuwin.tool_comp import DEFAULT_NAME, beside, load_tools
from gproof.ir import codes
from gproof.ir.dialects.mcuwin.settings import (
    ACTIONS,
    VERSIONS,
    McuWinSettings,
    RadiusTool,
    TaskCode,
    mcuwin_settings,
)
from gproof.ir.machine import AXES, NO_MACHINE, Axis, AxisKind, Machine, Unmodelled

Files = list[tuple[str, str]]

OFFSET_ROWS = 5
"""Records of zero offsets, for G54 to G58 (3.19, 14 (2.5.3.23))."""
LARGEST_PROGRAM = 12 * 2**20
"""Bytes that SZTSK3 may be set to, about (13.1.1.13)."""
MOST_PARAMETERS = 50
MOST_CHANNELS = 9
"""The number of a channel is one digit of M26 and M27 (4.11)."""

TIME_UNITS = {"min": 60.0, "s": 1.0}
WAIT_UNITS = {"ms": 0.001, "s": 1.0}

_CODE = re.compile(r"(?P<letter>[GM])0*(?P<number>[0-9]{1,3})", re.ASCII)
_BUILT_IN_M = (1, 17, 26, 27, 80, 96, 98, 150, 901, 902, 903, 904, 910, 911)
"""M codes that the manual does not leave to Task 0 (4.2, 4.10 to 4.12, 4.14 to 4.16, 4.18 to 4.24)."""


def with_din(root: TomlTable, machine: Machine, unit: Fraction, foreign: tuple[str, ...]) -> tuple[Machine, Files]:
    """The machine with what the table states, and the files read for it; lengths of the table are in ``unit`` mm.

    foreign: tables of the file that state settings of another controller.
    """
    table = root.table("din")
    table = table or TomlTable(root.file, ("din",), {})
    base = Path(str(root.values.get("base") or "")).parent
    before = _moved(mcuwin_settings(machine), base)
    stated = {key: value for key, value in _settings(table, unit, machine.axes).items() if value is not None}
    left = tuple(key for key in before.unstated if key not in table.values)
    din = replace(before, **stated, tasks=_tasks(table, before), unstated=left)
    tools, files = _tools(table, din, [root.file.path.parent, root.file.path.parent / base])
    if tools:
        left = tuple(key for key in left if key != "tool_file")
    controller = replace(machine.controller, dialect=machine.controller.dialect or "mcuwin")
    machine = replace(
        without_stated(machine, set(table.values)),
        controller=controller,
        settings=replace(din, tools=tools, unstated=left, foreign=foreign or din.foreign),
    )
    if table.boolean("shortest_path"):
        machine = replace(machine, not_modelled=(*machine.not_modelled, *_shortest_path(table, machine)))
    if table.boolean("error_compensation"):
        machine = replace(machine, not_modelled=(*machine.not_modelled, *_error_compensation(table, machine)))
    table.finish()
    return machine, files


def _moved(din: McuWinSettings, folder: Path) -> McuWinSettings:
    """Names of files to include, seen from a file that has the base in ``folder``."""
    names = {key: getattr(din, key) for key in ("pre_include", "post_include")}
    return replace(din, **{key: (folder / name).as_posix() for key, name in names.items() if name})


def _shortest_path(table: TomlTable, machine: Machine) -> tuple[Unmodelled, ...]:
    """Of each axis that turns: which way it goes to a place, and so which place it has then, is not known."""
    why = "its number of turns is then unknown"
    file, line = table.file.path.name, table.file.line_of("din.shortest_path")
    turning = [axis.name for axis in machine.axes or NO_MACHINE.axes if axis.kind is AxisKind.ROTARY]
    return tuple(Unmodelled("din.shortest_path", why, name, file, line) for name in turning)


def _error_compensation(table: TomlTable, machine: Machine) -> tuple[Unmodelled, ...]:
    """Of each axis: how far a table of spindle or angle errors moves it from its place is not known (2.8)."""
    why = "what the compensation files add to the axis is unknown"
    file, line = table.file.path.name, table.file.line_of("din.error_compensation")
    moving = [axis.name for axis in machine.axes or NO_MACHINE.axes]
    return tuple(Unmodelled("din.error_compensation", why, name, file, line) for name in moving)


def _settings(table: TomlTable, unit: Fraction, axes: tuple[Axis, ...]) -> dict[str, Any]:
    """Settings that the table states, the others None."""
    position = table.text("position_unit", tuple(MILLIMETRES))
    time = table.text("time_unit", tuple(TIME_UNITS))
    wait = table.text("wait_unit", tuple(WAIT_UNITS))
    persistence = table.text("persistence", ("strict", "keep"))
    return {
        "version": table.text("version", VERSIONS),
        "case_sensitive": table.boolean("case_sensitive"),
        "line_numbers": table.boolean("line_numbers"),
        "position_unit": None if position is None else float(MILLIMETRES[position]),
        "time_unit": None if time is None else TIME_UNITS[time],
        "absolute_centers": table.boolean("absolute_centers"),
        "interpolation_axes": _interpolation_axes(table, axes),
        "zero_offsets": _zero_offsets(table, unit, axes),
        "angle_unit": table.text("angle_unit", ("radians", "degrees")),
        "wait_unit": None if wait is None else WAIT_UNITS[wait],
        "arc_tolerance": table.positive("arc_tolerance", unit=unit, zero=True),
        "program_size": table.whole("program_size", 1, LARGEST_PROGRAM),
        "pre_include": _file_name(table, "pre_include"),
        "post_include": _file_name(table, "post_include"),
        "g60": table.text("g60", ("run", "once")),
        "channels": table.whole("channels", 1, MOST_CHANNELS),
        "keeps_over_codes": None if persistence is None else persistence == "keep",
    }


def _file_name(table: TomlTable, key: str) -> str | None:
    """A name of a file, "" for none."""
    name = table.text(key)
    if name is not None and not name.isprintable():
        table.bad(key, "a file name must have no control characters")
        return None
    return name


def _interpolation_axes(table: TomlTable, axes: tuple[Axis, ...]) -> str | None:
    """Letters of axes, as programs have them, upper case."""
    text = table.text("interpolation_axes")
    if text is None:
        return None
    known = [axis.word for axis in axes]
    letters = text.upper().replace(" ", "")
    if not letters or len(set(letters)) != len(letters) or not set(letters) <= set(known):
        what = f"{show(text)}: letters of axes of this machine ({', '.join(known) or 'none'}), each once"
        table.bad("interpolation_axes", what)
        return None
    return letters


def _zero_offsets(table: TomlTable, unit: Fraction, axes: tuple[Axis, ...]) -> tuple[tuple[float, ...], ...] | None:
    """A row for each of G54 to G58, in it a number for each axis of the machine; six columns."""
    rows = table.grid("zero_offsets")
    if rows is None:
        return None
    if len(rows) > OFFSET_ROWS:
        table.bad("zero_offsets", f"{len(rows)} records; the table has {OFFSET_ROWS}, for G54 to G58")
        return None
    found = []
    for number, row in enumerate(rows):
        if len(row) != len(axes):
            table.bad("zero_offsets", f"record {number} has {len(row)} numbers; the machine has {len(axes)} axes")
            return None
        columns = [0.0] * AXES
        for axis, value in zip(axes, row, strict=True):
            columns[axis.index] = float(value * (unit if axis.kind is AxisKind.LINEAR else 1))
        found.append(tuple(columns))
    return tuple(found)


def _tools(table: TomlTable, din: McuWinSettings, folders: list[Path]) -> tuple[tuple[RadiusTool, ...] | None, Files]:
    """The tools of the file that the table names, else those of the base, else of the usual file when it is there."""
    unit = table.text("tool_unit", tuple(MILLIMETRES))
    inches = din.position_unit is not None and din.position_unit != 1
    millimetres = MILLIMETRES[unit] if unit else None if inches else Fraction(1)
    stated = table.text("tool_file")
    if stated is None:
        units = [key for key in ("position_unit", "tool_unit") if key in table.values]
        if din.tools and units:
            table.bad(units[0], "state tool_file here to read the tools again: they are those of the base, in its unit")
        usual = next(filter(None, (beside(folder, DEFAULT_NAME) for folder in folders)), None)
        if din.tools is not None or "tool_file" in table.values:
            return din.tools, []
        return ((), []) if usual is None else _checked(table, usual, millimetres)
    if not stated:
        return (), []
    path = table.file.path.parent / stated
    if "\0" in stated or not is_file(path):
        what = f"there is no file {stated!r}"
        table.file.add(codes.FILE_UNREADABLE, table.name_of("tool_file"), what=what)
        return None, []
    return _checked(table, path, millimetres)


def _checked(table: TomlTable, path: Path, unit: Fraction | None) -> tuple[tuple[RadiusTool, ...] | None, Files]:
    tools, files = load_tools(path, table.file.findings, unit)
    table.file.errors += tools is None
    return tools, files


def _tasks(table: TomlTable, before: McuWinSettings) -> tuple[TaskCode, ...] | None:
    """``[din.task0]``, over what the base has; None when neither has any."""
    outer = table.table("task0")
    if outer is None:
        return before.tasks
    tasks = {task.code: task for task in before.tasks or ()}
    written: dict[str, str] = {}
    for key in outer.values:
        code = _code_name(key)
        if code is None:
            outer.take(key)
            outer.bad(key, f"{key!r} is not a code for Task 0: S, T, D, G74, G200 to G299, or an M code")
            continue
        if code in written:
            outer.take(key)
            outer.bad(key, f"{written[code]} is the same code")
            continue
        written[code] = key
        task = _task(outer, key, tasks.get(code, TaskCode(code=code)))
        if task is not None:
            tasks[code] = task
    return tuple(tasks.values())


def _code_name(key: str) -> str | None:
    """``M3`` for ``m03``; None for what Task 0 does not do."""
    name = key.upper()
    if name in ("S", "T", "D"):
        return name
    found = _CODE.fullmatch(name)
    if found is None:
        return None
    number = int(found["number"])
    own = number == 74 or 200 <= number <= 299 if found["letter"] == "G" else number not in _BUILT_IN_M
    return f"{found['letter']}{number}" if own else None


def _task(outer: TomlTable, key: str, before: TaskCode) -> TaskCode | None:
    """``M3 = "spindle_cw"``, or a table with ``does``, ``breaks`` and ``parameters``."""
    if not isinstance(outer.values[key], dict):
        action = outer.text(key, ACTIONS)
        return None if action is None else replace(before, action=action)
    table = outer.table(key)
    assert table is not None
    action, breaks = table.text("does", ACTIONS), table.boolean("breaks")
    parameters = table.whole("parameters", 0, MOST_PARAMETERS)
    table.finish()
    return replace(
        before,
        action=before.action if action is None else action,
        breaks=before.breaks if breaks is None else breaks,
        parameters=before.parameters if parameters is None else parameters,
    )
