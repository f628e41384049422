"""`gproof status`: what was executed of a run that ended, was killed, or left a journal that somebody damaged.

The job moves X from 0 to 4 mm in one line and to 9 mm in the next, at 5 mm/s and 100 steps/mm: 400 and 500 steps.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from support.command import Done, in_this_process

from gproof.backend import journal as journals
from gproof.backend import runtime
from gproof.verify.certificate.keys import create_key

MACHINE = """schema = "gproof-machine/1"
units = "mm"
[axes.x]
min = 0
max = 100
steps_per_unit = 100
max_velocity = 10
max_acceleration = 1000
"""
JOB = "G21 G90 G61\nG1 F300 X4\nG1 X9\nM0\nG1 X0\nM30\n"


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A folder with a package and the journal of a run of it, noted every tenth of a second."""
    folder = tmp_path_factory.mktemp("status")
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(runtime, "NOTED", 0.1)
        patched.setenv("XDG_CONFIG_HOME", str(folder / "config"))
        (folder / "config" / "gproof").mkdir(parents=True, mode=0o700)
        create_key(folder / "config" / "gproof" / "signing-key.pem")
        (folder / "machine.toml").write_text(MACHINE)
        (folder / "job.cnc").write_text(JOB)
        words = ["compile", "job.cnc", "--machine", "machine.toml", "--setup", "zero", "-o", "job.gpx"]
        assert in_this_process(words, folder).exit == 0
        done = in_this_process(["run", "job.gpx", "--board", "virtual", "--runs", "runs"], folder)
        assert done.exit == 0, done.err
    return folder


@pytest.fixture
def shop(made: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    (tmp_path / "runs").mkdir()
    for path in (made / "runs").glob("*.ended"):
        (tmp_path / "runs" / path.name).write_bytes(path.read_bytes())
    return tmp_path


def journal(shop: Path, until: str, count: int = 1, tail: bytes = b"") -> Path:
    """The journal as it is when the run is killed after so many entries of a kind."""
    (ended,) = (shop / "runs").glob("*.ended")
    lines = ended.read_bytes().splitlines(keepends=True)
    kinds = [json.loads(line[65:])["kind"] for line in lines]
    stop = [k for k, kind in enumerate(kinds) if kind == until][count - 1] + 1
    path = ended.with_suffix(journals.SUFFIX)
    path.write_bytes(b"".join(lines[:stop]) + tail)
    ended.unlink()
    return path


def status(shop: Path, *more: str) -> Done:
    return in_this_process(["status", *more, "--runs", "runs"], shop)


def told(shop: Path, *more: str) -> tuple[int, dict[str, object]]:
    done = status(shop, "--json", *more)
    value = json.loads(done.out)
    assert value["schema"] == "gproof-status/1"
    (run,) = value["runs"]
    return done.exit, run


def test_a_run_that_ended(shop: Path) -> None:
    done = status(shop)
    assert (done.exit, done.err) == (0, "")
    for text in (": ended\n", "result      completed", "motor X     1800 steps, at step 0\n", "nothing is left to do"):
        assert text in done.out
    exit_, run = told(shop)
    assert (exit_, run["state"], run["exact"]) == (0, "ended", True)
    assert run["motors"] == [{"name": "X", "least": 1800, "most": 1800, "position": 0}]


def test_a_run_that_was_killed_in_a_section(shop: Path, made: Path) -> None:
    # Line 2 is 400 steps, so that whoever has made more is in line 3.
    (ended,) = (shop / "runs").glob("*.ended")
    entries = [json.loads(line[65:]) for line in ended.read_bytes().splitlines()]
    noted = [entry["steps"][0] for entry in entries if entry["kind"] == "at"]
    count = next(k for k, steps in enumerate(noted, start=1) if steps > 420)
    journal(shop, "at", count)
    exit_, run = told(shop)
    assert (exit_, run["state"], run["exact"], run["result"]) == (2, "interrupted", False, "interrupted")
    (motor,) = run["motors"]  # type: ignore[misc]
    assert (motor["least"], motor["most"], motor["position"]) == (noted[count - 1], 900, None)
    assert run["lines"]["from"] == {"file": "job.cnc", "line": 3}  # type: ignore[index]
    assert run["lines"]["to"]["line"] in (3, 4)  # type: ignore[index]
    done = status(shop)
    assert done.exit == 2
    assert f"motor X     {motor['least']} to 900 steps, position not known" in done.out
    assert "home the machine" in done.out
    # Without its package there is no upper end and no line; with another place of it both are there again.
    (made / "job.gpx").rename(made / "moved.gpx")
    try:
        exit_, run = told(shop)
        assert (exit_, run["lines"]) == (2, None)
        assert run["motors"][0]["most"] is None  # type: ignore[index]
        assert "bounds and program lines are missing" in run["unknown"][0]  # type: ignore[index]
        assert told(shop, "--package", str(made / "moved.gpx"))[1]["motors"][0]["most"] == 900  # type: ignore[index]
    finally:
        (made / "moved.gpx").rename(made / "job.gpx")


def test_a_run_that_was_killed_between_sections(shop: Path) -> None:
    journal(shop, "ended")
    exit_, run = told(shop)
    assert (exit_, run["exact"]) == (0, True)
    assert run["motors"] == [{"name": "X", "least": 900, "most": 900, "position": 900}]
    assert "--after-interruption" in status(shop).out


def test_before_anything_moved(shop: Path) -> None:
    path = journal(shop, "begin")
    exit_, run = told(shop)
    assert (exit_, run["motors"]) == (0, [{"name": "X", "least": 0, "most": 0, "position": 0}])
    path.write_bytes(path.read_bytes()[:40])
    exit_, run = told(shop)
    assert (exit_, run["state"]) == (0, "not-started")


def test_a_damaged_journal_is_told_from_a_short_one(shop: Path) -> None:
    path = journal(shop, "at", 3, tail=b"0123456789abcdef" * 4 + b' {"kind":"at","ti')
    assert told(shop)[1]["state"] == "interrupted"
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2] + b"?" + whole[len(whole) // 2 + 1 :])
    exit_, run = told(shop)
    assert (exit_, run["state"]) == (1, "damaged")
    assert run["damaged_line"] in range(2, 6)
    assert run["motors"][0]["position"] is None  # type: ignore[index]
    done = status(shop)
    assert done.exit == 1
    assert "of the journal does not fit" in done.out
    assert "home the machine, check tool and part" in done.out
    path.write_bytes(b"\n")
    assert told(shop)[0] == 1


def test_what_is_named(shop: Path, made: Path) -> None:
    path = journal(shop, "at", 2)
    for words in (("runs",), (str(path),), (str(made / "job.gpx"),), ()):
        assert told(shop, *words)[1]["state"] == "interrupted", words
    (shop / "text.cnc").write_text(JOB)
    (shop / "empty").mkdir()
    os.mkfifo(shop / "pipe.journal")
    for words, why in (
        (("missing",), "no such file or folder"),
        (("text.cnc",), "neither a folder of runs, nor a journal, nor a package"),
        (("pipe.journal",), "pipe.journal: is not a regular file"),
        (("empty",), "no run is noted in empty"),
        (("--port", "/dev/no-such-port"), "error: /dev/no-such-port: there is no such port"),
        (("--port", ""), "error: --port is empty"),
    ):
        done = status(shop, *words)
        assert (done.exit, done.out) == (3, ""), words
        assert why in done.err and done.err.count("\n") == 1, done.err


def test_a_run_that_goes_on_is_not_disturbed(shop: Path) -> None:
    path = journal(shop, "at", 2)
    (left,) = journals.left_open(path.parent, "virtual")
    assert told(shop)[1]["state"] == "running"
    assert "killed" not in status(shop).out
    left.let_go()
    assert told(shop)[1]["state"] == "interrupted"
    assert len(journals.left_open(path.parent, "virtual")) == 1
