"""DIN lines of McuWIN: words, parameters, comments, what a line goes on with. Expected by hand from the manual."""

from __future__ import annotations

from pathlib import Path

import pytest
from frontend.mcuwin.mcuwin_programs import OLD, found, listed, load, machine, program_of

from gproof.ir.dialects.mcuwin.settings import TaskCode
from gproof.ir.program import Block

END = "\nM30\n"


def body(folder: Path, text: str) -> str:
    """The statements of a text without its M30."""
    program = program_of(folder, text + END)
    shown = listed(program.body)
    return shown[: shown.rindex("; M30")]


@pytest.mark.parametrize(
    ("text", "nodes"),
    [
        # 3.1 to 3.5, 4.11, 4.14, 4.19
        ("N0400 G00 X20 Y22\nN0410 X30 Y23 Z-5", "G0 X20 Y22; X30 Y23 Z-5 | G0"),
        ("g01x1y-.5z+2.5f100", "G1 X1 Y-0.5 Z2.5 F100"),
        ("N100 G04 3\nN100 G04 CD601\nG04(CD601+1)", "G4 @3; G4 @#601; G4 @(#601 + 1)"),
        ("N0100 M26 102      ' Set output 2 for axis 1", "M26 @102"),
        ("N220 M80 X 4", "M80 X4"),
        ("N020 M901 601", "M901 @601"),
        ("G60 X Y Z", "G60 X Y Z"),
        ("N200 G51 C120", "G51 C120"),
        ("N500 G39      (Reset all factors to -1)", "G39"),
        ("T1 M6 S1000 M3 D2", "T1 M6 S1000 M3 D2"),
        # 5.7
        ('WRITE "at: " X.rp', "write 'at: ', X.RP"),
        ("writeln \"a 'b' (c)\", CI600 + 1 ' d", "writeln \"a 'b' (c)\", (#1600 + 1)"),
        # 6
        ("N210 G00 X10 Y-20 (a comment)", "G0 X10 Y-20"),
        ("N220 G90          ' a comment", "G90"),
        ("N230 G01 X(CD601 - Y.rp) F1", "G1 X(#601 - Y.RP) F1"),
        ("(a)(b) G0 (c) X1 (d) ' e (f", "G0 X1"),
        ("G0 X1 ' (a (b)", "G0 X1"),
        ("G0 X1 (don't)", "G0 X1"),
        # 11
        ("N220 CD620 := 100\nN230 G00 X2*CD620", "#620 := 100; G0 X(2 * #620)"),
        ("X.zerooffset := 5 + CD600", "Unsupported"),
        ("CI600:=CI600+1", "#1600 := (#1600 + 1)"),
        ("G0 X10 -5", "G0 X(10 - 5)"),
        ("G0 X-CD600 Y-(3)", "G0 Xneg(#600) Yneg(3)"),
        # 4.15, 4.16, 5.1
        ("L5 G0 X1\nM96 L5", "L5:; G0 X1; jump 5"),
        ("L 0114\nM96 L 114", "L114:; jump 114"),
        ("M98 L7 O5\nM98L7O CI600\nM98 L7\nM30\nL7\nM17", "call 7 x 5; call 7 x #1600; call 7; M30; L7:; return"),
        ("N1 G4 1 G0 X1 M3", "G4 @1 G0 X1 M3"),
        # words whose turn is open stand in front as what is not followed
        ("M96 L5 G0 X1\nL5", "Unsupported; jump 5; L5:"),
        ("G0 X1 M96 L5\nL5", "G0 X1; jump 5; L5:"),
        ("M98 L7 F100\nM30\nL7 G0 X1 M17", "Unsupported; call 7; M30; L7:; G0 X1; return"),
        ("L7 M17 G0 X1", "L7:; Unsupported; return"),
        ("G0 X1 CD600 := 1 Y2", "Unsupported; G0 X1; #600 := 1 | G0"),
        ("CD600 := 1 CD601 := 2 G0 X1", "#600 := 1; #601 := 2; G0 X1"),
    ],
)
def test_lines(tmp_path: Path, text: str, nodes: str) -> None:
    assert body(tmp_path, text) == nodes


@pytest.mark.parametrize(
    ("text", "state"),
    [
        # 3.1: the line before in the source; 14 (2.5.3.94): M codes keep it; labels and assignments too
        ("G1 X1 F1\n", "G1"),
        ("G2 X1 I1 J1\nM8\nL5\nCD600 := 1\nF100\nS5\nT1\n", "G2"),
        ("G0 X1\nM96 L5\nL5\n", "G0"),
        ("G90 G01 X1\n", "G1"),
        # 3.5, 14 (2.5.3.106)
        ("G1 X1\nG04 1\n", ""),
        ("G1 X1\n$DINEND\n{$DINSTART}\n", ""),
        ("G1 X1\nG04 1\nG90\n", ""),
        # 3.26: a maintained command
        ("G1 X1\nG92 X5\n", "G92"),
        # open: another G code, a $ line, a text, the border of a module
        ("G1 X1\nG90\n", "?"),
        ("G01 X1 G90\n", "?"),
        ("G1 X1\n$wt(5);\n", "?"),
        ('G1 X1\nWRITE "a"\n', "?"),
        ("G1 X1\nG90\nM8\n", "?"),
        ("G1 X1\nG90\nG0 X2\n", "G0"),
        ("G90\n", ""),
        ("", ""),
    ],
)
def test_what_a_line_goes_on_with(tmp_path: Path, text: str, state: str) -> None:
    program = program_of(tmp_path, text + "X9\nM30\n")
    bare = next(n for n in program.body if isinstance(n, Block) and [w.letter for w in n.words] == ["X"])
    assert bare.continued == state


def test_a_module_goes_on_with_nothing_that_is_known(tmp_path: Path) -> None:
    program = program_of(tmp_path, "%1\nG1 X1\nM30\n%\n%2\nX9\nM17\n%\n")
    assert listed(program.subprograms["2"].body) == "X9 | ?; return | ?".replace("return | ?", "return")


@pytest.mark.parametrize(
    ("text", "state"),
    [("G1 X1\nG90\n", "G1"), ("G1 X1\n$wt(5);\n", "G1"), ("G1 X1\nG04 1\n", ""), ("G1 X1\n$DINEND\n{$DINSTART}\n", "")],
)
def test_persistence_that_goes_over_codes(tmp_path: Path, text: str, state: str) -> None:
    program = program_of(tmp_path, text + "X9\nM30\n", machine(keeps_over_codes=True))
    bare = next(n for n in program.body if isinstance(n, Block) and [w.letter for w in n.words] == ["X"])
    assert bare.continued == state


@pytest.mark.parametrize(
    ("text", "state"), [("G1 X1\nM8\n", ""), ("G1 X1\nG04 1\n", "?"), ("G1 X1\nG92 X5\n", "?"), ("G1 X1\nL5\n", "G1")]
)
def test_what_the_older_version_goes_on_with(tmp_path: Path, text: str, state: str) -> None:
    program = program_of(tmp_path, text + "X9\nM30\n", OLD)
    bare = next(n for n in program.body if isinstance(n, Block) and [w.letter for w in n.words] == ["X"])
    assert bare.continued == state


@pytest.mark.parametrize(
    ("text", "finding"),
    [
        # 4, 6: compiler error 2074
        ("M08 (coolant)", ("GP140", 1, 5, 14)),
        ("M26 102 (output)", ("GP140", 1, 9, 17)),
        ("G04 (wait)", ("GP140", 1, 5, 11)),
        ("G210 (own)", ("GP140", 1, 6, 11)),
        ("L5\nM96 L5 (loop)", ("GP140", 2, 8, 14)),
        ("WRITE (text)", ("GP140", 1, 7, 13)),
        # 14 (2.5.3.100): compiler error 2075
        ("G04", ("GP275", 1, 1, 4)),
        ("G04 ' nothing", ("GP275", 1, 1, 4)),
        ("G04 X.zerooffset := 5", ("GP275", 1, 1, 4)),
        # 13.1.1.1: error 1
        ("G59", ("GP112", 1, 1, 4)),
        ("N5 M77 X1", ("GP112", 1, 4, 7)),
        ("G38.2 X1", ("GP112", 1, 1, 6)),
        ("G1000000000000", ("GP112", 1, 1, 15)),
        # 6: comments that may end in two places
        ("G0 X1 (a (b) c)", ("GP104", 1, 7, 16)),
        ("G0 (don't) X1", ("GP104", 1, 4, 11)),
        ("G0 X1 (a (b)", ("GP104", 1, 7, 13)),
        ("G0 X1 (a", ("GP103", 1, 7, 9)),
        # words
        ("G0 X1 L5", ("GP101", 1, 7, 9)),
        ("G0 X1 R5", ("GP101", 1, 7, 9)),
        ("G0 U5", ("GP296", 1, 4, 6)),
        ("G0 X1 5", ("GP101", 1, 7, 8)),
        ("G0 5", ("GP121", 1, 4, 5)),
        ("F", ("GP108", 1, 1, 2)),
        ("G", ("GP108", 1, 1, 2)),
        ("N X1", ("GP101", 1, 1, 2)),
        ("CD600", ("GP101", 1, 1, 6)),
        ("G0 X.tp", ("GP121", 1, 4, 8)),
        ("X.tp", ("GP101", 1, 1, 5)),
        ("M96", ("GP275", 1, 1, 4)),
        ("M98 L5 5", ("GP121", 1, 8, 9)),
        ("/G0 X1", ("GP101", 1, 1, 2)),
        ("G0 X1;", ("GP101", 1, 6, 7)),
        ("G0 X1 // no", ("GP101", 1, 7, 8)),
        ("M8\n%\n{no}", ("GP101", 3, 1, 5)),
        ("G0 Xä", ("GP101", 1, 5, 6)),
        ("G0 X1\rY2", ("GP101", 1, 6, 7)),
        ("step := 5", ("GP136", 1, 1, 5)),
        ("CI600 := 1.5", ("GP135", 1, 10, 13)),
        # calls and jumps
        ("M96 L5", ("GP143", 1, 1, 7)),
        ("M98 L5", ("GP115", 1, 1, 7)),
        ("L5\nL5", ("GP142", 2, 1, 3)),
    ],
)
def test_mistakes(tmp_path: Path, text: str, finding: tuple[str, int, int, int]) -> None:
    assert found(tmp_path, text + END) == [finding]


def test_a_line_with_a_mistake_is_left_out(tmp_path: Path) -> None:
    program, _ = load(tmp_path, "G0 X1\nG0 X(\nG0 X3\nM30\n", tables=False)
    assert program is not None
    assert listed(program.body) == "G0 X1; Mistake; G0 X3 | ?; M30 | G0"


def test_codes_of_the_application(tmp_path: Path) -> None:
    tasks = (TaskCode(code="M77", action="nothing"),)
    assert found(tmp_path, "M77 5" + END, machine(tasks=tasks)) == []
    assert found(tmp_path, "M210 (CD600) G299" + END) == []


def test_line_numbers_that_a_machine_asks_for(tmp_path: Path) -> None:
    text = "%5\n' note\nN1 G0 X1\nG0 X2\nX3\n$CD600 := 1;\nN2 M30\n%\n"
    assert found(tmp_path, text, machine(line_numbers=True)) == [("GP148", 4, 1, 2), ("GP148", 5, 1, 2)]


def test_small_letters(tmp_path: Path) -> None:
    assert found(tmp_path, "g0 X1" + END, machine(case_sensitive=True)) == [("GP101", 1, 1, 2)]
    assert found(tmp_path, "g0 x1\nm30", machine(case_sensitive=False)) == []


@pytest.mark.parametrize(
    ("text", "findings"),
    [
        # 7 and 2.5.3.25 of the older manual: brackets are comments behind M codes, and nest
        ("M08 (coolant)\nM30 (end)", []),
        ("G0 X1 (a (b) c)\nM30", []),
        ("M26 102 // output\nM30", []),
        ("G04 CD600\nM30", [("GP107", 1, 5, 10)]),
        ("T CD600\nM30", [("GP107", 1, 1, 8)]),
        ("T2\nM30", []),
        # 14: what came later
        ("M901 600\nM30", [("GP112", 1, 1, 5)]),
        ("M80 X 4\nM30", [("GP112", 1, 1, 4)]),
        ("G96\nM30", [("GP112", 1, 1, 4)]),
        ('WRITE "a"\nM30', [("GP101", 1, 1, 10)]),
        # no error 190
        ("G0 X1", [("GP118", 1, 0, 0)]),
        ("G04 (wait)\nM30\n", [("GP275", 1, 1, 4)]),
        ("G04 (wait) 3\nM30\n", []),
    ],
)
def test_the_older_version(tmp_path: Path, text: str, findings: list[tuple[str, int, int, int]]) -> None:
    assert found(tmp_path, text, OLD) == findings
