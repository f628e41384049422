"""G10 L20 while G92 or a tool length is in force: both readings of "actual machine position" (Eding manual 3.4.5).

By hand. The tool stands at machine X = 10, Z = 50. G92 X0 there makes an offset of 10. ``G10 L20 P1 X5`` then gives an
offset of G54 of 10 - 5 - 10 = -5, when G92 is taken out, or of 10 - 5 = 5; G0 X20 goes to 20 - 5 + 10 = 25 or
20 + 5 + 10 = 35. With a length of 30 in force ``G10 L20 P1 Z0`` gives 50 - 30 = 20 or 50; Z20 is at 70 or 100.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from support.command import in_this_process

SETUP = """schema = "gproof-setup/1"
homed = ["x", "y", "z"]
start = {x = 10.0, y = 0.0, z = 50.0}
active_work = 1
tool = 1
work.1 = {x = 0.0, y = 0.0, z = 0.0}
g92 = {x = 0.0, y = 0.0, z = 0.0}
"""
X = "G21 G90 G54\nG92 X0\nG10 L20 P1 X5\nG0 X20\nM30\n"
Z = "G21 G90 G54\nG43 H1\nG10 L20 P1 Z0\nG0 Z20\nM30\n"
BOTH = "G21 G90 G54\nG43 H1\nG92 Z0\nG10 L20 P1 Z0\nG0 Z20\nM30\n"
ACTIVE = "G21 G90 G55\nG92 X0\nG10 L20 P1 X5\nG0 X20\nM30\n"


def machine(upper: dict[str, float], length: str = "length = 30.0", accepts: str = "") -> str:
    axes = "".join(
        f"[axes.{name}]\nmin = -500.0\nmax = {upper.get(name, 500.0)}\nmax_velocity = 100.0\nmax_acceleration = 500.0\n"
        for name in "xyz"
    )
    said = f'accepts = ["{accepts}"]\n' if accepts else ""
    return (
        f'schema = "gproof-machine/1"\nunits = "mm"\n{axes}[tools.1]\ndiameter = 4.0\n{length}\n'
        f'[controller]\ndialect = "eding"\n{said}'
    )


def check(folder: Path, job: str, text: str, *words: str) -> tuple[int, str]:
    (folder / "job.cnc").write_text(job)
    (folder / "mill.toml").write_text(text)
    (folder / "setup.toml").write_text(SETUP)
    done = in_this_process(["check", "job.cnc", "--machine", "mill.toml", "--setup", "setup.toml", *words], folder)
    return done.exit, done.out


@pytest.mark.parametrize(
    ("job", "axis", "shown", "counted"),
    [(X, "x", 25.0, 35.0), (Z, "z", 70.0, 100.0)],
    ids=["G92", "a tool length"],
)
def test_both_are_followed(job: str, axis: str, shown: float, counted: float, tmp_path: Path) -> None:
    low, high = sorted((shown, counted))
    assert check(tmp_path, job, machine({axis: high + 0.001}))[0] == 0
    assert check(tmp_path, job, machine({axis: (low + high) / 2}))[0] == 2
    assert check(tmp_path, job, machine({axis: low - 0.001}))[0] == 1
    for entry, place in (("l20-shown", shown), ("l20-machine", counted)):
        assert check(tmp_path, job, machine({axis: place + 0.001}, accepts=entry))[0] == 0
        assert check(tmp_path, job, machine({axis: place - 0.001}, accepts=entry))[0] == 1


@pytest.mark.parametrize(("upper", "code"), [(120.001, 0), (119.999, 2), (70.001, 2), (69.999, 1)])
def test_g92_and_a_length_together_are_all_followed(upper: float, code: int, tmp_path: Path) -> None:
    """Z is at 50, its tip at 20, so G92 Z0 makes 20; G10 L20 Z0 gives 50, 30, 20 or 0, and Z20 is 70 more."""
    assert check(tmp_path, BOTH, machine({"z": upper}))[0] == code


def test_a_system_that_is_not_used_changes_nothing(tmp_path: Path) -> None:
    setup = ACTIVE.replace("G55", "G54").replace("P1", "P2")
    assert check(tmp_path, setup, machine({"x": 30.001}))[0] == 0
    assert check(tmp_path, setup, machine({"x": 29.999}))[0] == 1


def test_without_either_there_is_nothing_to_read_two_ways(tmp_path: Path) -> None:
    job = "G21 G90 G54\nG10 L20 P1 X5\nG0 X20\nM30\n"
    code, out = check(tmp_path, job, machine({"x": 25.001}, accepts="l20-machine"))
    assert code == 0 and "G10 L20" not in out
    assert check(tmp_path, job, machine({"x": 24.999}))[0] == 1


def test_a_length_that_nobody_stated_leaves_the_place_open(tmp_path: Path) -> None:
    code, out = check(tmp_path, Z, machine({}, length=""))
    assert code == 2 and "G10 L20" in out and 'accepts = ["l20-shown"]' in out
    assert check(tmp_path, "G21 G90 G54\nG43 H1\nG10 L20 P1 X5\nG0 X20\nM30\n", machine({}, length=""))[0] == 0


@pytest.mark.parametrize("entries", ['["l20-shown", "l20-machine"]'])
def test_not_both_at_once(entries: str, tmp_path: Path) -> None:
    text = machine({}).replace('dialect = "eding"\n', f'dialect = "eding"\naccepts = {entries}\n')
    assert check(tmp_path, X, text)[0] == 3
