"""The setup at hand is that of the package in every field that the types have, or a rule says why it need not be."""

import dataclasses
import math
import re
import types
import typing
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from corpus.jobs import job_of
from support.each import each
from verify.jobs import JOBS
from verify.reference_stepper import machine

from gproof.driver.session import open_session
from gproof.ir.columns import Columns
from gproof.ir.machine import Area, Machine, Spindle, Tool
from gproof.ir.record import record
from gproof.ir.setup import NOTHING, ZERO, HeightMap, InForce, Interval, Setup, StoredPosition
from gproof.ir.text import parse_ir, print_ir
from gproof.ir.trace import Op, State, Trace
from gproof.ir.workpiece import TRIANGLES, Box, Placed, Workpiece
from gproof.verify.certificate.setup_at_hand import RULES, How, differences, how_compared, same

MACHINE = machine()
LABELS = {"Setup.name", "HeightMap.name", "Area.name", "Placed.name", "Mesh.source"}
"""Fields that no answer rests on: docs/reach.md says of each ``-`` or that it is the name in a finding."""


def trace() -> Trace:
    return JOBS["events"]().trace()


def told(then: Setup, now: Setup, on: Machine = MACHINE, job: Trace | None = None) -> list[str]:
    found = differences(then, now, on, trace() if job is None else job)
    assert all(isinstance(message, str) and len(message) < 400 and "Interval(" not in message for message in found)
    return found


# --- values made from the types ---------------------------------------------------------------------------------


def value_of(hint: Any, kind: int) -> Any:
    """A value of a type; another one for each kind."""
    origin, arguments = typing.get_origin(hint), typing.get_args(hint)
    if origin in (types.UnionType, typing.Union):
        return value_of(next(a for a in arguments if a is not type(None)), kind)
    if origin is dict:
        return {value_of(arguments[0], 0): value_of(arguments[1], kind)}
    if origin is tuple:
        if arguments[-1] is Ellipsis:
            return (value_of(arguments[0], kind),)
        return tuple(value_of(a, kind) for a in arguments)
    if hint is Interval:
        return Interval(3.0 + kind, 3.0 + kind)
    if hint is Columns:
        return Columns(TRIANGLES, {c.name: np.full((1, 3), 1.0 + kind) for c in TRIANGLES.columns})
    if hint is bool:
        return bool(kind)
    if hint in (int, float):
        return hint(1 + kind)
    if hint is str:
        # Keys of tables are axes and stored places, and so are values that name axes.
        return ("x", "z")[kind]
    assert dataclasses.is_dataclass(hint), f"no value is known of {hint}"
    return made(hint, kind)


def made(cls: Any, kind: int = 0) -> Any:
    hints = typing.get_type_hints(cls)
    return cls(**{f.name: value_of(hints[f.name], kind) for f in dataclasses.fields(cls)})


AXES = tuple(axis.name for axis in MACHINE.axes)
FULL = dataclasses.replace(made(Setup), homed=AXES)


def changes(value: Any, hint: Any, path: str) -> Iterator[tuple[str, Any]]:
    """(field by type and name, value with one part of it changed), for every part that there is."""
    origin, arguments = typing.get_origin(hint), typing.get_args(hint)
    if origin in (types.UnionType, typing.Union):
        known = [a for a in arguments if a is not type(None)]
        if len(known) < len(arguments):
            yield path, None
        if any(dataclasses.is_dataclass(a) for a in known):
            for other in known[1:]:
                yield path, made(other)
            yield from changes(value, type(value), path)
            return
        hint, origin, arguments = known[0], typing.get_origin(known[0]), typing.get_args(known[0])
    if dataclasses.is_dataclass(value) and not isinstance(value, Interval):
        hints = typing.get_type_hints(type(value))
        for field in dataclasses.fields(value):
            inner = f"{type(value).__name__}.{field.name}"
            for name, changed in changes(getattr(value, field.name), hints[field.name], inner):
                yield name, dataclasses.replace(value, **{field.name: changed})
        return
    if origin is dict:
        ((key, inner),) = value.items()
        more = next(k for k in (value_of(arguments[0], 1),) if k != key)
        yield path, {}
        yield path, {**value, more: inner}
        for name, changed in changes(inner, arguments[1], path):
            yield name, {key: changed}
        return
    if origin is tuple:
        if arguments[-1] is Ellipsis:
            if how_compared(*_place(path)) is not How.FEWER:
                yield path, ()
            if path != "Setup.homed":  # what the machine has no axis of is none
                yield path, (*value, value_of(arguments[0], 1))
        for at, inner in enumerate(value):
            hint = arguments[0] if arguments[-1] is Ellipsis else arguments[at]
            for name, changed in changes(inner, hint, path):
                yield name, (*value[:at], changed, *value[at + 1 :])
        return
    if isinstance(value, Interval):
        for other in (Interval(5.0, 5.0), Interval(value.low, value.high + 0.01), Interval(math.nan, math.nan)):
            yield path, other
        yield path, Interval(-math.inf, math.inf)
        return
    yield path, next(other for other in (value_of(hint, 1), value_of(hint, 0)) if other != value)
    if hint is float:
        yield path, math.nan
        yield path, value + 1e-9


class _Named:
    def __init__(self, name: str) -> None:
        self.__name__ = name


def _place(path: str) -> tuple[Any, str]:
    kind, _, name = path.partition(".")
    return _Named(kind), name


EACH = list(changes(FULL, Setup, "Setup"))


def test_every_field_of_every_type_is_changed() -> None:
    def fields_of(cls: Any) -> set[str]:
        found = set()
        for hint in typing.get_type_hints(cls).values():
            pending = [hint]
            while pending:
                one = pending.pop()
                pending += typing.get_args(one)
                if isinstance(one, type) and dataclasses.is_dataclass(one) and one is not Interval:
                    found |= fields_of(one)
        return found | {f"{cls.__name__}.{f.name}" for f in dataclasses.fields(cls)}

    bodies = {"Cylinder", "Prism", "Mesh"}  # of a union: see the test below
    named = {name for name, _ in EACH}
    assert {name for name in fields_of(Setup) if name.split(".")[0] not in bodies} <= named
    assert len(EACH) > 100
    assert not told(FULL, FULL)


@each("field,now", EACH, ids=lambda value: value if isinstance(value, str) else "")
def test_a_changed_value_is_refused(field: str, now: Setup) -> None:
    assert bool(told(FULL, now)) == (field not in LABELS), (field, now)


@pytest.mark.parametrize("body", [*typing.get_args(typing.get_type_hints(Placed)["body"])])
def test_so_is_one_of_any_body(body: Any) -> None:
    for field, other in changes(made(body), body, body.__name__):
        assert same(made(body), other) == (field in LABELS), (field, other)


@each("field", dataclasses.fields(Setup), ids=lambda f: str(f.name))
def test_what_was_left_open_and_is_stated_now_is_refused(field: Any) -> None:
    """And the other way round."""
    default = field.default if field.default is not dataclasses.MISSING else field.default_factory()
    then = dataclasses.replace(FULL, **{field.name: default})
    refused = field.name not in ("name", "homed", "block_delete")
    if field.name != "optional_stop":  # on, which is what an open one stood for
        assert bool(told(then, FULL)) == refused
    refused = field.name not in ("name", "keep_out")
    assert bool(told(FULL, then)) == refused


def test_a_field_that_is_new_is_compared_by_itself() -> None:
    @record(frozen=True, slots=True, kw_only=True)
    class Tomorrow(Setup):
        coolant: float | None = None
        clamps: tuple[Interval, ...] = ()
        pallets: dict[int, str] = dataclasses.field(default_factory=dict)

    then = Tomorrow()
    assert not told(then, Tomorrow())
    for now in (Tomorrow(coolant=1.0), Tomorrow(clamps=(Interval(1.0, 2.0),)), Tomorrow(pallets={1: "a"})):
        assert told(then, now), now
        assert told(now, then), now
        assert not told(now, now)
    assert told(then, NOTHING)


def test_a_kind_of_value_that_is_not_known_is_different() -> None:
    assert not same({1, 2}, {1, 2})
    assert not same(1.0, True)
    assert not same(math.nan, math.nan)
    assert not same((1.0,), [1.0])
    assert same((1, 2.0), (1.0, 2))


def test_each_rule_names_a_field_and_its_reason() -> None:
    assert {name for name, rule in RULES.items() if rule.how is How.LABEL} == LABELS
    kinds = {cls.__name__: cls for cls in (Setup, HeightMap, Area, Placed, Workpiece)}
    for name, rule in RULES.items():
        kind, field = name.split(".")
        assert rule.why
        if kind in kinds:
            assert field in {f.name for f in dataclasses.fields(kinds[kind])}


# --- what a default or an assumption stood for -----------------------------------------------------------------

BASE = Setup(homed=AXES, tool=1, active_work=1, start={a: Interval(0.0, 0.0) for a in "xyz"})


def on(setup: Setup, **values: Any) -> Setup:
    return dataclasses.replace(setup, **values)


def at(value: float) -> Interval:
    return Interval(value, value)


def test_a_length_that_the_tool_table_has() -> None:
    """60.8 mm beside the tool table's 38.2: the path would be 60.8 mm off."""
    listed = dataclasses.replace(MACHINE, tools=(Tool(number=3, length=38.2),))
    for then in (BASE, ZERO):
        assert told(then, on(then, tool_lengths={3: at(99.0)}), listed)
    assert told(BASE, on(BASE, tool_lengths={3: Interval(38.2, 38.3)}), listed)
    assert not told(BASE, on(BASE, tool_lengths={3: at(38.2)}), listed)
    assert not told(on(BASE, tool_lengths={3: at(38.2)}), BASE, listed)
    # A variable may have come before the table, and the setup "zero" says 0 where the table says 38.2.
    with_variable = on(BASE, parameters={5403: 5.0})
    assert told(with_variable, on(with_variable, tool_lengths={3: at(38.2)}), listed)
    for value in (0.0, 38.2):
        assert told(ZERO, on(ZERO, tool_lengths={3: at(value)}), listed)


def using(work: int = 1, tool: int = 1, rows_tool: float | None = None) -> Trace:
    job = trace()
    job.states = [dataclasses.replace(state, work=work, tool=tool) for state in job.states]
    for section in job.sections:
        rows = section.rows
        rows["op"][-1] = Op.TOOL_OFFSET
        offsets = (rows["op"] == Op.TOOL_CHANGE) | (rows["op"] == Op.TOOL_OFFSET)
        rows["arg"][offsets, 0] = tool if rows_tool is None else rows_tool
        rows["arg"][rows["op"] == Op.OFFSET, 0] = work
    return job


def test_offsets_and_lengths_that_no_row_names_may_be_stated_now() -> None:
    job = using()
    assert not told(BASE, on(BASE, work={(3, "x"): at(12.0)}), job=job)
    assert told(BASE, on(BASE, work={(1, "x"): at(12.0)}), job=job)
    assert told(BASE, on(BASE, work={(3, "x"): at(12.0)}), job=using(work=3))
    assert told(BASE, on(BASE, work={(3, "x"): at(12.0)}), job=using(work=0)), "the active one may be any"
    zone = Area(name="clamp", box=((0.0, 1.0), (0.0, 1.0), (0.0, 1.0)), work=3)
    assert told(on(BASE, keep_out=(zone,)), on(BASE, keep_out=(zone,), work={(3, "x"): at(12.0)}), job=job)
    body = Workpiece(fixtures=(Placed(name="vise", body=Box(low=(0, 0, 0), high=(1, 1, 1)), work=3),))
    assert told(on(BASE, workpiece=body), on(BASE, workpiece=body, work={(3, "x"): at(12.0)}), job=job)
    assert told(on(BASE, work={(3, "x"): at(12.0)}), BASE, job=job), "what was stated has to be stated"
    assert not told(BASE, on(BASE, tool_lengths={4: at(50.0)}), job=job)
    assert told(BASE, on(BASE, tool_lengths={4: at(50.0)}), job=using(tool=4))
    assert told(BASE, on(BASE, tool_lengths={4: at(50.0)}), job=using(tool=-1))
    assert told(BASE, on(BASE, tool_lengths={4: at(50.0)}), job=using(rows_tool=math.nan))
    assert told(BASE, on(BASE, tool_lengths={1: at(50.0)}), job=job)
    assert told(on(BASE, tool=None), on(BASE, tool=None, tool_lengths={4: at(50.0)}), job=job)
    assert told(BASE, on(BASE, tool_lengths={0: at(0.0)}), job=job)
    assert told(ZERO, on(ZERO, work={(3, "x"): at(12.0)}), job=job), "taken as 0 then"
    assert not told(ZERO, on(ZERO, work={(3, "x"): at(0.0)}), job=job)
    listed = dataclasses.replace(MACHINE, tools=(Tool(number=4, length=38.2),))
    assert told(BASE, on(BASE, tool_lengths={4: at(50.0)}), listed, job)
    job.frames = [*job.frames, ((("work.3.x", 1),), (), (), (), (), ())]
    assert told(BASE, on(BASE, work={(3, "x"): at(12.0)}), job=job)


def test_a_head_that_the_machine_file_has() -> None:
    """The offset of a spindle counts where the setup has none; with an open sign nothing does."""
    head = dataclasses.replace(MACHINE, spindles=(Spindle(number=1, offset=(50.0, None, 0.0)),))
    assert not told(BASE, on(BASE, heads={(1, "x"): at(50.0)}), head)
    assert told(BASE, on(BASE, heads={(1, "x"): at(-50.0)}), head)
    assert told(BASE, on(BASE, heads={(1, "y"): at(0.0)}), head)
    assert not told(ZERO, on(ZERO, heads={(1, "y"): at(0.0)}), head)
    open_ = dataclasses.replace(MACHINE, spindles=(Spindle(number=1, offset=(50.0, None, 0.0), unsigned=True),))
    for then in (BASE, ZERO):
        for value in (50.0, -50.0, 0.0):
            assert told(then, on(then, heads={(1, "x"): at(value)}), open_)


def test_a_variable_that_was_not_listed_stood_for_what_the_controller_has() -> None:
    """#5401 is the length of tool 1: not listed it is the tool table's, whatever the other variables are taken for."""
    assert told(ZERO, on(ZERO, parameters={5401: 0.0}))
    assert told(on(BASE, parameters={100: 1.0}), on(BASE, parameters={}, parameter_ranges={100: at(1.0)}))


@pytest.mark.parametrize(
    ("then", "now", "refused"),
    [
        (None, InForce(angle=0.0), False),
        (None, InForce(angle=0.0, x=5.0), False),
        (None, InForce(angle=1.25), True),
        (None, InForce(factor_x=2.0, factor_y=2.0), True),
        (InForce(angle=1.25), InForce(angle=1.25, factor_x=1.0, factor_y=1.0), False),
        (InForce(angle=1.25), InForce(angle=1.25, x=1.0), True),
        (InForce(angle=0.0), None, True),
        (InForce(angle=0.0), InForce(factor_x=1.0), True),
        (InForce(angle=0.0, x=1.0), InForce(angle=0.0), False),
        (None, InForce(angle=math.nan), True),
    ],
)
def test_a_rotation_that_is_in_force(then: InForce | None, now: InForce | None, refused: bool) -> None:
    assert bool(told(on(BASE, transform=then), on(BASE, transform=now))) == refused


@pytest.mark.parametrize(
    ("then", "now", "refused"),
    [
        ({}, {"block_delete": True}, True),
        ({}, {"block_delete": False}, False),
        ({"block_delete": False}, {}, True),
        ({}, {"optional_stop": False}, True),
        ({}, {"optional_stop": True}, False),
        ({"homed": None}, {"homed": AXES}, False),
        ({"homed": None}, {"homed": ("x", "y")}, True),
        ({"homed": None}, {"homed": ()}, True),
        ({"homed": AXES}, {"homed": None}, True),
        ({"homed": AXES}, {"homed": (*reversed(AXES), "w")}, False),
        ({"homed": ("x",)}, {"homed": AXES}, True),
    ],
)
def test_switches_and_homed_axes(then: dict[str, Any], now: dict[str, Any], refused: bool) -> None:
    assert bool(told(on(BASE, **then), on(BASE, **now))) == refused


def test_a_clamp_that_is_there_now() -> None:
    def zone(x: float, name: str = "clamp") -> Area:
        return Area(name=name, box=((x, x + 1.0), (0.0, 1.0), (0.0, 1.0)))

    def body(x: float, name: str = "vise") -> Placed:
        return Placed(name=name, body=Box(low=(x, 0, 0), high=(x + 1, 1, 1)))

    two = on(BASE, keep_out=(zone(0.0), zone(5.0)))
    assert told(BASE, two) == [
        "the job was checked without this keep-out zone of the setup at hand ('clamp')",
    ] * 2  # fmt: skip
    assert not told(two, BASE)
    assert not told(two, on(BASE, keep_out=(zone(5.0, "another name"),)))
    assert told(two, on(BASE, keep_out=(zone(5.1),)))
    held = on(BASE, workpiece=Workpiece(fixtures=(body(0.0), body(9.0))))
    assert not told(held, on(BASE, workpiece=Workpiece(fixtures=(body(9.0, "jaw"),))))
    assert told(held, on(BASE, workpiece=Workpiece(fixtures=(body(0.0), body(9.0), body(20.0))))) == [
        "made for another workpiece: fixtures differs now ('vise')"
    ]
    assert told(BASE, held) == ["made without stock, part and fixtures; now the setup has them"]
    assert told(held, BASE) == ["made for stock, part and fixtures; now the setup has none"]


def test_values_of_no_declared_type_are_refused_and_nothing_worse() -> None:
    strange: list[Any] = [None, 3, "x", [], {"x": 3.0}, {1: None}, (Interval(0, 1),), math.nan, object()]
    for field in dataclasses.fields(Setup):
        for value in strange:
            now = on(BASE, **{field.name: value})
            try:
                found = told(BASE, now)
            except (LookupError, ValueError, TypeError, AttributeError):
                continue  # check_package makes GP820 of it
            default = getattr(BASE, field.name)
            assert found or field.name == "name" or value == default or value is default, (field.name, value)


def test_places_and_channels_are_named() -> None:
    now = on(
        BASE, positions={"P4": StoredPosition(axes={"x": 1.0})}, inputs={6: 0.0}, answers={1: 1.0},
        contacts={"z": at(-3.0)}, measures={"z": at(-130.0)}, g92={"x": at(0.5)},
    )  # fmt: skip
    assert told(BASE, now) == [
        "made without G92 X offset; now it is 0.5",
        "made without the stored position P4; now it is another one",
        "made without input 6; now it is 0",
        "made without the answer to question 1; now it is 1",
        "made without the tool measure of Z; now it is -130",
        "made without the contact of Z; now it is -3",
    ]
    assert State().work == 1


def test_the_page_has_each_rule() -> None:
    page = (Path(__file__).parents[3] / "docs" / "certificate.md").read_text()
    table = page.partition("## The setup at hand")[2].partition("A value that the package's setup gives")[0]
    assert set(re.findall(r"`([A-Z]\w+\.\w+)`", table)) == set(RULES)


@pytest.mark.parametrize("name", ["eding/clamped-bracket", "eding/pcb-height-map", "eding/engraved-cylinder"])
def test_a_setup_is_itself_when_it_was_written_and_read(name: str) -> None:
    program, expected = job_of(name)
    files = [str(program.parent / expected[key]) for key in ("machine", "setup")]
    session = open_session(program, machine=Path(files[0]), setup=files[1], dialect="eding")
    for setup in (session.setup, FULL, ZERO, NOTHING):
        again = parse_ir(print_ir(setup))
        assert isinstance(again, Setup)
        assert differences(again, setup, session.machine, trace()) == []
        assert differences(setup, again, session.machine, trace()) == []
