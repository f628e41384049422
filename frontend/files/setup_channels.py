"""Tables of a setup file that speak of channels, stored places and tool measures, as WinCNC has them.

``[positions.P4]``, ``[inputs]``, ``[outputs]``, ``[virtual_inputs]``, ``answers``, ``[measures]``,
``[contacts]``: docs/setup-files.md. Axes go by the letters of the machine's own words.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction

from gproof.frontend.common.toml_table import TomlTable, show, small_number
from gproof.ir.machine import AXIS_NAMES, AxisKind, Machine
from gproof.ir.setup import Interval, Setup, StoredPosition

HIGHEST_CHANNEL = 64
_DIGITAL = re.compile(r"([a-z])\.digib\.([1-9]\d?)", re.ASCII)
_PLACE = re.compile(r"[PHT]\d{1,4}", re.ASCII)
_TURNING = "abc"
Columns = Mapping[str, tuple[str, bool]]


def columns_of(machine: Machine) -> Columns:
    """Names of axes in setup files: their column, and whether they turn.

    An axis that moves by another letter than its column's (a second head W) goes by that letter.
    """
    found = {name: (name, name in _TURNING) for name in AXIS_NAMES}
    for axis in machine.axes:
        found.pop(axis.name, None)
    for axis in machine.axes:
        found[axis.word.lower()] = (axis.name, axis.kind is AxisKind.ROTARY)
    return dict(sorted(found.items(), key=lambda one: AXIS_NAMES.index(one[1][0])))


def axes_of(table: TomlTable | None, unit: Fraction, columns: Columns) -> dict[str, Interval]:
    """Values by column name; those that are lengths are multiplied by ``unit``."""
    if table is None:
        return {}
    found = {}
    for name, (column, turns) in columns.items():
        ends = table.interval(name, unit=Fraction(1) if turns else unit)
        if ends is not None:
            found[column] = Interval(*ends)
    table.finish()
    return found


def digital_inputs(machine: Machine) -> dict[str, int]:
    """By axis word in small letters, the channel before the first of its digital inputs, as programs have them.

    ``X.digib.5`` is channel 5 of the first axis of the machine: 105 (McuWIN manual 4.11, 7).
    """
    return {axis.word.lower(): 100 * place for place, axis in enumerate(machine.axes, 1)}


def with_channels(setup: Setup, root: TomlTable, unit: Fraction, columns: Columns, machine: Machine) -> Setup:
    """The setup with what these tables state."""
    return replace(
        setup,
        positions=_positions(root.table("positions"), unit, columns),
        inputs=_states(root.table("inputs"), digital_inputs(machine)),
        outputs=_states(root.table("outputs")),
        virtual=_states(root.table("virtual_inputs")),
        answers=_answers(root),
        measures=axes_of(root.table("measures"), unit, columns),
        contacts=axes_of(root.table("contacts"), unit, columns),
    )


def _positions(table: TomlTable | None, unit: Fraction, columns: Columns) -> dict[str, StoredPosition]:
    """Stored places: ``[positions.P4]``, ``H1``, ``T3``; machine positions."""
    found: dict[str, StoredPosition] = {}
    for name in table.values if table else ():
        assert table is not None
        inner = table.table(name) if _PLACE.fullmatch(name) else None
        if inner is None:
            table.take(name)
            table.bad(name, f"{name!r} is not P, H or T and a number")
            continue
        axes: dict[str, float] = {}
        for letter, (column, turns) in columns.items():
            value = inner.number(letter, unit=Fraction(1) if turns else unit)
            if value is not None:
                axes[column] = value
        lift, clearance = inner.boolean("lift"), inner.number("clearance", unit=unit)
        if lift is None:
            inner.missing("lift")
        inner.finish()
        found[f"{name[0]}{int(name[1:])}"] = StoredPosition(axes=axes, lift=bool(lift), clearance=clearance)
    return found


def _states(table: TomlTable | None, digital: Mapping[str, int] | None = None) -> dict[int, float]:
    """Channels that are on (1 or true) or off (0 or false). digital: see ``digital_inputs``."""
    found: dict[int, float] = {}
    for name in table.values if table else ():
        assert table is not None
        value = table.take(name)
        channel = _channel(name, digital or {})
        if channel is None:
            or_axis = "" if digital is None else ', or the input of an axis as programs have it, in quotes: "X.digib.1"'
            table.bad(name, f"{name!r} is not a channel from 1 to {HIGHEST_CHANNEL}{or_axis}")
        elif value not in (0, 1):
            table.bad(name, f"{show(value)} is not 0 or 1")
        elif channel in found:
            table.bad(name, f"{name!r} is stated twice")
        else:
            found[channel] = float(value)
    return found


def _channel(name: str, digital: Mapping[str, int]) -> int | None:
    """The number of a channel, or of an axis's digital input."""
    written = _DIGITAL.fullmatch(name.lower())
    if written is None:
        return small_number(name, 1, HIGHEST_CHANNEL)
    first = digital.get(written[1])
    return None if first is None else first + int(written[2])


def _answers(root: TomlTable) -> dict[int, float]:
    """``answers = ["yes", "no"]``: to the job's questions in their order, from 1."""
    value = root.take("answers")
    if value is None:
        return {}
    if not isinstance(value, list) or any(one not in ("yes", "no") for one in value):
        root.bad("answers", f'{show(value)} is not a list of "yes" and "no"')
        return {}
    return {number: float(one == "yes") for number, one in enumerate(value, 1)}
