"""Short programs with the place where each ends, worked out from a manual by hand, and how they are compared.

An answer is a verdict and the place of each axis in machine coordinates: `.` where it started, `?` not compared. `!`
is any verdict but SAFE; a verdict alone says nothing of places.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from support.command import in_this_process


def agree(folder: Path, job: str, files: dict[str, str], answer: str, start: dict[str, float]) -> None:
    """Judge the file `job` of `files`, on machine.toml and with setup.toml, and compare it with what was worked out."""
    for name, text in files.items():
        (folder / name).write_text(text, "utf-8")
    words = ["check", job, "--machine", "machine.toml", "--setup", "setup.toml", "--format", "json"]
    done = in_this_process(words, folder)
    assert done.exit in (0, 1, 2), done.err
    report = json.loads(done.out)
    told = "; ".join(f"{f['line']}: {f['code']} {f['message']}" for f in report["findings"])
    verdict, *places = answer.split()
    assert report["verdict"] != "SAFE" if verdict == "!" else report["verdict"] == verdict, told
    end = report["summary"]["end"]
    for axis, place in zip(start, places, strict=bool(places)):
        if place != "?":
            assert end.get(axis) == pytest.approx(start[axis] if place == "." else float(place), abs=1e-9), (axis, told)
