"""A check, a report format, a board and a dialect from outside register themselves; no file of gproof is edited.

CONTRIBUTING.md says which files such an addition touches inside: the list is held against what the toys have.
"""

from __future__ import annotations

import ast
import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from support.command import Done
from support.goldens import ROOT

TOYS = Path(__file__).parent / "additions"
MACHINE = """schema = "gproof-machine/1"
units = "mm"
[axes.x]
min = 0
max = 100
steps_per_unit = 100
max_velocity = 50
max_acceleration = 500
[axes.y]
min = 0
max = 100
steps_per_unit = 100
max_velocity = 50
max_acceleration = 500
"""
JOB = "G21 G90 G94 G17 G40 G49 G54\nG0 X10 Y10\nG2 X20 I5 F600\nG0 X0 Y0\nM30\n"
AT_HAND = ("--machine", "machine.toml", "--setup", "zero")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "job.cnc").write_text(JOB, encoding="utf-8")
    (tmp_path / "machine.toml").write_text(MACHINE, encoding="utf-8")
    return tmp_path


def with_toy(name: str, folder: Path, *words: str) -> Done:
    """A command in a process of its own that has imported a toy first."""
    start = f"import sys; sys.path.insert(0, {str(TOYS)!r}); import {name}; from gproof.cli.main import main"
    done = subprocess.run(
        [sys.executable, "-c", f"{start}; sys.exit(main())", *words], cwd=folder, capture_output=True, text=True,
        check=False, stdin=subprocess.DEVNULL, env={"HOME": str(folder), "PATH": "/usr/bin:/bin"},
    )  # fmt: skip
    return Done(done.returncode, done.stdout, done.stderr)


def test_a_check(folder: Path) -> None:
    plain = with_toy("toy_check", folder, "check", "job.cnc", *AT_HAND, "--format", "json")
    assert "toy" in json.loads(plain.out)["not_judged"]
    done = with_toy("toy_check", folder, "check", "job.cnc", *AT_HAND, "--also", "toy", "--format", "json")
    report = json.loads(done.out)
    assert (done.exit, report["properties"]["toy"]["verdict"]) == (0, "SAFE"), done
    assert [(one["code"], one["line"]) for one in report["findings"]] == [("GP999", 3)]
    assert "toy" in with_toy("toy_check", folder, "check", "--help").out
    (folder / "shop.toml").write_text('schema = "gproof-policy/1"\nproperties = ["language", "toy"]\n')
    assert with_toy("toy_check", folder, "check", "job.cnc", *AT_HAND, "--policy", "shop.toml").exit == 0
    made = with_toy("toy_check", folder, "compile", "job.cnc", *AT_HAND, "--also", "toy", "-o", "job.gpx")
    assert made.exit == 0, made


def test_a_report_format(folder: Path) -> None:
    done = with_toy("toy_format", folder, "check", "job.cnc", *AT_HAND, "--format", "toy", "--report", "toy=report.txt")
    assert (done.exit, done.out) == (0, "job.cnc -> SAFE, 0\n"), done
    assert (folder / "report.txt").read_text() == done.out


def test_a_board(folder: Path) -> None:
    assert with_toy("toy_board", folder, "compile", "job.cnc", *AT_HAND, "-o", "job.gpx").exit == 0
    done = with_toy("toy_board", folder, "run", "job.gpx", "--board", "toy", *AT_HAND, "--record", "record.json")
    assert done.exit == 0, done
    assert json.loads((folder / "record.json").read_text())["board"]["name"] == "toy"
    # It is not the virtual one, so the package alone is not believed.
    assert with_toy("toy_board", folder, "run", "job.gpx", "--board", "toy").exit == 3


TOY_JOB = """# a square, and back
G21 G90
M3 S1000
G0 X10 Y10
G1 X20 F600
Y20
G91
X-10
G4 P0.5
M5
M30
"""


def test_a_dialect(folder: Path) -> None:
    """Ten codes that only the toy has: checked, compiled, verified and run, and printed as they are."""
    (folder / "job.toy").write_text(TOY_JOB, encoding="utf-8")
    done = with_toy("toy_dialect", folder, "check", "job.toy", *AT_HAND, "--format", "json")
    report = json.loads(done.out)
    assert (done.exit, report["verdict"], report["dialect"]["name"]) == (0, "SAFE", "toy"), done
    # 10 from the work zero, then 10 along X, 10 along Y and 10 back.
    box = {one["axis"]: (one["low"], one["high"]) for one in report["summary"]["box"]}
    assert box["x"] == (10.0, 20.0) and box["y"] == (10.0, 20.0), report["summary"]
    assert with_toy("toy_dialect", folder, "compile", "job.toy", *AT_HAND, "-o", "toy.gpx").exit == 0
    assert with_toy("toy_dialect", folder, "verify", "toy.gpx", *AT_HAND).exit == 0
    ran = with_toy("toy_dialect", folder, "run", "toy.gpx", "--board", "virtual", *AT_HAND, "--record", "toy.json")
    assert ran.exit == 0, ran
    record = json.loads((folder / "toy.json").read_text())
    assert (record["motors"], record["position"]) == (["X", "Y"], [1000, 2000])  # 100 steps a mm
    far = folder / "far.toy"
    far.write_text(TOY_JOB.replace("X20", "X200"), encoding="utf-8")
    done = with_toy("toy_dialect", folder, "check", "far.toy", *AT_HAND)
    assert done.exit == 1 and "far.toy:5:" in done.err + done.out, done
    bad = folder / "bad.toy"
    bad.write_text("G0 X1\nM77\n", encoding="utf-8")
    assert with_toy("toy_dialect", folder, "check", "bad.toy", *AT_HAND).exit == 1
    assert with_toy("toy_dialect", folder, "fmt", "--check", "job.toy").exit == 0


def listed(title: str) -> list[str]:
    """The files of a section of CONTRIBUTING.md: what begins the items of its list."""
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    section = re.search(rf"^## {title}\n(.*?)(?=^## |\Z)", text, re.M | re.S)
    assert section is not None, title
    return re.findall(r"^\d\. `([^`]+)`", section[1], re.M)


@pytest.mark.parametrize(
    ("title", "toy", "names"),
    [
        ("Add a check", "toy_check", {"<name>": "toy", "<room>": "lint"}),
        ("Add a report format", "toy_format", {"<name>": "toy"}),
        ("Add a board", "toy_board", {"<name>": "toy"}),
        ("Add a dialect", "toy_dialect", {"<name>": "toy"}),
    ],
)
def test_contributing_lists_the_files_of_an_addition(title: str, toy: str, names: dict[str, str]) -> None:
    stated = constants(TOYS / f"{toy}.py")
    paths = listed(title)
    for written, name in names.items():
        paths = [path.replace(written, name) for path in paths]
    assert paths == list(stated["FILES"])
    there = [path for path in paths if "toy" not in Path(path).name]
    registries = stated["REGISTRY"]
    assert there == ([registries] if isinstance(registries, str) else list(registries)), "registries alone are edited"
    assert all((ROOT / path).parent.is_dir() for path in paths)


def constants(path: Path) -> dict[str, Any]:
    """What a toy states of itself; it is not imported here, or it would be registered for all other tests."""
    body = ast.parse(path.read_text(encoding="utf-8")).body
    found = {}
    for node in body:
        if not (isinstance(node, ast.Assign) and isinstance(node.value, ast.Constant | ast.Tuple)):
            continue
        if isinstance(node.targets[0], ast.Name):
            found[node.targets[0].id] = ast.literal_eval(node.value)
    return found
