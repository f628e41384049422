"""WinCNC text printed back: the same Program, the same Trace, the same lines; printing twice changes nothing."""

from __future__ import annotations

import dataclasses
import random
import shutil
from pathlib import Path
from typing import Any

import pytest
from support.bundles import unpacked
from support.campaigns import share, sizes
from support.goldens import ROOT

from gproof.backend.emit.wincnc.program import emit
from gproof.cli.main import main
from gproof.driver.dialects import load_machine
from gproof.frontend.wincnc.load import load_alone
from gproof.frontend.wincnc.machine import NO_SHOP
from gproof.ir.dialects.wincnc.settings import Lexical, wincnc_settings
from gproof.ir.finding import Findings, Severity, Span
from gproof.ir.machine import Machine
from gproof.ir.program import BlockTable, DeferredBlock, Program
from gproof.ir.same import difference

SHOPS = [
    folder
    for parent in (unpacked("tests/hand") / "wincnc", ROOT / "corpus/wincnc", unpacked("docs/codes"))
    for folder in sorted(parent.iterdir())
    if any(folder.glob("*.tap")) or any(folder.glob("*/*.tap"))
]


def with_lexical(lexical: Lexical) -> Machine:
    return dataclasses.replace(NO_SHOP, settings=dataclasses.replace(wincnc_settings(NO_SHOP), lexical=lexical))


def machine_of(shop: Path) -> Machine:
    path = shop / "WINCNC.INI"
    machine = load_machine(path, Findings())[0] if path.is_file() else NO_SHOP
    assert machine is not None
    return machine


def read(folder: Path, data: bytes, machine: Machine, folders: list[Path], name: str = "job.tap") -> Program | None:
    """The program in ``data``, or None when it has mistakes."""
    path = folder / name
    path.write_bytes(data)
    findings = Findings()
    program = load_alone(path, findings, "job.tap", machine=machine, folders=folders)
    return None if findings.has(Severity.ERROR) else program


def printed(program: Program, machine: Machine = NO_SHOP) -> bytes:
    return b"".join(emit(program, wincnc_settings(machine).lexical))


def formatted(folder: Path, data: bytes, machine: Machine = NO_SHOP, folders: list[Path] | None = None) -> bytes | None:
    """``data`` in its printed form, after every property that holds for all; None when it has mistakes."""
    folders = folders or [folder]
    program = read(folder, data, machine, folders)
    if program is None:
        return None
    program.verify()
    try:
        text = printed(program, machine)
        again = read(folder, text, machine, folders, "again.tap")
        assert again is not None, "the printed text has mistakes"
        assert difference(program, again) is None
        assert comparable(program) == comparable(again)
        assert printed(again, machine) == text, "printing twice changes something"
        lines = len(data.replace(b"\r\n", b"\n").split(b"\n"))
        assert len(text.split(b"\n")) - 1 == lines - (data.endswith(b"\n") or not data.removeprefix(b"\xef\xbb\xbf"))
    except Exception:
        print(data)
        raise
    return text


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
            return value.first_line, value.last_line, words
        if dataclasses.is_dataclass(value):
            names = [f.name for f in dataclasses.fields(value) if f.compare]
            if getattr(value, "line", None) is not None:
                names = [name for name in names if name != "written"]
            return type(value).__name__, [plain(getattr(value, name)) for name in names]
        if isinstance(value, tuple | list):
            return [plain(item) for item in value]
        return repr(value)

    return repr((plain(program.body), program.line_count, notes_of(program)))


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
    ("g0x1y2", "G0 X1 Y2"),
    ("  G01   X1.50 Y-.5 z5. F0100", "G1 X1.5 Y-0.5 Z5.0 F100"),
    ("G 1 X+12.5", "G1 X12.5"),
    ("G+1x-0y-0.", "G1 X-0 Y-0.0"),
    ("g92xy", "G92 X Y"),
    ("X Y", "X Y"),
    ("G0X{5}Y{ TH1 + 2. }Z{q*-.5}", "G0 X{5} Y{TH1+2.0} Z{Q*-0.5}"),
    ("G0 X{tp1}", "G0 X{TP1}"),
    ("~g28x y", "~G28 X Y"),
    ("~ G28 X", "~G28 X"),
    ("l91 g1 x.25", "L91 G1 X0.25"),
    ("m11c2", "M11 C2"),
    ("M17.10C1", "M17.1 C1"),
    ('g5t1m"Clamp [left]  shut?"', 'G5 T1 M"Clamp [left]  shut?"'),
    ("G5 M“shut?”", 'G5 M"shut?"'),
    ('g5 t2 m"a" m"b"', 'G5 T2 M"a" M"b"'),
    ("m98 Texas.tap", "M98 Texas.tap"),
    ("M98  part.tap  x.5 t{t}", "M98 part.tap X0.5 T{T}"),
    ('M98.1 "my part.tap"x1', 'M98.1 "my part.tap" X1'),
    ("L41  copy  a.txt b", "L41 copy  a.txt b"),
    ("L10 r1 c4 x6 y0", "L10 R1 C4 X6 Y0"),
    ("L010", "L10"),
    ("%", "%"),
    ("  [a]  (b)  % rest \t", "[a] (b) % rest"),
    ("[ a ](b)", "[ a ] (b)"),
    ("X1[no blank", "X1 [no blank"),
    ("X1     [kept apart]", "X1     [kept apart]"),
    ("x1.000   [kept where it was]", "X1.0     [kept where it was]"),
    ("m11 c2\t[by a tab]", "M11 C2  [by a tab]"),
    ("X.1234567890123456789", "X0.12345678901234568"),
    # What only a macro of some machine can mean stays as it is.
    ("m06t1", "m06t1"),
    ("m06t1  [tool]", "m06t1  [tool]"),
    ("Park", "Park"),
    ("xy [park?]", "xy [park?]"),
    ("n10 g0x1", "n10 g0x1"),
    # Read by nobody.
    ("X1 [a] Y2", "X1 [a] Y2"),
    ("  x1 [a]y2 ", "  x1 [a]y2"),
]


@pytest.mark.parametrize(("line", "becomes"), FORM)
def test_form_of_a_line(tmp_path: Path, line: str, becomes: str) -> None:
    assert formatted(tmp_path, line.encode()) == becomes.encode() + b"\n"


def files_of(shop: Path) -> list[Path]:
    paths = sorted(path for path in shop.rglob("*") if path.suffix.lower() in (".tap", ".mac"))
    return [path for path in paths if path.name != "CNC.MAC"]


@pytest.mark.parametrize("shop", share(SHOPS, 4), ids=lambda path: path.name)
def test_files_of_shops(tmp_path: Path, shop: Path) -> None:
    machine = machine_of(shop)
    for path in files_of(shop):
        program = load_alone(path, findings := Findings(), machine=machine, folders=[shop, path.parent])
        text = formatted(tmp_path, path.read_bytes(), machine, [shop, path.parent])
        assert (text is None) == findings.has(Severity.ERROR), path
        assert program is not None, path


# -- lines that depend on the machine


def test_signs_of_the_machine(tmp_path: Path) -> None:
    machine = with_lexical(Lexical(comment_signs=";'", comma=True))
    data = b"g0x1,5y-,25 ; a\n' b\nL91 X{q*.5} 'c\nX1 [d] ;e\n"
    expected = b"G0 X1.5 Y-0.25 ; a\n' b\nL91 X{Q*0.5} 'c\nX1 [d] ;e\n"
    assert formatted(tmp_path, data, machine) == expected


def test_lines_that_are_left_out_stay(tmp_path: Path) -> None:
    machine = with_lexical(Lexical(skips=(("#%", 3),)))
    data = b"g0x1\n#one two \n  g0   x 2 [a\n?!\ng0x3\n% a\nx\n\ny\n # no sign\n"
    assert formatted(tmp_path, data, machine) is None  # the last line: no command
    text = data.replace(b" # no sign\n", b"  % no sign\n  [a]\n#")
    expected = b"G0 X1\n#one two\n  g0   x 2 [a\n?!\nG0 X3\n% a\nx\n\nY\n  % no sign\n[a]\n#\n"
    assert formatted(tmp_path, text, machine) == expected


def test_left_out_lines_over_the_ends_of_pieces(tmp_path: Path) -> None:
    machine = with_lexical(Lexical(skips=(("#", 50),)))
    block = b"#\n" + b"  not read\n" * 49 + b"g0x1 [a\n" * 20
    text = formatted(tmp_path, block * 50, machine)
    assert text == (b"#\n" + b"  not read\n" * 49 + b"G0 X1 [a\n" * 20) * 50


MACROS = b"""M3=M98 SPIN.MAC
M03.1=M11C1
M6=M98 CHANGE.MAC
M2=[
PARK=G53 Z0
ASK=G5 T3 M
RUN=L41 copy
G28=M98 HOME.MAC
"""


def test_lines_that_macros_replace(tmp_path: Path) -> None:
    (tmp_path / "CNC.MAC").write_bytes(MACROS)
    data = b'm03\nm6t1  [tool]\nm2x\npark\nask "go on?"\ng0x1\nrun  a  b\n~g28xy\ng28 x\nxy\n'
    expected = b'm03\nm6 T1 [tool]\nm2 X\npark\nask "go on?"\nG0 X1\nrun a  b\n~G28 X Y\ng28 X\nX Y\n'
    assert formatted(tmp_path, data) == expected


@pytest.mark.parametrize("newline", ["\n", "\r\n"])
def test_ends_of_lines_and_mark_are_kept(tmp_path: Path, newline: str) -> None:
    data = b"\xef\xbb\xbf" + newline.join(["g0x1", "", "m11c1", "[c", "x3"]).encode()
    expected = b"\xef\xbb\xbf" + newline.join(["G0 X1", "", "M11 C1", "[c", "X3", ""]).encode()
    assert formatted(tmp_path, data) == expected


def test_files_of_nothing(tmp_path: Path) -> None:
    assert formatted(tmp_path, b"") == b""
    assert formatted(tmp_path, b"\n\n") == b"\n\n"
    assert formatted(tmp_path, b"  ") == b"\n"


@pytest.mark.parametrize("raw", [
    b'g5 m"\xfcber"', b"g5 m\x93\xfcber\x94", b"x1[\xe4", b"m11c1 [\xe4\x81]", "g5 m“ß” [ß]".encode(), "% ü".encode(),
    b"g5 m\x93\xc3\xa4\x94",
])  # fmt: skip
def test_bytes_of_texts_are_kept(tmp_path: Path, raw: bytes) -> None:
    text = formatted(tmp_path, raw)
    assert text is not None
    quotes = (b"\x93", b"\x94", "“".encode(), "”".encode())
    for quote in quotes:
        raw, text = raw.replace(quote, b""), text.replace(quote, b"")
    assert [c for c in text if c > 127] == [c for c in raw if c > 127]


@pytest.mark.parametrize("line", ["X.1" * 80, "M11 C{TP1*.1}" + "[" + "c" * 242, "M11" + "[ä" + "ä" * 130])
def test_a_line_that_would_be_too_long_stays(tmp_path: Path, line: str) -> None:
    text = formatted(tmp_path, f"g0x1\n{line}\ng0x2\n".encode())
    assert text == f"G0 X1\n{line}\nG0 X2\n".encode()


def test_conditions_and_arrays(tmp_path: Path) -> None:
    data = b"""l112t0
m98 put.mac
m17.1 c3[a
M18.1D0C4
g0x1
L111 t2

L113 v1 l0 h2
l10 r2 c1 x0 y1
M17.1 C1
G7 X1 [no such code]
l10
l10
m18.2 c1
"""
    expected = b"""L112 T0
M98 put.mac
M17.1 C3 [a
M18.1 D0 C4
G0 X1
L111 T2

L113 V1 L0 H2
L10 R2 C1 X0 Y1
M17.1 C1
G7 X1 [no such code]
L10
L10
M18.2 C1
"""
    assert formatted(tmp_path, data) == expected


# -- anything


def random_line(rng: random.Random) -> str:
    """A line of WinCNC, mostly right, in some spelling."""

    def number() -> str:
        texts = ["0", "1", "12.5", ".25", "-3", "-.5", "+4", "007", "5.", "-0", "100000.000100", "0.1234567890123"]
        return rng.choice(["", " "]) + rng.choice(texts)

    def value(letter: str) -> str:
        kind = rng.random()
        if kind < 0.15:
            return letter
        if kind < 0.3:
            inside = rng.choice(["t", "TP1", " th2 + 1", "q*-2.5", "5", "-1-2", "x/3."])
            return f"{letter}{rng.choice(['', ' '])}{{{inside}}}"
        return letter + number()

    def words(letters: str) -> list[str]:
        return [value(letter) for letter in rng.sample(letters, rng.randint(0, min(4, len(letters))))]

    def of(code: str, letters: str) -> list[str]:
        return [rng.choice(["", "", "", "~", "L91", "G90"]), code, *words(letters)]

    kinds = [
        lambda: words("XYZWUVABCIJKRF"),
        lambda: [rng.choice(["G0", "G01", "G 2", "G+3", "G000"]), *words("XYZIJKRF")],
        lambda: of(rng.choice(["G4", "G28", "G53", "G81", "G92.1", "G92.10", "L5", "L210", "M37", "L22"]), "XYZRHTPF"),
        lambda: of(rng.choice(["M11", "M012", "M13", "M17", "L60", "L110"]), "CDT"),
        lambda: ["m98", rng.choice(["part.tap", "PART.TAP", '"my part.tap"', "sub\\a.tap"]), *words("XYZT")],
        lambda: [rng.choice(["M17.1", "M18.4", "L112", "L111"]), "C1", "T2"[: 2 * (rng.random() < 0.8)]],
        lambda: ["G5", rng.choice(["", "T1", "t3", "T4"]), rng.choice(['m"Go [on]?"', "M“x”", 'M ""', ""])],
        lambda: [rng.choice(["L41", "L201", "L400"]), rng.choice(["copy  a b", '"x" y', "", "a{b"])],
        lambda: [rng.choice(["L10", "l10 r2 c1", "L10 R1 C4 X6 Y0 E1"])],
        lambda: [rng.choice(["M3", "m06t1", "park", "S5000", "xy", "N10 X1", "M2", "ask", "back 1", "#", "T1"])],
        list,
    ]  # fmt: skip
    parts = [part for part in rng.choice(kinds)() if part]
    line = rng.choice(["", " "]).join(parts) if rng.random() < 0.5 else "  ".join(parts)
    line = rng.choice([line, line.lower(), "  " + line, line + "\t "])
    for _ in range(rng.choice([0, 0, 1, 2])):
        line += rng.choice(["", " ", "     ", "\t"])
        line += rng.choice(["[a]", "(b c)", "[open", "% rest ", "(", "[]", ";x", "' y", "[ä]", "(a[b)", "%%"])
    return line


LEXICALS = [Lexical(), Lexical(comment_signs=";'", comma=True), Lexical(skips=(("#%", 3), ("T", 2)))]


@pytest.mark.parametrize("macros", [False, True], ids=["no-macros", "macros"])
@pytest.mark.parametrize("programs", sizes(6, 120))
@pytest.mark.parametrize("seed", range(4))
def test_random_programs(tmp_path: Path, seed: int, macros: bool, programs: int) -> None:
    rng = random.Random(seed)
    if macros:
        (tmp_path / "CNC.MAC").write_bytes(MACROS + b"BACK=G0 X0\n")
    done = 0
    for _ in range(programs):
        machine = with_lexical(rng.choice(LEXICALS))
        good = []
        for _ in range(30):
            line = random_line(rng)
            if read(tmp_path, line.encode() + b"\nG0 X1\n", machine, [tmp_path]) is not None:
                good.append(line)
        data = rng.choice(["\n", "\r\n"]).join(good).encode(rng.choice(["utf-8", "utf-8", "cp1252"]))
        done += formatted(tmp_path, data, machine) is not None
    assert done > 0.6 * programs


@pytest.mark.parametrize("seed", range(3))
def test_random_bytes(tmp_path: Path, seed: int) -> None:
    rng = random.Random(seed)
    alphabet = b'GLMXYZCT0123.-+{}[]()%~"# \t\r\n\n\xe4\x93\x07;\xa0'
    for _ in range(150):
        data = bytes(rng.choice(alphabet) for _ in range(rng.randint(1, 60)))
        formatted(tmp_path, data, with_lexical(rng.choice(LEXICALS)))


@pytest.mark.parametrize("seed", range(3))
def test_both_speeds_print_the_same_bytes(tmp_path: Path, seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    rng = random.Random(seed)
    machine = with_lexical(LEXICALS[seed])
    good = []
    while len(good) < 300:
        line = random_line(rng)
        if read(tmp_path, line.encode() + b"\nG0 X1\n", machine, [tmp_path]) is not None:
            good.append(line)
    texts = []
    for mode in ("python", "numba"):
        monkeypatch.setenv("GPROOF_KERNELS", mode)
        texts.append(formatted(tmp_path, "\n".join(good).encode(), machine))
    assert texts[0] == texts[1] is not None


# -- what must be noticed

CHANGES = [
    (b"G0 X1", b"G0 X1.0"), (b"G0 X1", b"G0 X2"), (b"G0 X1", b"G1 X1"), (b"G0 X1", b"G0 X{1}"), (b"X0", b"X"),
    (b"X-0", b"X0"), (b"M11 C1", b"M12 C1"), (b"M11 C1", b"M11 C"), (b"~G28 X", b"G28 X"), (b"G28 X Y", b"G28 Y X"),
    (b"M98 A.TAP X1", b"M98 A.TAP X2"), (b"M98 A.TAP", b"M98 a.tap"), (b"M98 A.TAP", b"M98.1 A.TAP"),
    (b'G5 M"a"', b'G5 T0 M"a"'), (b'G5 M"a"', b'G5 M"b"'), (b"L10 R2 C1", b"L10 C1 R2"), (b"L41 a b", b"L41 a  b"),
    (b"M17.1 C1\nX1", b"M18.1 C1\nX1"), (b"L112 T1\nX1", b"L112 T{TP1}\nX1"), (b"L10", b""), (b"X1 [a]", b"X1 [a"),
    (b"X1 [a]", b"X1 (a)"), (b"X1 [a]", b"X1"), (b"[a]", b"[b]"), (b"%", b""), (b"X{TP1+1}", b"X{TP1-1}"),
    (b"G0 X1", b"X1\nG0"),
]  # fmt: skip


@pytest.mark.parametrize(("one", "two"), CHANGES)
def test_a_change_is_noticed(tmp_path: Path, one: bytes, two: bytes) -> None:
    for around in (b"%s\n", b"G0 Y1\n%s\nM11 C2\n"):
        programs = [read(tmp_path, around % text, NO_SHOP, [tmp_path], f"{n}.tap") for n, text in enumerate((one, two))]
        assert programs[0] is not None
        assert programs[1] is not None
        assert difference(programs[0], programs[1]) is not None
        assert difference(programs[1], programs[0]) is not None


@pytest.mark.parametrize("shop", share(SHOPS, 9), ids=lambda path: path.name)
def test_the_trace_is_the_same(
    tmp_path: Path, shop: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    jobs = [str(path.relative_to(shop)) for path in files_of(shop) if path.stat().st_size < 4000][:12]
    traces = []
    for side in ("as-written", "formatted"):
        folder = tmp_path / side
        shutil.copytree(shop, folder)
        monkeypatch.chdir(folder)
        machine = ["--dialect", "wincnc", *(["--machine", "WINCNC.INI"] if Path("WINCNC.INI").is_file() else [])]
        if side == "formatted":
            main(["fmt", *machine, *jobs])
        capsys.readouterr()
        codes = [
            main(["dump", job, "--stage", "trace", "--format", "jsonl", "--setup", "zero", *machine]) for job in jobs
        ]
        traces.append((codes, capsys.readouterr().out))
    assert traces[0] == traces[1]
