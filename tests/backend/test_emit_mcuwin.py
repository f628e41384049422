"""McuWIN text printed back: the same Program, the same Trace, the same lines; printing twice changes nothing."""

from __future__ import annotations

import dataclasses
import random
import re
import shutil
from pathlib import Path
from typing import Any

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from support.bundles import unpacked
from support.campaigns import share, sizes
from support.goldens import ROOT
from support.mcuwin_lines import HEAD, random_line

from gproof.backend.emit.mcuwin.pascal_words import Spelling, joined_words, words_of
from gproof.backend.emit.mcuwin.program import emit
from gproof.cli.main import main
from gproof.driver.dialects import load_machine
from gproof.frontend.mcuwin.load import load_alone, load_program
from gproof.frontend.mcuwin.machine import NO_MCUWIN
from gproof.ir.dialects.mcuwin.settings import NO_MCUWIN_SETTINGS, mcuwin_settings
from gproof.ir.finding import Findings, Severity, Span
from gproof.ir.machine import Machine
from gproof.ir.program import BlockTable, DeferredBlock, Program
from gproof.ir.same import difference

SOURCES = (".din", ".src", ".inc", ".pim")
JOBS = (".din", ".src")
SHOPS = sorted(
    {
        path.parent
        for parent in (unpacked("tests/hand") / "mcuwin", ROOT / "corpus/mcuwin", unpacked("docs/codes"))
        for path in parent.rglob("*")
        if path.suffix in JOBS
    }
)


def with_settings(**din: Any) -> Machine:
    return dataclasses.replace(NO_MCUWIN, settings=dataclasses.replace(NO_MCUWIN_SETTINGS, **din))


def machine_file_of(shop: Path) -> Path | None:
    places = [folder / name for folder in (shop, shop.parent) for name in ("machine.toml", "McuWIN.ini")]
    return next((path for path in places if path.is_file()), None)


def machine_of(shop: Path) -> Machine:
    path = machine_file_of(shop)
    machine = NO_MCUWIN if path is None else load_machine(path, Findings())[0]
    assert machine is not None
    return machine


def read(folder: Path, data: bytes, machine: Machine, source: Path | None = None, name: str = "job.din") -> Any:
    """The program in ``data``, which stands for the file ``source``, or None when it has mistakes."""
    path = folder / name
    path.write_bytes(data)
    findings = Findings()
    source = source or folder / "job.din"
    program = load_alone(path, findings, str(source), machine=machine, folder=source.parent)
    return None if findings.has(Severity.ERROR) else program


def printed(program: Program, machine: Machine = NO_MCUWIN) -> bytes:
    return b"".join(emit(program, mcuwin_settings(machine)))


def formatted(folder: Path, data: bytes, machine: Machine = NO_MCUWIN, source: Path | None = None) -> bytes | None:
    """``data`` in its printed form, after every property that holds for all; None when it has mistakes."""
    program = read(folder, data, machine, source)
    if program is None:
        return None
    try:
        text = printed(program, machine)
        again = read(folder, text, machine, source, "again.din")
        assert again is not None, "the printed text has mistakes"
        assert difference(program, again) is None
        assert comparable(program) == comparable(again)
        assert printed(again, machine) == text, "printing twice changes something"
        lines = len(data.removesuffix(b"\x1a").replace(b"\r\n", b"\n").split(b"\n"))
        whole = data.removesuffix(b"\x1a").endswith(b"\n") or not data.removeprefix(b"\xef\xbb\xbf").removesuffix(
            b"\x1a"
        )
        assert len(text.split(b"\n")) - 1 == lines - whole
        assert squeezed(text) == squeezed(data)
    except Exception:
        print(data.decode("latin-1"))
        raise
    return text


def squeezed(data: bytes) -> bytes:
    """Text without what printing may change: blanks, case, brackets, forms of numbers."""
    data = re.sub(rb"[0-9]+\.?[0-9]*|\.[0-9]+", lambda m: b"<%r>" % float(m[0]), data)
    return re.sub(rb"[ \t\r\n+()]|\x1a\Z", b"", data).lower()


def comparable(program: Program) -> str:
    """Everything but names, columns and byte offsets: a comparison that does not use ``ir/same.py``."""

    def plain(value: Any) -> Any:
        value = value.made() if isinstance(value, DeferredBlock) else value
        if isinstance(value, Span):
            return value.line
        if isinstance(value, BlockTable):
            words, begin, line = [], value.begin, value.first_line
            while line <= value.last_line:
                part, begin, line = program.load(value, begin, line, 5000)
                words += [(row, letter, flags, repr(number)) for row, _, letter, flags, number in part.rows()]
            return value.first_line, value.last_line, value.continued, words
        if dataclasses.is_dataclass(value):
            names = [f.name for f in dataclasses.fields(value) if f.compare]
            return type(value).__name__, [plain(getattr(value, name)) for name in names]
        if isinstance(value, tuple | list):
            return [plain(item) for item in value]
        return repr(value)

    procedures = [plain(sub) for sub in program.subprograms.values()]
    return repr((plain(program.body), procedures, program.line_count, notes_of(program)))


def notes_of(program: Program) -> list[tuple[int, int, int, bytes]]:
    found, begin, line = [], 0, 1
    while line <= program.line_count:
        notes, begin, line = program.load_notes(0, begin, line, 5000)
        notes.verify()
        found += [(row, place, kind, text) for row, place, kind, _, text in notes]
    assert (line, begin) == (program.line_count + 1, len(program.files[0].data))
    return found


# -- the form


FORM = [
    ("g0x1y2", "G00 X1 Y2"),
    ("  G01   X1.50 Y-.5 z5. F0100", "G01 X1.5 Y-0.5 Z5.0 F100"),
    ("G 2 X+12.5 i1j.5", "G02 X12.5 I1 J0.5"),
    ("n010 g1x-0y-0.", "N010 G01 X-0 Y-0.0"),
    ("N 10", "N10"),
    ("G90g17", "G90 G17"),
    ("g060 x y z", "G60 X Y Z"),
    ("G39", "G39"),
    ("G04 .5", "G04 0.5"),
    ("g4cd601", "G04 CD601"),
    ("G04 CD601*2", "G04 CD601 * 2"),
    ("G4 ( cd601+1 )", "G04 (CD601 + 1)"),
    ("M26 0102 ' a", "M26 102 ' a"),
    ("m80x 4", "M80 X4"),
    ("M901 601", "M901 601"),
    ("M3 S1000", "M03 S1000"),
    ("T1 m6 D 2", "T1 M06 D2"),
    ("TCI600", "T(CI600)"),
    ("X2*CD620", "X(2 * CD620)"),
    ("X(CD601 - y.RP) Y ( 200.0+5.0*sin (X.tp/10.0))", "X(CD601 - Y.rp) Y(200.0 + 5.0 * sin(X.tp / 10.0))"),
    ("XCD600 YCD601", "X(CD600) Y(CD601)"),
    ("X-cd600", "X(-CD600)"),
    ("X(5) Y((.5))", "X(5) Y((0.5))"),
    ("X1.5(in) Y2 (and)  ' out  ", "X1.5 (in) Y2 (and) ' out"),
    ("  (a)   (b) 'rest \t", "(a) (b) 'rest"),
    ("X1    ' kept apart", "X1    ' kept apart"),
    ("x1.000    ' kept where it was", "X1.0      ' kept where it was"),
    ("CD600:=CD601+ 2.50*(1)", "CD600 := CD601 + 2.5 * (1)"),
    ("N5 ci600 := -1 G0X1", "N5 CI600 := -1 G00 X1"),
    ("n20L0114 g0x1", "N20 L0114 G00 X1"),
    ("L 7", "L7"),
    ("m096 l0114", "M96 L0114"),
    ("M98 L 114 O 5", "M98 L114 O5"),
    ("M98 Up114 O(CI600+1) ' go", "M98 Up114 O(CI600 + 1) ' go"),
    ("M98 L114 O CI600", "M98 L114 O(CI600)"),
    ("m017", "M17"),
    ('write "a  (b" x.Rp', 'WRITE "a  (b" X.rp'),
    ('Writeln "a",CD600 ,"b"', 'WRITELN "a", CD600, "b"'),
    ("% Up114 (sub)", "%Up114 (sub)"),
    (" %", "%"),
    ("N500 %", "N500 %"),
    ("$i  Lib\\a.INC  (all)", "$I Lib\\a.INC   (all)"),
    ("N5 $ wt( 2000 ) ;//x", "N5 $wt(2000); //x"),
    ("$cd600:=CD601*-2.50", "$CD600 := CD601 * -2.5"),
    ("$IF(CD600<1)AND NOT X.DIGIB.5 THEN CD600:=1;", "$if (CD600 < 1) and not X.digib.5 then CD600 := 1;"),
    ("$ writeln('it''s', 5)", "$WRITELN ('it''s', 5)"),
    ("$CI600:= Round(CD600) mod 2 {a} ; {b}", "$CI600 := Round(CD600) mod 2 {a} ; {b}"),
    ("$sta( x,10.50 )", "$sta( x,10.50 )"),
    ("$", "$"),
    ("{ $DinStart }", "{$DINSTART}"),
    ("X.zeroOffset := 5.", "X.zeroOffset := 5."),
    (" CD600:={ a }36 ", " CD600:={ a }36"),
    (" x({ a }36)y.5", " x({ a }36)y.5"),
]  # fmt: skip


@pytest.mark.parametrize(("line", "becomes"), FORM)
def test_form_of_a_line(tmp_path: Path, line: str, becomes: str) -> None:
    before = b"G90\n"
    assert formatted(tmp_path, before + line.encode()) == before + becomes.encode() + b"\n"


def test_words_without_a_blank_between_them_stay() -> None:
    """In a command of which nothing is known, ``Y40.008`` is not Y40 and 0.008."""
    words = list(words_of("x.5 Y40.008,5AND .5"))
    assert joined_words(words, Spelling()) == "x.5 Y40.008, 5AND 0.5"


def files_of(shop: Path) -> list[Path]:
    return sorted(path for path in shop.iterdir() if path.suffix.lower() in SOURCES)


@pytest.mark.parametrize("shop", share(SHOPS, 4), ids=lambda path: "/".join(path.parts[-3:]))
def test_files_of_shops(tmp_path: Path, shop: Path) -> None:
    machine = machine_of(shop)
    for path in files_of(shop):
        findings = Findings()
        program = load_alone(path, findings, machine=machine)
        text = formatted(tmp_path, path.read_bytes(), machine, path)
        assert (text is None) == findings.has(Severity.ERROR), path
        if text is None and path.suffix in JOBS:
            whole = Findings()
            load_program(path, whole, machine, machine_file_of(shop))
            assert whole.has(Severity.ERROR), path
        assert program is not None, path


def test_a_whole_program(tmp_path: Path) -> None:
    data = b"""' sample
$dinend
// declarations
VAR
    sRadius, step : double;    { floating
   point }
 cntnr:integer;
const  Loopcntnr=500;
label  again , 010;
procedure bore( depth:double;VAR n : integer );
var k:integer;
begin
sRadius:=.50*depth; if step>1 then
step:=2
else begin step := 3;
   // what it is
repeat
k:=k-1 ;
until( k<1 )or(-k>5); end;
end;
  010:
{ $dinstart }

%SAMPLE (hello)
N10 g90
g0x100y200z-10
$IF(step<1)AND(CNTNR=2)  THEN BEGIN // c

' inside
(a) x2*cd620 F Step  y.5(note)
N12 $end ELSE begin
G1 X1
$repeat
N13 G1 X2
$end until(X.TP>5.) ;
$for cntnr:=1 TO loopcntnr do begin
g1 x(sradius)
$end
$end;
M30
%
%Up114
m17
$I  lib.inc   (library)
n500 %
"""
    expected = b"""' sample
$DINEND
// declarations
var
  sRadius, step: double;       { floating
   point }
  cntnr: integer;
const Loopcntnr = 500;
label again, 010;
procedure bore(depth: double; var n: integer);
var k: integer;
begin
  sRadius := 0.5 * depth; if step > 1 then
    step := 2
  else begin step := 3;
    // what it is
    repeat
      k := k - 1;
    until (k < 1) or (-k > 5); end;
end;
010:
{$DINSTART}

%SAMPLE (hello)
N10 G90
G00 X100 Y200 Z-10
$if (step < 1) and (cntnr = 2) then begin // c

  ' inside
  (a) X(2 * CD620) F(step) Y0.5 (note)
N12 $end else begin
  G01 X1
  $repeat
    N13 G01 X2
  $end until (X.tp > 5.0);
  $for cntnr := 1 to Loopcntnr do begin
    G01 X(sRadius)
  $end
$end;
M30
%
%Up114
M17
$I lib.inc    (library)
N500 %
"""
    assert formatted(tmp_path, data, with_settings(case_sensitive=False)) == expected


def test_names_keep_their_case_where_it_may_matter(tmp_path: Path) -> None:
    data = b"var step: double;\n%A\nSTEP := Step + 1\n$STEP:=SIN(step);\nM30\n"
    for settings_, middle in (
        ({"case_sensitive": False}, b"step := step + 1\n$step := sin(step);\n"),
        ({}, b"STEP := Step + 1\n$STEP := SIN(step);\n"),
    ):
        text = formatted(tmp_path, data, with_settings(**settings_))
        assert text == b"var step: double;\n%A\n" + middle + b"M30\n"
    exact = with_settings(case_sensitive=True)
    assert formatted(tmp_path, data, exact) is None
    data = b"var step, Step: double;\n%A\nstep:=Step+1\n$Step:=SIN( step );\nM30\n"
    expected = b"var step, Step: double;\n%A\nstep := Step + 1\n$Step := SIN(step);\nM30\n"
    assert formatted(tmp_path, data, exact) == expected
    assert formatted(tmp_path, b"g90\n", exact) is None


def test_settings_of_the_older_version(tmp_path: Path) -> None:
    old = with_settings(version="2.5.3.32")
    data = b"g90 // a\ng1x1.50y(cd600)\nm3 (on) (a(b))\nM26 102+1\n"
    assert formatted(tmp_path, data, old) == b"G90 // a\nG01 X1.5 Y(CD600)\nM03 (on) (a(b))\nM26 102 + 1\n"


@pytest.mark.parametrize("newline", ["\n", "\r\n"])
def test_ends_of_lines_and_mark_are_kept(tmp_path: Path, newline: str) -> None:
    data = b"\xef\xbb\xbf" + newline.join(["g0x1", "", "m8 ", "$ if CI600<1 then begin", "x3", "$end"]).encode()
    lines = ["G00 X1", "", "M08", "$if CI600 < 1 then begin", "  X3", "$end", ""]
    assert formatted(tmp_path, data) == b"\xef\xbb\xbf" + newline.join(lines).encode()


def test_files_of_nothing(tmp_path: Path) -> None:
    assert formatted(tmp_path, b"") == b""
    assert formatted(tmp_path, b"\n\n") == b"\n\n"
    assert formatted(tmp_path, b"  ") == b"\n"
    assert formatted(tmp_path, b"\x1a") == b""
    assert formatted(tmp_path, b"g0x1\r\n\x1a") == b"G00 X1\r\n"
    assert formatted(tmp_path, b"g0x1\n%\x1a") == b"G00 X1\n%\n"
    assert formatted(tmp_path, b"' \x1a\ng0\x1a\x1a") is None


@pytest.mark.parametrize(
    "raw",
    [
        b'WRITE "\xfcber"', b"X1 (\xe4)", b"' \xe4\x81", 'WRITE "\u00df" \'\u00df'.encode(),
        b"$WRITELN ('\xe4'); // \xfc",
        b"$DINEND // \xfc\n{ \xfc\n \xe4 } CI600 := 1; // \xf6\n{$DINSTART}",
    ],
)  # fmt: skip
def test_bytes_of_texts_are_kept(tmp_path: Path, raw: bytes) -> None:
    assert formatted(tmp_path, raw) == raw + b"\n"


def test_a_line_that_would_be_too_long_stays(tmp_path: Path) -> None:
    for line in ("X.1" * 250, "G90 " + "X.1" * 250, "X1" * 400 + "'" + "c" * 250, "X.10" * 251):
        assert formatted(tmp_path, f"g0x1\n {line} \ng0x2\n".encode()) == f"G00 X1\n {line}\nG00 X2\n".encode()


@pytest.mark.parametrize("line", ["G00 X1", "  g0x1 ' a", "M26 (200+CI600)", "x(cd600)"])
def test_a_line_that_is_too_long_for_its_blanks_stays(tmp_path: Path, line: str) -> None:
    """Without them it would be read otherwise: as one of the plain lines around it."""
    text = f"G00 X1\n{line}{' ' * 1000}\nG00 X2\n".encode()
    assert formatted(tmp_path, text) == text


def test_words_behind_a_mode_stay(tmp_path: Path) -> None:
    data = b"$DINEND ci600:=1; {$DINSTART}  n10 g0x1 ' a\n  {$DINSTART}n5  g90\n x1\n$DINEND\n {c\n d} {$DINSTART}x1\n"
    expected = data.replace(b"\n x1", b"\nX1").replace(b"\n  {", b"\n{").replace(b"\n {c", b"\n{c")
    assert formatted(tmp_path, data) == expected


def test_a_library_alone(tmp_path: Path) -> None:
    """Modules without a program, a block that another file ends, names that another file declares."""
    assert formatted(tmp_path, b"%1000(keyhole)\ng0x1\nm98 l7\nm17\n%\n") == (
        b"%1000 (keyhole)\nG00 X1\nM98 L7\nM17\n%\n"
    )
    assert formatted(tmp_path, b"g0x1\n$end\n") is None
    assert formatted(tmp_path, b"g0x(depth)\n") is None
    (tmp_path / "names.inc").write_bytes(b"var depth: double;\n$ nonsense ?\n")
    assert formatted(tmp_path, b"$I NAMES.INC\n%\ng0x(depth)\n") == b"$I NAMES.INC\n%\nG00 X(depth)\n"
    (tmp_path / "job.inc").write_bytes(b"$I job.din\n")
    assert formatted(tmp_path, b"$I missing.inc\n$i job.inc\ng0x1\n") == b"$I missing.inc\n$I job.inc\nG00 X1\n"


# -- anything


SETTINGS = [{}, {"case_sensitive": False}, {"case_sensitive": False, "keeps_over_codes": True}, {"version": "2.5.3.32"}]


@pytest.mark.parametrize("seed", range(4))
def test_random_programs(tmp_path: Path, seed: int) -> None:
    random_programs(tmp_path, seed, lines=32, programs=1)


@pytest.mark.soak
@pytest.mark.parametrize("seed", range(4, 16))
def test_many_random_programs(tmp_path: Path, seed: int) -> None:
    random_programs(tmp_path, seed, lines=600, programs=30)


def random_programs(folder: Path, seed: int, *, lines: int, programs: int) -> None:
    """Lines one by one, then programs of those that have no mistake."""
    rng = random.Random(seed)
    (folder / "lib.inc").write_bytes(b"g90\n")
    settings_ = SETTINGS[seed % len(SETTINGS)]
    machine = with_settings(**settings_)
    good = []
    for _ in range(lines):
        line = random_line(rng)
        if formatted(folder, (HEAD + line + "\nG0 X1\n").encode(), machine) is not None:
            good.append(line)
    assert len(good) > lines // 4
    for _ in range(programs):
        text = HEAD.splitlines() + [line for entry in rng.choices(good, k=40) for line in entry.split("\n")]
        data = rng.choice(["\n", "\r\n"]).join(text).encode(rng.choice(["utf-8", "utf-8", "cp1252"]))
        formatted(folder, data, machine)


@pytest.mark.parametrize("seed", range(3))
def test_random_bytes(tmp_path: Path, seed: int) -> None:
    rng = random.Random(seed)
    alphabet = b"GLMNXYCDI0123.-+*:=<(){}$%;,'/\"# \t\r\n\n\xe4\x93\x07\xa0ab\x1a"
    for _ in range(120):
        data = bytes(rng.choice(alphabet) for _ in range(rng.randint(1, 60)))
        formatted(tmp_path, data, with_settings(**SETTINGS[seed]))


def test_both_speeds_print_the_same_bytes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rng = random.Random(1)
    good = []
    while len(good) < 30:
        line = random_line(rng)
        if read(tmp_path, (HEAD + line + "\nG0 X1\n").encode(), NO_MCUWIN) is not None:
            good.append(line)
    texts = []
    for mode in ("python", "numba"):
        monkeypatch.setenv("GPROOF_KERNELS", mode)
        texts.append(formatted(tmp_path, (HEAD + "\n".join(good)).encode()))
    assert texts[0] == texts[1] is not None


PASCAL_WORDS = (
    "step Depth N flag CD600 ci601 5 .5 2.50 1e3 ( ) ( ) + - * / div MOD and OR not < <> = := ; ; , : begin END if "
    "THEN else while do repeat until for to sin ROUND boolean true pi X.tp c.RP x.digib.3 wt halt writeln 'a' \"b\" "
    "again: goto again {c} //d"
)
pascal_words = st.lists(st.sampled_from(PASCAL_WORDS.split()), max_size=14)
blanks = st.sampled_from(["", " ", "  ", "\t"])


@settings(max_examples=60, deadline=None)
@example(parts=[(["ROUND", "("], ""), (["step"], "")], section=True)
@given(st.lists(st.tuples(pascal_words, blanks), min_size=1, max_size=4), st.booleans())
def test_any_words_of_pascal(tmp_path_factory: pytest.TempPathFactory, parts: Any, section: bool) -> None:
    """Words in any order, most of them nonsense: what is read is printed as itself."""
    folder = tmp_path_factory.mktemp("words")
    lines = [blank + " ".join(words) for words, blank in parts]
    lines = ["$DINEND", *lines, "{$DINSTART}"] if section else [f"${line}" for line in lines]
    formatted(folder, (HEAD + "\n".join(lines)).encode(), with_settings(case_sensitive=False))


# -- what must be noticed

CHANGES = [
    (b"G0 X1", b"G0 X1.0"), (b"G0 X1", b"G0 X2"), (b"G0 X1", b"G1 X1"), (b"G0 X1", b"G0 X(1)"), (b"X-0", b"X0"),
    (b"M03", b"M04"), (b"G60 X Y", b"G60 Y X"), (b"G4 3", b"G4 3.0"), (b"M98 L1 O5", b"M98 L1 O6"), (b"L1", b"L2"),
    (b"M98 L1", b"M96 L1"), (b"M98 up", b"M98 down"), (b"%up", b"%Up"), (b"%", b""), (b"$wt(1);", b"$wt(2);"),
    (b"$CD600 := 1;", b"CD600 := 1"), (b"$if CI600 < 1 then begin\nX1\n$end", b"$if CI600 < 2 then begin\nX1\n$end"),
    (b"$if CI600 < 1 then begin\nX1\n$end", b"$while CI600 < 1 do begin\nX1\n$end"), (b"X1 (a)", b"X1 ' a"),
    (b"X1 (a)", b"X1"), (b"X1 (a)", b"(a) X1"), (b"' a", b"' b"), (b"$wt(1); // a", b"$wt(1); // b"), (b"N10", b"N010"),
    (b"$DINEND\n{ a\n}\n{$DINSTART}", b"$DINEND\n{ a\n }\n{$DINSTART}"), (b"G0 X1", b"X1\nG0"), (b"$I a", b"$I b"),
    (b"X(1 + CD600)", b"X(1 + CI600)"), (b'WRITE "a"', b'WRITELN "a"'), (b'WRITE "a"', b'WRITE "b"'),
    (b"$halt;", b"$stop;"), (b"G2 X1 I1", b"G3 X1 I1"), (b"T1", b"D1"),
]  # fmt: skip


@pytest.mark.parametrize(("one", "two"), CHANGES)
def test_a_change_is_noticed(tmp_path: Path, one: bytes, two: bytes) -> None:
    for around in (b"%s\n", b"G90\n%s\nM08\n"):
        programs = [read(tmp_path, around % text, NO_MCUWIN, name=f"{n}.din") for n, text in enumerate((one, two))]
        assert programs[0] is not None
        assert programs[1] is not None
        assert difference(programs[0], programs[1]) is not None
        assert difference(programs[1], programs[0]) is not None


TRACED = [shop for shop in SHOPS if "codes" not in shop.parts]


@pytest.mark.parametrize("shop", TRACED, ids=lambda path: "/".join(path.parts[-3:]))
@pytest.mark.parametrize("one_in", sizes(10, 1))
def test_the_trace_is_the_same(
    tmp_path: Path, one_in: int, shop: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    jobs = [str(path.relative_to(shop)) for path in files_of(shop) if path.suffix in JOBS][::one_in]
    machine_file = machine_file_of(shop)
    traces = []
    for side in ("as-written", "formatted"):
        root = tmp_path / side
        shutil.copytree(shop if machine_file is None or machine_file.parent == shop else shop.parent, root)
        monkeypatch.chdir(root / (shop.name if machine_file is not None and machine_file.parent != shop else ""))
        machine = ["--dialect", "mcuwin"]
        if machine_file is not None:
            place = Path(machine_file.name) if machine_file.parent == shop else Path("..") / machine_file.name
            machine += ["--machine", str(place)]
        if side == "formatted":
            main(["fmt", *machine, *[path.name for path in files_of(Path())]])
        capsys.readouterr()
        codes = [
            main(["dump", job, "--stage", "trace", "--format", "jsonl", "--setup", "zero", *machine]) for job in jobs
        ]
        traces.append((codes, re.sub(r'"sha256": "[0-9a-f]*"', "", capsys.readouterr().out.replace(str(root), ""))))
    assert traces[0] == traces[1]
