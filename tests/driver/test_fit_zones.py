"""`gproof fit` where a clamp moves with the work and the path does not: told of offsets, not of their negatives."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
import shapely

from gproof.cli.main import main
from gproof.driver.fit.fitting import fit_session
from gproof.driver.judge import judge
from gproof.driver.session import Running, Session, open_session
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
    assert ("now outside; " in printed) is (fit.verdict is not Verdict.SAFE and fit.zones[0].inside is False)
    assert "-1 x" not in printed


def test_a_start_that_nobody_stated_is_taken_to_be_beside_the_zones(folder: Path) -> None:
    """Random ways behind `G53 G0 Z..`: with the start where the answer wants it, every offset of the region is SAFE."""
    rng = np.random.default_rng(5)
    told = 0
    for case in range(8):
        way = "".join(
            f"G1 X{rng.uniform(-40, 40):.3f} Y{rng.uniform(-40, 40):.3f} Z{rng.uniform(-20, 0):.3f} F500\n"
            for _ in range(3)
        )
        first = f"G53 G0 Z{rng.uniform(-39, 300):.3f}\n" if case % 3 else f"G53 G0 X{rng.uniform(-90, 90):.3f}\n"
        job = f"G21 G90 G17 G94 G40 G49 G80 G54\n{first}G0 X{rng.uniform(-40, 40):.3f} Y0\n{way}M30\n"
        (folder / "job.cnc").write_text(job, encoding="utf-8")
        clamp = CLAMP.replace("work = 1\n", "")
        machine = (folder / "machine.toml").read_text(encoding="utf-8").partition("[[keep_out]]")[0] + clamp
        (folder / "machine.toml").write_text(machine, encoding="utf-8")
        nowhere = 'schema = "gproof-setup/1"\ng92 = {x = 0.0, y = 0.0, z = 0.0}\n'
        (folder / "setup.toml").write_text(nowhere, encoding="utf-8")

        def read() -> Session:
            return open_session(
                folder / "job.cnc", machine=folder / "machine.toml", setup=str(folder / "setup.toml"), dialect="eding"
            )

        fit = fit_session(read(), Running()).fit
        where = f"{case}\n{job}{fit}"
        if not fit.assumed:
            continue
        told += 1
        found = re.match(r"the start position of (.) is between (\S+) and (\S+) mm", fit.assumed)
        assert found, where
        assert not fit.complete
        for _ in range(3):
            start = dict(zip("xyz", rng.uniform(-900, 900, 3).tolist(), strict=True))
            start[found[1].lower()] = float(rng.uniform(float(found[2]), float(found[3])))
            offset = {one.terms[0][0][-1]: float(rng.uniform(one.low, one.high)) for one in fit.ranges}
            for one in fit.zones:
                box = one.place.boxes[int(rng.integers(len(one.place.boxes)))]
                offset |= {
                    form[0][0][-1]: float(rng.uniform(*ends))
                    for form, ends in zip(one.place.terms, box, strict=True)
                    if form
                }
            text = nowhere + "".join(
                f"[{name}]\n" + "".join(f"{axis} = {v!r}\n" for axis, v in values.items())
                for name, values in (("start", start), ("work.1", offset))
            )
            (folder / "setup.toml").write_text(f"active_work = 1\n{text}", encoding="utf-8")
            judgement = judge(read(), running=Running())
            assert judgement.verdict is Verdict.SAFE, f"{text}{[f.message for f in judgement.findings.kept]}\n{where}"
    assert told >= 4
