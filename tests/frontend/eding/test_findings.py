"""Every finding of the frontend: code, exact columns, and what is still read behind it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from frontend.eding.programs import load, program_of, shown
from support.each import each

from gproof.frontend.eding.load import load_program
from gproof.ir.finding import Findings
from gproof.ir.text import parse_ir, print_ir

CASES = [
    # GP101 syntax
    ("G0 X10 ? Y20", "GP101", 8, 9),
    ("5 g0", "GP101", 1, 2),
    ("G1 [3]", "GP101", 4, 5),
    ("G1 X1)", "GP101", 6, 7),
    ("G1 / X1", "GP101", 4, 5),
    ("% 12", "GP101", 1, 2),
    ("G1 X1 %", "GP101", 7, 8),
    ('G1 "a"', "GP101", 4, 5),
    ("O100", "GP101", 1, 2),
    ("G1 U5", "GP101", 4, 5),
    ("fo bar", "GP101", 1, 3),
    ("#1", "GP101", 3, 4),
    ("#1=2=3", "GP101", 5, 6),
    ("sub", "GP101", 4, 5),
    ("gosub ; nobody", "GP101", 6, 7),
    ("msg hello", "GP101", 5, 6),
    ('msg "a', "GP101", 5, 7),
    ("msg “a", "GP101", 5, 7),
    ("tcaguard maybe", "GP101", 10, 11),
    ("tcaguard", "GP101", 9, 10),
    ("home", "GP101", 5, 6),
    ("home q", "GP101", 6, 7),
    ("home x y", "GP101", 8, 9),
    ("hometandem xy", "GP101", 12, 13),
    ("homeisestop maybe", "GP101", 13, 14),
    ("setlafangle", "GP101", 12, 13),
    ("tanknife", "GP101", 9, 10),
    ("tanknife x", "GP101", 10, 11),
    ("tanknife on 45", "GP101", 13, 15),
    ("tanknife off 90", "GP101", 14, 16),
    ("zhcinit 1 2", "GP101", 12, 13),
    ("zhcinit 1 -2 3", "GP101", 11, 12),
    ("zhcaddpoint 1", "GP101", 13, 14),
    ("zhcs", "GP101", 5, 6),
    ("sp ", "GP101", 3, 4),
    ("%mx", "GP101", 1, 2),
    ("%mx=", "GP101", 5, 6),
    ("%mx=#1", "GP101", 5, 6),
    ("%nx=3", "GP101", 1, 2),
    ('dlgmsg "a" b', "GP101", 13, 14),
    ('dlgmsg "a" b -1', "GP101", 14, 16),
    ('dlgmsg "a" b 1.5', "GP101", 14, 17),
    ("G1 X1 é", "GP101", 7, 8),
    ("ſ1", "GP101", 1, 2),
    ("X1\u00a0Y1", "GP101", 3, 4),
    ("X1 \x07", "GP101", 4, 5),
    ("X1\rY2", "GP101", 3, 4),
    ("(é) ?", "GP101", 5, 6),
    # GP102 bad-number
    ("G0 X1.2.3 Y4", "GP102", 5, 10),
    ("G0 X1. 2 .3", "GP102", 5, 12),
    ("x.", "GP102", 2, 3),
    ("x-", "GP102", 2, 3),
    ("x- y1", "GP102", 2, 3),
    ("x--3", "GP102", 2, 5),
    ("x-3.4.", "GP102", 2, 7),
    ("x#-", "GP102", 3, 4),
    ("#2=-", "GP102", 4, 5),
    ("x[1 + 2.3.4]", "GP102", 7, 12),
    # GP103, GP104 comments
    ("G1 X1 (open", "GP103", 7, 12),
    ("(open", "GP103", 1, 6),
    ("if [1] (open", "GP103", 8, 13),
    ("G1 (a (b) c)", "GP104", 7, 8),
    ("(MSG, a (b)", "GP104", 9, 10),
    # GP105 bad-line-number
    ("N G1", "GP105", 1, 2),
    ("N123456 G1", "GP105", 1, 8),
    ("N-5 G1", "GP105", 1, 4),
    ("N10.5 G1", "GP105", 1, 6),
    ("N#1 G1", "GP105", 1, 2),
    ("G1 N10", "GP105", 4, 7),
    ("G1 N", "GP105", 4, 5),
    ("(c) N10", "GP105", 5, 8),
    ("N10 N20", "GP105", 5, 8),
    ("N123456 msg", "GP105", 1, 8),
    # GP106 line-too-long
    ("G1 X1" + " " * 252, "GP106", 257, 258),
    ("(" + "c" * 298 + ")", "GP106", 257, 301),
    # GP107 bad-expression
    ("x[1+", "GP107", 2, 3),
    ("x[1+[2]", "GP107", 2, 3),
    ("x[1 + [2", "GP107", 7, 8),
    ("x[]", "GP107", 3, 4),
    ("x[1+]", "GP107", 5, 6),
    ("x[1 mod]", "GP107", 8, 9),
    ("x[* 2]", "GP107", 3, 4),
    ("x[1 #2]", "GP107", 5, 6),
    ("x[#1 = 2]", "GP107", 6, 7),
    ("x[foo[1]]", "GP107", 3, 6),
    ("x foo[1]", "GP107", 3, 6),
    ("x[1 + foo]", "GP107", 7, 10),
    ("x sin 30", "GP107", 3, 6),
    ("x[sin 30]", "GP107", 3, 6),
    ("x atan[1]", "GP107", 10, 11),
    ("x[atan[1]/2]", "GP107", 11, 12),
    ("x[atan[1]*[2]]", "GP107", 10, 11),
    ("x[1]]", "GP107", 5, 6),
    ("x1+2", "GP107", 3, 4),
    ("#1=#2 mod 3", "GP107", 7, 10),
    ("x1 mod 2", "GP107", 4, 7),
    ("x1 band #2", "GP107", 4, 8),
    ("x[1] xor 2", "GP107", 6, 9),
    ("x#", "GP107", 2, 3),
    ("#=3", "GP107", 1, 2),
    ("#1=", "GP107", 1, 4),
    ("if #1 == 2", "GP107", 4, 5),
    ("while", "GP107", 6, 7),
    ("if [#1", "GP107", 4, 5),
    ('msg "a" [1', "GP107", 9, 10),
    # GP108 missing-value
    ("G1 X Y2", "GP108", 4, 5),
    ("G1 X", "GP108", 4, 5),
    ("G1 X (1)", "GP108", 4, 5),
    ("XY", "GP108", 1, 2),
    ("x=3", "GP108", 1, 2),
    ("x1 f", "GP108", 4, 5),
    # GP122 flow-word-misplaced
    ("G1 X1 endif", "GP122", 7, 12),
    ("if [1] G0 X1", "GP122", 8, 13),
    ("while [1] do", "GP122", 11, 13),
    ("gosub a b", "GP122", 9, 10),
    ("/if [1]", "GP122", 1, 2),
    ("then", "GP122", 1, 5),
    ("x1 gosub a", "GP122", 4, 9),
    # GP124 undecodable-name
    ("sub 12", "GP124", 5, 7),
    ("gosub a-b", "GP124", 7, 10),
    ("gosub läng", "GP124", 7, 11),
]  # fmt: skip

ENDS = {"if": "endif\n", "while": "endwhile\n", "sub": "endsub\n"}


@each("line,code,column,end", CASES)
def test_one_finding_at_its_columns_and_the_next_line_is_read(
    tmp_path: Path, line: str, code: str, column: int, end: int
) -> None:
    word = line.strip("/").split(" ")[0].split("[")[0]
    close = ENDS.get(word, "endif\n" if line == "then" else "")
    before = "if [1]\n" if line.endswith("endif") else ""
    if line == "then":
        close = ""
    program, findings = load(tmp_path, f"{before}{line}\n{close}g0 x1 (good)\nx#1\n")
    first = 1 + bool(before)
    assert shown(findings) == [(code, first, column, end)]
    assert program is not None
    program.verify()
    statements = [*program.body]
    assert len(statements) >= 2  # the table and the block behind the bad line


@each("line,code,column,end", CASES)
def test_blanks_before_a_line_move_its_columns(tmp_path: Path, line: str, code: str, column: int, end: int) -> None:
    if code == "GP106":
        return
    _, findings = load(tmp_path, f"\t {line}")
    assert ("GP114" not in code, shown(findings)[0]) == (True, (code, 1, column + 2, end + 2))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("#1=0\nx1\nendwhile\n", [("GP114", 3, 1, 9)]),
        ("endif", [("GP114", 1, 1, 6)]),
        ("  end sub\n", [("GP114", 1, 3, 10)]),
        ("else\n", [("GP114", 1, 1, 5)]),
        ("if [1]\nx1", [("GP114", 1, 1, 7)]),
        ("while [#1] (c)\nx1\n", [("GP114", 1, 1, 11)]),
        ("sub a\nx1\n", [("GP114", 1, 1, 6)]),
        ("if [1]\nelse\nelse\nendif\n", [("GP114", 3, 1, 5)]),
        ("if [1]\nendwhile\nendif\n", [("GP114", 2, 1, 9)]),
        ("while [1]\nif [2]\nendwhile\n", [("GP114", 2, 1, 7)]),
        ("sub a\nif [2]\nendsub\n", [("GP114", 2, 1, 7)]),
        ("sub a\nsub b\nendsub\n", [("GP114", 1, 1, 6)]),
        ("if [1]\nsub b\nendsub\nendif\n", [("GP114", 1, 1, 7), ("GP114", 4, 1, 6)]),
        ("while [1]\nelse\nendwhile\n", [("GP114", 2, 1, 5)]),
        ("gosub nobody\n", [("GP115", 1, 1, 13)]),
        ("sub a\ngosub nobody\nendsub\n", [("GP115", 2, 1, 13)]),
        ("N5 gosub nobody\nx1\ngosub Nobody (c)\n", [("GP115", 1, 4, 16), ("GP115", 3, 1, 13)]),
        ("sub a\nendsub\nsub A\nendsub\ngosub a\n", [("GP116", 3, 1, 6)]),
    ],
)
def test_structure_findings(tmp_path: Path, text: str, expected: list[tuple[str, int, int, int]]) -> None:
    program, findings = load(tmp_path, text)
    assert shown(findings) == expected
    assert program is not None
    program.verify()


def test_a_duplicate_names_the_first(tmp_path: Path) -> None:
    _, findings = load(tmp_path, "sub a\nendsub\n\nsub a\nendsub\nm30\n")
    (related,) = findings.kept[0].related
    assert (related.span.line, related.span.file) == (1, str(tmp_path / "job.cnc"))


def test_a_bad_condition_still_opens_its_block(tmp_path: Path) -> None:
    text = "if [#1 == ]\nx1\nelse\ny1\nendif\nwhile #1\nz1\nendwhile\nsub 5\nendsub\nif [1] g0 x1\nendif\ng1 endif\n"
    _, findings = load(tmp_path, text)
    codes = [(code, line) for code, line, _, _ in shown(findings)]
    assert codes == [("GP107", 1), ("GP107", 6), ("GP124", 9), ("GP122", 11), ("GP122", 13), ("GP114", 13)]


@pytest.mark.parametrize("word", ["if", "while"])
def test_blocks_nested_too_deep_are_not_modelled(tmp_path: Path, word: str) -> None:
    for depth, kinds in ((100, set()), (101, {"Unsupported"}), (3000, {"Unsupported"})):
        text = f"{word} [1]\nx1\n" * depth + f"end{word}\n" * depth
        program = program_of(tmp_path, text)
        assert parse_ir(print_ir(program)) == program
        assert {name for name in re.findall(r"\((\w+)", print_ir(program)) if name == "Unsupported"} == kinds


@pytest.mark.parametrize(
    "value", ["#" * 240 + "1", "-[" * 80 + "1" + "]" * 80, "[" + "1+" * 120 + "1]", "sin[" * 40 + "1" + "]" * 40]
)
def test_the_deepest_expressions_that_fit_a_line(tmp_path: Path, value: str) -> None:
    program = program_of(tmp_path, f"x{value}\n")
    assert parse_ir(print_ir(program)) == program


def test_findings_come_in_the_order_of_lines(tmp_path: Path) -> None:
    text = "".join(f"{line}\n" for line, code, _, _ in CASES if code != "GP114")
    _, findings = load(tmp_path, text)
    lines = [f.span.line for f in findings.kept if f.code.label not in ("GP114", "GP115", "GP116")]
    assert lines == sorted(lines)
    assert set(lines) == set(range(1, len(CASES) + 1))


@pytest.mark.parametrize("text", ["", "\n", "%\n%\n", "(only a comment)\n; and one\n", "\ufeff", "N10\n"])
def test_a_program_without_code(tmp_path: Path, text: str) -> None:
    program, findings = load(tmp_path, text)
    assert shown(findings) == [("GP120", 1, 0, 0)]
    assert program is not None
    assert program.body == ()


@pytest.mark.parametrize(
    ("data", "code", "message"),
    [
        (b"\xff\xfeG\x001\x00", "GP119", "0xFF"),
        (b"\xfe\xff\x00G\x001", "GP119", "0xFE"),
        (b"G1 X1\n\x00\n", "GP119", "offset 6"),
        (b"\x7fELF\x02\x01\x00" + bytes(range(256)) * 9000, "GP119", "offset 6"),
    ],
)
def test_files_that_are_no_text(tmp_path: Path, data: bytes, code: str, message: str) -> None:
    program, findings = load(tmp_path, data)
    assert program is None
    (finding,) = findings.kept
    assert finding.code.label == code
    assert message in finding.message


def test_files_that_can_not_be_read(tmp_path: Path) -> None:
    for path in (tmp_path, tmp_path / "missing.cnc", tmp_path / "x" / "job.cnc", Path("/dev/null")):
        findings = Findings()
        assert load_program(path, findings) is None
        assert [f.code.label for f in findings.kept] == ["GP601"]


def test_good_programs_have_no_findings(tmp_path: Path) -> None:
    program_of(tmp_path, "%\nN10 G21\nif [#1 == 2] then\nx#1\nendif\nm30\n%\n")
