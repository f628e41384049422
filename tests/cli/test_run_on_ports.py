"""`gproof run` on boards with a port: the emulator that it starts itself, one on a port, ports that are no board."""

from __future__ import annotations

import json
import os
import pty
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from cli.packages import Shop
from support.command import Done
from support.each import each

EMULATOR = [sys.executable, "-m", "gproof.backend.boards.emulator"]
MACHINE = """schema = "gproof-machine/1"
units = "mm"
name = "table"
[axes.x]
min = 0
max = 100
steps_per_unit = 100
max_velocity = 10
max_acceleration = 100
[axes.y]
min = 0
max = 100
steps_per_unit = 100
max_velocity = 10
max_acceleration = 100
[controller]
dialect = "eding"
fifo_time = 2
[board]
name = "klipper"
[board.motors.x]
step = "PA0"
direction = "PA1"
enable = "!PA6"
[board.motors.y]
step = "PA2"
direction = "!PA3"
enable = "!PA6"
"""
JOB = "G21 G90\nG1 F600 X1\nG1 Y0.5 X0.5\nM30\n"
HAND = ("--machine", "machine.toml", "--setup", "zero")


@pytest.fixture(scope="module")
def shop(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Shop]:
    with pytest.MonkeyPatch.context() as patch:
        shop = Shop(tmp_path_factory.mktemp("ports"), patch.setenv)
        (shop.folder / "machine.toml").write_text(MACHINE)
        (shop.folder / "job.cnc").write_text(JOB)
        shop.compile()
        yield shop


@contextmanager
def emulator(*words: str) -> Iterator[str]:
    """A board on a port, as somebody else's program."""
    process = subprocess.Popen([*EMULATOR, *words], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    try:
        yield process.stdout.readline().removeprefix("port: ").strip()
    finally:
        process.terminate()
        process.wait(10)
        process.stdout.close()


@pytest.fixture(scope="module")
def port() -> Iterator[str]:
    with emulator("--stay") as name:
        yield name


def on(shop: Shop, port: str, *more: str) -> Done:
    return shop("run", "made.gpx", "--board", "klipper", "--port", port, *HAND, *more)


def refused(done: Done, why: str) -> None:
    assert done.exit == 3, done
    assert done.err.count("\n") == 1 and why in done.err and "nothing was moved" in done.err, done


def test_the_emulator_is_started_and_ended(shop: Shop) -> None:
    done = shop("run", "made.gpx", "--board", "emulator", "--record", "emulated.json")
    assert done.exit == 0, done
    told = json.loads((shop.folder / "emulated.json").read_text())
    assert (told["board"]["name"], told["position"]) == ("emulator", [50, 50])
    assert _children() == []


def test_a_board_on_a_port(shop: Shop, port: str) -> None:
    done = on(shop, port, "--record", "ported.json")
    assert done.exit == 0, done
    told = json.loads((shop.folder / "ported.json").read_text())
    assert (told["board"]["name"], told["steps"], told["position"]) == ("klipper", [150, 50], [50, 50])


def test_what_it_asks_for(shop: Shop, port: str) -> None:
    words = ("run", "made.gpx", "--board", "klipper", "--port", port)
    for more, why in (
        ((), "also needs --machine and --setup"),
        (("--machine", "machine.toml"), "also needs --setup"),
        ((*HAND, "--allow-untrusted"), "works with --board emulator and virtual only"),
    ):
        done = shop(*words, *more)
        assert (done.exit, done.err.count("\n")) == (3, 1) and why in done.err, done
    done = shop("run", "made.gpx", "--board", "klipper", *HAND)
    refused(done, "no port: give one with --port or as port under [board]")
    for board in ("virtual", "emulator"):
        done = shop("run", "made.gpx", "--board", board, "--port", port)
        assert done.exit == 3 and "--port is for boards on a port (klipper)" in done.err


def test_other_wiring_is_another_machine(shop: Shop, port: str) -> None:
    """Pins are part of what the package was made for; the port is not."""
    for name, text, code in (
        ("swapped.toml", MACHINE.replace("PA0", "PA9"), 1),
        ("turned.toml", MACHINE.replace('"!PA3"', '"PA3"'), 1),
        ("moved.toml", MACHINE.replace("[board]\n", '[board]\nport = "/dev/nowhere"\n'), 0),
    ):
        (shop.folder / name).write_text(text)
        done = shop("run", "made.gpx", "--board", "klipper", "--port", port, "--machine", name, "--setup", "zero")
        assert done.exit == code, done
        assert code == 0 or "with other settings than now" in done.out


def test_a_pin_that_the_board_does_not_have(shop: Shop) -> None:
    (shop.folder / "odd.toml").write_text(MACHINE.replace('"!PA3"', '"PK99"'))
    compiled = shop("compile", "job.cnc", "--machine", "odd.toml", "--setup", "zero", "-o", "odd.gpx")
    assert compiled.exit == 0, compiled
    words = ("--machine", "odd.toml", "--setup", "zero")
    with emulator() as fresh:
        done = shop("run", "odd.gpx", "--board", "klipper", "--port", fresh, *words)
    assert done.exit == 1, done
    told = done.out + done.err
    assert "odd.toml:27:1: error GP841" in told and "motors.y.direction: the board (atmega2560) has no pin PK99" in told
    # The emulator that gproof starts has pins of its own instead.
    assert shop("run", "odd.gpx", "--board", "emulator").exit == 0


NOT_A_BOARD = {
    "another clock": (
        ["--frequency", "20000000"],
        "counts 20000000 ticks a second, the machine file says 16",
    ),
    "a command is missing": (["--without", "reset_step_clock"], "the firmware has no command reset_step_clock"),
    "too few objects": (["--chip", "atmega328p"], "has no pin PA0"),
}


@each("case", list(NOT_A_BOARD))
def test_a_board_that_does_not_fit(case: str, shop: Shop) -> None:
    words, why = NOT_A_BOARD[case]
    with emulator(*words) as port:
        done = on(shop, port)
    assert why in done.err + done.out, done
    assert done.exit == (1 if "pin" in why else 3), done


def test_ports_that_are_no_board(shop: Shop, port: str, tmp_path: Path) -> None:
    refused(on(shop, "/dev/not-there"), "/dev/not-there: there is no such port")
    refused(on(shop, "socket://127.0.0.1:1"), "it cannot be opened")
    refused(on(shop, "nonsense://x"), "nonsense://x: ")
    refused(on(shop, str(tmp_path)), str(tmp_path))
    plain = tmp_path / "plain"
    plain.write_text("no port")
    refused(on(shop, str(plain)), "plain: ")
    refused(on(shop, port, "--baud", "115200"), "at another baud rate")


def test_a_port_that_nobody_answers_at(shop: Shop) -> None:
    master, slave = pty.openpty()
    try:
        refused(on(shop, os.ttyname(slave)), "no board found: nobody answers")
    finally:
        os.close(master)
        os.close(slave)


def test_a_port_that_another_program_uses(shop: Shop, port: str) -> None:
    import fcntl

    handle = os.open(port, os.O_RDWR | os.O_NOCTTY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX)
        refused(on(shop, port), "another program uses it")
    finally:
        os.close(handle)


def _children() -> list[str]:
    """Processes of the emulator that this one started and that are still there."""
    ps = ["ps", "-o", "args=", "--ppid", str(os.getpid())]
    found = subprocess.run(ps, capture_output=True, text=True, check=False)
    return [line for line in found.stdout.splitlines() if "boards.emulator" in line and "--stay" not in line]
