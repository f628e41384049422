"""Short WinCNC programs with the place where each ends, worked out on paper from the user's guide before they were run.

X starts at 10, Y at 20, Z at -20, W at -30 (mm, coordinates of the machine); limits are 200 to either side, -150 ... 0
for Z and W; boundaries 190 in X and Y; no local zeros, measures of 0. `.`: where it started; `?`: not known.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from support.command import in_this_process

INI = (
    "unit=mm\ntimertype=7200\naxischar=XYZW\n"
    + "".join(
        f"axisspec=p0s{n}d{n}r100a400t{kind}\naxisvel=r6000f1500s50m200h450\n" for n, kind in enumerate((1, 2, 3, 3))
    )
    + "vgroup=FXY\nvgroup=XY\nvgroup=Z\nvgroup=W\nsoftlim=t1\nlolim=X-200Y-200Z-150W-150\nhilim=X200Y200Z0W0\n"
    "lobound=X-190Y-190\nhibound=X190Y190\nnmode=90\npositions=p20h20t10\nportin=2,8000\nportout=1,8001\n"
    "auxin=c1p2b1\nauxout=c1p1b1\natc1=H0 O0 Z0 A2 M0\n"
)
SETUP = """\
schema = "gproof-setup/1"
units = "mm"
homed = ["x", "y", "z", "w"]
active_work = 1
tool = 0
start = {x = 10.0, y = 20.0, z = -20.0, w = -30.0}
g92 = {x = 0.0, y = 0.0, z = 0.0, w = 0.0}
measures = {z = 0.0, w = 0.0}
[positions.P1]
lift = false
x = 2.0
y = 3.0
[tools.2]
length = -12.0
"""
FILES = {
    "a.tap": "G0 X5\nM99\nG0 X300\n",
    "p.tap": "G0 X{X+1}\n",
    "g.tap": "G91\n",
    "z.tap": "G92 X0\nG0 X1\n",
    "kept.tap": "G92 X0\nL92\n",
    "outer.tap": "M98 kept.tap\nG0 X1\n",
    "change.tap": "G53 Z0\nG53 X1\n",
    "home.tap": "~G28X\n~G28Y\n",
}
MACROS = "M6=M98 change.tap\nM2=[\nM8=G0 X3\nG28=M98 home.tap\n"
START = (10.0, 20.0, -20.0, -30.0)

ENDS = {
    # How numbers and lines are written: Parameters, Axis Specification, Comment, Braces.
    "G0 X.5": "SAFE .5 . . .",
    "G0X-.5Y+5.": "SAFE -.5 5 . .",
    "g0x1y2z-3": "SAFE 1 2 -3 .",
    "G0 X Y": "SAFE 0 0 . .",
    "G0 X1Y": "SAFE 1 0 . .",
    "G00X1": "SAFE 1 . . .",
    "G 0 X 5 Y 6": "SAFE 5 6 . .",
    "X5": "UNKNOWN ? ? ? ?",
    "G1 X5\nY6": "SAFE 5 6 . .",
    "G0 X5\nG4 X1\nY6": "SAFE 5 6 . .",
    "G0 X5 [go]": "SAFE 5 . . .",
    "[G0 X5]\nG0 X6": "SAFE 6 . . .",
    "(G0 X5)\nG0 X6": "SAFE 6 . . .",
    "%\nG0 X6": "SAFE 6 . . .",
    "G0 X5 [a] Y6": "UNKNOWN ? ? ? ?",
    "G0 X{2+3}": "SAFE 5 . . .",
    "G0 X{2*3}Y{8/4}": "SAFE 6 2 . .",
    "G0 X{10-12}": "SAFE -2 . . .",
    "G92.1 X4\nG0 X{LZ0+1}": "SAFE 9 . . .",
    "G92 X0\nG0 X{LZ0*1}": "SAFE 20 . . .",
    "G0 X5 G0 Y5": "UNSAFE ? ? ? ?",
    "G90 G91 G0 X1": "UNKNOWN ? ? ? ?",
    "G0 X5 Q1": "UNSAFE ? ? ? ?",
    "G0 A5": "UNSAFE ? ? ? ?",
    "T1": "UNKNOWN ? ? ? ?",
    "G4 X2\nG9 S10 A5\nF100\nG0 X5 F60": "SAFE 5 . . .",
    # Absolute and relative: G90, G91, L90, L91.
    "G91\nG0 X5\nX5": "SAFE 20 . . .",
    "G91 G0 X5\nG90 X5": "SAFE 5 . . .",
    "L91 G0 X5\nX5": "SAFE 5 . . .",
    "L91 G0 X5": "SAFE 15 . . .",
    "G91\nL90 G0 X5\nX5": "SAFE 10 . . .",
    "G91 G92 X0\nG0 X5": "SAFE 15 . . .",
    "G91\nG0 X": "SAFE 10 . . .",
    # Units: G20 to G23.
    "G20\nG0 X1": "SAFE 25.4 . . .",
    "G21\nG0 X1": "SAFE 10 . . .",
    "G20\nG91\nG0 X1\nG22\nX1": "SAFE 36.4 . . .",
    "G20\nG21\nG23\nG0 X1": "SAFE 25.4 . . .",
    "G20\nL91 G0 X1": "SAFE 35.4 . . .",
    "G21\nG92 X1\nG22\nG0 X0": "SAFE 0 . . .",
    "G21\nG92.1 X1\nG20\nG0 X1": "SAFE 35.4 . . .",
    # Arcs: G2, G3.
    "G2 X20 I5 J0 F100": "SAFE 20 . . .",
    "G2 X20 I5 J0\nG2 X30": "SAFE 30 . . .",
    "G2 I5 J0 F100": "SAFE . . . .",
    "G91\nG2 X10 Y0 I5 J0 F100": "SAFE 20 . . .",
    "G3 X20 R6 F100": "SAFE 20 . . .",
    "G3 X20 R4": "UNSAFE ? ? ? ?",
    "G2 X20 I6 J0": "UNSAFE ? ? ? ?",
    "G2 X20 I5 J0 Z-25": "SAFE 20 . -25 .",
    "G2 X20 I5": "SAFE 20 . . .",
    "G2 X20 I5 J0\nG2 Y30 J5": "UNKNOWN ? ? ? ?",
    "G2 X20 I5 J0\nG2 X30 I5": "SAFE 30 . . .",
    "G3 X188 I89 J0": "SAFE 188 . . .",
    "G2 I-100 J0": "SAFE . . . .",
    "G2 I-101 J0": "UNSAFE . . . .",
    "G0 Z-1\nG2 X20 I5 J0\nX30": "SAFE 30 . -1 .",
    "G20\nG2 X{20/25.4} I{5/25.4} J0": "SAFE 20 . . .",
    "G52 I10 J20 A90\nG2 X20 Y20 I5 J0 F100": "SAFE 10 30 . .",
    "G51 X2 Y2 I0 J0\nG2 X20 I5 J0": "UNSAFE ? ? ? ?",
    "L11 YXZW\nG2 X20 I5 J0": "UNSAFE ? ? ? ?",
    "L12 WZ\nG2 X20 I5 J0": "SAFE 20 . . .",
    "L300 Y\nG2 X20 I5 J0": "UNKNOWN ? ? ? ?",
    "L13 ZW\nG2 X20 I5 J0 Z-22": "SAFE 20 . -22 -32",
    # Cycles: G73, G80 to G83.
    "G81 X5 Y6 Z-30 R-10 F100": "SAFE 5 6 -10 .",
    "G81 X5 Y6 Z-30 R-10\nX7": "SAFE 7 6 -10 .",
    "G81 X5 Y6 Z-30 R-10\nG80\nX8": "UNKNOWN ? ? ? ?",
    "G0 X1\nG81 X5 Y6 Z-30 R-10\nG80\nX8": "SAFE 8 6 -10 .",
    "G81 X5 Y6 Z-30 R-10\nG0 Z-5": "SAFE 5 6 -5 .",
    "G83 X5 Y6 Z-30 R-10 Q5": "SAFE 5 6 -10 .",
    "G73 X5 Y6 Z-30 R-10 Q5": "SAFE 5 6 -10 .",
    "G82 X5 Y6 Z-30 R-10 P500": "SAFE 5 6 -10 .",
    "G81 X5 Y6 Z-30 R-40": "UNSAFE ? ? ? ?",
    "G81 X5 Y6 Z-160 R-10": "UNSAFE 5 6 -10 .",
    "G81 X5 Y6 Z-30 R1": "UNSAFE 5 6 1 .",
    "G73 X5 Y6 Z-3 R-.5 Q1": "SAFE 5 6 -.5 .",
    "G73 X5 Y6 Z-3 R-.2 Q1": "UNSAFE 5 6 -.2 .",
    "G92.1 Z-5\nG81 X5 Y6 Z-30 R-4": "SAFE 5 6 -9 .",
    "G91\nG81 X5 Y6 Z-3 R1": "UNKNOWN ? ? ? ?",
    "L91 G81 X5 Y6 Z-3 R1": "UNKNOWN ? ? ? ?",
    "G81 X5 Y6 R-10": "UNSAFE ? ? ? ?",
    "G20\nG81 X1 Y1 Z-2 R-1": "SAFE 25.4 25.4 -25.4 .",
    "G81 X5 Y6 Z-30 R-10\nG91\nX1": "UNKNOWN ? ? ? ?",
    "L300 Z\nG81 X5 Y6 Z-30 R-10": "SAFE 5 6 -20 .",
    "L300 X\nG81 X5 Y6 Z-30 R-10": "SAFE 10 6 -10 .",
    "L13 ZW\nG81 X5 Y6 Z-30 R-10": "SAFE 5 6 -10 -20",
    "L13 ZW\nG81 X5 Y6 Z-145 R-10": "UNSAFE 5 6 -10 -20",
    "G52 I10 J20 A90\nG81 X20 Y20 Z-30 R-10": "SAFE 10 30 -10 .",
    "M37 Z0\nG81 X5 Y6 Z-30 R10": "SAFE 5 6 -10 .",
    # G53, G0.1, stored positions, L3, L4, L53.
    "G92 X0\nG53 X5": "SAFE 5 . . .",
    "G53 Z": "SAFE . . 0 .",
    "G53": "SAFE . . 0 0",
    "G91\nG53": "SAFE . . 0 0",
    "M37 Z0\nG53 Z-5": "SAFE . . -5 .",
    "G1 X5\nG53 X6\nX7": "SAFE 7 . . .",
    "G20\nG53 X1": "SAFE 25.4 . . .",
    "G0.1 X5 Y6": "SAFE 5 6 . .",
    "G92.1 X3\nG0.1 X5": "SAFE 8 . . .",
    "L300 W\nG0.1 X5": "SAFE 5 . . .",
    "P1": "SAFE 2 3 . .",
    "G0 P1": "SAFE 2 3 . .",
    "G53 P1": "SAFE 2 3 . .",
    "G92.1 X50\nP1": "SAFE 2 3 . .",
    "G0 P1 X5": "UNKNOWN ? ? ? ?",
    "P21": "UNSAFE ? ? ? ?",
    "P9": "UNKNOWN ? ? ? ?",
    "L500 X P9 L0\nG0 X1\nP9": "SAFE 10 . . .",
    "G92.1 X50\nL500 P8 L0\nG0 X1 Y1 Z-1 W-1\nP8": "SAFE . . . .",
    "L501 X P8 L0\nG0 X1\nP8": "UNKNOWN ? ? ? ?",
    "L500 X H3 L0\nG0 X1\nH3": "SAFE 10 . . .",
    "L3XYZW\nG0 X1 Y1 Z-1 W-1\nL4XYZW": "SAFE . . . .",
    "L3 X99\nG0 X1\nL4 X5": "SAFE 10 . . .",
    "L4 X": "UNKNOWN ? ? ? ?",
    "G92 X0\nL3 X\nG92.1 X50\nG0 X1\nL4 X": "SAFE 10 . . .",
    "L53": "SAFE . . 0 0",
    "M37 Z0\nL53": "SAFE . . -20 0",
    "L91 G1 X-50 F20 M28 G31\nL28 X0\nG0 X5": "SAFE 5 . . .",
    "L91 G1 X-50 F20 M28\nL91 G1 X5\nL28 X0\nG0 X7": "SAFE 7 . . .",
    # Conditions: M17, M18, L111 to L113.
    "M17.4 C1\nG0 X5": "SAFE 5 . . .",
    "M17.4 C0\nG0 X5\nG0 Y6": "SAFE . 6 . .",
    "M18.4 C0\nG0 X5": "SAFE 5 . . .",
    "M18.4 C1\nG0 X5\nG0 Y6": "SAFE . 6 . .",
    "M17.1 C1\nG0 X205": "UNSAFE ? ? ? ?",
    "L111 T0\nG0 X5": "SAFE 5 . . .",
    "L110 T2\nL111 T2\nG0 X5": "SAFE 5 . . .",
    "L110 T2\nL112 T2\nG0 X5\nG0 Y6": "SAFE . 6 . .",
    "L113 L1 H5 V3\nG0 X5": "SAFE 5 . . .",
    "L113 L1 H5 V5\nG0 X5\nG0 Y6": "SAFE . 6 . .",
    "L113 L1 H5 V1\nG0 X5\nG0 Y6": "SAFE . 6 . .",
    "L61 C3\nM17.3 C3\nG0 X5": "SAFE 5 . . .",
    "L60 C3\nM17.3 C3\nG0 X5\nG0 Y6": "SAFE . 6 . .",
    "M11 C1\nM17.2 C1\nG0 X5": "SAFE 5 . . .",
    "M12 C1\nM18.2 C1\nG0 X5": "SAFE 5 . . .",
    "M17.4 C0\nM17.4 C1\nG0 X5": "SAFE 5 . . .",
    # Files and macros: M98, M99, L92, CNC.MAC.
    "M98 a.tap\nG0 Y6": "SAFE 5 6 . .",
    "M98 p.tap X5": "SAFE 6 . . .",
    "G20\nM98 p.tap X1": "SAFE 50.8 . . .",
    "M98 g.tap\nG0 X5": "SAFE 15 . . .",
    "M98 z.tap\nG0 X5": "SAFE 5 . . .",
    "M98 kept.tap\nG0 X5": "SAFE 15 . . .",
    "M98 outer.tap": "SAFE 11 . . .",
    "M98 outer.tap\nG0 X5": "SAFE 5 . . .",
    "M98 nothing.tap": "UNSAFE ? ? ? ?",
    "M6\nG0 Y6": "SAFE 1 6 0 .",
    "M2\nG0 X5": "SAFE 5 . . .",
    "M8": "SAFE 3 . . .",
    "G28": "SAFE 0 0 . .",
    "~G28Z": "SAFE . . 0 .",
    "M5": "UNSAFE ? ? ? ?",
    "M17.4 C0\nM6\nG0 Y6": "SAFE . 6 . .",
    # Limits and boundaries: L20 to L23.1.
    "G0 X195": "UNSAFE 195 . . .",
    "L21\nG0 X199": "SAFE 199 . . .",
    "L21\nG0 X201": "UNKNOWN 201 . . .",
    "L20 X2\nG0 X195": "SAFE 195 . . .",
    "L20 X1\nG0 X195": "UNSAFE 195 . . .",
    "L20 X1\nG0 Z1": "UNKNOWN . . 1 .",
    "L22 X15\nG0 Y6": "UNSAFE . 6 . .",
    "L22 X5\nL22.1 X\nG0 X1": "SAFE 1 . . .",
    "L22 X5\nL22\nG0 X1": "SAFE 1 . . .",
    "G20\nL22 X1 Y-9\nG0 X.5": "UNSAFE 12.7 . . .",
    "G92 X100\nL22 X5\nG0 X96": "SAFE 6 . . .",
    "G92 X100\nL22 X5\nG0 X94": "UNSAFE 4 . . .",
    # Arrays: L10.
    "L10 R1 C3 X20 Y0\nG92XY\nG0 X5\nL10": "SAFE . . . .",
    "L10 R1 C3 X20 Y0 E1\nG92XY\nG0 X5": "SAFE 55 . . .",
    "L10 R2 C2 X20 Y20\nG92XY\nG0 X5": "UNKNOWN ? ? ? ?",
    "L10 R3 C1 X0 Y-20 E\nG92XY\nG0 Y1": "SAFE . -19 . .",
    "L10 R1 C3 X90 E\nG92XY\nG0 X5": "UNSAFE 195 . . .",
    "L10 R1 C2 X20 E\nG92XY\nG0 X5\nL10 R2 C1 X0 Y10 E\nG92 X Y\nG0 Y1\nL10\nG92\nG0 X0": "SAFE 0 31 . .",
    "G91\nL10 R1 C3 X20 E\nG92XY\nG0 X5": "SAFE 55 . . .",
    "L10 R1 C2 X20\nG92XY\nG81 X1 Y2 Z-30 R-10\nL10\nG92\nG0 Y1": "SAFE 10 1 -10 .",
    "L10 R1 C2 X20 E\nG92XY\nM98 a.tap\nL10": "SAFE 35 . . .",
    # Maps and locks: L11 to L13, L300.
    "L12 ZZ\nG0 Z-25": "SAFE . . -25 -25",
    "L12 WZ\nG0 Z-25": "SAFE . . . -25",
    "L11 YXZW\nG0 X5": "SAFE . 5 . .",
    "L12 ZZ\nG91\nG0 Z-5": "SAFE . . -25 -35",
    "L12 WZ\nM37 Z0": "UNKNOWN ? ? ? ?",
    "L300 Z\nG53": "SAFE . . -20 0",
    "L300 X\nP1": "SAFE 10 3 . .",
    "L300 X\nL301 X\nG0 X5": "SAFE 5 . . .",
    "L13 ZW\nG0 Z-25\nL13\nG0 Z-20": "SAFE . . -20 -35",
    "L13 ZW\nG92 Z0\nG0 Z-5": "SAFE . . -25 -35",
    # What two commands leave open together: G49 and M37, G52 and L300, L13 and G56.
    "M37 W5\nG49\nM37 Z0\nG0 W-2": "UNKNOWN ? ? ? ?",
    "M37 W5\nG49\nM37 Z0\nG91\nG0 W-2": "SAFE . . -20 -32",
    "M37 W5\nG49\nM37 Z0\nG43\nG0 W-2": "SAFE . . -20 -37",
    "M37 W5\nG49 Z\nM37 Z0\nG0 W-2": "SAFE . . -20 -37",
    "G49\nM37 Z0\nG0 W-2": "SAFE . . -20 -2",
    "G52 I10 J20 A90\nL300 X\nG0 X20 Y25\nL301 X\nG0 X20": "UNKNOWN ? ? ? ?",
    "G52 I10 J20 A90\nG0 X20": "SAFE . 30 . .",
    "G52 I0 J0 A90\nG0 X20": "UNKNOWN ? ? ? ?",
    "G52 I0 J0 A90\nG0 X20 Y1\nX30": "SAFE -1 30 . .",
    "G52 I0 J0 A90\nL91 G0 X5": "SAFE . 25 . .",
    "G52 I10 J20 A90\nP1\nG0 X20": "UNKNOWN ? ? ? ?",
}


PROBED = {
    # L82 down to a contact at -40, which is Z0 then; a probe that is locked or coupled is not followed.
    "L82\nG0 Z3": "SAFE . . -37 .",
    "L82 Z5\nG0 Z7": "SAFE . . -38 .",
    "L12 WZ\nL300 W\nL82": "UNKNOWN ? ? ? ?",
    "L300 Z\nL82\nG0 Z3": "UNKNOWN ? ? ? ?",
    "L13 ZW\nL82\nL13\nG91\nG0 W25": "UNKNOWN ? ? ? ?",
    "L13 WZ\nL82": "UNKNOWN ? ? ? ?",
    "G51 Z2 K0\nL82\nG0 Z3": "UNKNOWN ? ? ? ?",
}


def judged(folder: Path, program: str, more: dict[str, str] | None = None) -> tuple[str, dict[str, float | None], str]:
    files = {"WINCNC.INI": INI, "CNC.MAC": MACROS, "setup.toml": SETUP, **FILES, "job.tap": program + "\n"}
    files.update(more or {})
    for name, text in files.items():
        (folder / name).write_text(text, "utf-8")
    words = ["check", "job.tap", "--machine", "WINCNC.INI", "--setup", "setup.toml", "--format", "json"]
    report = json.loads(in_this_process(words, folder).out)
    verdicts = [report["properties"][name]["verdict"] for name in ("language", "limits", "arcs")]
    verdict = next((v for v in ("UNSAFE", "UNKNOWN") if v in verdicts), "SAFE")
    told = "; ".join(f"{f['line']}: {f['code']} {f['message']}" for f in report["findings"])
    return verdict, report["summary"]["end"], told


def judged_with_a_probe(folder: Path, program: str) -> tuple[str, dict[str, float | None], str]:
    files = {"WINCNC.INI": f"{INI}scan=t1a2c1\n", "setup.toml": f"{SETUP}[contacts]\nz = -40.0\n"}
    return judged(folder, program, files)


@pytest.mark.parametrize("program", [*ENDS, *PROBED])
def test_a_program_ends_where_the_guide_says(program: str, tmp_path: Path) -> None:
    verdict, *places = (ENDS | PROBED)[program].split()
    found, end, told = (judged_with_a_probe if program in PROBED else judged)(tmp_path, program)
    assert found == verdict, told
    for axis, place, start in zip("xyzw", places, START, strict=True):
        if place != "?":
            assert end.get(axis) == pytest.approx(start if place == "." else float(place)), (axis, told)
