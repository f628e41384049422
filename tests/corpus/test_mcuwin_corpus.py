"""Every job of the McuWIN machines through the command line ends as `expect.toml` and its markers say."""

from __future__ import annotations

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

SHOPS = ROOT / "corpus" / "mcuwin"
JOBS = jobs("mcuwin")
EXIT = {"SAFE": 0, "UNSAFE": 1, "UNKNOWN": 2}


def name_of(job: Path) -> str:
    return f"{job.parent.parent.name}/{job.stem}"


def words_for(job: Path) -> list[str]:
    """The command that judges a job, with a report in JSON."""
    return ["check", str(job), *around(job), "--format", "json"]


@pytest.mark.parametrize("job", JOBS, ids=name_of)
def test_job_ends_as_expected(job: Path) -> None:
    expect = expectation(job)
    done = in_this_process(words_for(job), ROOT)
    assert "Traceback" not in done.err, done.err
    report = report_of(done.out or done.err)
    found = findings(report)
    assert {one.code for one in found if one.severity in JUDGED} == set(expect["findings"]), found
    assert report["verdict"] == expect["verdict"]
    assert false_alarms(found, expect) == set()
    assert done.exit == expect["exit"]
    verdicts = {name: report["properties"][name]["verdict"] for name in expect.get("properties", {})}
    assert verdicts == expect.get("properties", {})
    assert misplaced(found, job) == []
    box = {one["axis"]: (one["low"], one["high"]) for one in report["summary"]["box"] if not one["relative_to"]}
    for axis, ends in expect.get("reaches", {}).items():
        assert box[axis] == pytest.approx(ends, abs=2e-4), axis


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
    assert markers(job).codes <= set(expect["findings"])
    assert bool(expect["findings"]) == (expect["verdict"] != "SAFE")


def test_readme_lists_every_job_under_its_verdict() -> None:
    tables = readme_tables("McuWIN")
    for job in JOBS:
        link = f"[{job.stem}]({job.relative_to(ROOT / 'corpus').as_posix()})"
        holding = [verdict for verdict, body in tables.items() if link in body]
        assert holding == [expectation(job)["verdict"]], link
    assert sum(body.count("\n| [") for body in tables.values()) == len(JOBS)


def test_every_machine_is_whole() -> None:
    shops = sorted(path for path in SHOPS.iterdir() if path.is_dir())
    assert len(shops) >= 3
    for shop in shops:
        assert {"McuWIN.ini", "machine.toml", "setup.toml"} <= {path.name for path in shop.iterdir()}


def test_the_machine_files_are_read_without_errors() -> None:
    from gproof.driver.dialects import load_machine
    from gproof.ir.finding import Findings

    for shop in SHOPS.iterdir():
        told = Findings()
        machine, _ = load_machine(shop / "machine.toml", told)
        assert machine is not None
        assert {f.code.label for f in told.kept} <= {"GP602"}
        assert not machine.not_modelled
