"""Packages that a board must not run: on a port each is refused, and the board's own log has no step."""

from __future__ import annotations

import random
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from cli.packages import Shop, resigned
from cli.test_run_on_ports import JOB, MACHINE
from support.campaigns import SOAK
from support.each import each

from gproof.backend.boards.emulator.log_reader import read

HAND = ("--machine", "machine.toml", "--setup", "zero")
EMULATOR = [sys.executable, "-m", "gproof.backend.boards.emulator", "--stay"]


class Bench:
    """A shop, and a board on a port that keeps a log."""

    def __init__(self, folder: Path, use: Callable[[str, str], None]) -> None:
        self.shop = Shop(folder, use)
        (folder / "machine.toml").write_text(MACHINE)
        (folder / "job.cnc").write_text(JOB)
        self.whole = self.shop.compile().read_bytes()
        self.log = folder / "log"
        self.process = subprocess.Popen([*EMULATOR, "--log", str(self.log)], stdout=subprocess.PIPE, text=True)
        assert self.process.stdout is not None
        self.port = self.process.stdout.readline().removeprefix("port: ").strip()

    def run(self, package: str, *words: str) -> tuple[int, str]:
        at_hand = words if "--machine" in words else (*HAND, *words)
        done = self.shop("run", package, "--board", "klipper", "--port", self.port, *at_hand)
        return done.exit, done.out + done.err

    def end(self) -> int:
        """Steps that the board has made."""
        self.process.terminate()
        self.process.communicate()
        return len(read(self.log).steps.tick)


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Bench]:
    with pytest.MonkeyPatch.context() as patch:
        bench = Bench(tmp_path_factory.mktemp("bench"), patch.setenv)
        yield bench
        if bench.process.poll() is None:
            bench.end()


Case = Callable[[Bench], tuple[int, str]]


def unsigned(bench: Bench) -> tuple[int, str]:
    bench.shop.compile("--unsigned", output="unsigned.gpx")
    return bench.run("unsigned.gpx")


def of_a_stranger(bench: Bench) -> tuple[int, str]:
    private, _ = bench.shop.key("stranger")
    bench.shop.compile("--key", str(private), output="strange.gpx")
    return bench.run("strange.gpx")


def of_a_revoked_key(bench: Bench) -> tuple[int, str]:
    private, public = bench.shop.key("late")
    bench.shop.compile("--key", str(private), output="late.gpx")
    assert bench.shop("keys", "trust", public.name).exit == 0
    assert bench.shop("keys", "revoke", "late").exit == 0
    return bench.run("late.gpx")


def of_an_expired_key(bench: Bench) -> tuple[int, str]:
    private, public = bench.shop.key("old")
    bench.shop.compile("--key", str(private), output="old.gpx")
    public.write_text(f"expires: {bench.shop.day(-1)}\n{public.read_text()}")
    return bench.run("old.gpx", "--trust", public.name)


def of_another_machine(bench: Bench) -> tuple[int, str]:
    (bench.shop.folder / "other.toml").write_text(MACHINE.replace("max_velocity = 10\n", "max_velocity = 9\n"))
    return bench.run("made.gpx", "--machine", "other.toml", "--setup", "zero")


def of_other_pins(bench: Bench) -> tuple[int, str]:
    swapped = MACHINE.replace('"PA0"', '"PA9"').replace('"PA2"', '"PA0"').replace('"PA9"', '"PA2"')
    (bench.shop.folder / "swapped.toml").write_text(swapped.replace("PA9", "PA7"))
    return bench.run("made.gpx", "--machine", "swapped.toml", "--setup", "zero")


def of_another_board(bench: Bench) -> tuple[int, str]:
    """Compiled for one that the wiring does not name."""
    text = MACHINE.replace('name = "klipper"\n', 'name = "apci"\n')
    (bench.shop.folder / "apci.toml").write_text(text)
    words = ("--machine", "apci.toml", "--setup", "zero")
    assert bench.shop("compile", "job.cnc", *words, "-o", "apci.gpx").exit == 0
    return bench.run("apci.gpx", *words)


def of_another_clock(bench: Bench) -> tuple[int, str]:
    (bench.shop.folder / "fast.toml").write_text(MACHINE.replace("[board]\n", "[board]\ntick_frequency = 20000000\n"))
    words = ("--machine", "fast.toml", "--setup", "zero")
    assert bench.shop("compile", "job.cnc", *words, "-o", "fast.gpx").exit == 0
    return bench.run("fast.gpx", *words)


def of_other_offsets(bench: Bench) -> tuple[int, str]:
    setup = 'schema = "gproof-setup/1"\nunits = "mm"\nhomed = ["x", "y"]\n[start]\nx = 0\ny = 0\n[work.1]\nx = 5.0\n'
    (bench.shop.folder / "moved.toml").write_text(setup)
    return bench.run("made.gpx", "--machine", "machine.toml", "--setup", "moved.toml")


def of_a_newer_version(bench: Bench) -> tuple[int, str]:
    private, public = bench.shop.key("future")
    path = bench.shop.folder / "newer.gpx"
    path.write_bytes(bench.whole)
    resigned(path, private, lambda body: body.update(format="gproof-certificate/99"))
    return bench.run("newer.gpx", "--trust", public.name)


CASES: dict[str, tuple[Case, int, str]] = {
    "unsigned": (unsigned, 2, "GP827"),
    "a stranger": (of_a_stranger, 2, "GP827"),
    "a revoked key": (of_a_revoked_key, 1, "GP828"),
    "an expired key": (of_an_expired_key, 2, "which expired on"),
    "another machine": (of_another_machine, 1, "GP823"),
    "other pins": (of_other_pins, 1, "GP823"),
    "another board": (of_another_board, 1, "GP823"),
    "another clock": (of_another_clock, 3, "ticks a second"),
    "other offsets": (of_other_offsets, 1, "GP825"),
    "a newer version": (of_a_newer_version, 2, "GP857"),
}


@each("case", list(CASES))
def test_each_is_refused(case: str, bench: Bench) -> None:
    make, code, said = CASES[case]
    found, text = make(bench)
    assert (found, said in text, "nothing was moved" in text) == (code, True, True), text


def test_no_byte_of_a_package_may_change(bench: Bench) -> None:
    rng = random.Random(21)
    for at in rng.sample(range(len(bench.whole)), 200 if SOAK else 12):
        spoilt = bytearray(bench.whole)
        spoilt[at] ^= 1 << rng.randrange(8)
        (bench.shop.folder / "spoilt.gpx").write_bytes(spoilt)
        code, text = bench.run("spoilt.gpx")
        assert code in (1, 2, 3) and "nothing was moved" in text, (at, text)


def test_the_board_has_made_no_step(bench: Bench) -> None:
    """The last of this file: what the board itself has written down."""
    assert bench.end() == 0
