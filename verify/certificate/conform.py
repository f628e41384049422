"""Whether a value read from a file has the types that its dataclass declares, all the way down.

``parse_ir`` builds any dataclass of the IR from any fields; this is what is between such a value and code
that trusts its types.
"""

from __future__ import annotations

import dataclasses
import enum
import functools
import types
import typing
from collections.abc import Callable, Iterable, Iterator
from fractions import Fraction
from typing import Any


@functools.cache
def _fields(cls: type) -> tuple[tuple[str, Any], ...]:
    hints = typing.get_type_hints(cls)
    return tuple((f.name, hints[f.name]) for f in dataclasses.fields(cls))


def misfit(value: Any, hint: Any, where: str = "") -> str:
    """The first place that is not of its declared type, or an empty text.

    A value of a type made from the declared one is held against its own fields. A whole number is allowed where a float
    is declared; a truth value stands for no number.
    """
    return "" if _checker(hint)(value) else _misfit(value, hint, where)


@functools.cache
def _checker(hint: Any) -> Callable[[Any], bool]:
    """What says at once whether a value is of a declared type, without the place where it is not."""
    if isinstance(hint, type):
        return _plain_checker(hint)
    origin, arguments = typing.get_origin(hint), typing.get_args(hint)
    if origin in (types.UnionType, typing.Union):
        options = [_checker(a) for a in arguments]
        return lambda value: any(fits(value) for fits in options)
    if origin is dict:
        key, item = map(_checker, arguments)
        return lambda value: isinstance(value, dict) and all(key(k) and item(v) for k, v in value.items())
    if origin in (list, frozenset) or arguments[-1] is Ellipsis:
        each = _checker(arguments[0])
        return lambda value: isinstance(value, origin) and all(map(each, value))
    parts = [_checker(a) for a in arguments]
    return lambda value: (
        isinstance(value, origin)
        and len(value) == len(parts)
        and all(fits(item) for fits, item in zip(parts, value, strict=True))
    )


def _plain_checker(hint: type) -> Callable[[Any], bool]:
    if hint is float or hint is int or not dataclasses.is_dataclass(hint):
        return lambda value: type(value) is hint or not _plain(value, hint, "")
    fields: list[tuple[str, Callable[[Any], bool]]] = []

    def fits(value: Any) -> bool:
        if not fields:  # Not before: a type may have fields of its own type.
            fields.extend((name, _checker(inner)) for name, inner in _fields(hint))
        if type(value) is not hint:
            return isinstance(value, hint) and _checker(type(value))(value)
        return all(check(getattr(value, name)) for name, check in fields)

    return fits


def _misfit(value: Any, hint: Any, where: str) -> str:
    """The first place that is not of its declared type, or an empty text."""
    if isinstance(hint, type):
        return _plain(value, hint, where)
    origin, arguments = typing.get_origin(hint), typing.get_args(hint)
    if origin in (types.UnionType, typing.Union):
        return (
            "" if any(not _misfit(value, a, "") for a in arguments) else f"{where or 'value'}: {type(value).__name__}"
        )
    if not isinstance(value, origin):
        return f"{where or 'value'}: {type(value).__name__}"
    return next(filter(None, _members(value, origin, arguments, where)), "")


def _members(value: Any, origin: Any, arguments: tuple[Any, ...], where: str) -> Iterator[str]:
    if origin is dict:
        for key, item in value.items():
            yield _misfit(key, arguments[0], f"{where} key") or _misfit(item, arguments[1], f"{where}[{key!r}]")
        return
    hints: Iterable[Any] = arguments
    if origin in (list, frozenset) or arguments[-1] is Ellipsis:
        hints = [arguments[0]] * len(value)
    elif len(value) != len(arguments):
        yield f"{where or 'value'}: {len(value)} instead of {len(arguments)}"
        return
    for place, (item, hint) in enumerate(zip(value, hints, strict=True)):
        yield _misfit(item, hint, f"{where}[{place}]")


def _plain(value: Any, hint: type, where: str) -> str:
    good = isinstance(value, hint)
    if hint is int or hint is float:
        good = isinstance(value, int | float if hint is float else int) and not isinstance(value, bool | enum.Enum)
    elif hint is Fraction:
        good = isinstance(value, Fraction)
    if not good:
        return f"{where or 'value'}: {type(value).__name__} instead of {hint.__name__}"
    if dataclasses.is_dataclass(hint):
        kind: type = type(value)
        for name, inner in _fields(kind):
            found = _misfit(getattr(value, name), inner, f"{where}.{name}" if where else name)
            if found:
                return found
    return ""
