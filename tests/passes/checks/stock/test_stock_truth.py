"""Random jobs with stock of every form: what the tools meet is told, and what is told for certain is so."""

from __future__ import annotations

from pathlib import Path

import pytest
from passes.checks.stock.stock_oracle import judge, report, wrong
from passes.checks.stock.stock_scenes import Scene
from support.campaigns import seeds


@pytest.mark.parametrize("seed", seeds(5, 300))
def test_what_is_told_is_what_happens(seed: int, tmp_path: Path) -> None:
    scene = Scene(seed)
    judged = judge(scene, tmp_path)
    found = wrong(scene, judged)
    assert not found, "\n".join([*found, report(scene, judged)])
