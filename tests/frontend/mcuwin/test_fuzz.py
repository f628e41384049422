"""Whatever a McuWIN file holds ends in a Program or in findings with places; nothing else is ever raised."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from frontend.mcuwin.mcuwin_programs import OLD, load, machine
from hypothesis import example, given
from hypothesis import strategies as st
from support.bundles import unpacked
from support.campaigns import examples, seeds

from gproof.frontend.mcuwin.load import load_program
from gproof.ir.finding import Findings, Severity
from gproof.ir.machine import Machine
from gproof.ir.program import Program

ROOT = Path(__file__).resolve().parents[3]
PROGRAMS = sorted(
    path
    for folder in (unpacked("tests/hand") / "mcuwin", unpacked("docs/codes"), ROOT / "corpus/mcuwin")
    for path in folder.glob("**/*")
    if path.suffix.lower() in (".din", ".src", ".inc")
)
MACHINES = [machine(), machine(case_sensitive=True, line_numbers=True), machine(keeps_over_codes=True), OLD]
LINES = [line for path in PROGRAMS for line in path.read_bytes().decode("cp1252").splitlines() if line.strip()]
WHOLE_LINE = {"GP118", "GP120", "GP146", "GP147"}
"""Findings about a file, which have no columns."""


def check(program: Program | None, findings: Findings, text: str) -> None:
    """The program holds together, and each finding of a line says where in the line."""
    if program is not None:
        program.verify()
    sources = {source.name: source for source in program.files} if program is not None else {}
    for finding in findings.kept:
        span = finding.span
        source = sources.get(span.file)
        if source is None or not span.line:
            continue
        assert 1 <= span.line <= max(source.line_count, 1), (text, finding)
        if finding.code.label in WHOLE_LINE or (finding.code.label == "GP141" and not span.column):
            continue
        lines = source.data.split(b"\n")
        width = len(lines[span.line - 1]) + 2
        assert 1 <= span.column < span.end_column <= width + 1, (text, finding)


PIECES = st.sampled_from(
    [
        "G0", "G1 ", "G04", "G90", "M3", "M17", "M30", "M96", "M98", " L5", "L", "O2", "%", "%7", "%UP", "N10 ",
        "X", "Y1", "CD600", "CI601", ":=", "step", "(", ")", "((", "'", "//", "{", "}", "{$DINSTART}",
        "$DINEND", "$", "$if ", "$while ", "$repeat begin", "$for CI600:=1 to 3 do begin", "then begin",
        "do begin", "$end", "$end else begin", "$end else if (true) begin", "$until (true)", "$else begin",
        "$I ", "$I job.din", "var ", "const ", "procedure p;", "begin", "end;", ": integer;", "X.tp",
        "X.digib.5", "X.", "1.5", "-", "+", "*", "/", "div", "=", "<>", ",", ";", "WRITE ", "WRITELN", '"',
        '"a"', "sin(", "BOOLEAN(", "\n", "\n", "\n", "\r", "\r\n", "\t", " ", "\x1a", "é",
    ]
)  # fmt: skip


@examples(150, 4000)
@given(st.lists(PIECES, max_size=25), st.sampled_from(MACHINES), st.booleans())
@example(["$if ", "(", "\n", "$end else if (true) begin", "\n", "$end"], MACHINES[0], True)
@example(["var ", "step", "{", "\n", "%7", "\n", "}", "%7"], MACHINES[0], True)
@example(["var ", "\n", "\r", "G0", "\n", "procedure p;"], MACHINES[0], True)
def test_pieces(tmp_path_factory: pytest.TempPathFactory, pieces: list[str], on: Machine, tables: bool) -> None:
    folder = tmp_path_factory.getbasetemp()
    text = "".join(pieces)
    check(*load(folder, text, on, tables=tables), text)


@examples(100, 1600)
@given(st.binary(max_size=60), st.sampled_from(MACHINES))
def test_bytes(tmp_path_factory: pytest.TempPathFactory, data: bytes, on: Machine) -> None:
    program, findings = load(tmp_path_factory.getbasetemp(), data, on)
    check(program, findings, repr(data))


def mutated(random_: random.Random, text: str) -> str:
    at = random_.randrange(len(text) + 1)
    way = random_.randrange(4)
    if way == 0:
        return text[:at]
    if way == 1:
        return text[:at] + text[at + 1 :]
    if way == 2:
        return text[:at] + random_.choice("()'%$NXGML0.;:=*\"{}/ \tö") + text[at:]
    other = random_.choice(LINES)
    return text[:at] + other[random_.randrange(len(other)) :]


@pytest.mark.parametrize("seed", seeds(3, 8))
def test_lines_of_real_programs_with_a_mistake(tmp_path: Path, seed: int) -> None:
    random_ = random.Random(seed)
    for _ in range(150):
        text = "var step, x : double; i : integer;\n%1\n" + mutated(random_, random_.choice(LINES)) + "\nM30\n%\n"
        on = random_.choice(MACHINES)
        check(*load(tmp_path, text, on), text)


@pytest.mark.parametrize("seed", seeds(3, 6))
def test_real_programs_with_mistakes(tmp_path: Path, seed: int) -> None:
    random_ = random.Random(100 + seed)
    for _ in range(40):
        text = random_.choice(PROGRAMS).read_bytes().decode("cp1252")
        for _ in range(random_.randint(1, 4)):
            text = mutated(random_, text)
        (tmp_path / "job.din").write_bytes(text.encode("utf-8"))
        findings = Findings()
        check(load_program(tmp_path / "job.din", findings, random_.choice(MACHINES), None), findings, text)


def test_deep_and_long_lines(tmp_path: Path) -> None:
    for text in (
        "G0 X" + "(" * 5000 + "1" + ")" * 5000,
        "G0 X" + "1+" * 5000 + "1",
        "G0 X" + "-" * 5000 + "1",
        "$if " + "(" * 3000 + "true" + ")" * 3000 + " then begin\n$end",
        "$if (true) then begin\n" * 3000 + "$end\n" * 3000,
        "$if (CI600 = 1) then begin\n" + "$end else if (CI600 = 1) begin\n" * 3000 + "$end\n",
        "(" * 20000,
        "L1\n" * 3000,
        "M96 L1\n" * 3000,
        "%1\nM17\n" * 3000,
        "{" * 5000,
        "G0 " + "X1 " * 5000,
        "N" + "1" * 5000 + " G0 X" + "9" * 5000,
        "G" + "1" * 5000,
        "M96 L" + "1" * 5000,
        "CD" + "1" * 5000 + " := 1",
        "WRITE " + '"a" ' * 5000,
    ):
        program, findings = load(tmp_path, text + "\nM30\n")
        check(program, findings, text[:80])


def test_truncated_anywhere(tmp_path: Path) -> None:
    """Each beginning of a program with everything in it: an error, or a program that ends where it may."""
    text = (
        "var step : double;\n%MAIN (name)\nN1 G90 G00 X(CD600 - 1) Y-2.5 'note\nstep := 0.5 * sin(step)\n"
        "$for CI600 := 1 to 3 do begin // again\nM98 L7 O2\n$if (CI600 = 2) then begin\nG04 CD601\n$end else begin\n"
        'WRITELN "at" X.tp\n$end\n$end;\nM96 L9\nL9 M30\n%\n%7\nM17\n%\n'
    )
    for end in range(len(text)):
        program, findings = load(tmp_path, text[:end])
        check(program, findings, text[:end])
        judged = [f for f in findings.kept if f.severity in (Severity.ERROR, Severity.UNKNOWN)]
        assert judged or text[:end].rstrip("\n% ").endswith(("M30", "M17")), text[:end]
