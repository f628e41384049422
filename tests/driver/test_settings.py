"""Settings of a cnc.ini that gproof does not follow: each is named with its line and stops only jobs it concerns."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from gproof.cli.main import main

AXIS = """\
[JOINT_{n}]
visible = 1
resolution = 100
positiveLimit = 300
negativeLimit = -300
maxVelocity = 100
maxAcceleration = 500
"""
INI = "[GENERAL]\nunits = mm\nmaxStepFrequency = 125000\n" + "".join(AXIS.format(n=n) for n in range(4))
JOB = "G21 G17 G90 G94 G54 G40 G49 G80 G50 G69\nF600\nG0 X10 Y10\nG1 Z-1\n{line}\nM30\n"

A_IS_ELSE = ["mode = FOAM CUT", "mode = 2nd Z", "mode = Tangential Knife"]


def checked(folder: Path, ini: str, line: str, capsys: pytest.CaptureFixture[str]) -> dict[str, Any]:
    """The report of ``check``; ``compile`` must agree with it."""
    (folder / "cnc.ini").write_text(ini)
    (folder / "job.cnc").write_text(JOB.format(line=line))
    words = [str(folder / "job.cnc"), "--machine", str(folder / "cnc.ini"), "--setup", "zero"]
    code = main(["check", *words, "--format", "json"])
    report: dict[str, Any] = json.loads(capsys.readouterr().out)
    made = main(["compile", *words, "-o", str(folder / "job.gpx")])
    capsys.readouterr()
    assert made == code, report
    return report


def found(report: dict[str, Any], code: str) -> list[tuple[str, int, str]]:
    return [(f["file"], f["line"], f["message"]) for f in report["findings"] if f["code"] == code]


@pytest.mark.parametrize("mode", A_IS_ELSE)
def test_what_a_is_stops_only_jobs_that_move_it(mode: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    ini = INI + mode + "\n"
    assert checked(tmp_path, ini, "G1 X20", capsys)["verdict"] == "SAFE"
    report = checked(tmp_path, ini, "G1 A20", capsys)
    assert report["verdict"] == "UNKNOWN"
    ((file, line, message),) = found(report, "GP605")
    assert (file, line) == ("cnc.ini", ini.count("\n"))
    assert mode.upper() in message.upper()


def test_a_3d_printer(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    ini = INI + "[INTERPRETER]\nis3DPrinter = 1\n"
    assert checked(tmp_path, ini, "G1 X20", capsys)["verdict"] == "SAFE"
    report = checked(tmp_path, ini, "G1 A20", capsys)
    assert report["verdict"] == "UNKNOWN"
    assert [place[:2] for place in found(report, "GP605")] == [("cnc.ini", ini.count("\n"))]
    report = checked(tmp_path, ini, "G1 X20 E4", capsys)
    assert report["verdict"] == "UNKNOWN"
    assert [place[1] for place in found(report, "GP113")] == [5]
    # elsewhere E is a word that nothing uses
    assert checked(tmp_path, INI, "G1 X20 E4", capsys)["verdict"] == "UNSAFE"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[KINEMATICS]\nkinType = 3\n", "virtual C"),
        ("[KINEMATICS]\nkinType = 18\n", "does not describe"),
        ("[JOINT_3]\nvisible = 1\nmode = 9\n", "not one of the modes"),
    ],
)
def test_what_may_move_every_axis_stops_every_job(
    text: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    ini = (INI.partition("[JOINT_3]")[0] if "JOINT" in text else INI) + text
    report = checked(tmp_path, ini, "G1 X20", capsys)
    assert report["verdict"] == "UNKNOWN"
    ((file, line, message),) = found(report, "GP605")
    assert (file, line) == ("cnc.ini", ini.count("\n"))
    assert said in message


def test_a_fourth_axis_of_a_mill_keeps_its_places(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """4THMILL (2.1.3) changes feeds: places are judged; no stream is made of a job that moves A (GP520)."""
    ini = INI + "mode = 4THMILL\n"
    assert checked(tmp_path, ini, "G1 X20", capsys)["verdict"] == "SAFE"
    (tmp_path / "job.cnc").write_text(JOB.format(line="G1 A20"))
    words = [str(tmp_path / "job.cnc"), "--machine", str(tmp_path / "cnc.ini"), "--setup", "zero"]
    assert main(["check", *words]) == 0
    assert main(["compile", *words, "-o", str(tmp_path / "a.gpx")]) == 2
    assert "GP520" in capsys.readouterr().out


def test_a_bent_knife(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """2.1.9: XY would move with Z; the line that switches it on is named."""
    ini = INI + AXIS.format(n=5) + "mode = Tangential Knife\n"
    report = checked(tmp_path, ini, "tanknife on 90\nG1 X20\ntanknife off", capsys)
    assert report["verdict"] == "UNKNOWN"
    assert [place[1] for place in found(report, "GP323")] == [5]
