"""Jobs of Eding CNC for WinCNC: the text that a person who knows both manuals writes, and its proof.

Each case is written by hand: the lines of the program after its modes, those of WinCNC after ``G22``, ``G90`` and
``G49``. What the WinCNC manual says is under the heading or code in brackets.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from support.target_machines import machine_like
from support.traps import changed, machine_files

from gproof.driver.translation import Translation, Wanted, translate
from gproof.ir.translation_map import TranslationMap
from gproof.ir.verdict import Verdict

MODES = "G17 G21 G90 G94 G40 G49 G80 G54\n"
HEADER = ["G22", "G90", "G49"]
MACROS = {
    "CNC.MAC": "M3=M11C2\nM4=M11C1\nM5=M98 REST.MAC\nM6=M98 CHANGE.MAC\nM8=M11C3\nM9=M12C3\n",
    "REST.MAC": "M12C1\nM12C2\n",
    "CHANGE.MAC": "G53 Z0\nG4 [put it in]\nL101 T{t}\n",
}
"""A shop that has defined the spindle both ways, flood, and a tool change by hand [Macro File Configuration]."""


def translated(
    folder: Path, text: str, ini: str = "", given: TranslationMap | None = None, macros: dict[str, str] | None = None
) -> Translation:
    """A program of Eding CNC for the machine of the traps; ini: changes of its WINCNC.INI; given: a map."""
    for dialect in ("eding", "wincnc"):
        (folder / dialect).mkdir(exist_ok=True)
        for name, data in machine_files(dialect).items():
            (folder / dialect / name).write_text(changed(data.decode(), ini if name == "WINCNC.INI" else ""))
    for name, commands in (MACROS if macros is None else macros).items():
        (folder / "wincnc" / name).write_text(commands)
    job = folder / "job.cnc"
    job.write_text(text)
    return translate(
        Wanted(
            job=job, to="wincnc", machine=folder / "eding" / "machine.toml", dialect="eding", given=given,
            machine_to=folder / "wincnc" / "WINCNC.INI",
        )
    )  # fmt: skip


def lines_of(done: Translation) -> list[str]:
    """The lines after those for the modes."""
    assert [f"{f.span.line}: {f.message}" for f in done.findings.kept] == []
    assert done.verdict is Verdict.SAFE
    lines = done.files[""].decode().splitlines()
    assert lines[:3] == HEADER
    return lines[3:]


BODIES = {
    "rapids and feed moves: a feed for X and Y and another one for Z [Feed Velocity]": (
        "G0 X10 Y20 Z5\nG1 Z-1 F100\nX20\nY40 F300\nZ-2\nX0",
        ["G0 X10 Y20 Z5", "G1 Z-1 F100", "X20 F100", "Y40 F300", "Z-2 F300", "X0"],
    ),
    "arcs with both words of the centre, each with its code; a line after one says its code [G2, G3]": (
        "G0 X0 Y0\nG3 X10 Y10 J10 F200\nX20 Y20 I10\nG1 X30",
        ["G0 X0 Y0", "G3 X10 Y10 I0 J10 F200", "G3 X20 Y20 I10 J0", "G1 X30 F200"],
    ),
    "R becomes a centre": ("G0 X0 Y0\nG2 X10 Y10 R10 F200", ["G0 X0 Y0", "G2 X10 Y10 I10 J0 F200"]),
    "one command a line, the spindle before the move [Command Reference]": (
        "G1 X10 F100 S5000 M3\nG0 Z20 M5", ["S5000", "M3", "G1 X10 F100", "M5", "G0 Z20"]),
    "distances [G91]": ("G91\nG0 X1 Y2\nG1 Z-1 F50\nG90\nG0 X0", None),
    "a dwell is in seconds [G4]": ("G0 X1\nG4 P1.5\nG1 X2 F50", ["G0 X1", "G4 X1.5", "G1 X2 F50"]),
    "M0 is G4 alone: until the operator goes on [G4]": ("G0 X1\nM0\nG0 X2", ["G0 X1", "G4", "X2"]),
    "spindle backwards and flood by CNC.MAC": (
        "S8000 M4\nM8\nG1 X1 F50\nM9\nM5", ["S8000", "M4", "M8", "G1 X1 F50", "M9", "M5"]),
    "a hole has all its words, P is in milliseconds [G81, G82]": (
        "G0 X0 Y0 Z5\nG99 G81 X10 Y0 Z-3 R2 F60\nX20\nG82 X30 Z-3 R2 P0.5\nG80\nG0 Z9",
        ["G0 X0 Y0 Z5", "G81 X10 Y0 Z-3 R2 F60", "G81 X20 Z-3 R2", "G82 X30 Z-3 R2 P500", "G80", "G0 Z9"],
    ),
    "a hole that ends at the height before it: back to R, and up": (
        "G0 X0 Y0 Z5\nG98 G81 X10 Y0 Z-3 R2 F60\nG80",
        ["G0 X0 Y0 Z5", "G81 X10 Y0 Z-3 R2 F60", "G80", "G0 Z5"],
    ),
    "below R the hole goes up first in Eding CNC": (
        "G0 X0 Y0 Z0\nG99 G81 X10 Y0 Z-3 R2 F60\nG80", ["G0 X0 Y0 Z0", "Z2", "G81 X10 Y0 Z-3 R2 F60", "G80"]),
    "G53 for a rapid is a move of its own [G53]": (
        "G1 X1 F50\nG53 G0 Z0\nG1 X2", ["G1 X1 F50", "G53 Z0", "X2"]),
    "a zero that outlives the job [G92, L92]": ("G0 X50 Y0\nG92 X0 Y0\nG0 X5", [
        "G0 X50 Y0", "G92 X0 Y0", "X5", "L92"]),
    "a local offset that ends: shifted back [G92.2]": ("G0 X50 Y0\nG92 X0\nG0 X5\nG92.1\nG0 X5", [
        "G0 X50 Y0", "G92 X0", "X5", "G92.2 X-50", "X5", "L92"]),
    "comments": ("(one)\nG0 X1 ; two\n(a [b] c)", ["[one]", "G0 X1 [two]", "(a [b] c)"]),
    "a rotation is about I and J; X and Y are named first [G52]": (
        "G68 X10 Y20 R30\nG0 X5 Y5\nX6 Y6\nG69\nG0 X0 Y0", ["G52 I10 J20 A30", "G0 X5 Y5", "X6 Y6", "G50", "X0 Y0"]),
}  # fmt: skip
"""By what it is about: lines of Eding CNC after the modes; lines of WinCNC, None: see the test for it."""


@pytest.mark.parametrize("about", [about for about, (_, lines) in BODIES.items() if lines is not None])
def test_lines(about: str, tmp_path: Path) -> None:
    body, expected = BODIES[about]
    done = translated(tmp_path, f"{MODES}{body}\nM30\n")
    assert lines_of(done) == expected


def test_distances_say_their_mode_where_it_changes(tmp_path: Path) -> None:
    done = translated(tmp_path, f"{MODES}G91\nG0 X1 Y2\nG1 Z-1 F50\nG90\nG0 X0\nM30\n")
    assert done.verdict is Verdict.SAFE
    assert done.files[""].decode().splitlines() == ["G22", "G49", "G91", "G0 X1 Y2", "G1 Z-1 F50", "G90", "G0 X0"]


def test_a_subprogram_is_a_file(tmp_path: Path) -> None:
    text = f"sub hole\nG1 Z-1 F100\nG0 Z5\nendsub\n{MODES}G0 X0 Y0 Z5\ngosub hole\nG0 X10\ngosub hole\nM30\n"
    done = translated(tmp_path, text)
    assert lines_of(done) == ["G0 X0 Y0 Z5", "M98 HOLE.TAP", "G0 X10", "M98 HOLE.TAP"]
    assert done.files["HOLE.TAP"].decode().splitlines() == ["G1 Z-1 F100", "G0 Z5"]


def test_a_file_that_moves_the_zero_leaves_it_to_its_caller(tmp_path: Path) -> None:
    """M98 would give the caller's zero back; L92 keeps it, in the file and at the end of the job."""
    text = f"sub here\nG92 X0\nendsub\n{MODES}G0 X50 Y0\ngosub here\nG0 X5\nM30\n"
    done = translated(tmp_path, text)
    assert lines_of(done) == ["G0 X50 Y0", "M98 HERE.TAP", "G0 X5", "L92"]
    assert done.files["HERE.TAP"].decode().splitlines() == ["L92", "G92 X0"]


def test_a_tool_change_is_that_of_the_shop(tmp_path: Path) -> None:
    """Eding CNC counts no length without G43; a measure counts from the tool's number on, so G49 [L101, G49]."""
    done = translated(tmp_path, f"{MODES}G0 Z50\nT2 M6\nG0 X10\nM30\n")
    assert lines_of(done) == ["G0 Z50", "M6 T2", "G49", "G0 X10"]


REFUSED = {
    "optional stop": "M1",
    "cutter compensation": "G41 D1\nG1 X1 F50",
    "parking place of the controller": "G28",
    "probing move": "G38.2 Z-5 F20",
}


@pytest.mark.parametrize("construct", REFUSED)
def test_what_the_controller_cannot_have_is_refused_by_name(construct: str, tmp_path: Path) -> None:
    done = translated(tmp_path, f"{MODES}G0 X0 Y0 Z5\n{REFUSED[construct]}\nM30\n")
    assert not done.files
    assert any(construct in finding.message for finding in done.findings.kept)


def test_codes_that_cnc_mac_does_not_have_are_refused(tmp_path: Path) -> None:
    for body, what in (("T2 M6", "tool change"), ("S5000 M3", "spindle"), ("M8", "flood")):
        done = translated(tmp_path, f"{MODES}{body}\nG0 X1\nM30\n", macros={"CNC.MAC": "M30=[\n"})
        assert any(what in finding.message for finding in done.findings.kept), body


ARRAY = """G22
G90
G0 X5 Y7 Z5
L10 R1 C3 X20 Y0
G92 X Y
G1 X3 F200
G0 Z5
L10
G0 X1
"""
CELL = ["G92 X0 Y0", "G1 X3 F200", "G0 Z5"]


def test_cells_of_an_array_count_from_their_own_zero(tmp_path: Path) -> None:
    """Each cell names its start X0 Y0, so that the next one is 20 from there, and the first one 40 back [L10]; at the
    end the operator's zero is there again [L92]."""
    for dialect in ("eding", "wincnc"):
        (tmp_path / dialect).mkdir()
        for name, data in machine_files(dialect).items():
            (tmp_path / dialect / name).write_bytes(data)
    job = tmp_path / "job.tap"
    job.write_text(ARRAY)
    done = translate(
        Wanted(
            job=job, to="eding", machine=tmp_path / "wincnc" / "WINCNC.INI", dialect="wincnc",
            machine_to=tmp_path / "eding" / "machine.toml",
        )
    )  # fmt: skip
    assert done.verdict is Verdict.SAFE
    lines = done.files[""].decode().splitlines()
    begin = lines.index("X20 Y0") - len(CELL)
    assert lines[begin : begin + 4 * len(CELL)] == [*CELL, "X20 Y0", *CELL, "X20 Y0", *CELL, "X-40 Y0"]


def test_an_output_that_runs_the_spindle_there_is_refused(tmp_path: Path) -> None:
    """CNC.MAC of that machine has M3=M11C2: output 2 is the spindle, whatever it is on the other machine."""
    text = f"{MODES}M54 P1\nG0 X1\nM55 P1\nM30\n"
    done = translated(tmp_path, text, given=TranslationMap(outputs={1: 2}, given=True))
    assert done.verdict is Verdict.UNKNOWN and not done.files
    assert [one.code.label for one in done.findings.kept] == ["GP703"] and "output 1" in done.findings.kept[0].message
    assert translated(tmp_path, text, given=TranslationMap(outputs={1: 5}, given=True)).verdict is Verdict.SAFE


def test_axes_that_share_no_feed_say_it_in_each_move(tmp_path: Path) -> None:
    """Without vgroup=XY an F next to X leaves the feed of Y as it was [vgroup=]."""
    text = f"{MODES}G0 X0 Y0 Z5\nG1 X10 F100\nY10\nX20 Y20\nG2 X30 Y10 I0 J-10\nG1 Y0\nM30\n"
    both = translated(tmp_path, text, "`vgroup=FXY` → `vgroup=FX`; `vgroup=XY` → `vgroup=X`")
    assert lines_of(both)[1:] == [
        "G1 X10 F100", "Y10 F100", "X20 Y20 F100", "G2 X30 Y10 I0 J-10 F100", "G1 Y0 F100"
    ]  # fmt: skip


TURNED = "S8000 M3\nG1 X1 F50\n{}M4\nG1 X2\nM5\n"
BOTH_WAYS = MACROS | {
    "CNC.MAC": "M3=M98 CW.MAC\nM4=M98 CCW.MAC\nM5=M98 REST.MAC\n", "CW.MAC": "M11C2\nM12C1\n",
    "CCW.MAC": "M11C1\nM12C2\n",
}  # fmt: skip


def test_a_spindle_is_not_turned_round_by_an_m4_that_leaves_the_output_of_m3_on(tmp_path: Path) -> None:
    """M4=M11C1 of that CNC.MAC leaves output 2, which M3 has switched on, as it is: both are on then."""
    loop = "#1 = 0\nwhile [#1 < 2]\nM4\nG1 X2\nM3\nG1 X1\n#1 = [#1 + 1]\nendwhile\nM5\n"
    for body in (TURNED.format(""), f"S8000 M3\nG1 X1 F50\n{loop}"):
        done = translated(tmp_path, f"{MODES}{body}M30\n")
        assert done.verdict is Verdict.UNKNOWN and not done.files
        first = done.findings.kept[0]
        assert first.code.label == "GP703" and "straight into the other" in first.message and "M5" in first.message
    for body, macros in ((TURNED.format("M5\n"), MACROS), (TURNED.format(""), BOTH_WAYS)):
        done = translated(tmp_path, f"{MODES}{body}M30\n", macros=macros)
        assert done.verdict is Verdict.SAFE, [one.message for one in done.findings.kept]


def test_a_line_after_a_helix_says_its_feed(tmp_path: Path) -> None:
    """Whether the F of an arc is also that of the lines of its axes, the manual leaves open [Feed Velocity]."""
    rows = "G0 X0 Y0 Z1\nG1 Z0 F100\nG1 X10 F300\nG2 X20 Y10 I10 Z-1 F200\nG1 Z-2 F100\nX30 F300\n"
    passes = "G2 X20 Y10 I10 Z[-1 - #1] F200\nG1 Z[-2 - #1] F100\nX10 Y0 F300\n"
    loop = f"#1 = 0\nwhile [#1 < 2]\n{passes}#1 = [#1 + 1]\nendwhile\n"
    for text in (rows, f"G0 X10 Y0 Z1\nG1 Z0 F100\n{loop}"):
        lines = lines_of(translated(tmp_path, f"{MODES}{text}M30\n"))
        after = [lines[n + 1] for n, line in enumerate(lines) if line.startswith("G2 ")]
        assert after and all("F100" in line for line in after), lines


def test_a_helix_of_wincnc_leaves_the_feed_of_the_next_plunge_open(tmp_path: Path) -> None:
    """By one reading it is that of the helix, by the other that of the last line: nothing is proven."""
    for name, data in machine_files("wincnc").items():
        (tmp_path / name).write_bytes(data)
    text = "G22\nG90\nG0 X0 Y0 Z5\nG1 Z0 F100\nG1 X10 F300\nG2 X20 Y10 I10 J0 Z-1 F{}\nG1 Z-2\n"
    machine_to = machine_like(tmp_path / "WINCNC.INI", "eding", tmp_path / "to")
    for feed, is_proven in ((200, False), (100, True)):
        job = tmp_path / f"job{feed}.tap"
        job.write_text(text.format(feed))
        done = translate(
            Wanted(
                job=job, to="eding", machine=tmp_path / "WINCNC.INI", machine_to=machine_to, dialect="wincnc"
            )
        )  # fmt: skip
        assert (done.verdict is Verdict.SAFE) == is_proven, [one.message for one in done.findings.kept]
