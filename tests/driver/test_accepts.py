"""``accepts`` of a machine file: each entry with a job that needs it, which is not SAFE without the entry."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest
from support.command import Done, in_this_process

from gproof.ir.dialects.accepts import ACCEPTS

AXES = """
[axes.x]
min = 0
max = 100
backlash = 0.05
[axes.y]
min = 0
max = 100
[axes.z]
min = -50
max = 0
"""
HEADS = {
    "eding": f'schema = "gproof-machine/1"\nunits = "mm"{AXES}[controller]\ndialect = "eding"\n',
    "wincnc": f'schema = "gproof-machine/1"\nunits = "mm"\nbase = "WINCNC.INI"{AXES}[controller]\n',
}
INI = (
    "unit=mm\ntimertype=7200\naxischar=XYZ\n"
    + "".join(f"axisspec=p0 s{n} d{n} r100 a36000 f24000 t{n + 1}\n" for n in range(3))
    + "auxout=c1p0b1\nauxout=c2p0b2\nauxout=c3p0b3\n"
)


@dataclass(frozen=True)
class Job:
    """A job that needs an entry: the text of its file, further files, and the finding that it has without."""

    entry: str
    dialect: str
    text: str
    code: str
    files: tuple[tuple[str, str], ...] = ()


LONG = " ".join(f"v{n} {n}" for n in range(1, 16))
JOBS = (
    Job("motion-alone", "eding", "G21 G90 F100\nG1\nX5\nG0\nX6 Y1\nM30\n", "GP201"),
    Job("motion-alone", "eding", "G21 G90\ngosub change\nX5 F100\nM30\nsub change\n#1 = 2\ng1\nendsub\n", "GP201"),
    Job("message-formats", "eding", 'G21 G90\n#1 = 2\nmsg "passes " #1 %d\nlogmsg "x %f" %.3f #1\nG0 X5\n', "GP101"),
    Job("digit-names", "eding", "G21 G90\ngosub 3d_probe\nM30\nsub 3d_probe\nG0 X5\nendsub\n", "GP124"),
    Job(
        "user-macro-file",
        "eding",
        "G21 G90\ngosub park\nM30\n",
        "GP605",
        (("macro.cnc", "sub park\nG0 X500\nendsub\n"), ("user_macro.cnc", "sub park\nG0 X5\nendsub\n")),
    ),
    Job(
        "usual-precedence",
        "eding",
        "G21 G90\n#1 = 4\nif [#1 == 4 and 2]\nG0 X5\nelse\nG0 X500\nendif\nM30\n",
        "GP230",
    ),
    Job("kept-motion", "eding", "G21 G90\nX5 Y6\nM30\n", "GP202"),
    Job("kept-motion", "wincnc", "G22\nG90\nX5 Y6\n", "GP202"),
    Job("shown-tools", "eding", 'G21 G90\ndlgmsg "put in" "tool" 5011 "old" 5008\nG0 X5\nM30\n', "GP113"),
    Job("written-tools", "eding", "G21 G90\n#5011 = 3\n#5008 = 3\nG0 X5\nM30\n", "GP113"),
    Job("scaled-z", "eding", "G21 G90\nG51 P0.5 I0 J0\nG0 Z-80\nM30\n", "GP304"),
    Job("unscaled-z", "eding", "G21 G90\nG51 P2 I0 J0\nG0 X5 Y6\nG81 X6 Z-40 R0 F100\nM30\n", "GP276"),
    Job("l20-shown", "eding", "G21 G90\nG92 X50\nG10 L20 P1 X0\nG0 X20\nM30\n", "GP304"),
    Job("l20-machine", "eding", "G21 G90\nG92 X50\nG10 L20 P1 X0\nG0 X145\nM30\n", "GP304"),
    Job("tool-zero", "eding", "G21 G90\n#5400 = 0\n#[5500 + #5008] = 0\nG0 X5\nM30\n", "GP113"),
    Job("long-dialogs", "eding", f'G21 G90\ndlgmsg "ask" {LONG}\nG0 X5\nM30\n', "GP113"),
    Job("tool-info", "eding", "G21 G90\nGetToolInfo num 3\nG0 X5\nM30\n", "GP113"),
    Job("modbus", "eding", "G21 G90\nmodbus s1 f3 a2 n1 u20\nG0 X5\nM30\n", "GP113"),
    Job("pc-programs", "eding", 'G21 G90\nExec "ask.exe" "-b=yes" 60000\nG0 X5\nM30\n', "GP113"),
    Job("height-commands", "eding", "G21 G90\nZHC off\nG0 X5\nM30\n", "GP113"),
    Job("repeated-channel", "wincnc", "G22\nG90\nM11C1C2\nm12 c1 c2\nG0 X5\n", "GP109"),
    Job("text-after-comment", "wincnc", "G22\nG90\n[N50] G0 X5 [a] Y6 [b]\n", "GP134"),
    Job("line-numbers", "wincnc", "N10 G22\nn20 G90\nN 30 G0 X5 Y6\nN40\nN50 M11C1\n", "GP113"),
)


def run(job: Job, folder: Path, *words: str, entry: str = "", more: str = "") -> Done:
    """Check a job on a machine that accepts the entry, or nothing."""
    accepts = f'accepts = ["{entry}"]\n' if entry else ""
    (folder / "mill.toml").write_text(HEADS[job.dialect] + accepts + more)
    if job.dialect == "wincnc":
        (folder / "WINCNC.INI").write_text(INI)
        (folder / "CNC.MAC").write_text("")
    name = "job.cnc" if job.dialect == "eding" else "job.tap"
    (folder / name).write_text(job.text)
    for other, text in job.files:
        (folder / other).write_text(text)
    return in_this_process(["check", name, "--machine", "mill.toml", "--setup", "zero", *words], folder)


def test_every_entry_has_a_job_of_each_of_its_dialects() -> None:
    assert {(job.entry, job.dialect) for job in JOBS} == {(r.name, d) for r in ACCEPTS.values() for d in r.dialects}


@pytest.mark.parametrize("job", JOBS, ids=lambda job: f"{job.entry}-{job.dialect}")
def test_without_the_entry_the_finding_names_it_and_with_it_the_answer_rests_on_it(job: Job, tmp_path: Path) -> None:
    without = run(job, tmp_path)
    assert without.exit in (1, 2), without.out
    assert job.code in without.out and int(job.code[2:]) in ACCEPTS[job.entry].codes
    assert f'accepts = ["{job.entry}"]' in without.out, without.out
    given = run(job, tmp_path, entry=job.entry)
    assert given.exit == 0, given.out
    assert ACCEPTS[job.entry].assumption in " ".join(given.out.split()), given.out
    # An entry that a job does not need is no assumption of its answer.
    (tmp_path / "user_macro.cnc").unlink(missing_ok=True)
    plain = Job("", job.dialect, "G90\nG0 X5\n" + "M30\n" * (job.dialect == "eding"), "")
    other = run(plain, tmp_path, entry=job.entry)
    assert other.exit == 0 and "accepts" not in other.out, other.out


@pytest.mark.parametrize(
    ("stated", "told"),
    [
        ('["motion-alon"]', "did you mean 'motion-alone'?"),
        ('["text-after-comment"]', "eding has no"),
        ('"motion-alone"', "not a list of texts"),
        ("[1]", "not a list of texts"),
    ],
)
def test_an_unknown_entry_is_an_error(stated: str, told: str, tmp_path: Path) -> None:
    done = run(JOBS[0], tmp_path, more=f"accepts = {stated}\n")
    assert done.exit == 3
    assert told in done.out + done.err


@pytest.mark.parametrize(
    ("dialect", "entry"), [(dialect, row.name) for row in ACCEPTS.values() for dialect in row.dialects]
)
@pytest.mark.parametrize("mistake", [lambda name: name[:-1], lambda name: name + "s", lambda name: name[1:]])
def test_each_entry_misspelt_is_named(
    dialect: str, entry: str, mistake: Callable[[str], str], tmp_path: Path
) -> None:  # fmt: skip
    """In every dialect that has it: an entry that is none is no entry that counts for nothing."""
    job = next(job for job in JOBS if job.dialect == dialect)
    done = run(job, tmp_path, more=f'accepts = ["{mistake(entry)}"]\n')
    assert done.exit == 3, done.out
    assert f"did you mean '{entry}'?" in done.out + done.err, done.out + done.err


@pytest.mark.parametrize("entry", ACCEPTS)
def test_mcuwin_has_none(entry: str, tmp_path: Path) -> None:
    (tmp_path / "mill.toml").write_text(
        f'schema = "gproof-machine/1"\nunits = "mm"\n[axes.x]\n'
        f'[controller]\ndialect = "mcuwin"\naccepts = ["{entry}"]\n'
    )
    (tmp_path / "job.src").write_text("G90\nG00 X5\nM30\n")
    done = in_this_process(["check", "job.src", "--machine", "mill.toml"], tmp_path)
    assert done.exit == 3 and entry in done.out + done.err and "mcuwin" in done.out + done.err, done.out + done.err


@pytest.mark.parametrize("job", JOBS, ids=lambda job: f"{job.entry}-{job.dialect}")
def test_reports_of_every_form_know_the_assumption(job: Job, tmp_path: Path) -> None:
    """JSON has it as text; -q and the documents of servers have verdicts and findings only."""
    text = run(job, tmp_path, "--format", "json", entry=job.entry).out
    assert ACCEPTS[job.entry].assumption in json.loads(text)["assumptions"]
    for form in ("junit", "github", "markdown", "sarif"):
        done = run(job, tmp_path, "--format", form, entry=job.entry)
        assert done.exit == 0 and job.code not in done.out, done.out


def test_underscores_are_read_and_a_version_is_said(tmp_path: Path) -> None:
    done = run(JOBS[0], tmp_path, more='accepts = ["motion_alone"]\nversion = "4.03.52"\n')
    assert done.exit == 0
    assert "4.03.52" in done.out


@pytest.mark.parametrize(
    ("x", "travel", "wanted"),
    [(0.0, "", 0), (100.0, "", 0), (-0.001, "", 1), (0.0, "travel_min = -0.02\n", 2), (0.0, "travel_min = -0.06\n", 0)],
)
def test_soft_limits_that_hold_for_programmed_positions(x: float, travel: str, wanted: int, tmp_path: Path) -> None:
    """Parking at a limit with backlash: GP320 without the statement; the end stops hold for the motor anyway."""
    job = Job("", "eding", f"G21 G90\nG53 G0 X50\nG53 G0 X{x}\nM30\n", "")
    before = run(job, tmp_path)
    assert before.exit == (1 if x < 0 else 2)
    assert x < 0 or ("GP320" in before.out and "limits_hold" in before.out)
    (tmp_path / "mill.toml").write_text(
        HEADS["eding"].replace("backlash", travel + "backlash") + 'limits_hold = "programmed"\n'
    )
    done = in_this_process(["check", "job.cnc", "--machine", "mill.toml", "--setup", "zero"], tmp_path)
    assert done.exit == wanted, done.out
    assert "limits_hold" in done.out
