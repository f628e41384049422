"""The emulator as a process: ports, control channel, ends, wrong arguments. A process costs; so few are started."""

from __future__ import annotations

import ast
import json
import os
import select
import signal
import socket
import struct
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from gproof.backend.boards.emulator.__main__ import main
from gproof.backend.boards.emulator.control import Broken, Control, framed
from gproof.backend.boards.emulator.emulator import Emulator, Options
from gproof.backend.boards.emulator.log_reader import read
from gproof.backend.boards.emulator.wire import frame

ROOM = Path(sys.modules[main.__module__].__file__ or "").parent

IDENTIFY = bytes.fromhex("08 10 01 00 28 5e 9f 7e")
CLOCK = frame(1, b"\x03")
COMMAND = [sys.executable, "-m", "gproof.backend.boards.emulator"]
needs_terminal = pytest.mark.skipif(not hasattr(os, "openpty"), reason="no pseudo-terminals here")


@contextmanager
def started(*arguments: str) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """A process and the first address that it says."""
    with subprocess.Popen([*COMMAND, *arguments], stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            yield process, process.stdout.readline().partition(": ")[2].strip()
        finally:
            process.kill()


def received(number: int, count: int) -> bytes:
    """At least so many bytes of a descriptor, within seconds."""
    data, until = b"", time.monotonic() + 10
    while len(data) < count and time.monotonic() < until:
        if select.select([number], [], [], 0.1)[0]:
            data += os.read(number, 4096)
    return data


@needs_terminal
def test_a_terminal_answers_and_the_process_ends_with_its_host(tmp_path: Path) -> None:
    log, link = tmp_path / "log", tmp_path / "board"
    with started("--log", str(log), "--link", str(link), "--linger", "0.05") as (process, port):
        assert link.readlink() == Path(port)
        number = os.open(link, os.O_RDWR | os.O_NOCTTY)
        os.write(number, IDENTIFY)
        data = received(number, 53)
        # 40 bytes of data with their length, offset and number, and the acknowledgement.
        assert data[0] == 5 + 43 and data[1] == 0x11 and data[-5:] == frame(1)
        os.close(number)
        assert process.wait(10) == 0
    assert [event.kind for event in read(log).events] == ["B"]
    assert not link.is_symlink()


def test_a_tcp_port_takes_one_host_and_a_signal_ends_it() -> None:
    with started("--tcp", "--linger", "100") as (process, port):
        address = ("127.0.0.1", int(port.rpartition(":")[2]))
        assert port.startswith("socket://127.0.0.1:")
        with socket.create_connection(address) as one:
            one.sendall(IDENTIFY)
            assert len(received(one.fileno(), 53)) == 53
            with socket.create_connection(address) as two:
                two.settimeout(10)
                assert two.recv(1) == b""
            one.sendall(CLOCK)
            assert len(received(one.fileno(), 14)) >= 12
        # The next host finds the same board.
        with socket.create_connection(address) as again:
            again.sendall(frame(2, b"\x03"))
            assert received(again.fileno(), 12)[1] == 0x13
        process.send_signal(signal.SIGTERM)
        assert process.wait(10) == 0


def test_simulated_time_is_the_harness_s(tmp_path: Path) -> None:
    log = tmp_path / "log"
    with started("--simulated", "--linger", "0", "--log", str(log)) as (process, address):
        host, _, number = address.partition(":")
        with socket.create_connection((host, int(number))) as line:
            line.sendall(framed(b"W", IDENTIFY) + framed(b"R", struct.pack("<q", 10**12)))
            answer = received(line.fileno(), 5 + 8 + 48)
            assert answer[:1] == b"D"
            (now,) = struct.unpack_from("<q", answer, 5)
            # 8 bytes there and 48 back at 40 µs, whatever the world's clock says.
            assert now == 56 * 40_000 and answer[13] == 48
            line.sendall(framed(b"P", struct.pack("<q", 3600 * 10**9)) + framed(b"S"))
            answers = received(line.fileno(), 5 + 13 + 5 + 5)
            assert struct.unpack_from("<q", answers, 5) == (3600 * 10**9,)
            state = json.loads(answers[answers.index(b"{") :])
            assert state["tick"] == 3600 * 16_000_000 and state["boots"] == 1
        assert process.wait(10) == 0
    assert read(log).complete


def test_no_process_is_left_behind_when_its_parent_goes() -> None:
    code = (
        "import subprocess, sys\n"
        f"p = subprocess.Popen({COMMAND!r} + ['--tcp'], stdout=subprocess.PIPE)\n"
        "print(p.pid, p.stdout.readline().decode(), flush=True)"
    )
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    pid, port = int(told.split()[0]), int(told.rpartition(":")[2])
    until = time.monotonic() + 10
    while time.monotonic() < until:
        try:
            socket.create_connection(("127.0.0.1", port), 1).close()
        except OSError:
            return
        time.sleep(0.05)
    pytest.fail(f"process {pid} is still there")


def test_control_frames_that_are_none_end_nothing_but_the_connection() -> None:
    control = Control(Emulator(Options()), simulated=True)
    assert control.feed(framed(b"?"))[:1] == b"E"
    assert control.feed(framed(b"R", b"abc"))[:1] == b"E"
    assert control.feed(framed(b"R", struct.pack("<q", 2**62)))[:1] == b"E"
    assert control.feed(framed(b"F", b"explode"))[:1] == b"E"
    assert control.feed(framed(b"F", b"drop to-board 3"))[:1] == b"K"
    assert control.feed(framed(b"I", bytes((9, 1))))[:1] == b"K"
    # In pieces, and after the end nothing.
    asked = framed(b"S") + framed(b"Q")
    assert b"".join(control.feed(asked[k : k + 1]) for k in range(len(asked)))[:1] == b"S"
    assert control.ends and control.feed(framed(b"S")) == b""
    with pytest.raises(Broken):
        Control(Emulator(Options()), simulated=True).feed(b"W\xff\xff\xff\xff")
    # A link that is closed says so at once.
    control = Control(Emulator(Options()), simulated=True)
    control.feed(framed(b"F", b"close 1"))
    assert control.feed(framed(b"R", struct.pack("<q", 10**9))) == framed(b"L", struct.pack("<q", 0))
    assert control.feed(framed(b"P", struct.pack("<q", 10**9)))[:1] == b"D"


def test_wrong_arguments_are_one_line_and_exit_3(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    schedule = tmp_path / "faults"
    schedule.write_text("1 explode\n")
    link = tmp_path / "taken"
    link.touch()
    for arguments in (
        ["--nope"],
        ["--profile", "other"],
        ["--baud", "three"],
        ["--baud", "3"],
        ["--drift", "nan"],
        ["--noise", "drop=2"],
        ["--faults", str(tmp_path / "missing")],
        ["--faults", str(schedule)],
        ["--faults", str(tmp_path)],
        ["--log", str(tmp_path)],
        ["--switch", "PA0"],
        ["--switch", "PA9:PA0<=1"],
        ["--input", "PA0=2"],
        ["--without", "dance"],
        ["--tcp", "70000"],
        ["--link", str(link)],
    ):
        assert main(arguments) == 3, arguments
        told = capsys.readouterr()
        assert told.err.count("\n") == 1 and told.err.startswith("board emulator: "), arguments
        assert "Traceback" not in told.err


def test_it_imports_nothing_of_the_host() -> None:
    for path in ROOM.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            names = [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            names += [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            for name in names:
                own = name.startswith("gproof.backend.boards.emulator")
                assert own or name.partition(".")[0] in {*sys.stdlib_module_names, "numpy"}, (path.name, name)
