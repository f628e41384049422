"""Every stated fact of a machine and a setup, and other values for it.

A path leads from ``Machine`` or ``Setup`` to a field of it or of a record inside: ``("axes", 0, "lower")``; a row is
the type and the field at its end: ``Axis.lower``.
"""

from __future__ import annotations

import dataclasses
import enum
import typing
from collections.abc import Iterator
from fractions import Fraction
from typing import Any

Path = tuple[Any, ...]


def is_record(value: object) -> bool:
    """An instance of a record of ``ir/``."""
    return dataclasses.is_dataclass(value) and not isinstance(value, type)


def paths(value: Any, path: Path = ()) -> Iterator[tuple[str, Path]]:
    """(row, path) of each field of a record and of the records inside it."""
    for known in dataclasses.fields(value):
        inner = getattr(value, known.name)
        yield f"{type(value).__name__}.{known.name}", (*path, known.name)
        yield from _inside(inner, (*path, known.name))


def _inside(value: Any, path: Path) -> Iterator[tuple[str, Path]]:
    if is_record(value):
        yield from paths(value, path)
    elif isinstance(value, tuple):
        for place, item in enumerate(value[:3]):
            yield from _inside(item, (*path, place))
    elif isinstance(value, dict):
        for key, item in list(value.items())[:3]:
            yield from _inside(item, (*path, key))


def at(value: Any, path: Path) -> Any:
    """What a path leads to."""
    for step in path:
        value = getattr(value, step) if is_record(value) else value[step]
    return value


def put(value: Any, path: Path, new: Any) -> Any:
    """The same with another value at the end of a path."""
    if not path:
        return new
    step, rest = path[0], path[1:]
    if is_record(value):
        return dataclasses.replace(value, **{step: put(getattr(value, step), rest, new)})
    if isinstance(value, dict):
        return {**value, step: put(value[step], rest, new)}
    return (*value[:step], put(value[step], rest, new), *value[step + 1 :])


def others(value: Any, hint: Any) -> Iterator[Any]:
    """Other values that a field of the type ``hint`` may have."""
    if value is not None and type(None) in typing.get_args(hint):
        yield None
    if isinstance(value, bool) or (value is None and bool in typing.get_args(hint)):
        yield from (v for v in (True, False) if v is not value)
    elif isinstance(value, enum.Enum):
        yield from (v for v in type(value) if v is not value)
    elif isinstance(value, (float, Fraction)):
        scale = Fraction if isinstance(value, Fraction) else float
        for number in (value * 2, value / 2, value * 40, -value, value + 3, value - 10, scale(0)):
            if number != value:
                yield number
    elif isinstance(value, int):
        yield from (v for v in (value + 1, value - 1, value * 3, 0) if v != value)
    elif value is None and (float in typing.get_args(hint) or Fraction in typing.get_args(hint)):
        made = float if float in typing.get_args(hint) else Fraction
        yield from (made(n) for n in (3, 0, 90, -5, 2000))
    elif value is None and int in typing.get_args(hint):
        yield from (0, 1, 2, 5)
    elif isinstance(value, tuple) and value:
        yield ()
        if isinstance(value[0], (int, float)) and not isinstance(value[0], bool):
            for factor in (2, -1):
                yield tuple(v * factor for v in value)
        elif isinstance(value[0], tuple) and value[0] and isinstance(value[0][-1], float):
            yield tuple((*inner[:-1], inner[-1] * 2 + 1) for inner in value)
        if len(value) > 1:
            yield value[:-1]
            yield value[::-1]
    elif isinstance(value, dict) and value:
        yield {}
        first = next(iter(value))
        if isinstance(value[first], float):
            yield {**value, first: value[first] * 2 + 1}
            yield {**value, first: 1.0 - value[first]}
