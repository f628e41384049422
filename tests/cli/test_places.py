"""Every finding of a program has a line, in docs/codes and in the corpus; no number prints as 0 that is none."""

from __future__ import annotations

import json
import random
import sys
import tomllib
from pathlib import Path

import pytest
from corpus.test_codes import FOLDERS, dialects, settings
from support.campaigns import share
from support.goldens import ROOT

from gproof.cli.lengths import INCH
from gproof.cli.main import main
from gproof.ir.codes import SOFT_LIMIT
from gproof.ir.finding import Span, fixed

JOBS = [path.parent for path in sorted(ROOT.glob("corpus/*/*/expect.toml")) if path.parent.name != "raster-surface"]
MACHINE = 'schema = "gproof-machine/1"\nunits = "mm"\n' + "".join(
    f"[axes.{a}]\nmin = 0.0\nmax = 300.0\n" for a in "xyz"
)
HEAD = "G21 G90 G94 G17 G40 G49 G54\n"


def places(words: list[str], capsys: pytest.CaptureFixture[str]) -> list[tuple[str, int]]:
    main(["check", *words, "--format", "json"])
    out = capsys.readouterr().out
    return [(f["code"], f["line"]) for f in json.loads(out)["findings"]] if out.startswith("{") else []


@pytest.mark.parametrize("folder", share(FOLDERS, 5), ids=lambda folder: folder.name)
def test_no_finding_of_a_documented_program_is_at_line_0(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for dialect in dialects(folder):
        for side in ("bad", "good"):
            run = settings(folder, dialect, side)
            words = [str(folder / run["program"]), "--machine", str(folder / run["machine"])]
            if run["setup"] != "none":
                words += ["--setup", run["setup"] if run["setup"] == "zero" else str(folder / run["setup"])]
            if run["command"] == "check":
                assert [code for code, line in places([*words, *run["options"]], capsys) if line < 1] == []


@pytest.mark.parametrize("folder", share(JOBS, 3), ids=lambda folder: folder.name)
def test_no_finding_of_the_corpus_is_at_line_0(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    expect = tomllib.loads((folder / "expect.toml").read_text(encoding="utf-8"))
    words = [str(folder / "job.cnc"), "--machine", str(folder / expect["machine"])]
    if "setup" in expect:
        words += ["--setup", expect["setup"] if expect["setup"] == "zero" else str(folder / expect["setup"])]
    assert [code for code, line in places(words, capsys) if line < 1] == []


@pytest.mark.parametrize("seed", range(20))
def test_no_number_prints_as_0(seed: int) -> None:
    rng = random.Random(seed)
    for _ in range(50):
        value = rng.choice((-1, 1)) * 10.0 ** rng.uniform(-15, 3)
        for places_ in (0, 1, 3, 4, 6):
            text = fixed(value, places_)
            assert float(text) != 0.0, value
            if round(value, places_):
                assert text == f"{value:.{places_}f}"
            else:
                assert abs(float(text) - value) <= abs(value) * 0.06, value
    assert fixed(0.0, 4) == "0.0000"


@pytest.mark.parametrize(("over", "said"), [(0.00001, "0.000010 past"), (4e-13, "4.0e-13 past"), (0.25, "0.2500 past")])
def test_a_limit_passed_by_little(over: float, said: str) -> None:
    finding = SOFT_LIMIT.at(
        Span("job.cnc", 1), axis="X", reached=300.0 + over, unit="mm", over=over, side="upper", limit=300.0
    )
    assert said in finding.message
    assert " 0.0000 past" not in INCH.message(finding)


def test_many_probe_contacts_are_counted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Forty contacts in one position, one behind another."""
    (tmp_path / "machine.toml").write_text(MACHINE)
    (tmp_path / "job.cnc").write_text(HEAD + "G0 Z5\nG91\n" + "G38.2 Z-20 F100\nG0 Z3\n" * 40 + "M30\n")
    main(["check", str(tmp_path / "job.cnc"), "--machine", str(tmp_path / "machine.toml"), "--setup", "zero"])
    out = capsys.readouterr().out
    assert "probe contacts in Z (" in out
    assert max(map(len, out.splitlines())) < 300
    assert out.count("the probe contact ") <= 12
    assert sys.getsizeof(out) < 6000
