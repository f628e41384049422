"""Every numeric field of every type that a package holds, set to what no machine has: refused or harmless, at once.

The fields are those that the types have, found by walking them; none is listed here.
"""

from __future__ import annotations

import dataclasses
import enum
import math
import time
import types
import typing
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.campaigns import sizes
from support.guarded import alarm
from verify.package_files import members_of, rebuilt, write

from gproof.backend.boards.virtual import VirtualBoard
from gproof.backend.runtime import RunRefused, run
from gproof.ir.columns import Columns
from gproof.ir.machine import Machine
from gproof.ir.number_ranges import FIELDS, INHERITED, number_problem
from gproof.ir.setup import Setup
from gproof.ir.stream import EVENT, RUN, StepStream
from gproof.ir.trace import TRACE_ROW, Trace
from gproof.ir.workpiece import TRIANGLES
from gproof.verify.certificate.check import check_package
from gproof.verify.certificate.package import CertificateError, Package, parts_of, read_package

ROOTS: dict[str, type] = {"machine": Machine, "setup": Setup, "trace": Trace, "stream": StepStream}
FLOATS = (math.nan, math.inf, -math.inf, 1e308, -1e308, 1e-300, 5e-324, -1.0, 0.0, 1e9)
INTEGERS = (-1, 0, 2**31, 2**63, -(2**63), 10**400, 10**9)
FRACTIONS = (
    Fraction(10**400),
    Fraction(1, 10**400),
    Fraction(-1),
    Fraction(0),
    Fraction(10**400 + 1, 10**400),
    Fraction(10**9),
)
Case = tuple[str, Any]


def sample(hint: Any) -> Any:
    """A plain value of a type; every container has something in it."""
    if isinstance(hint, type):
        if hint is Columns:
            return Columns(TRIANGLES, {c.name: np.ones((1, 3)) for c in TRIANGLES.columns})
        if dataclasses.is_dataclass(hint):
            hints = typing.get_type_hints(hint)
            return hint(**{f.name: sample(hints[f.name]) for f in dataclasses.fields(hint) if f.compare})
        if issubclass(hint, enum.Enum):
            return next(iter(hint))
        plain: dict[type, Any] = {
            int: 1, float: 1.0, str: "x", bool: True, Fraction: Fraction(1), bytes: b"", type(None): None,
        }  # fmt: skip
        return plain[hint]
    origin, arguments = typing.get_origin(hint), typing.get_args(hint)
    if origin in (types.UnionType, typing.Union):
        return sample(next(a for a in arguments if a is not type(None)))
    if origin is dict:
        return {sample(arguments[0]): sample(arguments[1])}
    if origin is list:
        return [sample(arguments[0])]
    if origin is frozenset:
        return frozenset([sample(arguments[0])])
    if arguments[-1] is Ellipsis:
        return (sample(arguments[0]),)
    return tuple(sample(a) for a in arguments)


def bad(value: float | Fraction) -> tuple[Any, ...]:
    return FRACTIONS if isinstance(value, Fraction) else FLOATS if isinstance(value, float) else INTEGERS


def spoilt(value: Any, hint: Any, where: str) -> Iterator[Case]:
    """The value with one number exchanged, for each number that may stand in it, also where nothing stands now."""
    empty = value is None or (isinstance(value, tuple | list | dict) and not value)
    if empty and hint is not None:
        value = sample(hint)
    if isinstance(value, bool | str | bytes | enum.Enum) or value is None:
        return
    if isinstance(value, int | float | Fraction):
        yield from ((f"{where} = {other!r:.30}", other) for other in bad(value))
    elif isinstance(value, tuple | list):
        # One item stands for all: they are of one type, or two of each kind are enough.
        for place in range(min(len(value), 2)):
            for name, item in spoilt(value[place], item_hint(hint, place), f"{where}[{place}]"):
                yield name, type(value)([*value[:place], item, *value[place + 1 :]])
    elif isinstance(value, dict):
        key, item = next(iter(value.items()))
        rest = {k: v for k, v in value.items() if k != key}
        yield from ((name, rest | {other: item}) for name, other in spoilt(key, item_hint(hint, 0), f"{where} key"))
        yield from ((name, rest | {key: other}) for name, other in spoilt(item, item_hint(hint, 1), f"{where}[]"))
    elif isinstance(value, Columns):
        yield from spoilt_table(value, where)
    elif dataclasses.is_dataclass(value):
        hints = typing.get_type_hints(type(value))
        for f in dataclasses.fields(value):
            if f.compare:
                for name, other in spoilt(getattr(value, f.name), hints[f.name], f"{where}.{f.name}"):
                    yield name, dataclasses.replace(value, **{f.name: other})  # type: ignore[type-var]


def item_hint(hint: Any, place: int) -> Any:
    arguments = typing.get_args(hint)
    if typing.get_origin(hint) in (types.UnionType, typing.Union):
        return next((item_hint(a, place) for a in arguments if typing.get_args(a)), None)
    if not arguments:
        return None
    return (
        arguments[0] if arguments[-1] is Ellipsis or len(arguments) == 1 else arguments[min(place, len(arguments) - 1)]
    )


def spoilt_table(table: Columns, where: str) -> Iterator[Case]:
    for column in table.schema.columns:
        values = table[column.name]
        others: list[Any] = list(FLOATS) if values.dtype.kind == "f" else []
        if values.dtype.kind in "iu":
            info = np.iinfo(values.dtype)
            others = [info.min, info.max, 0, *((2**31, 2**53) if info.bits == 64 else ())]
        for other in others:
            for row in {0, len(table) - 1} if len(table) else ():
                changed = values.copy()
                changed[row] = other
                arrays = {c.name: table[c.name] for c in table.schema.columns} | {column.name: changed}
                yield f"{where}.{column.name}[{row}] = {other!r}", Columns(table.schema, arrays)


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Package:
    return read_package(write(tmp_path_factory.mktemp("numbers") / "job.gpx", name="events"))


def judged(package: Package, part: str, value: Any) -> str:
    """``refused`` (by its numbers, by the checker, by the runtime) or ``ran``; no exception passes."""
    if number_problem(value) is not None:
        return "refused"
    changed = dataclasses.replace(package, **{part: value})
    try:
        for one in (changed.machine, changed.trace, changed.stream):
            one.verify()
    except ValueError:
        return "refused"
    if not check_package(changed).valid:
        return "refused"
    board = VirtualBoard.for_machine(changed.machine, len(changed.stream.motors))
    try:
        run(changed, board)
    except RunRefused:
        return "refused"
    return "ran"


@pytest.mark.parametrize("one_in", sizes(3, 1))
@pytest.mark.parametrize("part", ROOTS)
def test_numbers_that_no_machine_has(part: str, one_in: int, package: Package) -> None:
    seen, failed = set(), []
    for number, (name, value) in enumerate(spoilt(getattr(package, part), ROOTS[part], part)):
        seen.add(name.split(" = ")[0])
        if number % one_in:
            continue  # of neighbouring fields other numbers of the list
        began = time.process_time()
        try:
            with alarm(5):
                judged(package, part, value)
        except Exception as error:
            failed.append(f"{name}: {type(error).__name__}: {error}")
        took = time.process_time() - began
        assert took < 5.0, f"{name}: {took:.1f} s"
    assert not failed
    assert len(seen) > 5


@pytest.mark.parametrize("part", ROOTS)
def test_what_is_not_finite_is_refused_where_nothing_says_what_it_means(part: str, package: Package) -> None:
    """Every field of every type, without a reckoning: NaN and infinity only where the table has them."""
    for name, value in spoilt(getattr(package, part), ROOTS[part], part):
        for sign in ("nan", "inf", "1e+308", "10000000000000000000000000000"):
            if f" = {sign}" in name or f" = -{sign}" in name:
                found = number_problem(value)
                assert found is not None or allowed(name, sign), name


def allowed(name: str, sign: str) -> bool:
    place, _, _ = name.partition(" = ")
    field = place.rstrip("0123456789[]").replace(" key", "").rsplit(".", 1)[-1].split("[")[0]
    ranges = [r for (_, f), r in FIELDS.items() if f == field]
    if field == "arg":  # NaN: not known; infinite: a tolerance that is not known
        return sign in ("nan", "inf")
    if field == "feed":
        return sign == "nan"
    return any(r.unstated if sign == "nan" else r.infinite for r in ranges)


def test_the_tables_name_fields_that_are_there() -> None:
    from gproof.ir.text import types

    classes = types().classes
    for name, field in {*FIELDS, *INHERITED}:
        assert field in {f.name for f in dataclasses.fields(classes[name])}, (name, field)


@pytest.mark.parametrize("schema", [TRACE_ROW, RUN, EVENT])
def test_columns_are_in_range_as_they_are(schema: Any, package: Package) -> None:
    for part in ("trace", "stream", "machine", "setup"):
        assert number_problem(getattr(package, part)) is None
    assert number_problem(Columns(schema)) is None


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda p: {"machine": dataclasses.replace(p.machine, unit=math.nan)}, "Machine.unit: nan is not a possible"),
        (lambda p: {"machine": dataclasses.replace(p.machine, axes=(
            dataclasses.replace(p.machine.axes[0], steps_per_unit=Fraction(1, 10**400)), *p.machine.axes[1:]))},
         "Machine.axes[0].steps_per_unit: 0 is closer to 0 than 1e-09"),
        (lambda p: {"stream": dataclasses.replace(p.stream, tick_frequency=10**13)},
         "StepStream.tick_frequency: 1e+13 is outside 1 to 1e+12"),
    ],
)  # fmt: skip
def test_a_package_with_such_a_number_is_refused_by_name(
    change: Any, said: str, package: Package, tmp_path: Path
) -> None:
    changed = dataclasses.replace(package, **change(package))
    members = parts_of(changed.machine, changed.setup, changed.trace, changed.stream)
    with pytest.raises(CertificateError) as caught:
        read_package(rebuilt(tmp_path / "a.gpx", members_of(Path(package.path)) | members))
    assert caught.value.finding.code.label == "GP820"
    assert said in caught.value.finding.message
