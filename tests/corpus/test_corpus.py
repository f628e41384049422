"""Every job of the corpus through the command line ends as its `expect.toml` and its markers say."""

from __future__ import annotations

import importlib.util
import tomllib
from pathlib import Path

import pytest
from corpus.expectations import JUDGED, ROOT, false_alarms, findings, markers, misplaced, readme_tables, report_of
from support.command import in_own_process, in_this_process

CORPUS = ROOT / "corpus"
JOBS = sorted(path.parent for path in CORPUS.glob("*/*/job.cnc"))
EXIT = {"SAFE": 0, "UNSAFE": 1, "UNKNOWN": 2}


def name_of(folder: Path) -> str:
    return folder.relative_to(CORPUS).as_posix()


def expectation(folder: Path) -> dict:
    return tomllib.loads((folder / "expect.toml").read_text(encoding="utf-8"))


def words_for(folder: Path) -> list[str]:
    """The command that judges a job, with a report in JSON."""
    expect = expectation(folder)
    words = ["check", str(folder / "job.cnc"), "--machine", str(folder / expect["machine"]), "--format", "json"]
    if "setup" in expect:
        setup = expect["setup"]
        words += ["--setup", setup if setup == "zero" else str(folder / setup)]
    return words + [word for name in expect.get("also", ()) for word in ("--also", name)]


@pytest.mark.parametrize("folder", JOBS, ids=name_of)
def test_job_ends_as_expected(folder: Path) -> None:
    expect = expectation(folder)
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
    folder = next(folder for folder in JOBS if expectation(folder)["verdict"] == verdict)
    assert in_own_process(words_for(folder), ROOT) == in_this_process(words_for(folder), ROOT)


@pytest.mark.parametrize("folder", JOBS, ids=name_of)
def test_expectation_is_complete(folder: Path) -> None:
    expect = expectation(folder)
    assert expect["title"].strip()
    assert expect["exit"] == EXIT[expect["verdict"]]
    assert (folder / expect["machine"]).is_file()
    assert expect.get("setup", "zero") == "zero" or (folder / expect["setup"]).is_file()
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
        assert holding == [expectation(folder)["verdict"]], link
    assert sum(body.count("\n| [") for body in tables.values()) == len(JOBS)


def test_corpus_has_the_demo_job() -> None:
    lines = (CORPUS / "eding" / "drilled-plate" / "job.cnc").read_text(encoding="ascii").splitlines()
    assert 80 <= len(lines) <= 150
