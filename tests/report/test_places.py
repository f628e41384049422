"""Every finding has its line: none is at line 0, none at line 1 that line 1 does not give; no number prints as 0."""

from __future__ import annotations

import json
import random
import shutil
import sys
from pathlib import Path

import pytest
from corpus.jobs import all_jobs, job_of
from corpus.pages import FOLDERS, dialects, settings
from support.campaigns import seeds, share
from support.goldens import ROOT

from gproof.cli.main import main
from gproof.ir.codes import SOFT_LIMIT
from gproof.ir.finding import Span, fixed
from gproof.report.units import INCH

SLOW = ("eding/raster-surface",)
JOBS = [name for verdict in ("SAFE", "UNSAFE", "UNKNOWN") for name in all_jobs(verdict) if name not in SLOW]
MACHINE = 'schema = "gproof-machine/1"\nunits = "mm"\n' + "".join(
    f"[axes.{a}]\nmin = 0.0\nmax = 300.0\n" for a in "xyz"
)
HEAD = "G21 G90 G94 G17 G40 G49 G54\n"


WHOLE = {
    "GP118": "nothing ends the job that a % at its first line begins",
    "GP119": "the first byte",
    "GP120": "nothing stands in the program",
    "GP146": "the size of the compiled program",
    "GP147": "the size of the compiled program",
    "GP425": "no file states stock or fixtures",
    "GP426": "no file states stock",
    "GP515": "the end of a program of which nothing stands there",
}
"""Findings about a whole program, which have no other line than its first one."""
SIGN = {".tap": "[a line of its own]\n", ".src": "' a line of its own\n"}
"""A comment of the language, ``;`` in others."""
HAZARDS = {
    ".cnc": (
        "G0 X700", "G0 X0 Y0 Z-5", "G91", "G90", "/G91", "G1 X20 F500", "G1 Z-20", "G2 X10 I5 J1",
        "G3 X30 Y0 I10 J0 F300", "M3 S1000", "T2 M6", "G43", "G10 L2 P1 X5", "G92 X0", "G38.2 Z-20 F50",
        "#1=#4500", "G0 X#1", "M0", "M22",
        "G53 G0 Z0", "G0 X560 Y360", "G41 D1", "G40", "G55", "/G0 X250", "G0 X-100", "MCAGuard off", "G1 Y5 F-1", "G20",
        "G81 X5 Y5 Z-10 R1", "M5", "M9",
    ),
    ".tap": (
        "G0 X700", "G0 X0 Y0", "G91", "G90", "G1 X20 F50", "G1 Z-2", "G2 X1 I5 J1", "G3 X3 Y0 I1 J0 F30", "M3", "T2",
        "G92 X0", "L21", "L20", "G53 Z0", "G55", "G0 X-10", "G1 Y5 F-1", "M37 Z0", "G7777", "L9999", "G81 X5 Y5 Z-1 R1",
        "G20", "G22", "L23 Z20", "G51 X2", "G28 X0",
    ),
    ".src": (
        "G00 X700", "G00 X0 Y0 Z-5", "G91", "G90", "G01 X20 F500", "G01 Z-20", "G02 X10 I5 J1",
        "G03 X30 Y0 I10 J0 F300", "M03 S1000", "T2", "G92 X0", "G53", "G54", "G55", "G00 X-100", "G01 Y5 F-1",
        "G98 X10", "G41", "G40", "G70", "G93",
        "M0", "M900", "G24 X", "G74 X0",
    ),
}  # fmt: skip
MACHINES = {".cnc": "machine.toml", ".tap": "wincnc/WINCNC.INI", ".src": "mcuwin/machine.toml"}


def places(words: list[str], capsys: pytest.CaptureFixture[str]) -> list[tuple[str, str, int]]:
    """(code, file, line) of each finding."""
    main(["check", *words, "--format", "json"])
    out = capsys.readouterr().out
    return [(f["code"], f["file"], f["line"]) for f in json.loads(out)["findings"]] if out.startswith("{") else []


def stray(job: Path, words: list[str], capsys: pytest.CaptureFixture[str]) -> list[tuple[str, int]]:
    """Findings at no line, and those at line 1 of the job that stay there when a comment goes before the program."""
    told = places([str(job), *words], capsys)
    found = [(code, line) for code, _, line in told if line < 1]
    suspects = {code for code, file, line in told if file == str(job) and line == 1 and code not in WHOLE}
    if suspects:
        sign = SIGN.get(job.suffix.lower(), "; a line of its own\n").encode()
        job.write_bytes(sign + job.read_bytes())
        again = places([str(job), *words], capsys)
        found += [(code, line) for code, file, line in again if file == str(job) and line == 1 and code in suspects]
    return found


@pytest.mark.parametrize("folder", share(FOLDERS, 5), ids=lambda folder: folder.name)
def test_findings_of_a_documented_program_are_at_their_lines(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for shared in folder.parent.iterdir():
        if shared.is_file():
            shutil.copy(shared, tmp_path)
        elif not shared.name.startswith("GP") or shared == folder:
            shutil.copytree(shared, tmp_path / shared.name)
    here = tmp_path / folder.name
    for dialect in dialects(folder):
        for side in ("bad", "good"):
            run = settings(folder, dialect, side)
            words = ["--machine", str(here / run["machine"])]
            if run["setup"] != "none":
                words += ["--setup", run["setup"] if run["setup"] == "zero" else str(here / run["setup"])]
            if run["command"] == "check":
                assert stray(here / run["program"], [*words, *run["options"]], capsys) == []


@pytest.mark.parametrize("name", share(JOBS, 4))
def test_findings_of_the_corpus_are_at_their_lines(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    program, expect = job_of(name)
    # A shop is its folder, a job of Eding a folder by itself.
    shop = program.parent if name.startswith("eding") else program.parents[1]
    shutil.copytree(shop, tmp_path / shop.name)
    here = tmp_path / program.relative_to(shop.parent).parent
    words = ["--machine", str(here / expect["machine"])]
    if "setup" in expect:
        words += ["--setup", expect["setup"] if expect["setup"] == "zero" else str(here / expect["setup"])]
    assert stray(here / program.name, words, capsys) == []


@pytest.mark.parametrize("suffix", list(HAZARDS))
@pytest.mark.parametrize("seed", seeds(12, 400))
def test_findings_of_made_jobs_are_at_their_lines(
    seed: int, suffix: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Every property, with nothing, all and some of the machine's state stated."""
    rng = random.Random(f"{seed} {suffix}")
    head = {".tap": "[a plate]\n", ".src": "%A\n"}.get(suffix, "(a plate)\n")
    program = head + "".join(f"{rng.choice(HAZARDS[suffix])}\n" for _ in range(rng.randint(4, 14)))
    program += "" if suffix == ".tap" else "M30\n"
    job = tmp_path / f"job{suffix}"
    job.write_text(program)
    words = ["--machine", str(ROOT / "docs" / "codes" / MACHINES[suffix]), "--also", "all"]
    stated = rng.choice(("", "zero", "start = {x = -20.0, z = [-30.0, 9.0]}\n[work.1]\nz = [-90.0, 0.0]\n"))
    if stated not in ("", "zero"):
        (tmp_path / "setup.toml").write_text('schema = "gproof-setup/1"\nunits = "mm"\n' + stated)
        words += ["--setup", str(tmp_path / "setup.toml")]
    elif stated:
        words += ["--setup", stated]
    assert stray(job, words, capsys) == [], program + f"# {stated}"


@pytest.mark.parametrize("seed", seeds(8, 20))
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


@pytest.mark.parametrize(
    ("over", "said"), [(0.00001, "0.000010 mm past"), (4e-13, "4.0e-13 mm past"), (0.25, "0.250 mm past")]
)
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
