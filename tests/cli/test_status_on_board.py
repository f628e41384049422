"""A run that is killed (SIGKILL) in real time on a board on a port: `gproof status`, judged by the board's own log."""

from __future__ import annotations

import json
import random
import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from cli.packages import Shop
from cli.test_run_on_ports import MACHINE, emulator
from support.campaigns import sizes
from support.command import COMMAND

from gproof.backend.boards.emulator.log_reader import read
from gproof.backend.journal import read_journal

JOB = "G21 G90\nG1 F600 X20\nG1 Y20 X40\nM30\n"
ON = ("--board", "klipper", "--machine", "machine.toml", "--setup", "zero", "--runs", "runs")


@pytest.fixture(scope="module")
def shop(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Shop]:
    with pytest.MonkeyPatch.context() as patch:
        shop = Shop(tmp_path_factory.mktemp("killed"), patch.setenv)
        (shop.folder / "machine.toml").write_text(MACHINE.replace("fifo_time = 2", "fifo_time = 0.4"))
        (shop.folder / "job.cnc").write_text(JOB)
        shop.compile()
        yield shop


def killed(shop: Shop, port: str, after: float) -> None:
    """A run that is killed so many seconds after it was first noted in motion."""
    words = [*COMMAND, "run", "made.gpx", *ON, "--port", port, "--after-interruption"]
    process = subprocess.Popen(
        words, cwd=shop.folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )  # fmt: skip
    until = time.monotonic() + 60
    while time.monotonic() < until and not any(
        b'"kind":"at"' in path.read_bytes() for path in (shop.folder / "runs").glob("*.journal")
    ):
        assert process.poll() is None
        time.sleep(0.01)
    time.sleep(after)
    process.send_signal(signal.SIGKILL)
    process.wait()


@pytest.mark.parametrize("many", sizes(1, 12))
def test_status_asks_the_board_and_says_what_it_made(many: int, shop: Shop) -> None:
    for seed in range(many):
        log = shop.folder / f"log{seed}"
        with emulator("--stay", "--log", str(log)) as port:
            killed(shop, port, random.Random(seed).uniform(0, 1.5))
            alone = shop("status", "--json", "--runs", "runs")
            asked = shop("status", "--json", "--runs", "runs", "--port", port)
        told = read(log)
        made = [len(told.steps.of(pin)[0]) for pin in (0, 2)]
        assert alone.exit == 2, alone
        run = json.loads(alone.out)["runs"][-1]
        assert run["state"] == "interrupted"
        for motor, count in zip(run["motors"], made, strict=True):
            assert motor["least"] <= count <= motor["most"], (seed, run, made)
        assert asked.exit == 0, (seed, asked)
        run = json.loads(asked.out)["runs"][-1]
        assert [(motor["least"], motor["most"]) for motor in run["motors"]] == [(n, n) for n in made], (seed, run)
        assert "their CRC-32 is that of the stream" in run["board_said"]
        assert run["section"]["proved"] is True
        # X and Y only go up, so that the position is the count.
        assert [motor["position"] for motor in run["motors"]] == made
        assert any("home the machine" in hint for hint in run["next"])
        assert 0 < sum(made) < 6000
        for path in (shop.folder / "runs").glob("*.journal"):
            Path(read_journal(path).field("mark")).unlink()
            path.unlink()


def test_a_record_of_a_board_that_counts_says_which_steps_are_proved(shop: Shop) -> None:
    (shop.folder / "small.cnc").write_text("G21 G90\nG1 F600 X1\nM30\n")
    assert shop("compile", "small.cnc", "--machine", "machine.toml", "--setup", "zero", "-o", "small.gpx").exit == 0
    for profile, word in (("certified", "proved"), ("plain", "acknowledged")):
        with emulator("--stay", "--profile", profile) as port:
            done = shop("run", "small.gpx", *ON, "--port", port, "--record", f"{profile}.json")
        assert done.exit == 0, done
        verified = shop("verify", f"{profile}.json", "--package", "small.gpx")
        assert verified.exit == 0, verified
        assert f"  {word:<12}100 steps in section 0: " in verified.out, verified.out
        assert ("CRC-32 are those of the stream" in verified.out) == (profile == "certified")
        status = shop("status", "--runs", "runs")
        assert status.exit == 0 and "motor X     100 steps, at step 100" in status.out, status.out
