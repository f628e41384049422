"""Jobs of Eding CNC for McuWIN: the text that a person who knows both manuals writes, and its proof.

Each case is written by hand: the lines of the program, those of McuWIN between the header and the end. Sections are
those of the McuWIN manual of V 2.5.3.133.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from support.traps import changed, machine_files

from gproof.driver.translation import Translation, Wanted, translate
from gproof.ir.translation_map import TranslationMap
from gproof.ir.verdict import Verdict

HEADER = ["G90 G71 G94 G162 G17", "G54"]
"""Modes that other programs or IniCfg may have left (3.3, 3.6, 3.24, 3.28), the work offset of the source (3.19)."""


def translated(folder: Path, text: str, machine: str = "", given: TranslationMap | None = None) -> Translation:
    """A program of Eding CNC for the machine of the traps, with changes; given: a map."""
    for dialect in ("eding", "mcuwin"):
        (folder / dialect).mkdir(exist_ok=True)
        for name, data in machine_files(dialect).items():
            said = machine if dialect == "mcuwin" else ""
            (folder / dialect / name).write_text(changed(data.decode(), said))
    job = folder / "job.cnc"
    job.write_text(text)
    return translate(
        Wanted(
            job=job, to="mcuwin", machine=folder / "eding" / "machine.toml", dialect="eding", given=given,
            machine_to=folder / "mcuwin" / "machine.toml",
        )
    )  # fmt: skip


def lines_of(done: Translation) -> list[str]:
    """The lines between the header and M30."""
    assert [f"{f.span.line}: {f.message}" for f in done.findings.kept] == []
    assert done.verdict is Verdict.SAFE
    lines = done.files[""].decode().splitlines()
    begin = lines.index("%MAIN") + 1
    assert lines[begin : begin + 2] == HEADER
    return [*lines[: begin - 1], *lines[begin + 2 :]]


BODIES = {
    "moves, each with its code after another line (3.1)": (
        "G0 X10 Y20 Z5\nG1 Z-1 F100\nX20 F300\nY40",
        ["G00 X10 Y20 Z5", "G01 Z-1 F100", "X20 F300", "Y40"],
    ),
    "arcs with both words of the centre, as distances (3.3, 3.36)": (
        "G0 X0 Y0\nG3 X10 Y10 J10 F200\nG2 X20 Y20 R10\nG2 X20 Y20 I5 J0",
        ["G00 X0 Y0", "G03 X10 Y10 I0 J10 F200", "G02 X20 Y20 I10 J0", "X20 Y20 I5 J0"],
    ),
    "inches as millimetres, which G00 has (3.1)": (
        "G20\nG0 X1\nG1 Y0.5 F10", ["G00 X25.4", "G01 Y12.7 F254"]),
    "distances (3.25)": ("G91\nG0 X1 Y2\nG1 Z-1 F50\nG90\nG0 X0", [
        "G91 G00 X1 Y2", "G01 Z-1 F50", "G90 G00 X0"]),
    "a dwell is in seconds (3.5)": ("G0 X1\nG4 P1.5\nG1 X2 F50", ["G00 X1", "G04 1.5", "G01 X2 F50"]),
    "spindle, coolant, tool, each where it acts (4, 5)": (
        "T2 M6\nS8000 M3\nM8\nG1 X1 F50\nM9\nM5\nM0\nM1",
        ["T2 M06", "S8000 M03", "M08", "G01 X1 F50", "M09", "M05", "M00", "M01"],
    ),
    "what acts before the move is on a line before it": (
        "M8\nG0 Z20 M9", ["M08", "M09", "G00 Z20"]),
    "work offsets (3.19)": ("G0 X0 Y0\nG55\nG0 X1 Y1\nG54\nG0 X0", [
        "G00 X0 Y0", "G55", "G00 X1 Y1", "G54", "G00 X0"]),
    "comments (6)": ("(one)\nG0 X1 ; two\nM3 S5000 (three)", [
        "' one", "G00 X1 ' two", "S5000 M03 ' three", "M05"]),
    "messages (5.7.2)": ('msg "part "#1\nG0 X1', ['WRITELN "part " (v_b)', "G00 X1"]),
}  # fmt: skip
"""By what it is about: lines of Eding CNC after the modes; lines of McuWIN."""


@pytest.mark.parametrize("about", [about for about in BODIES if "(5.7.2)" not in about])
def test_lines(about: str, tmp_path: Path) -> None:
    body, expected = BODIES[about]
    first = [line for line in expected if line == "' one"]
    found = lines_of(translated(tmp_path, f"G17 G21 G90 G94 G54 G49\n{body}\nM30\n"))
    assert found == [*expected, "M30", "%"] or found == [*first, *expected[len(first) :], "M30", "%"]


def test_loops_and_variables(tmp_path: Path) -> None:
    """Variables are doubles that are declared before the first % (12); conditions are Booleans (7, 8.1)."""
    text = (
        "G17 G21 G90 G94 G54 G49\n#1 = 0\n#12 = 30\nwhile [#1 < 3]\nG0 X[10 * #1] Y[5 * cos[#12]]\nG1 Z-1 F100\n"
        "G0 Z5\n#1 = [#1 + 1]\nendwhile\nif [#1 == 3]\nG0 X0\nelse\nG0 Y0\nendif\nM30\n"
    )
    assert lines_of(translated(tmp_path, text)) == [
        "$DINEND", "var", "  v_b, v_bc : double;", "{$DINSTART}",
        "v_b := 0", "v_bc := 30", "$while (v_b < 3) do begin",
        "  G00 X(10 * v_b) Y(5 * cos(v_bc * 0.017453292519943295))", "  G01 Z-1 F100", "  G00 Z5", "  v_b := v_b + 1",
        "$end;", "$if (v_b = 3) then begin", "  G00 X0", "$end else begin", "  G00 Y0", "$end;", "M30", "%",
    ]  # fmt: skip


def test_subprograms(tmp_path: Path) -> None:
    """Modules after the program, each with a number, up to M17 (4.10, 4.16, 5.1)."""
    text = "sub hole\nG1 Z-2 F90\nG0 Z3\nendsub\nG17 G21 G90 G94 G54 G49\nG0 X1\ngosub hole\nG0 X2\ngosub hole\nM30\n"
    assert lines_of(translated(tmp_path, text)) == [
        "G00 X1", "M98 L1000", "G00 X2", "M98 L1000", "M30", "%",
        "%1000 ' hole", "G01 Z-2 F90", "G00 Z3", "M17", "%",
    ]  # fmt: skip


def test_machine_coordinates(tmp_path: Path) -> None:
    """The zero is put at machine zero (3.26), and brought back: by its record (3.19), or as it was kept (3.34)."""
    text = "G17 G21 G90 G94 G54 G49\nG0 X1\nG53 G0 Z0\nG0 X2\nM30\n"
    expected = ["G00 X1", "G92 Z0", "G00 Z0", "G54", "G00 X2", "M30", "%"]
    assert lines_of(translated(tmp_path, text)) == expected
    text = "sub up\nG53 G0 Z0\nendsub\nG17 G21 G90 G94 G54 G49\nG0 X1\ngosub up\nG0 X2\nM30\n"
    expected = [
        "G00 X1",
        "M98 L1000",
        "G00 X2",
        "M30",
        "%",
        "%1000 ' up",
        "G153",
        "G92 Z0",
        "G00 Z0",
        "G154",
        "M17",
        "%",
    ]
    assert lines_of(translated(tmp_path, text)) == expected


def test_local_offset(tmp_path: Path) -> None:
    """G92 of Eding CNC calls the present place so; that of McuWIN moves the zero, and a work offset ends it (3.26)."""
    text = "G17 G21 G90 G94 G54 G49\nG0 X40 Y10\nG92 X0\nG1 X5 F100\nG55\nG1 X6\nG92.1\nG1 X7\nM30\n"
    assert lines_of(translated(tmp_path, text)) == [
        "G00 X40 Y10", "G91", "G92 X40", "G90", "G01 X5 F100", "G55", "G91", "G92 X40", "G90", "G01 X6", "G91",
        "G92 X-40", "G90", "G01 X7", "M30", "%",
    ]  # fmt: skip


def test_inverse_time(tmp_path: Path) -> None:
    """Twice a minute 10 mm, four times a minute a quarter of a circle of 5 mm (7.854 mm), each a feed (5.3)."""
    text = "G17 G21 G90 G94 G54 G49\nG0 X0 Y0\nG93 G1 X10 F2\nG3 X5 Y5 I-5 J0 F4\nG94 G1 X0 F50\nM30\n"
    assert lines_of(translated(tmp_path, text)) == [
        "G00 X0 Y0", "G01 X10 F20", "G03 X5 Y5 I-5 J0 F31.4159", "G01 X0 F50", "M30", "%",
    ]  # fmt: skip


def test_stored_work_offset(tmp_path: Path) -> None:
    """The table is mcfg's (3.19): what a job stores is a zero in machine places, after each choice of it (3.26)."""
    text = "G17 G21 G90 G94 G54 G49\nG0 X0 Y0\nG10 L2 P2 X30 Y40\nG55\nG0 X1\nG54\nG0 X2\nG55\nG0 X3\nM30\n"
    done = translated(tmp_path, text)
    assert done.files[""].decode().splitlines()[3:] == [
        "G00 X0 Y0", "G55", "G92 X30 Y40", "G00 X1", "G54", "G00 X2", "G55", "G92 X30 Y40", "G00 X3", "M30", "%",
    ]  # fmt: skip


def test_spindle_rests_for_the_change_and_the_end(tmp_path: Path) -> None:
    """M6 and M30 of Eding CNC stop the spindle, M30 coolant too (3.5.1, 3.5.3 there); Task 0 need not (4.7, 4.13)."""
    text = "G17 G21 G90 G94 G54 G49\nT1 M6\nM3 S5000\nM8\nG1 X1 F100\nT2 M6\nM3\nG1 X2\nM30\n"
    assert lines_of(translated(tmp_path, text)) == [
        "T1 M06", "S5000 M03", "M08", "G01 X1 F100", "M05", "T2 M06", "M03", "G01 X2", "M05", "M09", "M30", "%",
    ]  # fmt: skip


def test_outputs_by_the_map(tmp_path: Path) -> None:
    """The axes rest for an output of Eding CNC (3.5.9 there); M26 does not stop them (4.11): G04 does (3.5)."""
    text = "G17 G21 G90 G94 G54 G49\nG0 X1\nM54 P1\nG1 X2 F100\nM55 P1\nM30\n"
    done = translated(tmp_path, text, given=TranslationMap(outputs={1: 203}, given=True))
    assert lines_of(done) == ["G00 X1", "G04 0", "M26 203", "G01 X2 F100", "G04 0", "M27 203", "M30", "%"]
    refused = translated(tmp_path, text)
    assert [f.message.partition(" cannot")[0] for f in refused.findings.kept] == ["output 1", "output 1"]


def test_line_numbers_of_a_shop(tmp_path: Path) -> None:
    done = translated(
        tmp_path, "G17 G21 G90 G94 G54 G49\n#1 = 2\nG0 X#1\nM30\n", "`line_numbers = false` → `line_numbers = true`"
    )
    assert done.verdict is Verdict.SAFE
    assert done.files[""].decode().splitlines() == [
        "$DINEND", "var", "  v_b : double;", "{$DINSTART}", "%MAIN", "N10 G90 G71 G94 G162 G17", "N20 G54",
        "N30 v_b := 2", "N40 G00 X(v_b)", "N50 M30", "%",
    ]  # fmt: skip


def test_what_task_0_does_for_t(tmp_path: Path) -> None:
    """T may change the tool itself (5.5), or be of unknown effect."""
    text = "G17 G21 G90 G94 G54 G49\nT3\nG0 X1\nM6\nM30\n"
    changes = translated(tmp_path, text, '`T = "tool_select"` → `T = "tool_change"`')
    assert lines_of(changes) == ["G00 X1", "T3", "M30", "%"]
    unknown = translated(tmp_path, text, '`T = "tool_select"` → `T = "unknown"`')
    assert unknown.verdict is Verdict.UNKNOWN
    assert {f.span.line for f in unknown.findings.kept} <= {2, 4}


def test_tool_lengths_are_in_the_zero(tmp_path: Path) -> None:
    """McuWIN has none (3, 5.5): G92 in G91 adds to the zero offset (3.26), G54 puts its own record there (3.19).

    T1 and T2 are 40 mm long in the tool table of the source.
    """
    text = (
        "G17 G21 G90 G94 G54 G49\nT1 M6\nG43 H1\nG0 X1 Z5\nG53 G0 Z0\nT2 M6\nG43 H2\nG0 X1 Z5\nG92 X0\nG55\nG0 X1 Z9\n"
        "G49\nG0 Z50\nM30\n"
    )
    done = translated(tmp_path, text.replace("G92 X0\n", ""))
    zero_up = ["G91", "G92 Z40", "G90"]
    assert lines_of(done) == [
        "T1 M06", *zero_up, "G00 X1 Z5", "G92 Z0", "G00 Z0", "G54", *zero_up, "T2 M06", "G00 X1 Z5", "G55", *zero_up,
        "G00 X1 Z9", "G91", "G92 Z-40", "G90", "G00 Z50", "M30", "%",
    ]  # fmt: skip
    assert "tool 1 is 40 mm long: McuWIN has no tool lengths, the work zero is moved by it" in done.assumed
    with_local = translated(tmp_path, text)
    assert with_local.verdict is Verdict.SAFE


def test_another_length_than_that_of_the_source_is_another_place(tmp_path: Path) -> None:
    """The tool table of the source has 40 mm for T1: with 41 in the zero, the tip is elsewhere."""
    text = "G17 G21 G90 G94 G54 G49\nT1 M6\nG43 H1\nG0 X1 Z5\nM30\n"
    wrong = translated(tmp_path, text, given=TranslationMap(lengths={1: 41.0}))
    assert wrong.verdict is Verdict.UNSAFE
    assert not wrong.files or {f.code.label for f in wrong.findings.kept} == {"GP704"}


REFUSED = {
    "G41 D1\nG1 X1 F50\nG40": "cutter compensation",
    "G43 H7\nG0 Z5": "tool length offset",
    "M7\nG0 X1": "mist coolant",
    "G28\nG0 X1": "parking place of the controller",
    "G38.2 Z-5 F50": "probing move",
    "/G0 X1": "block delete",
}
"""What McuWIN does not have, or its manual leaves open."""


@pytest.mark.parametrize("body", REFUSED)
def test_refused(body: str, tmp_path: Path) -> None:
    done = translated(tmp_path, f"G17 G21 G90 G94 G54\n{body}\nM30\n")
    assert not done.files
    assert any(REFUSED[body] in f.message for f in done.findings.kept)


PATTERNS = {
    "end of a compensation that never starts -> nothing": ("G40\nG0 X1", "G0 X1"),
    "end of a tool length that is never used -> nothing": ("G49\nG0 X1", "G0 X1"),
    "tool length -> shift of the zero": ("G43 H1\nG0 Z5", "G49\nG0 Z5"),
    "zero while a tool length is in force -> moved by it": ("G43 H1\nG55\nG0 Z5", "G43 H1\nG0 Z5"),
    "inverse time -> a feed a move": ("G0 X0\nG93 G1 X5 F2", "G0 X0\nG1 X5 F2"),
    "machine coordinates -> zero there and back": ("G53 G0 X1", "G0 X1"),
    "work offset with a local offset -> with a shift": ("G0 X9\nG92 X0\nG55\nG0 X1", "G0 X9\nG92 X0\nG0 X1"),
    "change that stops the spindle -> spindle off, change": ("M3 S900\nT1 M6", "M3 S900\nM5"),
    "end that stops spindle and coolant -> both off, end": ("M3 S900\nG1 X1 F9\nM30", "M3 S900\nG1 X1 F9\nM5\nM2"),
}  # fmt: skip
"""Patterns with a program that needs each, and one that does not."""


@pytest.mark.parametrize("name", PATTERNS)
def test_pattern(name: str, tmp_path: Path) -> None:
    needs, other = PATTERNS[name]
    with_it = translated(tmp_path, f"G17 G21 G90 G94 G54\n{needs}\nM2\n")
    assert name in {one.pattern for one in with_it.lowered}
    without = translated(tmp_path, f"G17 G21 G90 G94 G54\n{other}\nM2\n")
    assert name not in {one.pattern for one in without.lowered}
