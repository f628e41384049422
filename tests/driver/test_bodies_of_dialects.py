"""The same part, clamp and tool under jobs of the three dialects: the same answers.

A wall of the part stands at X20; an end mill of 6 mm goes along it at X17, where it touches, and at X17.2, where it is
0.2 mm within. A clamp ends at Y40; the cut ends at Y35, 2 mm before it, or at Y37.5, half a millimetre within.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from support.command import in_this_process

from gproof.passes.checks.registry import decided

ROOT = Path(__file__).resolve().parents[2]

TOOL = """[tools.1]
length = 40.0
diameter = 6.0
shape = "flat"
flute_length = 20.0
shank_diameter = 6.0
stickout = 40.0
holder = [[30.0, 30.0, 50.0]]
"""
SETUP = """schema = "gproof-setup/1"
homed = ["x", "y", "z"]
tool = 1
active_work = 1
[start]
x = 100.0
y = 100.0
z = 0.0
[[part]]
polygon = [[20, 0], [60, 0], [60, 30], [20, 30]]
bottom = -10
top = 0
[[fixtures]]
name = "clamp"
box = [[0, 40, -10], [60, 60, 10]]
"""
EDING = "G21 G17 G90 G94 G40 G49 G80 G54\nG43\nG0 Z20\nG0 X{x} Y-10\nG1 Z-5 F300\nG1 Y{y}\nG0 Z20\nM30\n"
WINCNC = "G90\nG0 Z20\nG0 X{x} Y-10\nG1 Z-5 F300\nG1 Y{y}\nG0 Z20\n"
MCUWIN = "% P\nG90 G54\nG00 Z20\nG00 X{x} Y-10\nG01 Z-5 F300\nG01 Y{y}\nG00 Z20\nM30\n"
AXES = "".join(f"[axes.{axis}]\nmin = -200.0\nmax = 200.0\n{{more}}" for axis in "xyz")
INI = """unit=MM
axischar=XYZ
axisspec=p0 s0 d0 r100 a100 t1
axisspec=p0 s1 d1 r100 a100 t2
axisspec=p0 s2 d2 r100 a100 t3
axisvel=r6000 f3000
lolim=X-200 Y-200 Z-200
hilim=X200 Y200 Z200
softlim=T1
"""
DIN = """[din]
position_unit = "mm"
time_unit = "min"
absolute_centers = false
interpolation_axes = "XYZ"
tool_file = ""
zero_offsets = [[0, 0, 0]]
[din.task0]
M30 = "end"
"""


def machine_of(folder: Path, dialect: str) -> tuple[str, str, str]:
    """Name and text of the job; machine file."""
    head = 'schema = "gproof-machine/1"\nunits = "mm"\n'
    if dialect == "wincnc":
        (folder / "WINCNC.INI").write_text(INI)
        (folder / "CNC.MAC").write_text("")
        return "job.tap", WINCNC, head + 'base = "WINCNC.INI"\n' + TOOL
    if dialect == "mcuwin":
        (folder / "McuWIN.ini").write_text("[MCU]\n")
        axes = AXES.format(more='position_unit = "mm"\n')
        return "job.src", MCUWIN, head + 'base = "McuWIN.ini"\n' + axes + TOOL + DIN
    return "job.cnc", EDING, head + AXES.format(more="") + TOOL


def judged(folder: Path, dialect: str, x: float, y: float, name: str, offsets: str = "") -> tuple[str, set[str]]:
    """The verdict of one property, and the codes of errors and unknowns."""
    job, text, machine = machine_of(folder, dialect)
    (folder / job).write_text(text.format(x=x, y=y))
    (folder / "machine.toml").write_text(machine)
    (folder / "setup.toml").write_text(SETUP + offsets)
    words = ["check", str(folder / job), "--machine", str(folder / "machine.toml"), "--dialect", dialect]
    words += ["--setup", str(folder / "setup.toml"), "--also", name, "--format", "json"]
    report = json.loads(in_this_process(words, ROOT).out)
    found = {one["code"] for one in report["findings"] if one["severity"] in ("error", "unknown")}
    return report["properties"][name]["verdict"], found


def test_they_are_decided() -> None:
    assert decided("gouges") and decided("collisions")


@pytest.mark.parametrize("dialect", ["eding", "wincnc", "mcuwin"])
def test_a_wall_that_is_touched_and_one_that_is_cut(tmp_path: Path, dialect: str) -> None:
    assert judged(tmp_path, dialect, 17.0, 35.0, "gouges")[0] == "SAFE"
    verdict, found = judged(tmp_path, dialect, 17.2, 35.0, "gouges")
    assert (verdict, "GP420" in found) == ("UNSAFE", True)


@pytest.mark.parametrize("dialect", ["eding", "wincnc", "mcuwin"])
def test_a_clamp_in_the_way(tmp_path: Path, dialect: str) -> None:
    assert "GP421" not in judged(tmp_path, dialect, 10.0, 35.0, "collisions")[1]
    verdict, found = judged(tmp_path, dialect, 10.0, 37.5, "collisions")
    assert (verdict, "GP421" in found) == ("UNSAFE", True)


@pytest.mark.parametrize("dialect", ["eding", "wincnc", "mcuwin"])
def test_offsets_that_are_stated_change_nothing(tmp_path: Path, dialect: str) -> None:
    stated = "[g92]\nx = 3.0\ny = -4.0\nz = 5.0\n" + ("" if dialect == "wincnc" else "[work.1]\nx=7.0\ny=8.0\nz=9.0\n")
    if dialect == "mcuwin":  # where the record that is selected is the offset in force
        stated = stated.replace("x = 3.0\ny = -4.0\nz = 5.0", "x = 7.0\ny = 8.0\nz = 9.0")
    assert judged(tmp_path, dialect, 17.0, 35.0, "gouges", stated)[0] == "SAFE"
    assert judged(tmp_path, dialect, 17.2, 35.0, "gouges", stated)[0] == "UNSAFE"


def test_each_property_says_that_smoothing_is_not_followed(tmp_path: Path) -> None:
    """How far a controller rounds corners is in no file: zones, gouges and collisions rest on the same assumption."""
    job, text, machine = machine_of(tmp_path, "wincnc")
    (tmp_path / job).write_text(text.format(x=17.0, y=35.0))
    (tmp_path / "machine.toml").write_text(machine)
    zone = '[[keep_out]]\nname = "post"\nx = [90.0, 95.0]\ny = [0.0, 5.0]\n'
    (tmp_path / "setup.toml").write_text(SETUP + zone)
    words = ["check", str(tmp_path / job), "--machine", str(tmp_path / "machine.toml"), "--dialect", "wincnc"]
    words += ["--setup", str(tmp_path / "setup.toml"), "--also", "gouges", "--also", "collisions", "--format", "json"]
    for smoothing, said in (("", False), ("accel=s50\n", True)):
        (tmp_path / "WINCNC.INI").write_text(INI + smoothing)
        properties = json.loads(in_this_process(words, ROOT).out)["properties"]
        for name in ("areas", "gouges", "collisions"):
            assumed = properties[name]["assumptions"]
            assert any("that the controller rounds" in sentence for sentence in assumed) is said, (name, assumed)
