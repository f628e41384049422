"""Whether a value read from a file has the types that its dataclass declares, all the way down.

``parse_ir`` builds any dataclass of the IR from any fields; this is what stands between such a value and code
that trusts its types.
"""

from __future__ import annotations

import dataclasses
import enum
import functools
import types
import typing
from collections.abc import Iterable, Iterator
from fractions import Fraction
from typing import Any


@functools.cache
def _fields(cls: type) -> tuple[tuple[str, Any], ...]:
    hints = typing.get_type_hints(cls)
    return tuple((f.name, hints[f.name]) for f in dataclasses.fields(cls))


def misfit(value: Any, hint: Any, where: str = "") -> str:
    """The first place that is not of its declared type, or an empty text.

    A whole number may stand where a float is declared; a truth value stands for no number.
    """
    if isinstance(hint, type):
        return _plain(value, hint, where)
    origin, arguments = typing.get_origin(hint), typing.get_args(hint)
    if origin in (types.UnionType, typing.Union):
        return "" if any(not misfit(value, a) for a in arguments) else f"{where or 'value'}: {type(value).__name__}"
    if not isinstance(value, origin):
        return f"{where or 'value'}: {type(value).__name__}"
    return next(filter(None, _members(value, origin, arguments, where)), "")


def _members(value: Any, origin: Any, arguments: tuple[Any, ...], where: str) -> Iterator[str]:
    if origin is dict:
        for key, item in value.items():
            yield misfit(key, arguments[0], f"{where} key") or misfit(item, arguments[1], f"{where}[{key!r}]")
        return
    hints: Iterable[Any] = arguments
    if origin in (list, frozenset) or arguments[-1] is Ellipsis:
        hints = [arguments[0]] * len(value)
    elif len(value) != len(arguments):
        yield f"{where or 'value'}: {len(value)} instead of {len(arguments)}"
        return
    for place, (item, hint) in enumerate(zip(value, hints, strict=True)):
        yield misfit(item, hint, f"{where}[{place}]")


def _plain(value: Any, hint: type, where: str) -> str:
    good = isinstance(value, hint)
    if hint is int or hint is float:
        good = isinstance(value, int | float if hint is float else int) and not isinstance(value, bool | enum.Enum)
    elif hint is Fraction:
        good = isinstance(value, Fraction)
    if not good:
        return f"{where or 'value'}: {type(value).__name__} where {hint.__name__} belongs"
    if dataclasses.is_dataclass(hint):
        for name, inner in _fields(hint):
            found = misfit(getattr(value, name), inner, f"{where}.{name}" if where else name)
            if found:
                return found
    return ""
