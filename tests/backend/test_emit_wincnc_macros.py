"""CNC.MAC printed back: the same definitions, the same programs that use them; printing twice changes nothing.

Forms by hand from docs/fmt.md; what a line is from the manual, "Macro File Configuration".
"""

from __future__ import annotations

import dataclasses
import random
import shutil
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.bundles import unpacked
from support.campaigns import examples, share
from support.goldens import ROOT

from gproof.backend.emit.wincnc.program import emit
from gproof.cli.dump import loaded
from gproof.cli.main import main
from gproof.driver.dialects import load_machine
from gproof.frontend.common.source import read_source
from gproof.frontend.wincnc.load import load_alone
from gproof.frontend.wincnc.mac_file import read_macros
from gproof.frontend.wincnc.mac_program import load_macro_file
from gproof.frontend.wincnc.machine import NO_SHOP
from gproof.ir.dialects.wincnc.settings import Lexical, wincnc_settings
from gproof.ir.finding import Findings, Refusal, Severity, Span
from gproof.ir.machine import Machine
from gproof.ir.program import Block, Definition, Message, Program
from gproof.ir.same import difference
from gproof.ir.text import parse_ir, print_ir

MACRO_FILES = sorted(
    path
    for parent in (unpacked("tests/hand") / "wincnc", ROOT / "corpus/wincnc", unpacked("docs/codes"))
    for path in parent.rglob("*")
    if path.name.lower() == "cnc.mac"
)


def with_lexical(lexical: Lexical) -> Machine:
    return dataclasses.replace(NO_SHOP, settings=dataclasses.replace(wincnc_settings(NO_SHOP), lexical=lexical))


def read(path: Path, data: bytes, machine: Machine = NO_SHOP) -> Program | None:
    """The definitions in ``data``, or None when it has mistakes."""
    path.write_bytes(data)
    findings = Findings()
    program = load_macro_file(path, findings, "CNC.MAC", machine=machine)
    return None if findings.has(Severity.ERROR) else program


def formatted(folder: Path, data: bytes, machine: Machine = NO_SHOP) -> bytes | None:
    """``data`` in its printed form, after every property that holds for all; None when it has mistakes."""
    path, other = folder / "CNC.MAC", folder / "other" / "CNC.MAC"
    other.parent.mkdir(exist_ok=True)
    program = read(path, data, machine)
    if program is None:
        return None
    lexical = wincnc_settings(machine).lexical
    program.verify()
    whole = loaded(program)
    assert parse_ir(print_ir(whole)) == whole
    text = b"".join(emit(program, lexical))
    again = read(other, text, machine)
    assert again is not None, "the printed text has mistakes"
    assert difference(program, again) is None
    assert b"".join(emit(again, lexical)) == text, "printing twice changes something"
    # Without ir/same.py: the reader that jobs are read with has the same names, with the same words.
    sides = [read_macros(read_source(p, dos=True), Findings(), lexical)[0] for p in (path, other)]
    assert list(sides[0]) == list(sides[1])
    for name, macro in sides[0].items():
        assert squeezed(macro.text) == squeezed(sides[1][name].text)
    body = data.removeprefix(b"\xef\xbb\xbf").removesuffix(b"\x1a")
    assert text.count(b"\n") == body.count(b"\n") + bool(body and not body.endswith(b"\n"))
    return text


def squeezed(text: str) -> str:
    """A command without what spelling may change: case, blanks, zeros of numbers, the shape of quotes."""
    text = text.upper().replace("“", '"').replace("”", '"').replace(" ", "").replace("\t", "").replace("+", "")
    return text.replace(",", ".").replace(".", "").replace("0", "")


FORM = [
    ("m3 = m98  Spin.mac   x.5 t{t}", "m3=M98 Spin.mac X0.5 T{T}"),
    ("M03=M11C2", "M03=M11 C2"),
    ("\tM3\t=\tm11 c2\t", "M3=M11 C2"),
    ("g 28 =~ g28 xy", "g 28=~G28 X Y"),
    ("L5.10=~L5XY", "L5.10=~L5 X Y"),
    ("Park=g53z0", "Park=G53 Z0"),
    ("M2=[", "M2=["),
    ("M2 = [", "M2=["),
    ("M2 =   [no end] [at all", "M2=[no end] [at all"),
    ("M2=( off )", "M2=( off )"),
    ("M2=% off", "M2=% off"),
    ("M8=[                CAM asks", "M8=[                CAM asks"),
    ("M9=m12c2[off]", "M9=M12 C2 [off]"),
    ("M9 = m12c2     [off]", "M9=M12 C2      [off]"),
    ('ASK=g5t1m"Clamp [left]  shut?"[ask]', 'ASK=G5 T1 M"Clamp [left]  shut?" [ask]'),
    ("ASK=G5M“shut?”", 'ASK=G5 M"shut?"'),
    ("DOWN=g92.2z{ th1 + 2. }", "DOWN=G92.2 Z{TH1+2.0}"),
    ("RUN=l41 copy  a.txt", "RUN=L41 copy  a.txt"),
    ("ROWS=l10 r2 c1x0y1.50", "ROWS=L10 R2 C1 X0 Y1.5"),
    ("IF3=m17.1c3", "IF3=M17.1 C3"),
    ("Z1=l91g1z.25", "Z1=L91 G1 Z0.25"),
    # Only the line of a job completes these; or a machine may take them for something else.
    ('ASK=g5 m"go', 'ASK=g5 m"go'),
    ("CALL=m98", "CALL=m98"),
    ("CALL=m98 my  part.tap", "CALL=m98 my  part.tap"),
    ("BACK=park x5", "BACK=park x5"),
    ("T5=m06t1", "T5=m06t1"),
    ("BAD=g0 x?1", "BAD=g0 x?1"),
    # Comments, and lines of which the manual leaves open what they are.
    ("   [a]   (b)  % c  ", "[a] (b) % c"),
    ("  % M2=[", "% M2=["),
    ("  depth = 12.50   [in]", "  depth = 12.50   [in]"),
    ("depth={TH1+1}", "depth={TH1+1}"),
    (" m9=m12c2 [off] c3 ", " m9=m12c2 [off] c3"),
    (" [off]  m9=m12c2", " [off]  m9=m12c2"),
    ("M9=" + "x1" * 126, "M9=" + "x1" * 126),
]


@pytest.mark.parametrize(("line", "becomes"), FORM)
def test_form_of_a_line(tmp_path: Path, line: str, becomes: str) -> None:
    text = formatted(tmp_path, line.encode())
    # A line that would begin with a percent sign stays as it is, as in programs.
    assert text is not None
    assert text.decode() in (f"{becomes}\n", f"{line}\n" if line.lstrip().startswith("%") else "")


def test_a_definition_that_begins_with_another_one(tmp_path: Path) -> None:
    """What stands behind a macro that calls a file stays: it may be a part of the file's name."""
    data = b"M6=m98 CHANGE.MAC t{t}\nm16=m06t5\nM26=M16 x\nG28=g28 x\n"
    expected = b"M6=M98 CHANGE.MAC T{T}\nm16=m06 T5\nM26=M16 x\nG28=g28 x\n"
    assert formatted(tmp_path, data) == expected


def test_signs_of_the_machine(tmp_path: Path) -> None:
    machine = with_lexical(Lexical(comment_signs=";'", comma=True, skips=(("#%", 3),)))
    data = b"m3=m11c2;on\nP=g0x1,5 'up\n; a\nM2=;off\n"
    assert formatted(tmp_path, data, machine) == b"m3=M11 C2 ;on\nP=G0 X1.5 'up\n; a\nM2=;off\n"


@pytest.mark.parametrize("newline", ["\n", "\r\n"])
@pytest.mark.parametrize("end", ["", "\x1a", "NEWLINE", "NEWLINE\x1a"])
def test_ends_of_lines_and_mark_are_kept(tmp_path: Path, newline: str, end: str) -> None:
    data = (
        b"\xef\xbb\xbf"
        + newline.join(["m3=m11c1", "", "[c", "m2=["]).encode()
        + end.replace("NEWLINE", newline).encode()
    )
    expected = b"\xef\xbb\xbf" + newline.join(["m3=M11 C1", "", "[c", "m2=[", ""]).encode()
    assert formatted(tmp_path, data) == expected


@pytest.mark.parametrize("data", [b"", b"\n\n", b"[nothing here]\n", b"\xef\xbb\xbf"])
def test_files_that_define_nothing(tmp_path: Path, data: bytes) -> None:
    assert formatted(tmp_path, data) == data


@pytest.mark.parametrize("raw", [
    b'M1=g5 m"\xfcber"', b"M1=g5 m\x93\xfcber\x94", b"M1=x1[\xe4", b"[\xe4", "M1=g5 m“ß” [ß]".encode(), "% ü".encode(),
    b"M1=g5 m\x93\xc3\xa4\x94",
])  # fmt: skip
def test_bytes_of_texts_are_kept(tmp_path: Path, raw: bytes) -> None:
    text = formatted(tmp_path, raw)
    assert text is not None
    for quote in (b"\x93", b"\x94", "“".encode(), "”".encode()):
        raw, text = raw.replace(quote, b""), text.replace(quote, b"")
    assert [c for c in text if c > 127] == [c for c in raw if c > 127]


def test_more_open_lines_than_findings_are_kept(tmp_path: Path) -> None:
    data = "".join(f"depth{n} = {n}.50\nM{n}=m11c{n} [a] b\n" for n in range(200)).encode()
    assert formatted(tmp_path, data) == data


@pytest.mark.parametrize("path", MACRO_FILES, ids=lambda path: path.parent.name)
def test_files_of_shops(tmp_path: Path, path: Path) -> None:
    ini = path.parent / "WINCNC.INI"
    # Some pages of findings show a WINCNC.INI with a mistake.
    machine = (load_machine(ini, Findings())[0] if ini.is_file() else None) or NO_SHOP
    read_macros(read_source(path), findings := Findings(), wincnc_settings(machine).lexical)
    assert (formatted(tmp_path, path.read_bytes(), machine) is None) == findings.has(Severity.ERROR)


# -- what a Program of definitions is


SPAN = Span("CNC.MAC", 1, 1, 2)


def definition(**values: object) -> Definition:
    given = {"name": "M3", "label": "m3", "written": "M11", "span": SPAN, **values}
    return Definition(**given)  # type: ignore[arg-type]


@pytest.mark.parametrize("body", [
    (definition(name=""),), (definition(name="m3"),), (definition(label=""),), (definition(label="m=3"),),
    (definition(written="M1\nM2"),), (definition(label="m3\r"),),
    (definition(written="", line=Block(words=(), assigns=(), span=SPAN)),),
    (definition(), Message(kind="msg", parts=(), span=SPAN)),
])  # fmt: skip
def test_what_is_no_program_of_definitions(tmp_path: Path, body: tuple[Definition, ...]) -> None:
    program = read(tmp_path / "CNC.MAC", b"M3=M11\n")
    assert program is not None
    program.verify()
    with pytest.raises(ValueError, match=r"definition|command"):
        dataclasses.replace(program, body=body).verify()


def test_what_has_no_text_is_refused(tmp_path: Path) -> None:
    program = read(tmp_path / "CNC.MAC", b"M3=G0 X{TH1+1}\n")
    assert program is not None
    (node,) = program.body
    assert isinstance(node, Definition)
    assert node.line is not None
    word = node.line.words[1]
    deep = dataclasses.replace(word.value, left=word.value)
    words = (node.line.words[0], dataclasses.replace(word, value=deep))
    program.body = (dataclasses.replace(node, line=dataclasses.replace(node.line, words=words)),)
    with pytest.raises(Refusal) as refused:
        list(emit(program, Lexical()))
    assert refused.value.finding.code.label == "GP702"


CHANGES = [
    (b"M3=M11 C1", b"M3=M11 C2"), (b"M3=M11 C1", b"M03=M11 C1"), (b"M3=M11 C1", b"M4=M11 C1"), (b"M3=M11", b"M3=["),
    (b"M3=M11 C1", b"M3=~M11 C1"), (b"M3=M98 A.TAP", b"M3=M98 a.tap"), (b"M3=M11 [a]", b"M3=M11 [b]"),
    (b"M2=[", b"M2=("),
    (b"M3=G0 X1", b"M3=G0 X1.0"), (b"M3=G0 X", b"M3=G0 X0"), (b"d=1.5", b"d=1.50"),
    (b"M3=M11", b"[M3=M11"), (b"M3=M11 C1\nM4=M11 C2", b"M4=M11 C2\nM3=M11 C1"), (b"M3=M11\n", b"M3=M11\n\nM4=["),
]  # fmt: skip


@pytest.mark.parametrize(("one", "two"), CHANGES)
def test_a_change_is_noticed(tmp_path: Path, one: bytes, two: bytes) -> None:
    programs = [read(tmp_path / f"{n}.mac", text) for n, text in enumerate((one, two))]
    assert programs[0] is not None
    assert programs[1] is not None
    assert difference(programs[0], programs[1]) is not None
    assert difference(programs[1], programs[0]) is not None


# -- anything

BLANKS = st.sampled_from(["", "", " ", "  ", "\t"])
NAMES = st.sampled_from(["M3", "m03", "M3.0", "g28", "G0", "L5.1", "g 54", "Park", "T", "x", "A_B", "M2", "m6", "X1"])
NUMBERS = st.sampled_from(
    ["0", "1", "12.50", ".25", "-.5", "+4", "007", "5.", "-0", "{t}", "{ th1 + 2. }", "", "{q*.5}"]
)
WORDS = st.lists(
    st.tuples(st.sampled_from("XYZCTFPxyzctf"), NUMBERS).map("".join), max_size=4, unique_by=lambda w: w[0]
)
CODES = st.sampled_from(
    ["G0", "g1", "G53", "M11", "m12", "M17.1", "~G28", "~ m3", "L91 g1", "G92.1", "M3", "park", "l10", "G"]
)
TEXTS = st.sampled_from(
    ["M98 SPIN.MAC", "m98  a.tap  x.5 t{t}", 'm98 "my part.tap"y1', "M98", "M98.1 my part.tap", 'g5t1m"Go [on]?"',
     'G5 m"open', "G5M“x”", "L41 copy  a", "l210", "", "12.5", "{TH1}", "?", "X" * 245, "G0" + "X1" * 130, "ä"]
)  # fmt: skip
COMMENTS = st.sampled_from(["", "", "[a]", "(b c)", "[open", "% rest ", "[", "[x] (y)", "[ä]", "[a] b", ";x", "(a[b)"])


@st.composite
def macro_lines(draw: st.DrawFn) -> str:
    """A line of CNC.MAC, mostly right, in some spelling."""
    kind = draw(st.integers(0, 9))
    comment = draw(COMMENTS)
    if kind == 0:
        return draw(BLANKS) + comment
    command = draw(TEXTS) if kind < 4 else draw(BLANKS).join([draw(CODES), *draw(WORDS)])
    if kind == 4:
        command, comment = "", comment or "["
    return "".join([draw(BLANKS), draw(NAMES), draw(BLANKS), "=", draw(BLANKS), command, draw(BLANKS), comment])


JOB = (
    b"""g0x1
m3
m03 x5 y1
M3 x.5[a]
park
Park 5
x1
g28 xy
m6t1
M6 Y"""
    + b"1" * 230
    + b"""
m6 """
    + b"X{TP1}" * 40
    + b"""
t [b]
~m3
l5.1 "on"
a_b c.tap
M2
"""
)


@examples(50, 1000)
@given(
    lines=st.lists(macro_lines(), max_size=8), newline=st.sampled_from(["\n", "\r\n"]),
    last=st.sampled_from(["", "\n", "\x1a"]), encoding=st.sampled_from(["utf-8", "cp1252", "utf-8-sig"]),
    lexical=st.sampled_from([Lexical(), Lexical(comment_signs=";")]),
)  # fmt: skip
def test_any_macro_file(
    tmp_path_factory: pytest.TempPathFactory, lines: list[str], newline: str, last: str, encoding: str, lexical: Lexical
) -> None:
    folder = tmp_path_factory.mktemp("any")
    machine = with_lexical(lexical)
    good = []
    for line in lines:  # one after the other, so that one mistake does not hide the rest
        data = newline.join([*good, line]).encode(encoding)
        if read(folder / "CNC.MAC", data, machine) is not None:
            good.append(line)
    data = (newline.join(good) + last).encode(encoding)
    text = formatted(folder, data, machine)
    assert text is not None or "\n" in newline.join(good)[-1:]
    if text is None:
        return
    (folder / "CNC.MAC").write_bytes(data)
    # A job that uses the file: the same Program with both, or fmt refuses the file.
    job = folder / "job.tap"
    job.write_bytes(JOB)
    sides = []
    for macros in (folder / "CNC.MAC", folder / "other" / "CNC.MAC"):
        findings = Findings()
        program = load_alone(job, findings, machine=machine, folders=[folder], macro_file=macros)
        assert program is not None
        sides.append((program, [(f.code.label, f.span.line) for f in findings.kept if f.span.file == str(job)]))
    same = sides[0][1] == sides[1][1] and difference(sides[0][0], sides[1][0], notes=False) is None
    too_long = {line for side in sides for label, line in side[1] if label == "GP133"}
    assert same or too_long
    if lexical == Lexical():
        assert main(["fmt", str(folder / "CNC.MAC")]) == 0
        written = (folder / "CNC.MAC").read_bytes()
        # Lines that are not understood stay as they are.
        sides_of_lines = zip(written.splitlines(), text.splitlines(), data.splitlines(), strict=False)
        assert all(line in both for line, *both in sides_of_lines) or not same
        program = load_alone(job, Findings(), machine=machine, folders=[folder])
        assert program is not None
        assert difference(sides[0][0], program, notes=False) is None
        assert main(["fmt", str(folder / "CNC.MAC")]) == 0
        assert (folder / "CNC.MAC").read_bytes() == written


@pytest.mark.parametrize("blank", [b"\xa0", b"\x85", b" \xa0\t", b"\xc2\xa0", b"\x1c", b"\xa0\nG5 = G4 X1\n\xa0"])
def test_a_line_of_other_blanks_is_empty(tmp_path: Path, blank: bytes) -> None:
    for data in (blank, blank + b"\n", b"G5=G4 X1\n" + blank + b"\nG6=G4 X2\n"):
        formatted(tmp_path, data)


@pytest.mark.parametrize("command", [b"G0X0", b"g0 x0", b"G0X0F+4", b'L100 "a b"'])
def test_a_command_beside_a_line_that_stays_is_as_it_was_written(tmp_path: Path, command: bytes) -> None:
    """Both define M3, by the same command: printed in two ways they would be two."""
    data = b"M3=" + command + b"\nM3=" + command + b"[a] b\n"
    assert formatted(tmp_path, data) == data
    assert formatted(tmp_path, b"M3=G0X0\nM3=G0X1\n") is None


@given(st.binary(max_size=120))
@settings(deadline=None)
def test_random_bytes(tmp_path_factory: pytest.TempPathFactory, data: bytes) -> None:
    formatted(tmp_path_factory.mktemp("bytes"), data)


@pytest.mark.parametrize("seed", range(4))
def test_random_text(tmp_path: Path, seed: int) -> None:
    rng = random.Random(seed)
    alphabet = 'GLMXC013.-+{}[]()%~"“”„#= \t\r\n\n=ä;\xa0'
    for _ in range(300):
        text = "".join(rng.choice(alphabet) for _ in range(rng.randint(1, 60)))
        formatted(tmp_path, text.encode(rng.choice(["utf-8", "latin-1"]), "replace"))


# -- whole shops

SHOPS = sorted({path.parent for path in MACRO_FILES if "docs/codes" not in str(path)})


@pytest.mark.parametrize("shop", share(SHOPS, 6), ids=lambda path: path.name)
def test_a_formatted_shop_has_the_same_traces(
    tmp_path: Path, shop: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def files() -> dict[str, bytes]:
        return {str(p): p.read_bytes() for p in sorted(Path().rglob("*")) if p.is_file()}

    jobs = [p.relative_to(shop) for p in sorted(shop.rglob("*.tap")) if p.stat().st_size < 4000][:8]
    folders = sorted({Path(), *(job.parent for job in jobs)})
    traces = []
    for side in ("as-written", "formatted"):
        shutil.copytree(shop, tmp_path / side)
        monkeypatch.chdir(tmp_path / side)
        machine = ["--dialect", "wincnc", *(["--machine", "WINCNC.INI"] if Path("WINCNC.INI").is_file() else [])]
        if side == "formatted":
            for folder in folders:
                main(["fmt", *machine, str(folder)])
                once = files()
                main(["fmt", *machine, str(folder)])
                assert files() == once
            assert "CNC.MAC: not formatted" not in capsys.readouterr().err
        capsys.readouterr()
        codes = [
            main(["dump", str(job), "--stage", "trace", "--format", "jsonl", "--setup", "zero", *machine])
            for job in jobs
        ]
        traces.append((codes, capsys.readouterr().out))
    assert traces[0] == traces[1]


def test_blanks_before_a_comment_need_no_encoding(tmp_path: Path) -> None:
    """A no-break space of Windows-1252 there is a blank; a comment with such letters keeps its encoding."""
    assert formatted(tmp_path, b"\xa0[left]\n[caf\xe9]\n M7=M11C2\n") == b"[left]\n[caf\xe9]\nM7=M11 C2\n"
