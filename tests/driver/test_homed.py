"""Homed axes of a setup: not stated is an assumption that is printed, stated as none is UNKNOWN, in every dialect.

The programs move X, Y and Z of machines that would be large enough, if anybody knew where their zero is.
McuWIN manual 2.4, 3.29; Eding manual 2.1.7 (HomingMandatory), 2.10; WinCNC manual, Homing the Machine.
"""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest
from support.command import in_this_process

from gproof.ir.verdict import Verdict
from gproof.verify.certificate.check import check_package
from gproof.verify.certificate.package import read_package
from gproof.verify.stream import validate

AXES = "".join(
    f'[axes.{name}]\nmin = {low}\nmax = {high}\nsteps_per_unit = "320/1"\nmax_velocity = 100.0\n'
    f"max_acceleration = 500.0\n"
    for name, low, high in (("x", -150.0, 150.0), ("y", -100.0, 100.0), ("z", -60.0, 60.0))
)
SETUP = 'schema = "gproof-setup/1"\n{}start = {{x = 0.0, y = 0.0, z = 0.0}}\nactive_work = 1\n' + "".join(
    f"[{table}]\nx = 0.0\ny = 0.0\nz = 0.0\n" for table in ("work.1", "g92", "measures")
)
JOBS = {
    "mcuwin": ("job.src", "%JOB\nG90 G71 F200\n{}G00 X10 Y10 Z5\nG01 Z-1\nG02 X12 Y10 I1 J0\nM30\n%\n", "G74\n"),
    "eding": (
        "job.cnc",
        "g21 g90 g54\n{}g0 x10 y10 z5\ng1 z-1 f200\ng2 x12 y10 i1 j0\nm30\n",
        "home x\nhome y\nhome z\n",
    ),
    "wincnc": ("job.tap", "{}g0 x10 y10 z5\ng1 z-1 f200\ng2 x12 y10 i1 j0 f200\n", "G28\n"),
}
EXTRA = {
    "mcuwin": '[din]\nposition_unit = "mm"\ntime_unit = "min"\nabsolute_centers = false\nzero_offsets = [[0, 0, 0]]\n'
    '[din.task0]\nM30 = "end"\nG74 = "home"\n',
    "eding": "",
    "wincnc": "",
}


def judged(folder: Path, dialect: str, homed: str, *, homes: bool = False) -> tuple[int, str]:
    """(exit code, report) of the job; homes: it begins with a reference run of all axes."""
    name, text, home = JOBS[dialect]
    (folder / name).write_text(text.format(home if homes else ""))
    (folder / "setup.toml").write_text(SETUP.format(homed).replace("[measures]\nx = 0.0\ny = 0.0\n", "[measures]\n"))
    (folder / "machine.toml").write_text(
        f'schema = "gproof-machine/1"\nunits = "mm"\nname = "m"\n{AXES}'
        f'[controller]\ndialect = "{dialect}"\n{EXTRA[dialect]}'
    )
    (folder / "CNC.MAC").write_text("")
    done = in_this_process(["check", name, "--machine", "machine.toml", "--setup", "setup.toml"], folder)
    return done.exit, done.out + done.err


@pytest.mark.parametrize("dialect", JOBS)
def test_what_is_not_stated_is_assumed_and_said(dialect: str, tmp_path: Path) -> None:
    code, text = judged(tmp_path, dialect, "")
    assert code == 0, text
    assert "X Y Z are homed: machine positions are what the controller shows" in text


@pytest.mark.parametrize("dialect", JOBS)
def test_all_that_is_stated_is_no_assumption(dialect: str, tmp_path: Path) -> None:
    code, text = judged(tmp_path, dialect, 'homed = ["x", "y", "z"]\n')
    assert code == 0, text
    assert "homed:" not in text


@pytest.mark.parametrize("dialect", JOBS)
@pytest.mark.parametrize(
    ("homed", "lost"), [("homed = []\n", "XYZ"), ('homed = ["z"]\n', "XY"), ('homed = ["x", "y"]\n', "Z")]
)
def test_an_axis_that_is_stated_not_to_be_homed_is_nowhere(dialect: str, homed: str, lost: str, tmp_path: Path) -> None:
    code, text = judged(tmp_path, dialect, homed)
    assert code == 2, text
    assert "are homed" not in text
    for axis in "XYZ":
        assert (
            f"the position of {axis} depends on the start position of {axis}, which has had no reference run" in text
        ) == (axis in lost), text


@pytest.mark.parametrize("dialect", JOBS)
def test_a_reference_run_of_the_job_is_one(dialect: str, tmp_path: Path) -> None:
    _, text = judged(tmp_path, dialect, "homed = []\n", homes=True)
    assert "has had no reference run" not in text


@pytest.mark.parametrize("dialect", JOBS)
def test_no_stream_is_made_and_none_is_accepted(dialect: str, tmp_path: Path) -> None:
    """Neither compiled for axes without a reference run, nor run on them when it was made for others."""
    judged(tmp_path, dialect, 'homed = ["x", "y", "z"]\n')
    name = JOBS[dialect][0]
    words = [name, "--machine", "machine.toml", "--setup"]
    made = in_this_process(["compile", *words, "setup.toml", "--unsigned", "-o", "job.gpx"], tmp_path)
    assert made.exit == 0, made.out + made.err
    text = (tmp_path / "setup.toml").read_text()
    (tmp_path / "none.toml").write_text(text.replace('homed = ["x", "y", "z"]', "homed = []"))
    assert in_this_process(["compile", *words, "none.toml", "--unsigned", "-o", "no.gpx"], tmp_path).exit == 2
    assert not (tmp_path / "no.gpx").exists()
    package = read_package(tmp_path / "job.gpx")
    for homed, said, told in (
        (("x", "y", "z"), "", False),
        (None, "made for homed axes X Y Z; now the setup does not say which axes are homed", False),
        ((), "made for X homed; now it is not homed", True),
    ):
        now = dataclasses.replace(package.setup, homed=homed)
        found = [f.message for f in check_package(package, package.machine, now).findings if f.code.number == 825]
        assert any(said in one for one in found) if said else not found, (homed, found)
        # A package whose own setup says it: the stream checker looks at that by itself.
        own = validate(package.stream, package.trace, package.machine, now)
        assert (own.verdict is Verdict.SAFE) != told, (homed, own.findings)
