"""The bracket of the corpus with something wrong in its setup: what was moved is what is found."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from corpus.expectations import ROOT
from support.command import in_this_process

FOLDER = ROOT / "corpus" / "eding" / "clamped-bracket"
TABLE = '[[fixtures]]\nname = "table"\nbox = [[0, 0, -40], [120, 80, -16]]\n[[fixtures]]\nname = "stop"'
SPOILED = {
    # The contour at the left goes along X7 with a tool of 6 mm: 4 is free, 1 mm is left to X3, 0.5 mm is asked for.
    "clamp": ("setup.toml", "[3, 48, 12]", "[3.75, 48, 12]", "collisions", {"GP421"}, (52, 62, 72)),
    # The pocket is cut to 6 mm.
    "floor": ("setup.toml", "floor = -6", "floor = -5.75", "gouges", {"GP420"}, (28, 29, 30, 31, 32, 33)),
    # The hole goes down to -17; a table is below.
    "table": ("setup.toml", '[[fixtures]]\nname = "stop"', TABLE, "collisions", {"GP421"}, (87,)),
}  # fmt: skip


@pytest.mark.parametrize("what", SPOILED)
def test_what_is_wrong_is_found_where_it_is(tmp_path: Path, what: str) -> None:
    name, old, new, decides, expected, lines = SPOILED[what]
    for file in ("setup.toml", "machine.toml", "bracket.dxf", "job.cnc"):
        shutil.copy(FOLDER / file, tmp_path / file)
    text = (tmp_path / name).read_text()
    assert old in text
    (tmp_path / name).write_text(text.replace(old, new))
    words = ["check", str(tmp_path / "job.cnc"), "--machine", str(tmp_path / "machine.toml"), "--setup"]
    words += [str(tmp_path / "setup.toml"), "--also", decides, "--format", "json"]
    report = json.loads(in_this_process(words, ROOT).out)
    assert report["properties"][decides]["verdict"] == "UNSAFE"
    errors = [one for one in report["findings"] if one["severity"] == "error"]
    assert {one["code"] for one in errors} == expected
    assert {one["line"] for one in errors} <= set(lines)
    assert report["counts"]
