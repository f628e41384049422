"""The shortest program that uses each command of WinCNC as its manual says, and what a machine needs for it.

They run behind ``PREPARED`` on the machine of ``docs/codes/wincnc``, with the lines of ``DEVICES`` that an example
needs. Source: the headings of ``wincnc_manual``.
"""

from __future__ import annotations

import re

PREPARED = "G22\nG90\nG92\nG49\nG0 X100 Y100 Z-10\nG1 X100 Y100 F1200\nG1 Z-10 F600\nG0 X100\n"

G_CODES = {
    "G0": "G0 X110",
    "G0.1": "G0.1 X110 Y110",
    "G1": "G1 X110",
    "G2": "G2 X120 I10 J0",
    "G3": "G3 X120 R10",
    "G4": "G4 X1",
    "G5": 'G5 T0 M"Clamped?"',
    "G9": "G9 S20 A15",
    "G20": "G20",
    "G21": "G21",
    "G22": "G22",
    "G23": "G20\nG23",
    "G28": "G28 Z",
    "G31": "L91 G1 Z-5 F100 M28 G31",
    "G40": "G40",
    "G41": "G41 O0\nG1 X120\nG40",
    "G42": "G42 O0\nG1 X120\nG40",
    "G43": "M37 Z0\nG49\nG43",
    "G49": "G49",
    "G50": "G50",
    "G51": "G51 X2 Y2 I100 J100\nG1 X110\nG50",
    "G52": "G52 I100 J100 A30\nG1 X110\nG50",
    "G52.1": "G52.1 A1 B2\nG1 X50 Y30\nG1 X60\nG50",
    "G53": "G53 Z0",
    "G54": "G54",
    "G55": "G55",
    "G56": "G56",
    "G57": "G57",
    "G58": "G58",
    "G59": "G59",
    "G73": "G73 X120 Y100 Z-20 R-12 Q2 F300\nG80",
    "G80": "G80",
    "G81": "G81 X120 Y100 Z-20 R-12 F300\nG80",
    "G82": "G82 X120 Y100 Z-20 R-12 P500 F300\nG80",
    "G83": "G83 X120 Y100 Z-20 R-12 Q2 F300\nG80",
    "G90": "G90",
    "G91": "G91",
    "G92": "G92 X0 Y0",
    "G92.1": "G92.1 X50",
    "G92.2": "G92.2 Z-0.5",
    "G92.3": "G92 X0\nG92.3\nG92.3",
    "G92.4": "G92.4 A1 B2 C3 D4",
    "G93": "G93\nG1 X110 F2\nG94",
    "G94": "G94",
    "G95": "G95 F300\nG95",
}

L_CODES = {
    "L1": "L1 N3 V12.5",
    "L1.1": "L1.1",
    "L1.2": "L1.2",
    "L3": "L3 X Y",
    "L4": "L3 X Y\nG0 X110\nL4 X",
    "L5": "L5 X2000 Y2000",
    "L6": "L6 X10000",
    "L7": "L7 P50\nL7",
    "L8": "L8 X.01",
    "L9": "L9",
    "L10": "L10 R1 C3 X50 Y0 E1\nG92 X0 Y0\nG1 X10\nL10",
    "L11": "L11 Y X\nG1 X110\nL11",
    "L12": "L12 W Z\nG1 Z-9\nL12",
    "L13": "L13 Z W\nG1 Z-12\nL13",
    "L20": "L20",
    "L21": "L21\nL20",
    "L22": "L22 X10 Y10",
    "L22.1": "L22.1 X",
    "L23": "L23 X550",
    "L23.1": "L23.1 X",
    "L28": "L28 Z-10",
    "L28.1": "L28.1",
    "L29": "L29 X",
    "L29.1": "L29.1",
    "L30": "L30\nG1 X110\nL31",
    "L30.1": "L30.1 A20 Z-5 P-12",
    "L31": "L31",
    "L32": "L32\nG1 X110\nL33",
    "L33": "L33",
    "L34": "L34",
    "L35": "L35",
    "L36": "L36\nL37",
    "L36.1": "L36.1",
    "L36.2": "L36.2",
    "L37": "L37",
    "L37.1": "L37.1",
    "L38": "L37\nL38\nL39",
    "L39": "L39",
    "L40": "L40 P90",
    "L41": "L41 C:\\Tools\\Count.exe",
    "L48": "L48",
    "L51": "L51 V5",
    "L53": "L53",
    "L55": "L55",
    "L56": "L56",
    "L57": "L57",
    "L58": "L58",
    "L59": "L59 M50",
    "L60": "L60 C1",
    "L61": "L61 C1",
    "L70": "L70",
    "L82": "L82 Z-20",
    "L82.1": "L82.1",
    "L82.2": "L82.2",
    "L82.3": "L82.3",
    "L83": "L83 X120 Y100",
    "L90": "L90 G1 X110",
    "L91": "L91 G1 X10",
    "L92": "L92",
    "L101": "L101 T2",
    "L102": "L102 T2",
    "L110": "L110 T2",
    "L111": "L111 T2\nG1 X110",
    "L111.1": "L111.1 T2\nG1 X110",
    "L112": "L112 T2\nG1 X110",
    "L113": "L113 L1000 H5000 V3000\nG1 X110",
    "L120": "L120 T2",
    "L201": "L201 CLEAN.TAP",
    "L202": "L202 M12C1",
    "L204": "L204 C1",
    "L205": "L205 C1",
    "L210": "L210 X",
    "L210.1": "L210.1 X C1",
    "L211": "L211 X",
    "L211.1": "L211.1 X C1",
    "L212": "L212",
    "L213": "L213 Y",
    "L214": "L214 Y",
    "L215": "L215 Y",
    "L249": "L249 P50",
    "L250": "L250",
    "L251": "L251 P60\nL250",
    "L251.1": "L251.1 D0.5",
    "L252": "L252",
    "L252.1": "L252.1",
    "L253": "L253",
    "L253.1": "L253.1",
    "L254": "L254",
    "L254.1": "L254.1",
    "L255": "L255",
    "L255.1": "L255.1",
    "L256": "L256 R20",
    "L300": "L300 Z\nG0 X110 Z-5\nL301 Z",
    "L301": "L301 Z",
    "L400": "L400",
    "L401": "L401",
    "L402": "L402 PLACES.TXT",
    "L500": 'L500 X Y P5 L0 N"Corner"',
    "L500.2": "L500.2 T7 N6 A5.98 H40",
    "L501": 'L501 X Y P6 L0 N"Stop"',
    "L502": "L502 X0 Y0 W300 H200",
    "L600": "L600 X",
    "L601": "L601 X",
    "L602": "L602 X Y",
    "L603": "L603 N",
    "L604": "L604 N",
    "L605": "L605",
    "L606": "L606 N2 V.05",
    "L800": "L800",
    "L801": "L801",
    "L802": "L802 X50 Y50 I1",
    "L803": "L803 X50 Y50 I1",
    "L810": "L810 EDGE.TXT X50 I1 K2",
    "L820": "L820",
    "L821": "L821",
    "L901": "L901 D10",
    "L910": "L910",
    "L911": "L911",
}

M_CODES = {
    "M11": "M11 C2",
    "M12": "M12 C2",
    "M13": "M13 C2",
    "M14": "M14 C2",
    "M17": "M17 C2",
    "M17.1": "M17.1 C2\nG1 X110",
    "M17.2": "M12 C2\nM17.2 C2\nG1 X110",
    "M17.3": "M17.3 C5\nG1 X110",
    "M17.4": "M17.4 C1\nG1 X110",
    "M18": "M18 C2",
    "M18.1": "M18.1 C2\nG1 X110",
    "M18.2": "M12 C2\nM18.2 C2\nG1 X110",
    "M18.3": "M18.3 C5\nG1 X110",
    "M18.4": "M18.4 C0\nG1 X110",
    "M28": "L91 G1 Z-5 F100 M28",
    "M29": "L91 G1 Z-5 F100 M29",
    "M37": "M37 Z0",
    "M37.1": "M37.1 Z0",
    "M37.2": "M37.2 Z0",
    "M37.3": "M37.3 S-1 T2",
    "M98": "M98 PART.TAP",
    "M98.1": "M98.1 PART.TAP",
    "M99": "M98 PART.TAP",
    "M99.1": "M99.1",
}

LETTERS = {
    "X": "G91\nG1 X Y5",
    "F": "F300\nG1 X110",
    "P": "P1",
    "H": "H1",
    "S": "S12000",
    "[": "G1 X110 [to the stop",
    "{": "G1 X{100+10}",
}

OPEN = {
    "F": [("with axes without numbers, away from 0", "F300 Z")],
    "G2": [("with only one of I and J, the other kept from before", "G3 Y120 I0 J10\nG2 X110 Y130 I10")],
    **{
        name: [
            ("with O other than 0", f"{name} O1\nG1 X120\nG40"),
            ("without O", f"{name}\nG1 X120\nG40"),
            (
                "on a machine with a tool changer, but for a tool that L500.2 calls unworn",
                f"{name} O0\nG1 X120\nG40",
                "atc1=H40 O0 Z0 A2 M1\n",
            ),
        ]
        for name in ("G41", "G42")
    },
    "G81": [("Z, R or another axis without X and Y on a line after it", "G81 X120 Y100 Z-20 R-12 F300\nZ-25\nG80")],
    **{
        name: [
            ("type 3", name, f"{name.lower()}=X0 Y0 T3 R5\n"),
            ("type 5", name, f"{name.lower()}=X0 Y0 T5\n"),
            ("with X or Y", f"{name} X10"),
        ]
        for name in ("G54", "G55", "G56", "G57", "G58", "G59")
    },
    "G52": [("one of X and Y alone after it, before both were named", "G52 I0 J0 A30\nG1 X110\nG50")],
    "G52.1": [("one of X and Y alone after it, before both were named", "G52.1 A1 B2\nG1 X110\nG50")],
    "L10": [("with several rows and columns", "L10 R2 C2 X50 Y50 E1\nG92 X0 Y0\nG1 X10\nL10")],
    "L28": [("of an axis that has followed another one", "L13 XY\nG0 X110\nL13\nL28 Y0")],
    "L36": [("with the torch lit", "L36\nL38\nG1 X110\nL39\nL37")],
    "L38": [("before the first L37", "L38\nL39\nL37"), ("with A", "L37\nL38 A5\nL39")],
    "L53": [("while G49 puts a measure aside", "M37 Z3\nG49\nL53")],
    "M17.1": [("an empty line or a comment after it", "M17.1 C2\n\nG1 X110")],
    "M99": [("in the job itself, with lines after it", "G1 X110\nM99\nG1 X120")],
    "P": [("a position that is not in the setup file", "P9")],
}
"""What of a command the manual leaves open: in words, a program that is UNKNOWN, and lines of WINCNC.INI in place of
those that it usually has for the device."""

VARIABLES = {
    **dict.fromkeys(("TP1", "TN1", "TS1", "TH1"), ("L101", "L101 T2\n")),
    **dict.fromkeys(("TP2", "TN2", "TS2", "TH2"), ("L102", "L102 T2\n")),
    "TM1": ("M37.1", "M37.1 Z0\n"),
    "TM2": ("M37.2", "M37.2 Z0\n"),
    **dict.fromkeys(("TMX", "TMI", "TMY", "TMJ", "TMD", "TMF"), ("M37.1", "")),
    **{f"LZ{n}": ("X", "") for n in range(6)},
    **dict.fromkeys(
        ("THM", "THA", "THO", "THI", "THP", "THC", "THZ", "THR", "THS", "THE", "THD", "THL", "THF"), ("L37", "")
    ),
}
"""The command on whose machine a variable is used, and what runs before."""

FILES = {"PART.TAP": "G1 X110\nM99\nG1 X500\n", "CLEAN.TAP": "M12C1\n"}
"""Files that the examples call."""

TURNING_AXIS = (
    ("axischar=XYZW\n", "axischar=XYZWC\n"),
    ("\nvgroup=FXY", "\naxisspec=p0 s4 d4 r44 a72000 t4\naxisvel=r36000 f18000\nvgroup=C\nvgroup=FXY"),
    ("lolim=", "lolim=C-36000 "),
    ("hilim=", "hilim=C36000 "),
)
"""What is replaced in WINCNC.INI for a fifth axis that turns."""

SECOND_MOTOR = "altaxisspec=p0 s5 d5\n"
SECOND_MOTOR_OF = re.compile(r"axisspec=p0 s1 [^\n]*\n")
"""A second motor, and the line of the axis that it belongs to."""

STATED = """\
[positions.P1]
x = 100.0
y = 100.0
lift = false

[positions.P2]
x = 150.0
y = 120.0
lift = false

[positions.P3]
x = 120.0
y = 80.0
lift = false

[positions.P4]
x = 110.0
y = 160.0
lift = false

[positions.H1]
x = 50.0
y = 50.0
lift = false
"""
"""Lines of the setup: positions that the controller has stored."""

DEVICES = {
    "knife": "knifemode=T0 A20 L0 Z-5 P-12 N4 M1 V2\n",
    "saw": "sawmode=T1 A4 R80 O0 Z10\n",
    "autoaux": "autoaux=C2 I0 S0 E0 T0\n",
    "thc": "thc=A2 F100 V120 S.5 E.2 P90 O1 I1 D2 L10 T2\n",
    "laser": "laser=P50 D100 S0 M2 O0 A0 B1\n",
    "da": "da=T1 V10 I0\n",
    "pump": "pumpcont=T3 L10 H1000 A10 B5000 I0 R0\n",
    "probe": "auxin=C8 P3 B7\nscan=T1 A2 C8\n",
    "atc1": "atc1=H40 O0 Z0 A2 M1\n",
    "atc2": "atc2=H40 O0 Z0 A3 M1\n",
    "g37": "g37=X300 Y50 I310 J60 D30 F100\n",
    "workspaces": "".join(f"g{n}=X{10 * (n - 54)} Y0 T0 M0\n" for n in range(54, 60)),
}
"""Lines of WINCNC.INI that set a device up."""

NEEDS = {
    **dict.fromkeys(("L30", "L30.1", "L31"), ("knife",)),
    **dict.fromkeys(("L32", "L33"), ("saw",)),
    **dict.fromkeys(("L34", "L35"), ("autoaux",)),
    **dict.fromkeys(("L36", "L36.1", "L36.2", "L37", "L37.1", "L38", "L39"), ("thc",)),
    **dict.fromkeys(
        ("L48", "L249", "L250", "L251", "L251.1", "L252", "L252.1", "L253", "L253.1", "L254", "L254.1", "L255"),
        ("laser",),
    ),
    **dict.fromkeys(("L255.1", "L256"), ("laser",)),
    "L51": ("da",),
    **dict.fromkeys(("L55", "L56", "L57", "L58", "L59"), ("pump",)),
    **dict.fromkeys(("L82", "L82.1", "L82.2", "L82.3", "L83", "L800", "L801", "L802", "L803", "L810"), ("probe",)),
    **dict.fromkeys(("L101", "L110", "L111", "L112"), ("atc1",)),
    **dict.fromkeys(("L102", "L111.1", "L120"), ("atc1", "atc2")),
    **dict.fromkeys((f"G{n}" for n in range(54, 60)), ("workspaces",)),
    **dict.fromkeys(("M37.1", "M37.2"), ("g37",)),
}  # fmt: skip
"""What must be set up for a command's example."""

WITH_SECOND_MOTOR = ("L213", "L214", "L215")
WITH_TURNING_AXIS = ("L30", "L30.1", "L31", "L32", "L33", "G95", "L28.1")
"""Examples that need a fifth axis, C, which turns."""
