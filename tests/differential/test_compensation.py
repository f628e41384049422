"""Random compensated contours: gproof and LinuxCNC agree on every row.

LinuxCNC lets the first move end square to its direction, the manual (5.4) at the right angle of a triangle. The two
ends are r²/d apart, where d is the length of the move: a contour that begins far away enough (50 m for a radius of
1 mm) hides that within the bound of the comparison, and nothing else of it has to be left out.
"""

from __future__ import annotations

import math
import random
from pathlib import Path

import pytest
from differential import rs274_peer
from differential.test_random import BATCH, judge
from passes.interpret.eding.compensated_jobs import Stretch, contour
from support.campaigns import seeds

HEAD = "G21 G17 G40 G49 G54 G80 G90 G94 G98\n"
FAR = 50_000.0


def turns(rng: random.Random, side: int) -> list[Stretch]:
    """Lines and arcs of any sweep, each going straight on from the one before or turning away from the tool."""
    at, heading = (0.0, 0.0), rng.uniform(0, 360)
    out: list[Stretch] = []
    for k in range(rng.randint(3, 9)):
        if k and rng.random() < 0.7:
            heading -= side * rng.uniform(4, 170)
        u, v = math.cos(math.radians(heading)), math.sin(math.radians(heading))
        sense = rng.choice((0, 1, -1)) if k else 0
        if not sense:
            length = rng.uniform(3, 60)
            out.append(Stretch(at, (at[0] + length * u, at[1] + length * v)))
        else:
            radius, swept = rng.uniform(1.5, 40), sense * rng.uniform(8, 345)
            center = (at[0] - sense * v * radius, at[1] + sense * u * radius)
            heading += swept
            w, z = math.cos(math.radians(heading)), math.sin(math.radians(heading))
            out.append(Stretch(at, (center[0] + sense * z * radius, center[1] - sense * w * radius), center, sense))
        at = out[-1].end
    return out


def job(seed: int) -> str:
    """A contour of lines and arcs, its corners rounded or sharp, in G90 or in G91, with some words left out."""
    rng = random.Random(seed)
    side = rng.choice((1, -1))
    stretches = turns(rng, side) if seed % 2 else contour(rng, side, 1.0, sharp=rng.random() < 0.5)
    first = stretches[0]
    length = math.dist(first.begin, first.end)
    u, v = ((b - a) / length for a, b in zip(first.begin, first.end, strict=True))
    text = f"{HEAD}F{rng.randint(100, 2000)}\nG0 X{-FAR * u:.6f} Y{-FAR * v:.6f} Z5\nG4{1 if side > 0 else 2} D4\n"
    text += "G1 X0 Y0\n"
    incremental = rng.random() < 0.4
    text += "G91\n" if incremental else ""
    for stretch in stretches:
        text += stretch.text(stretch.begin if incremental else None)
        if rng.random() < 0.2:
            text += f"G{rng.choice((0, 1))} Z{rng.randint(-5, 5)}\n"
    return text + "G90 G40\nG0 X0 Y0 Z50\nM2\n"


@pytest.mark.usefixtures("peer", "gproof")
@pytest.mark.parametrize("batch", seeds(2, 20))
def test_random_contours(batch: int, tmp_path: Path) -> None:
    first = batch * BATCH
    paths = []
    for seed in range(first, first + BATCH):
        paths.append(tmp_path / f"{seed}.ngc")
        paths[-1].write_text(job(seed))
    runs = rs274_peer.run_peers([(path, rs274_peer.situation_of(None)) for path in paths])
    for path, run in zip(paths, runs, strict=True):
        assert run.accepted, f"seed {path.stem}: {run.error}\n{path.read_text()}"
        found = judge(path, run)
        assert found is None, f"seed {path.stem}: {found}\n{path.read_text()}"
