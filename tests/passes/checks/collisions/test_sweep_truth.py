"""Gouges and collisions in meshes with slopes and curved surfaces, against sweeps that manifold3d cuts.

A depth that is told is met by a tool that is smaller by nearly as much, and by none that is smaller by more; what
nobody tells of is not there. ``swept_tools`` says why neither answer rests on how finely a circle is cut.
"""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from passes.checks.collisions.relief_jobs import Body, Relief
from passes.checks.collisions.table_jobs import Piece
from support.campaigns import seeds

from gproof.cli.main import main

SHOWN = 6e-4
"""mm that a printed number may be rounded by."""
WITHIN = 3e-6
"""mm between "nearer than allowed, proved" and "not, proved", and what float64 loses on the way."""


def told_of(found: list[dict[str, object]], body: Body, part: str = "") -> list[tuple[str, float]]:
    """(code, mm: how deep, less than 0 how near) of what is told of a body and a part of the tool."""
    out = []
    for finding in found:
        message = str(finding["message"])
        if f"{body.name}.stl" not in message and f'"{body.name}"' not in message:
            continue
        if part and f"({part})" not in message:
            continue
        number = re.search(r"(hits .* by|comes within) (\d+\.\d+) mm", message)
        assert number is not None, message
        out.append((str(finding["code"]), float(number[2]) if number[1][0] == "h" else -float(number[2])))
    return out


@pytest.mark.parametrize("seed", seeds(5, 400))
def test_depths_are_those_of_swept_tools(seed: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    job = Relief(seed, tmp_path)
    assert main(job.write()) in (0, 1, 2)
    report = json.loads(capsys.readouterr().out)
    verdicts = {name: value["verdict"] for name, value in report["properties"].items()}
    found = report["findings"]
    assert not [f for f in found if f["code"] in ("GP432", "GP423", "GP424")], found
    cutter = job.tool.cutter
    told = {f["code"] for f in found}
    assert verdicts["gouges"] == ("UNSAFE" if "GP420" in told else "UNKNOWN" if "GP425" in told else "SAFE")
    for body in job.part:
        depths = [depth for code, depth in told_of(found, body) if code == "GP420"]
        _gouge(job, cutter, body, max(depths, default=None))
        for piece in job.tool.others:
            if not told_of(found, body, piece.name):
                assert not job.meets(piece, body, -job.tolerance - WITHIN, outside=False), piece
    for body in job.fixtures:
        for name in ("cutter", "shank", "holder"):
            pieces = [piece for piece in (cutter, *job.tool.others) if piece.name == name]
            _clearance(job, pieces, body, [depth for _, depth in told_of(found, body, name)])


def _gouge(job: Relief, cutter: Piece, body: Body, depth: float | None) -> None:
    """What is told of the cutter and a body of the part."""
    if depth is None:
        assert not job.meets(cutter, body, -job.tolerance - WITHIN, outside=False)
        return
    assert depth > job.tolerance - SHOWN
    assert job.meets(cutter, body, SHOWN - depth, outside=True), depth
    worst = depth + 0.031 * max(depth - job.tolerance, 0.0) + SHOWN + 2e-5
    assert not job.crosses(cutter, body, -worst), depth


def _clearance(job: Relief, pieces: list[Piece], body: Body, told: list[float]) -> None:
    """What is told of one kind of piece and a fixture."""
    near = [-depth for depth in told]
    if not pieces:
        assert not told
        return
    limit = job.clearance
    if not near:
        assert not any(job.meets(piece, body, limit - WITHIN, outside=False) for piece in pieces)
        return
    least = min(near)
    assert any(job.meets(piece, body, max(least, 0.0) + SHOWN, outside=True) for piece in pieces), least
    if least > 0.0:
        nearer = least - 0.031 * (limit - least) - SHOWN - 2e-5
        assert not any(job.meets(piece, body, nearer, outside=False) for piece in pieces), least
