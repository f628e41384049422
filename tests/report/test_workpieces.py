"""Stock, part and fixtures in the summary, the JSON report and the picture of a job."""

from __future__ import annotations

import json
import re
from pathlib import Path

from support.command import in_this_process

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "corpus" / "eding" / "clamped-bracket"
WORDS = ["check", str(FOLDER / "job.cnc"), "--machine", str(FOLDER / "machine.toml")]
OWN = [*WORDS, "--setup", str(FOLDER / "setup.toml")]


def test_the_summary_names_them() -> None:
    done = in_this_process(OWN, ROOT)
    said = "  workpiece   stock 120 x 80 x 15 mm; part bracket.dxf; fixtures left clamp, right clamp, stop"
    assert said in done.out.splitlines()
    inches = in_this_process([*OWN, "--units", "inch"], ROOT)
    assert "stock 4.7244 x 3.1496 x 0.5906 inch" in inches.out


def test_things_without_names_are_counted(tmp_path: Path) -> None:
    setup = tmp_path / "setup.toml"
    box = "box = [[0, 0, 0], [1, 1, 1]]\n"
    setup.write_text(f'schema = "gproof-setup/1"\n[[part]]\n{box}[[fixtures]]\n{box}[[fixtures]]\n{box}')
    done = in_this_process([*WORDS, "--setup", str(setup)], ROOT)
    assert "  workpiece   part; 2 fixtures" in done.out.splitlines()


def test_the_report_has_them() -> None:
    found = json.loads(in_this_process([*OWN, "--format", "json"], ROOT).out)
    workpiece = found["summary"]["workpiece"]
    assert workpiece["stock"] == [
        {"name": "stock", "bodies": 1, "counts_from": "1", "low": [0, 0, -15], "high": [120, 80, 0], "closed": True}
    ]
    (part,) = workpiece["part"]
    assert (part["name"], part["bodies"], part["low"], part["high"]) == ("bracket.dxf", 2, [10, 10, -15], [110, 70, 0])
    assert [one["name"] for one in workpiece["fixtures"]] == ["left clamp", "right clamp", "stop"]
    assert (workpiece["tolerance"], workpiece["clearance"], workpiece["cell"]) == (0.01, 0.5, 0.5)
    assert {Path(one["file"]).name for one in found["inputs"] if one["role"] == "setup"} == {
        "setup.toml",
        "bracket.dxf",
    }


def test_a_job_without_them_says_nothing() -> None:
    done = in_this_process([*WORDS, "--setup", "zero"], ROOT)
    assert "workpiece" not in done.out
    assert "workpiece" not in json.loads(in_this_process([*WORDS, "--format", "json"], ROOT).out)["summary"]


def test_they_are_in_the_picture(tmp_path: Path) -> None:
    picture = tmp_path / "job.svg"
    in_this_process([*OWN, "--picture", str(picture)], ROOT)
    text = picture.read_text()
    assert all(f">{name}<" in text for name in ("stock", "part", "fixture"))
    # From above and from the front, of the cut and of the machine.
    assert len(re.findall('fill="#fff8e1"', text)) == 4
    # Without stated offsets they stand beside the same unknown zero as the cut.
    bare = tmp_path / "setup.toml"
    stated = (FOLDER / "setup.toml").read_text().partition("[workpiece]")[2]
    bare.write_text(
        'schema = "gproof-setup/1"\n[workpiece]' + stated.replace("bracket.dxf", str(FOLDER / "bracket.dxf"))
    )
    in_this_process([*WORDS, "--setup", str(bare), "--picture", str(picture)], ROOT)
    assert ">part<" in picture.read_text()
