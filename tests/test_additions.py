"""A check, a report format and a board that stand outside register themselves, and no file of gproof is edited.

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
    ],
)
def test_contributing_lists_the_files_of_an_addition(title: str, toy: str, names: dict[str, str]) -> None:
    stated = constants(TOYS / f"{toy}.py")
    paths = listed(title)
    for written, name in names.items():
        paths = [path.replace(written, name) for path in paths]
    assert paths == list(stated["FILES"])
    there = [path for path in paths if "toy" not in Path(path).name]
    assert there == [stated["REGISTRY"]], "what is edited is the registry alone"
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
