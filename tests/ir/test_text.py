"""Text forms print and parse back bit for bit: every stage, arbitrary contents."""

from __future__ import annotations

import math
import re
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gproof.ir import machine as m
from gproof.ir import plan, stream, trace, workpiece
from gproof.ir import program as p
from gproof.ir.columns import Columns, Schema
from gproof.ir.dialects import rules_named
from gproof.ir.dialects.eding.settings import EdingSettings
from gproof.ir.finding import Span
from gproof.ir.notes import NOTE, Notes
from gproof.ir.rules import BINARY, UNARY
from gproof.ir.setup import CylinderMap, Interval, Setup
from gproof.ir.text import WIDTH, NotKnown, parse_ir, print_ir
from gproof.ir.verdict import Condition, PropertyResult, Verdict

floats = st.floats(allow_nan=False)
names = st.text(max_size=8)
spans = st.builds(Span, names, st.integers(0, 10**9), st.integers(0, 300), st.integers(0, 300))


def tables(schema: Schema) -> st.SearchStrategy[Columns]:
    width = sum(np.dtype(c.dtype).itemsize * c.width for c in schema.columns)

    def build(rows: list[bytes]) -> Columns:
        arrays = {}
        raw = np.frombuffer(b"".join(rows), dtype=np.uint8).reshape(len(rows), width)
        at = 0
        for c in schema.columns:
            size = np.dtype(c.dtype).itemsize * c.width
            part = np.ascontiguousarray(raw[:, at : at + size]).view(c.dtype)
            part = part.reshape((len(rows), c.width) if c.width > 1 else (len(rows),))
            if c.dtype.startswith("f"):
                part = np.where(np.isnan(part), np.nan, part)
            arrays[c.name] = part
            at += size
        return Columns(schema, arrays)

    return st.lists(st.binary(min_size=width, max_size=width), max_size=4).map(build)


expressions = st.recursive(
    st.builds(p.Number, floats, spans) | st.builds(p.Text, names, spans) | st.builds(p.Constant, names, floats, spans),
    lambda inner: (
        st.builds(p.Variable, inner, spans, names)
        | st.builds(p.Unary, st.sampled_from(UNARY), inner, spans)
        | st.builds(p.Binary, st.sampled_from(BINARY), inner, inner, spans, st.booleans())
    ),
    max_leaves=6,
)
blocks = st.builds(
    p.Block,
    words=st.lists(st.builds(p.Word, st.sampled_from("GMXYZ@"), expressions, spans), max_size=3).map(tuple),
    assigns=st.lists(
        st.builds(p.Assign, st.builds(p.Variable, expressions, spans), expressions, spans), max_size=2
    ).map(tuple),
    span=spans, comment=names, deleted=st.booleans(), continued=names,
)  # fmt: skip
leaves = (
    blocks
    | st.builds(p.Call, name=names, span=spans, count=st.none() | expressions)
    | st.builds(p.Label, name=names, span=spans)
    | st.builds(p.Jump, name=names, span=spans)
    | st.builds(p.Return, span=spans, code=names)
    | st.builds(
        p.Declare, kind=names, names=st.lists(names, max_size=2).map(tuple), span=spans, type=names,
        value=st.none() | expressions,
    )
    | st.builds(p.Include, name=names, span=spans)
    | st.builds(p.Mode, name=names, span=spans)
    | st.builds(p.Message, kind=names, parts=st.lists(expressions, max_size=2).map(tuple), span=spans)
    | st.builds(p.Guard, name=names, on=st.booleans(), span=spans)
    | st.builds(p.Unsupported, what=names, span=spans)
    | st.builds(
        p.BlockTable, file=st.just(0), first_line=st.integers(1, 5), last_line=st.integers(5, 9), begin=st.just(0),
        end=st.integers(0, 9), words=tables(p.WORD) | st.none(),
    )
)  # fmt: skip
statements = st.recursive(
    leaves,
    lambda inner: (
        st.builds(
            p.If, condition=expressions, then=st.lists(inner, max_size=2).map(tuple),
            otherwise=st.lists(inner, max_size=2).map(tuple), span=spans,
        )
        | st.builds(p.While, condition=expressions, body=st.lists(inner, max_size=2).map(tuple), span=spans)
        | st.builds(p.Repeat, condition=expressions, body=st.lists(inner, max_size=2).map(tuple), span=spans)
        | st.builds(
            p.For, variable=st.builds(p.Variable, expressions, spans, names), first=expressions, last=expressions,
            down=st.booleans(), body=st.lists(inner, max_size=2).map(tuple), span=spans, end_span=st.none() | spans,
        )
    ),
    max_leaves=5,
)  # fmt: skip
bodies = st.lists(statements, max_size=3).map(tuple)
programs = st.builds(
    p.Program, dialect=st.just("eding"), rules=st.just(rules_named("eding")),
    files=st.lists(st.builds(p.SourceFile, name=names, sha256=names), max_size=2), body=bodies,
    subprograms=st.dictionaries(
        names,
        st.builds(
            p.Subprogram, name=names, body=bodies, span=spans, is_module=st.booleans(), text=names,
            parameters=st.lists(st.tuples(names, names, st.integers()), max_size=2).map(tuple),
        ),
        max_size=2,
    ),
    line_count=st.integers(0, 10**8),
)  # fmt: skip

optional = st.none() | floats
axes = st.builds(
    m.Axis, name=st.sampled_from(m.AXIS_NAMES), kind=st.sampled_from(m.AxisKind),
    steps_per_unit=st.none() | st.fractions(), lower=optional, upper=optional, travel_lower=optional,
    travel_upper=optional, max_velocity=optional, max_acceleration=optional, backlash=floats,
    slaves=st.lists(
        st.builds(m.Slave, joint=names, lower=optional, steps_per_unit=st.none() | st.fractions()), max_size=2
    ).map(tuple),
    pitch=st.none() | st.builds(m.PitchTable, machine=st.tuples(floats), calibrated=st.tuples(floats)),
)  # fmt: skip
pairs = st.tuples(floats, floats)
areas = st.builds(m.Area, name=names, box=st.tuples(pairs, pairs, pairs))
tools = st.builds(
    m.Tool, number=st.integers(0, 99), length=optional, x_offset=optional, diameter=optional,
    orientation=st.none() | st.integers(1, 9),
)  # fmt: skip
machines = st.builds(
    m.Machine, name=names, axes=st.lists(axes, max_size=3).map(tuple), tool_change_area=st.none() | areas,
    keep_out=st.lists(areas, max_size=1).map(tuple), tools=st.lists(tools, max_size=2).map(tuple),
    controller=st.builds(m.Controller, dialect=st.none() | names, laf_angle=optional), unit=floats,
    board=st.builds(m.Board, name=names, tick_frequency=st.integers(1, 10**9)),
    not_modelled=st.lists(st.builds(m.Unmodelled, names, names, names, names, st.integers()), max_size=2).map(tuple),
    unknown_keys=st.lists(st.tuples(names, names), max_size=2).map(tuple),
)  # fmt: skip
intervals = st.builds(Interval, floats, floats)
places = st.tuples(floats, floats)
bodies = st.one_of(
    st.builds(workpiece.Box, low=st.tuples(floats, floats, floats), high=st.tuples(floats, floats, floats)),
    st.builds(workpiece.Cylinder, x=floats, y=floats, radius=floats, low=floats, high=floats),
    st.builds(
        workpiece.Prism, outline=st.lists(places, max_size=3).map(tuple), low=floats, high=floats, error=floats,
        holes=st.lists(st.lists(places, max_size=2).map(tuple), max_size=2).map(tuple),
    ),
    st.builds(workpiece.Mesh, triangles=tables(workpiece.TRIANGLES), source=names, closed=st.booleans()),
)  # fmt: skip
placed = st.lists(st.builds(workpiece.Placed, name=names, body=bodies, work=st.integers(-1, 9)), max_size=2).map(tuple)
workpieces = st.builds(workpiece.Workpiece, stock=placed, part=placed, fixtures=placed, tolerance=floats, cell=floats)
setups = st.builds(
    Setup, name=names, homed=st.none() | st.lists(names, max_size=2).map(tuple),
    start=st.dictionaries(names, intervals, max_size=2),
    work=st.dictionaries(st.tuples(st.integers(1, 9), names), intervals, max_size=2),
    g92=st.dictionaries(names, intervals, max_size=1),
    tool_lengths=st.dictionaries(st.integers(), intervals, max_size=1),
    parameters=st.dictionaries(st.integers(), floats, max_size=2), tool=st.none() | st.integers(),
    default_offset=optional, block_delete=st.none() | st.booleans(),
    cylinder=st.none() | st.builds(CylinderMap, radius=optional, y=optional), workpiece=st.none() | workpieces,
)  # fmt: skip

affine = st.lists(st.tuples(names, st.integers()), max_size=2).map(tuple)
states = st.builds(
    trace.State, tool=st.integers(), spindle=floats, path_mode=st.sampled_from(trace.PathMode),
    laf_angle=floats, guards_off=st.lists(names, max_size=2).map(tuple),
    tip=st.lists(st.builds(trace.TipOffset, st.integers(0, 5), floats, affine), max_size=2).map(tuple),
)  # fmt: skip
edges = st.builds(
    trace.Edge, wait=st.sampled_from(trace.Wait), outcome=names, target=st.integers(-1, 3), line=st.integers()
)
sections = st.builds(
    trace.TraceSection, number=st.integers(0, 3), start=st.tuples(*[floats] * 6), start_frame=st.integers(),
    rows=tables(trace.TRACE_ROW), edges=st.lists(edges, max_size=2).map(tuple),
)  # fmt: skip
traces = st.builds(
    trace.Trace, files=st.lists(names, max_size=2), calls=st.lists(names, max_size=2),
    frames=st.lists(st.tuples(*[affine] * 6), max_size=2), states=st.lists(states, max_size=2),
    texts=st.lists(names, max_size=2), sections=st.lists(sections, max_size=2),
)  # fmt: skip
plans = st.builds(
    plan.Plan,
    sections=st.lists(
        st.builds(plan.PlanSection, number=st.integers(), rows=tables(plan.PLAN_ROW), duration=floats), max_size=2
    ),
)
streams = st.builds(
    stream.StepStream, tick_frequency=st.integers(1, 10**9),
    motors=st.lists(
        st.builds(stream.Motor, name=names, axis=st.integers(0, 5), steps_per_unit=st.fractions()), max_size=2
    ).map(tuple),
    sections=st.lists(
        st.builds(
            stream.StreamSection, number=st.integers(), start=st.lists(st.integers(), max_size=2).map(tuple),
            runs=st.lists(tables(stream.RUN), max_size=2).map(tuple), events=tables(stream.EVENT),
            duration=st.integers(),
        ), max_size=2,
    ),
)  # fmt: skip
results = st.builds(
    PropertyResult, name=names, verdict=st.sampled_from(Verdict), assumptions=st.lists(names, max_size=2).map(tuple),
    conditions=st.lists(st.builds(Condition, terms=affine, low=floats, high=floats), max_size=2).map(tuple),
)  # fmt: skip


@given(programs | machines | setups | traces | plans | streams | results)
def test_parse_of_print_is_the_same_value(value: object) -> None:
    text = print_ir(value)
    again = parse_ir(text)
    assert again == value
    assert print_ir(again) == text


@given(floats)
def test_floats_keep_every_bit(value: float) -> None:
    again = parse_ir(print_ir(value))
    assert math.copysign(1.0, again) == math.copysign(1.0, value)
    assert again == value


@given(st.text(alphabet='()[]{}" ;abN0.1-/e\\\n', max_size=40))
def test_broken_text_is_a_value_error(text: str) -> None:
    try:
        parse_ir(text)
    except ValueError as error:
        assert str(error)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('(Span file: "a" line: 1 column: 2 end_column: 3 more: 4)', "Span.more: no such field"),
        ('(Spam file: "a")', "Spam: no such type"), ("(Edge wait: Wait.LUNCH)", "Wait.LUNCH: no such value"),
        ("Weight.END", "Weight.END: no such value"), ("(columns nothing 0)", "nothing: no such table"),
    ],
)  # fmt: skip
def test_names_that_are_none_here_are_those_of_another_version(text: str, said: str) -> None:
    with pytest.raises(NotKnown, match=re.escape(said)):
        parse_ir(text)


@pytest.mark.parametrize(
    "text",
    ['(Span "a" 1 2 3)', '(Span file: "a" "b" line: 1)', '(Span file: "a" file: "b" line: 1)', "(Span line: 1)",
     "(Span file:", "(Span file:)", '(Span file: "a" line: 1', '(Span File: "a" line: 1)', "(LanguageRules)",
     '(LanguageRules name: "eding")', '{"a" 1 "a" 2}', '{"a"}', '(Span file: "a" line: 1) 2'],
)  # fmt: skip
def test_fields_that_are_not_as_they_are_printed(text: str) -> None:
    with pytest.raises(ValueError, match=r".") as caught:
        parse_ir(text)
    assert type(caught.value) is ValueError


def test_what_has_its_default_is_left_out() -> None:
    assert print_ir(trace.State()) == "(State)\n"
    assert print_ir(trace.State(tool=3)) == "(State tool: 3)\n"
    assert print_ir(m.Board(step_pulse=1e-6)) == "(Board step_pulse: 1e-06)\n"


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (m.Axis(name="x", kind=m.AxisKind.LINEAR, backlash=0), "backlash: 0"),
        (m.Axis(name="x", kind=m.AxisKind.LINEAR, backlash=-0.0), "backlash: -0.0"),
        (m.Axis(name="x", kind=m.AxisKind.LINEAR, tip_feed=0), "tip_feed: 0"),  # type: ignore[arg-type]
        (m.Axis(name="x", kind=m.AxisKind.LINEAR, slaves=(m.Slave(),)), "slaves: [(Slave)]"),
        (m.Machine(name="", axes=(), settings=EdingSettings()), "settings: (EdingSettings)"),
        (m.Machine(name="", axes=(), controller=m.Controller(fifo_time=1)), "controller: (Controller fifo_time: 1)"),
        (trace.Trace(calls=[]), "calls: []"),
    ],
)  # fmt: skip
def test_what_is_only_like_the_default_is_printed(value: object, text: str) -> None:
    printed = print_ir(value)
    assert text in printed
    assert print_ir(parse_ir(printed)) == printed


def test_numbers_of_numpy_are_printed_as_they_are_read() -> None:
    for value in (np.float64(0.0), np.float64(2.5)):
        printed = print_ir(m.Axis(name="x", kind=m.AxisKind.LINEAR, backlash=value))
        assert printed == print_ir(m.Axis(name="x", kind=m.AxisKind.LINEAR, backlash=float(value)))


def test_lines_are_no_longer_than_they_have_to_be() -> None:
    names = [f"{'n' * k}" for k in range(1, 130)]
    for line in print_ir(tuple((tuple(names[:k]),) for k in range(16))).splitlines():
        assert len(line) <= WIDTH or line.strip().startswith('"')
    for name in names:
        assert max(map(len, print_ir(m.Board(name=name)).splitlines())) <= max(WIDTH, len(name) + 10)


def test_rationals_are_exact() -> None:
    assert parse_ir("1600/3") == Fraction(1600, 3)


def test_bytes_come_back_whatever_they_are() -> None:
    for data in (b"", b'b"x"', b"\xe4\xc3\xa4\\ \"'\t\x81", bytes(range(256))):
        assert parse_ir(print_ir(data)) == data
        assert parse_ir(print_ir(Notes(Columns(NOTE), data))) == Notes(Columns(NOTE), data)
