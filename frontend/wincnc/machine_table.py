"""``[controls]`` of gproof's own machine file: what no file of a WinCNC machine says, or a job needs otherwise.

docs/machine-files.md lists the keys; they have the names of ``ir/dialects/wincnc/settings.py``.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

from gproof.frontend.common.exact_numbers import exact_number
from gproof.frontend.common.toml_table import TomlTable, show
from gproof.ir.dialects.accepts import LINE_NUMBERS, TEXT_AFTER_COMMENT
from gproof.ir.dialects.wincnc.settings import DEVICES, HIGHEST_CHANNEL, WinCncSettings, wincnc_settings
from gproof.ir.machine import AXIS_NAMES, Machine

DEEPEST = 1000
MOST_CHANNELS = 1000


def settings_from(root: TomlTable, machine: Machine, unit: Fraction) -> WinCncSettings:
    """The machine's settings with what the table and ``accepts`` of ``[controller]`` state."""
    return _read_so(_controls_from(root, wincnc_settings(machine), unit), machine.controller.accepts)


def _controls_from(root: TomlTable, before: WinCncSettings, unit: Fraction) -> WinCncSettings:
    """The controls with what the table states; lengths of the table are in ``unit`` mm."""
    table = root.table("controls")
    if table is None:
        return before
    highest = table.whole("highest_channel", 1, MOST_CHANNELS)
    top = HIGHEST_CHANNEL if highest is None else highest
    stated: dict[str, Any] = {
        "highest_channel": highest,
        "around_files": table.boolean("around_files"),
        "array_order": table.text("array_order", ("rows", "columns")),
        "absolute": table.boolean("absolute"),
        "soft_limits": table.boolean("soft_limits"),
        "limits_available": table.boolean("limits_available"),
        "adjust_boundary": table.boolean("adjust_boundary"),
        "adjust_vertical": table.boolean("adjust_vertical"),
        "arcs_modal": table.boolean("arcs_modal"),
        "helical_arcs": table.boolean("helical_arcs"),
        "arcs_share_feed": table.boolean("arcs_share_feed"),
        "arc_tolerance": table.positive("arc_tolerance", unit=unit, zero=True),
        "smallest_arc": table.positive("smallest_arc", unit=unit, zero=True),
        "shift_sign": _sign(table, "shift_sign"),
        "rotation_sign": _sign(table, "rotation_sign"),
        "virtual_on": table.whole("virtual_on", 60, 61),
        "knife_positions": table.text("knife_positions", ("machine", "work")),
        "nesting": table.whole("nesting", 0, DEEPEST),
        "start": table.text("start"),
        "end": table.text("end"),
        "abort": table.text("abort"),
        "coolant": _channels(table, "coolant", top),
        "inputs": _channels(table, "inputs", top),
        "outputs": _channels(table, "outputs", top),
        "devices": _texts(table, "devices", DEVICES),
        "feed_groups": _groups(table),
    }
    group = table.text("command_group")
    if group is not None and _is_group(group):
        stated["command_group"] = group
    elif group is not None:
        table.bad("command_group", f"{group[:20]!r} is not made of {', '.join(AXIS_NAMES)}")
    table.finish()
    given = {name: value for name, value in stated.items() if value is not None}
    return replace(before, **given, places=tuple(place for place in before.places if place[0] not in given))


def _read_so(settings: WinCncSettings, accepts: tuple[str, ...]) -> WinCncSettings:
    """With what ``accepts`` says of how lines are read."""
    before = settings.lexical
    lexical = replace(
        before,
        continued=before.continued or TEXT_AFTER_COMMENT.name in accepts,
        numbered=before.numbered or LINE_NUMBERS.name in accepts,
    )
    return settings if lexical == before else replace(settings, lexical=lexical)


def _sign(table: TomlTable, key: str) -> int | None:
    """1 or -1."""
    sign = table.whole(key, -1, 1)
    if sign == 0:
        table.bad(key, "0 is neither 1 nor -1")
        return None
    return sign


def _channels(table: TomlTable, key: str, top: int) -> tuple[int, ...] | None:
    """A list of numbers of inputs or outputs."""
    value = table.take(key)
    if value is None:
        return None
    numbers = [exact_number(one) for one in value] if isinstance(value, list) else [None]
    found = [int(n) for n in numbers if n is not None and n.denominator == 1 and 1 <= n <= top]
    if len(found) != len(numbers):
        table.bad(key, f"{show(value)} is not a list of whole numbers from 1 to {top}")
        return None
    return tuple(sorted(set(found)))


def _texts(table: TomlTable, key: str, allowed: tuple[str, ...] = ()) -> tuple[str, ...] | None:
    """A list of texts, each of ``allowed`` when that is given."""
    found = table.texts(key)
    strange = next((one for one in found or () if allowed and one not in allowed), None)
    if strange is not None:
        table.bad(key, f"{show(strange)} is not one of {', '.join(allowed)}")
        return None
    return found


def _groups(table: TomlTable) -> tuple[str, ...] | None:
    """Columns that share a feed, a text for each group, no column in two."""
    groups = _texts(table, "feed_groups")
    if groups is not None and not _is_group("".join(groups)):
        table.bad("feed_groups", f"{show(list(groups))}: each of {', '.join(AXIS_NAMES)} at most once")
        return None
    return groups


def _is_group(columns: str) -> bool:
    return set(columns) <= set(AXIS_NAMES) and len(set(columns)) == len(columns)
