"""A record is what ``dataclasses.dataclass`` makes of the same class."""

from __future__ import annotations

import copy
import dataclasses
import inspect
import pickle
from collections.abc import Callable
from itertools import product
from typing import Any

import pytest

from gproof.ir.record import field, record

Decorator = Callable[..., Any]


def plain(decorate: Decorator, **how: bool) -> Any:
    @decorate(slots=True, **how)
    class Thing:
        """A thing."""

        a: int
        b: float = 2.5
        c: list[int] = field(default_factory=list)
        d: str = field(default="d", compare=False)
        e: int = field(default=7, repr=False)
        f: int = field(init=False, default=9)
        g: dict[str, int] = field(init=False, repr=False, compare=False, default_factory=dict)

        @property
        def double(self) -> int:
            return 2 * self.a

    return Thing


def with_methods(decorate: Decorator, **how: bool) -> Any:
    @decorate(slots=True, **how)
    class Thing:
        """A thing."""

        a: int
        b: int = 0

        def __post_init__(self) -> None:
            object.__setattr__(self, "b", self.b + 1)

        def __repr__(self) -> str:
            return f"<{self.a}>"

        def __hash__(self) -> int:
            return 5

    return Thing


def inherited(decorate: Decorator, **how: bool) -> Any:
    @decorate(slots=True, **how)
    class Base:
        """A base."""

        a: int
        b: int = 1

    @decorate(slots=True, **how)
    class Thing(Base):
        """A thing."""

        c: int = 2

    return Thing


def empty(decorate: Decorator, **how: bool) -> Any:
    @decorate(slots=True, **how)
    class Thing:
        """Nothing."""

    return Thing


def own_equality(decorate: Decorator, **how: bool) -> Any:
    @decorate(slots=True, **how)
    class Thing:  # noqa: PLW1641
        """A thing."""

        a: int
        b: int = 0

        def __eq__(self, other: object) -> bool:
            return True

    return Thing


SHAPES = [plain, with_methods, inherited, empty, own_equality]
WAYS = [
    {"frozen": frozen, "kw_only": kw_only, "eq": eq} for frozen, kw_only, eq in product((False, True), repeat=3)
]  # fmt: skip
CASES = [pytest.param(shape, how, id=f"{shape.__name__}-{n}") for shape in SHAPES for n, how in enumerate(WAYS)]


def outcome(act: Callable[[], Any]) -> Any:
    """What it gives, or the kind of its error."""
    try:
        return act()
    except Exception as error:
        return type(error)


@pytest.mark.parametrize(("shape", "how"), CASES)
def test_a_record_is_a_dataclass(shape: Callable[..., Any], how: dict[str, bool]) -> None:
    ours, theirs = shape(record, **how), shape(dataclasses.dataclass, **how)
    assert [f.name for f in dataclasses.fields(ours)] == [f.name for f in dataclasses.fields(theirs)]
    assert ours.__slots__ == theirs.__slots__
    assert ours.__match_args__ == theirs.__match_args__
    assert (ours.__hash__ is None) == (theirs.__hash__ is None)
    names = [(p.name, p.kind) for p in inspect.signature(ours).parameters.values()]
    assert names == [(p.name, p.kind) for p in inspect.signature(theirs).parameters.values()]

    def same(act: Callable[[Any], Any]) -> None:
        assert outcome(lambda: act(ours)) == outcome(lambda: act(theirs))

    arguments: list[tuple[tuple[Any, ...], dict[str, Any]]] = [
        ((), {}), ((1,), {}), ((), {"a": 1}), ((1, 2), {}), ((), {"a": 1, "b": 3}), ((1, 2, 3, 4, 5, 6, 7), {}),
        ((), {"a": 1, "z": 2}), ((1,), {"a": 1}),
    ]  # fmt: skip
    for words, named in arguments:
        same(lambda cls, w=words, n=named: repr(cls(*w, **n)).rpartition("<locals>.")[2])
        for other_words, other_named in arguments:
            same(lambda cls, w=words, n=named, o=other_words, m=other_named: cls(*w, **n) == cls(*o, **m))
            same(lambda cls, w=words, n=named, o=other_words, m=other_named: (
                hash(cls(*w, **n)) == hash(cls(*o, **m)) if how["eq"] else type(hash(cls(*w, **n)))
            ))  # fmt: skip
        same(lambda cls, w=words, n=named: dataclasses.astuple(cls(*w, **n)))
        same(lambda cls, w=words, n=named: dataclasses.astuple(dataclasses.replace(cls(*w, **n), a=8)))
        same(lambda cls, w=words, n=named: dataclasses.astuple(copy.deepcopy(cls(*w, **n))))
        if shape is not empty or not how["frozen"]:
            same(lambda cls, w=words, n=named: setattr(cls(*w, **n), "a", 4))
            same(lambda cls, w=words, n=named: delattr(cls(*w, **n), "a"))
        if not how["frozen"]:
            # Of what is no field of a frozen class with slots, the standard library (3.11) fails in its own refusal.
            same(lambda cls, w=words, n=named: setattr(cls(*w, **n), "nothing", 4))
    same(lambda cls: cls(a=1) == 1)
    same(lambda cls: cls(a=1).c is cls(a=1).c)


@record(frozen=True, slots=True, kw_only=True)
class Kept:
    """A record of a module, which can be pickled."""

    a: int
    b: list[int] = field(default_factory=list)


@pytest.mark.parametrize("protocol", range(2, pickle.HIGHEST_PROTOCOL + 1))
def test_records_can_be_pickled(protocol: int) -> None:
    value = Kept(a=1, b=[2])
    again = pickle.loads(pickle.dumps(value, protocol))
    assert again == value
    with pytest.raises(dataclasses.FrozenInstanceError):
        again.a = 3
    with pytest.raises(dataclasses.FrozenInstanceError):
        del again.a


def test_a_record_has_slots() -> None:
    with pytest.raises(TypeError):
        record(slots=False)
