"""Every job of the WinCNC workshops through the command line ends as `expect.toml` and its markers say."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest
from corpus.expectations import (
    JUDGED,
    ROOT,
    around,
    expectation,
    false_alarms,
    findings,
    jobs,
    markers,
    misplaced,
    readme_tables,
    report_of,
)
from support.command import in_own_process, in_this_process
from support.each import each

from gproof.driver.dialects import load_machine, semantics_of
from gproof.frontend.wincnc.load import load_alone
from gproof.frontend.wincnc.mac_program import load_macro_file
from gproof.ir.finding import Findings, Severity
from gproof.passes.interpret.understood_lines import doubtful_lines

SHOPS = ROOT / "corpus" / "wincnc"
JOBS = jobs("wincnc")
EXIT = {"SAFE": 0, "UNSAFE": 1, "UNKNOWN": 2}


def name_of(job: Path) -> str:
    return f"{job.parent.parent.name}/{job.stem}"


def called(job: Path) -> list[Path]:
    """The subprogram files beside a job that it names."""
    text = job.read_text(encoding="latin-1").upper()
    return [path for path in sorted(job.parent.glob("*.TAP")) if path.name.upper() in text]


def words_for(job: Path) -> list[str]:
    """The command that judges a job, with a report in JSON."""
    return ["check", str(job), *around(job), "--dialect", "wincnc", "--format", "json"]


@pytest.mark.parametrize("job", JOBS, ids=name_of)
def test_job_ends_as_expected(job: Path) -> None:
    expect = expectation(job)
    done = in_this_process(words_for(job), ROOT)
    assert "Traceback" not in done.err, done.err
    report = report_of(done.out or done.err)
    found = findings(report)
    assert {one.code for one in found if one.severity in JUDGED} == set(expect["findings"]), found
    assert report["verdict"] == expect["verdict"]
    # What a shop knows of its machine's file and lives with.
    assert false_alarms(found, expect) - set(expect.get("known", ())) == set()
    assert done.exit == expect["exit"]
    verdicts = {name: report["properties"][name]["verdict"] for name in expect.get("properties", {})}
    assert verdicts == expect.get("properties", {})
    assert [place for file in [job, *called(job)] for place in misplaced(found, file)] == []


@pytest.mark.parametrize("verdict", EXIT)
def test_a_process_of_its_own_says_the_same(verdict: str) -> None:
    job = next(job for job in JOBS if expectation(job)["verdict"] == verdict)
    assert in_own_process(words_for(job), ROOT) == in_this_process(words_for(job), ROOT)


@each("job", JOBS, ids=name_of)
def test_expectation_is_complete(job: Path) -> None:
    expect = expectation(job)
    assert job.is_file()
    assert expect["title"].strip()
    assert expect["exit"] == EXIT[expect["verdict"]]
    assert Path(expect["machine"]).is_file()
    assert expect.get("setup", "zero") == "zero" or Path(expect["setup"]).is_file()
    assert {code for file in [job, *called(job)] for code in markers(file).codes} <= set(expect["findings"])
    assert bool(expect["findings"]) == (expect["verdict"] != "SAFE")


@pytest.mark.parametrize("script", sorted(SHOPS.glob("*/jobs/make_*.py")), ids=lambda path: path.stem)
def test_generated_job_is_what_its_script_writes(script: Path) -> None:
    spec = importlib.util.spec_from_file_location(script.stem, script)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    written = "".join(f"{line}\n" for line in module.lines())
    job = script.with_name(f"{script.stem.removeprefix('make_')}.tap")
    assert job.read_bytes() == written.encode("ascii")


def test_readme_lists_every_job_under_its_verdict() -> None:
    tables = readme_tables("WinCNC")
    for job in JOBS:
        link = f"[{job.stem}]({job.relative_to(ROOT / 'corpus').as_posix()})"
        holding = [verdict for verdict, body in tables.items() if link in body]
        assert holding == [expectation(job)["verdict"]], link
    assert sum(body.count("\n| [") for body in tables.values()) == len(JOBS)


@pytest.mark.parametrize(
    "macro", sorted(SHOPS.glob("*/*.[mM][aA][cC]")), ids=lambda path: f"{path.parent.name}/{path.name}"
)
def test_every_file_of_a_machine_is_read(macro: Path) -> None:
    """With its own machine, and without a mistake, whatever calls it."""
    findings = Findings()
    machine, _ = load_machine(macro.parent / "WINCNC.INI", findings)
    assert machine is not None
    assert not findings.has(Severity.ERROR)
    findings = Findings()
    if macro.name.lower() == "cnc.mac":
        program = load_macro_file(macro, findings, machine=machine)
    else:
        program = load_alone(macro, findings, machine=machine, folders=[macro.parent])
    assert program is not None
    assert [one for one in findings.kept if one.severity in (Severity.ERROR, Severity.UNKNOWN)] == []
    if macro.name.lower() != "cnc.mac":
        assert doubtful_lines(program, machine, semantics_of(program)) == IDIOMS.get(macro.name, frozenset())


IDIOMS = {"puttool.mac": {4, 5, 10}, "gettool.mac": {3, 6}, "park.mac": {2}, "front.mac": {2}}
"""Lines that mean more than fmt prints: axes beside a stored place."""


def test_the_large_shop_has_its_macros() -> None:
    names = {path.name for path in (SHOPS / "vacuum-router").glob("*.mac")}
    assert len(names) == 29
    called = " ".join(path.read_text("ascii") for path in (SHOPS / "vacuum-router").glob("*.*") if path.is_file())
    assert all(name in called for name in names)


def test_every_workshop_is_whole() -> None:
    shops = sorted(path for path in SHOPS.iterdir() if path.is_dir())
    assert len(shops) >= 3
    for shop in shops:
        assert {"WINCNC.INI", "CNC.MAC", "setup.toml"} <= {path.name for path in shop.iterdir()}
