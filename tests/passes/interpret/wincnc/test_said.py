"""What a job or a shop's files say in rare places reaches its answer: G9, the least speed of a spindle, CNC.MAC."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from support.command import in_this_process

INI = """\
unit=mm
axischar=XYZ
axisspec=s0d0r80a30000t1
axisspec=s1d1r80a30000t2
axisspec=s2d2r80a30000t3
lolim=x0y0z-150
hilim=x600y400z0
softlim=t1
spindle=t1r18000
"""
MACHINE = """\
schema = "gproof-machine/1"
units = "mm"
base = "WINCNC.INI"
[spindles.0]
min_rpm = 6000
"""
ACCEPTS = '[controller]\naccepts = ["text-after-comment"]\n'


def judged(folder: Path, lines: str, *, machine: str = "", macros: str = "") -> dict:
    files = {"WINCNC.INI": INI, "CNC.MAC": macros, "machine.toml": MACHINE + machine, "job.tap": f"G90\n{lines}\n"}
    for name, text in files.items():
        (folder / name).write_text(text, "utf-8")
    words = ["check", "job.tap", "--machine", "machine.toml", "--setup", "zero", "--format", "json"]
    done = in_this_process(words, folder)
    assert done.out, done.err
    report: dict = json.loads(done.out)
    report["codes"] = {one["code"] for one in report["findings"]}
    return report


@pytest.mark.parametrize(("speed", "told"), [("S0", 0), ("S5999", 1), ("S6000", 0), ("S18000", 0), ("S18001", 1)])
def test_speeds_below_the_least_are_told(speed: str, told: int, tmp_path: Path) -> None:
    """spindle= has only the most; the least is the machine file's. S0 is a spindle that rests."""
    report = judged(tmp_path, speed)
    assert [one["code"] for one in report["findings"]].count("GP271") == told, report["findings"]


@pytest.mark.parametrize(("line", "said"), [("G9 S20", True), ("G9 S20 A5", True), ("G9 S0", False), ("G9 A5", False)])
def test_smoothing_that_the_job_sets_is_an_assumption(line: str, said: bool, tmp_path: Path) -> None:
    report = judged(tmp_path, f"{line}\nG0 X5")
    assert report["verdict"] == "SAFE"
    assert any("the controller rounds (G9)" in text for text in report["assumptions"]) is said


MACROS = {
    "M8=G0 [over] X5": 5.0,
    "M8=[over] G0 X5": 5.0,
    "M8=G0 [a] X5 [b]": 5.0,
    "M8=G0 (a) X5 [b] Y0 [c]": 5.0,
    "[N1] M8=G0 X5": 5.0,
    "(a)[b] M8=G0 [c] X5": 5.0,
}


@pytest.mark.parametrize("definition", MACROS)
def test_text_after_a_comment_of_a_macro(definition: str, tmp_path: Path) -> None:
    """Where the shop says that its controller takes it, in CNC.MAC as in a job; with the assumption that says so."""
    assert judged(tmp_path, "M8", macros=f"{definition}\n")["verdict"] != "SAFE"
    report = judged(tmp_path, "M8", machine=ACCEPTS, macros=f"{definition}\n")
    assert (report["verdict"], report["summary"]["end"]["x"]) == ("SAFE", MACROS[definition]), report["findings"]
    assert any("comment" in text for text in report["assumptions"]), report["assumptions"]
    report = judged(tmp_path, "G0 X5", machine=ACCEPTS, macros=f"{definition}\n")
    assert not any("comment" in text for text in report["assumptions"])
