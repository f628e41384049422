"""`gproof run` on boards with a port: the emulator that it starts itself, one on a port, ports that are no board."""

from __future__ import annotations

import json
import os
import pty
import random
import re
import select
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from cli.packages import Shop
from support.campaigns import seeds, share
from support.command import Done
from support.each import each

from gproof.backend.boards.klipper import connection

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


@pytest.fixture
def impatient(monkeypatch: pytest.MonkeyPatch) -> None:
    """Half a second of probes in place of three."""
    monkeypatch.setattr(connection, "PROBES", 5)


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


@pytest.mark.parametrize(
    ("board", "pin", "level"), [("pci7200", "P0S0", 0), ("eding-cpu", "STEP1", 1), ("apci8001", "STEP1", 1)]
)
def test_a_modelled_board_writes_its_pins(shop: Shop, board: str, pin: str, level: int) -> None:
    place = shop.folder / f"{board}.vcd"
    done = shop("run", "made.gpx", "--board", board, "--vcd", place.name, "--record", f"{board}.json")
    assert done.exit == 0, done
    told = json.loads((shop.folder / f"{board}.json").read_text())
    assert (told["board"]["name"], told["steps"], told["position"]) == (board, [150, 50], [50, 50])
    name = re.search(rf"\$var wire 1 (\S+) {pin} ", place.read_text()).group(1)
    changes = place.read_text().split("$dumpvars", 1)[1].split("$end", 1)[1].splitlines()
    assert changes.count(f"{level}{name}") == 150


def test_where_pins_cannot_be_written(shop: Shop) -> None:
    for words, why in (
        (("virtual", "--vcd", "a.vcd"), "--vcd is for modelled boards (pci7200, eding-cpu, apci8001)"),
        (("pci7200", "--vcd", "nowhere/a.vcd"), "no such folder"),
        (("pci7200", "--vcd", "made.gpx"), "would overwrite an input"),
        (("pci7200", "--machine", "machine.toml", "--vcd", "machine.toml"), "would overwrite an input"),
        (("pci7200", "--source", "job.cnc", "--vcd", "job.cnc"), "would overwrite an input"),
        (("pci7200", "--vcd", "job.cnc"), "is not a waveform of gproof"),
        (("pci7200", "--vcd", "new.json", "--record", "./new.json"), "the same file as --record"),
        (("apci8001", "--port", "COM3"), "--port is for boards on a port"),
    ):
        done = shop("run", "made.gpx", "--board", *words)
        assert (done.exit, done.err.count("\n")) == (3, 1) and why in done.err, done


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
        ((*HAND, "--allow-untrusted"), "works with --board apci8001, eding-cpu, emulator, pci7200, virtual only"),
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


@pytest.mark.usefixtures("impatient")
def test_ports_that_are_no_board(shop: Shop, port: str, tmp_path: Path) -> None:
    assert on(shop, "").err == "gproof: error: --port is empty\n"
    refused(on(shop, "/dev/not-there"), "/dev/not-there: there is no such port")
    refused(on(shop, "socket://127.0.0.1:1"), "it cannot be opened")
    spy = f"spy:///dev/null?file={tmp_path / 'written'}"
    for address in ("nonsense://x", "loop://", spy):
        refused(on(shop, address), f"{address}: not a port; an address starts with socket:// or rfc2217://")
    for address in (
        "socket://",
        "socket://localhost",
        "socket://:5",
        "socket://a:0",
        "rfc2217://a:99999",
        "socket://[:5",
    ):
        refused(on(shop, address), f"{address}: the address has no port number from 1 to 65535")
    assert not (tmp_path / "written").exists()
    refused(on(shop, str(tmp_path)), f"{tmp_path}: it is not a serial port")
    plain = tmp_path / "plain"
    plain.write_text("no port")
    refused(on(shop, str(plain)), "plain: it is not a serial port")
    refused(on(shop, port, "--baud", "115200"), "at another baud rate")


@pytest.mark.usefixtures("impatient")
def test_a_port_that_nobody_answers_at(shop: Shop) -> None:
    master, slave = pty.openpty()
    try:
        refused(on(shop, os.ttyname(slave)), "no board found: nobody answers")
    finally:
        os.close(master)
        os.close(slave)


@pytest.mark.usefixtures("impatient")
def test_a_device_that_is_no_board(shop: Shop) -> None:
    """A controller with another language answers each line, whatever it is."""
    master, slave = pty.openpty()
    over = threading.Event()

    def answer() -> None:
        while not over.is_set():
            if select.select([master], [], [], 0.02)[0] and os.read(master, 4096):
                os.write(master, b"error:1\r\nok\r\n")

    thread = threading.Thread(target=answer)
    thread.start()
    try:
        refused(on(shop, os.ttyname(slave)), "what answers does not speak Klipper's protocol, or at another baud rate")
    finally:
        over.set()
        thread.join()
        os.close(master)
        os.close(slave)


def test_switches_that_nobody_reads_are_said(shop: Shop, port: str) -> None:
    text = MACHINE.replace("[board.motors.y]", 'limit = "^PB4"\n[board.motors.y]').replace(
        'name = "klipper"\n', 'name = "klipper"\nprobe = "PB5"\n'
    )
    (shop.folder / "switches.toml").write_text(text)
    done = shop(
        "run", "made.gpx", "--board", "klipper", "--port", port, "--machine", "switches.toml", "--setup", "zero"
    )
    assert done.exit == 1 and "GP823" in done.out, "another wiring is another machine"
    assert done.err.splitlines()[0] == (
        "gproof: warning: limit switches (X) and the probe of the machine file: not read while a job runs; "
        "they have to act without gproof"
    )


def test_a_port_without_permission(shop: Shop, monkeypatch: pytest.MonkeyPatch) -> None:
    """Not by the file's mode: root may do everything."""
    import errno

    import serial

    def denied(*_: object, **__: object) -> None:
        raise serial.SerialException(errno.EACCES, "could not open port /dev/ttyACM0: [Errno 13] Permission denied")

    monkeypatch.setattr(serial, "serial_for_url", denied)
    refused(
        on(shop, "/dev/ttyACM0"), "/dev/ttyACM0: no permission to open it (on Linux the user has to be in the group"
    )


def test_a_port_that_another_program_uses(shop: Shop, port: str) -> None:
    import fcntl

    handle = os.open(port, os.O_RDWR | os.O_NOCTTY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX)
        refused(on(shop, port), "another program uses it")
    finally:
        os.close(handle)


LONG = "G21 G90\nG1 F600 X60\nG1 X0\nM30\n"
"""Twelve seconds."""

START = (
    "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler); "
    "from gproof.cli.main import main; sys.exit(main())"
)
"""As from a shell: what runs in the background is born deaf to Ctrl-C."""


@pytest.fixture(scope="module")
def long(shop: Shop) -> Shop:
    (shop.folder / "long.cnc").write_text(LONG)
    made = shop("compile", "long.cnc", "--machine", "machine.toml", "--setup", "zero", "-o", "long.gpx")
    assert made.exit == 0, made
    return shop


@contextmanager
def running(
    shop: Shop, name: str, *words: str, package: str = "long.gpx", answers: int = subprocess.DEVNULL
) -> Iterator[subprocess.Popen[str]]:
    """A run in a process of its own, without a terminal: whom it asks gives no answer, unless ``answers`` is a pipe."""
    runs = shop.folder / f"runs-{name}"
    process = subprocess.Popen(
        [sys.executable, "-c", START, "run", package, *words, "--runs", str(runs), "--progress", "jsonl"],
        cwd=shop.folder, stdin=answers, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    try:
        yield process
    finally:
        process.kill()
        process.communicate()


def until(process: subprocess.Popen[str], kind: str, moved: int = 0) -> dict[str, Any]:
    """Read its progress up to a line of a kind, with so many steps made."""
    assert process.stderr is not None
    for line in process.stderr:
        told: dict[str, Any] = json.loads(line) if line.startswith("{") else {}
        if told.get("kind") == kind and (kind != "at" or told["steps"]["X"] >= moved):
            return told
    raise AssertionError(f"it ended before {kind}")


def record_of(shop: Shop, name: str) -> dict[str, Any]:
    (path,) = (shop.folder / f"runs-{name}").glob("*.record.json")
    told: dict[str, Any] = json.loads(path.read_text())
    return told


SIGNALS = {
    # name, signal, what the run is doing, what the record says
    "hold": ([signal.SIGINT], "at", "stopped"),
    "stop": ([signal.SIGINT, signal.SIGINT], "at", "emergency-stop"),
    "term": ([signal.SIGTERM], "at", "emergency-stop"),
    "opening": ([signal.SIGINT], "start", "stopped"),
}


@pytest.mark.parametrize("name", share(list(SIGNALS), 2))
def test_a_signal_ends_it_at_rest_with_a_record(name: str, long: Shop) -> None:
    """On the emulator, whose process does not hear the terminal's Ctrl-C and is gone with the run."""
    signals, moment, result = SIGNALS[name]
    with running(long, name, "--board", "emulator") as process:
        until(process, moment, 100)
        while moment == "start" and not _emulators_of(process.pid):
            time.sleep(0.02)
        for number in signals:
            process.send_signal(number)
            time.sleep(0.05)
        out, err = process.communicate(timeout=30)
    assert process.returncode == 130, (out, err)
    told = record_of(long, name)
    assert told["result"] == result, told
    assert told["position"] is not None and told["position"][0] == told["steps"][0] < 6000
    if moment == "start":
        assert told["steps"] == [0, 0] and told["sections"] == []
    assert "long.gpx: " in out and f'"result":"{result}"' in err
    assert _emulators_of(process.pid) == []


def test_a_feed_hold_goes_on_when_the_operator_says_so(long: Shop) -> None:
    (long.folder / "wait.cnc").write_text("G21 G90\nG1 F600 X8\nM8\nG1 X0\nM30\n")
    made = long("compile", "wait.cnc", "--machine", "machine.toml", "--setup", "zero", "-o", "wait.gpx")
    assert made.exit == 0, made
    words = ("--board", "emulator", "--ask")
    with running(long, "answered", *words, package="wait.gpx", answers=subprocess.PIPE) as process:
        assert process.stdin is not None
        until(process, "at", 100)
        process.send_signal(signal.SIGINT)
        # The way of the axis may end before the hold does: then it holds where it rests for M8.
        assert until(process, "hold")["section"] == 0
        print("", file=process.stdin, flush=True)
        asked = until(process, "wait")
        assert (asked["line"], asked["text"]) == (3, "mist: off; flood: on")
        print("", file=process.stdin, flush=True)
        until(process, "wait")
        print("", file=process.stdin, flush=True)
        out, err = process.communicate(timeout=30)
    assert process.returncode == 0, (out, err)
    told = record_of(long, "answered")
    assert (told["result"], told["position"], told["steps"]) == ("completed", [0, 0], [1600, 0])


def test_a_signal_while_the_operator_is_asked_ends_it_there(long: Shop) -> None:
    words = ("--board", "emulator", "--ask")
    with running(long, "asked", *words, package="wait.gpx", answers=subprocess.PIPE) as process:
        until(process, "wait")
        time.sleep(0.2)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=30)
    assert process.returncode == 130, (out, err)
    told = record_of(long, "asked")
    assert (told["result"], told["position"], told["steps"]) == ("stopped", [800, 0], [800, 0])


@pytest.mark.parametrize("seed", seeds(1, 40))
def test_signals_at_any_moment(seed: int, long: Shop) -> None:
    """It ends at rest: with a record that knows the position, or before anything was opened and without one."""
    rng = random.Random(seed)
    numbers = [rng.choice([signal.SIGINT, signal.SIGINT, signal.SIGTERM]) for _ in range(rng.randint(1, 3))]
    name = f"any-{seed}"
    with running(long, name, "--board", "emulator") as process:
        time.sleep(rng.uniform(0.1, 5.0))
        for number in numbers:
            process.send_signal(number)
            time.sleep(rng.choice([0.0, 0.01, 0.3]))
        out, err = process.communicate(timeout=60)
    what = (seed, numbers, out, err)
    assert "Traceback" not in err and "internal error" not in err, what
    assert process.returncode in (130, *(-number for number in numbers)), what
    assert _emulators_of(process.pid) == []
    records = list((long.folder / f"runs-{name}").glob("*.record.json"))
    assert len(records) == ("long.gpx: " in out), what
    if records:
        told = json.loads(records[0].read_text())
        assert told["result"] in ("stopped", "emergency-stop"), what
        # It goes out 6000 steps and comes back.
        steps = told["steps"][0]
        assert told["position"] == [min(steps, 12_000 - steps), 0], what


def test_a_signal_before_the_board_is_opened_moves_nothing(long: Shop) -> None:
    with running(long, "early", "--board", "emulator") as process:
        # Python itself takes longer to start.
        time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=30)
    assert process.returncode in (130, -signal.SIGINT), (out, err)
    assert not list((long.folder / "runs-early").glob("*.record.json"))


def test_the_emulator_dies_with_a_host_that_is_killed(long: Shop) -> None:
    with running(long, "killed", "--board", "emulator") as process:
        until(process, "at", 100)
        (child,) = _emulators_of(process.pid)
        process.kill()
        process.wait()
        until_gone = time.monotonic() + 10
        while _is_there(child) and time.monotonic() < until_gone:
            time.sleep(0.05)
        assert not _is_there(child)


def test_two_hosts_on_one_port(long: Shop) -> None:
    with emulator() as port, running(long, "first", "--board", "klipper", "--port", port, *HAND) as process:
        until(process, "at", 100)
        # One of the same user's folder of runs, one that knows nothing of the first but the port.
        refused(on(long, port, "--runs", str(long.folder / "runs-first")), "another run is using it")
        refused(on(long, port, "--runs", str(long.folder / "runs-second")), f"{port}: another program uses it")
        probed = long("boards", "probe", port)
        assert (probed.exit, probed.err) == (3, f"gproof: error: {port}: another program uses it\n")
        assert process.poll() is None
        until(process, "at", 300)
        process.send_signal(signal.SIGTERM)
        out, err = process.communicate(timeout=30)
    assert process.returncode == 130, (out, err)
    assert record_of(long, "first")["position"] is not None


def test_a_port_that_vanishes_in_motion(long: Shop, tmp_path: Path) -> None:
    (tmp_path / "faults").write_text("motion+0.3 close 60\n")
    words = ("--faults", str(tmp_path / "faults"), "--log", str(tmp_path / "log"))
    with emulator(*words) as port, running(long, "gone", "--board", "klipper", "--port", port, *HAND) as process:
        out, err = process.communicate(timeout=60)
    assert process.returncode == 1, (out, err)
    told = record_of(long, "gone")
    assert told["result"] == "fault" and told["position"] is None
    from gproof.backend.boards.emulator.log_reader import read

    made = len(read(tmp_path / "log").steps.tick)
    # The board stops by itself when its promise ends: far before the 12,000 steps.
    assert 0 < made < 3000
    assert told["steps"][0] <= made


def _is_there(process: int) -> bool:
    return Path(f"/proc/{process}").exists() and "Z" not in Path(f"/proc/{process}/stat").read_text().split()[2:3]


def _emulators_of(parent: int) -> list[int]:
    found = subprocess.run(
        ["ps", "-o", "pid=,args=", "--ppid", str(parent)], capture_output=True, text=True, check=False
    )
    return [int(line.split()[0]) for line in found.stdout.splitlines() if "boards.emulator" in line]


def _children() -> list[str]:
    """Processes of the emulator that this one started and that are still there."""
    ps = ["ps", "-o", "args=", "--ppid", str(os.getpid())]
    found = subprocess.run(ps, capture_output=True, text=True, check=False)
    return [line for line in found.stdout.splitlines() if "boards.emulator" in line and "--stay" not in line]
