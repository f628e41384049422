"""The range of every number of a Machine, Setup, Trace or StepStream: looked at before anything reckons with it.

One walk over a value, by its types: each number is finite and in a stated range, that of its field where the tables
below name it, else of its kind. NaN and infinity are only where the field's documentation gives them a meaning. What
is in range can be squared, scaled by resolutions and converted to ticks within doubles and 64 bits; a value that is no
sense (a tool of -3 mm) is the business of who uses it.
"""

from __future__ import annotations

import dataclasses
import functools
import math
import sys
from collections.abc import Iterator
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from gproof.ir.columns import Columns


class Range(NamedTuple):
    """low <= x <= high; infinite, unstated: infinity and NaN are allowed too; least: of any but 0, signs aside."""

    low: float
    high: float
    infinite: bool = False
    unstated: bool = False
    least: float = 0.0


GREATEST = 1e9
"""Lengths in mm, angles in degrees, speeds and times of any machine and job: a million metres."""
PLAIN = Range(-GREATEST, GREATEST)
"""Of a number of which no table says otherwise."""
POSITIVE = Range(1e-9, GREATEST)
NOT_NEGATIVE = Range(0, GREATEST, least=1e-9)
COUNT = Range(0, GREATEST)
RESOLUTION = Range(-GREATEST, GREATEST, least=1e-9)
OPEN = Range(-1e15, 1e15, infinite=True)
VARIABLE = Range(-1e300, 1e300)
LONGEST_TABLE = 1 << 26
"""Rows of a table at most: their indexes are 32 bits."""
FRACTION_BITS = 4096
"""Of numerator and denominator of a rational number: what a file's decimals and a double's exact value need."""

FIELDS: dict[tuple[str, str], Range] = {
    # Divided by, or ticks are counted by it.
    ("Machine", "unit"): Range(1e-6, 1e6),
    ("Board", "tick_frequency"): Range(1, 1e12),
    ("StepStream", "tick_frequency"): Range(1, 1e12),
    ("Board", "step_pulse"): Range(0, 1),
    ("Board", "direction_setup"): Range(0, 1),
    ("WiredOutput", "speed"): POSITIVE,
    ("Controller", "interpolation_time"): Range(1e-6, 10),
    ("Controller", "fifo_time"): Range(1e-3, 60),
    ("Controller", "spindle_ramp_time"): Range(0, 1e6, least=1e-9),
    ("Controller", "max_step_frequency"): Range(1e-6, 1e12),
    ("Axis", "max_velocity"): POSITIVE,
    ("Axis", "max_acceleration"): POSITIVE,
    ("Slave", "max_velocity"): POSITIVE,
    ("Slave", "max_acceleration"): POSITIVE,
    ("Axis", "backlash"): NOT_NEGATIVE,
    ("Slave", "backlash"): NOT_NEGATIVE,
    ("CylinderMap", "radius"): POSITIVE,
    ("HeightMap", "size"): POSITIVE,
    ("Workpiece", "cell"): POSITIVE,
    ("Axis", "steps_per_unit"): RESOLUTION,
    ("Slave", "steps_per_unit"): RESOLUTION,
    ("Motor", "steps_per_unit"): RESOLUTION,
    ("InForce", "factor_x"): RESOLUTION,
    ("InForce", "factor_y"): RESOLUTION,
    ("McuWinSettings", "wait_unit"): Range(0, 1e6),
    # Indexes and numbers of things.
    ("Motor", "axis"): Range(0, 5),
    ("Boundary", "axis"): Range(0, 5),
    ("TipOffset", "axis"): Range(0, 5),
    ("State", "backlash"): PLAIN,
    ("TraceSection", "number"): COUNT,
    ("TraceSection", "start_frame"): COUNT,
    ("StreamSection", "number"): COUNT,
    ("Edge", "target"): Range(-1, GREATEST),
    ("Edge", "file"): COUNT,
    # Steps and ticks: sums of them stay within 64 bits.
    ("StreamSection", "start"): Range(-(2**45), 2**45),
    ("StreamSection", "duration"): Range(0, 2**61),
    # A side that is open, a bound that is not known.
    ("Axis", "lower"): OPEN,
    ("Axis", "upper"): OPEN,
    ("Axis", "travel_lower"): OPEN,
    ("Axis", "travel_upper"): OPEN,
    ("Axis", "boundary_lower"): OPEN,
    ("Axis", "boundary_upper"): OPEN,
    ("Slave", "lower"): OPEN,
    ("Slave", "upper"): OPEN,
    ("Slave", "travel_lower"): OPEN,
    ("Slave", "travel_upper"): OPEN,
    ("Area", "box"): OPEN,
    ("Interval", "low"): OPEN,
    ("Interval", "high"): OPEN,
    ("Boundary", "low"): OPEN,
    ("Boundary", "high"): OPEN,
    ("ToolDiameter", "low"): OPEN,
    ("ToolDiameter", "high"): OPEN,
    ("State", "path_tolerance"): Range(0, GREATEST, infinite=True),
    ("State", "simplify"): Range(0, GREATEST, infinite=True),
    # NaN: not known, or the machine's own setting (see ``State``).
    ("State", "spindle"): Range(-GREATEST, GREATEST, unstated=True),
    ("State", "laf_angle"): Range(-GREATEST, GREATEST, unstated=True),
    ("State", "feed_override"): Range(-GREATEST, GREATEST, unstated=True),
    ("State", "surface_speed"): Range(-GREATEST, GREATEST, unstated=True),
    ("State", "spindle_limit"): Range(-GREATEST, GREATEST, unstated=True),
    # Numbers of the program's own, of any kind.
    ("Setup", "parameters"): VARIABLE,
    ("Setup", "default_parameter"): VARIABLE,
    ("Setup", "parameter_ranges"): VARIABLE,
    ("Setup", "resident"): VARIABLE,
    ("Setup", "answers"): VARIABLE,
    ("Setup", "inputs"): VARIABLE,
    ("Setup", "outputs"): VARIABLE,
    ("Setup", "virtual"): VARIABLE,
}
"""By class and field; parts of it, keys of dicts included, have the same."""

INHERITED = frozenset({("Setup", "parameter_ranges"), ("Setup", "resident")})
"""Fields of which the range holds for the records in them too."""

COLUMNS: dict[tuple[str, str], Range] = {
    ("trace", "feed"): Range(0, GREATEST, unstated=True),
    ("trace", "arg"): Range(-1e12, 1e12, infinite=True, unstated=True),
    ("runs", "interval"): Range(1, 2**61),
    ("runs", "count"): Range(1, 2**61),
    ("runs", "add"): Range(-(2**61), 2**61),
    ("runs", "direction"): Range(-1, 1),
    ("events", "tick"): Range(0, 2**61),
    ("events", "row"): COUNT,
    ("events", "arg"): Range(-(2**61), 2**61),
}
"""By schema and column; others: PLAIN."""


class NumberProblem(NamedTuple):
    """where: the field's path from the root, as in ``axes[0].lower``; what: a sentence part that says what it is."""

    where: str
    what: str


def number_problem(value: Any, *, tables: bool = True) -> NumberProblem | None:
    """The first number that is out of range, None when there is none; for values of their declared types.

    tables: those of column tables too (False: whoever asks has judged them).
    """
    if _fine(value, PLAIN, forced=False, tables=tables):
        return None
    return next(_problems(value, PLAIN, "", forced=False, tables=tables), None)


@functools.cache
def _fields(cls: type) -> tuple[tuple[str, Range, bool], ...]:
    name = cls.__name__
    return tuple(
        (f.name, FIELDS.get((name, f.name), PLAIN), (name, f.name) in INHERITED) for f in dataclasses.fields(cls)
    )


def _fine(value: Any, range_: Range, *, forced: bool, tables: bool) -> bool:
    """True only where ``_problems`` finds nothing; several times as fast for what most values are."""
    kind = type(value)
    if kind is float or kind is int:
        if range_.least == 0.0 and range_.low <= value <= range_.high:
            return True
        return not _problem(value, range_)
    if kind is str or value is None or issubclass(kind, str):
        return True
    if kind is tuple or kind is list:
        return all(_fine(item, range_, forced=forced, tables=tables) for item in value)
    if kind is not Columns and dataclasses.is_dataclass(kind):
        for name, own, passed in _fields(kind):
            field_range = range_ if forced else own
            if not _fine(getattr(value, name), field_range, forced=forced or passed, tables=tables):
                return False
        return True
    return next(_problems(value, range_, "", forced=forced, tables=tables), None) is None


def _problems(value: Any, range_: Range, where: str, *, forced: bool, tables: bool) -> Iterator[NumberProblem]:
    """forced: the range holds for fields of records too; tables: those of columns are looked at."""
    if value is None or isinstance(value, str | bytes | bool):
        return
    if isinstance(value, int | float | Fraction):
        what = _problem(value, range_)
        if what:
            yield NumberProblem(where, what)
    elif isinstance(value, tuple | list | frozenset):
        for place, item in enumerate(value):
            yield from _problems(item, range_, f"{where}[{place}]", forced=forced, tables=tables)
    elif isinstance(value, dict):
        for key, item in value.items():
            yield from _problems(key, range_, f"{where} key", forced=forced, tables=tables)
            yield from _problems(item, range_, f"{where}[{key!r}]", forced=forced, tables=tables)
    elif isinstance(value, Columns):
        if tables:
            yield from _columns(value, where)
    elif dataclasses.is_dataclass(value) and not isinstance(value, type):
        for name, own, passed in _fields(type(value)):
            inner = f"{where}.{name}" if where else name
            found = range_ if forced else own
            yield from _problems(getattr(value, name), found, inner, forced=forced or passed, tables=tables)


def _problem(value: Any, range_: Range) -> str:
    if isinstance(value, float) and not math.isfinite(value):
        good = range_.unstated if math.isnan(value) else range_.infinite
        return "" if good else f"{value} is not a possible number here"
    if isinstance(value, Fraction) and max(map(int.bit_length, value.as_integer_ratio())) > FRACTION_BITS:
        return f"a fraction of more than {FRACTION_BITS} bits"
    if 0 < abs(value) < range_.least:
        return f"{float(value):g} is closer to 0 than {range_.least:g}"
    if range_.low <= value <= range_.high:
        return ""
    if isinstance(value, int) and value.bit_length() > 64:
        return f"a whole number of {value.bit_length()} bits, outside {range_.low:g} to {range_.high:g}"
    if abs(value) > sys.float_info.max:
        return f"an infinite number, outside {range_.low:g} to {range_.high:g}"
    return f"{float(value):g} is outside {range_.low:g} to {range_.high:g}"


def _columns(table: Columns, where: str) -> Iterator[NumberProblem]:
    if len(table) > LONGEST_TABLE:
        yield NumberProblem(where, f"a table of {len(table)} rows, more than {LONGEST_TABLE}")
        return
    for column in table.schema.columns:
        range_ = COLUMNS.get((table.schema.name, column.name), PLAIN)
        values = table[column.name]
        if values.size == 0:
            continue
        info = np.iinfo(values.dtype) if values.dtype.kind in "iu" else None
        if info is not None and info.min >= range_.low and info.max <= range_.high:
            continue
        low, high = values.min(), values.max()  # NaN where there is one
        if range_.low <= low and high <= range_.high:
            continue
        flat = values.reshape(len(table), -1)
        good = (flat >= range_.low) & (flat <= range_.high)
        if range_.infinite:
            good |= np.isinf(flat)
        if range_.unstated:
            good |= np.isnan(flat)
        if not good.all():
            row = int(np.argmin(good.all(axis=1)))
            bad = flat[row][~good[row]][0].item()
            yield NumberProblem(f"{where}.{column.name}[{row}]", _problem(bad, range_))
