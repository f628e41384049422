"""WinCNC: what scales, turns, maps, couples and moves zeros, together: where the manual says it, else UNKNOWN.

Expected places are worked out by hand from the WinCNC Users Guide, Command Reference (G43, G49 to G59, G81 to G92.3,
L1, L10 to L13, L101, M37), in machine coordinates. The machine counts in mm; all axes start at 0, with no local zeros,
and no measure but what the job gives.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest

AXES = "XYZW"
SHOP = (
    "unit=MM\ntimertype=7200\naxischar=XYZW\n"
    + "".join(
        f"axisspec=p0s{n}d{n}r{res}a400t{kind}\naxisvel=r6000f1500s50m200h450\naxislo=p2b{n}o1\naxishi=p3b{n}o1\n"
        for n, (res, kind) in enumerate(((100, 1), (100, 2), (200, 3), (200, 3)))
    )
    + "vgroup=FXY\nvgroup=XY\nvgroup=Z\nvgroup=W\nsoftlim=T1\nlolim=X-100Y-100Z-100W-100\nhilim=X100Y100Z100W100\n"
    + "nmode=90\nportin=2,8000\nportin=3,8001\natc1=H0 O0 Z0 A2 M0\ng37=X30Y40D5F50\n"
)
SETUP = (
    'schema = "gproof-setup/1"\nunits = "mm"\nhomed = ["x", "y", "z", "w"]\nactive_work = 1\ntool = 0\n'
    "start = {x = 0.0, y = 0.0, z = 0.0, w = 0.0}\ng92 = {x = 0.0, y = 0.0, z = 0.0, w = 0.0}\n"
    "[measures]\nz = 0.0\nw = 0.0\n[positions.P1]\nlift = false\nx = 0.0\ny = 0.0\n"
    "[positions.P2]\nlift = false\nx = 0.0\ny = 10.0\n[positions.H2]\nlift = false\n"
    "x = 5.0\ny = 6.0\n[tools.2]\nlength = 12.0\n"
)
UNKNOWN = None


def answers(folder: Path, program: str, capsys: pytest.CaptureFixture[str], settings: str = "") -> tuple[int, str]:
    """Exit code and answer for limits."""
    from gproof.cli.main import main

    (folder / "WINCNC.INI").write_text(SHOP + settings, encoding="ascii")
    (folder / "CNC.MAC").write_text("", encoding="ascii")
    (folder / "setup.toml").write_text(SETUP, encoding="ascii")
    (folder / "job.tap").write_text(program, encoding="ascii")
    machine = ["--machine", str(folder / "WINCNC.INI"), "--setup", str(folder / "setup.toml")]
    code = main(["check", str(folder / "job.tap"), *machine])
    shown = capsys.readouterr().out
    limits = next((line.split()[1] for line in shown.splitlines() if line.strip().startswith("limits")), shown)
    return code, limits


def places(folder: Path, capsys: pytest.CaptureFixture[str]) -> list[tuple[float | str, ...]]:
    """Where each move of the job in the folder ends."""
    from gproof.cli.main import main

    machine = ["--machine", str(folder / "WINCNC.INI"), "--setup", str(folder / "setup.toml")]
    main(["dump", "--stage", "trace", "--format", "jsonl", str(folder / "job.tap"), *machine])
    rows = [json.loads(line) for line in capsys.readouterr().out.splitlines() if line.startswith("{")]
    moves = [row for row in rows if row["op"] in ("traverse", "feed", "arc")]
    return [
        tuple("?" if axis in row.get("relative_to", {}) else round(row["to"][axis], 6) for axis in AXES.lower())
        for row in moves
    ]


CYCLES = {"G81": "", "G82": "P5", "G73": "Q5", "G83": "Q5"}


@pytest.mark.parametrize("code", CYCLES)
def test_cycles_are_scaled(code: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """G51 scales Z and R of a hole: -20 about 0 is -60, R2 is 6; about K10 they are -80 and -14."""
    program = f"G51 Z3 K0\n{code} X5 Y5 Z-20 R2 {CYCLES[code]} F100\n"
    assert answers(tmp_path, program, capsys) == (0, "SAFE"), program
    found = places(tmp_path, capsys)
    assert (5.0, 5.0, -60.0, 0.0) in found, program
    assert found[-1] == (5.0, 5.0, 6.0, 0.0), program
    program = f"G51 Z3 K10\n{code} X5 Y5 Z-20 R2 {CYCLES[code]} F100\n"
    answers(tmp_path, program, capsys)
    found = places(tmp_path, capsys)
    assert (5.0, 5.0, -80.0, 0.0) in found and found[-1] == (5.0, 5.0, -14.0, 0.0), program
    assert answers(tmp_path, f"G51 Z3 K0\n{code} X5 Y5 Z-40 R2 {CYCLES[code]} F100\n", capsys) == (1, "UNSAFE")


OPEN = {
    "a follower's own word": "L13 XY\nG0 Y500\n",
    "a follower's own word beside its leader's": "L13 XY\nG0 X5 Y5\n",
    "a follower's own word where it stands": "L13 XY\nG0 X5 Y0\n",
    "a follower's own distance": "L13 XY\nG91 G0 Y500\n",
    "a follower that G53 lifts": "L13 ZW\nG0 Z-5\nG53\n",
    "a follower that L4 sends": "L3 XY\nG0 X5 Y5\nL13 XY\nL4 Y\n",
    "a follower that goes to a stored place": "G0 Y5\nL13 XY\nG0 P1\n",
    "a follower in a cycle": "L13 XY\nG81 X5 Y9 Z-20 R2 F100\n",
    "a follower that is lifted": "G0 Z-5 W-5\nL13 ZW\nG0.1 X5\n",
    "a place of what followed": "L13 XY\nG0 X40\nL13\nG0 Y90\n",
    "a place of what followed, by G53": "L13 XY\nG0 X40\nL13\nG53 Y90\n",
    "a second L13": "L13 XY\nL13 XW\nG0 X20\n",
    "a second L13, the other way round": "L13 XY\nL13 YX\nG0 X20\n",
    "an L13 of three axes": "L13 XYW\nG0 X20\n",
    "an L13 of axes whose steps differ": "L13 XZ\nG0 X20\n",
    "a register of L1": "L1 N2 V-30\nL101 T1 R2\nG0 Z0\n",
    "a register of L1, by the tool's number": "L1 N2 V-30\nL110 T2\nG0 Z0\n",
    "a register of L1, as a home position": "L1 N2 V-30\nG0 H2\n",
    "registers of a file": "L1.2\nL101 T1 R2\nG0 Z0\n",
    "registers of a file, as home positions": "L1.2\nG0 H2\n",
    "registers that are shifted": "M37.3 S-1 H2\nL101 T1 R2\nG0 Z0\n",
    "K without J": "G2 X70 Z-5 I10 K0 F100\n",
    "K without J, a half circle": "G2 X20 I10 K0 F100\n",
    "K without J, on a line of G2 that is modal": "G2 X0 Y0 I1 J0 K0 F100\nX20 I10 K0\n",
    "K without I": "G2 Y20 J10 K0 F100\n",
    "K alone": "G2 X20 I10 J0 F100\nG2 X40 K0\n",
    "K beside R": "G2 X20 R15 K0 F100\n",
    "M37 of a scaled axis": "G51 Z2\nG0 Z-10\nM37 Z0\nG0 Z-30\n",
    "G92 of a scaled axis": "G51 Z2\nG0 Z-10\nG92 Z0\nG0 Z-30\n",
    "a measure while its axis is scaled": "L110 T2\nG51 Z2\nG49\nG0 Z-30\n",
    "G53 of a scaled axis": "G51 Z2\nG53 Z-30\n",
    "G53 of a turned axis": "G52 I0 J0 A90\nG53 X-30\n",
    "L11 of scaled axes": "G51 X2 Y2\nL11 YX\nG0 X40\n",
    "L12 of scaled axes": "G51 Z2\nL12 WZ\nG0 Z-40\n",
    "L11 of axes with other local zeros": "G92.1 X50\nL11 YX\nG0 X40 Y40\n",
    "a mapped Z in a cycle": "L11 ZYX\nG81 X5 Y5 Z-20 R2 F100\n",
    "G51 of another axis later": "G51 X2 Y2\nG51 Z2\nG0 X5\n",
    "a hole of words that were scaled": "G51 Z3 K0\nG81 X5 Y5 Z-20 R2 F100\nG50\nG81 X9\n",
    "a hole of words before another zero": "G81 X5 Y5 Z-20 R2 F100\nG92 Z1\nG81 X9\n",
    "an array without G92XY": "L10 R1 C2 X30\nG0 X80\nL10\n",
    "an array with G92 of one axis": "L10 R1 C2 X30\nG92 X\nG0 X8\nL10\n",
    "an array whose G92 comes late": "L10 R1 C2 X30\nG0 X8\nG92 XY\nL10\n",
    "braces with a length in another unit": "G20\nG0 X{TMX}\n",
    "braces with a local zero in another unit": "G92 X-50\nG20\nG0 X{LZ0-1}\n",
    "M37 under a local zero": "G92 Z90\nG0 Z80\nM37 Z0\nG0 Z115\n",
}


@pytest.mark.parametrize("what", OPEN)
def test_what_the_manual_leaves_open_is_not_safe(what: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    program = OPEN[what]
    modal = "g2modal=1\n" if "modal" in what else ""
    code, limits = answers(tmp_path, program, capsys, modal)
    assert (code, limits) == (2, "UNKNOWN"), program


KNOWN = {
    "a follower goes with its leader": ("L13 XY\nG0 X40\nG0 X0\nL13\nG0 Y9\n", (0, 9, 0, 0)),
    "the same L13 again": ("L13 XY\nL13 XY\nG0 X40\n", (40, 40, 0, 0)),
    "K of 0 beside I and J": ("G2 X20 I10 J0 K0 F100\n", (20, 0, 0, 0)),
    "L11 of axes with the same zero": ("G92.1 X5 Y5\nL11 YX\nG0 X40 Y20\n", (25, 45, 0, 0)),
    "L12 with distances": ("G92.1 Z5\nL12 WZ\nG91 G0 Z-3\n", (0, 0, 0, -3)),
    "M37 of another axis than the scaled": ("G51 Z2\nM37 W3\nG0 W4\n", (0, 0, 0, 1)),
    "a register of M37": ("G0 Z-10\nM37 Z0 H2\nL1 N3 V5\nL101 T1 R2\nG0 Z4\n", (0, 0, -6, 0)),
    "a hole of the same words under the same scale": (
        "G51 Z3 K0\nG81 X5 Y5 Z-20 R2 F100\nX9\n",
        (9, 5, 6, 0),
    ),
    "an array": ("L10 R1 C2 X30 E1\nG92 XY\nG0 X8\n", (38, 0, 0, 0)),
    "braces in the file's unit": ("G0 X{TMX}\n", (30, 0, 0, 0)),
}


@pytest.mark.parametrize("what", KNOWN)
def test_what_the_manual_says_is_exact(what: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    program, expected = KNOWN[what]
    assert answers(tmp_path, program, capsys) == (0, "SAFE"), program
    assert places(tmp_path, capsys)[-1] == expected, program
