"""The benchmarks call what is there: a stage whose signature has changed is a failure here, not a line in a table."""

from __future__ import annotations

import importlib.util
from pathlib import Path

ROOT = Path(__file__).parents[1]


def test_every_stage_has_a_figure() -> None:
    spec = importlib.util.spec_from_file_location("bench_stages", ROOT / "bench/stages.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    folder = ROOT / "corpus/eding/drilled-plate"
    figures = module.stages(folder / "job.cnc", folder / "machine.toml")
    assert [name for name, found in figures.items() if "problem" in found] == [], figures
    assert {"execute", "plan", "step", "validate"} <= figures.keys()
