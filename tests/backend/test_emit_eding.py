"""Eding text printed back: the same Program, the same Trace, the same lines; printing twice changes nothing."""

from __future__ import annotations

import dataclasses
import random
import re
import shutil
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from frontend.eding.test_random import random_bytes, random_program
from frontend.eding.test_tolerance import SAME
from support import wild
from support.bundles import unpacked
from support.campaigns import seeds
from support.goldens import ROOT

from gproof.backend.emit.eding.program import emit
from gproof.backend.emit.numbers import number_text
from gproof.cli.main import main
from gproof.frontend.eding.load import load_alone
from gproof.ir.finding import Findings, Refusal, Severity, Span
from gproof.ir.notes import NoteKind
from gproof.ir.program import BlockTable, DeferredBlock, Program
from gproof.ir.rules import DEVICES
from gproof.ir.same import difference
from gproof.ir.text import parse_ir, print_ir

WRONG = ("language-errors-job", "default-macros-macro")
"""Jobs with lines that are mistakes by the manual: the second one machine takes more than it."""
JOBS = sorted((ROOT / "corpus" / "eding").glob("*/*.cnc"))
EXAMPLES = sorted(unpacked("docs/codes").glob("GP*/*.cnc"))
SHARED = sorted(unpacked("tests/differential").glob("*/*.ngc"))


def read(folder: Path, data: bytes, name: str = "job.cnc") -> Program | None:
    """The program in ``data``, or None when it has mistakes."""
    path = folder / name
    path.write_bytes(data)
    findings = Findings()
    program = load_alone(path, findings)
    return None if findings.has(Severity.ERROR) else program


def printed(program: Program) -> bytes:
    return b"".join(emit(program))


def formatted(folder: Path, data: bytes) -> bytes | None:
    """``data`` in its printed form, after every property that holds for all; None when it has mistakes."""
    program = read(folder, data)
    if program is None:
        return None
    try:
        text = printed(program)
        again = read(folder, text, "again.cnc")
        assert again is not None, "the printed text has mistakes"
        assert difference(program, again) is None
        assert comparable(program) == comparable(again)
        assert printed(again) == text, "printing twice changes something"
        assert len(text.splitlines(keepends=True)) == len(data.replace(b"\r\n", b"\n").split(b"\n")) - (
            data.endswith(b"\n") or not data.removeprefix(b"\xef\xbb\xbf")
        ), "another number of lines"
    except Exception:
        print(data)
        raise
    return text


def comparable(program: Program) -> str:
    """The text form without names, columns and byte offsets: a comparison that does not use ``ir/same.py``."""

    def plain(value: Any) -> Any:
        value = value.made() if isinstance(value, DeferredBlock) else value
        if isinstance(value, Span):
            return value.line
        if isinstance(value, BlockTable):
            words, begin, line = [], value.begin, value.first_line
            while line <= value.last_line:
                part, begin, line = program.load(value, begin, line, 5000)
                words += [(row, letter, flags, repr(number)) for row, _, letter, flags, number in part.rows()]
            return value.first_line, value.last_line, words
        if dataclasses.is_dataclass(value):
            return type(value).__name__, [plain(getattr(value, f.name)) for f in dataclasses.fields(value)]
        if isinstance(value, tuple | list):
            return [plain(item) for item in value]
        return repr(value)

    subs = {name: plain(sub) for name, sub in program.subprograms.items()}
    return repr((plain(program.body), subs, program.line_count, notes_of(program)))


def notes_of(program: Program) -> list[tuple[int, int, int, bytes]]:
    found, begin, line = [], 0, 1
    while line <= program.line_count:
        notes, begin, line = program.load_notes(0, begin, line, 5000)
        notes.verify()
        found += [(row, place, kind, text) for row, place, kind, _, text in notes]
    return found


# -- the form


FORM = [
    ("g0x1y2", "G0 X1 Y2"),
    ("  G1   X1.50 Y-.5 z5. F0100", "G1 X1.5 Y-0.5 Z5.0 F100"),
    ("G 0 1 X 1 2 . 5", "G1 X12.5"),
    ("x-0 y-0. z+3", "X-0 Y-0.0 Z3"),
    ("/n0010g0(a)x1(b)", "/N0010 G0 (a) X1 (b)"),
    ("/", "/"),
    ("%  ", "%"),
    (" N 1 2 ; tail \t", "N12 ; tail"),
    (";;;", ";;;"),
    ("X1;no blank", "X1 ;no blank"),
    ("X1     (kept apart)", "X1     (kept apart)"),
    ("x1.000   (kept where it was)", "X1.0     (kept where it was)"),
    ("x1\t;by a tab", "X1      ;by a tab"),
    ("G1X1Y1Z1F1  (no room)", "G1 X1 Y1 Z1 F1 (no room)"),
    ("(msg, hello)", "(msg, hello)"),
    ("g0 (MSG,two) x1", "G0 (MSG,two) X1"),
    ("x[5]y1", "X[5] Y1"),
    ("x[5.]y[1]", "X[5.0] Y[1]"),
    ("X#1Y-#2Z##3", "X#1 Y-#2 Z##3"),
    ("X[#1]Ysin[30]", "X#1 Y[sin[30]]"),
    ("#1=5#2=[3]", "#1 = 5 #2 = 3"),
    ("#1=#[#2+1]", "#1 = #[#2 + 1]"),
    ("#1=SQRT[2]", "#1 = sqrt[2]"),
    ("#1=ATAN[1]/[2]", "#1 = atan[1]/[2]"),
    ("#1=[1+2*3]", "#1 = [1 + 2 * 3]"),
    ("#1=[[1+2]*3]", "#1 = [[1 + 2] * 3]"),
    ("#1=[1-[2-3]]", "#1 = [1 - [2 - 3]]"),
    ("#1=[[1-2]-3]", "#1 = [1 - 2 - 3]"),
    ("#1=[2**[3**2]]", "#1 = [2 ** [3 ** 2]]"),
    ("#1=[1--2]", "#1 = [1 - -2]"),
    ("#1=[-[2]]", "#1 = [-[2]]"),
    ("#1=-[-[#2]]", "#1 = [-[-#2]]"),
    ("#1=[-#2**2]", "#1 = [-#2 ** 2]"),
    ("#1=[[-#2]**2]", "#1 = [[-#2] ** 2]"),
    ("#1=[[#2==1]and[#3==2]]", "#1 = [[#2 == 1] and [#3 == 2]]"),
    ("#1=[#2 band 3==#4]", "#1 = [#2 band 3 == #4]"),
    ("#1=[[#2 band 3]==#4]", "#1 = [[#2 band 3] == #4]"),
    ("#1=[1 MOD 2]", "#1 = [1 mod 2]"),
    ("#1=[.1]", "#1 = 0.1"),
    ("#2=100000000000000000000.5", "#2 = 100000000000000000000.0"),
    ("X0.000000000000000012345678901234567890", "X0.000000000000000012345678901234568"),
    ("X.1234567890123456789", "X0.12345678901234568"),
    ("#1=3x#1#2=4", "#1 = 3 X#1 #2 = 4"),
    ('MSG"a"#1[#2+1]', 'msg "a" #1 [#2 + 1]'),
    ('ErrMsg “say "x"”', 'errmsg “say "x"”'),
    ('dlgmsg "T" name 100 “other” 101', 'dlgmsg "T" "name" 100 "other" 101'),
    ("TCAGuard OFF", "tcaguard off"),
    ("Home X", "home x"),
    ("HomeTandem Y", "hometandem y"),
    ("PrepareTandemHome x", "preparetandemhome x"),
    ("MoveStaveToMaster A", "moveslavetomaster a"),
    ("HomeIsEstop ON", "homeisestop on"),
    ("SP points.txt 1", 'sp "points.txt" 1'),
    ("LogFile “log.txt” #3", 'logfile "log.txt" #3'),
    ("SetLafAngle 2.50", "setlafangle 2.5"),
    ("TanKnife ON -90", "tanknife on -90"),
    ("tanknife off ; up", "tanknife off ; up"),
    ("Tanknife B", "tanknife b"),
    ("Tanknife LO", "tanknife lo"),
    ("ZHCINIT [#1] [10.] 5", "zhcinit #1 10.0 5"),
    ("zhcinit [-1] #2 [1+1]", "zhcinit [-1] #2 [1 + 1]"),
    ("ZhcAddPoint (a)", "zhcaddpoint (a)"),
    ("ZHCS table.txt", 'zhcs "table.txt"'),
    ("%MX = 3", "%mx = 3"),
]


@pytest.mark.parametrize(("line", "becomes"), FORM)
def test_form_of_a_line(tmp_path: Path, line: str, becomes: str) -> None:
    assert formatted(tmp_path, line.encode()) == becomes.encode() + b"\n"


def test_form_of_blocks(tmp_path: Path) -> None:
    text = """
sub  Part ( a hole )
n5 g0x1
; why
IF[#1==2]THEN(so)
g0x1
 ( before else )

else
/ MSG "x" (c)
end  if ; done
while [#1]
While [#2]
(nothing)
EndWhile
 endwhile
endsub
gosub PART
%"""
    expected = """
sub part ( a hole )
  N5 G0 X1
  ; why
  if [#1 == 2] (so)
    G0 X1
    ( before else )

  else
    /msg "x" (c)
  endif ; done
  while [#1]
    while [#2]
      (nothing)
    endwhile
  endwhile
endsub
gosub part
%
"""
    assert (formatted(tmp_path, text.encode()) or b"").decode() == expected


@pytest.mark.parametrize("newline", ["\n", "\r\n"])
def test_ends_of_lines_and_mark_are_kept(tmp_path: Path, newline: str) -> None:
    data = b"\xef\xbb\xbf" + newline.join(["g0x1", "", "#1=2", "if [1]", "; c", "endif", "x3"]).encode()
    expected = b"\xef\xbb\xbf" + newline.join(["G0 X1", "", "#1 = 2", "if [1]", "  ; c", "endif", "X3", ""]).encode()
    assert formatted(tmp_path, data) == expected


def test_an_empty_file_stays_empty(tmp_path: Path) -> None:
    assert formatted(tmp_path, b"") == b""
    assert formatted(tmp_path, b"\n\n") == b"\n\n"
    assert formatted(tmp_path, b"  ") == b"\n"


@pytest.mark.parametrize("encoding", ["utf-8", "cp1252", "latin-1"])
@pytest.mark.parametrize("line", ["x1 (\xe4\xf6)", "#1=1 (\xe4\xf6)", 'msg "\xe4\xf6"', "if [1] ; \xfc", "(MSG, \xdf)"])
def test_bytes_of_texts_are_kept(tmp_path: Path, line: str, encoding: str) -> None:
    raw = line.encode(encoding) if encoding != "latin-1" else line.encode(encoding) + b" (\x81)"
    if line.startswith("if"):
        raw += b"\nendif"
    text = formatted(tmp_path, raw + "\ng0 x1 (ß)".encode())
    assert text is not None
    kept = re.compile(rb"[\x80-\xff]")
    assert kept.findall(text) == kept.findall(raw + "ß".encode())


def test_a_line_that_would_get_another_encoding_stays(tmp_path: Path) -> None:
    """Without its quotes of Windows-1252 the text would be UTF-8."""
    line = b"Msg \x93\xc3\xa4\x94"
    assert formatted(tmp_path, line + b"\n") == line + b"\n"
    assert formatted(tmp_path, b"Msg \x93\xe4\x94\n") == b'msg "\xe4"\n'


@pytest.mark.parametrize("line", ["X.1" * 85, "#1=[1" + "+1" * 120 + "]", "if [1" + "+1" * 120 + "]\nendif"])
def test_a_line_that_would_be_too_long_stays(tmp_path: Path, line: str) -> None:
    data = f"g0 x1\n{line}\ng0x2".encode()
    text = formatted(tmp_path, data)
    assert text is not None
    assert text.split(b"\n")[1] == line.split("\n", maxsplit=1)[0].encode()
    assert text.startswith(b"G0 X1\n")
    assert text.endswith(b"\nG0 X2\n")


def test_numbers_read_back_bit_for_bit() -> None:
    rng = random.Random(5)
    values = [rng.uniform(-1000, 1000) for _ in range(2000)]
    values += [round(rng.uniform(-1000, 1000), rng.randrange(12)) for _ in range(2000)]
    values += [np.ldexp(rng.random(), rng.randrange(-400, 400)) for _ in range(500)]
    values += [0.0, -0.0, 1e15, 1e22, 5e-324, 123456789012345680.0, 0.1 + 0.2]
    for value in map(float, values):
        for point in (False, True):
            text = number_text(value, point)
            assert float(text).hex() == value.hex()
            assert "e" not in text
            assert ("." in text) or not point


@pytest.mark.parametrize("mode", ["python", "numba"])
def test_both_speeds_print_the_shortest_numbers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, mode: str) -> None:
    monkeypatch.setenv("GPROOF_KERNELS", mode)
    rng = random.Random(7)
    values = [round(rng.uniform(-1000, 1000), rng.randrange(16)) for _ in range(3000)]
    values += [rng.uniform(-1, 1) * 10.0 ** rng.randrange(-12, 16) for _ in range(1000)]
    texts = [number_text(value, rng.random() < 0.5) for value in values]
    lines = [f"X{text} (c) Y{text} ; r" for text in texts if len(text) < 60]
    data = ("\n".join(["/N1 " + line for line in lines] + lines) + "\n").encode()
    assert formatted(tmp_path, data) == data


# -- whole programs


@pytest.mark.parametrize("path", JOBS, ids=lambda p: p.parent.name + "-" + p.stem)
def test_corpus(tmp_path: Path, path: Path) -> None:
    data = path.read_bytes()
    assert (formatted(tmp_path, data) is None) == (f"{path.parent.name}-{path.stem}" in WRONG)


def test_examples_of_codes_and_shared_programs(tmp_path: Path) -> None:
    done = [formatted(tmp_path, path.read_bytes()) for path in (*EXAMPLES, *SHARED)]
    assert sum(text is not None for text in done) > 100


SHORT = [p for p in JOBS if p.name == "job.cnc" and p.stat().st_size <= 60_000]
"""Of longer jobs the Programs are compared, above."""


@pytest.mark.parametrize("path", SHORT, ids=lambda p: p.parent.name)
def test_the_trace_is_the_same(
    tmp_path: Path, path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    traces = []
    for side in ("as-written", "formatted"):
        folder = tmp_path / side
        shutil.copytree(path.parent, folder)
        monkeypatch.chdir(folder)
        if side == "formatted":
            main(["fmt", *(str(p.relative_to(folder)) for p in folder.glob("*.cnc"))])
        capsys.readouterr()
        machine = ["--machine", "machine.toml"] if (folder / "machine.toml").is_file() else []
        # A loop until an unknown answer has as many outcomes as one follows, all of the same lines.
        words = ["--stage", "trace", "--setup", "zero", "--max-branches", "64"]
        exit_code = main(["dump", "job.cnc", *words, *machine])
        traces.append((exit_code, capsys.readouterr().out))
    assert traces[0] == traces[1]


def test_the_trace_of_shared_programs_is_the_same(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for path in SHARED[::4]:
        traces = []
        shutil.copy(path, "job.cnc")
        for words in ([], ["fmt", "--dialect", "eding", "job.cnc"]):
            if words:
                main(words)
            capsys.readouterr()
            exit_code = main(["dump", "job.cnc", "--dialect", "eding", "--stage", "trace", "--setup", "zero"])
            traces.append((exit_code, capsys.readouterr().out))
        assert traces[0] == traces[1], path


def test_a_parsed_dump_prints_the_same_text(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for path in JOBS:
        if path.stat().st_size > 30_000:
            continue
        program = read(tmp_path, path.read_bytes())
        if program is None:
            continue
        shutil.copy(path, tmp_path / "job.cnc")
        capsys.readouterr()
        main(["dump", str(tmp_path / "job.cnc"), "--stage", "program"])
        parsed = parse_ir(capsys.readouterr().out)
        assert print_ir(parsed) == print_ir(parse_ir(print_ir(parsed)))
        assert printed(parsed) == printed(program)


# -- anything


@pytest.mark.parametrize("seed", seeds(3, 60))
def test_random_programs(tmp_path: Path, seed: int) -> None:
    rng = random.Random(seed)
    jobs = wild.corpus_jobs()
    for _ in range(25):
        formatted(tmp_path, random_program(rng))
        formatted(tmp_path, wild.wild_program(rng))
        formatted(tmp_path, wild.mutated(rng, jobs))
        formatted(tmp_path, random_bytes(rng))


def test_lines_as_people_write_them(tmp_path: Path) -> None:
    texts = [formatted(tmp_path, line.encode()) for pair in SAME for line in pair]
    assert sum(text is not None for text in texts) > 0.7 * len(texts)  # the rest opens or closes a block


def test_many_lines_with_expressions(tmp_path: Path) -> None:
    """More than a Program keeps as trees."""
    data = b"".join(b"G1 X[#1 + %d] ; c\n" % n for n in range(2500))
    assert formatted(tmp_path, data) == data


def test_random_expressions(tmp_path: Path) -> None:
    rng = random.Random(3)
    maker = wild.Wild(rng)
    maker.wrong = 0.0
    done = 0
    for _ in range(40):
        lines = [f"#1=[{maker.expression()}]" for _ in range(10)]
        good = [line for line in lines if len(line) < 250 and read(tmp_path, line.encode()) is not None]
        done += formatted(tmp_path, "\n".join(good).encode()) is not None
    assert done == 40


def test_random_lines_with_notes(tmp_path: Path) -> None:
    """Comments anywhere between the items of a line, on plain lines and on others."""
    rng = random.Random(11)
    items = ["G1", "x 1.5", "Y[1 + 2]", "#3 = 4", "Z-#2", "F100", "Q[sin[30]]", "#[1+2]=atan[1]/[2]", "H[2]", "m3"]
    notes = ["(a)", "( b ; )", "", "", "", "  ", "\t", "(MSG, m)", "(\xe4)"]
    for _ in range(100):
        lines = []
        for _ in range(8):
            line = rng.choice(["", "/", "N12", "/ n 7"])
            for item in rng.sample(items, rng.randrange(4)):
                line += rng.choice(notes) + rng.choice(notes) + item
            lines.append(line + rng.choice(notes) + rng.choice(["", "; end", "   (c)", "   ;  (d "]))
        assert formatted(tmp_path, "\n".join(lines).encode(rng.choice(["utf-8", "cp1252"]))) is not None


@pytest.mark.soak
@pytest.mark.parametrize("seed", range(100, 120))
def test_soak(tmp_path: Path, seed: int) -> None:
    rng = random.Random(seed)
    jobs = wild.corpus_jobs()
    for _ in range(500):
        formatted(tmp_path, random_program(rng))
        formatted(tmp_path, wild.wild_program(rng))
        formatted(tmp_path, wild.mutated(rng, jobs))


@pytest.mark.parametrize("line", ["errmsg “b” [2+1]", "msg “b”", "dlgmsg “a” “b” 100", "msg “ü” #1", "/msg  “b”  (ü)"])
@pytest.mark.parametrize("around", ["", "if [1]\n{}\nendif\n", "G1 X1 (ü)\n{}\n"])
def test_curly_quotes_of_windows_1252(line: str, around: str, tmp_path: Path) -> None:
    """Without the quotes nothing may be left that says how the line is encoded: it then stays as it is."""
    text = around.format(line) if around else line
    assert formatted(tmp_path, text.encode("cp1252")) is not None
    assert formatted(tmp_path, text.encode("utf-8")) is not None


# -- what can not be printed, and what would differ


def test_nesting_beyond_what_a_program_holds_is_refused(tmp_path: Path) -> None:
    program = read(tmp_path, b"if [1]\n" * 110 + b"endif\n" * 110)
    assert program is not None
    with pytest.raises(Refusal) as refusal:
        printed(program)
    assert refusal.value.finding.code.label == "GP702"


CHANGES = [
    (b"G0 X1", b"G0 X2"),
    (b"G0 X1", b"G0 X1.0"),
    (b"G0 X0", b"G0 X-0"),
    (b"G0 X1", b"/G0 X1"),
    (b"G0 X1 (a)", b"G0 (a) X1"),
    (b"G0 X1 (a)", b"G0 X1 (A)"),
    (b"G0 X1 ;a", b"G0 X1 (a)"),
    (b"N1 X1", b"N01 X1"),
    (b"", b";"),
    (b"%", b""),
    (b"#1 = [1 + 2]", b"#1 = [1 + 2.0]"),
    (b"#1 = [1 and 2 == 3]", b"#1 = [[1 and 2] == 3]"),
    (b"X[1]", b"X1"),
    (b'msg "a"', b'msg "b"'),
    (b"if [1]\nX1\nendif", b"if [1]\nendif\nX1"),
    (b"if [1]\nelse\nendif", b"if [1]\n\nendif"),
    (b"sub a\nendsub", b"sub b\nendsub"),
    (b"G0 X1\n", b"G0 X1\n\n"),
    (b"G0 X1\r\n", b"G0 X1\n"),
]


@pytest.mark.parametrize(("one", "other"), CHANGES)
def test_programs_that_differ_are_told_apart(tmp_path: Path, one: bytes, other: bytes) -> None:
    left, right = read(tmp_path, one + b"\n", "a.cnc"), read(tmp_path, other + b"\n", "b.cnc")
    assert left is not None
    assert right is not None
    assert difference(left, right) is not None
    assert difference(left, left) is None


def test_every_command_has_a_text() -> None:
    from gproof.backend.emit.eding.statements import _DEVICES

    # The manual gives height maps no syntax for these; wait is another controller's.
    unread = {"height_map_load", "height_map_on", "height_map_off", "wait", "own_tool_change"}
    assert set(_DEVICES) == set(DEVICES) - unread


def test_kinds_of_notes_are_those_of_the_kernels() -> None:
    from gproof.backend.emit import plain_lines_kernels
    from gproof.frontend.eding import scan_kernels

    for module in (plain_lines_kernels, scan_kernels):
        for kind in list(NoteKind)[:5]:
            assert getattr(module, kind.name) == kind


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_memory_does_not_grow_with_the_file(tmp_path: Path) -> None:
    """A hundred thousand lines and three hundred thousand take about the same memory."""
    import subprocess

    code = (
        "import sys,resource;from gproof.cli.main import main;main(['fmt',sys.argv[1]]);"
        "print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)"
    )
    peaks = []
    for lines in (100_000, 300_000):
        path = tmp_path / f"{lines}.cnc"
        path.write_text("".join(f"n{n % 99999} g1x{n % 997}.{n % 10}y{n % 89}.5 (row)\n" for n in range(lines)))
        done = subprocess.run([sys.executable, "-c", code, str(path)], capture_output=True, text=True, check=True)
        peaks.append(int(done.stdout.split()[-1]) / 1024 - 2 * path.stat().st_size / 2**20)  # mapped files count
        assert path.read_text().startswith("N0 G1 X0.0 Y0.5 (row)\nN1 G1 X1.1 Y1.5 (row)\n")
    assert peaks[1] - peaks[0] < 20
