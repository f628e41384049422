"""Conditions of limits and boundaries on the same unknown offsets, worked out by hand."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest

from gproof.cli.main import main
from gproof.driver.condition_feasibility import contradiction
from gproof.ir.verdict import Condition

INI = "unit=MM\naxischar=XYZ\n"
INI += "".join(f"axisspec=p0 s{n} d{n} r100 a400 t{n + 1}\naxisvel=r600f150s50m200h450\n" for n in range(3))
INI += "portout=7, 8002\nlolim=X0 Y0 Z-50\nhilim=X50 Y300 Z50\nsoftlim=T1\n"
SETUP = """schema = "gproof-setup/1"
units = "mm"
homed = ["x", "y", "z"]
active_work = 1
start = {x = 0.0, y = 0.0, z = 0.0}
"""


def check(
    folder: Path, boundary: str, capsys: pytest.CaptureFixture[str], moves: str = "G0 X0\nG0 X40\n"
) -> tuple[str, list[str], list[list[int]]]:
    (folder / "WINCNC.INI").write_text(INI + boundary)
    (folder / "CNC.MAC").write_text("")
    (folder / "setup.toml").write_text(SETUP)
    (folder / "job.tap").write_text("G90\n" + moves)
    words = ["--machine", str(folder / "WINCNC.INI"), "--setup", str(folder / "setup.toml"), "--format", "json"]
    capsys.readouterr()
    main(["check", str(folder / "job.tap"), *words])
    report = json.loads(capsys.readouterr().out)
    told = [f for f in report["findings"] if f["severity"] in ("error", "unknown")]
    places = [[f["line"], *(other["line"] for other in f.get("related", ()))] for f in told]
    return report["verdict"], [f["code"] for f in told], places


@pytest.mark.parametrize(
    ("boundary", "verdict", "codes"),
    [
        # X 0 to 40 of a G92 that nobody stated: limits 0 to 50 leave it 0 to 10.
        ("", "SAFE", []),
        ("lobound=X5\n", "SAFE", []),  # boundaries leave G92 out: it is 5 at least
        ("lobound=X10\n", "SAFE", []),
        ("lobound=X10.1\n", "UNSAFE", ["GP303"]),
        ("hibound=X39\n", "UNSAFE", ["GP303"]),  # -1 at most
    ],
)
def test_limits_and_boundaries(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], boundary: str, verdict: str, codes: list[str]
) -> None:
    assert check(tmp_path, boundary, capsys)[:2] == (verdict, codes)


@pytest.mark.parametrize("boundary", ["lobound=X10.1\n", "hibound=X39\n"])
@pytest.mark.parametrize(
    ("moves", "places"),
    [
        ("G0 X0\nG0 X40\n", [3, 2]),
        ("G0 X40\nG0 X0\n", [3, 2]),
        ("G0 X20\nG0 Y1\nG0 X40\nG0 Y2\nG0 X0\nG0 Y3\n", [6, 4]),
    ],
)
def test_limits_and_boundaries_that_exclude_each_other_stand_at_the_later_move(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], boundary: str, moves: str, places: list[int]
) -> None:
    """One of the two asks something of X0, the other one of X40, whichever comes first."""
    assert check(tmp_path, boundary, capsys, moves)[1:] == (["GP303"], [places])


def condition(low: float, high: float, **terms: int) -> Condition:
    return Condition(terms=tuple(sorted(terms.items())), low=low, high=high)


@pytest.mark.parametrize(
    ("conditions", "missed"),
    [
        ([], 0.0),
        ([condition(0, 1, a=1), condition(1, 2, a=1)], 0.0),
        ([condition(0, 1, a=1), condition(1 + 1e-9, 2, a=1)], 0.0),
        ([condition(0, 1, a=1), condition(3, 4, a=1)], 2.0),
        ([condition(0, 1, a=1), condition(0, 1, b=1), condition(2, 3, a=1, b=1)], 0.0),
        ([condition(0, 1, a=1), condition(0, 1, b=1), condition(2.5, 3, a=1, b=1)], 0.5),
        ([condition(0, 1, a=1), condition(5, 6, b=1), condition(-3.5, math.inf, a=1, b=-1)], 0.5),
        ([condition(0, 1, a=1), condition(5, 6, b=1), condition(-math.inf, -7, a=1, b=-1)], 1.0),
        ([condition(1, math.inf, a=1), condition(-math.inf, -2, a=-1)], 0.0),
        ([condition(1, 1, a=1, b=1), condition(1, 1, b=1, c=1), condition(1, 1, a=1, c=1)], 0.0),
        ([condition(1, 1, a=1, b=1), condition(1, 1, b=1, c=1), condition(2, 2, a=1, b=2, c=1)], 0.0),
        ([condition(1, 1, a=1, b=1), condition(1, 1, b=1, c=1), condition(3, 3, a=1, b=2, c=1)], 1.0),
    ],
)
def test_conditions_together(conditions: list[Condition], missed: float) -> None:
    assert contradiction(conditions) == pytest.approx(missed, abs=1e-6)
