"""Every job of the corpus through the command line ends as its `expect.toml` and its markers say."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest
from corpus.expectations import (
    CORPUS,
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

JOBS = [job.parent for job in jobs("eding")]
EXIT = {"SAFE": 0, "UNSAFE": 1, "UNKNOWN": 2}


def name_of(folder: Path) -> str:
    return folder.relative_to(CORPUS).as_posix()


def words_for(folder: Path) -> list[str]:
    """The command that judges a job, with a report in JSON."""
    job = folder / "job.cnc"
    also = [word for name in expectation(job).get("also", ()) for word in ("--also", name)]
    return ["check", str(job), *around(job), "--format", "json", *also]


@pytest.mark.parametrize("folder", JOBS, ids=name_of)
def test_job_ends_as_expected(folder: Path) -> None:
    expect = expectation(folder / "job.cnc")
    done = in_this_process(words_for(folder), ROOT)
    assert "Traceback" not in done.err, done.err
    report = report_of(done.out or done.err)
    found = findings(report)
    assert {one.code for one in found if one.severity in JUDGED} == set(expect["findings"]), found
    assert report["verdict"] == expect["verdict"]
    assert false_alarms(found, expect) == set()
    assert done.exit == expect["exit"]
    verdicts = {name: report["properties"][name]["verdict"] for name in expect.get("properties", {})}
    assert verdicts == expect.get("properties", {})
    assert misplaced(found, folder / "job.cnc") == []


@pytest.mark.parametrize("verdict", EXIT)
def test_a_process_of_its_own_says_the_same(verdict: str) -> None:
    folder = next(folder for folder in JOBS if expectation(folder / "job.cnc")["verdict"] == verdict)
    assert in_own_process(words_for(folder), ROOT) == in_this_process(words_for(folder), ROOT)


@each("folder", JOBS, ids=name_of)
def test_expectation_is_complete(folder: Path) -> None:
    expect = expectation(folder / "job.cnc")
    assert expect["title"].strip()
    assert expect["exit"] == EXIT[expect["verdict"]]
    assert Path(expect["machine"]).is_file()
    assert expect.get("setup", "zero") == "zero" or Path(expect["setup"]).is_file()
    assert markers(folder / "job.cnc").codes <= set(expect["findings"])
    assert bool(expect["findings"]) == (expect["verdict"] != "SAFE")


@pytest.mark.parametrize("script", sorted(CORPUS.glob("*/*/make_job.py")), ids=lambda path: path.parent.name)
def test_generated_job_is_what_its_script_writes(script: Path) -> None:
    spec = importlib.util.spec_from_file_location(f"make_{script.parent.name.replace('-', '_')}", script)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    written = "".join(f"{line}\n" for line in module.lines())
    assert script.with_name("job.cnc").read_bytes() == written.encode("ascii")


def test_readme_lists_every_job_under_its_verdict() -> None:
    tables = readme_tables("Eding CNC")
    for folder in JOBS:
        link = f"[{folder.name}]({name_of(folder)}/job.cnc)"
        holding = [verdict for verdict, body in tables.items() if link in body]
        assert holding == [expectation(folder / "job.cnc")["verdict"]], link
    assert sum(body.count("\n| [") for body in tables.values()) == len(JOBS)


def test_corpus_has_the_demo_job() -> None:
    lines = (CORPUS / "eding" / "drilled-plate" / "job.cnc").read_text(encoding="ascii").splitlines()
    assert 80 <= len(lines) <= 150
