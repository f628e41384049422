"""Damaged drawings, meshes and tables end in findings, never in a traceback; what is read is whole."""

from __future__ import annotations

import math
import random
from pathlib import Path

import pytest
from support.campaigns import seeds

from gproof.driver.dialects import load_setup
from gproof.ir.finding import Findings, Severity
from gproof.ir.workpiece import Mesh, Prism

FOLDER = Path(__file__).resolve().parents[3] / "corpus" / "eding" / "clamped-bracket"
FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]
CORNERS = [(0, 0, 0), (10, 0, 0), (0, 10, 0), (0, 0, 10)]
STL = "solid a\n" + "".join(
    "facet normal 0 0 0\nouter loop\n" + "".join("vertex {} {} {}\n".format(*CORNERS[k]) for k in face)
    + "endloop\nendfacet\n" for face in FACES
) + "endsolid a\n"  # fmt: skip
PIECES = [
    b"0",
    b"-1",
    b"nan",
    b"inf",
    b"1e999",
    b"LINE",
    b"ARC",
    b"SPLINE",
    b"INSERT",
    b"",
    b"\xff",
    b"POLYLINE",
    b"  0",
]


def damaged(rng: random.Random, raw: bytes) -> bytes:
    """Some lines or bytes changed, left out, doubled or swapped."""
    for _ in range(rng.randint(1, 4)):
        lines = raw.split(b"\n")
        at = rng.randrange(len(lines))
        what = rng.randrange(6)
        if what == 0:
            lines[at] = rng.choice(PIECES)
        elif what == 1:
            del lines[at]
        elif what == 2:
            lines.insert(at, lines[rng.randrange(len(lines))])
        elif what == 3:
            other = rng.randrange(len(lines))
            lines[at], lines[other] = lines[other], lines[at]
        raw = b"\n".join(lines)
        if what == 4 and raw:
            at = rng.randrange(len(raw))
            raw = raw[:at] + bytes([rng.randrange(256)]) + raw[at + 1 :]
        elif what == 5:
            raw = raw[: rng.randrange(len(raw) + 1)]
    return raw


@pytest.mark.parametrize("seed", seeds(40, 3000))
def test_damaged_files_are_findings(tmp_path: Path, seed: int) -> None:
    rng = random.Random(seed)
    drawing, mesh = (FOLDER / "bracket.dxf").read_bytes(), STL.encode()
    setup = (FOLDER / "setup.toml").read_bytes() + b'[[fixtures]]\nstl = "body.stl"\nrotate = 30\nshift = [1, 2, 3]\n'
    which = rng.randrange(3)
    (tmp_path / "bracket.dxf").write_bytes(damaged(rng, drawing) if which == 0 else drawing)
    (tmp_path / "body.stl").write_bytes(damaged(rng, mesh) if which == 1 else mesh)
    (tmp_path / "setup.toml").write_bytes(damaged(rng, setup) if which == 2 else setup)
    findings = Findings()
    found, files = load_setup(tmp_path / "setup.toml", findings)
    labels = {finding.code.label for finding in findings.kept}
    assert labels <= {"GP601", "GP611", "GP603", "GP604", "GP432"}
    # A key that there is not may be a mistyped one: such a setup is no setup either.
    assert (found is None) == any(finding.severity is Severity.ERROR for finding in findings.kept)
    assert all(len(digest) == 64 for _, digest in files)
    if found is None or found.workpiece is None:
        return
    for placed in (*found.workpiece.stock, *found.workpiece.part, *found.workpiece.fixtures):
        body = placed.body
        if isinstance(body, Prism):
            assert len(body.outline) >= 3 and body.low < body.high
            assert all(math.isfinite(value) for point in body.outline for value in point)
        elif isinstance(body, Mesh):
            assert body.closed == ("GP432" not in labels)
