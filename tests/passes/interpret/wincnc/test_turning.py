"""Workspaces of a turning spindle (WinCNC g54= T3), and of heads that may move: what is not known is not made up.

Manual: WINCNC.INI Settings: g54=; Workspace; G Codes: G54 … G57.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from gproof.cli.main import main

INI = """unit=MM
timertype=7200
axischar=XYZC
axisspec=p0 s0 d0 r80 a30000 t1
axisvel=r6000 f2000
axisspec=p0 s1 d1 r80 a30000 t2
axisvel=r6000 f2000
axisspec=p0 s2 d2 r80 a24000 t3
axisvel=r3600 f1000
axisspec=p0 s3 d3 r80 a24000 t4
axisvel=r3600 f1000
softlim=T1
lolim=X0 Y0 Z-150 C-360
hilim=X600 Y400 Z0 C360
g55=X10 Y0 T3 R20
g56=X0 Y0 T0
g57=X100 Y0 T0
g58=X100 Y0 T0 M0
g59=X100 Y0 T0 M1
nmode=90
"""
TOML = """schema = "gproof-machine/1"
base = "WINCNC.INI"
units = "mm"
[controls]
shift_sign = 1
"""
SETUP = """schema = "gproof-setup/1"
units = "mm"
homed = ["x", "y", "z", "c"]
active_work = 1
tool = 1
start = {x = 50.0, y = 50.0, z = -10.0, c = 0.0}
g92 = {x = 0.0, y = 0.0, z = 0.0, c = 0.0}
[tools.1]
length = 0.0
"""


def judged(
    folder: Path, capsys: pytest.CaptureFixture[str], program: str, setup: str = SETUP
) -> tuple[str, set[tuple[str, int]], dict]:
    """Verdict, (code, line) of errors and unknowns, and the ends by axis."""
    for name, text in (
        ("WINCNC.INI", INI),
        ("machine.toml", TOML),
        ("CNC.MAC", ""),
        ("setup.toml", setup),
        ("job.tap", program),
    ):
        (folder / name).write_text(text, encoding="ascii")
    files = (str(folder / name) for name in ("job.tap", "machine.toml", "setup.toml"))
    job, machine, setup = files
    main(["check", job, "--machine", machine, "--setup", setup, "--format", "json"])
    report = json.loads(capsys.readouterr().out)
    found = {(f["code"], f["line"]) for f in report["findings"] if f["severity"] in ("error", "unknown")}
    return report["verdict"], found, report["summary"]["end"]


def test_what_turns_and_x_and_y_are_not_known(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Z stays where it was; C, X and Y are anywhere: distances from there tell nothing, and nothing is made up."""
    verdict, found, end = judged(tmp_path, capsys, "G55 X100 Y100\nG91\nG0 C700\nG1 X900\nZ-5\n")
    assert verdict == "UNKNOWN"
    assert ("GP113", 1) in found
    assert not {code for code, _ in found} & {"GP301", "GP303"}
    assert (end["x"], end["y"], end["c"], end["z"]) == (None, None, None, -15.0)


def test_other_axes_are_judged_behind_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    verdict, found, _ = judged(tmp_path, capsys, "G49\nG55 X100 Y100\nG0 Z5\n")
    assert verdict == "UNSAFE"
    assert ("GP301", 3) in found


@pytest.mark.parametrize(("x", "verdict"), [(600, "UNKNOWN"), (649, "UNKNOWN"), (651, "UNSAFE"), (-51, "UNSAFE")])
def test_words_are_within_the_shift_and_twice_the_radius(
    x: int, verdict: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A shift of 10 and a radius of 20: at most 50 beside the word, either way; the limits are 0 and 600."""
    assert judged(tmp_path, capsys, f"G55 X100 Y100\nG0 X{x} Y100\n")[0] == verdict


def test_another_workspace_is_known_again(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    _, found, end = judged(tmp_path, capsys, "G55 X100 Y100\nG56\nG0 X300 Y200 C90\n")
    assert found == {("GP113", 1)}
    assert (end["x"], end["y"], end["c"]) == (300.0, 200.0, 90.0)


@pytest.mark.parametrize(
    ("program", "verdict"),
    [
        # From X50: with M1 the head goes to 150, with M0 it stays; where M is not there both are followed.
        ("G59\nL91 G0 X450\n", "SAFE"), ("G59\nL91 G0 X451\n", "UNSAFE"), ("G59\nL91 G0 X-60\n", "SAFE"),
        ("G58\nL91 G0 X-50\n", "SAFE"), ("G58\nL91 G0 X-51\n", "UNSAFE"),
        ("G57\nL91 G0 X450\n", "SAFE"), ("G57\nL91 G0 X451\n", "UNKNOWN"), ("G57\nL91 G0 X551\n", "UNSAFE"),
        ("G57\nL91 G0 X-60\n", "UNKNOWN"), ("G57\nL91 G0 X-50\n", "SAFE"), ("G57\nG0 X500\n", "SAFE"),
        ("G57\nG0 X501\n", "UNSAFE"),
    ],
)  # fmt: skip
def test_heads_that_move_and_heads_that_may(
    program: str, verdict: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert judged(tmp_path, capsys, f"G49\n{program}")[0] == verdict


@pytest.mark.parametrize(
    ("program", "line"),
    [
        ("[a]\nG90\nF500\nG0 X100\nG1 Y5\n", 4),
        ("[a]\nG90\nF500\nG0\n[b]\nG53 Z0\nG0 X100\n", 6),
        ("[a]\nG90\nF500\nG81 X5 Y5 Z-20 R0\n", 4),
    ],
)
def test_a_workspace_that_turns_from_the_start_stands_at_the_first_move(
    program: str, line: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    _, found, _ = judged(tmp_path, capsys, program, SETUP.replace("active_work = 1", "active_work = 2"))
    assert {at for code, at in found if code == "GP113"} == {line}
