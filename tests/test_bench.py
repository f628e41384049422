"""The benchmarks call what is there: a stage whose signature has changed is a failure here, not a line in a table."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import pytest
from support.bundles import unpacked

from gproof.driver.dialects import load_machine
from gproof.driver.running import begin, collect
from gproof.driver.translation import Wanted, translate
from gproof.frontend.mcuwin.load import load_program
from gproof.ir.finding import Findings
from gproof.ir.setup import ZERO
from gproof.ir.verdict import Verdict

ROOT = Path(__file__).parents[1]


def bench(name: str) -> ModuleType:
    """A module of the benchmarks."""
    spec = importlib.util.spec_from_file_location(f"bench_{name}", ROOT / f"bench/{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_stage_has_a_figure() -> None:
    module = bench("stages")
    folder = ROOT / "corpus/eding/drilled-plate"
    figures = module.stages(folder / "job.cnc", folder / "machine.toml")
    assert [name for name, found in figures.items() if "problem" in found] == [], figures
    assert {"execute", "plan", "step", "validate"} <= figures.keys()


@pytest.mark.parametrize("shape", ["raster", "arcs", "modal"])
def test_programs_of_mcuwin_have_no_mistakes(tmp_path: Path, shape: str) -> None:
    bench("programs").write_program(shape, 120, tmp_path / "job.din")
    findings = Findings()
    machine, _ = load_machine(unpacked("bench") / "machines/mcuwin.toml", findings)
    assert machine is not None
    program = load_program(tmp_path / "job.din", findings, machine)
    assert program is not None
    trace = collect(begin(program, ZERO, machine, findings))
    assert findings.kept == []
    assert sum(len(section.rows) for section in trace.sections) > 100


@pytest.mark.parametrize("dialect", ["eding", "wincnc", "mcuwin"])
def test_programs_that_are_translated_are_proven(
    tmp_path: Path, dialect: str, monkeypatch: pytest.MonkeyPatch
) -> None:  # fmt: skip
    monkeypatch.syspath_prepend(ROOT / "bench")
    module = bench("translation")
    suffix, machine = module.SOURCES[dialect]
    job = tmp_path / f"job{suffix}"
    bench("programs").write_program("arcs", 40, job)
    for to, machine_to in module.TARGETS.items():
        done = translate(Wanted(job=job, to=to, machine=machine, machine_to=machine_to, dialect=dialect))
        assert done.verdict is Verdict.SAFE, (to, done.findings.kept)


@pytest.mark.parametrize("dialect", ["eding", "mcuwin"])
def test_programs_that_are_read_have_no_mistakes(tmp_path: Path, dialect: str) -> None:
    parse = bench("parse")
    for kind in parse.KINDS[dialect]:
        path = tmp_path / f"{kind}{parse.SUFFIX[dialect]}"
        parse.write(kind, 30, path)
        parse.load(path)


def test_the_link_has_runs_to_carry(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(ROOT / "bench")
    module = bench("link")
    tables = module.tables(2_500, 0.1)
    assert [int(t["count"].sum()) for t in tables] == [62] * module.MOTORS
    assert module.encoding() > 0
