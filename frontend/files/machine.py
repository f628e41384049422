"""gproof's machine file (TOML, schema ``gproof-machine/1``), alone or over a controller's own file.

docs/machine-files.md lists every key. ``load_machine`` also reads a controller's file directly (``cnc.ini``,
``WINCNC.INI``, ``McuWIN.ini``).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import fields, replace
from fractions import Fraction
from pathlib import Path
from typing import Any

from gproof.frontend.common.exact_numbers import MILLIMETRES
from gproof.frontend.common.frontend import Files, Frontend, OwnTable
from gproof.frontend.common.own_keys import key_paths
from gproof.frontend.common.paths import is_there
from gproof.frontend.common.toml_table import TomlFile, TomlTable, in_range, meant
from gproof.frontend.files.areas_table import areas_from
from gproof.frontend.files.board_table import board_from
from gproof.frontend.files.tool_table import check_shape, shape_keys
from gproof.ir.dialects.accepts import ACCEPTS, names_of
from gproof.ir.finding import Findings
from gproof.ir.machine import (
    AXIS_NAMES,
    Axis,
    AxisKind,
    Controller,
    Knife,
    Machine,
    PitchTable,
    Slave,
    Spindle,
    Tool,
    Unmodelled,
)
from gproof.ir.settings import Settings

SCHEMA = "gproof-machine/1"
HIGHEST_TOOL = 99
DEEPEST_BASE = 8
MOST_SLAVES = 5
HIGHEST_HEAD = 5
HIGHEST_CHANNEL = 9999
LETTERS = ("W", "U", "V")
"""Letters that an axis of column a, b or c may have in programs in place of its own."""
LIMITS_HOLD = ("motor", "programmed")
LENGTH_UNITS = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "um": 0.001, "inch": 25.4}
ANGLE_UNITS = {"deg": 1.0, "rev": 360.0, "rad": math.degrees(1.0)}

Frontends = Sequence[Frontend]
"""Of the dialects that there are; the first that has an .ini file of its own decides how it is read."""


def load_machine(path: Path, findings: Findings, frontends: Frontends) -> tuple[Machine | None, Files]:
    """The machine in a TOML file or a controller's .ini file; None, with findings GP601–GP604, when it is bad."""
    machine, files = _load(path, findings, frontends, DEEPEST_BASE)
    if machine is None:
        return None, files
    for frontend in frontends:
        if machine.controller.dialect == frontend.name:
            machine = frontend.completed(machine)
    return in_range(machine, path, findings), files


def _load(
    path: Path, findings: Findings, frontends: Frontends, depth: int, anew: frozenset[tuple[str, ...]] = frozenset()
) -> tuple[Machine | None, Files]:
    """again: keys of the files that refine this one, with their tables."""
    if path.suffix.lower() == ".ini":
        return _whose(path, frontends).load_machine(path, findings, depth == DEEPEST_BASE, anew)
    return _load_toml(path, findings, frontends, depth, anew)


def _whose(path: Path, frontends: Frontends) -> Frontend:
    """The frontend of a controller's own file: by its name, else by its text, else the one that takes all others."""
    named = [one for one in frontends if path.name.lower() in one.machine_files]
    by_text = (one for one in frontends if one.knows_machine is not None and one.knows_machine(path))
    others = (one for one in frontends if one.knows_machine is None)
    return next(itertools.chain(named, by_text, others))


def _load_toml(
    path: Path, findings: Findings, frontends: Frontends, depth: int, anew: frozenset[tuple[str, ...]]
) -> tuple[Machine | None, Files]:
    file = TomlFile(path, SCHEMA, findings)
    root = file.root
    if root is None:
        return None, file.files
    unit_name = root.text("units", tuple(MILLIMETRES))
    if "units" not in root.values:
        root.missing("units")
    unit = MILLIMETRES[unit_name or "mm"]
    files = file.files
    machine: Machine | None = Machine(name=path.stem, axes=(), unit=float(unit))
    base = root.text("base")
    if base is not None:
        if depth == 0:
            root.bad("base", "files refer to each other in a circle")
            file.finish()
            return None, files
        target = path.parent / base
        if "\0" in base or (is_there(target) and not target.is_file()):
            root.bad("base", f"{base!r} is not a regular file")
            file.finish()
            return None, files
        machine, more = _load(target, findings, frontends, depth - 1, anew | frozenset(key_paths(root.values)))
        files = files + more
    if machine is None:
        file.finish()
        return None, files
    machine = replace(
        machine,
        name=root.text("name") or machine.name,
        axes=_axes(root, machine, unit),
        tools=_tools(root, machine, unit),
        spindles=_spindles(root, machine, unit),
    )
    machine, foreign, own = _settings(root, machine, unit, frontends)
    machine = replace(
        machine,
        board=board_from(root, machine),
        knife=_knife(root, machine.knife, unit),
        **_given(kinematics=root.text("kinematics"), z_down_tool_length=root.number("z_down_tool_length", unit=unit)),
        **_given(spindle_started=root.boolean("spindle")),
    )
    if machine.kinematics != "trivial" and "kinematics" in root.values:
        said, line = f"kinematics = {machine.kinematics}", file.line_of("kinematics")
        stated = Unmodelled(said, file=path.name, line=line)
        machine = replace(machine, not_modelled=(*machine.not_modelled, stated))
    change, keep_out = areas_from(root, machine.tool_change_area, machine.keep_out, unit)
    machine = replace(machine, tool_change_area=change, keep_out=keep_out)
    machine = _clearance(root, machine, unit)
    if own is not None and own.whole is not None:
        machine, more = own.whole(root, machine, unit, foreign)
        files = files + more
    root.finish()
    if file.errors:
        return None, files
    machine.verify()
    return machine, files


def _clearance(root: TomlTable, machine: Machine, unit: Fraction) -> Machine:
    """``[tool_change]``: how high Z has to be before a tool is changed."""
    table = root.table("tool_change")
    if table is None:
        return machine
    height, start = table.number("clear_z", unit=unit), table.boolean("at_start")
    if "clear_z" not in table.values and machine.tool_change_clearance is None:
        table.missing("clear_z")
    table.finish()
    return replace(machine, **_given(tool_change_clearance=height, clearance_at_start=start))


def _given(**values: Any) -> dict[str, Any]:
    """Those that are not None."""
    return {name: value for name, value in values.items() if value is not None}


def _axes(root: TomlTable, machine: Machine, unit: Fraction) -> tuple[Axis, ...]:
    axes = {axis.name: axis for axis in machine.axes}
    outer = root.table("axes")
    for name in outer.values if outer else ():
        assert outer is not None
        if name not in AXIS_NAMES:
            outer.bad(name, f"{name!r} is not an axis; axes are {', '.join(AXIS_NAMES)}")
            continue
        table = outer.table(name)
        if table is not None:
            axes[name] = _axis(table, name, axes.get(name), unit)
            letter = axes[name].letter
            others = {axis.letter for other, axis in axes.items() if other != name}
            if name in "abc" and letter in others - {""} and "letter" in table.values:
                table.bad("letter", f"{letter} already moves another axis")
    return tuple(axes[name] for name in AXIS_NAMES if name in axes)


def _axis(table: TomlTable, name: str, before: Axis | None, unit: Fraction) -> Axis:
    """One axis; what the table does not say stays as ``before`` has it."""
    stated = table.text("kind", tuple(kind.value for kind in AxisKind))
    usual = AxisKind.LINEAR if name in "xyz" else AxisKind.ROTARY
    kind = AxisKind(stated) if stated else before.kind if before else usual
    length = unit if kind is AxisKind.LINEAR else Fraction(1)
    steps = table.ratio("steps_per_unit")
    before = before or Axis(name=name, kind=kind)
    axis = replace(
        before,
        kind=kind,
        **_given(
            steps_per_unit=None if steps is None else steps / length,
            lower=table.number("min", unit=length),
            upper=table.number("max", unit=length),
            travel_lower=table.number("travel_min", unit=length),
            travel_upper=table.number("travel_max", unit=length),
            max_velocity=table.positive("max_velocity", unit=length),
            max_acceleration=table.positive("max_acceleration", unit=length),
            backlash=table.positive("backlash", unit=length, zero=True),
            slaves=_slaves(table, length),
            pitch=_pitch(table, length),
            home_position=table.number("home_position", unit=length),
            home_velocity=table.number("home_velocity", unit=length),
            tip_feed=table.boolean("tip_feed"),
            letter=table.text("letter", LETTERS if name in "abc" else ()),
            vertical=table.boolean("vertical"),
            boundary_lower=table.number("boundary_min", unit=length),
            boundary_upper=table.number("boundary_max", unit=length),
            feed_velocity=table.positive("feed_velocity", unit=length),
            home_place=table.number("home_place", unit=length),
            position_unit=_position_unit(table, kind),
        ),
    )
    if axis.letter and name not in "abc":
        table.bad("letter", f"{name.upper()} has its own letter")
    for low, high, keys in (
        (axis.lower, axis.upper, ("min", "max")),
        (axis.boundary_lower, axis.boundary_upper, ("boundary_min", "boundary_max")),
        (axis.travel_lower, axis.travel_upper, ("travel_min", "travel_max")),
    ):
        if low is not None and high is not None and low > high:
            least, most = (table.as_stated(key, value, length) for key, value in zip(keys, (low, high), strict=True))
            stated = keys[0] if keys[0] in table.values else keys[1]
            table.bad(stated, f"{keys[0]} is above {keys[1]} ({least} > {most})")
    for drive in axis.drives():
        for side, soft, end in (("min", drive.lower, drive.travel_lower), ("max", drive.upper, drive.travel_upper)):
            if soft is not None and end is not None and (soft < end if side == "min" else soft > end):
                # An end stop within the soft limits: inside them the axis would still run into it.
                own = f"travel_{side}" if f"travel_{side}" in table.values else side
                key = own if drive.name == axis.name.upper() and own in table.values else "slaves"
                table.bad(key, f"{side} of {drive.name} is beyond travel_{side}")
    for slave in axis.slaves:
        low = slave.lower if slave.lower is not None else axis.lower
        high = slave.upper if slave.upper is not None else axis.upper
        if low is not None and high is not None and low > high:
            table.bad("slaves", "the lower limit of a motor is above the upper one")
    table.finish()
    return axis


def _position_unit(table: TomlTable, kind: AxisKind) -> float | None:
    """mm or degrees in the unit of an axis's own positions."""
    units = LENGTH_UNITS if kind is AxisKind.LINEAR else ANGLE_UNITS
    name = table.text("position_unit", tuple(units))
    return None if name is None else units[name]


def _slaves(table: TomlTable, length: Fraction) -> tuple[Slave, ...] | None:
    """Further motors: their number, when they are all like the axis's own, or a table each."""
    stated = table.values.get("slaves")
    if not isinstance(stated, list):
        number = table.whole("slaves", 0, MOST_SLAVES)
        return None if number is None else tuple(Slave() for _ in range(number))
    if len(stated) > MOST_SLAVES:
        table.take("slaves")
        table.bad("slaves", f"an axis can have at most {MOST_SLAVES} further motors")
        return None
    found = []
    for one in table.tables("slaves"):
        steps = one.ratio("steps_per_unit")
        found.append(
            Slave(
                joint=one.text("joint") or "",
                steps_per_unit=None if steps is None else steps / length,
                lower=one.number("min", unit=length),
                upper=one.number("max", unit=length),
                travel_lower=one.number("travel_min", unit=length),
                travel_upper=one.number("travel_max", unit=length),
                max_velocity=one.positive("max_velocity", unit=length),
                max_acceleration=one.positive("max_acceleration", unit=length),
                backlash=one.positive("backlash", unit=length, zero=True),
                pitch=_pitch(one, length),
                home_position=one.number("home_position", unit=length),
                home_velocity=one.number("home_velocity", unit=length),
            )
        )
        one.finish()
    return tuple(found)


def _pitch(table: TomlTable, length: Fraction) -> PitchTable | None:
    """``pitch = [[machine, calibrated], ...]``."""
    pairs = table.grid("pitch")
    if pairs is None:
        return None
    if any(len(pair) != 2 for pair in pairs):
        table.bad("pitch", "a pitch table must have two positions on each row: machine, calibrated")
        return None
    found = PitchTable(
        machine=tuple(float(pair[0] * length) for pair in pairs),
        calibrated=tuple(float(pair[1] * length) for pair in pairs),
    )
    problem = found.problem()
    if problem is not None:
        table.bad("pitch", problem)
        return None
    return found


def _knife(root: TomlTable, before: Knife | None, unit: Fraction) -> Knife | None:
    """``[knife]``."""
    table = root.table("knife")
    if table is None:
        return before
    knife = replace(
        before or Knife(),
        **_given(
            axis=table.text("axis", AXIS_NAMES[3:]),
            angle=table.positive("angle", zero=True),
            lift=table.positive("lift", unit=unit, zero=True),
            blend_angle=table.positive("blend_angle", zero=True),
            blend_distance=table.positive("blend_distance", unit=unit, zero=True),
        ),
    )
    table.finish()
    return knife


def _tools(root: TomlTable, machine: Machine, unit: Fraction) -> tuple[Tool, ...]:
    tools = {tool.number: tool for tool in machine.tools}
    for number, table in root.numbered("tools", 1, HIGHEST_TOOL):
        tools[number] = replace(
            tools.get(number, Tool(number=number)),
            **shape_keys(table, unit),
            **_given(
                length=table.number("length", unit=unit),
                x_offset=table.number("x_offset", unit=unit),
                diameter=table.number("diameter", unit=unit),
                orientation=table.whole("orientation", 0, 9),
                min_rpm=table.positive("min_rpm", zero=True),
                max_rpm=table.positive("max_rpm"),
                max_feed=table.positive("max_feed", unit=unit),
                max_plunge=table.positive("max_plunge", unit=unit),
                max_depth=table.positive("max_depth", unit=unit),
            ),
        )
        check_shape(table, tools[number])
        table.finish()
    return tuple(tools[number] for number in sorted(tools))


def _spindles(root: TomlTable, machine: Machine, unit: Fraction) -> tuple[Spindle, ...]:
    """``[spindles.1]``: speeds, and what is added to positions while it is selected."""
    spindles = {spindle.number: spindle for spindle in machine.spindles}
    for number, table in root.numbered("spindles", 0, HIGHEST_HEAD):
        before = spindles.get(number, Spindle(number=number))
        given = [table.number(axis, unit=unit) for axis in "xyz"]
        kept = (None, None, None) if before.unsigned and any(v is not None for v in given) else before.offset
        offset = [old if new is None else new for old, new in zip(kept, given, strict=True)]
        if number == 0 and any(offset):
            table.bad("x", "offsets count from spindle 0, which must have none")
        spindles[number] = replace(
            before,
            offset=(offset[0], offset[1], offset[2]),
            unsigned=before.unsigned and kept is before.offset,
            **_given(
                min_rpm=table.positive("min_rpm", zero=True),
                max_rpm=table.positive("max_rpm"),
                ramp_time=table.positive("ramp_time", zero=True),
                spin_up=table.positive("spin_up", zero=True),
                output=table.whole("output", 0, HIGHEST_CHANNEL),
                oriented_stop=table.boolean("oriented_stop"),
            ),
        )
        low, high = spindles[number].min_rpm, spindles[number].max_rpm
        if low is not None and high is not None and low > high:
            table.bad("min_rpm" if "min_rpm" in table.values else "max_rpm", "min_rpm is above max_rpm")
        table.finish()
    return tuple(spindles[number] for number in sorted(spindles))


def _settings(
    root: TomlTable, machine: Machine, unit: Fraction, frontends: Frontends
) -> tuple[Machine, tuple[str, ...], OwnTable | None]:
    """With what ``[controller]`` and the tables of single controllers state; the names of tables that are another
    controller's; and who makes the whole machine of the file, if anybody does.

    A machine has the settings of one controller: the one whose file it is as a whole; else one with a table here, then
    one without, that has something stated, or was that of the base, or is the dialect's.
    """
    own = {one.name: one.own_table for one in frontends if one.own_table is not None}
    of_base = _owner(machine, own)
    controller, keys = _controller(root, machine.controller, frontends)
    machine = replace(machine, controller=controller)
    titles = {one.name: one.title for one in frontends}
    stated = {
        name: table.read(root, machine, unit, keys[name])
        for name, table in own.items()
        if table.read and (name == of_base or _concerns(root, name, table, controller, keys[name]))
    }
    told = sorted((name for name in stated if stated[name] != own[name].usual()), key=lambda name: not own[name].name)
    for name, table in own.items():
        if table.whole and (table.name in root.values or name in (controller.dialect, of_base)):
            return machine, tuple(own[other].name for other in told if own[other].name), table
    if len(told) > 1 and told[0] != of_base:
        first, other = told[:2]
        usual = own[other].usual()
        key = next(one.name for one in fields(usual) if getattr(usual, one.name) != getattr(stated[other], one.name))
        what = f"settings of a {titles[first]} controller, together with {key}, which only {titles[other]} has"
        root.bad(own[first].name, what)
    for name in sorted(stated, key=lambda name: not own[name].name):
        if name in told or name in (of_base, controller.dialect):
            return replace(machine, settings=stated[name]), (), None
    return machine, (), None


def _owner(machine: Machine, own: dict[str, OwnTable]) -> str | None:
    """The dialect whose settings a machine has; that of its controller is looked at first, which loads no other."""
    if type(machine.settings) is Settings:
        return None
    first = sorted(own, key=lambda name: name != machine.controller.dialect)
    return next((name for name in first if type(own[name].usual()) is type(machine.settings)), None)


def _concerns(root: TomlTable, name: str, own: OwnTable, controller: Controller, keys: dict[str, Any]) -> bool:
    """Whether a file can state settings of a dialect: by its table, its keys, as its dialect, or by ``accepts``."""
    accepted = any(one in ACCEPTS and ACCEPTS[one].dialects == (name,) for one in controller.accepts)
    return own.name in root.values or bool(keys) or controller.dialect == name or accepted


def _controller(
    root: TomlTable, before: Controller, frontends: Frontends
) -> tuple[Controller, dict[str, dict[str, Any]]]:
    """``[controller]``, and what it states that only one controller has, by dialect."""
    table = root.table("controller")
    owners = {one.name: one.own_table for one in frontends if one.own_table is not None}
    if table is None:
        return before, {name: {} for name in owners}
    keys = {name: own.read_keys(table) if set(own.keys) & set(table.values) else {} for name, own in owners.items()}
    angle = table.positive("laf_angle", zero=True)
    if angle is not None and angle > 180:
        table.bad("laf_angle", "an angle between two moves can be at most 180 degrees")
    controller = replace(
        before,
        **_given(
            dialect=table.text("dialect", tuple(one.name for one in frontends)),
            laf_angle=angle,
            interpolation_time=table.positive("interpolation_time"),
            fifo_time=table.positive("fifo_time"),
            max_step_frequency=table.positive("max_step_frequency"),
            auto_tool_change=table.boolean("auto_tool_change"),
            absolute_arc_centers=table.boolean("absolute_arc_centers"),
            xz_seen_from=table.text("xz_seen_from", ("+y", "-y")),
            diameter_programming=table.boolean("diameter_programming"),
            extruder=table.boolean("extruder"),
            spindle_ramp_time=table.positive("spindle_ramp_time", zero=True),
            homing_mandatory=table.boolean("homing_mandatory"),
            safety_feed=table.positive("safety_feed", zero=True),
            home_is_stop=table.boolean("home_is_stop"),
            turning=table.boolean("turning"),
            straight_traverse=table.boolean("straight_traverse"),
            version=_version(table),
            accepts=_accepts(table, table.values.get("dialect", before.dialect)),
            limits_hold=table.text("limits_hold", LIMITS_HOLD),
        ),
    )
    table.finish()
    return controller, keys


def _version(table: TomlTable) -> str | None:
    """The version of the controller's software, a text that is not empty."""
    version = table.text("version")
    if version is not None and not version.strip():
        table.bad("version", "an empty text")
    return version.strip() if version else None


def _accepts(table: TomlTable, dialect: object) -> tuple[str, ...] | None:
    """Names of ``ir/dialects/accepts.py``, each once; ``_`` counts as ``-``."""
    names = table.texts("accepts")
    if names is None:
        return None
    known = names_of(dialect if isinstance(dialect, str) else None)
    found = tuple(dict.fromkeys(name.replace("_", "-") for name in names))
    for name in found:
        if name in ACCEPTS and name not in known:
            table.bad("accepts", f"{dialect} has no {name!r}; it has: {', '.join(known) or 'no entry is'}")
        elif name not in ACCEPTS:
            near = meant(name, known)
            table.bad("accepts", f"{name!r} is not one of {', '.join(known)}{'; ' * bool(near)}{near}")
        elif ACCEPTS[name].against in found[: found.index(name)]:
            table.bad("accepts", f"{ACCEPTS[name].against!r} and {name!r} cannot both be true")
    return found
