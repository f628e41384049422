"""Random threads, taps, synchronised moves and back bores mean the same to gproof and to LinuxCNC's interpreter."""

from __future__ import annotations

from pathlib import Path

import pytest
from differential import rs274_peer
from differential.random_spindle import program
from differential.test_random import judge

SEEDS = range(20)


@pytest.mark.usefixtures("peer", "gproof")
def test_random_spindle_programs(tmp_path: Path) -> None:
    paths = [tmp_path / f"{seed}.ngc" for seed in SEEDS]
    for seed, path in zip(SEEDS, paths, strict=True):
        path.write_text(program(seed))
    runs = rs274_peer.run_peers([(path, rs274_peer.situation_of(None)) for path in paths])
    for seed, path, run in zip(SEEDS, paths, runs, strict=True):
        assert run.accepted, f"seed {seed}: the generator left the shared language: {run.error}\n{path.read_text()}"
        found = judge(path, run)
        assert found is None, f"seed {seed}: {found}\n\n{path.read_text()}"
