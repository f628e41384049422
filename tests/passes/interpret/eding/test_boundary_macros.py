"""GP332 is a warning where the job leaves its boundaries, a note where a command that the machine defines does.

WinCNC Users Guide: Macro File Configuration; L20, L21; Soft Limit / Boundaries.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from gproof.driver.judge import judge
from gproof.driver.session import Running, open_session
from gproof.ir.verdict import Verdict

INI = """unit=MM
axischar=XYZ
axisspec=p0 s0 d0 r100 a100 t1
axisvel=r6000 f3000
axisspec=p0 s1 d1 r100 a100 t2
axisvel=r6000 f3000
axisspec=p0 s2 d2 r100 a100 t3
axisvel=r3000 f1000
lolim=X0 Y0 Z-100
hilim=X500 Y500 Z0
lobound=X0 Y0
hibound=X400 Y400
softlim=T1
"""
FILES = {
    "CNC.MAC": "M6=M98 CHANGE.MAC\nM7=M98 FETCH.MAC\n",
    "CHANGE.MAC": "M98 RACK.MAC\n",
    "FETCH.MAC": "M6\n",
    "RACK.MAC": "L20 X2\nG53 X450\nG53 X100\nL20\n",
    "OWN.TAP": "M98 RACK.MAC\n",
    "SHOP.TAP": "G0 X200\nM6\n",
}


def told(folder: Path, job: str, ini: str = INI, files: dict[str, str] = FILES) -> tuple[Verdict, set[tuple[str, str]]]:
    """The verdict; file and severity of each GP332."""
    (folder / "WINCNC.INI").write_text(ini)
    for name, text in files.items():
        (folder / name).write_text(text)
    (folder / "job.tap").write_text(job)
    session = open_session(folder / "job.tap", machine=folder / "WINCNC.INI", setup="zero", dialect=None)
    found = judge(session, running=Running())
    kept = [f for f in found.findings.kept if f.code.label == "GP332"]
    return found.verdict, {(Path(f.span.file).name, f.severity.value) for f in kept}


ARRAY = "L10 R1 C2 X5 Y5\n{}\nL10\n"
"""Twice; what a row of an array does with the guard is not known, who goes beyond is."""


@pytest.mark.parametrize("job", ["M6", "M7", "M98 SHOP.TAP", ARRAY.format("M6"), 'G5 M"Change?"\nM6'])
def test_what_a_command_of_the_machine_does_is_a_note(job: str, tmp_path: Path) -> None:
    assert told(tmp_path, f"G90\n{job}\nG0 X10\n")[1] == {("RACK.MAC", "note")}


@pytest.mark.parametrize(
    "job", ["M98 RACK.MAC", "M6\nM98 RACK.MAC", "M98 OWN.TAP\nM7", "M98 CHANGE.MAC", ARRAY.format("M98 OWN.TAP")]
)
def test_what_a_line_of_the_job_calls_is_the_job_s(job: str, tmp_path: Path) -> None:
    assert told(tmp_path, f"G90\n{job}\nG0 X10\n")[1] == {("RACK.MAC", "warning")}


def test_neither_changes_the_verdict(tmp_path: Path) -> None:
    assert {told(tmp_path, f"G90\n{job}\nG0 X10\n")[0] for job in ("M6", "M98 RACK.MAC")} == {Verdict.SAFE}


def test_lines_of_the_job_itself_are_the_job_s(tmp_path: Path) -> None:
    assert told(tmp_path, "G90\nM6\nL21\nG0 X420\nG0 X10\n")[1] == {("RACK.MAC", "note"), ("job.tap", "warning")}


def test_what_runs_before_each_job_is_the_machine_s(tmp_path: Path) -> None:
    """cmdstart= of WINCNC.INI."""
    ini = f"{INI}cmdstart=M98 RACK.MAC\n"
    assert told(tmp_path, "G90\nG0 X10\n", ini) == (Verdict.SAFE, {("RACK.MAC", "note")})
    assert told(tmp_path, "G90\nM98 RACK.MAC\n", ini)[1] == {("RACK.MAC", "warning")}


def test_an_error_stays_an_error(tmp_path: Path) -> None:
    """With the guard on, past a boundary is UNSAFE, whoever goes there."""
    guarded = {"RACK.MAC": "G53 X450\nG53 X100\n"}
    assert told(tmp_path, "G90\nM6\n", files=FILES | guarded) == (Verdict.UNSAFE, set())
