"""Progress from one second on, on a terminal only; Ctrl-C is exit 130, one line, no file."""

from __future__ import annotations

import contextlib
import os
import pty
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from gproof.cli import progress as p
from gproof.cli.main import main

MACHINE = (
    'schema = "gproof-machine/1"\nunits = "mm"\n[controller]\ndialect = "eding"\n'
    + "".join(
        f"[axes.{axis}]\nsteps_per_unit = 320\nmin = -100.0\nmax = 300.0\n"
        "max_velocity = 100.0\nmax_acceleration = 500.0\n"
        for axis in "xyz"
    )
    + "[board]\ntick_frequency = 16000000\nstep_pulse = 2e-6\ndirection_setup = 5e-6\n"
)
JOB = "G21 G90 G94 G17 G40 G49 G54\nF600\nG1 X10\nG1 X0\nM30\n"
ENDLESS = "G21 G90 G94 G17 G40 G49 G54\n#1=0\nwhile [#1 >= 0]\n#1=[#1+1]\nG0 X[#1*#1/[#1*#1+1]]\nendwhile\nM30\n"
START = (
    "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler); "
    "from gproof.cli.main import main; sys.exit(main())"
)
"""As from a shell: what runs in the background is born deaf to Ctrl-C."""
COMMANDS = [
    ["check", "job.cnc", "--machine", "m.toml", "--setup", "zero"],
    ["check", "job.cnc", "job.cnc", "--machine", "m.toml", "--setup", "zero"],
    ["fit", "job.cnc", "--machine", "m.toml"],
    ["compile", "job.cnc", "--machine", "m.toml", "--setup", "zero", "--unsigned", "-o", "job.gpx"],
    ["verify", "job.gpx"],
]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "m.toml").write_text(MACHINE)
    (tmp_path / "job.cnc").write_text(JOB)
    (tmp_path / "endless.cnc").write_text(ENDLESS)
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("CI", raising=False)
    return tmp_path


@pytest.mark.parametrize("words", COMMANDS, ids=" ".join)
def test_there_is_a_bar_on_a_terminal_only(
    words: list[str], folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """What is printed is the same with a bar and without."""
    assert main(COMMANDS[3]) == 0
    capsys.readouterr()
    started: list[str] = []
    show = p.Progress._show

    def remember(self: p.Progress) -> None:
        started.append(self._state["description"])
        show(self)

    monkeypatch.setattr(p, "AFTER", 0.0)
    monkeypatch.setattr(p.Progress, "_show", remember)
    quiet = main(words), capsys.readouterr()
    assert started == []
    monkeypatch.setattr("sys.stderr.isatty", lambda: True, raising=False)
    loud = main(words), capsys.readouterr()
    assert started
    assert (loud[0], loud[1].out) == (quiet[0], quiet[1].out)


def run_on_a_terminal(words: list[str], folder: Path, seconds: float) -> tuple[int, str]:
    """Exit code and standard error of a command whose terminal sends Ctrl-C after a time and once a bar is up."""
    near, far = pty.openpty()
    process = subprocess.Popen(
        [sys.executable, "-c", START, *words], cwd=folder, stdout=subprocess.DEVNULL, stderr=far,
        env={**os.environ, "TERM": "xterm"},
    )  # fmt: skip
    os.close(far)
    os.set_blocking(near, False)
    said, until = b"", time.monotonic() + seconds
    asked = False
    while process.poll() is None:
        if time.monotonic() > until + 120.0:
            process.kill()
        if not asked and time.monotonic() > until + (0.0 if b"checking" in said else 60.0):
            asked = True
            process.send_signal(signal.SIGINT)
        time.sleep(0.05)
        try:
            said += os.read(near, 1 << 16)
        except (BlockingIOError, OSError):
            continue
    with contextlib.suppress(OSError):
        said += os.read(near, 1 << 16)
    os.close(near)
    return process.returncode, said.decode("utf-8", "replace")


@pytest.mark.parametrize("words", [COMMANDS[0], COMMANDS[3]], ids=" ".join)
def test_an_endless_job_shows_how_far_it_is_and_ends_by_an_interrupt(words: list[str], folder: Path) -> None:
    words = [word.replace("job.cnc", "endless.cnc") for word in words] + ["--max-blocks", "100000000"]
    code, said = run_on_a_terminal(words, folder, 2.5)
    assert code == 130, said
    assert "checking" in said
    assert said.rstrip().endswith("gproof: interrupted")
    assert "Traceback" not in said
    assert sorted(path.name for path in folder.iterdir()) == ["endless.cnc", "job.cnc", "m.toml"]
