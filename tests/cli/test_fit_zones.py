"""`gproof fit` where a clamp moves with the work and the path does not: told of offsets, not of their negatives."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import shapely

from gproof.cli.fit import fit_session
from gproof.cli.main import main
from gproof.cli.session import Running, open_session
from gproof.ir.verdict import Verdict

AXES = "".join(f'[axes.{axis}]\nkind = "linear"\nmin = -900.0\nmax = 900.0\n' for axis in "xyz")
CLAMP = '[[keep_out]]\nname = "clamp"\nx = [100.0, 120.0]\ny = [100.0, 130.0]\nz = [-150.0, -40.0]\nwork = 1\n'
# The way through (300, 220) at -50 of the machine stays where it is, the clamp goes with G54.
JOB = "G21 G90 G17 G94 G40 G49 G80 G54\nG53 G0 Z-50\nG53 G0 X300 Y220\nG53 G0 X310\nM30\n"
STATED = "start = {x = 290.0, y = 220.0, z = 400.0}\ng92 = {x = 0.0, y = 0.0, z = 0.0}\n"


def setup(x: float, y: float, z: float) -> str:
    return f'schema = "gproof-setup/1"\n{STATED}[work.1]\nx = {x}\ny = {y}\nz = {z}\n'


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    head = 'schema = "gproof-machine/1"\nname = "m"\nunits = "mm"\n[controller]\ndialect = "eding"\n'
    (tmp_path / "machine.toml").write_text(head + AXES + CLAMP, encoding="utf-8")
    (tmp_path / "job.cnc").write_text(JOB, encoding="utf-8")
    return tmp_path


def test_the_region_is_where_check_says_safe(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = [str(folder / "job.cnc"), "--machine", str(folder / "machine.toml"), "--setup", str(folder / "setup.toml")]
    (folder / "setup.toml").write_text(setup(0.0, 0.0, 0.0), encoding="utf-8")
    session = open_session(
        folder / "job.cnc", machine=folder / "machine.toml", setup=str(folder / "setup.toml"), dialect="eding"
    )
    (one,) = fit_session(session, Running()).fit.zones
    assert [[count for _, count in form] for form in one.place.terms] == [[1], [1], [1]]
    assert one.names == ("G54 X", "G54 Y", "G54 Z")
    random = np.random.default_rng(612)
    seen = set()
    for _ in range(40):
        # The clamp's corner about the way, so that half of the places are hit.
        x, y, z = (random.uniform(150, 230), random.uniform(70, 140), random.uniform(-30, 130))
        free = any(
            layer.z[0] <= z <= layer.z[1] and layer.left.covers(shapely.Point(x, y))
            for layer in one.place.region.layers
        )
        (folder / "setup.toml").write_text(setup(x, y, z), encoding="utf-8")
        assert (main(["check", *words, "--quiet"]) == 0) is free, (x, y, z)
        seen.add(free)
    capsys.readouterr()
    assert seen == {True, False}


def test_a_safe_place_beside_what_is_known_is_not_called_outside(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = setup(200.0, 100.0, -20.0).replace(STATED, "g92 = {x = 0.0, y = 0.0, z = 0.0}\n")
    (folder / "setup.toml").write_text(text, encoding="utf-8")
    words = [str(folder / "job.cnc"), "--machine", str(folder / "machine.toml"), "--setup", str(folder / "setup.toml")]
    code = main(["fit", *words])
    printed = capsys.readouterr().out
    session = open_session(
        folder / "job.cnc", machine=folder / "machine.toml", setup=str(folder / "setup.toml"), dialect="eding"
    )
    fit = fit_session(session, Running()).fit
    assert (code == 0) is (fit.verdict is Verdict.SAFE)
    assert ("now outside" in printed) is (fit.verdict is not Verdict.SAFE and fit.zones[0].inside is False)
    assert "-1 x" not in printed
