"""Several jobs in one command: which ones, in what order, what is printed, and the exit code."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import pytest
from support.goldens import ROOT

from gproof.cli.main import main

MACHINE = ROOT / "docs" / "codes" / "machine.toml"
SAFE = "G21 G90 G17 G40 G49 G80 G94\nG0 Z-5\nG1 X10 F100\nG0 X0\nM30\n"
UNSAFE = SAFE.replace("X10", "X100000")
UNKNOWN = SAFE.replace("G1 X10", "M22\nG1 X10")

Shop = Path


@pytest.fixture
def shop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Shop:
    """A folder with a machine file and a job of each verdict; it is the current one."""
    monkeypatch.chdir(tmp_path)
    machine = MACHINE.read_text(encoding="utf-8")
    (tmp_path / "mill.toml").write_text(machine, encoding="utf-8")
    (tmp_path / "jobs").mkdir()
    for name, text in (("b-safe.cnc", SAFE), ("a-unsafe.cnc", UNSAFE), ("c-unknown.ngc", UNKNOWN)):
        (tmp_path / "jobs" / name).write_text(text, encoding="utf-8")
    return tmp_path


def checked(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str, str]:
    code = main(["check", *words])
    printed = capsys.readouterr()
    return code, printed.out, printed.err


WITH = ("--machine", "mill.toml", "--setup", "zero")


def verdict_lines(out: str) -> list[str]:
    return [line for line in out.splitlines() if line.endswith((": SAFE", ": UNSAFE", ": UNKNOWN"))]


def test_a_folder_is_its_jobs_by_name(shop: Shop, capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = checked(capsys, "jobs", *WITH)
    assert verdict_lines(out) == ["jobs/a-unsafe.cnc: UNSAFE", "jobs/b-safe.cnc: SAFE", "jobs/c-unknown.ngc: UNKNOWN"]
    assert out.splitlines()[-1] == "3 jobs: 1 SAFE, 1 UNSAFE, 1 UNKNOWN"
    assert code == 1


@pytest.mark.parametrize(
    ("words", "names", "code"),
    [
        (["jobs/*.cnc"], ["jobs/a-unsafe.cnc", "jobs/b-safe.cnc"], 1),
        (["**/*.ngc", "jobs/b-safe.cnc"], ["jobs/c-unknown.ngc", "jobs/b-safe.cnc"], 2),
        (["jobs/b-safe.cnc", "./jobs/b-safe.cnc"], ["jobs/b-safe.cnc"], 0),
        (["jobs", "--exclude", "*-unsafe.cnc"], ["jobs/b-safe.cnc", "jobs/c-unknown.ngc"], 2),
        (["jobs", "--exclude", "c-*", "--exclude", "a-*"], ["jobs/b-safe.cnc"], 0),
    ],
)
def test_names_patterns_and_exclusions(
    shop: Shop, capsys: pytest.CaptureFixture[str], words: list[str], names: list[str], code: int
) -> None:
    got, out, _ = checked(capsys, *words, *WITH)
    assert [line.rpartition(":")[0] for line in verdict_lines(out)] == names
    assert got == code


def test_folders_leave_out_what_is_no_job(shop: Shop, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("macro.cnc", "letters.inc", "notes.txt", "CNC.MAC", ".hidden.cnc"):
        (shop / "jobs" / name).write_text(UNSAFE, encoding="utf-8")
    (shop / "jobs" / ".old").mkdir()
    (shop / "jobs" / ".old" / "job.cnc").write_text(UNSAFE, encoding="utf-8")
    (shop / "jobs" / "DEEP").mkdir()
    (shop / "jobs" / "DEEP" / "JOB.CNC").write_text(SAFE, encoding="utf-8")
    _, out, _ = checked(capsys, "jobs", *WITH)
    assert [line.rpartition(":")[0] for line in verdict_lines(out)] == [
        "jobs/DEEP/JOB.CNC", "jobs/a-unsafe.cnc", "jobs/b-safe.cnc", "jobs/c-unknown.ngc",
    ]  # fmt: skip


def test_one_that_can_not_be_judged_does_not_stop_the_others(shop: Shop, capsys: pytest.CaptureFixture[str]) -> None:
    code, out, err = checked(capsys, "jobs/b-safe.cnc", "no-such.cnc", "jobs/a-unsafe.cnc", *WITH)
    assert code == 3
    assert err == "gproof: error: job no-such.cnc: no such file\n"
    assert verdict_lines(out) == ["jobs/b-safe.cnc: SAFE", "jobs/a-unsafe.cnc: UNSAFE"]
    assert out.splitlines()[-1] == "3 jobs: 1 SAFE, 1 UNSAFE, 1 not checked"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["empty"], "empty: no programs in this folder (.cnc, "),
        (["*.tap"], "*.tap: no file matches this pattern"),
        (["jobs", "--exclude", "*"], "no jobs left: --exclude leaves out all of them"),
        (["jobs", "--picture", "out.svg"], "--picture draws one program"),
        (["jobs", "--call", "one"], "--call takes one program, not several jobs"),
        (["jobs", "--jobs", "0"], "--jobs"),
        (["jobs", "--format", "sarif", "--output", "nowhere/report.sarif"], "no such folder: nowhere"),
        (["jobs/b-safe.cnc", "--output", "jobs/b-safe.cnc"], "would overwrite an input"),
        (["jobs", "--output", "mill.toml"], "would overwrite an input"),
        ([], "Missing argument 'JOB...'"),
    ],
)
def test_a_bad_argument_is_one_line(
    shop: Shop, capsys: pytest.CaptureFixture[str], words: list[str], said: str
) -> None:
    (shop / "empty").mkdir()
    code, out, err = checked(capsys, *words, *WITH)
    assert (code, out) == (3, "")
    assert said in err
    assert len(err.splitlines()) == 1
    assert (shop / "jobs" / "b-safe.cnc").read_text(encoding="utf-8") == SAFE


@pytest.mark.parametrize("form", ["text", "sarif"])
def test_processes_change_nothing(shop: Shop, capsys: pytest.CaptureFixture[str], form: str) -> None:
    words = ["jobs", "no-such.cnc", *WITH, "--format", form]
    alone = checked(capsys, *words, "--jobs", "1")
    assert checked(capsys, *words, "--jobs", "2") == alone


def test_quiet_says_verdicts_only(shop: Shop, capsys: pytest.CaptureFixture[str]) -> None:
    _, out, _ = checked(capsys, "jobs", *WITH, "-q")
    assert out.splitlines() == [
        "jobs/a-unsafe.cnc: UNSAFE", "jobs/b-safe.cnc: SAFE", "jobs/c-unknown.ngc: UNKNOWN",
        "3 jobs: 1 SAFE, 1 UNSAFE, 1 UNKNOWN",
    ]  # fmt: skip
    assert checked(capsys, "jobs/b-safe.cnc", *WITH, "-q") == (0, "jobs/b-safe.cnc: SAFE\n", "")


def test_conditions_of_a_safe_job_are_told(shop: Shop, capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = checked(capsys, "jobs/b-safe.cnc", "jobs/b-safe.cnc", "no-such", "--machine", "mill.toml")
    assert code == 3
    bounds = [line for line in out.splitlines() if line.startswith("  if ")]
    # Each with the property that asks for it.
    assert all(line.endswith(("(limits)", "(areas)")) for line in bounds)
    assert len(bounds) == len(set(bounds)) >= 2
    assert "jobs/b-safe.cnc: SAFE if" in out.splitlines()


def test_the_report_goes_to_a_file_whole(shop: Shop, capsys: pytest.CaptureFixture[str]) -> None:
    for form in ("text", "json", "sarif"):
        _, printed, _ = checked(capsys, "jobs", *WITH, "--format", form)
        assert checked(capsys, "jobs", *WITH, "--format", form, "--output", "report")[:2] == (1, "")
        assert (shop / "report").read_text(encoding="utf-8") == printed
    assert sorted(path.name for path in shop.iterdir()) == ["jobs", "mill.toml", "report"]


def test_further_reports_are_those_that_the_forms_alone_give(shop: Shop, capsys: pytest.CaptureFixture[str]) -> None:
    forms = ("json", "sarif", "junit", "github", "markdown")
    for jobs in (["jobs"], ["jobs/a-unsafe.cnc"]):
        asked = [word for form in forms for word in ("--report", f"{form}=out.{form}")]
        plain = checked(capsys, *jobs, *WITH)
        assert checked(capsys, *jobs, *WITH, *asked) == plain
        for form in forms:
            code, out, _ = checked(capsys, *jobs, *WITH, "--format", form)
            assert (shop / f"out.{form}").read_text(encoding="utf-8") == out
            assert code == plain[0]


def test_a_job_that_can_not_be_judged_has_its_reports(shop: Shop, capsys: pytest.CaptureFixture[str]) -> None:
    code, out, err = checked(capsys, "nowhere.cnc", "--report", "json=out.json")
    assert (code, out) == (3, "")
    assert "nowhere.cnc" in err
    report = json.loads((shop / "out.json").read_text(encoding="utf-8"))
    assert report["counts"]["not_judged"] == 1
    assert "nowhere.cnc" in report["jobs"][0]["problem"]


@pytest.mark.parametrize("word", ["json", "text=a", "json=", "=a", "sarif=jobs", "sarif=mill.toml", "json=b"])
def test_a_report_that_can_not_be_written(shop: Shop, capsys: pytest.CaptureFixture[str], word: str) -> None:
    code, out, err = checked(capsys, "jobs", *WITH, "--output", "b", "--report", word)
    assert (code, out, err.count("\n")) == (3, "", 1)
    assert not (shop / "b").exists()


def test_a_file_name_with_marks_of_a_pattern(shop: Shop, capsys: pytest.CaptureFixture[str]) -> None:
    os.rename(shop / "jobs" / "b-safe.cnc", shop / "jobs" / "part[1].cnc")
    assert checked(capsys, "jobs/part[1].cnc", *WITH, "-q")[:2] == (0, "jobs/part[1].cnc: SAFE\n")


JOB_FILE = """
schema = "gproof-job/1"
machine = "../mill.toml"
setup = "zero"
job = ["b-safe.cnc", "*.ngc"]

[[jobs]]
job = "a-unsafe.cnc"
dialect = "eding"
"""


def test_a_job_file_says_what_is_judged_with(shop: Shop, capsys: pytest.CaptureFixture[str]) -> None:
    (shop / "jobs" / "all.toml").write_text(JOB_FILE, encoding="utf-8")
    for words in (["jobs/all.toml"], ["jobs"]):
        code, out, err = checked(capsys, *words)
        assert (code, err) == (1, "")
        assert sorted(verdict_lines(out)) == [
            "jobs/a-unsafe.cnc: UNSAFE", "jobs/b-safe.cnc: SAFE", "jobs/c-unknown.ngc: UNKNOWN",
        ]  # fmt: skip
    assert out.splitlines()[-1] == "3 jobs: 1 SAFE, 1 UNSAFE, 1 UNKNOWN"


def test_a_job_file_names_a_policy(shop: Shop, capsys: pytest.CaptureFixture[str]) -> None:
    stop = SAFE.replace("G1 X10", "M0\nG1 X10")
    (shop / "jobs" / "stops.cnc").write_text(stop, encoding="utf-8")
    head = 'schema = "gproof-job/1"\nmachine = "../mill.toml"\nsetup = "zero"\njob = "stops.cnc"\n'
    (shop / "jobs" / "plain.toml").write_text(head, encoding="utf-8")
    (shop / "jobs" / "strict.toml").write_text(head + 'policy = "strict-policy.toml"\n', encoding="utf-8")
    for name, level in (("strict", "error"), ("mild", "warning")):
        text = f'schema = "gproof-policy/1"\n[severity]\noperator-stop = "{level}"\n'
        (shop / "jobs" / f"{name}-policy.toml").write_text(text, encoding="utf-8")
    assert checked(capsys, "jobs/plain.toml", "-q")[:2] == (0, "jobs/stops.cnc: SAFE\n")
    assert checked(capsys, "jobs/strict.toml", "-q")[:2] == (1, "jobs/stops.cnc: UNSAFE\n")
    mild = checked(capsys, "jobs/strict.toml", "-q", "--policy", "jobs/mild-policy.toml", "--fail-on", "warning")
    assert mild[:2] == (1, "jobs/stops.cnc: SAFE (and findings that fail the check)\n")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "GP612"),
        ("job = 3\n", "must be a path or a list of paths"),
        ('job = "*.tap"\n', "no file matches '*.tap'"),
        ('job = "b-safe.cnc"\nmachin = "x"\n', "machin"),
        ('job = "b-safe.cnc"\ndialect = "fanuc"\n', "'fanuc' is not one of"),
    ],
)
def test_a_bad_job_file_has_its_place(shop: Shop, capsys: pytest.CaptureFixture[str], text: str, said: str) -> None:
    (shop / "jobs" / "all.toml").write_text('schema = "gproof-job/1"\n' + text, encoding="utf-8")
    code, out, err = checked(capsys, "jobs/all.toml", *WITH)
    if "machin" in text:
        assert "jobs/all.toml:3" in err
        return
    assert (code, out) == (3, "")
    assert "jobs/all.toml" in err
    if said != "GP612":
        assert said in err
    assert err.splitlines()[-1] == "gproof: error: job file jobs/all.toml: cannot be used, see the errors above"


def test_json_of_several(shop: Shop, capsys: pytest.CaptureFixture[str]) -> None:
    _, out, _ = checked(capsys, "jobs", "no-such.cnc", *WITH, "--format", "json")
    report: dict[str, Any] = json.loads(out)
    assert report["schema"] == "gproof-check-several/1"
    assert report["counts"] == {"SAFE": 1, "UNSAFE": 1, "UNKNOWN": 1, "not_judged": 1, "conditional": 0}
    _, alone, _ = checked(capsys, "jobs/b-safe.cnc", *WITH, "--format", "json")
    assert report["jobs"][1] == json.loads(alone)
    assert report["jobs"][3] == {"job": "no-such.cnc", "problem": "job no-such.cnc: no such file"}
