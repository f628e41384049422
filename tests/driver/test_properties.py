"""Properties beyond the default policy: who asks for them, and what that changes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from support.goldens import ROOT

from gproof.cli.main import main
from gproof.ir.verdict import DEFAULT_POLICY
from gproof.passes.checks.registry import CHECKS, added, decided, not_judged

MACHINE = ROOT / "docs" / "codes" / "machine.toml"
WITH = ("--machine", str(MACHINE), "--setup", "zero")
SAFE = "G21 G90 G17 G40 G49 G80 G94\nG0 Z-5\nG1 X10 F100\nG0 X0\nM30\n"


@pytest.fixture
def job(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("job.cnc").write_text(SAFE, encoding="utf-8")
    return Path("job.cnc")


def report(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, dict[str, object]]:
    code = main(["check", *words, "--format", "json"])
    return code, json.loads(capsys.readouterr().out)


def test_the_command_names_all_of_them(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "--help"]) == 0
    assert ", ".join(added()) in " ".join(capsys.readouterr().out.split())


def test_nobody_asks(job: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, said = report(capsys, str(job), *WITH)
    assert code == 0
    assert said["not_judged"] == list(added())
    assert list(said["properties"]) == list(DEFAULT_POLICY)  # type: ignore[call-overload]


@pytest.mark.parametrize("name", added())
def test_what_no_check_decides_is_unknown_where_it_is_asked_for(
    name: str, job: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(CHECKS, name, ())
    code, said = report(capsys, str(job), *WITH, "--also", name)
    assert (code, said["verdict"]) == (2, "UNKNOWN")
    assert said["properties"][name]["verdict"] == "UNKNOWN"  # type: ignore[index]
    assert name not in said["not_judged"]  # type: ignore[operator]


def test_a_job_file_asks(job: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(CHECKS, "gouges", ())
    head = f'schema = "gproof-job/1"\nmachine = "{MACHINE}"\nsetup = "zero"\njob = "job.cnc"\n'
    Path("a.toml").write_text(head + 'also = ["gouges"]\n', encoding="utf-8")
    code, said = report(capsys, "a.toml")
    assert code == 2
    assert "gouges" in said["jobs"][0]["properties"]  # type: ignore[index]
    Path("a.toml").write_text(head + 'also = ["wear"]\n', encoding="utf-8")
    assert main(["check", "a.toml"]) == 3
    assert "'wear' is not one of" in capsys.readouterr().err


def test_another_name_is_a_usage_error(job: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(job), "--also", "wear"]) == 3
    assert "wear" in capsys.readouterr().err


def test_what_is_left_open() -> None:
    assert not_judged([*DEFAULT_POLICY, "feeds"]) == added()[1:]
    assert all(decided(name) for name in DEFAULT_POLICY)


@pytest.mark.parametrize(
    "words", [("sense,feeds",), ("feeds", "sense"), ("feeds, sense", "feeds"), ("feeds,feeds,sense",)]
)
def test_names_with_commas_are_the_same_as_options_one_by_one(
    job: Path, capsys: pytest.CaptureFixture[str], words: tuple[str, ...]
) -> None:
    _, said = report(capsys, str(job), *WITH, *(part for word in words for part in ("--also", word)))
    assert said["not_judged"] == ["cutting", "gouges", "collisions"]


@pytest.mark.parametrize(
    ("asked", "codes"),
    [("gouges", {"GP425"}), ("collisions", {"GP426"}), ("gouges,collisions", {"GP425", "GP426"})],
)
def test_bodies_that_nobody_stated_are_asked_for_once(
    job: Path, capsys: pytest.CaptureFixture[str], asked: str, codes: set[str]
) -> None:
    """One finding a property, which says where they are stated."""
    code, said = report(capsys, str(job), *WITH, "--also", asked)
    found = said["findings"]
    assert isinstance(found, list)
    assert (code, {one["code"] for one in found}, len(found)) == (2, codes, len(codes))
    assert all("in the setup file" in one["hint"] for one in found)


@pytest.mark.parametrize(
    ("body", "hint"),
    [
        ("T9 M6\nG0 X5\n", "state [tools.9] in the machine file"),
        ("G0 X5\n", "program a tool change before it, or state tool = ... in the setup file"),
    ],
)
def test_a_tool_without_a_shape_says_where_it_is_stated(
    job: Path, capsys: pytest.CaptureFixture[str], body: str, hint: str
) -> None:
    job.write_text("G21 G90 G17 G40 G49 G80 G94\n" + body + "M30\n")
    Path("setup.toml").write_text(
        'schema = "gproof-setup/1"\ntool = 0\nactive_work = 1\nstart = {x = 0, y = 0, z = 0}\n'
        "g92 = {x = 0, y = 0, z = 0}\n[work.1]\nx = 0\ny = 0\nz = 0\n[[fixtures]]\nbox = [[1, -5, -20], [9, 5, 20]]\n"
    )
    _, said = report(capsys, str(job), "--machine", str(MACHINE), "--setup", "setup.toml", "--also", "collisions")
    found = said["findings"]
    assert isinstance(found, list)
    assert [one["hint"].split(";")[0] for one in found if one["code"] == "GP426"] == [hint]
