"""The box of a job that the report shows: one line an axis, however many values are only bounded."""

from __future__ import annotations

from pathlib import Path

from gproof.driver.judge import judge
from gproof.driver.session import Running, open_session

MACHINE = """schema = "gproof-machine/1"
units = "mm"
[controller]
dialect = "mcuwin"
[axes.x]
min = -100.0
max = 100.0
[axes.y]
min = -100.0
max = 100.0
[din]
position_unit = "mm"
time_unit = "min"
"""


def test_bounded_values_are_one_range(tmp_path: Path) -> None:
    """Y lies within 12 mm of the zero offset at every one of fifty points whose X nobody knows."""
    (tmp_path / "m.toml").write_text(MACHINE)
    job = tmp_path / "job.din"
    job.write_text(
        "%\nG90 G94 F100\n$for CI600 := 1 to 50 do begin\nG01 X(X.tp + 0.5) Y(12 * sin(X.tp / 10))\n$end\nM30\n%\n"
    )
    session = open_session(job, machine=tmp_path / "m.toml", setup=None, dialect=None)
    box = judge(session, running=Running()).summary.box
    y = [(relative, low, high) for axis, relative, low, high in box if axis == "y"]
    assert [(round(low, 9), round(high, 9)) for _, low, high in y] == [(-12.0, 12.0)], box
    assert "value" not in y[0][0]
