"""Jobs of WinCNC for other controllers: what the macros of a shop do at a tool change, by the WinCNC manual."""

from __future__ import annotations

from pathlib import Path

from support.target_machines import machine_like
from support.traps import machine_files

from gproof.driver.translation import Translation, Wanted, translate
from gproof.ir.verdict import Verdict

JOB = """G22
G90
M6 T1
S6000
M3
G0 X10 Y20 Z5
M6 T{again}
{spindle}
G1 Z-1 F100
M5
"""
OFF = "M12C2\n"
SWAP = {"SWAP.MAC": f"{OFF}G53 Z0\nG4 [put it in]\n"}
COUNT = "L101 T{t}\nG43\n"
CHANGES = {
    "always": f"{OFF}G53 Z0\n{COUNT}",
    "another tool": "L112 T{t}\nM98 SWAP.MAC\n" + COUNT,
    "an input": "M17.1 C1\nM98 SWAP.MAC\n" + COUNT,
}
"""Macros of M6: the spindle off, off where another tool is in it (L112), off where an input is on (M17.1)."""


def translated(folder: Path, change: str, to: str = "eding", again: int = 2, spindle: str = "M3") -> Translation:
    """A job that changes a tool twice, with a macro of ``CHANGES``."""
    for name, data in machine_files("wincnc").items():
        (folder / name).write_bytes(data)
    (folder / "CNC.MAC").write_text("M3=M11C2\nM5=M12C2\nM6=M98 CHANGE.MAC\n")
    for name, text in {"CHANGE.MAC": CHANGES[change], **SWAP}.items():
        (folder / name).write_text(text)
    job = folder / "job.tap"
    job.write_text(JOB.format(again=again, spindle=spindle))
    machine = folder / "WINCNC.INI"
    machine_to = machine_like(machine, to, folder / "to")
    return translate(Wanted(job=job, to=to, machine=machine, machine_to=machine_to, dialect="wincnc"))


def test_a_change_that_switches_the_spindle_off_is_one_that_stops_it(tmp_path: Path) -> None:
    """M6 of Eding CNC stops the spindle (3.5.3), and so does this shop's: what starts it again is the job's M3."""
    for n, change in enumerate(("always", "another tool")):
        folder = tmp_path / str(n)
        folder.mkdir()
        done = translated(folder, change)
        assert done.verdict is Verdict.SAFE, [one.message for one in done.findings.kept]
        lines = done.files[""].decode().splitlines()
        second = next(at for at, line in enumerate(lines) if "T2" in line)
        assert "M3" not in lines[second] and "M3" in lines[second + 1 :]


def test_the_spindle_of_a_tool_that_is_in_it_already_goes_on(tmp_path: Path) -> None:
    """L112 skips the change of tool 1 for tool 1: the job cuts with a spindle that turns, M6 of Eding CNC stops it."""
    assert translated(tmp_path, "another tool", again=1, spindle="G0 X11").verdict is not Verdict.SAFE


def test_a_change_without_the_job_s_own_start_leaves_the_spindle_off(tmp_path: Path) -> None:
    done = translated(tmp_path, "always", spindle="G0 X11")
    assert done.verdict is Verdict.SAFE
    assert done.files[""].decode().count("M3\n") == 1


def test_a_spindle_that_may_be_on_is_open(tmp_path: Path) -> None:
    done = translated(tmp_path, "an input")
    assert done.verdict is not Verdict.SAFE
    assert any("may leave the spindle on" in one.message for one in done.findings.kept)
