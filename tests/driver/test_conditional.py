"""A SAFE with conditions says so in every report, with the property of each; JSON stays SAFE, and conditional."""

from __future__ import annotations

import json
import re
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from gproof.cli.main import main

HEAD = "G21 G90 G94 G17 G40 G49 G54\n"
MACHINE = (
    'schema = "gproof-machine/1"\nunits = "mm"\n[controller]\ndialect = "eding"\n'
    + "".join(f"[axes.{axis}]\nmin = -100.0\nmax = 300.0\n" for axis in "xyz")
    + '[[keep_out]]\nname = "clamp"\nx = [250.0, 300.0]\n'
)
SETUP = (
    'schema = "gproof-setup/1"\nhomed = ["x", "y", "z"]\nactive_work = 1\ntool = 0\nblock_delete = false\n'
    "start = {x = 0.0, y = 0.0, z = 0.0}\ng92 = {x = 0.0, y = 0.0, z = 0.0}\n"
)
X = "G54 X offset is -110.0000 ... 290.0000 mm"
ZONE = "G54 X offset is -110.0000 ... 240.0000 mm"
Z = "the start position of Z is -100.0000 ... 250.0000 mm"
START = "the start position of X is -100.0000 ... 250.0000 mm"
JOBS = {
    # limits: 10 + offset in -100 ... 300; clamp: of these 10 + offset at most 250.
    "offset.cnc": HEAD + "G0 X10\nM30\n",
    "start.cnc": HEAD + "G91 G0 Z50\nM30\n",
    "plain.cnc": HEAD + "G53 G0 X10\nM30\n",
    "unsafe.cnc": HEAD + "G0 X10\nG53 G0 Y400\nM30\n",
    "unknown.cnc": HEAD + "G0 X10\nG53 G0 Y[#5]\nM30\n",
}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "machine.toml").write_text(MACHINE)
    (tmp_path / "setup.toml").write_text(SETUP)
    (tmp_path / "no-start.toml").write_text(SETUP.replace("start =", "# start ="))
    for name, text in JOBS.items():
        (tmp_path / name).write_text(text)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def said(capsys: pytest.CaptureFixture[str], *words: str, setup: str = "setup.toml") -> tuple[int, str]:
    code = main(["check", *words, "--machine", "machine.toml", "--setup", setup])
    told = capsys.readouterr()
    return code, re.sub(r"(?<=\S) +", " ", told.out + told.err)


def test_quiet_has_the_conditions_in_its_line(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert said(capsys, "offset.cnc", "-q") == (0, f"offset.cnc: SAFE if {X} (limits), {ZONE} (areas)\n")
    assert said(capsys, "plain.cnc", "-q") == (0, "plain.cnc: SAFE\n")
    assert said(capsys, "unsafe.cnc", "-q") == (1, "unsafe.cnc: UNSAFE\n")
    assert said(capsys, "unknown.cnc", "-q") == (2, "unknown.cnc: UNKNOWN\n")
    assert said(capsys, "offset.cnc", "-q", "--strict") == (2, "offset.cnc: UNKNOWN\n")


def test_a_start_that_is_not_stated_is_a_condition(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, out = said(capsys, "start.cnc", "-q", setup="no-start.toml")
    assert (code, out) == (0, f"start.cnc: SAFE if {Z} (limits), {START} (areas)\n")
    assert said(capsys, "start.cnc", "-q", "--strict", setup="no-start.toml")[0] == 2


def test_text_names_the_properties(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    _, out = said(capsys, "offset.cnc")
    assert "offset.cnc: SAFE if the conditions of limits and areas hold" in out.splitlines()
    assert f"  areas SAFE if {ZONE}" in out.splitlines()
    _, out = said(capsys, "unsafe.cnc")
    assert " if " not in "".join(line for line in out.splitlines() if line.startswith("  "))
    _, out = said(capsys, "offset.cnc", "--strict")
    assert "  limits UNKNOWN SAFE only under conditions, which --strict does not accept" in out.splitlines()


def test_every_report_of_several(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    names = sorted(JOBS)
    _, text = said(capsys, *names, setup="setup.toml")
    assert f"  if {X} (limits)" in text.splitlines()
    assert f"  if {ZONE} (areas)" in text.splitlines()
    assert text.splitlines()[-1] == "5 jobs: 2 SAFE, 1 SAFE-IF, 1 UNSAFE, 1 UNKNOWN"
    assert sum(line.startswith("  if ") for line in text.splitlines()) == 2
    _, github = said(capsys, *names, "--format", "github")
    assert f"gproof: offset.cnc: SAFE if {X} (limits), {ZONE} (areas)" in github.splitlines()
    assert "gproof: plain.cnc: SAFE" in github.splitlines()
    _, page = said(capsys, *names, "--format", "markdown")
    assert [line for line in page.splitlines() if "SAFE if" in line] == [
        f"- SAFE if {X} (limits)", f"- SAFE if {ZONE} (areas)",
    ]  # fmt: skip
    assert "| `offset.cnc` | ☑️ SAFE-IF |" in page
    _, junit = said(capsys, *names, "--format", "junit")
    suites = {suite.get("name"): suite for suite in ET.fromstring(junit)}
    value = {name: suite.find("properties/property") for name, suite in suites.items()}
    told = {name: "" if one is None else one.get("value") for name, one in value.items()}
    assert told["offset.cnc"] == f"SAFE if {X} (limits), {ZONE} (areas)"
    assert (told["plain.cnc"], told["unsafe.cnc"], told["unknown.cnc"]) == ("SAFE", "UNSAFE", "UNKNOWN")
    cases = {case.get("name"): case for case in suites["offset.cnc"].iter("testcase")}
    assert f"areas is SAFE if {ZONE}" in (cases["areas"].findtext("system-out") or "")
    assert "SAFE if" not in "".join(suites["unsafe.cnc"].itertext())
    _, sarif = said(capsys, *names, "--format", "sarif")
    answers = json.loads(sarif)["runs"][0]["properties"]
    assert answers["verdicts"]["offset.cnc"] == "SAFE-IF"
    assert answers["conditions"] == {"offset.cnc": {"limits": [X], "areas": [ZONE]}}


def test_json_stays_safe_and_is_conditional(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name, words, verdict, exit_code in (
        ("offset.cnc", [], "SAFE", 0),
        ("plain.cnc", [], "SAFE", 0),
        ("unsafe.cnc", [], "UNSAFE", 1),
        ("offset.cnc", ["--strict"], "UNKNOWN", 2),
    ):
        code, out = said(capsys, name, *words, "--format", "json")
        report = json.loads(out)
        assert (report["verdict"], code) == (verdict, exit_code)
        assert report["conditional"] == (name == "offset.cnc" and not words)
        for answer in report["properties"].values():
            assert answer["verdict"] == "SAFE" or not answer["conditions"]
    _, out = said(capsys, *sorted(JOBS), "--format", "json")
    assert json.loads(out)["counts"]["conditional"] == 1


def test_the_picture_says_so(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    said(capsys, "offset.cnc", "--picture", "a.svg")
    told = [element.text for element in ET.parse("a.svg").iter("{http://www.w3.org/2000/svg}text")]
    assert {"SAFE-IF", f"if {X} (limits)", f"if {ZONE} (areas)"} <= set(told)


def test_setup_zero_names_the_lengths_it_takes_as_0(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "tools.cnc").write_text(HEAD + "T3 M6\nG43 H3\nG0 Z10\nT1 M6\nG43 H1\nG0 Z9\nM30\n")
    with (folder / "machine.toml").open("a") as machine:
        machine.write("[tools.1]\nlength = 20.0\n")
    main(["check", "tools.cnc", "--machine", "machine.toml", "--setup", "zero"])
    out = capsys.readouterr().out
    assert "setup zero: length 0 for T3, which are in no tool table" in out
    assert "T1," not in out


def test_packages_say_under_which_conditions_they_hold(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Of a length in force that no setup states a zone asks to be short enough; the runtime refuses to guess."""
    from corpus.jobs import CORPUS

    router = (CORPUS / "eding" / "clamped-bracket" / "machine.toml").read_text()
    (tmp_path / "m.toml").write_text(
        router + '[[keep_out]]\nname = "clamp"\nx = [100.0, 120.0]\ny = [0.0, 300.0]\nz = [-200.0, -60.0]\n'
    )
    (tmp_path / "s.toml").write_text(SETUP.replace("tool = 0", "tool = 1"))
    condition = "if active tool length is at most 60.0000 mm (areas)"
    words = ["--machine", str(tmp_path / "m.toml"), "--setup", str(tmp_path / "s.toml")]
    for name, moves, code in (("cond", "G53 G0 X110 Y10\n", 0), ("plain", "G53 G0 X60 Y10\n", 0)):
        job, package = tmp_path / f"{name}.cnc", tmp_path / f"{name}.gpx"
        job.write_text(f"G21 G90 G17 G54\n{moves}M30\n")
        assert main(["compile", str(job), *words, "-o", str(package)]) == code
        compiled = " ".join(capsys.readouterr().out.split())
        assert main(["verify", str(package)]) == 0
        verified = " ".join(capsys.readouterr().out.split())
        assert [condition in compiled, condition in verified] == [name == "cond"] * 2, (compiled, verified)
        assert f"{package}: {'SAFE-IF' if name == 'cond' else 'SAFE'} " in verified
        assert "GP825" not in verified
        assert (main(["run", str(package), "--board", "virtual"]) == 0) == (name == "plain")
        capsys.readouterr()


def test_a_conditional_job_without_a_stream_is_not_called_safe(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:  # fmt: skip
    words = ["--machine", "machine.toml", "--setup", "setup.toml", "--unsigned", "-o", "job.gpx"]
    assert main(["compile", "offset.cnc", *words]) == 2
    told = capsys.readouterr()
    assert "the job is SAFE under conditions, but it cannot be compiled" in told.out + told.err
