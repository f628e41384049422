"""What generated programs have found, each in a few lines: expected texts are worked out by hand from the manuals."""

from __future__ import annotations

from pathlib import Path

import pytest

from gproof.driver.translation import Translation
from gproof.ir.verdict import Verdict

from .generated.cases import translated, written
from .generated.judged import Figures, judge
from .generated.writer import Made

EDING = "G17 G21 G90 G94 G54 G40 G49 G80\n"
MCUWIN = "%JOB\nG90\nG71\nG94\nG17\nG162\nG54\nF300 S3000\n"
WINCNC = "G22\nG90\nS3000\n"
EXTENSION = {"eding": ".cnc", "wincnc": ".tap", "mcuwin": ".src"}


def translation(folder: Path, dialect: str, to: str, text: str) -> Translation:
    if dialect == "mcuwin":
        head = MCUWIN.replace("G54\n", "") if "G55" in text else MCUWIN
        text = f"{head}{text}%\n"
    else:
        text = (EDING if dialect == "eding" else WINCNC) + text
    job = written(Made(dialect, EXTENSION[dialect], text), folder)
    return translated(job, dialect, to, exact=False)


LINES = {
    "G94 takes the feed away, also where it is in force already (LinuxCNC's interpreter)": (
        "eding",
        "linuxcnc",
        "sub p\nG93 G1 X5 F2\nG94 F300\nendsub\nF300\nG0 X0 Y0 Z0\ngosub p\nG91 G3 X6 Y-6 I0 J-6\nM30\n",
        ["G94 F300", "G91 G3 X6 Y-6 I0 J-6"],
        ["G91 G94 G3 X6 Y-6 I0 J-6"],
    ),
    "the end of a file stops nothing, M2 does (LinuxCNC Overview, File Requirements; Eding 3.5.1)": (
        "eding",
        "linuxcnc",
        "G0 X1 Y1 Z1\nS1000 M3\nM2\n",
        ["%", "X1 Y1 Z1", "M3", "%"],
        ["M2", "M5"],
    ),
    "an arc by its radius needs no G91.1 (LinuxCNC G-Codes, G90.1 G91.1)": (
        "eding",
        "linuxcnc",
        "F300\nG0 X0 Y0 Z0\nG2 X5 Y5 R5\nM30\n",
        ["G2 X5 Y5 R5"],
        ["G91.1"],
    ),
    "a feed below 1 has as many digits that count (3.7: F of a line is in the unit before it)": (
        "eding",
        "wincnc",
        "G0 X0 Y0 Z0\nG20 F7.87\nG1 X1\nM30\n",
        ["F0.30984"],
        [],
    ),
    "the end of a file brings the zero back, without the local one (L92; McuWIN 3.19)": (
        "wincnc",
        "mcuwin",
        "G0 X10 Y0 Z0\nG92 X0\nG0 X5\n",
        ["G92 X10", "X5", "G54", "M30"],
        [],
    ),
    "a zero that a job leaves behind outlives the file (McuWIN 3.26; L92)": (
        "mcuwin",
        "wincnc",
        "G00 X0 Y0 Z0\nG91\nG92 X5\nG90\nG01 X1\nM30\n",
        ["G92.2 X5", "G1 X1 F300", "L92"],
        [],
    ),
    "G161 after G00, whose places are millimetres: a centre from there (3.1, 3.35)": (
        "mcuwin",
        "eding",
        "G161\nG70 F10\nG00 X50.8 Y0 Z0\nG02 X4 Y0 I3 J0\nM30\n",
        ["G2 X4 Y0 I1 J0"],
        [],
    ),
    "an arc in a loop has its own centre words (3.3)": (
        "mcuwin",
        "eding",
        "$for CI601 := 1 to 2 do begin\nG00 X0 Y0 Z0\nG01 X(CI601)\nG00 X0\nG02 X10 Y0 I5 J0\n$end;\nM30\n",
        ["G2 X10 Y0 I5 J0"],
        [],
    ),
    "a wait without a limit reads the input until then (M17; Eding 3.5.9, 4.1)": (
        "wincnc",
        "eding",
        "G0 X0 Y0 Z0\nM17C2\nG0 X1\n",
        ["P2 M56", "while [#5399 == 0]", "P2 M56", "endwhile"],
        [],
    ),
    "a choice by an input asks as the manual does (M17.1; Eding 3.5.9)": (
        "wincnc",
        "eding",
        "G0 X0 Y0 Z0\nM18.1C2\nG0 X1\n",
        ["P2 M56", "if [#5399 == 0]", "endif"],
        [],
    ),
    "and back (Eding 3.5.9; M18.1)": (
        "eding",
        "wincnc",
        "G0 X0 Y0 Z0\nM56 P2\nif [#5399 == 0]\nG0 X1\nendif\nM30\n",
        ["M18.1 C2", "X1"],
        [],
    ),
    "an input that is read until it is off is a wait (Eding 3.5.9; M18)": (
        "eding",
        "wincnc",
        "G0 X0 Y0 Z0\nM56 P2\nwhile [#5399 == 1]\nM56 P2\nendwhile\nG0 X1\nM30\n",
        ["M18 C2", "X1"],
        [],
    ),
    "S before M04 is part of it (Eding 3.7; McuWIN 5.4)": (
        "eding",
        "mcuwin",
        "G0 X0 Y0 Z0\nS6000 M3\nG0 X1\nM4 S3000\nG0 X2\nM30\n",
        ["S6000 M03", "S3000 M04"],
        [],
    ),
    "an output before a zero changes acts at rest after a feed (McuWIN 3.26, 4.11; M11)": (
        "mcuwin",
        "wincnc",
        "G00 X0 Y0 Z0\nG01 X1\nM26 105\nG91\nG92 X5\nG90\nG01 X1\nM30\n",
        ["M11 C5", "G92.2 X5"],
        [],
    ),
    "G92.1 of X after G92 of Y: Y is 10 less 4 from the work offset (G92, G92.1; Eding 3.4.5)": (
        "wincnc",
        "eding",
        "G0 X0 Y10 Z0\nG92 Y4\nG92.1 X30\nG0 X1 Y1\n",
        ["G92.1", "G10 X30 Y[#5222 + 6] Z#5223 P9 L2", "G59.3", "X1 Y1", "G54"],
        [],
    ),
    "places of centres in Z-X as chords from the right start (3.7, 3.35)": (
        "mcuwin",
        "wincnc",
        "G161\nG18\nG00 X10 Y0 Z0\nG02 Z10 X20 K10 I10\nM30\n",
        ["X20 Z10"],
        [],
    ),
    "a program that names no work offset starts in that of the machine (McuWIN 3.19)": (
        "mcuwin",
        "eding",
        "G55\nG00 X0 Y0 Z0\nM30\n",
        ["G55", "G0 X0 Y0 Z0"],
        [],
    ),
    "G68 has its place in G90 (Eding 3.4.18; G52)": (
        "wincnc",
        "eding",
        "G0 X0 Y0 Z0\nG91\nG0 X1\nG90\nG52 I1 J2 A90\nG0 X5 Y5\nG50\nG0 X0 Y0\n",
        ["G90", "G68 X1 Y2 R90", "G69"],
        [],
    ),
    "M27 before a stop acts at rest: M65 needs no motion after it (LinuxCNC M62 to M65)": (
        "mcuwin",
        "linuxcnc",
        "G00 X0 Y0 Z0\nM27 105\nM00\nG00 X1\nM30\n",
        ["M65 P5", "M0"],
        ["M63 P5"],
    ),
    "G92.1 of Eding CNC takes away what G92 has added (3.4.23; G92.2)": (
        "eding",
        "wincnc",
        "G0 X0 Y0 Z5\nG92 Z1\nG0 Z2\nG92.1\nG54\nG0 X1\nM30\n",
        ["G92 Z1", "Z2", "G92.2 Z-4", "X1", "L92"],
        ["G92.2"],
    ),
    "boring feeds up to the height before it (Eding 3.4.21.8)": (
        "eding",
        "wincnc",
        "G0 X0 Y0 Z10\nF100\nG98 G85 X1 Y1 Z-5 R2\nG80\nM30\n",
        ["X1 Y1", "Z2", "G1 Z-5 F100", "Z10"],
        ["G0 Z10"],
    ),
    "G92 of X leaves the height of Z known: first up, then to the hole (Eding 3.4.21.1; G81)": (
        "eding",
        "wincnc",
        "F100\nG0 X0 Y0 Z0\nG92 X5\nG99 G81 X10 Y0 Z-5 R2\nG80\nM30\n",
        ["G92 X5", "Z2", "G81 X10 Y0 Z-5 R2 F100"],
        [],
    ),
    "S after a stop, while the spindle turns (Eding 3.5.2; CNC.MAC)": (
        "eding",
        "wincnc",
        "G0 X0 Y0 Z0\nS1000 M3\nM0\nS2000\nG0 X1\nM30\n",
        ["M3", "G4", "S2000", "X1", "M5"],
        [],
    ),
    "a work offset ends what G92 has added to the zero before; G92 outlives it (McuWIN 3.26; grbl, G92.1)": (
        "mcuwin",
        "grbl",
        "G00 X5 Y0 Z0\nG91\nG92 X3\nG90\nG57\nG00 X1\nM30\n",
        ["G92 X2", "G92.1", "G57", "X1"],
        [],
    ),
    "an output after a zero changes acts at rest after a feed (McuWIN 3.26, 4.11; M11)": (
        "mcuwin",
        "wincnc",
        "G00 X0 Y0 Z0\nG01 X1\nG91\nG92 X5\nG90\nM26 105\nG01 X1\nM30\n",
        ["G92.2 X5", "M11 C5", "X1"],
        [],
    ),
    "an output after a rapid and a change of the zero does not: G00 is no contour (McuWIN 3.26; M13)": (
        "mcuwin",
        "wincnc",
        "G00 X0 Y0 Z0\nG91\nG92 X5\nG90\nM26 105\nG01 X1\nM30\n",
        ["G92.2 X5", "M13 C5", "X1 F300"],
        [],
    ),
    "S in the line of M03 is part of it, after a stop too (McuWIN 5.4; LinuxCNC, Order of Execution)": (
        "mcuwin",
        "linuxcnc",
        "G00 X0 Y0 Z0\nM04\nG00 X1\nM00\nG00 X2\nS6000 M03\nG01 X3\nM30\n",
        ["M4", "M0", "S6000 M3"],
        [],
    ),
    "M7 after M8 and a stop leaves flood as it is; M9 is both outputs (Eding 3.5.4; CNC.MAC)": (
        "eding",
        "wincnc",
        "G0 X0 Y0 Z0\nM8\nG0 X1\nM0\nG0 X2\nM7\nG0 X3\nM9\nG0 X4\nM30\n",
        ["M8", "G4", "M7", "M9"],
        [],
    ),
    "two outputs off in the file of M9 are one M9 (CNC.MAC; Eding 3.5.4)": (
        "wincnc",
        "eding",
        "G0 X0 Y0 Z0\nM7\nG0 X1\nM8\nG0 X2\nM9\nG0 X3\n",
        ["M7", "M8", "M9", "X3"],
        [],
    ),
    "M30 switches the coolant off, also where it is on on one way alone (Eding 3.5.1)": (
        "eding",
        "mcuwin",
        "G0 X0 Y0 Z0\n#1 = 3\nsub p\nif [#1 > 5]\nM8\nendif\nG0 X1\nendsub\ngosub p\nM30\n",
        ["M98 L1000", "M09", "M30"],
        [],
    ),
    "and after a stop, at which the operator may have switched it on (Eding 3.5.1)": (
        "eding",
        "mcuwin",
        "G0 X0 Y0 Z0\nM8\nG0 X1\nM9\nM56 P2\nif [#5399 == 1]\nM8\nendif\nM0\nG0 X2\nM30\n",
        ["M00", "M09", "M30"],
        [],
    ),
    "each relative place makes up for what the one before has left out": (
        "eding",
        "mcuwin",
        "G0 X0 Y0 Z0\nF100\nG20 G91\nG1 X0.0001\nX0.0001\nX0.0001\nX0.0001\nM30\n",
        ["X0.0025", "X0.0026", "X0.0025", "X0.0026"],  # 0.00254 0.00508 0.00762 0.01016 mm
        [],
    ),
    "distances of a subprogram have all their digits: it may be called again (G20, G91; McuWIN 3.25)": (
        "eding",
        "mcuwin",
        "sub p\nG1 X0.12345\nX0.12345\nendsub\nG20 F10\nG0 X0 Y0 Z0\nG91\ngosub p\ngosub p\nG90\nM30\n",
        ["M98 L1000", "M98 L1000", "G01 X3.13563", "X3.13563", "M17"],
        ["X3.1356", "G01 X3.1356"],
    ),
    "a peck that ends at the bottom in decimals is the last one (G73; 10.56 - 3 times 2.63 is 2.67)": (
        "wincnc",
        "linuxcnc",
        "G0 X0 Y0 Z20\nG73 X1 Y1 Z2.67 R10.56 Q2.63 F30\nG80\nG0 X2\n",
        ["G1 Z7.93", "G1 Z5.3", "G1 Z2.67", "G0 Z10.56", "X2"],
        ["Z3.94", "G0 Z3.94"],
    ),
    "an output after a zero that ends a contour does not stop motion itself (McuWIN 3.26, 4.11; M13)": (
        "wincnc",
        "mcuwin",
        "G0 X0 Y0 Z0\nG92 X5\nM13C5\nG0 X9\n",
        ["G92 X-5", "M26 105", "X9"],
        [],
    ),
    "a full circle by its end where places are sums, 0.1 + 0.2 + 0.3 (G2, G3; grbl goes all round)": (
        "wincnc",
        "grbl",
        "G0 X0.1 Y0.1 Z0\nG91\nG1 X0.2 Y0.2 F100\nX0.3 Y0.3\nG3 I5 J1 F100\nG3 I1 J5\nG2 I-5 J1\nG2 I1 J-5\n",
        ["G90 G3 X0.6 Y0.6 I5 J1", "X0.6 Y0.6 I1 J5", "G2 X0.6 Y0.6 I-5 J1", "X0.6 Y0.6 I1 J-5"],
        [],
    ),
    "F after a call counts where each way to it has set the same (M98; Feed Velocity)": (
        "mcuwin",
        "wincnc",
        "G00 X0 Y0 Z0\nF100\nM98 L10\nM98 L10\nM30\n%\n%10\nM98 L11\nG01 Y1 Z2\nG00 X5\nM17\n%\n"
        "%11\nG01 X1 F600\nM17\n",
        ["M98 10.TAP", "M98 10.TAP"],
        [],
    ),
    "a choice whose ways all end with a feed, then a work offset: the output is at rest (McuWIN 3.19; M65)": (
        "mcuwin",
        "linuxcnc",
        "CD601 := 0\nG00 X0 Y0 Z0\nG01 X1\n$if (CD601 > 1) then begin\nG00 X2\nG01 X3\n$end;\n"
        "M27 107\nG57\nG00 X3\nM30\n",
        ["M65 P7", "G57"],
        [],
    ),
    "an output that motion stops for on one way alone, for the zero next to it (McuWIN 3.26; M14)": (
        "mcuwin",
        "wincnc",
        "G00 X0 Y0 Z0\nG01 X1\n$if (X.digib.1) then begin\nG00 X3\n$end;\nM27 107\nG91\nG92 X5\nG90\nG00 X3\nM30\n",
        ["M14 C7", "G92.2 X5"],
        [],
    ),
    "a choice that is decided on the way (McuWIN 3.26; M12)": (
        "mcuwin",
        "wincnc",
        "CD601 := 0\nG00 X0 Y0 Z0\n$if (CD601 < 1) then begin\nG01 X1\n$end;\nM27 107\nG91\nG92 X5\nG90\nG01 X1\nM30\n",
        ["M12 C7", "G92.2 X5"],
        [],
    ),
    "a reflection is no change of the zero: an output before it goes on flying (McuWIN 3.9; M62)": (
        "mcuwin",
        "linuxcnc",
        "G00 X0 Y0 Z0\nG01 X1\nM26 106\nG21\nG91\nG01 X1 Y1\nG24\nG90\nG00 X0\nM30\n",
        ["M62 P6"],
        [],
    ),
    "a work offset in a subprogram leaves G92 as it is, which McuWIN's takes off (Eding 3.4.23; McuWIN 3.19)": (
        "eding",
        "mcuwin",
        "sub p\nG0 X1\nG55\nG0 X2\nendsub\nG0 X0 Y0 Z0\nG92 X5\ngosub p\nM30\n",
        ["G92 X-5", "G55", "G92 X-5"],
        [],
    ),
    "G86 rests at the bottom, stops the spindle and goes up (Eding 3.4.21.9; LinuxCNC G86)": (
        "eding",
        "linuxcnc",
        "F100\nG0 X0 Y0 Z10\nS1000 M3\nG99 G86 X1 Y1 Z-5 R2 P0.5\nX2\nG80\nM5\nM30\n",
        ["G99 G86 X1 Y1 Z-5 R2 P0.5", "X2"],
        [],
    ),
}
"""By what it is about: from, to, the program after its first lines, lines in their order, lines that are not there."""


@pytest.mark.parametrize("about", LINES)
def test_lines(about: str, tmp_path: Path) -> None:
    dialect, to, text, expected, absent = LINES[about]
    done = translation(tmp_path, dialect, to, text)
    assert [f"{f.code.label} {f.span.line}: {f.message}" for f in done.findings.kept] == []
    assert done.verdict is Verdict.SAFE
    lines = [line.strip() for line in done.files[""].decode().splitlines()]
    place = 0
    for wanted in expected:
        found = [n for n, line in enumerate(lines[place:], place) if line == wanted or line.endswith(f" {wanted}")]
        assert found, f"{wanted} is not there, or too early:\n" + "\n".join(lines)
        place = found[0] + 1
    for line in absent:
        assert line not in lines


REFUSED = {
    "an output before a work offset, which stops motion on the way alone that ends with a feed (McuWIN 3.19)": (
        "mcuwin",
        "eding",
        "G00 X0 Y0 Z0\nG01 X1\n$if (X.digib.1) then begin\nG00 X3\n$end;\nM27 107\nG57\nG00 X3\nM30\n",
        "output without stopping motion",
    ),
    "a work offset after a G92 on one way alone: McuWIN's work offset takes it off (3.26)": (
        "eding",
        "mcuwin",
        "G0 X0 Y0 Z0\nM56 P2\nif [#5399 == 1]\nG92 X5\nendif\nG55\nG0 X1\nM30\n",
        "work offset selected while a local offset",
    ),
    "a zero that is kept while X alone gets another one: G92.3 clears all": (
        "mcuwin",
        "wincnc",
        "G00 X0 Y0 Z0\nG153\nG92 X5\nG00 X1 Y1\nG154\nG00 X2\nM30\n",
        "a zero that is kept",
    ),
    "a feed that depends on an input: WinCNC says F at a move": (
        "mcuwin",
        "wincnc",
        "G00 X0 Y0 Z0\n$if (X.digib.2) then begin\nF500\n$end;\nG01 X1\nM30\n",
        "a feed that depends",
    ),
    "moves in the work offset of the start, then in another one: WinCNC has one zero": (
        "mcuwin",
        "wincnc",
        "G00 X0 Y0 Z0\nG55\nG00 X1\nM30\n",
        "work offset selected",
    ),
    "a tool change while the spindle turns: M6 of Eding CNC stops it": (
        "wincnc",
        "eding",
        "G0 X0 Y0 Z0\nM3\nM6 T2\nG0 X1\n",
        "tool change that leaves the spindle",
    ),
    "a zero of Z at a machine place while a measure of a tool may count": (
        "wincnc",
        "mcuwin",
        "G0 X0 Y0 Z0\nG92.1 Z5\nG0 Z1\n",
        "work zero set while a tool length",
    ),
    "M56 L without Q, whose limit no section says": (
        "eding",
        "wincnc",
        "G0 X0 Y0 Z0\nM56 P2 L1\nG0 X1\nM30\n",
        "wait for an input whose limit",
    ),
    "an output that no motion follows in LinuxCNC": (
        "mcuwin",
        "linuxcnc",
        "G00 X0 Y0 Z0\nM26 105\n$if (CD601 > 1) then begin\nG00 X1\n$end;\nM30\n",
        "an output without stopping motion",
    ),
}
"""By what it is about: from, to, the program after its first lines, and what is named."""


@pytest.mark.parametrize("about", REFUSED)
def test_refused(about: str, tmp_path: Path) -> None:
    dialect, to, text, named = REFUSED[about]
    if "CD601" in text:
        text = f"CD601 := 0\n{text}"
    done = translation(tmp_path, dialect, to, text)
    assert done.verdict is Verdict.UNKNOWN
    assert [f.code.label for f in done.findings.kept][:1] == ["GP703"]
    assert done.findings.kept[0].message.startswith(named)


def test_an_output_at_the_start_of_a_subprogram_comes_after_motion() -> None:
    """M12 of WinCNC waits for the axes; M26 and M27 do not: G04 0 before them, wherever the call is (3.5)."""
    figures = Figures()
    done = judge("wincnc", "mcuwin", 505, figures)
    assert done is not None and not figures.wrong
    assert b"' part0.tap\nG04 0\nM27 107\n" in done.files[""].replace(b"\r\n", b"\n")


def test_a_subprogram_says_the_feed_that_its_call_has_set(tmp_path: Path) -> None:
    """F of WinCNC is kept for the axes of its line (Feed Velocity): Z says it again after a line in X."""
    done = translation(
        tmp_path, *LINES["F after a call counts where each way to it has set the same (M98; Feed Velocity)"][:3]
    )
    assert b"Y1 Z2 F600" in done.files["10.TAP"]
