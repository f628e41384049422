"""A finding that holds in some outcomes only says in which: each source of outcomes, each dialect, every report."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import pytest

from gproof.cli.main import main

CORPUS = Path(__file__).resolve().parents[2] / "corpus"
MACHINE = 'schema = "gproof-machine/1"\nunits = "mm"\n[controller]\ndialect = "eding"\n' + "".join(
    f"[axes.{axis}]\nmin = -100.0\nmax = 300.0\n" for axis in "xyz"
)
SETUP = (
    'schema = "gproof-setup/1"\nunits = "mm"\nhomed = ["x", "y", "z"]\nactive_work = 1\ntool = 0\n'
    "block_delete = false\nstart = {x = 0.0, y = 0.0, z = 0.0}\n"
    "g92 = {x = 0.0, y = 0.0, z = 0.0}\n[work.1]\nx = 0.0\ny = 0.0\nz = 0.0\n"
)
HEAD = "G21 G90 G94 G17 G40 G49 G54\nF100\n"  # two lines
X = "G0 X400"
INI = """unit=MM
axischar=XYZ
axisspec=p0 s0 d0 r100 a100 t1
axisvel=r6000 f3000
axisspec=p0 s1 d1 r100 a100 t2
axisvel=r6000 f3000
axisspec=p0 s2 d2 r100 a100 t3
axisvel=r3000 f1000
lolim=X-100 Y-100 Z-100
hilim=X300 Y300 Z300
softlim=T1
"""


def eding(folder: Path, text: str, setup: str = "") -> list[str]:
    (folder / "machine.toml").write_text(MACHINE)
    (folder / "setup.toml").write_text(SETUP + setup)
    (folder / "job.cnc").write_text(HEAD + text + "\nM30\n")
    return ["job.cnc", "--machine", "machine.toml", "--setup", "setup.toml"]


def wincnc(folder: Path, text: str) -> list[str]:
    ini = (CORPUS / "wincnc" / "router-atc" / "WINCNC.INI").read_text()
    channels = "".join(
        f"{line}\n" for line in ini.splitlines() if line.startswith(("cnfin", "cnfout", "auxin", "auxout", "inp"))
    )
    (folder / "WINCNC.INI").write_text(INI + channels)
    (folder / "CNC.MAC").write_text("")
    (folder / "job.tap").write_text("G90\n" + text + "\n")
    return ["job.tap", "--machine", "WINCNC.INI", "--setup", "zero"]


def mcuwin(folder: Path, text: str, setup: str = "") -> list[str]:
    shutil.copytree(CORPUS / "mcuwin" / "engraver", folder, dirs_exist_ok=True)
    (folder / "s.toml").write_text((folder / "setup.toml").read_text() + setup)
    (folder / "job.src").write_text("%A\nN010 G90\nN015 G53\n" + text + "\nN100 M30\n%\n")
    return ["job.src", "--machine", "machine.toml", "--setup", "s.toml"]


def report(words: list[str], capsys: pytest.CaptureFixture[str], form: str = "json") -> str:
    main(["check", *words, "--format", form, "--also", "sense"])
    return capsys.readouterr().out


def rests(words: list[str], capsys: pytest.CaptureFixture[str], code: str = "GP301") -> list[str]:
    """What the findings of a code rest on, in words: "" for nothing."""
    found = json.loads(report(words, capsys))["findings"]
    return [one.get("rests", {}).get("text", "") for one in found if one["code"] == code]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        # A variable that the setup bounds; an input (M56 leaves #5399); a contact; a dialog; two that both count.
        (f"if [#10 > 0]\n{X}\nendif", ["only when #10 > 0 at line 3 is true"]),
        (f"if [#10 > 0]\nG0 Y1\nelse\n{X}\nendif", ["only when #10 > 0 at line 3 is false"]),
        (f"M56 P3\nif [#5399 == 1]\n{X}\nendif", ["only when #5399 == 1 at line 4 is true"]),
        (f"G38.2 Z-20\nif [#5067 == 0]\n{X}\nendif", ["only when #5067 == 0 at line 4 is true"]),
        (f'dlgmsg "which" "n" 100\nif [#5398 < 0]\n{X}\nendif', ["only when #5398 < 0 at line 4 is true"]),
        (
            f"if [#10 > 0]\nG0 Y1\nif [#11 > 0]\n{X}\nendif\nendif",
            ["only when #10 > 0 at line 3 is true; #11 > 0 at line 5 is true"],
        ),
        # The first question makes no difference.
        (f"if [#10 > 0]\nG0 Y1\nendif\nif [#11 > 0]\n{X}\nendif", ["only when #11 > 0 at line 6 is true"]),
        # One of two is enough.
        (
            f"#1 = 0\nif [#10 > 0]\n#1 = 1\nendif\nif [#11 > 0]\n#1 = 1\nendif\nif [#1 == 1]\n{X}\nendif",
            ["for example when #11 > 0 at line 7 is true"],
        ),
        # In every outcome.
        (f"if [#10 > 0]\nG0 Y1\nendif\n{X}", [""]),
        (f"{X}\nG0 X0\nif [#10 > 0]\nG0 Y1\nendif", [""]),
        # What is left when the other outcome has ended; a loop; passes of a loop.
        (f"if [#10 > 0]\nM30\nendif\n{X}", ["only when #10 > 0 at line 3 is false"]),
        (f"while [#10 > 0]\n{X}\nG0 X0\n#10 = [#10 - 1]\nendwhile", ["only when #10 > 0 at line 3 is true"]),
        (
            "#1 = 0\nwhile [#10 > #1]\nG0 X[#1 * 100]\n#1 = [#1 + 1]\nendwhile",
            ["only when #10 > #1 at line 4 is true 5 times"],
        ),
    ],
)  # fmt: skip
def test_eding(folder: Path, capsys: pytest.CaptureFixture[str], text: str, wanted: list[str]) -> None:
    stated = "[parameters]\n10 = [-1, 5]\n11 = [-1, 5]\n"
    assert rests(eding(folder, text, stated), capsys) == wanted


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        (f"M17.1 D0 C3\n{X}", "only when input 3 at line 2 is on"),
        (f"M18.1 D0 C3\n{X}", "only when input 3 at line 2 is off"),
        (f"M17.2 D0 C3\n{X}", "only when output 3 at line 2 is on"),
        (f"M17.3 C2\n{X}", "only when virtual input 2 at line 2 is on"),
        (f"M18.3 C2\n{X}", "only when virtual input 2 at line 2 is off"),
        (f"M17.1 D0 C3\nG0 Y5\n{X}", ""),
    ],
)
def test_wincnc(folder: Path, capsys: pytest.CaptureFixture[str], text: str, wanted: str) -> None:
    found = rests(wincnc(folder, text), capsys)
    assert found[:1] == [wanted]


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("$if (Z.digib.3) then begin\nG00 X400\n$end;", ["only when Z.digib.3 at line 4 is true"]),
        ("$if (CI606 > 1) then begin\nG00 X400\n$end;", ["only when CI606 > 1 at line 4 is true"]),
        ("$if (CI606 = 2) then begin\nG00 X400\n$end;", ["only when CI606 = 2 at line 4 is true"]),
        (
            "$while (CI606 > 2) do begin\nG00 X400\nG00 X0\nCI606 := CI606 - 1\n$end;",
            ["only when CI606 > 2 at line 4 is true"],
        ),
        (
            "$for CI601 := CI606 to 3 do begin\nG00 X(CI601 * 100 - 300)\n$end;",
            ["only when the first value of the for loop at line 4 is 1"],
        ),
        (
            "$for CI601 := 1 to CI606 do begin\nG00 X(CI601 * 60)\n$end;",
            ["only when the for loop at line 4 goes on 2 times"],
        ),
    ],
)  # fmt: skip
def test_mcuwin(folder: Path, capsys: pytest.CaptureFixture[str], text: str, wanted: list[str]) -> None:
    found = rests(mcuwin(folder, text, "[parameters]\n1606 = [1, 3]\n"), capsys)
    assert found == wanted


def test_every_report_has_it(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = eding(folder, f"if [#10 > 0]\n{X}\nendif\nG0 X0", "[parameters]\n10 = [-1, 5]\n")
    said = "only when #10 > 0 at line 3 is true"
    found: dict[str, Any] = json.loads(report(words, capsys))["findings"][0]
    assert found["rests"] == {
        "text": said,
        "outcomes": [{"file": "job.cnc", "line": 3, "what": "#10 > 0", "answer": "is true", "times": 1}],
        "more": 0,
        "example": False,
    }
    assert f"      = {said}\n" in report(words, capsys, "text")
    failure = ET.fromstring(report(words, capsys, "junit")).find(".//failure")
    assert failure is not None and said in str(failure.text)
    assert said in report(words, capsys, "github")
    assert said.replace("#", "\\#").replace(">", "\\>") in report(words, capsys, "markdown")
    result = json.loads(report(words, capsys, "sarif"))["runs"][0]["results"][0]
    assert result["message"]["text"].endswith(said) and result["properties"]["rests"] == found["rests"]


def test_a_handful_is_named(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = "".join(f"if [#{10 + n} > 0]\n" for n in range(7)) + f"{X}\n" + "endif\n" * 7
    words = eding(folder, text, "[parameters]\n" + "".join(f"{10 + n} = [-1, 5]\n" for n in range(7)))
    named = "; ".join(f"#{n} > 0 at line {n - 7} is true" for n in range(13, 17))
    assert rests(words, capsys) == [f"only when {named}; and 3 more before"]


def test_what_is_reported_at_the_end_names_no_more_than_an_example(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    setup = "[parameters]\n10 = [-1, 5]\n"
    text = "if [#10 > 0]\nG0 X[#11]\nendif"
    found = rests(eding(folder, text, f"{setup}11 = [0, 400]\n"), capsys, "GP304")
    assert found == ["for example when #10 > 0 at line 3 is true"]
