"""Every "It is an error if" and every listed error message of the Eding CNC manual, each with a program that has it.

Rows: section, what is wrong (in short), lines of a program, the code that must be its only error.
"""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest
from passes.interpret.core.programs import HEAD
from support.judging import judged

from gproof.ir.finding import Severity

MILL, LATHE = "mill", "lathe"
TOOL = "T1 M6\nS900 M3\nF600\nG0 Z10\nG0 X0 Y0\n"
"""Tool 1 is 6 mm thick."""
ON = TOOL + "G41 D1\nG1 X20 Y20\n"
HOLES = "F100\nG0 Z10\n"
THREAD = "G18\nS500 M3\nG0 X20 Z20\n"


@dataclasses.dataclass(frozen=True)
class Row:
    section: str
    wrong: str
    lines: str
    code: str
    machine: str = MILL


def cycle(lines: str) -> str:
    return HOLES + lines


ROWS = (
    # chapter 3.1 to 3.3: lines
    Row("3.2", "a character that is not allowed", "G0 X1 ? Y2\n", "GP101"),
    Row("3.2", "more characters than a line may have", "G0 X1 (" + "x" * 260 + ")\n", "GP106"),
    Row("3.2.1", "a line number with more than five digits", "N000009 G0 X1\n", "GP105"),
    Row("3.2.1", "a line number that is not in its place", "G0 N10 X1\n", "GP105"),
    Row("3.2.2", "a letter that begins no word", "G0 X1 U3\n", "GP101"),
    Row("3.2.2.1", "a number without a digit", "G0 X.\n", "GP102"),
    Row("3.2.2.2", "a parameter number that is not whole", "#[1.5] = 3\n", "GP226"),
    Row("3.2.2.2", "a parameter number below 1", "#[0] = 3\n", "GP226"),
    Row("3.2.2.3", "a bracket that is not closed", "G0 X[1 + 2\n", "GP107"),
    Row("3.2.2.4", "arc tangent of one value", "G0 X[atan[1]]\n", "GP107"),
    Row("3.2.4", "a comment that is not closed", "G0 X1 (foo\n", "GP103"),
    Row("3.2.4", "a left parenthesis in a comment", "G0 X1 (foo (bar))\n", "GP104"),
    Row("3.2.5", "two G codes of one modal group", "G0 G1 X1 F100\n", "GP110"),
    Row("3.2.5", "more than four M codes", "S100 M3 M7 M48 M54 P1 M0\n", "GP111"),
    Row("3.2.5", "two M codes of one modal group", "S100 M3 M4\n", "GP110"),
    Row("3.2.5", "one letter twice", "G0 X1 X2\n", "GP109"),
    Row("3.3", "a motion code and a code of group 0, both with axis words", "G1 G92 X1 F100\n", "GP224"),
    Row("3.4", "a required item is left out (G10 without L)", "G10 P1 X1\n", "GP209"),
    # 3.4: G codes
    Row("3.4.1", "G0 without axis words", "G0\n", "GP201"),
    Row("3.4.2", "G1 without axis words", "F100\nG1\n", "GP201"),
    Row("3.4.3.2", "radii at start and end of an arc differ", "F100\nG0 X0 Y0\nG2 X10 Y0 I5.1\n", "GP401"),
    Row("3.4.3.2", "the same in inches, beyond 0.0002", "G20\nF9\nG0 X0 Y0\nG2 X1 Y0 I0.5003\n", "GP401"),
    Row("3.4.3.2", "XY: I and J left out", "F100\nG2 X10\n", "GP203"),
    Row("3.4.3.2", "XZ: I and K left out", "G18\nF100\nG2 X10\n", "GP203"),
    Row("3.4.3.2", "YZ: J and K left out", "G19\nF100\nG2 Y10\n", "GP203"),
    Row("3.4.3", "no word of the arc's plane", "F100\nG2 Z10 I5\n", "GP201"),
    Row("3.4.4", "a negative dwell", "G4 P-1\n", "GP206"),
    Row("3.4.5", "G10 for system 0", "G10 L2 P0 X1\n", "GP208"),
    Row("3.4.5", "G10 for system 10", "G10 L2 P10 X1\n", "GP208"),
    Row("3.4.5", "G10 for system 1.5", "G10 L2 P1.5 X1\n", "GP208"),
    Row("3.4.9", "G33 without axis words", "S500 M3\nG33 K1\n", "GP201"),
    Row("3.4.9", "G33 while the spindle rests", "M5\nG33 Z-1 K1\n", "GP244"),
    Row("3.4.9", "G33.1 while the spindle rests", "M5\nG33.1 Z-1 K1\n", "GP244"),
    Row("3.4.9", "faster than the machine", "S6000 M3\nG33 Z-10 K1.5\n", "GP510"),
    Row("3.4.10.1", "probing less than 0.254 mm", "F50\nG38.2 Z-0.25\n", "GP291"),
    Row("3.4.10.1", "probing less than 0.01 inch", "G20\nF2\nG38.2 Z-0.0099\n", "GP291"),
    Row("3.4.10.1", "probing in inverse time", "G93\nG38.2 Z-20 F2\n", "GP292"),
    Row("3.4.10.1", "probing turns an axis", "F50\nG38.2 Z-20 A5\n", "GP293"),
    Row("3.4.10.1", "probing without X, Y or Z", "F50\nG38.2 A0\n", "GP294"),
    Row("3.4.11", "D is not whole", TOOL + "G41 D1.5\n", "GP229"),
    Row("3.4.11", "D is negative", TOOL + "G41 D-1\n", "GP253"),
    Row("3.4.11", "D beyond the slots", TOOL + "G42 D100\n", "GP254"),
    Row("3.4.11", "compensation in the YZ plane", TOOL + "G19\nG41 D1\n", "GP249"),
    Row("3.4.11", "on while it is on", ON + "G41 D1\n", "GP250"),
    Row("3.4.12", "H is no tool of the table", "G43 H100\n", "GP236"),
    Row("3.4.14", "G53 without G0 or G1", "F100\nG53 G2 X10 I5\n", "GP210"),
    Row("3.4.14", "G53 under compensation", ON + "G53 G1 X50\n", "GP211"),
    Row("3.4.14", "G53 without axis words", "G0 G53\n", "GP201"),
    Row("3.4.15", "another system under compensation", ON + "G55\n", "GP246"),
    Row("3.4.19", "threading in another plane", "S500 M3\nG0 X20 Z20\nG76 P1 Z10 I-5 J0.25 K1\n", "GP261", LATHE),
    Row("3.4.19", "threading with X", THREAD + "G76 P1 X3 Z10 I-5 J0.25 K1\n", "GP262", LATHE),
    Row("3.4.19", "threading with Y", THREAD + "G76 P1 Y3 Z10 I-5 J0.25 K1\n", "GP262", LATHE),
    Row("3.4.19", "degression below 1", THREAD + "G76 P1 Z10 I-5 J0.25 K1 R0.5\n", "GP262", LATHE),
    *(
        Row(
            "3.4.19",
            f"{left} is left out",
            THREAD + "G76 " + " ".join(word for word in ("P1", "Z10", "I-5", "J0.25", "K1") if word[0] != left) + "\n",
            "GP275",
            LATHE,
        )
        for left in "PZIJK"
    ),
    Row("3.4.19", "P negative", THREAD + "G76 P-1 Z10 I-5 J0.25 K1\n", "GP262", LATHE),
    Row("3.4.19", "J negative", THREAD + "G76 P1 Z10 I-5 J-0.25 K1\n", "GP262", LATHE),
    Row("3.4.19", "K negative", THREAD + "G76 P1 Z10 I-5 J0.25 K-1\n", "GP262", LATHE),
    Row("3.4.19", "H negative", THREAD + "G76 P1 Z10 I-5 J0.25 K1 H-1\n", "GP262", LATHE),
    Row("3.4.19", "taper longer than half the line", THREAD + "G76 P1 Z10 I-5 J0.25 K1 E5.5 L3\n", "GP262", LATHE),
    Row("3.4.20", "axis words under G80", "G80\nX10\n", "GP202"),
    # 3.4.21: cycles
    Row("3.4.21", "X, Y and Z all missing", cycle("G81 R5\n"), "GP215"),
    Row("3.4.21", "negative P where P is required", cycle("G82 X1 Z-5 R5 P-1\n"), "GP218"),
    Row("3.4.21", "L0", cycle("G81 X1 Z-5 R5 L0\n"), "GP219"),
    Row("3.4.21", "L not whole", cycle("G81 X1 Z-5 R5 L1.5\n"), "GP219"),
    Row("3.4.21", "L negative", cycle("G81 X1 Z-5 R5 L-2\n"), "GP219"),
    Row("3.4.21", "rotary motion", cycle("G81 X1 Z-5 R5 A5\n"), "GP220"),
    Row("3.4.21", "inverse time", cycle("G93\nG81 X1 Z-5 R5 F2\n"), "GP221"),
    Row("3.4.21", "compensation", ON + "G81 X30 Z-5 R5\n", "GP238"),
    Row("3.4.21", "XY: Z missing, cycle not active", cycle("G81 X1 R5\n"), "GP216"),
    Row("3.4.21", "XY: Z missing, another cycle active", cycle("G81 X1 Z-5 R5\nG82 X2 P1\n"), "GP216"),
    Row("3.4.21", "XY: R below Z", cycle("G81 X1 Z5 R2\n"), "GP217"),
    Row("3.4.21", "XZ: Y missing", cycle("G18\nG81 X1 R5\n"), "GP216"),
    Row("3.4.21", "XZ: R below Y", cycle("G18\nG81 X1 Y5 R2\n"), "GP217"),
    Row("3.4.21", "YZ: X missing", cycle("G19\nG81 Y1 R5\n"), "GP216"),
    Row("3.4.21", "YZ: R below X", cycle("G19\nG81 Y1 X5 R2\n"), "GP217"),
    Row("3.4.21.4", "G83 with Q0", cycle("G83 X1 Z-5 R5 Q0\n"), "GP222"),
    Row("3.4.21.4", "G83 with a negative Q", cycle("G83 X1 Z-5 R5 Q-1\n"), "GP222"),
    Row("3.4.21.5", "G73 with Q0", cycle("G73 X1 Z-5 R5 Q0\n"), "GP222"),
    Row("3.4.21.5", "G73 with a negative Q", cycle("G73 X1 Z-5 R5 Q-1\n"), "GP222"),
    Row("3.4.21.9", "G86 while the spindle rests", cycle("M5\nG86 X1 Z-5 R5 P1\n"), "GP244"),
    Row("3.4.23", "G92 without axis words", "G92\n", "GP212"),
    Row("3.4.24", "G93: a feed move without F", "G93\nG1 X1 F2\nX2\n", "GP205"),
    # 3.5, 3.6: M codes and other words
    Row("3.5.9", "an output's share beyond 1000", "M54 E1 Q1001\n", "GP283"),
    Row("3.5.9", "a wait mode that is not 0, 1 or 2", "M56 P1 L3 Q1\n", "GP297"),
    Row("3.5.10", "the clamped axis moves", "M26\nG0 A5\n", "GP279"),
    Row("3.6.2", "negative spindle speed", "S-1\n", "GP213"),
    Row("3.6.3", "negative tool", "T-1\n", "GP214"),
    Row("3.6.3", "a tool beyond the slots", "T100\n", "GP214"),
    # 4: extensions
    Row("4.1", "an if that is not closed", "if [1 == 1]\nG0 X1\n", "GP114"),
    Row("4.1", "a call of what is not there", "gosub nothing\n", "GP115"),
    Row("4.4", "other codes beside a replaced one", "sub m123\nM9\nendsub\nM123 M8 G1 X100\n", "GP290"),
    # 5.4: the seventeen messages, in their order
    Row("5.4 (1)", "axis offsets change", ON + "G92 X0\n", "GP246"),
    Row("5.4 (2)", "units change", ON + "G20\n", "GP247"),
    Row("5.4 (3)", "probing", ON + "G38.2 X50\n", "GP248"),
    Row("5.4 (4)", "on out of the XY plane", TOOL + "G19\nG42 D1\n", "GP249"),
    Row("5.4 (5)", "on when on", ON + "G42 D1\n", "GP250"),
    Row("5.4 (6)", "G28", ON + "G28 X30\n", "GP251"),
    Row("5.4 (6)", "G30", ON + "G30 X30\n", "GP251"),
    Row("5.4 (7)", "G53", ON + "G53 G0 X50\n", "GP211"),
    Row("5.4 (8)", "G18", ON + "G18\n", "GP252"),
    Row("5.4 (9)", "G19", ON + "G19\n", "GP252"),
    Row("5.4 (10)", "a concave corner", ON + "G1 X60\nG1 Y40\n", "GP410"),
    Row("5.4 (11)", "gouging", TOOL + "G41 D1\nG1 X2\n", "GP411"),
    Row("5.4 (12)", "D without G41 or G42", TOOL + "G1 X5 D1\n", "GP121"),
    Row("5.4 (13)", "two D words", TOOL + "G41 D1 D1\n", "GP109"),
    Row("5.4 (14)", "negative D", TOOL + "G42 D-1\n", "GP253"),
    Row("5.4 (15)", "D too big", TOOL + "G41 D100\n", "GP254"),
    Row("5.4 (16)", "tool radius not less than the arc's", ON + "G1 X60\nG3 X62 Y22 R2\n", "GP412"),
    Row("5.4 (17)", "two codes of the group", TOOL + "G40 G41 D1\n", "GP110"),
)

MISSING: tuple[Row, ...] = ()
"""Rows whose error is not there yet; the test fails when one begins to work, so that it moves up."""


def machines(folder: Path) -> dict[str, Path]:
    """A mill with four axes and six tools, and a lathe that has said how it looks at XZ and what I of G76 is."""
    axis = 'kind = "{}"\nmin = -600.0\nmax = 600.0\nmax_velocity = 100.0\nmax_acceleration = 500.0\n'
    text = 'schema = "gproof-machine/1"\nname = "m"\nunits = "mm"\n'
    text += "".join(f"[axes.{n}]\n{axis.format('linear')}" for n in "xyz") + f"[axes.a]\n{axis.format('rotary')}"
    text += "".join(f"[tools.{k}]\nlength = {10.0 * k}\ndiameter = 6.0\n" for k in range(1, 7))
    found = {}
    for name, controller in ((MILL, ""), (LATHE, 'xz_seen_from = "-y"\nthread_peak = "offset"\n')):
        found[name] = folder / f"{name}.toml"
        found[name].write_text(f'{text}[controller]\ndialect = "eding"\n{controller}')
    return found


def errors(folder: Path, row: Row) -> list[str]:
    job = folder / "job.cnc"
    job.write_text(f"{HEAD}{row.lines}M30\n")
    judgement = judged(job, machines(folder)[row.machine], "zero")
    return [f.code.label for f in judgement.findings.kept if f.severity is Severity.ERROR]


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row.section} {row.wrong}")
def test_it_is_an_error(tmp_path: Path, row: Row) -> None:
    assert errors(tmp_path, row) == [row.code]


def test_what_is_missing_is_still_missing(tmp_path: Path) -> None:
    assert [row for row in MISSING if errors(tmp_path, row) == [row.code]] == []


@pytest.mark.parametrize("value", [0.0, 10.0, 1.5, -1.0])
def test_the_coordinate_system_at_the_start(tmp_path: Path, value: float) -> None:
    """3.1.3: parameter 5220 must be whole, 1 to 9."""
    job, setup = tmp_path / "job.cnc", tmp_path / "setup.toml"
    job.write_text("G21 G90\nG0 X1\nM30\n")
    setup.write_text(f'schema = "gproof-setup/1"\nhomed = ["x", "y", "z", "a"]\n[parameters]\n5220 = {value}\n')
    judgement = judged(job, machines(tmp_path)[MILL], str(setup))
    assert [f.code.label for f in judgement.findings.kept if f.severity is Severity.ERROR] == ["GP235"]
