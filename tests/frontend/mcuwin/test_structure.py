"""Blocks of $ lines, sections of rw_SymPas, modules, labels, jumps, calls and includes, by hand from the manual."""

from __future__ import annotations

from pathlib import Path

import pytest
from frontend.mcuwin.mcuwin_programs import OLD, found, listed, load, machine, program_of

from gproof.frontend.mcuwin.load import load_alone
from gproof.ir.finding import Findings
from gproof.ir.program import If, Include, Label, Unsupported


def shown(folder: Path, text: str) -> str:
    return listed(program_of(folder, text).body)


@pytest.mark.parametrize(
    ("text", "nodes"),
    [
        # 7
        (
            "N350 $if (CI600 < 20) then begin\nN400 G0 X1\nN450 $end\n",
            "if (#1600 < 20) [G0 X1]",
        ),
        (
            "$if (X.digib.5) then begin\nG0 X1\n$end else begin\nG0 X2\n$end\n",
            "if input105 [G0 X1] else [G0 X2 | ?]",
        ),
        (
            "$if (CI600 = 1) then begin\nM8\n$end else if (CI600 = 2) begin\nM9\n$end else if (CI600 = 3) then begin\n"
            "M0\n$end else begin\nM1\n$end\n",
            "if (#1600 == 1) [M8] else [if (#1600 == 2) [M9] else [if (#1600 == 3) [M0] else [M1]]]",
        ),
        ("$if (BOOLEAN (CI600)) then begin\n$end\n$else begin\nM8\n$end\n", "if bool(#1600) [] else [M8]"),
        # 8
        ("$while (CI600 < 5) do begin // more\nM8\n$end;\n", "while (#1600 < 5) [M8]"),
        ("$repeat begin\nM8\n$end until (CI600 > 5);\n", "repeat [M8] until (#1600 > 5)"),
        ("$repeat\nM8\n$until (CI600 > 5);\n", "repeat [M8] until (#1600 > 5)"),
        ("$for CI600:=1 to 10 do begin\nM8\n$end;\n", "for #1600 1 to 10 [M8]"),
        ("$for CI600:=10 downto CI601 do begin\nM8\n$end;\n", "for #1600 10 downto #1601 [M8]"),
        # one in another, over the whole line
        (
            "$while (true) do begin\n$if (CI600 = 1) then begin\nM96 L5\n$end\n$end\nL5\n",
            "while true [if (#1600 == 1) [jump 5]]; L5:",
        ),
        ("$CI600 := 1;\n$wt(2000);\n", "#1600 := 1; Device"),
        ("$if (CI600 = 1) then CI600 := 2;\n", "if (#1600 == 1) [#1600 := 2]"),
        # 10
        ("$DINEND\nCI600 := 1;\nCI601 := 2;\n{$DINSTART}\nG0 X1\n",
         "mode pascal; #1600 := 1; #1601 := 2; mode din; G0 X1"),
        ("$DINEND CI600 := 1; { a\n{$DINSTART} CI601 := 2; { $dinstart } G0 X1\n",
         "mode pascal; #1600 := 1; #1601 := 2; mode din; G0 X1"),
    ],
)  # fmt: skip
def test_blocks(tmp_path: Path, text: str, nodes: str) -> None:
    assert shown(tmp_path, text + "M30\n").split("; M30")[0] == nodes


def test_places_of_a_chain(tmp_path: Path) -> None:
    text = "$if (CI600 = 1) then begin\nM8\n$end else if (CI600 = 2) begin\nM9\n$end else begin\nM0\n$end\nM30\n"
    node = program_of(tmp_path, text).body[0]
    assert isinstance(node, If)
    inner = node.otherwise[0]
    assert isinstance(inner, If)
    assert node.else_span is not None and inner.else_span is not None and inner.end_span is not None
    assert node.end_span == inner.end_span
    assert (node.span.line, node.else_span.line, inner.span.line) == (1, 3, 3)
    assert (inner.else_span.line, inner.end_span.line) == (5, 7)


SAMPLE = """' note
$DINEND
// block

var
    radius, step : double;    { floating point }
    counter      : integer;   { integer }

const
    last = 500;               { constant }

{ $DINSTART }

%SAMPLE
G90
G00 X100 Y200 Z-10
step := 0.5                  ' assignment
$for counter := 0 to last do begin // loop
    CI601 := counter
    G01 X(X.tp + step) Y (200.0 + 5.0 * sin (X.tp / 10.0)) ' function
$end;

M30
%
"""


def test_declarations_before_the_first_percent_sign(tmp_path: Path) -> None:
    expected = (
        "mode pascal; Declare; Declare; Declare; mode din; G90; G0 X100 Y200 Z-10; step := 0.5 | G0; "
        "for counter 0 to last [#1601 := counter | ?; "
        "G1 X(X.TP + step) Y(200 + (5 * rsin((X.TP / 10)))) | ?]; M30 | ?"
    )
    assert shown(tmp_path, SAMPLE) == expected
    without = SAMPLE.replace("$DINEND\n", "").replace("{ $DINSTART }\n", "")
    assert shown(tmp_path, without) == expected.replace("mode pascal; ", "").replace("mode din; ", "")


@pytest.mark.parametrize(
    ("text", "nodes"),
    [
        ("G90\n%1\nM30\n%\n", "Unsupported; G90; M30"),
        ("G90\nM30\n%1\nM17\n%\n", "G90; M30"),
        ("G90\nM30\n%\n", "G90; M30"),
        ("%\nG90\nM30\n%\n", "G90; M30"),
        ("' note\n\n%\nG90\nM30\n", "G90; M30"),
    ],
)
def test_what_runs_first(tmp_path: Path, text: str, nodes: str) -> None:
    assert shown(tmp_path, text) == nodes


def test_a_percent_sign_within_rw_sympas(tmp_path: Path) -> None:
    assert found(tmp_path, "$DINEND\nCI600 := 1;\n%5\nM30\n") == [("GP101", 3, 1, 2)]


@pytest.mark.parametrize(
    ("text", "finding"),
    [
        ("$end\n", ("GP114", 1, 2, 5)),
        ("$end until (CI600 = 1);\n", ("GP114", 1, 2, 23)),
        ("$while (CI600 = 1) do begin\n$end until (CI600 = 1);\n", ("GP114", 2, 2, 23)),
        ("$repeat begin\n$end\n", ("GP114", 2, 2, 5)),
        ("$while (CI600 = 1) do begin\n$end else begin\n$end\n", ("GP114", 2, 2, 16)),
        ("M8\n$else begin\n$end\n", ("GP114", 2, 2, 12)),
        ("$if (CI600) then begin\n$end\n", ("GP135", 1, 5, 12)),
        ("$for CD600 := 1 to 5 do begin\n$end\n", ("GP135", 1, 6, 11)),
        ("$if (CI600 = 1) then\nM8\n", ("GP139", 1, 17, 21)),
        ("$if (CI600 = 1) then begin\nM8\n", ("GP114", 1, 2, 27)),
        ("$if (CI600 = 1) then begin\n%7\nM17\n%\n", ("GP114", 1, 2, 27)),
        ("$I\n", ("GP101", 1, 1, 3)),
        ("$I two words.src\n", ("GP101", 1, 1, 17)),
        ("$I nowhere.src\n", ("GP130", 1, 1, 15)),
        ("$I job.din\n", ("GP145", 1, 1, 11)),
        ("$nonsense begin\n$end\n", ("GP114", 2, 2, 5)),
    ],
)
def test_mistakes_of_blocks(tmp_path: Path, text: str, finding: tuple[str, int, int, int]) -> None:
    assert found(tmp_path, text + "M30\n")[:1] == [finding]


@pytest.mark.parametrize(
    "head",
    ["if q then", "if q", "if (q) begin", "if (q then begin", "if ) then begin", "while q do", "while q begin",
     "for CI600 := 1 to", "for CI600 := 1 to 3", "for CI600 := 1 to 3 begin", "for := 1 to 3 do begin", "begin"],
)  # fmt: skip
@pytest.mark.parametrize("inner", [True, False])
def test_a_mistake_in_a_head_is_one_mistake(tmp_path: Path, head: str, inner: bool) -> None:
    text = f"var q : boolean;\n%1\n$while (CI601 < 3) do begin\n$DINEND\n{{$DINSTART}}\n${head}\nM8\n$end\n$end\nM30\n"
    if not inner:
        text = f"var q : boolean;\n%1\n\n\n\n${head}\nM8\n$end\nM9\nM30\n"
    assert [line for _, line, _, _ in found(tmp_path, text)] == [6]
    behind = found(tmp_path, text.replace("M30", "$end\nG99999\nM30"))
    assert [line for _, line, _, _ in behind] == [6, 10, 11]


MODULES = """%MAIN (the main program)
N1 M98 L107 O2
N2 M98 UP114
N3 M98 LUP114
N4 M30
N5 %
%107
N0100 L107            (Local sub-routine 107)
N0200 G0 X1
N1000 M17
%
%UP114   (Sub-program UP114)
G0 X2
M17
%
"""


def test_modules(tmp_path: Path) -> None:
    program = program_of(tmp_path, MODULES)
    assert listed(program.body) == "call 107 x 2; call up114; call up114; M30"
    assert {name: listed(sub.body) for name, sub in program.subprograms.items()} == {
        "107": "L107:; G0 X1; return",
        "up114": "G0 X2 | ?; return",
    }
    assert all(sub.is_module for sub in program.subprograms.values())


def test_labels_that_are_called(tmp_path: Path) -> None:
    text = "G0 X1\nM98 L5\nM98 L6\nM30\nL5\nG0 X2\nL6\nG0 X3\nM17\n"
    program = program_of(tmp_path, text)
    assert {name: listed(sub.body) for name, sub in program.subprograms.items()} == {
        "5": "L5:; G0 X2 | G0; L6:; G0 X3 | G0; return",
        "6": "L6:; G0 X3 | G0; return",
    }
    assert not any(sub.is_module for sub in program.subprograms.values())


def test_a_called_label_whose_text_jumps_back_before_it(tmp_path: Path) -> None:
    program = program_of(tmp_path, "M98 L6\nM30\nL5\nM8\nL6\nM9\nM96 L5\nM17\n")
    assert listed(program.subprograms["6"].body) == "jump 6; call 6; M30; L5:; M8; L6:; M9; jump 5; return"


def test_a_jump_to_the_beginning_of_a_module(tmp_path: Path) -> None:
    program = program_of(tmp_path, "%MAIN\nM8\nM96 LMAIN\nM30\n%\n")
    assert listed(program.body) == "Lmain:; M8; jump main; M30"
    assert isinstance(program.body[0], Label)


def test_a_label_of_a_block_and_of_what_is_around_it(tmp_path: Path) -> None:
    text = "L1\n$while (CI600 < 3) do begin\nL2\nM96 L2\nM96 L1\n$end\nM30\n"
    assert shown(tmp_path, text) == "L1:; while (#1600 < 3) [L2:; jump 2; jump 1]; M30"


@pytest.mark.parametrize(
    ("text", "findings"),
    [
        ("M96 L2\n$while (CI600 < 3) do begin\nL2\n$end\nM30\n", [("GP144", 1, 1, 7)]),
        ("M98 L2\n$while (CI600 < 3) do begin\nL2\n$end\nM30\n", [("GP144", 1, 1, 7)]),
        ("M96 L2\nM30\n%\n%2\nM17\n%\n", [("GP144", 1, 1, 7)]),
        ("M96 L3\nM30\n%\n%2\nL3\nM17\n%\n", [("GP144", 1, 1, 7)]),
        # 14 (2.5.3.90): compiler error 190, of each module
        ("G0 X1\n", [("GP141", 1, 0, 0)]),
        ("%MAIN\nG0 X1\n%\n", [("GP141", 1, 1, 6)]),
        ("M98 L2\nM30\n%\n%2\nG0 X1\n%\n", [("GP141", 4, 1, 3)]),
        # a label that is a module's name elsewhere, two modules of one name
        ("M98 L2\nM30\n%\n%2\nM17\n%\n%3\nL2\nM17\n", [("GP142", 8, 1, 3)]),
        ("M30\n%\n%2\nM17\n%\n%2\nM17\n%\n", [("GP142", 6, 1, 3)]),
        ("%2 G0\nM30\n", [("GP101", 1, 4, 6)]),
        ("%\n", [("GP120", 1, 0, 0)]),
        ("", [("GP120", 1, 0, 0)]),
        ("var step : double;\n", [("GP120", 1, 0, 0)]),
    ],
)
def test_mistakes_of_modules(tmp_path: Path, text: str, findings: list[tuple[str, int, int, int]]) -> None:
    assert found(tmp_path, text) == findings


@pytest.mark.parametrize(
    ("text", "line"), [("%1\nM98 UP\nM30\n%Up\nM17\n%\n", 4), ("%1\nM98 LUP\nM30\n%Up\nM17\n%\n", 4),
                       ("%Up\nM96 UP\nM30\n%\n", 2)],
)  # fmt: skip
def test_names_of_modules_in_two_ways(tmp_path: Path, text: str, line: int) -> None:
    """Where nobody says that case does not matter, it may be another module that is meant, or none."""
    for setting in (None, True):
        told = found(tmp_path, text, machine(case_sensitive=setting))
        assert [one[:2] for one in told] == [("GP139", line)]
    assert found(tmp_path, text, machine(case_sensitive=False)) == []
    assert found(tmp_path, text.replace("%Up", "%UP"), machine(case_sensitive=True)) == []


def test_names_of_modules_are_no_labels_in_the_older_version(tmp_path: Path) -> None:
    assert found(tmp_path, "M98 L107\nM30\n%\n%107\nM17\n%\n", OLD) == [("GP115", 1, 1, 9)]
    text = "M98 L107\nM30\n%\n%107\nM8\nL107\nM9\nM17\n%\n"
    program = program_of(tmp_path, text, OLD)
    assert listed(program.subprograms["107"].body) == "L107:; M9; return"


# includes: 9, 14 (2.5.3.52, .90)


def test_includes_within_includes(tmp_path: Path) -> None:
    (tmp_path / "lib").mkdir()
    (tmp_path / "lib" / "all.inc").write_text("$I UP1.SRC (Module 1000)\n$I ..\\LIB\\up2.src ' 2000\n")
    (tmp_path / "lib" / "Up1.src").write_text("%1000 (name)\nN200 G00 X1\nN400 M17 ' return\nN500 %\n")
    (tmp_path / "lib" / "UP2.SRC").write_text("%2000\nM98 L1000\nM17\n%\n")
    program = program_of(tmp_path, "M98 L2000\nM30\n%\n$I lib/ALL.inc (library)\n")
    assert listed(program.subprograms["1000"].body) == "G0 X1; return"
    assert listed(program.subprograms["2000"].body) == "call 1000; return"
    assert [Path(source.name).name for source in program.files] == ["job.din", "all.inc", "Up1.src", "UP2.SRC"]
    assert program.subprograms["1000"].body[0].span.file.endswith("Up1.src")  # type: ignore[union-attr]
    includes = [n for sub in program.subprograms.values() for n in sub.body if isinstance(n, Include)]
    assert [node.name for node in includes] == ["lib/ALL.inc", "UP1.SRC", "..\\LIB\\up2.src"]


def test_a_drive_stands_for_the_folder_of_the_source(tmp_path: Path) -> None:
    (tmp_path / "up1.src").write_text("M8\n")
    assert listed(program_of(tmp_path, "$I C:\\McuWIN\\UP1.SRC\nM30\n").body) == "Include; M8; M30"


def test_two_files_of_one_name_that_differ(tmp_path: Path) -> None:
    (tmp_path / "lib").mkdir()
    (tmp_path / "lib" / "a.inc").write_text("$I up1.src\n")
    (tmp_path / "lib" / "up1.src").write_text("M8\n")
    (tmp_path / "up1.src").write_text("M9\n")
    assert listed(program_of(tmp_path, "$I lib/a.inc\nM30\n").body) == "Include; Include; Unsupported; M8; M30"
    (tmp_path / "up1.src").write_text("M8\n")
    assert listed(program_of(tmp_path, "$I lib/a.inc\nM30\n").body) == "Include; Include; M8; M30"


def test_files_that_double_one_another(tmp_path: Path) -> None:
    """Each includes the next one twice: 2 to the 30 inclusions, of which some are followed."""
    for n in range(30):
        (tmp_path / f"a{n}.inc").write_text(f"$I a{n + 1}.inc\n$I a{n + 1}.inc\n")
    (tmp_path / "a30.inc").write_text("M8\n")
    program, findings = load(tmp_path, "$I a0.inc\nM30\n")
    assert program is not None
    assert findings.kept == []
    assert any(isinstance(node, Unsupported) for node in program.body)
    assert load_alone(tmp_path / "job.din", Findings()) is not None


def test_files_that_include_one_another(tmp_path: Path) -> None:
    (tmp_path / "a.inc").write_text("$I b.inc\n")
    (tmp_path / "b.inc").write_text("$I a.inc\n")
    _, findings = load(tmp_path, "$I a.inc\nM30\n")
    assert [(f.code.label, Path(f.span.file).name, f.span.line) for f in findings.kept] == [("GP145", "b.inc", 1)]


def test_a_block_ends_in_the_file_where_it_begins(tmp_path: Path) -> None:
    (tmp_path / "a.inc").write_text("$if (CI600 = 1) then begin\n")
    _, findings = load(tmp_path, "$I a.inc\n$end\nM30\n")
    assert [(f.code.label, Path(f.span.file).name, f.span.line) for f in findings.kept] == [
        ("GP114", "a.inc", 1), ("GP114", "job.din", 2),
    ]  # fmt: skip


def test_files_before_and_behind_each_job(tmp_path: Path) -> None:
    (tmp_path / "before.inc").write_text("$DINEND\nvar step : double;\n{$DINSTART}\n")
    (tmp_path / "behind.inc").write_text("%900\nM8\nM17\n%\n")
    on = machine(pre_include="before.inc", post_include="behind.inc")
    program = program_of(tmp_path, "%1\nstep := 1\nM98 L900\nM30\n%\n", on)
    assert listed(program.body) == "mode pascal; Declare; mode din; step := 1; call 900; M30"
    assert found(tmp_path, "M30\n", machine(pre_include="nowhere.inc")) == [("GP130", 1, 0, 0)]


def test_a_library_before_the_job(tmp_path: Path) -> None:
    (tmp_path / "lib.inc").write_text("%900\nM8\nM17\n%\n")
    program = program_of(tmp_path, "$I lib.inc\n%1\nM30\n%\n")
    assert listed(program.body).startswith("Unsupported")


def test_procedures(tmp_path: Path) -> None:
    text = (
        "$DINEND\nprocedure inner(a : integer);\nbegin\n  CI600 := a;\nend;\n"
        "procedure outer;\nbegin\n  inner(5);\nend;\n{$DINSTART}\n%1\n$outer;\nM30\n%\n"
    )
    program = program_of(tmp_path, text)
    assert listed(program.body) == "mode pascal; mode din; call outer; M30"
    assert listed(program.subprograms["outer"].body) == "call inner 5"
    assert listed(program.subprograms["inner"].body) == "#1600 := a"


def test_names_that_are_words(tmp_path: Path) -> None:
    assert found(tmp_path, "var x : double;\n%1\nM30\n%\n") == [("GP139", 1, 1, 15)]


def test_a_file_alone(tmp_path: Path) -> None:
    """For a printer: includes give names only, and what they have is no finding."""
    (tmp_path / "names.inc").write_text("$DINEND\nvar step : double;\n{$DINSTART}\n%900\nG0 X(\nM17\n%\n")
    text = "$I names.inc\n$I nowhere.inc\n%1\nX5\nstep := 1\nM98 L900\nM96 L3\n%\n%2\nL2\nM8\n%\n"
    path = tmp_path / "job.din"
    path.write_text(text)
    findings = Findings()
    program = load_alone(path, findings, "-")
    assert findings.kept == []
    assert program is not None
    assert [source.name for source in program.files] == ["-"]
    assert listed(program.body) == "Include; Include; table 4-4; step := 1; call 900; jump 3; L2:; M8"
    assert program.subprograms == {}
