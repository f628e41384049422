"""A McuWIN Program printed without its source: what is read again is the same Program, for every file there is."""

from __future__ import annotations

import dataclasses
import random
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.bundles import unpacked
from support.campaigns import share
from support.goldens import ROOT
from support.mcuwin_lines import HEAD, random_line

from gproof.backend.emit.mcuwin.tree import text_of
from gproof.driver.dialects import load_machine
from gproof.frontend.mcuwin.load import load_program
from gproof.frontend.mcuwin.machine import NO_MCUWIN
from gproof.ir import codes
from gproof.ir import program as p
from gproof.ir.dialects import rules_named
from gproof.ir.dialects.mcuwin.settings import NO_MCUWIN_SETTINGS, mcuwin_settings
from gproof.ir.finding import Findings, Refusal, Severity, Span
from gproof.ir.machine import Machine

NOWHERE = Span("", 0)
JOBS = sorted(
    path
    for parent in (unpacked("tests/hand") / "mcuwin", ROOT / "corpus/mcuwin", unpacked("docs/codes"))
    for path in parent.rglob("*")
    if path.suffix.lower() in (".din", ".src", ".inc", ".pim")
)
SHOPS = sorted({path.parent for path in JOBS})


def machine_of(shop: Path) -> tuple[Machine, Path | None]:
    places = [folder / name for folder in (shop, shop.parent) for name in ("machine.toml", "McuWIN.ini")]
    path = next((path for path in places if path.is_file()), None)
    machine = NO_MCUWIN if path is None else load_machine(path, Findings())[0]
    assert machine is not None
    return machine, path


def stripped(value: Any, program: p.Program) -> Any:
    """A part of a Program without places: tables as blocks of words, no includes, no spans."""
    if isinstance(value, p.DeferredBlock):
        value = value.made()
    if isinstance(value, tuple):
        if any(isinstance(one, p.BlockTable | p.Include) for one in value):
            value = tuple(whole for one in value for whole in expanded(one, program))
        return tuple(stripped(one, program) for one in value)
    if isinstance(value, p.Block) and not value.words:
        value = dataclasses.replace(value, continued="")
    if not dataclasses.is_dataclass(value):
        return value
    return dataclasses.replace(
        value,
        **{
            f.name: NOWHERE if f.name.endswith("span") else stripped(getattr(value, f.name), program)
            for f in dataclasses.fields(value)
        },
    )


def expanded(node: p.Statement, program: p.Program) -> Sequence[p.Statement]:
    return () if isinstance(node, p.Include) else (node,)


def whole(program: p.Program) -> Any:
    """What a Program says: its body and subprograms, those without a name by their order."""
    subs = [stripped(sub, program) for sub in program.subprograms.values()]
    subs = [dataclasses.replace(sub, name="%") if sub.name.startswith("%") else sub for sub in subs]
    subs = [sub for sub in subs if sub.body or sub.name != "%"]
    return stripped(program.body, program), subs


def without_source(program: p.Program) -> p.Program:
    """As another part would have made it: no bytes, no notes, nothing that says where a statement came from."""
    return p.Program(
        dialect=program.dialect, rules=program.rules, body=stripped(program.body, program),
        subprograms={name: stripped(sub, program) for name, sub in program.subprograms.items()},
    )  # fmt: skip


def printed(program: p.Program, machine: Machine, *, includes: bool = False) -> bytes:
    axes = "".join(axis.word for axis in machine.axes)
    return b"".join(text_of(program, mcuwin_settings(machine), axes, includes=includes))


def opaque(program: p.Program) -> bool:
    """Whether it holds what nobody knows the text of."""
    bodies = [program.body, *(sub.body for sub in program.subprograms.values())]
    return any(isinstance(node, p.Unsupported) and not node.text for body in bodies for node in _walk(body))


def _walk(body: Sequence[p.Statement]) -> Any:
    for node in body:
        yield node
        for part in p.parts_of(node):
            yield from _walk(part)


def read_back(folder: Path, text: bytes, machine: Machine, machine_file: Path | None) -> p.Program:
    """The printed text holds what PreInclude and PostInclude put around the job."""
    alone = dataclasses.replace(mcuwin_settings(machine), pre_include="", post_include="")
    machine = dataclasses.replace(machine, settings=alone)
    path = folder / "again.din"
    path.write_bytes(text)
    findings = Findings()
    again = load_program(path, findings, machine, machine_file, tables=False)
    assert again is not None
    errors = [f for f in findings.kept if f.severity is Severity.ERROR and f.code is not codes.EMPTY_PROGRAM]
    assert errors == []
    return again


def settled(value: Any, field: str) -> Any:
    """With blocks that have nothing in a field."""
    if isinstance(value, tuple | list):
        return tuple(settled(one, field) for one in value)
    if isinstance(value, p.Block):
        return dataclasses.replace(value, **{field: ""})
    if not dataclasses.is_dataclass(value) or isinstance(value, Span):
        return value
    return dataclasses.replace(
        value, **{f.name: settled(getattr(value, f.name), field) for f in dataclasses.fields(value)}
    )


def agrees(folder: Path, program: p.Program, machine: Machine, machine_file: Path | None = None) -> bytes | None:
    """The text of a Program after it was read back; None where it holds what has no text."""
    try:
        text = printed(without_source(program), machine)
    except Refusal:
        assert opaque(program)
        return None
    try:
        again = read_back(folder, text, machine, machine_file)
        assert whole(again) == whole(program)
        assert printed(again, machine) == text
    except Exception:
        print(text.decode())
        raise
    return text


@pytest.mark.parametrize("shop", share(SHOPS, 4), ids=lambda path: "/".join(path.parts[-3:]))
def test_every_job_is_printed_from_its_statements(tmp_path: Path, shop: Path) -> None:
    machine, machine_file = machine_of(shop)
    for number, path in enumerate(path for path in JOBS if path.parent == shop):
        findings = Findings()
        program = load_program(path, findings, machine, machine_file, tables=False)
        if program is None or findings.has(Severity.ERROR):
            continue
        text = agrees(tmp_path, program, machine, machine_file)
        if text is not None and number % 3 == 0:
            tables = load_program(path, Findings(), machine, machine_file)
            assert tables is not None
            again = read_back(tmp_path, printed(tables, machine), machine, machine_file)
            assert settled(whole(again), "comment") == settled(whole(program), "comment"), path


SETTINGS: list[dict[str, Any]] = [{}, {"case_sensitive": False, "keeps_over_codes": True}, {"version": "2.5.3.32"}]


@pytest.mark.parametrize("seed", range(3))
def test_random_programs(tmp_path: Path, seed: int) -> None:
    random_programs(tmp_path, seed, 60)


@pytest.mark.soak
@pytest.mark.parametrize("seed", range(3, 12))
def test_many_random_programs(tmp_path: Path, seed: int) -> None:
    random_programs(tmp_path, seed, 2000)


def random_programs(folder: Path, seed: int, count: int) -> None:
    """Programs of lines that were found to be right alone."""
    rng = random.Random(seed)
    machine = with_settings(**SETTINGS[seed % len(SETTINGS)])
    (folder / "lib.inc").write_bytes(b"G90\n")
    good: list[str] = []
    same = 0
    for _ in range(count):
        lines = [random_line(rng), *rng.choices(good, k=min(len(good), rng.randint(0, 12)))]
        path = folder / "job.din"
        path.write_text(HEAD + "\n".join(lines) + "\nL7 M30\n%Sub\nM17\n")
        findings = Findings()
        program = load_program(path, findings, machine, tables=False)
        if program is None or findings.has(Severity.ERROR):
            continue
        good.append(lines[0])
        same += agrees(folder, program, machine) is not None
    assert same > count // 6


def with_settings(**din: Any) -> Machine:
    return dataclasses.replace(NO_MCUWIN, settings=dataclasses.replace(NO_MCUWIN_SETTINGS, **din))


# -- Programs that no McuWIN file made


def number(value: float) -> p.Number:
    return p.Number(value, NOWHERE, point=True)


def word(letter: str, value: p.Expr) -> p.Word:
    return p.Word(letter, value, NOWHERE)


def block(*words: p.Word, continued: str = "") -> p.Block:
    return p.Block(words=words, assigns=(), span=NOWHERE, continued=continued)


def job(*body: p.Statement, **more: Any) -> p.Program:
    return p.Program(dialect="mcuwin", rules=rules_named("mcuwin"), body=body, **more)


depth = p.Variable(p.Number(600.0, NOWHERE), NOWHERE)
leaves = st.decimals(-1000, 1000, places=3).map(lambda d: number(float(d))) | st.just(depth)
values = st.recursive(
    leaves,
    lambda inner: (
        st.builds(p.Binary, st.sampled_from("+-*/"), inner, inner, st.just(NOWHERE))
        | st.builds(p.Unary, st.sampled_from(("rsin", "sqrt", "abs")), inner, st.just(NOWHERE))
    ),
    max_leaves=4,
)
conditions = st.builds(p.Binary, st.sampled_from(("<", "<=", "==", "<>")), values, values, st.just(NOWHERE))
simple = st.one_of(
    st.builds(lambda x, y: block(word("G", p.Number(1.0, NOWHERE)), word("X", x), word("Y", y)), values, values),
    st.builds(lambda v: p.Block(words=(), assigns=(p.Assign(depth, v, NOWHERE),), span=NOWHERE), values),
    st.builds(lambda v: p.Device(name="wait", arguments=(v,), span=NOWHERE), values),
    st.builds(lambda v: p.Message(kind="write", parts=(p.Text("it's", NOWHERE), v), span=NOWHERE), values),
    st.just(p.Jump(name="5", span=NOWHERE)),
    st.just(p.Call(name="sub", span=NOWHERE, count=depth)),
)


def around(inner: Any) -> Any:
    bodies = st.lists(inner, max_size=3).map(tuple)
    ends = {"span": st.just(NOWHERE), "end_span": st.just(NOWHERE)}
    return (
        st.builds(p.If, condition=conditions, then=bodies, otherwise=bodies, else_span=st.just(NOWHERE), **ends)
        | st.builds(p.While, condition=conditions, body=bodies, **ends)
        | st.builds(p.Repeat, condition=conditions, body=bodies, **ends)
    )


statements = st.lists(st.recursive(simple, around, max_leaves=6), max_size=6)


@settings(max_examples=15, deadline=None)
@given(statements)
def test_generated_programs(tmp_path_factory: pytest.TempPathFactory, body: list[p.Statement]) -> None:
    end = block(word("M", p.Number(30.0, NOWHERE)))
    sub = p.Subprogram(name="sub", body=(p.Return(span=NOWHERE, code="M17"),), span=NOWHERE, is_module=True)
    program = job(p.Label(name="5", span=NOWHERE), *body, end, subprograms={"sub": sub})
    text = printed(program, NO_MCUWIN)
    again = read_back(tmp_path_factory.mktemp("made"), text, NO_MCUWIN, None)
    assert settled(whole(again), "continued") == settled(whole(program), "continued"), text.decode()


def test_names_are_declared_where_their_numbers_say(tmp_path: Path) -> None:
    """Procedures stand between the declarations; a name of a module is behind its percent sign."""
    path = tmp_path / "job.din"
    path.write_text(
        "const Deep = 5;\nvar a, b: integer;\nprocedure bore(d: double; var n: integer);\nvar k: integer;\nbegin\n"
        "  k := 1; repeat n := n + k until n > 3\nend;\nprocedure stop; begin end;\nvar c: double; f: boolean;\n"
        "%First\nG01 X(c * Deep) F100\n$if f then bore(c, a) else if a = 1 then stop;\nm96 first\nm98 Other o2\n"
        "$b := 1;\nX5 ' where?\nM30\n%Other\nG91 Y5.\nM17\n"
    )
    program = load_program(path, Findings(), NO_MCUWIN, tables=False)
    assert program is not None
    assert (
        agrees(tmp_path, program, NO_MCUWIN)
        == b"""const Deep = 5;
var a, b: integer;
procedure bore(d: double; var n: integer);
  var k: integer;
begin
  k := 1;
  repeat
    n := n + k;
  until (n > 3);
end;
var c: double;
  f: boolean;
procedure stop;
begin
end;
%first
G01 X(c * Deep) F100
$if (f) then begin
  $bore(c, a);
$end else if (a = 1) begin
  $stop;
$end
M96 first
M98 other O2
b := 1
X5 ' where?
M30
%other
G91 Y5.0
M17
"""
    )


def test_what_a_line_goes_on_with_is_written_where_the_order_would_say_otherwise() -> None:
    first = block(word("G", p.Number(0.0, NOWHERE)), word("X", number(1.0)))
    on = block(word("X", number(2.0)), continued="G1")
    assert printed(job(first, on, on), NO_MCUWIN) == b"G00 X1.0\nG01 X2.0\nX2.0\n"
    nothing = block(word("X", number(2.0)))
    assert printed(job(nothing), NO_MCUWIN) == b"X2.0\n"
    with pytest.raises(Refusal, match="goes on with nothing after G0"):
        printed(job(first, nothing), NO_MCUWIN)
    unknown = block(word("X", number(2.0)), continued="?")
    assert printed(job(first, unknown), NO_MCUWIN) == b"G00 X1.0\n$\nX2.0\n"


def test_subprograms_of_other_languages_become_modules_that_return() -> None:
    sub = p.Subprogram(name="slot", body=(block(word("M", p.Number(8.0, NOWHERE))),), span=NOWHERE)
    call = p.Call(name="slot", span=NOWHERE)
    end = block(word("M", p.Number(30.0, NOWHERE)))
    program = job(call, end, subprograms={"slot": sub})
    assert printed(program, NO_MCUWIN) == b"%\nM98 slot\nM30\n%slot\nM08\nM17\n"
    numbered = printed(program, with_settings(line_numbers=True))
    assert numbered == b"%\nN10 M98 slot\nN20 M30\n%slot\nN30 M08\nN40 M17\n"


@pytest.mark.parametrize(
    "node",
    [
        p.Guard(name="machine_area", on=True, span=NOWHERE),
        p.Unsupported(what="the statement 'case'", span=NOWHERE),
        p.Call(name="slot", span=NOWHERE, arguments=(word("X", number(1.0)),)),
        p.Message(kind="dialog", parts=(), span=NOWHERE),
        p.Device(name="home", arguments=(), span=NOWHERE),
        block(word("G", number(54.1))),
        block(word("X", p.Binary("**", depth, depth, NOWHERE))),
        dataclasses.replace(block(word("X", number(1.0))), deleted=True),
        p.Block(words=(), assigns=(p.Assign(depth, depth, NOWHERE),) * 2, span=NOWHERE),
        dataclasses.replace(block(word("X", number(1.0))), comment="two\nlines"),
        p.Block(words=(), assigns=(p.Assign(p.Variable(number(5001.0), NOWHERE), depth, NOWHERE),), span=NOWHERE),
    ],
)
def test_what_mcuwin_has_no_text_for_is_refused(node: p.Statement) -> None:
    with pytest.raises(Refusal) as refusal:
        printed(job(node), NO_MCUWIN)
    assert refusal.value.finding.code.label == "GP702"
