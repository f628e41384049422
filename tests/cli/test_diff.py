"""``gproof diff``: the same, another move, what is unknown, and wrong arguments."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from support.command import in_this_process
from support.goldens import ROOT
from support.json_schema import violations

SCHEMA_JSON = json.loads((ROOT / "docs" / "translation.schema.json").read_text(encoding="utf-8"))
JOB = "G21 G90 G54\nG0 X0 Y0 Z5\nG1 Z-1 F100\nG1 X10 F300\nG4 P0.5\nG0 Z5\nM30\n"


@pytest.fixture
def shop(tmp_path: Path) -> Path:
    (tmp_path / "a.cnc").write_text(JOB)
    (tmp_path / "same.cnc").write_text("G21\n" + JOB.replace("X10 F300", "X5 F300\nX10"))
    (tmp_path / "other.cnc").write_text(JOB.replace("X10", "X10.5"))
    (tmp_path / "dwell.cnc").write_text(JOB.replace("P0.5", "P5"))
    (tmp_path / "open.cnc").write_text(JOB.replace("X10", "X[#4001]"))
    return tmp_path


@pytest.mark.parametrize(
    ("second", "exit_code", "said"),
    [
        ("a.cnc", 0, "do the same"), ("same.cnc", 0, "do the same"), ("other.cnc", 1, "X10.0000 and X10.5000"),
        ("dwell.cnc", 1, "dwell"), ("open.cnc", 2, "unknown"),
    ],
)  # fmt: skip
def test_two_programs(shop: Path, second: str, exit_code: int, said: str) -> None:
    done = in_this_process(["diff", "a.cnc", second], shop)
    assert (done.exit, done.err) == (exit_code, "")
    assert said in done.out


def test_the_zero_of_a_controller_without_a_table_is_the_first_work_offset(shop: Path) -> None:
    """What the operator has set by G92 on WinCNC, and by G54 on Eding CNC, is the zero of the material."""
    cut, park = "G0 X1 Y2 Z5\nG1 Z-1 F100\nG1 X10 F300\n", "G0 X1 Y2 Z5\nG53 G0 Z0\n"
    for name, text in (("a", cut), ("b", park)):
        (shop / f"{name}.tap").write_text("G22\nG90\nG49\n" + text.replace("G53 G0", "G53"))
        (shop / f"{name}2.cnc").write_text("G21 G90 G54 G49\n" + text)
    axes = "".join(f"[axes.{axis}]\nmin = -500\nmax = 500\n" for axis in "xyz")
    for name in ("wincnc", "eding"):
        text = f'schema = "gproof-machine/1"\nunits = "mm"\n{axes}[controller]\ndialect = "{name}"\n'
        (shop / f"{name}.toml").write_text(text)
    (shop / "CNC.MAC").write_text("")
    machines = ["--machine", "wincnc.toml", "--machine-to", "eding.toml"]
    done = in_this_process(["diff", "a.tap", "a2.cnc", *machines], shop)
    assert done.exit == 0 and "(G92) of the source program is work offset 1 (G54)" in done.out, done.out
    done = in_this_process(["diff", "b.tap", "b2.cnc", *machines], shop)
    assert done.exit == 0 and "machine coordinates count from the same place" in done.out, done.out


def test_machine_places_of_machines_of_other_travel_are_open(shop: Path) -> None:
    for name, top in (("one.toml", 0), ("two.toml", 10)):
        axes = "".join(f"[axes.{axis}]\nmin = -500\nmax = {top}\n" for axis in "xyz")
        (shop / name).write_text(f'schema = "gproof-machine/1"\nunits = "mm"\n{axes}')
    (shop / "park.cnc").write_text(JOB.replace("M30", "G53 G0 Z-1\nM30"))
    for second, exit_code in (("one.toml", 0), ("two.toml", 2)):
        done = in_this_process(["diff", "park.cnc", "park.cnc", "--machine", "one.toml", "--machine-to", second], shop)
        assert done.exit == exit_code, done.out


def test_block_delete_is_compared_in_both_positions(shop: Path) -> None:
    (shop / "slash.cnc").write_text(JOB.replace("G4 P0.5", "G4 P0.5\n/G0 X99"))
    (shop / "on.toml").write_text('schema = "gproof-setup/1"\nblock_delete = true\n')
    done = in_this_process(["diff", "slash.cnc", "a.cnc"], shop)
    assert done.exit == 1
    both = JOB.replace("G4 P0.5", "/G4 P0.5")
    (shop / "left.cnc").write_text(both)
    (shop / "right.cnc").write_text(JOB)
    assert in_this_process(["diff", "left.cnc", "right.cnc"], shop).exit == 1
    stated = ["--setup", "on.toml", "--setup-to", "on.toml"]
    assert in_this_process(["diff", "slash.cnc", "a.cnc", *stated], shop).exit == 0


def test_both_lines_are_below_one_another(shop: Path) -> None:
    out = in_this_process(["diff", "a.cnc", "other.cnc"], shop).out
    assert "    a.cnc:4: G1 X10 F300\n    other.cnc:4: G1 X10.5 F300\n" in out


def test_json_and_a_picture(shop: Path) -> None:
    done = in_this_process(["diff", "a.cnc", "other.cnc", "--format", "json", "--picture", "where.svg"], shop)
    report = json.loads(done.out)
    assert list(violations(report, SCHEMA_JSON)) == []
    (found,) = report["differences"]
    assert (found["first"]["line"], found["second"]["line"]) == (4, 4)
    assert "<circle" in (shop / "where.svg").read_text()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["diff", "a.cnc", "nope.cnc"], "no such file"), (["diff", "a.cnc"], "SECOND"),
        (["diff", "a.cnc", "a.cnc", "--picture", "a.cnc"], "would overwrite an input"),
        (["diff", "a.cnc", "a.cnc", "--tolerance", "-1"], "--tolerance"),
    ],
)  # fmt: skip
def test_wrong_arguments(shop: Path, words: list[str], said: str) -> None:
    done = in_this_process(words, shop)
    assert (done.exit, done.out) == (3, "")
    assert said in done.err
