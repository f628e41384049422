"""``record``: dataclasses that are made fast, because every start of the command makes some hundred and fifty of them.

The standard library writes half a dozen functions a class and compiles each by itself; that was a third of the time of
a small job. Here it finds the fields and the slots, as always, and only ``__init__`` is compiled. For type checkers,
and for ``dataclasses.replace`` and ``fields``, a record is a dataclass with ``slots=True``.
"""

from __future__ import annotations

import dataclasses
import reprlib
import sys
from collections.abc import Callable
from dataclasses import MISSING, FrozenInstanceError, field
from operator import attrgetter
from typing import TYPE_CHECKING, Any, TypeVar

__all__ = ["field", "record"]

T = TypeVar("T")

if TYPE_CHECKING:
    from dataclasses import dataclass as record
else:

    def record(
        *, slots: bool = True, frozen: bool = False, kw_only: bool = False, eq: bool = True
    ) -> Callable[[type[T]], type[T]]:
        """The decorator. slots: always; frozen, kw_only, eq: as of ``dataclasses.dataclass``."""
        if not slots:
            raise TypeError("a record has slots")

        def made(cls: type[T]) -> type[T]:
            own_hash = cls.__dict__.get("__hash__", MISSING)
            cls = dataclasses.dataclass(init=False, repr=False, eq=False, slots=True, kw_only=kw_only)(cls)
            fields = dataclasses.fields(cls)
            cls.__init__ = _init(cls, fields, frozen)
            if "__repr__" not in cls.__dict__:
                cls.__repr__ = _repr(tuple(f.name for f in fields if f.repr))
            if eq and "__eq__" not in cls.__dict__:
                cls.__eq__ = _eq(_getter(f.name for f in fields if f.compare))
            if own_hash is MISSING or (own_hash is None and "__eq__" in cls.__dict__):
                hashed = _getter(f.name for f in fields if (f.compare if f.hash is None else f.hash))
                if eq:
                    cls.__hash__ = _hash(hashed) if frozen else None
            if frozen:
                cls.__setattr__, cls.__delattr__ = _frozen("assign to"), _frozen("delete")
                cls.__getstate__, cls.__setstate__ = _getstate, _setstate
            return cls

        return made


def _init(cls: type, fields: tuple[dataclasses.Field[Any], ...], frozen: bool) -> Callable[..., None]:
    """``__init__``, compiled; a frozen record's slots are set by their descriptors."""
    given: dict[str, Any] = {"_missing": MISSING}
    parameters: list[str] = []
    by_name: list[str] = []
    body: list[str] = []
    for f in fields:
        name, value = f.name, f.name
        if f.default is not MISSING:
            given[f"_default_{name}"] = f.default
        elif f.default_factory is not MISSING:
            given[f"_make_{name}"] = f.default_factory
        if f.init:
            default = ""
            if f.default is not MISSING:
                default = f" = _default_{name}"
            elif f.default_factory is not MISSING:
                default = " = _missing"
                value = f"_make_{name}() if {name} is _missing else {name}"
            (by_name if f.kw_only else parameters).append(f"{name}{default}")
        elif f.default is not MISSING:
            value = f"_default_{name}"
        elif f.default_factory is not MISSING:
            value = f"_make_{name}()"
        else:
            continue
        if frozen:
            given[f"_set_{name}"] = getattr(cls, name).__set__
            body.append(f"_set_{name}(_self, {value})")
        else:
            body.append(f"_self.{name} = {value}")
    if hasattr(cls, "__post_init__"):
        body.append("_self.__post_init__()")
    signature = ", ".join(["_self", *parameters, *(["*", *by_name] if by_name else [])])
    lines = "\n  ".join(body or ["pass"])
    # The names are arguments of a function around it, as in dataclasses: globals are those of the class's module.
    source = f"def _create({', '.join(given)}):\n def __init__({signature}):\n  {lines}\n return __init__"
    scope: dict[str, Any] = {}
    exec(source, sys.modules[cls.__module__].__dict__, scope)
    init: Callable[..., None] = scope["_create"](**given)
    init.__qualname__ = f"{cls.__qualname__}.__init__"
    init.__annotations__ = {f.name: f.type for f in fields if f.init} | {"return": None}
    return init


def _getter(names: Any) -> Callable[[Any], Any]:
    """The values of some fields as one tuple."""
    wanted = tuple(names)
    if len(wanted) > 1:
        return attrgetter(*wanted)
    if not wanted:
        return lambda _: ()
    one = attrgetter(*wanted)
    return lambda value: (one(value),)


def _repr(names: tuple[str, ...]) -> Callable[[Any], str]:
    @reprlib.recursive_repr()
    def __repr__(self: Any) -> str:
        return f"{type(self).__qualname__}({', '.join(f'{name}={getattr(self, name)!r}' for name in names)})"

    return __repr__


def _eq(values: Callable[[Any], Any]) -> Callable[[Any, object], bool]:
    def __eq__(self: Any, other: object) -> bool:
        if other.__class__ is self.__class__:
            return bool(values(self) == values(other))
        return NotImplemented

    return __eq__


def _hash(values: Callable[[Any], Any]) -> Callable[[Any], int]:
    def __hash__(self: Any) -> int:
        return hash(values(self))

    return __hash__


def _frozen(what: str) -> Callable[..., None]:
    def refuse(self: Any, name: str, *_: object) -> None:
        raise FrozenInstanceError(f"cannot {what} field {name!r}")

    return refuse


def _getstate(self: Any) -> list[Any]:
    return [getattr(self, f.name) for f in dataclasses.fields(self)]


def _setstate(self: Any, state: list[Any]) -> None:
    for f, value in zip(dataclasses.fields(self), state, strict=True):
        object.__setattr__(self, f.name, value)
