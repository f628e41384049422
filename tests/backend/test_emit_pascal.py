"""rw_SymPas: what is printed is read again as the same tree, for generated expressions, statements and sections."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gproof.backend.emit.mcuwin.pascal import Printer, first_number, layout
from gproof.backend.emit.mcuwin.pascal_expressions import ExpressionPrinter, Style
from gproof.frontend.mcuwin.pascal import Place, Simple, Symbols, parse_dollar, parse_expression, parse_section
from gproof.ir import program as p
from gproof.ir.finding import Findings, Severity, Span

HERE = Span("", 0)
DECLARED = """var alpha, beta: integer; gamma, delta: double; flag, ready: boolean;
const Count = 5; Scale = 1.5; Dark = true; Low = -0.5; Title = "a title";
label again, 10;
procedure bore(depth: double; var n: integer; fast: boolean); begin end;
procedure stop; begin end;"""


def bare(node: Any, lines: bool = False) -> Any:
    """A tree with every span the same, or of its line alone."""
    if isinstance(node, Span):
        return Span("", node.line) if lines else HERE
    if isinstance(node, tuple):
        return tuple(bare(one, lines) for one in node)
    if dataclasses.is_dataclass(node):
        return dataclasses.replace(
            node, **{f.name: bare(getattr(node, f.name), lines) for f in dataclasses.fields(node)}
        )
    return node


def symbols(**settings: Any) -> Symbols:
    found = Symbols(Findings(), axes="XYZC", **settings)
    parse_section(DECLARED.splitlines(), Place("job", 1), found)
    assert found.findings.kept == []
    return found


def complaints(names: Symbols) -> list[str]:
    """Errors and unknowns that reading gave."""
    judged = (Severity.ERROR, Severity.UNKNOWN)
    return [
        f"{f.code.label} {f.message}"
        for f in names.findings.kept
        if f.severity in judged and "a minus before" not in f.message
    ]


def number(value: float, point: bool) -> p.Number:
    return p.Number(value, HERE, point)


def variable(value: int, name: str = "") -> p.Variable:
    return p.Variable(number(float(value), False), HERE, name)


def unary(operator: str, operand: Any) -> Any:
    return st.builds(p.Unary, st.just(operator), operand, st.just(HERE))


def binary(operators: str, left: Any, right: Any) -> Any:
    return st.builds(p.Binary, st.sampled_from(operators.split()), left, right, st.just(HERE))


decimals = st.decimals(-1000, 1000, places=4).map(float)
whole = (
    st.builds(number, st.integers(-(2**31) + 1, 2**31 - 1).map(float), st.just(False))
    | st.sampled_from((variable(1600), variable(1699), variable(2000, "alpha"), variable(2001, "beta")))
    | st.just(p.Constant("Count", 5.0, HERE))
)
real = (
    st.builds(number, decimals, st.just(True))
    | st.just(number(-0.0, True))
    | st.sampled_from((variable(600), variable(2002, "gamma"), p.Named("X.TP", HERE), p.Named("C.RP", HERE)))
    | st.sampled_from((p.Constant("Scale", 1.5, HERE), p.Constant("Low", -0.5, HERE), p.Constant("pi", math.pi, HERE)))
)  # fmt: skip
truth = st.sampled_from(
    (
        variable(2004, "flag"), p.Constant("true", 1.0, HERE), p.Constant("Dark", 1.0, HERE),
        p.Input("input", number(405.0, False), HERE),
    )
)  # fmt: skip
INTEGERS = st.deferred(
    lambda: (
        whole
        | st.one_of(*(unary(name, INTEGERS) for name in ("neg", "pos", "abs", "sqr", "bnot")))
        | st.one_of(*(unary(name, DOUBLES) for name in ("nearest", "trunc")))
        | binary("+ - * div rem << shr band bor bxor", INTEGERS, INTEGERS)
        | unary("neg", st.builds(lambda node: dataclasses.replace(node, doubtful=True), shifted))
    )
)
shifted = binary("shr band", whole.filter(lambda node: not isinstance(node, p.Number)), whole)
DOUBLES = st.deferred(
    lambda: (
        real
        | st.one_of(*(unary(name, DOUBLES) for name in ("neg", "sqrt", "rsin", "ratan", "racos", "int", "frac", "ln")))
        | unary("exp", INTEGERS)
        | binary("+ - * /", DOUBLES, DOUBLES | INTEGERS)
        | binary("+ - * /", INTEGERS, DOUBLES)
        | binary("/", INTEGERS, INTEGERS)
    )
)
BOOLEANS = st.deferred(
    lambda: (
        truth
        | unary("not", BOOLEANS)
        | unary("odd", INTEGERS)
        | unary("bool", INTEGERS | DOUBLES | BOOLEANS)
        | binary("and or xor == <>", BOOLEANS, BOOLEANS)
        | binary("< <= > >= == <>", INTEGERS | DOUBLES, INTEGERS | DOUBLES)
    )
)


expressions = st.one_of(INTEGERS, DOUBLES, BOOLEANS)


@given(expressions)
def test_expressions_are_read_again(node: Any) -> None:
    names = symbols()
    text = ExpressionPrinter(Style("XYZC")).expression(node)
    again, _, end = parse_expression(text, 0, Place("job", 1), names)
    assert (bare(again), end) == (node, len(text)), text
    assert complaints(names) == []


factors = st.sampled_from(("alpha", "7", "2.5", "CI600", "X.tp", "(beta)", "round(gamma)", "not beta", "-3", "- alpha"))


operators = st.sampled_from("+ - * / div mod and or xor shl shr < =".split())


@st.composite
def written(draw: Any, depth: int = 2) -> str:
    """Text of operands, signs, operators and brackets, needed or not."""
    words = [draw(st.sampled_from(("", "", "-", "+", "- ")))]
    for _ in range(draw(st.integers(1, 4))):
        operand = draw(factors) if not depth or draw(st.booleans()) else f"({draw(written(depth - 1))})"
        words += [operand, f" {draw(operators)} "]
    return "".join([*words, draw(factors)])


@given(written())
def test_every_text_that_is_read_is_printed_as_itself(text: str) -> None:
    """Signs, doubtful groupings and needless brackets of every kind, whatever the types."""
    names = symbols()
    try:
        node, _, end = parse_expression(text, 0, Place("job", 1), names)
    except Exception as error:
        assert type(error).__name__ == "PascalError"
        return
    printed = Printer().expression(node)
    again, _, _ = parse_expression(printed, 0, Place("job", 1), names)
    assert bare(again) == bare(node), (text[:end], printed)
    assert len(printed.replace(" ", "")) <= len(text[:end].replace(" ", "")) + printed.count("(") * 2


assigns = st.builds(
    lambda pair: p.Block(words=(), assigns=(p.Assign(*pair, HERE),), span=HERE),
    st.tuples(st.sampled_from((variable(1650), variable(2001, "beta"))), INTEGERS)
    | st.tuples(st.sampled_from((variable(650), variable(2003, "delta"))), DOUBLES | INTEGERS)
    | st.tuples(st.just(variable(2005, "ready")), BOOLEANS),
)
texts = st.text(st.characters(codec="utf-8", exclude_categories=("C", "Zl", "Zp")), max_size=8).map(
    lambda s: p.Text(s, HERE)
)
calls = st.builds(
    lambda depth, n, fast: p.Call(
        name="bore", span=HERE, text="bore",
        arguments=(p.Word("depth", depth, HERE), p.Word("n", n, HERE), p.Word("fast", fast, HERE)),
    ),
    DOUBLES | INTEGERS, st.sampled_from((variable(2000, "alpha"), variable(1600))), BOOLEANS,
)  # fmt: skip
simple = (
    assigns
    | calls
    | st.just(p.Call(name="stop", span=HERE, text="stop"))
    | st.builds(p.Jump, name=st.sampled_from(("again", "10")), span=st.just(HERE))
    | st.builds(p.Device, name=st.just("wait"), arguments=st.tuples(INTEGERS | DOUBLES), span=st.just(HERE))
    | st.builds(
        p.Message, kind=st.sampled_from(("write", "writeln")),
        parts=st.lists(expressions | texts, max_size=4).map(tuple), span=st.just(HERE),
    )
    | st.builds(
        lambda text: p.Unsupported(what=f"the command {text.split('(')[0].strip()!r}", span=HERE, text=text),
        st.sampled_from(("halt", "ms(X, Y)", "sta (X, 10.5)")),
    )
)  # fmt: skip
labels = st.sampled_from(((), (), (p.Label(name="again", span=HERE),)))


def closes_else(body: tuple[Any, ...]) -> bool:
    """Whether an else behind this list, without begin and end, would belong to an if in it."""
    node = body[-1] if body else None
    if isinstance(node, p.If):
        return (not node.otherwise and node.else_span is None) or closes_else(node.otherwise)
    return isinstance(node, p.While | p.For) and closes_else(node.body)


@st.composite
def parts(draw: Any, depth: int) -> tuple[bool, tuple[Any, ...]]:
    """What stands in a statement: (it has begin and end, statements)."""
    if draw(st.booleans()):
        return True, draw(lists(depth))
    body = draw(lists(depth))[:1]
    return False, (*draw(labels), *body)


@st.composite
def statements(draw: Any, depth: int = 2) -> Any:
    """A statement with at most ``depth`` levels in it."""
    kind = draw(st.sampled_from(("simple", "simple", "if", "while", "repeat", "for"))) if depth else "simple"
    if kind == "simple":
        return draw(simple)
    if kind == "repeat":
        return p.Repeat(condition=draw(BOOLEANS), body=draw(lists(depth - 1)), span=HERE, end_span=HERE)
    closed, body = draw(parts(depth - 1))
    end = HERE if closed else None
    if kind == "while":
        return p.While(condition=draw(BOOLEANS), body=body, span=HERE, end_span=end)
    if kind == "for":
        first, last, down = draw(INTEGERS), draw(INTEGERS), draw(st.booleans())
        return p.For(variable=variable(1620), first=first, last=last, down=down, body=body, span=HERE, end_span=end)
    if draw(st.booleans()):
        return p.If(condition=draw(BOOLEANS), then=body, otherwise=(), span=HERE, end_span=end)
    other_closed, otherwise = draw(parts(depth - 1))
    closed = closed or other_closed or closes_else(body)
    return p.If(
        condition=draw(BOOLEANS), then=body, otherwise=otherwise, span=HERE, else_span=HERE,
        end_span=HERE if closed else None,
    )  # fmt: skip


@st.composite
def lists(draw: Any, depth: int) -> tuple[Any, ...]:
    """Statements one after the other."""
    return tuple(draw(statements(depth)) for _ in range(draw(st.integers(0, 3))))


bodies = lists(2)


@settings(max_examples=20)
@given(bodies)
def test_statements_are_read_again_on_one_line(body: tuple[Any, ...]) -> None:
    names = symbols()
    text = " ".join(piece.text for piece in Printer(Style("XYZC")).pieces(body))
    found = parse_dollar(text, 0, Place("job", 1), names)
    assert isinstance(found, Simple)
    assert bare(found.statements) == body, text
    assert complaints(names) == []


@settings(max_examples=20)
@given(bodies, bodies)
def test_sections_are_read_again(body: tuple[Any, ...], inner: tuple[Any, ...]) -> None:
    """With declarations, and a procedure before the statements."""
    names = symbols()
    local = p.Declare(kind="var", names=("k", "m"), span=Span("", 2), type="integer", number=2013)
    head = p.Declare(kind="var", names=("extra",), span=Span("", 0, 1), type="boolean", number=2009)
    sub = p.Subprogram(
        name="own", text="Own", body=(local, *inner), span=Span("", 0, 2), end_span=HERE,
        parameters=(("a", "double", 2010), ("b", "var integer", 2011), ("c", "var integer", 2012)),
    )  # fmt: skip
    label = p.Declare(kind="label", names=("Third", "0020"), span=Span("", 0, 3))
    ends = (p.Label(name="third", span=Span("", 0, 4)), p.Jump(name="20", span=Span("", 0, 5)))
    printer = Printer(Style("XYZC"))
    parts = (printer.pieces((head,)), printer.procedure(sub), printer.pieces((label, *ends, *body)))
    printed = [line for pieces in parts for line in layout(pieces)]
    assert [first_number(node) for node in (head, sub, label)] == [2009, 2010, None]
    found = parse_section(printed, Place("job", 1), names)
    jumps = {node.name for node in p.lost_jumps(inner)}
    assert bare(found.statements) == bare((head, label, *ends, *body)), printed
    if not jumps:
        wanted = dataclasses.replace(sub, parameters=found.subprograms[0].parameters)
        assert bare(found.subprograms) == (bare(wanted),), printed
        assert [(name, type_) for name, type_, _ in found.subprograms[0].parameters] == [
            (name, type_) for name, type_, _ in sub.parameters
        ]
        assert complaints(names) == []


@pytest.mark.parametrize(
    ("written", "printed"),
    [
        ("((CI600)) + (2*CI601)", "CI600 + 2 * CI601"),
        ("(CI600+2)*CI601", "(CI600 + 2) * CI601"),
        ("CI600-(2-CI601)", "CI600 - (2 - CI601)"),
        ("CI600-2-CI601", "CI600 - 2 - CI601"),
        ("-(CI600*2)", "-CI600 * 2"),
        ("(-CI600)*2", "(-CI600) * 2"),
        ("-(2*CI600)", "-(2 * CI600)"),
        ("-2*CI600", "-2 * CI600"),
        ("-CI600 shr 2", "-CI600 shr 2"),
        ("-(CI600 shr 2)", "-(CI600 shr 2)"),
        ("-(CI600 shl 2)", "-CI600 shl 2"),
        ("(-5) and CI600", "(-5) and CI600"),
        ("-5 and CI600", "-5 and CI600"),
        ("not (flag and (CI600 < 2))", "not (flag and (CI600 < 2))"),
        ("(CI600 < 2) = (flag)", "(CI600 < 2) = flag"),
        ("SIN(x.TP/10.0)", "sin(X.tp / 10.0)"),
        ("boolean(CI600)", "BOOLEAN(CI600)"),
    ],
)
def test_brackets_are_those_that_are_needed(written: str, printed: str) -> None:
    node, _, _ = parse_expression(written, 0, Place("job", 1), symbols())
    assert Printer().expression(node) == printed
