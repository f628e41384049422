"""The command line on bad input: one clear line or findings, the right exit code, nothing half-written.

Exit codes: 3 the command could not run, 1 UNSAFE, 2 UNKNOWN, 0 SAFE; the code always agrees with what is printed.
"""

from __future__ import annotations

import json
import os
import re
import socket
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest
from support.campaigns import share

from gproof.cli.main import main
from gproof.ir.codes import CODES

MACHINE = """schema = "gproof-machine/1"
units = "mm"
[axes.x]
min = 0
max = 100
steps_per_unit = 100
max_velocity = 10
max_acceleration = 100
"""
JOB = "G21 G90\nG0 X1\nM30\n"
EXIT = {"SAFE": 0, "UNSAFE": 1, "UNKNOWN": 2}
ONE_LINE = re.compile(r"gproof(?: \w+)?: error: [^\n]+\n\Z")


@dataclass(frozen=True)
class Done:
    exit: int
    out: str
    err: str


Run = Callable[..., Done]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a good job, machine and setup, and the working directory."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    (tmp_path / "job.cnc").write_text(JOB)
    (tmp_path / "machine.toml").write_text(MACHINE)
    (tmp_path / "setup.toml").write_text('schema = "gproof-setup/1"\n')
    return tmp_path


@pytest.fixture
def gproof(folder: Path, capsys: pytest.CaptureFixture[str]) -> Run:
    def run(*words: str | Path) -> Done:
        before = contents(folder)
        capsys.readouterr()
        try:
            code = main([str(word) for word in words])
        except SystemExit as end:
            code = end.code if isinstance(end.code, int) else 3
        captured = capsys.readouterr()
        done = Done(code, captured.out, captured.err)
        assert "Traceback" not in done.out + done.err
        assert "internal error" not in done.err
        if code == 3:
            assert contents(folder) == before, "a command that could not run left something behind"
        return done

    return run


def contents(folder: Path) -> dict[str, bytes]:
    return {str(p): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file() and not p.is_symlink()}


def refused(done: Done, *words: str) -> None:
    """Exit 3, nothing on standard output, one line on standard error that has these words."""
    assert done.exit == 3, done
    assert done.out == ""
    assert ONE_LINE.match(done.err), done.err
    for word in words:
        assert word in done.err, done.err


def bad_file(done: Done, role: str, *words: str) -> None:
    """Exit 3: findings with a place, then one line."""
    assert done.exit == 3, done
    assert done.out == ""
    lines = done.err.splitlines()
    assert re.fullmatch(rf"gproof: error: {role} file .+: cannot be used, see the errors above", lines[-1]), lines[-1]
    assert re.match(r".+?:.* error GP6[01]\d \[[-a-z]+\] ", lines[0]), done.err
    for word in words:
        assert word in done.err, done.err


def judged(gproof: Run, job: str | Path, *more: str | Path) -> tuple[str, set[str]]:
    """(verdict, codes) of a job: the same in both formats, and the exit code with them."""
    text = gproof("check", job, *more)
    report = gproof("check", job, *more, "--format", "json")
    verdict = re.search(r"^(?:.+): (SAFE|UNSAFE|UNKNOWN)( if the conditions of [\w ]+ hold)?$", text.out, re.M)
    assert verdict is not None, text
    data = json.loads(report.out)
    assert data["verdict"] == verdict[1]
    assert data["conditional"] == bool(verdict[2])
    assert text.exit == report.exit == EXIT[verdict[1]]
    assert text.err == report.err == ""
    codes = {item["code"] for item in data["findings"]}
    assert codes == set(re.findall(r"^\S.*?: \w+ (GP\d{3}) \[", text.out, re.M))
    assert codes <= {code.label for code in CODES.values()}
    return verdict[1], codes


# -- jobs

LONG = 5_000_000
JOBS: dict[str, tuple[bytes, str, str]] = {
    "empty": (b"", "UNSAFE", "GP120"),
    "comments only": (b"(nothing)\n; to do\n\n%\n", "UNSAFE", "GP120"),
    "blanks": (b" \t \n\n", "UNSAFE", "GP120"),
    "binary": (bytes(range(256)) * 40, "UNSAFE", "GP119"),
    "NUL": (b"G21 G90\n\0G0 X1\nM30\n", "UNSAFE", "GP119"),
    "NUL at the end": (b"G21 G90\nG0 X1\nM30\n\0", "UNSAFE", "GP119"),
    "UTF-16": (JOB.encode("utf-16"), "UNSAFE", "GP119"),
    "UTF-16 without a mark": (JOB.encode("utf-16-le"), "UNSAFE", "GP119"),
    "CR only": (JOB.replace("\n", "\r").encode(), "UNSAFE", "GP101"),
    "control character": (b"G21\x07\nM30\n", "UNSAFE", "GP101"),
    "one long line": (b"G0 " + b"X1" * (LONG // 2) + b"\n", "UNSAFE", "GP106"),
    "300 characters": (b"G21 (" + b"c" * 294 + b")\nM30\n", "UNSAFE", "GP106"),
    "text of another kind": (b"Dear Sir,\nplease mill this.\n", "UNKNOWN", "GP113"),
}
FINE: dict[str, bytes] = {
    "no end of line": JOB.rstrip("\n").encode(),
    "CR LF": JOB.replace("\n", "\r\n").encode(),
    "mixed ends of lines": b"G21 G90\r\nG0 X1\nM30\r\n",
    "UTF-8 mark": b"\xef\xbb\xbf" + JOB.encode(),
    "UTF-8 in a comment": f"(Bohrung ø 5)\n{JOB}".encode(),
    "Latin-1 in a comment": f"(Bohrung ø 5)\n; größer\n{JOB}".encode("latin-1"),
    "256 characters": b"G21 (" + b"c" * 250 + b")\n" + JOB.encode(),
    "a million empty lines": b"\n" * 1_000_000 + JOB.encode(),
    "nothing but an end": b"M30\n",
    "percent signs": b"%\n" + JOB.encode() + b"%\n",
    "lower case": JOB.lower().encode(),
}


@pytest.mark.parametrize("name", JOBS)
def test_a_job_that_is_no_program(name: str, folder: Path, gproof: Run) -> None:
    data, verdict, code = JOBS[name]
    (folder / "job.cnc").write_bytes(data)
    found, codes = judged(gproof, "job.cnc", "--machine", "machine.toml", "--setup", "zero")
    assert (found, code in codes) == (verdict, True), codes


@pytest.mark.parametrize("name", JOBS)
def test_no_output_is_longer_than_a_screen(name: str, folder: Path, gproof: Run) -> None:
    (folder / "job.cnc").write_bytes(JOBS[name][0])
    out = gproof("check", "job.cnc").out
    assert max(map(len, out.splitlines())) < 200
    assert len(out.splitlines()) < 150


@pytest.mark.parametrize("name", FINE)
def test_a_job_written_by_any_editor(name: str, folder: Path, gproof: Run) -> None:
    (folder / "job.cnc").write_bytes(FINE[name])
    assert judged(gproof, "job.cnc", "--machine", "machine.toml", "--setup", "zero") == ("SAFE", set())


@pytest.mark.parametrize("command", ["check", "compile", "dump"])
def test_a_job_that_can_not_be_read(command: str, folder: Path, gproof: Run) -> None:
    (folder / "folder").mkdir()
    (folder / "dangling").symlink_to(folder / "gone")
    (folder / "around").symlink_to(folder / "around")
    more = {"check": [], "compile": ["-o", "job.gpx"], "dump": ["--stage", "trace"]}[command]
    refused(gproof(command, "nothere.cnc", *more), "nothere.cnc", "no such file")
    refused(
        gproof(command, "folder", *more),
        "folder",
        "no programs in this folder" if command == "check" else "is a folder",
    )
    refused(gproof(command, "folder/job.cnc", *more), "no such file")
    refused(gproof(command, "job.cnc/job.cnc", *more), "no such file")
    refused(gproof(command, "dangling", *more), "no such file")
    refused(gproof(command, "around", *more), "around")
    refused(gproof(command, "n" * 300, *more))
    refused(gproof(command, "", *more))
    refused(gproof(command, "/dev/null", *more), "is not a regular file")
    refused(gproof(command, "/dev/zero", *more), "is not a regular file")


def test_a_pipe_is_never_half_a_job(folder: Path, gproof: Run) -> None:
    os.mkfifo(folder / "pipe")
    refused(gproof("check", "pipe"), "is not a regular file")
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(str(folder / "socket"))
        refused(gproof("check", "socket"), "is not a regular file")
    long = JOB.replace("G0 X1", "G0 X1\n" * 20_000 + "G0 X500")
    done = run_process("check", "/dev/stdin", "--machine", str(folder / "machine.toml"), text=long)
    assert done.exit == 3
    assert "is not a regular file" in done.err


def run_process(*words: str, text: str = "", more: dict[str, str] | None = None) -> Done:
    """The command in a process of its own."""
    return run_python("-m", "gproof.cli.main", *words, text=text, more=more)


def run_python(*words: str, text: str = "", more: dict[str, str] | None = None) -> Done:
    """A fresh Python in the working directory."""
    done = subprocess.run(
        [sys.executable, *words],
        input=text.encode(),
        capture_output=True,
        check=False,
        env=os.environ | (more or {}),
    )
    return Done(done.returncode, done.stdout.decode(errors="replace"), done.stderr.decode(errors="replace"))


def test_a_job_that_may_not_be_opened(folder: Path, gproof: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """Root may open everything, so the refusal is played."""
    really = Path.open
    monkeypatch.setitem(globals(), "contents", lambda _: {})

    def locked(self: Path, *args: object, **kwargs: object) -> object:
        if self.name == "locked.cnc":
            raise PermissionError(13, "Permission denied", str(self))
        return really(self, *args, **kwargs)  # type: ignore[arg-type]

    (folder / "locked.cnc").write_text(JOB)
    monkeypatch.setattr(Path, "open", locked)
    refused(gproof("check", "locked.cnc"), "locked.cnc", "Permission denied")
    refused(gproof("check", "job.cnc", "--machine", "locked.cnc"), "locked.cnc", "Permission denied")
    refused(gproof("check", "job.cnc", "--setup", "locked.cnc"), "locked.cnc", "Permission denied")


# -- machine files

BAD_MACHINES: dict[str, tuple[str, str, int]] = {
    "limits reversed": ("[axes.x]\nmin = 10\nmax = 5\n", "min is above max", 4),
    "travel reversed": ("[axes.x]\ntravel_min = 10\ntravel_max = 5\n", "travel_min is above travel_max", 4),
    "NaN": ("[axes.x]\nmin = nan\n", "NaN is not a number", 4),
    "infinite": ("[axes.x]\nmax = inf\n", "is not a number", 4),
    "absurd exponent": ("[axes.x]\nmax = 1e999999999\n", "is not a number", 4),
    "too large": ("[axes.x]\nmax = 1e100\n", "too large", 4),
    "text for a number": ('[axes.x]\nmax = "100"\n', "is not a number", 4),
    "true for a number": ("[axes.x]\nmax = true\n", "is not a number", 4),
    "zero steps": ("[axes.x]\nsteps_per_unit = 0\n", "steps_per_unit", 4),
    "steps by zero": ('[axes.x]\nsteps_per_unit = "1600/0"\n', "steps_per_unit", 4),
    "steps in words": ('[axes.x]\nsteps_per_unit = "many"\n', "steps_per_unit", 4),
    "standing still": ("[axes.x]\nmax_velocity = 0\n", "not greater than 0", 4),
    "negative acceleration": ("[axes.x]\nmax_acceleration = -5\n", "not greater than 0", 4),
    "negative backlash": ("[axes.x]\nbacklash = -1\n", "backlash", 4),
    "axis of another kind": ('[axes.x]\nkind = "round"\n', "'round'", 4),
    "no such axis": ("[axes.q]\nmax = 1\n", "'q' is not an axis", 3),
    "axes are a number": ("axes = 3\n", "not a table", 3),
    "axes are a list": ("[[axes]]\n", "not a table", 3),
    "area upside down": ("[areas.tool_change]\nx = [50, 0]\n", "is not below the upper end", 4),
    "area of one number": ("[areas.tool_change]\nx = [50]\n", "list of a lower and an upper end", 4),
    "area of nothing": ("[areas.tool_change]\n", "is missing", 3),
    "tool 0": ("[tools.0]\nlength = 1\n", "'0'", 3),
    "tool one": ("[tools.one]\nlength = 1\n", "'one'", 3),
    "no such dialect": ('[controller]\ndialect = "fanuc"\n', "'fanuc'", 4),
    "no ticks": ("[board]\ntick_frequency = 0\n", "tick_frequency", 4),
    "base is missing": ('base = "cnc.ini"\n', "No such file", 0),
    "base is a folder": ('base = "."\n', "base", 3),
    "base is a device": ('base = "/dev/zero"\n', "not a regular file", 3),
    "base has a NUL": ('base = "a\\u0000b"\n', "not a regular file", 3),
    "base of itself": ('base = "bad.toml"\n', "circle", 3),
    "not TOML": ("[axes.x\n", "this is not TOML", 3),
    "a key twice": ("[axes.x]\nmin = 1\nmin = 2\n", "this is not TOML", 5),
    "deep": ("a = " + "[" * 5000 + "]" * 5000 + "\n", "this is not TOML", 0),
}


@pytest.mark.parametrize("name", BAD_MACHINES)
def test_a_machine_file_that_makes_no_sense(name: str, folder: Path, gproof: Run) -> None:
    text, what, line = BAD_MACHINES[name]
    (folder / "bad.toml").write_text(f'schema = "gproof-machine/1"\nunits = "mm"\n{text}')
    for form in ("text", "json"):
        done = gproof("check", "job.cnc", "--machine", "bad.toml", "--setup", "zero", "--format", form)
        bad_file(done, "machine", what)
        if line:
            assert f"bad.toml:{line}:" in done.err, done.err


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"\0\0\0",
        b"\xff\xfe",
        b"\x7fELF\x02\x01\x01\0" * 50,
        b"schema = 3\n",
        b'schema = "gproof-setup/1"\n',
        JOB.encode(),
    ],
)
def test_a_file_that_is_no_machine_file(data: bytes, folder: Path, gproof: Run) -> None:
    for name in ("bad.toml", "bad.ini", "bad", "bad.INI"):
        (folder / name).write_bytes(data)
        bad_file(gproof("check", "job.cnc", "--machine", name), "machine", name)


INI = "[GENERAL]\nunits = mm\n[JOINT_0]\nportID = 1\nresolution = 100\npositiveLimit = 100\nnegativeLimit = 0\n"


@pytest.mark.parametrize(
    ("old", "new", "what"),
    [
        ("resolution = 100", "resolution = 0", "no steps per unit"),
        ("resolution = 100", "resolution = nan", "is not a number"),
        ("positiveLimit = 100", "positiveLimit = inf", "is not a number"),
        ("positiveLimit = 100", "positiveLimit = 1e999", "is not a number"),
        ("positiveLimit = 100", "positiveLimit = -100", "is above"),
        ("units = mm", "units = furlong", "'furlong'"),
        ("portID = 1", "portID", "neither [section] nor key = value"),
        ("portID = 1", "portID = one", "is not a number"),
        ("portID = 1", "maxVelocity = 0", "not greater than 0"),
        ("portID = 1", "maxAcceleration = -1", "not greater than 0"),
    ],
)
def test_a_controller_file_that_makes_no_sense(old: str, new: str, what: str, folder: Path, gproof: Run) -> None:
    assert old in INI
    (folder / "cnc.ini").write_text(INI)
    assert judged(gproof, "job.cnc", "--machine", "cnc.ini", "--setup", "zero") == ("SAFE", set())
    (folder / "cnc.ini").write_text(INI.replace(old, new))
    bad_file(gproof("check", "job.cnc", "--machine", "cnc.ini", "--setup", "zero"), "machine", what)


def test_an_unknown_key_of_an_own_file_is_an_error(folder: Path, gproof: Run) -> None:
    (folder / "machine.toml").write_text(MACHINE + "maximum = 3\n[spindel]\nrpm = 1\n")
    done = gproof("check", "job.cnc", "--machine", "machine.toml", "--setup", "zero")
    bad_file(done, "machine", "GP611", "maximum'", "did you mean 'spindle")


def test_a_machine_file_that_can_not_be_read(folder: Path, gproof: Run) -> None:
    refused(gproof("check", "job.cnc", "--machine", "nothere.toml"), "machine file nothere.toml: no such file")
    refused(gproof("check", "job.cnc", "--machine", "."), "is a folder")
    refused(gproof("check", "job.cnc", "--machine", ""), "the file name is empty")
    refused(gproof("check", "job.cnc", "--machine", "/dev/null"), "is not a regular file")


# -- setup files

BAD_SETUPS: dict[str, tuple[str, str]] = {
    "homed": ("homed = 3\n", "homed"),
    "homed axis": ('homed = ["q"]\n', "homed"),
    "homed lists": ('homed = [["x"]]\n', "homed"),
    "start list": ("start = [1, 2]\n", "not a table"),
    "start text": ('start = {x = "1"}\n', "start.x"),
    "start upside down": ("start = {x = [5, 1]}\n", "above the upper end"),
    "start NaN": ("start = {x = nan}\n", "start.x"),
    "start infinite": ("start = {x = -inf}\n", "start.x"),
    "three ends": ("start = {x = [1, 2, 3]}\n", "start.x"),
    "work 10": ("[work.10]\nx = 1\n", "'10'"),
    "work one": ("[work.one]\nx = 1\n", "'one'"),
    "active work": ("active_work = 0\n", "active_work"),
    "tool": ("tool = 1.5\n", "tool"),
    "negative tool": ("tool = -1\n", "tool"),
    "tool length": ('[tools.1]\nlength = "long"\n', "tools.1.length"),
    "parameter 0": ("[parameters]\n0 = 1\n", "'0'"),
    "parameter name": ("[parameters]\nspeed = 1\n", "'speed'"),
    "parameter text": ('[parameters]\n1 = "x"\n', "parameters.1"),
    "switch": ("block_delete = 1\n", "block_delete"),
    "units": ('units = "cm"\n', "'cm'"),
    "not TOML": ("homed = \n", "this is not TOML"),
}


@pytest.mark.parametrize("name", BAD_SETUPS)
def test_a_setup_file_that_makes_no_sense(name: str, folder: Path, gproof: Run) -> None:
    text, what = BAD_SETUPS[name]
    (folder / "setup.toml").write_text(f'schema = "gproof-setup/1"\n{text}')
    bad_file(gproof("check", "job.cnc", "--machine", "machine.toml", "--setup", "setup.toml"), "setup", what)


def test_a_setup_file_that_can_not_be_read(folder: Path, gproof: Run) -> None:
    refused(gproof("check", "job.cnc", "--setup", "nothere.toml"), "setup file nothere.toml: no such file")
    refused(gproof("check", "job.cnc", "--setup", "."), "is a folder")
    refused(gproof("check", "job.cnc", "--setup", "Zero"), "no such file")
    bad_file(gproof("check", "job.cnc", "--setup", "machine.toml"), "setup", "gproof-machine/1")
    bad_file(gproof("check", "job.cnc", "--machine", "setup.toml"), "machine", "gproof-setup/1")


def test_files_given_as_each_other(folder: Path, gproof: Run) -> None:
    """One finding that names the right option, and not one for each key."""
    for option, role, name, other in (
        ("--machine", "machine", "setup.toml", "--setup"), ("--setup", "setup", "machine.toml", "--machine"),
    ):  # fmt: skip
        done = gproof("check", "job.cnc", option, name)
        bad_file(done, role, f"hint: give this file with {other}")
        assert "GP611" not in done.err
    bad_file(
        gproof("check", "job.cnc", "--machine", "job.cnc"),
        "machine",
        "hint: use a machine file of gproof",
        "WINCNC.INI",
    )
    bad_file(gproof("check", "job.cnc", "--setup", "job.cnc"), "setup", "hint: use a setup file of gproof")


@pytest.mark.parametrize("name", ["WINCNC.INI", "cnc.ini", "McuWIN.ini", "ToolComp.INI", "machine.toml", "setup.toml"])
@pytest.mark.parametrize(
    "words", [["check"], ["dump", "--stage", "trace"], ["compile", "-o", "out.gpx"], ["fmt"]], ids=" ".join
)
def test_settings_are_no_program(words: list[str], name: str, folder: Path, gproof: Run) -> None:
    """One line, and not a finding for each of theirs."""
    if not (folder / name).exists():
        (folder / name).write_text("[GENERAL]\nunit=IN\n")
    refused(gproof(*words, name), f"{name}: is not a program")


def test_a_job_for_another_controller(folder: Path, gproof: Run) -> None:
    """Only where it has lines that cannot be read, and says itself whose it is."""
    hint = "the program looks like one for mcuwin: DIN section in line 2"
    (folder / "job.src").write_text("x = ;\n{$DINSTART}\nN10 G00 X1\nN20 M30\n")
    assert hint in gproof("check", "job.src", "--dialect", "eding").out
    assert "looks like" not in gproof("check", "job.src", "--dialect", "mcuwin").out
    (folder / "job.src").write_text("x = ;\n")
    assert "looks like" not in gproof("check", "job.src", "--dialect", "eding").out
    assert "looks like" not in gproof("check", "job.cnc", "--dialect", "wincnc").out


def test_standard_input_is_no_job(folder: Path, gproof: Run) -> None:
    refused(gproof("check", "-"), "job -: give a file; standard input is not read")
    (folder / "-").write_text(JOB)
    assert judged(gproof, "-")[0] == "UNKNOWN"


def test_a_picture_is_svg(folder: Path, gproof: Run) -> None:
    refused(gproof("check", "job.cnc", "--picture", "job.png"), "pictures are SVG; name it job.svg")
    assert gproof("check", "job.cnc", "--machine", "machine.toml", "--picture", "job").exit != 3
    assert (folder / "job").read_text().startswith("<")


# -- options and arguments


@pytest.mark.parametrize(
    ("words", "what"),
    [
        (["--nonsense"], "--nonsense"),
        (["nonsense"], "nonsense"),
        (["check"], "JOB"),
        (["check", "job.cnc", "other.cnc", "--call", "one"], "--call"),
        (["check", "job.cnc", "--nonsense"], "--nonsense"),
        (["check", "job.cnc", "--machine"], "--machine"),
        (["check", "job.cnc", "--format", "yaml"], "yaml"),
        (["check", "job.cnc", "--dialect", "fanuc"], "fanuc"),
        (["check", "job.cnc", "--max-blocks", "0"], "--max-blocks"),
        (["check", "job.cnc", "--max-blocks", "many"], "many"),
        (["dump", "job.cnc"], "--stage"),
        (["dump", "job.cnc", "--stage", "nonsense"], "nonsense"),
        (["dump", "job.cnc", "--stage", "plan", "--format", "jsonl"], "jsonl"),
        (["compile", "job.cnc"], "--output"),
        (["compile", "job.cnc", "-o", "x.gpx", "--unsigned", "--key", "k.pem"], "--key"),
        (["verify"], "PACKAGE"),
        (["verify", "nothere.gpx"], "no such file"),
        (["verify", "."], "is a folder"),
        (["verify", "job.cnc", "--trust", "nothere.pem"], "nothere.pem"),
        (["verify", "job.cnc", "--machine", "nothere.toml"], "nothere.toml"),
        (["run", "job.cnc"], "--board"),
        (["run", "job.cnc", "--board", "mill"], "mill"),
        (["run", "nothere.gpx", "--board", "virtual"], "no such file"),
        (["run", "job.cnc", "--board", "virtual", "--override", "0"], "--override"),
        (["run", "job.cnc", "--board", "virtual", "--hold-at", "-1"], "--hold-at"),
        (["run", "job.cnc", "--board", "virtual", "--hold-at", "soon"], "soon"),
        (["run", "job.cnc", "--board", "virtual", "--hold-at", "nan"], "'nan' is not a finite number"),
        (["run", "job.cnc", "--board", "virtual", "--estop-at", "inf"], "'inf' is not a finite number"),
        (["run", "job.cnc", "--board", "virtual", "--override", "nan"], "'nan' is not a finite number"),
        (["verify", "job.cnc", "--trust", "."], "trusted key .: is a folder, not a file"),
        (["compile", "job.cnc", "-o", "x.gpx", "--key", "."], "key .: is a folder, not a file"),
        (["compile", "job.cnc", "-o", "x.gpx", "--key", "nothere.pem"], "key nothere.pem: no such file"),
        (["explain"], "CODE"),
        (["explain", "GP999"], "GP999"),
        (["explain", "GP305"], "GP305 [offset-box] is retired"),
        (["explain", "jump-target"], "GP143"),
        (["explain", "GP1"], "GP1"),
        (["explain", "0"], "'0'"),
        (["explain", ""], "''"),
        (["explain", "../GP301"], "GP301"),
        (["explain", "GP301 GP302"], "GP301 GP302"),
        (["explain", "sof-limit"], "did you mean soft-limit (GP301)"),
        (["explain", "arc radius"], "arc-radius-mismatch (GP401)"),
        (["explain", "GP399"], "this group has GP301 to"),
    ],
    ids=" ".join,
)
def test_arguments_that_make_no_sense(words: list[str], what: str, folder: Path, gproof: Run) -> None:
    refused(gproof(*words), what)


def test_the_list_of_commands_is_not_cut_short(gproof: Run) -> None:
    commands = gproof("--help").out.partition("Commands:")[2]
    assert "  fmt " in commands
    assert "..." not in commands


def test_no_arguments_show_the_help(gproof: Run) -> None:
    done = gproof()
    assert done.exit == 3
    assert done.err.startswith("Usage: gproof ")
    for words in (["--help"], ["check", "--help"], ["explain", "-h"], ["--version"]):
        done = gproof(*words)
        assert (done.exit, done.err) == (0, "")


@pytest.mark.parametrize(
    "text", ["GP301", "gp301", "301", "soft-limit", "Soft limit", "SOFT_LIMIT", " GP301 ", "GP0301"]
)
def test_a_code_in_any_spelling(text: str, gproof: Run) -> None:
    done = gproof("explain", text)
    assert (done.exit, done.out.splitlines()[0]) == (0, "# GP301 soft-limit")


# -- packages that are none

PACKAGES = [b"", b"PK\x03\x04", b"PK\x05\x06" + b"\0" * 18, b"\0" * 1000, JOB.encode()]


@pytest.mark.parametrize("data", PACKAGES)
def test_a_file_that_is_no_package(data: bytes, folder: Path, gproof: Run) -> None:
    (folder / "job.gpx").write_bytes(data)
    done = gproof("verify", "job.gpx")
    assert done.exit == 1
    assert re.match(r"job.gpx: error GP82[01] \[certificate-", done.out)
    assert done.out.endswith("job.gpx: UNSAFE\n")
    done = gproof("run", "job.gpx", "--board", "virtual")
    assert done.exit == 1
    assert "nothing was moved" in done.err


# -- outputs

WITH_MACHINE = ["--machine", "machine.toml", "--setup", "zero"]


def outputs(folder: Path, gproof: Run) -> list[tuple[Callable[[str], Done], str]]:
    """Every command that writes a file, as a function of the place, and what it calls the file."""
    made = gproof("compile", "job.cnc", *WITH_MACHINE, "--unsigned", "-o", "made.gpx")
    assert made.exit == 0, made
    return [
        (lambda place: gproof("check", "job.cnc", *WITH_MACHINE, "--picture", place), "picture"),
        (lambda place: gproof("compile", "job.cnc", *WITH_MACHINE, "--unsigned", "-o", place), "output"),
        (
            lambda place: gproof("run", "made.gpx", "--board", "virtual", "--allow-untrusted", "--record", place),
            "record",
        ),
    ]


def test_an_output_that_can_not_be_written(folder: Path, gproof: Run) -> None:
    (folder / "folder").mkdir()
    for write, what in outputs(folder, gproof):
        refused(write("missing/out"), f"{what} missing/out", "no such folder")
        refused(write("job.cnc/out"), "no such folder")
        refused(write("folder"), "is a folder")
        refused(write("."), "is a folder")
        refused(write("/dev/null"), "is not a regular file")
        refused(write("/proc/self/out"))
        refused(write(f"{'n' * 300}.out"))


def test_an_output_never_replaces_an_input(folder: Path, gproof: Run) -> None:
    (folder / "link.cnc").symlink_to("job.cnc")
    (folder / "hard.cnc").hardlink_to(folder / "job.cnc")
    write_picture, write_package, write_record = (write for write, _ in outputs(folder, gproof))
    for place in ("job.cnc", "./job.cnc", "link.cnc", "hard.cnc", "machine.toml"):
        refused(write_picture(place), "would overwrite an input")
        refused(write_package(place), "would overwrite an input")
    refused(write_record("made.gpx"), "would overwrite an input")


def test_an_output_replaces_an_older_one(folder: Path, gproof: Run) -> None:
    for write, what in outputs(folder, gproof):
        (folder / "out").write_text("old")
        if what == "record":  # of what was executed there is one only: it replaces nothing but a record, when asked to
            refused(write("out"), "is not an execution record; choose another name")
            continue
        assert write("out").exit == 0
        assert (folder / "out").read_bytes()[:3] != b"old"
        assert sorted(p.name for p in folder.iterdir() if "out" in p.name) == ["out"]


def test_a_failed_write_leaves_nothing(folder: Path, gproof: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """The disk is full at the last moment: the old file stays, no other remains. Records: `test_run.py`."""
    writers = [(write, what) for write, what in outputs(folder, gproof) if what != "record"]

    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    for write, _ in writers:
        (folder / "out").write_text("old")
        with monkeypatch.context() as patch:
            patch.setattr(os, "replace", full)
            patch.setattr(Path, "replace", full)
            refused(write("out"), "No space left on device")
        assert (folder / "out").read_text() == "old"


def test_a_job_that_is_not_safe_is_not_compiled(folder: Path, gproof: Run) -> None:
    for text, code in (("G21\nG0 X500\nM30\n", 1), ("G21\nG0 Y1\nM30\n", 2), ("G21 ???\n", 1), ("", 1)):
        (folder / "job.cnc").write_text(text)
        done = gproof("compile", "job.cnc", *WITH_MACHINE, "-o", "out.gpx")
        assert done.exit == code, done
        assert not (folder / "out.gpx").exists()
        assert "nothing was written" in done.err


# -- the outside world


def test_any_file_name_can_be_printed(folder: Path) -> None:
    """Whatever the terminal's encoding: one process for each, which checks one file after the other."""
    paths = []
    for name in (b"\xff\xe9.cnc", "ø “x”.cnc".encode(), b"a\nb.cnc", b"-job.cnc", b"%s {0}.cnc"):
        paths.append(os.path.join(os.fsencode(folder), name))
        with open(paths[-1], "wb") as file:
            file.write(JOB.encode())
    script = """
import os, sys
from gproof.cli.main import main
codes = [main(["check", os.fsdecode(path), *sys.argv[2:]]) for path in bytes.fromhex(sys.argv[1]).split(bytes(1))]
sys.exit(max(codes))
"""
    around = [b"\0".join(paths).hex(), *WITH_MACHINE]
    for encoding in ("utf-8", "ascii", "latin-1"):
        words = [*around, "--picture", "p.svg"]
        done = run_python("-c", script, *words, more={"PYTHONIOENCODING": encoding})
        assert (done.exit, done.err) == (0, ""), (encoding, done)
        assert done.out.count(": SAFE\n") == len(paths), (encoding, done)
    done = run_python("-c", script, *around, "--format", "json", more={"PYTHONIOENCODING": "utf-8"})
    reports = json.loads("[" + done.out.replace("}\n{", "},{") + "]")
    assert [report["verdict"] for report in reports] == ["SAFE"] * len(paths)
    done = run_process("check", os.fsdecode(paths[0]), *WITH_MACHINE, more={"PYTHONIOENCODING": "ascii"})
    assert (done.exit, done.err) == (0, "")


def test_a_reader_that_goes_away(folder: Path) -> None:
    (folder / "job.cnc").write_text("G21 G90 G1 F100 X1\n" + "X2\nX3\n" * 20_000 + "M30\n")
    command = [sys.executable, "-m", "gproof.cli.main", "dump", "job.cnc", *WITH_MACHINE, "--stage", "trace"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=folder) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.readline()
        process.stdout.close()
        assert process.stderr.read() == b""
        assert process.wait(60) == 3


STREAMS = {
    "check": "check job.cnc --machine machine.toml --setup zero",
    "a missing job": "check nothere.cnc",
    "dump": "dump job.cnc --stage trace",
    "compile": "compile job.cnc --machine machine.toml --setup zero --unsigned -o new.gpx",
    "run": "run made.gpx --board virtual --allow-untrusted",
    "standard input": "fmt -",
    "explain": "explain GP301",
}


@pytest.mark.parametrize("name", share(list(STREAMS), 4))
def test_streams_that_are_closed_or_full(name: str, folder: Path, gproof: Run) -> None:
    """No output is told with exit 3, never with the exit code of a verdict; a lost message changes nothing else."""
    assert gproof("compile", "job.cnc", *WITH_MACHINE, "--unsigned", "-o", "made.gpx").exit == 0

    def run(redirection: str) -> Done:
        command = f'"{sys.executable}" -m gproof.cli.main {STREAMS[name]} <job.cnc {redirection}'
        done = subprocess.run(["bash", "-c", command], cwd=folder, capture_output=True, text=True, check=False)
        out, err = (re.sub(r"run in .+ s", "run in no time", text) for text in (done.stdout, done.stderr))
        return Done(done.returncode, out, err)

    good = run("")
    fails = good.exit == 3
    full, closed = run(">/dev/full"), run(">&-")
    # Where the axes are is not lost with standard output.
    first = good.out if name == "run" else ""
    assert full == (good if fails else Done(3, "", f"{first}gproof: error: No space left on device\n"))
    assert closed == Done(3, "", "gproof: error: standard output is closed\n")
    assert run("2>/dev/full") == (Done(3, good.out, "") if good.err else good)
    assert run("2>&-") == Done(good.exit, good.out, "")
    assert run("<&- >&- 2>&-") == Done(3, "", "")
    missing = Done(3, "", "gproof: error: standard input is closed\n")
    assert run("<&-") == (missing if name == "standard input" else good)


@pytest.mark.parametrize(
    ("words", "where"),
    [
        (["check", "job.cnc"], "gproof.driver.conclude.judge"),
        (["dump", "job.cnc", "--stage", "trace"], "gproof.driver.running.execute"),
        (["compile", "job.cnc", *WITH_MACHINE, "--unsigned", "-o", "new.gpx"], "gproof.passes.motion.step.step"),
        (["compile", "job.cnc", *WITH_MACHINE, "--unsigned", "-o", "new.gpx"], "os.replace"),
        (["check", "job.cnc", "--picture", "new.svg"], "os.replace"),
        (["verify", "made.gpx"], "gproof.verify.certificate.check.check_package"),
        (["run", "made.gpx", "--board", "virtual", "--allow-untrusted", "--record", "new.json"], "os.replace"),
        (["fmt", "job.cnc"], "filecmp.cmp"),
        (["fmt", "job.cnc"], "os.replace"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else value,
)
def test_an_interrupt(words: list[str], where: str, folder: Path, gproof: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """Ctrl-C at any moment: exit 130, one line, and no file that is new or changed (the fixture compares)."""
    assert gproof("compile", "job.cnc", *WITH_MACHINE, "--unsigned", "-o", "made.gpx").exit == 0
    (folder / "job.cnc").write_text("g21   g90\ng0 x1\nm30\n")

    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(where, interrupted)
    done = gproof(*words)
    assert (done.exit, done.out, done.err) == (130, "", "gproof: interrupted\n")


def test_an_internal_error_is_no_verdict(folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch) -> None:
    def broken(*_: object, **__: object) -> None:
        raise ZeroDivisionError("of course")

    monkeypatch.delenv("GPROOF_TRACEBACK", raising=False)
    monkeypatch.setattr("gproof.driver.conclude.judge", broken)
    assert main(["check", "job.cnc"]) == 3
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.startswith("gproof: internal error: ZeroDivisionError: of course; please report it")
    assert len(captured.err.splitlines()) == 1


# -- exit code, verdict and format agree on every job


@pytest.mark.parametrize("options", [[], ["--strict"], ["--setup", "zero"], ["--machine", "machine.toml"],
                                     ["--machine", "machine.toml", "--setup", "zero"],
                                     ["--machine", "machine.toml", "--strict"]], ids=" ".join)  # fmt: skip
def test_exit_code_agrees_with_the_verdict(options: list[str], folder: Path, gproof: Run) -> None:
    for text in (
        JOB,
        "G21\nG0 X500\nM30\n",
        "G21\nG0 X[#1]\nM30\n",
        "G21\nG41 D1\nM30\n",
        "G0 X\n",
        "M30\n",
        "G21\n/G0 X1\n",
    ):
        (folder / "job.cnc").write_text(text)
        judged(gproof, "job.cnc", *options)
        for stage in ("program", "trace", "plan", "stream"):
            assert gproof("dump", "job.cnc", "--stage", stage, *[o for o in options if o != "--strict"]).exit in (
                0,
                1,
                2,
            )


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("check", "job.cnc", "--machine", "machine.toml", "--machine", "b.toml"), "as machine.toml and as b.toml"),
        (("check", "job.cnc", "--setup", "zero", "--setup", "setup.toml"), "given twice, as zero and as setup.toml"),
        (("compile", "job.cnc", "--machine", "a", "--machine", "b", "-o", "x.gpx"), "given twice, as a and as b"),
        (("dump", "job.cnc", "--stage", "trace", "--setup", "a", "--setup", "b"), "given twice, as a and as b"),
        (("fit", "job.cnc", "--machine", "machine.toml", "--setup", "a", "--setup", "b"), "given twice, as a and as b"),
        (("check", "job.cnc", "--policy", "a", "--policy", "b"), "given twice, as a and as b"),
        (("check", "job.cnc", "--baseline", "a", "--baseline", "b"), "given twice, as a and as b"),
        (("check", "job.cnc", "--machine", ""), "'--machine': the file name is empty"),
        (("check", "job.cnc", "--setup", ""), "'--setup': the file name is empty"),
        (("check", "job.cnc", "--output", ""), "'--output': the file name is empty"),
        (("fit", ""), "'JOB': the file name is empty"),
        (("check", "job.cnc", "--also", "gouge"), "Did you mean 'gouges'?"),
        (("check", "job.cnc", "--also", "feeds,,sense"), "'' is not one of 'feeds'"),
        (("check", "job.cnc", "--also", ""), "'' is not one of 'feeds'"),
        (("check", "job.cnc", "--jobs", "x"), "'x' is not a whole number."),
        (("run", "x.gpx", "--board", "virtual", "--override", "x"), "'x' is not a number."),
    ],
)  # fmt: skip
def test_what_decides_a_judgement_is_given_once_and_has_a_name(gproof: Run, words: tuple[str, ...], said: str) -> None:
    done = gproof(*words)
    assert (done.exit, done.out) == (3, "")
    assert ONE_LINE.match(done.err)
    assert said in done.err


def test_the_same_machine_twice_is_one(gproof: Run) -> None:
    """A hook's ``args`` and a command line may say the same."""
    done = gproof("check", "job.cnc", *("--machine", "machine.toml", "--setup", "zero") * 2)
    assert (done.exit, done.err) == (0, "")


@pytest.mark.parametrize("form", ["text", "json", "sarif", "junit", "github", "markdown"])
def test_a_name_that_is_no_utf_8_is_reported(gproof: Run, folder: Path, form: str) -> None:
    """Linux has names of any bytes; reports on standard output and in files say the same."""
    names = [os.fsdecode(name) for name in (b"b\xffd.cnc", b"m\xff.toml", b"s\xff.toml")]
    (folder / names[0]).write_text(JOB.replace("X1", "X1 Q5"))
    (folder / names[1]).write_text(MACHINE)
    (folder / names[2]).write_text('schema = "gproof-setup/1"\nstart = {x = 0.0}\n')
    words = ("check", names[0], "--machine", names[1], "--setup", names[2], "--format", form)
    done = gproof(*words)
    assert (done.exit, done.err) == (1, "")
    assert gproof(*words, "--output", "report").exit == 1
    said = done.out.encode("utf-8", "backslashreplace")
    assert (folder / "report").read_bytes() == said
    assert {"sarif": b"b%FFd.cnc", "junit": "b\ufffdd.cnc".encode()}.get(form, b"b\\udcffd.cnc") in said
    assert gproof(*words, "--write-baseline", "known").exit == 0
    assert gproof(*words, "--baseline", "known").exit == 0


def test_a_certificate_names_no_file_that_is_no_utf_8(gproof: Run, folder: Path) -> None:
    name = os.fsdecode(b"b\xffd.cnc")
    (folder / name).write_text(JOB)
    done = gproof("compile", name, "--machine", "machine.toml", "--setup", "zero", "-o", "x.gpx", "--unsigned")
    refused(done, "the file name is not UTF-8")


@pytest.mark.parametrize("name", ["a\nb.cnc", "a\x1b[31mb.cnc", "a\rb.cnc", "a\u2028b.cnc"])
def test_a_name_writes_no_line_of_its_own(gproof: Run, folder: Path, name: str) -> None:
    """``x.cnc: SAFE`` as part of a name is no verdict, and no name changes the colour of a terminal."""
    shown = name.replace("\n", r"\x0a").replace("\x1b", r"\x1b").replace("\r", r"\x0d").replace("\u2028", r"\u2028")
    (folder / name).write_text(JOB.replace("X1", "X1 Q5"))
    words = ("--machine", "machine.toml", "--setup", "zero")
    done = gproof("check", f"./{name}", *words)
    assert f"{shown}: UNSAFE\n" in done.out
    assert f"{shown}:2:7: error GP121" in done.out
    assert gproof("check", f"./{name}", "--quiet", *words).out == f"{shown}: UNSAFE\n"
    assert gproof("fit", f"./{name}", *words).out.count(f"{shown}: UNSAFE") == 1
    refused(gproof("check", "job.cnc", "--machine", name + ".toml"), shown)
    (folder / name).unlink()
    refused(gproof("fit", name, *words), shown)
