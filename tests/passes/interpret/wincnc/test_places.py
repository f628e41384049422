"""Places that a shop's files name without numbers: stored positions by axis, a probed surface, maps that are not there.

Ends are counted by hand from the positions of the setup: T2 at X100 Y300 Z-50, the surface between -40 and -30.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from support.command import in_this_process

INI = """\
unit=mm
axischar=XYZW
axisspec=s0d0r80a30000t1
axisspec=s1d1r80a30000t2
axisspec=s2d2r80a30000t3
axisspec=s3d3r80a30000t3
lolim=x0y0z-150w-150
hilim=x600y400z0w0
softlim=t1
positions=p20h20t10
scan=t1a2c1
auxin=c1p2b2
"""
SETUP = """\
schema = "gproof-setup/1"
units = "mm"
homed = ["x", "y", "z", "w"]
active_work = 1
tool = 1
start = {x = 50.0, y = 50.0, z = 0.0, w = 0.0}
g92 = {x = 0.0, y = 0.0, z = 0.0, w = 0.0}

[measures]
z = 0.0
w = 0.0

[positions.T2]
x = 100.0
y = 300.0
z = -50.0
lift = false

[positions.P3]
x = 10.0
lift = false

[positions.T4]
x = 200.0
y = 100.0
z = -60.0
w = -20.0
lift = true
"""
CONTACT = "\n[contacts]\nz = [-40.0, -30.0]\n"


def judged(lines: str, folder: Path, *, ini: str = "", setup: str = "") -> dict:
    (folder / "WINCNC.INI").write_text(INI + ini, "utf-8")
    (folder / "CNC.MAC").write_text("", "utf-8")
    (folder / "setup.toml").write_text(SETUP + setup, "utf-8")
    (folder / "job.tap").write_text(lines, "utf-8")
    words = ["check", "job.tap", "--machine", "WINCNC.INI", "--setup", "setup.toml", "--format", "json"]
    done = in_this_process(words, folder)
    assert done.out, done.err
    report: dict = json.loads(done.out)
    report["codes"] = {one["code"] for one in report["findings"] if one["severity"] in ("error", "unknown")}
    return report


ENDS = {
    # All of it; the axes that are named; a distance from it, with and without blanks, from braces too.
    "g53 t2": {"x": 100, "y": 300, "z": -50},
    "g53 t2 xy": {"x": 100, "y": 300, "z": 0},
    "g53t2y": {"x": 50, "y": 300, "z": 0},
    "g53t2y-2": {"x": 50, "y": 298, "z": 0},
    "g53 t{2}z+3.5": {"x": 50, "y": 50, "z": -46.5},
    "g53 t{tp1+1} x+1 y-1": {"x": 101, "y": 299, "z": 0},
    "g20\ng53t2y-2": {"x": 50, "y": 249.2, "z": 0},
    "g53 p3 x-4": {"x": 6, "y": 50, "z": 0},
    "g92x7\ng53 p3 x-4": {"x": 6, "y": 50, "z": 0},
    "g91\ng53t2xy": {"x": 100, "y": 300, "z": 0},
}


@pytest.mark.parametrize("line", ENDS)
def test_a_stored_place_by_axis(line: str, tmp_path: Path) -> None:
    report = judged(f"g90\n{line}\n", tmp_path)
    assert report["verdict"] == "SAFE", report["findings"]
    end = report["summary"]["end"]
    assert {axis: end[axis] for axis in "xyz"} == pytest.approx(ENDS[line])


OPEN = {
    # A place that is not stored; which number counts outside of G53; a head that is lifted and not named.
    "g53 p3 y": ("UNKNOWN", set()),
    "g0 t2 x": ("UNKNOWN", {"GP113"}),
    "t2 x5": ("UNKNOWN", {"GP113"}),
    "g53 t9 xy": ("UNKNOWN", {"GP113"}),
    "g53 t11 xy": ("UNSAFE", {"GP286"}),
    "g53 t2p3": ("UNSAFE", {"GP287"}),
    "g53 t2 x510": ("UNSAFE", {"GP301"}),
    "g53 t2z+60": ("UNSAFE", {"GP301"}),
    "g0z-30\ng53t4xy\ng0w-10": ("SAFE", set()),
    "g0z-30\ng53t4xy\ng91g0z-130": ("UNKNOWN", {"GP304"}),
    "g0z-30\ng53t4xy\ng53z-130\ng91g0z-20": ("SAFE", set()),
}


@pytest.mark.parametrize("line", OPEN)
def test_what_of_a_stored_place_is_open(line: str, tmp_path: Path) -> None:
    verdict, codes = OPEN[line]
    report = judged(f"g90\n{line}\n", tmp_path)
    assert report["verdict"] == verdict, report["findings"]
    assert codes <= report["codes"]


SURFACES = {
    # Z5 is the surface between -40 and -30: Z15 lies between -30 and -20, Z-105 between -150 and -140.
    "l82z5\ng0z15\n": "SAFE",
    "l82z5\ng1z-105f600\n": "SAFE",
    "l82z5\ng1z-106f600\n": "UNKNOWN",
    "l82z5\ng1z-116f600\n": "UNSAFE",
    "l82\ng0z30\n": "SAFE",
    "l82\ng0z31\n": "UNKNOWN",
    "l82\ng0z41\n": "UNSAFE",
    # Nobody says how far it rises again.
    "l82\ng91g1z-110f600\n": "SAFE",
    "l82\ng91g1z-111f600\n": "UNKNOWN",
    # It began at -35: the contact is no higher.
    "g0z-35\nl82\ng0z35\n": "SAFE",
    "g0z-45\nl82\n": "UNKNOWN",
    "l83x10y10\n": "UNKNOWN",
}


@pytest.mark.parametrize("lines", SURFACES)
def test_a_surface_whose_contact_is_stated(lines: str, tmp_path: Path) -> None:
    assert judged(f"g90\n{lines}", tmp_path, setup=CONTACT)["verdict"] == SURFACES[lines]
    assert judged(f"g90\n{lines}", tmp_path)["verdict"] != "SAFE"


def test_maps_that_are_not_there(tmp_path: Path) -> None:
    assert judged("g90\nl600\nl601x\ng0x60\n", tmp_path)["verdict"] == "SAFE"
    axes = INI.replace("axisspec=s1", "axismap=s0e600m50\naxisspec=s1")
    (tmp_path / "WINCNC.INI").write_text(axes, "utf-8")
    report = judged("g90\nl600\n", tmp_path, ini="axismap=s0e600m50\n")
    assert (report["verdict"], report["codes"]) == ("UNKNOWN", {"GP113"})
