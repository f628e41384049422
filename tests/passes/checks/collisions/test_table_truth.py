"""Verdicts of ``gouges`` and ``collisions`` of random jobs; what is true of them is found without the checks."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from passes.checks.collisions.framed_jobs import Framed
from passes.checks.collisions.table_jobs import Scene
from support.campaigns import seeds

from gproof.cli.main import main
from gproof.ir.machine import Tool
from gproof.ir.workpiece import Box, Placed
from gproof.passes.checks.collisions.facets import Surface
from gproof.passes.checks.collisions.scene import Scene as Table
from gproof.passes.checks.tooling.tool_shape import HOLDER, SHANK, UNSTATED, shape_of


@pytest.mark.parametrize("kind", [Scene, Framed])
@pytest.mark.parametrize("seed", seeds(2, 300))
def test_verdicts_are_what_the_shapes_say(
    seed: int, kind: type[Scene], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scene = kind(seed, tmp_path)
    assert main(scene.write()) in (0, 1, 2)
    properties = json.loads(capsys.readouterr().out)["properties"]
    for name, room in scene.truth().items():
        verdict = properties[name]["verdict"]
        if verdict == "SAFE":
            assert room - scene.slack >= -1e-4, name
        elif verdict == "UNSAFE":
            assert room <= 1e-3 or (name == "collisions" and scene.across() <= 1e-3), name


@pytest.mark.parametrize("tolerance", [0.0, 0.001, 0.1, 2.0])
@pytest.mark.parametrize("stickout", [5.0, 25.0])
def test_what_the_cutter_alone_goes_into_is_not_in_its_shank(tolerance: float, stickout: float) -> None:
    """The piece across the joint of cutter and shank reaches below it no further than the tolerance."""
    tool = Tool(
        number=1, shape="flat", diameter=6.0, flute_length=5.0, shank_diameter=6.0, stickout=stickout,
        holder=((20.0, 30.0, 10.0),),
    )  # fmt: skip
    table = Table(
        1,
        (SHANK, HOLDER, UNSTATED),
        -tolerance,
        Surface([Placed(name="part", body=Box(low=(0.0, 0.0, 0.0), high=(1.0, 1.0, 1.0)))]),
    )
    pieces = [piece for piece in table.ladder(1, shape_of(tool)).pieces if piece.part != UNSTATED]
    assert min(piece.tip for piece in pieces) >= 5.0 - tolerance
