"""Everything that the public peer ``gcode-collision-check`` finds is found: in scenes that both understand.

collision_peer.py says what the peer does and how its answers are kept.
"""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from differential.collision_peer import EXPECTED, Scene, scene_of
from support.campaigns import seeds

from gproof.cli.main import main

PEER_NAMES = {"cutter": "flute", "shank": "shank", "holder": "holder"}
SAID = re.compile(r'tool 1 \((\w+)\) (?:hits|is already inside) "(\w+)')
KNOWN = json.loads(EXPECTED.read_text(encoding="utf-8"))
AXIS = 'kind = "linear"\nmin = -500.0\nmax = 500.0\n'


def write_files(scene: Scene, folder: Path) -> list[str]:
    """The command's words for a scene: the same program, the same tool and STL files."""
    job = scene.write(folder)
    tool = scene.tool
    machine = [
        'schema = "gproof-machine/1"',
        'name = "as the peer has it"',
        'units = "mm"',
        "[controller]",
        "straight_traverse = true",
    ]
    machine += [f"[axes.{axis}]\n{AXIS}" for axis in "xyz"]
    machine += [
        "[tools.1]", f'shape = "{tool.kind}"', f"diameter = {tool.diameter}", f"flute_length = {tool.flute_length}",
        f"shank_diameter = {tool.shank_diameter}", f"stickout = {tool.flute_length + tool.shank_length}",
        f"holder = [[{tool.holder_diameter}, {tool.holder_diameter}, {tool.holder_length}]]",
    ]  # fmt: skip
    setup = ['schema = "gproof-setup/1"', "tool = 1", "active_work = 1", "start = {x = 0.0, y = 0.0, z = 0.0}"]
    setup += ["[work.1]", "x = 0.0", "y = 0.0", "z = 0.0", "[g92]", "x = 0.0", "y = 0.0", "z = 0.0"]
    for name, path in scene.files.items():
        setup += ["[[fixtures]]", f'name = "{name}"', f'stl = "{path.name}"']
    for name, lines in (("machine.toml", machine), ("setup.toml", setup)):
        (folder / name).write_text("\n".join(lines) + "\n", encoding="utf-8")
    words = [str(job), "--machine", str(folder / "machine.toml"), "--setup", str(folder / "setup.toml")]
    return ["check", *words, "--dialect", "eding", "--also", "collisions", "--format", "json"]


def found(report: dict[str, object]) -> dict[tuple[str, str], int]:
    """By part of the tool, in the peer's words, and box: the first line on which one is found in the other."""
    hits: dict[tuple[str, str], int] = {}
    for finding in report["findings"]:  # type: ignore[attr-defined]
        said = SAID.search(finding["message"])
        if said is not None and finding["severity"] == "error":
            key = PEER_NAMES[said[1]], said[2]
            hits[key] = min(hits.get(key, finding["line"]), finding["line"])
    return hits


@pytest.mark.parametrize("number", seeds(30, len(KNOWN)))
def test_what_the_peer_finds_is_found(number: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = scene_of(number)
    code = main(write_files(scene, tmp_path))
    printed = capsys.readouterr()
    assert code in (0, 1), printed
    report = json.loads(printed.out)
    hits = found(report)
    for line, part, box, depth in KNOWN[number]:
        first = hits.get((part, box))
        assert first is not None and first <= line, (line, part, box, depth, hits)
    if KNOWN[number]:
        assert report["properties"]["collisions"]["verdict"] == "UNSAFE"
