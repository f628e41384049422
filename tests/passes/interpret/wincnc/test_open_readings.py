"""Programs of WinCNC that another reading of the manual takes out of the limits are not SAFE.

Each case leaves the limits (X -0.4 to 50.4 inches), or does so where the manual is open, by what a checker might pass
over: a macro within a line, a line behind a carriage return, what runs behind the job, a mapped or locked axis.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

INI = """unit=IN
timertype=7200
axischar=XYZ
axisspec = p0 s0 d0 r1000 a400 t1
axisvel = r600 f150 s50 m200 h450
axislo = p2 b6 o1
axishi = p2 b7 o1
axisspec=p0s1d1r1000a400t2
axisvel=r600f150s50m200h450
axislo=p3 b0 o0
axishi=p3 b1 o0
axisspec = p0 s2 d2 r2000 a200 t3
axisvel = r200 f60 s20 m50 h100
axislo = p3 b2 o0
axishi = p3 b3 o0
vgroup=FXY
vgroup=XY
vgroup=Z
softlim=T1
lolim=X-.4 Y-.4 Z-7
hilim=X50.4 Y100.4 Z.4
g28move=Z-.25 X.25 Y.25 R.25 F60 T10
nmode=90
portin=2, 8000
portin=3, 8001
portout=7, 8002
auxin=C1 P2 B0 O1 D20
auxout=C1 P7 B0 O0 S0 E0 X0
skipchars=C"/" N1
"""
SETUP = """schema = "gproof-setup/1"
units = "inch"
homed = ["x", "y", "z"]
active_work = 1
tool = 1
start = {x = 1.0, y = 1.0, z = -1.0}
g92 = {x = 0.0, y = 0.0, z = 0.0}
[tools.1]
length = 0.0
"""
HEAD = "G90\nG49\nG0 X1 Y1 Z-1\n"
CASES: dict[str, tuple[str, dict[str, str], str, str]] = {
    # what: (lines behind HEAD, other files, lines of WINCNC.INI, codes of the findings)
    "control": ("G0 X2\nG1 X3 F50\n", {}, "", ""),
    "an output that rest switches off": ("M11C2\nM18.2C2\nG0X300\n", {}, "auxout=C2P7B1T2\n", "GP301"),
    "an output of the velocity": ("M11C2\nM18.2C2\nG0X300\n", {}, "auxout=C2P7B1T3\n", "GP301"),
    "an output that a pause sets": ("M11C2\nM18.2C2\nG0X300\n", {}, "auxout=C2P7B1W0\n", "GP301"),
    "an output that stays": ("M11C2\nM18.2C2\nG0X300\n", {}, "auxout=C2P7B1\n", ""),
    "cells of mapped axes": ("L11YX\nL10R1C2X95E1\nG92XY\nG0X6\n", {}, "", "GP113 GP304"),
    "cells of axes mapped within": ("L10R1C2X45E1\nG92XY\nL11YX\n", {}, "", "GP113"),
    "cells of coupled axes": ("L13XY\nL10R1C2X45E1\nG92XY\nG0Y56\n", {}, "", "GP113"),
    "cells of locked axes": ("L300X\nL10R1C2X45E1\nG92XY\nG0Y56\n", {}, "", "GP113 GP304"),
    "cells of axes that are free again": ("L11YX\nL11\nL10R1C2X45E1\nG92XY\nG0Y5\n", {}, "", ""),
    "cells of scaled axes": ("G51X2\nL10R1C2X26E1\nG0X5\n", {}, "", "GP113 GP304"),
    "a macro behind a mode": ("G90 G28\n", {"CNC.MAC": "G28=M98 HOME.MAC\n", "HOME.MAC": "G0X300\n"}, "", "GP113"),
    "a macro with a sign": ("G+28\n", {"CNC.MAC": "G28=M98 HOME.MAC\n", "HOME.MAC": "G0X300\n"}, "", "GP301"),
    "a macro in braces": ("G{28}\n", {"CNC.MAC": "G28=M98 HOME.MAC\n", "HOME.MAC": "G0X300\n"}, "", "GP113"),
    "a macro behind a speed": ("S18000 M3\n", {"CNC.MAC": "M3=M11C1\n"}, "", "GP113"),
    "a parameter is no macro": ("G0 X2\nG4 X1\nM11 C1\n", {"CNC.MAC": "C1=M98 HOME.MAC\n"}, "", ""),
    "a tilde": ("~G28\n", {"CNC.MAC": "G28=M98 HOME.MAC\n", "HOME.MAC": "G0X300\n"}, "", "GP295"),
    "a carriage return in a comment": ("[on\rG0X300\nG0 X2\n", {}, "", "GP101"),
    "the end in an array": ("L10 R1 C4 X20 Y0\nG92XY\nG1X2F50\nM99\n", {}, "", "GP113 GP301"),
    "behind the job": ("M99\n", {}, "cmdend=G0X300\n", "GP301"),
    "behind the job, conditional": ("M17.1C1\nM99\nG0X2\n", {}, "cmdend=G0X300\n", "GP113 GP301"),
    "the end of a subprogram, in the job": ("G0X2\nM99\nG0X300\n", {}, "", "GP113 GP301"),
    "the end of a subprogram, in the job, last": ("G0X2\nM99\n\n[end]\n", {}, "", ""),
    "the end of a subprogram, at its place": ("M98 A.TAP\nG0X2\n", {"A.TAP": "G0X3\nM99\nG0X300\n"}, "", ""),
    "behind the job, within": ("G0X2\n", {}, "cmdend=M99\n", ""),
    "behind an abort": ("M99.1\n", {}, "cmdabort=G0X300\n", "GP288 GP301"),
    "behind an abort, again": ("M99.1\n", {}, "cmdabort=M99.1\n", "GP288"),
    "behind a question": ('G5 T1 M"stop?"\nG0X2\n', {}, "cmdabort=G0X300\n", "GP243 GP301"),
    "a condition, then nothing": ("M17.1C1\n", {}, "cmdend=G0X2\n", "GP289"),
    "a condition ends an array": ("L10R1C2X2\nG92XY\nG0X2\nM17.1C1\n", {}, "", "GP289"),
    "a condition, then a code switched off": ("M17.1C1\nM2\nG0X3\n", {"CNC.MAC": "M2=[\n"}, "", "GP113 GP289 GP304"),
    "a condition, then a line left out": ("M17.1C1\n/G0X300\nG0X3\n", {}, "", "GP113 GP289 GP304"),
    "homing a locked axis": ("G0X40\nL300X\nG28\nL301X\nG91G0X20\n", {}, "", "GP113 GP304"),
    "homing a coupled axis": ("G0X10\nL13XY\nG28X\nL13\nG91G0X20\n", {}, "", "GP113 GP304"),
    "local zero of a mapped axis": ("L11YXZ\nG92X0\nG0X45\n", {}, "", "GP113 GP304"),
    "local zero of axes mapped alike": ("L11XYZ\nG92X0\nG0X45\n", {}, "", ""),
    "another workspace while G52 is on": ("G52I0J0A90\nG55\nG0X2Y-2\n", {}, "g55=X1 Y0 T0 M0\n", "GP276"),
    "the same place while G52 is on": ("G52I0J0A90\nG55\nG0X2Y-2\n", {}, "g55=X0 Y0 T0 M0\n", ""),
    "a speed that runs a file": ("S900\n", {"SPIN.MAC": "G0X300\n"}, "spindle=T2 R24000\n", "GP113"),
    "a letter that is none": ("G2X3Y1\u01311\n", {}, "", "GP101"),
    "a tool behind G49": ("L110T2\nG0Z0\n", {}, "atc1=H0 O0 Z0 A2 M0\n", "GP304"),
    "a tool and its measure": ("L110T2\nG49\nG0Z0\n", {}, "atc1=H0 O0 Z0 A2 M0\n", ""),
    "a command behind a condition and a line": ("M17.1C1 G0X300\nG0X2\n", {}, "", "GP101"),
    "words behind a condition": ("M17.1C1 X300\nG0X2\n", {}, "", "GP101"),
    "a mode beside a condition": ("G91 M17.1C1\nG0X2\nG0X49\n", {}, "", "GP101"),
    "a channel that is not there": ("M17.1C7\nG0X2\n", {}, "", "GP128"),
    "a condition of a macro": ("ON C1 X300\nG0X2\n", {"CNC.MAC": "ON=M17.1\n"}, "", "GP101"),
    "conditions": ("M17.1D1C1\nM18.1C1\nM18.3C64\nM17.4C1\nL113L1H9V5\nG0X2\n", {}, "", ""),
    "two modes in a line": ("G90G91X2\nG90\nG0X1\n", {}, "", "GP113 GP304"),
    "a mode and another for the line": ("G90L91X2\nG90\nG0X1\n", {}, "", "GP113 GP304"),
    "an arc that a switch ends": ("G2X3I1J0F9M28\nG0X1Y1\n", {}, "", "GP113 GP304"),
    "a machine place that a switch ends": ("G53X40M29\nG0X1Y1\n", {}, "", "GP113 GP304"),
    "a modal arc that a switch ends": ("G2X3I1J0F9\nX5M28\nG0X1Y1\n", {}, "g2modal=1\n", "GP113 GP304"),
    "kept centre in another unit": ("G2I.5J0F50\nG22\nG2\n", {}, "", "GP405"),
    "a cycle in another unit": ("G81X2Y2Z-2R-1F10\nG22\nX60\n", {}, "", "GP216"),
    "a cycle, then a depth alone": ("G81X2Y2Z-2R-1F10\nZ-3\nG80\nG0X3\n", {}, "", "GP113 GP304"),
    "a cycle, then a height alone": ("G81X2Y2Z-2R-1F10\nR-.5\nG80\nG0X3\n", {}, "", "GP113 GP304"),
    "a peck, then another alone": ("G83X2Y2Z-2R-1Q.2F10\nQ.1\nG80\nG0X3\n", {}, "", "GP121"),
    "a cycle, then a head alone": ("G81X2Y2Z-2R-1F10\nP2\nG80\nG91G0X3\n", {}, "", "GP113 GP304"),
    "a cycle, then a depth and a place": ("G81X2Y2Z-2R-1F10\nX3Z-3\nF20\nY3\nG80\n", {}, "", ""),
    "a peck where there is none": ("G81X2Y2Z-2R-1Q.2F10\nX3\nG82X4P100\nG80\n", {}, "", "GP216 GP259"),
    "a pause where there is none": ("G73X2Y2Z-2R-1Q.2P100F10\nX3\nG80\n", {}, "", "GP259"),
    "a condition on a number": ("M17.4C{TP1}\nG0X300\nM18.4C{TP1}\nG0X300\n", {}, "", "GP301"),
    "a condition on a number that is neither": ("M17.4C{TP1+1}\nG0X300\nG0X2\n", {}, "", "GP128"),
    "the other condition on one": ("M18.4C{TP1+1}\nG0X300\nG0X2\n", {}, "", "GP128"),
    "local zeros put away, and others": ("G92X1\nG92.3\nG92X0\nG92.3\nG0X2\n", {}, "", "GP260"),
    "local zeros put away, others taken back": ("G92X0\nG92.3\nG92X0\nG92\nG92.3\nG0X2\n", {}, "", ""),
    "an arc to where it begins": ("G2X1Y1I1J0F50\n", {}, "", "GP418"),
    "an arc by distances of 0": ("L91G3Y0I1J0F50\n", {}, "", "GP418"),
    "a circle": ("G2I1J0F50\nG3\n", {}, "", ""),
    "a spindle that turns": ("G55X10Y5\nG0X10Y10\n", {}, "g55=X0 Y0 T3 R2 O0\n", "GP113"),
    "a spindle that turns, near a limit": ("G55X10Y5\nG0X49Y10\n", {}, "g55=X0 Y0 T3 R2 O0\n", "GP113 GP304"),
    "a spindle that turns, too far": ("G55X10Y5\nG0X55Y10\n", {}, "g55=X0 Y0 T3 R2 O0\n", "GP113 GP303"),
    "a spindle that turns and is away": ("G55\nG0X55Y10\n", {}, "g55=X-1 Y0 T3 R2 O0 M0\n", "GP113 GP304"),
    "a spindle that turns, of any length": ("G55X10Y5\nG0X55Y10\n", {}, "g55=X0 Y0 T3\n", "GP113 GP304"),
    "a spindle with two points of rotation": ("G55\nG0X55Y10\n", {}, "g55=X0 Y0 T5 R2\n", "GP113 GP304"),
    "a spindle that turned before": ("G0X55\n", {}, "g54=X0 Y0 T3 R2\n", "GP113 GP304"),
    "a spindle that turned, then heads": ("G55X10Y5\nG54\nG0X3Y3\n", {}, "g55=X0 Y0 T3 R2\n", "GP113"),
    "places behind a workspace of heads": ("G55X10\nG0X3Y3\n", {}, "g55=X0 Y0 T0\n", "GP113"),
    "a cutter beside the path": ("G41O.1\nG1X50.35F50\nG2I1J0\n", {}, "", "GP113 GP304"),
    "a cutter beside a plain path": ("G42O.1\nG1X50.35F50\nY3\nG40\nX3Y4\n", {}, "", "GP113 GP304"),
    "a cutter back from the path": ("G41O.1\nG40\nG1X3Y4F50\nX60\n", {}, "", "GP113 GP301"),
    "a cutter on the path": ("G41O0\nG1X3F50\nG40\nG42O\nX2\nG40\n", {}, "", ""),
    "a cutter, and no amount": ("G41\nG1X3F50\n", {}, "", "GP113 GP304"),
    "an amount beside a tool changer": ("G41O0\nG1X3F50\n", {}, "atc1=H0 O0 Z0 A2 M0\n", "GP113 GP304"),
    "a tool as new": ("L110T7\nL500.2T7N.5A.5C0\nG41\nG1X3F50\n", {}, "atc1=H0 O0 Z0 A2 M0\n", ""),
    "a worn tool": ("L110T7\nL500.2T7N.5A.49C0\nG41\nG1X3F50\n", {}, "atc1=H0 O0 Z0 A2 M0\n", "GP113 GP304"),
    "a local zero over another machine zero": ("G92X0\nG28X\nG0X3\n", {}, "", "GP295 GP335"),
    "no local zero over another machine zero": ("G92X0\nG28Y\nG92\nG28X\nG0X3\n", {}, "", "GP295"),
    "a measure over another machine zero": ("M37Z0\nL91G1Z-2F20M28\nL28Z0\nG0Z.1\n", {}, "", "GP335"),
    "another dwell": ("G81X2Y2Z-2R-1F10\nX3\n", {}, "g81set=D1\ng81dwell=2\n", "GP512"),
    "another dwell, and one of the program": ("G82X2Y2Z-2R-1P9F10\n", {}, "g81set=D1\ng81dwell=2\n", ""),
    "the same dwell": ("G81X2Y2Z-2R-1F10\n", {}, "g81set=D2\ng81dwell=2\n", ""),
    "a lift of the machine's": ("G83X2Y2Z-2R-1Q.3F10\nX3\n", {}, "g81set=L.5\n", "GP512"),
    "a tool measure within a move": ("G1Z-2F10M37Z1\n", {}, "", "GP127"),
}


@pytest.mark.parametrize("what", CASES)
def test_an_open_reading_is_not_safe(what: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from gproof.cli.main import main

    lines, files, settings, expected = CASES[what]
    (tmp_path / "WINCNC.INI").write_text(INI + settings, encoding="ascii")
    (tmp_path / "setup.toml").write_text(SETUP, encoding="ascii")
    (tmp_path / "job.tap").write_bytes((HEAD + lines).encode())
    for name, text in ({"CNC.MAC": ""} | files).items():
        (tmp_path / name).write_text(text, encoding="ascii")
    job, machine, setup = (str(tmp_path / name) for name in ("job.tap", "WINCNC.INI", "setup.toml"))
    exit_code = main(["check", job, "--machine", machine, "--setup", setup])
    shown = capsys.readouterr().out
    assert sorted(set(re.findall(r"GP\d{3}", shown))) == expected.split(), shown
    worst = {"error": 1, "unknown": 2}
    found = {worst[kind] for kind in re.findall(r" (error|unknown) GP\d{3}", shown)}
    assert exit_code == min(found, default=0), shown


@pytest.mark.parametrize("abort", ["", "cmdabort=M12C1\n"])
@pytest.mark.parametrize("answer", ["", 'answers = ["yes"]\n', 'answers = ["no"]\n'])
@pytest.mark.parametrize("kind", [1, 2])
def test_answers_of_a_setup_end_a_job(
    answer: str, abort: str, kind: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Every section that is spoken of is there, whatever the setup says about a question."""
    from gproof.cli.main import main

    (tmp_path / "WINCNC.INI").write_text(INI + abort, encoding="ascii")
    (tmp_path / "CNC.MAC").write_text("", encoding="ascii")
    (tmp_path / "setup.toml").write_text(SETUP.replace("[tools", f"{answer}[tools"), encoding="ascii")
    (tmp_path / "job.tap").write_text(f'{HEAD}G5 T{kind} M"stop?"\nG0X300\n', encoding="ascii")
    job, machine, setup = (str(tmp_path / name) for name in ("job.tap", "WINCNC.INI", "setup.toml"))
    ends = answer and (kind == 1) == ("yes" in answer)
    assert main(["check", job, "--machine", machine, "--setup", setup]) == (0 if ends else 1)
    assert main(["dump", "--stage", "trace", job, "--machine", machine, "--setup", setup]) == 0
    shown = capsys.readouterr()
    assert "internal error" not in shown.out + shown.err


def test_two_files_of_one_name_that_differ(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """M98 names a file beside the job and another one beside the machine's file."""
    from gproof.cli.main import main

    jobs, machine = tmp_path / "jobs", tmp_path / "machine"
    jobs.mkdir()
    machine.mkdir()
    (machine / "WINCNC.INI").write_text(INI, encoding="ascii")
    (machine / "CNC.MAC").write_text("", encoding="ascii")
    (machine / "SUB.MAC").write_text("G0X300\n", encoding="ascii")
    (jobs / "sub.mac").write_text("G0X2\n", encoding="ascii")
    (jobs / "setup.toml").write_text(SETUP, encoding="ascii")
    (jobs / "job.tap").write_text(f"{HEAD}M98 SUB.MAC\n", encoding="ascii")
    arguments = ["check", str(jobs / "job.tap"), "--machine", str(machine / "WINCNC.INI"), "--setup"]
    assert main([*arguments, str(jobs / "setup.toml")]) == 2
    assert "SUB.MAC (they differ), is not modelled" in capsys.readouterr().out
    (machine / "SUB.MAC").write_text("G0X2\n", encoding="ascii")
    assert main([*arguments, str(jobs / "setup.toml")]) == 0
