"""Text reports in the unit of the shop; JSON in millimetres whatever the shop counts in."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from support.command import in_this_process

from gproof.cli.main import main

INI = """timertype=7200
axischar=XYA
axisspec=p0 s0 d0 r1000 a400 t1
axisvel=r600 f150
axisspec=p0 s1 d1 r1000 a400 t2
axisvel=r600 f150
axisspec=p0 s2 d2 r100 a400 t4
axisvel=r600 f150
softlim=T1
lolim=X-.4 Y-.4
hilim=X50.4 Y100.4
nmode=90
"""
SETUP = """schema = "gproof-setup/1"
units = "inch"
homed = ["x", "y", "a"]
active_work = 1
start = {x = 1.0, y = 2.0, a = 0.0}
"""


@pytest.fixture
def shop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "WINCNC.INI").write_text(f"unit=IN\n{INI}", encoding="ascii")
    (tmp_path / "CNC.MAC").write_text("", encoding="ascii")
    (tmp_path / "setup.toml").write_text(f"{SETUP}g92 = {{x = 0.0, y = 0.0, a = 0.0}}\n", encoding="ascii")
    (tmp_path / "open.toml").write_text(SETUP, encoding="ascii")
    (tmp_path / "job.tap").write_text("G1 X60 F50\nG1 Y12 A90\n", encoding="ascii")
    (tmp_path / "fits.tap").write_text("G1 X10 F50\nX1.5\n", encoding="ascii")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def report(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    main(["check", *words])
    return capsys.readouterr().out


def test_an_inch_shop_reads_inches(shop: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """60 inches are 9.6 past 50.4; the way is 59 at X, then 10 at Y; angles are degrees."""
    shown = report(capsys, "job.tap", "--machine", "WINCNC.INI", "--setup", "setup.toml")
    assert "X would reach 60.0000 inch, 9.6000 inch past its upper travel limit of 50.4000 inch" in shown
    lines = [line.split() for line in shown.splitlines()]
    assert ["reaches", "X", "60.0000", "...", "60.0000", "inch", "(limits", "-0.4", "...", "50.4)"] in lines
    assert ["Y", "2.0000", "...", "12.0000", "inch", "(limits", "-0.4", "...", "100.4)"] in lines
    assert ["A", "0.000", "...", "90.000", "deg", "(limits", "not", "given", "...", "not", "given)"] in lines
    assert ["starts", "at", "X", "1.0000,", "Y", "2.0000,", "A", "0.000"] in lines
    assert ["ends", "at", "X", "60.0000,", "Y", "12.0000,", "A", "90.000"] in lines
    assert ["path", "69.00", "inch,", "of", "which", "69.00", "inch", "at", "feed"] in lines
    assert " mm" not in shown


def test_an_option_says_otherwise(shop: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = "job.tap", "--machine", "WINCNC.INI", "--setup", "setup.toml", "--units"
    shown = report(capsys, *words, "mm")
    assert "X would reach 1524.000 mm, 243.840 mm past its upper travel limit of 1280.160 mm" in shown
    assert "(limits -10.16 ... 1280.16)" in shown
    assert "path        1752.6 mm" in shown
    (shop / "WINCNC.INI").write_text(f"unit=MM\n{INI}", encoding="ascii")
    assert "X would reach 60.000 mm, 9.600 mm past" in report(capsys, *words[:-1])
    assert "X would reach 2.3622 inch, 0.3780 inch past" in report(capsys, *words, "inch")


def test_conditions_are_rounded_to_the_side_that_holds(shop: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Words from 1.5 to 10 between -0.4 and 50.4: the local zero lies between -1.9 and 40.4."""
    shown = report(capsys, "fits.tap", "--machine", "WINCNC.INI", "--setup", "open.toml")
    assert "G92 X offset is   -1.9000 ...   40.4000 inch" in shown


def test_assumptions_count_like_the_rest(shop: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Without a setup, where the job starts is a condition: inside the limits, in the report's unit."""
    words = "fits.tap", "--machine", "WINCNC.INI"
    assert re.search(r"if the start position of X is +-0.4000 \.\.\. +50.4000 inch", report(capsys, *words))
    between = r"if the start position of X is +-10.1600 \.\.\. +1280.1600 mm"
    assert re.search(between, report(capsys, *words, "--units", "mm"))
    said = "the start position of X is between -10.160 and 1280.160 mm (machine"
    assert said in report(capsys, *words, "--format", "json")


def test_compiling_counts_as_checking_does(shop: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["compile", "job.tap", "--machine", "WINCNC.INI", "--setup", "setup.toml", "-o", "job.gpx"]) == 1
    shown = capsys.readouterr().out
    assert "X would reach 60.0000 inch, 9.6000 inch past its upper travel limit of 50.4000 inch" in shown
    assert " mm" not in shown


def test_without_a_machine_file_none_is_quoted(shop: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Nothing is said of what the machine file names when there is none."""
    assert "the machine file gives" in report(capsys, "job.tap", "--machine", "WINCNC.INI")
    shown = report(capsys, "job.tap")
    assert "without a machine file no tool change area is known" in shown
    assert "the machine file gives" not in shown


def test_json_stays_in_millimetres(shop: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = "job.tap", "--machine", "WINCNC.INI", "--setup", "setup.toml", "--format", "json"
    made = json.loads(report(capsys, *words))
    assert made == json.loads(report(capsys, *words, "--units", "inch"))
    assert "X would reach 1524.000 mm, 243.840 mm past" in made["findings"][0]["message"]
    assert made["summary"]["path_length_mm"] == pytest.approx(1752.6)


@pytest.mark.parametrize("form", ["markdown", "github", "junit"])
def test_documents_that_people_read_count_as_the_text_does(
    form: str, shop: Path, capsys: pytest.CaptureFixture[str]
) -> None:  # fmt: skip
    """Ten lines at X60 and one at X70 of 50.4: one finding, the worst 19.6 past; JSON stays in mm."""
    (shop / "job.tap").write_text("G1 X60 F50\n" + "Y1\nY2\n" * 5 + "X70\n", encoding="ascii")
    words = "job.tap", "--machine", "WINCNC.INI", "--setup", "setup.toml"
    shown = report(capsys, *words, "--format", form, "--report", "json=told.json")
    assert "X would reach 60.0000 inch, 9.6000 inch past its upper travel limit of 50.4000 inch" in shown
    assert form == "junit" or "the worst in line 12: X would reach 70.0000 inch, 19.6000 inch past" in shown
    assert form == "junit" or shown.count("60.0000 inch, 9.6000 inch past") == 1
    assert " mm" not in shown
    told = json.loads((shop / "told.json").read_text(encoding="utf-8"))
    assert "X would reach 1524.000 mm, 243.840 mm past" in json.dumps(told)
    assert " inch" not in json.dumps(told)
    assert "1524.000 mm, 243.840 mm past" in report(capsys, *words, "--format", form, "--units", "mm")


def test_without_a_machine_file_the_job_says_it(shop: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """G20 and G22 of the job; WinCNC counts inches before."""
    for first, unit in (("G20\n", "inch"), ("G22\n", "mm"), ("", "inch")):
        (shop / "job.tap").write_text(f"{first}G90\nG0 X1 Y2\nX3\n", encoding="ascii")
        assert f"path        2.{'00 inch' if unit == 'inch' else '0 mm'}" in report(capsys, "job.tap")


def test_a_second_heads_length_is_a_length(tmp_path: Path) -> None:
    """W of a WinCNC machine has the column of a rotary axis and is none: its tool measure is in mm, or in inches."""
    axes = "".join(f"axisspec=p0 s{n} d{n} r100 a100 t{t}\naxisvel=r3000 f1000\n" for n, t in enumerate((1, 2, 3, 3)))
    ini = f"unit=mm\naxischar=XYZW\n{axes}lolim=x0 y0 z-100 w-100\nhilim=x500 y500 z0 w0\nsoftlim=T1\n"
    files = {"WINCNC.INI": ini, "CNC.MAC": "", "job.tap": "G22\nG90\nG92\nG0 X1 Y1 W-25.4\n"}
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    for units, said in (("mm", "-74.6000 ... 25.4000 mm"), ("inch", "-2.9370 ... 1.0000 in")):
        done = in_this_process(["check", "job.tap", "--machine", "WINCNC.INI", "--units", units], tmp_path)
        assert f"active tool length of W is {said}" in " ".join(done.out.split()), done.out
