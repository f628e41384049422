"""A compensated job from text to certified steps: short arcs at corners, arcs of hardly any radius, many bends."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from support.goldens import ROOT

from gproof.cli.main import main

MACHINE = ROOT / "docs" / "codes" / "machine.toml"
HEAD = "G21 G17 G90 G94 G54 G40 G49 G80\nG64 P0.05\nM6 T1\nF1500\nG0 X20 Y20\n"

# A polygon of 90 corners of 4 degrees each, every one rounded by an arc of 0.2 mm.
POLYGON = "".join(
    f"G1 X{200 + 60 * math.sin(math.radians(4 * k)):.4f} Y{200 + 60 * math.cos(math.radians(4 * k)):.4f}\n"
    for k in range(1, 91)
)
JOBS = {
    "many corners": f"G0 X200 Y290\nG0 X180 Y250\nG41 D1\nG1 X200 Y260\n{POLYGON}G40\n",
    "sharp corners": "G41 D1\nG1 X60 Y40\nG1 X100 Y39\nG1 X60 Y38\nG1 X59 Y50\nG1 X59.5 Y60\nG40\n",
    "arcs of hardly more than the tool": "G41 D1\nG1 X60 Y40\nG1 X80\nG3 X83.001 Y43.001 R3.001\nG1 Y80\nG40\n",
    "a helix around a boss": "G0 X70\nG41 D1\nG1 X60 Y40 Z-2\nG1 Y60\nG2 I20 X60 Y60 Z-3\nG2 I20 X60 Y60 Z-4\nG40\n",
}


@pytest.mark.parametrize("name", JOBS)
def test_a_compensated_job_becomes_certified_steps(name: str, tmp_path: Path) -> None:
    job = tmp_path / "job.cnc"
    job.write_text(HEAD + JOBS[name] + "M30\n")
    package = tmp_path / "job.gpx"
    assert main(["check", str(job), "--machine", str(MACHINE), "--setup", "zero"]) == 0
    words = ["compile", str(job), "--machine", str(MACHINE), "--setup", "zero", "-o", str(package)]
    assert main(words) == 0
    assert main(["verify", str(package)]) == 0
