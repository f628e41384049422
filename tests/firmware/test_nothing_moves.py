"""What is no right package for this machine, board and day moves no motor: on the emulator and on the firmware.

The judge is the board's own log, and the pins of the simulated chip.
"""

from __future__ import annotations

import datetime
import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import pytest
from backend.boards.emulator.emulated_line import EmulatedLine
from firmware.test_jobs_on_firmware import compiled, machine_text
from support.simulated_board import MISSING, Simulation
from support.simulated_line import Recorded, number_of
from verify.package_files import BODY, SIGNATURE, members_of, rebuilt

from gproof.backend.boards.board import BoardError
from gproof.backend.boards.emulator.emulator import Emulator, Options
from gproof.backend.boards.emulator.log_reader import read
from gproof.backend.boards.klipper.driver import KlipperBoard
from gproof.backend.boards.klipper.from_machine import ticks_of, wiring_of
from gproof.backend.boards.klipper.session import Session
from gproof.backend.job import RunRefused
from gproof.backend.record_data import ExecutionRecord, Result
from gproof.backend.runtime import run
from gproof.ir.machine import Machine
from gproof.ir.setup import Interval
from gproof.verify.certificate.keys import load_or_create_key, raw_public
from gproof.verify.certificate.package import CertificateError, Package, canonical, read_package
from gproof.verify.certificate.signers import Signer

PROGRAM = """\
G21 G90 G54 G17 G94
G0 X1 Y1
G1 X2 Y0 F600
M30
"""

DAY = datetime.timedelta(days=1)


@dataclass
class Given:
    """What a run is given: right as it is."""

    path: Path
    key: bytes
    machine: Machine
    more: dict[str, Any] = field(default_factory=dict)

    @property
    def package(self) -> Package:
        return read_package(self.path)


def changed_byte(given: Given, one_in: int) -> None:
    data = bytearray(given.path.read_bytes())
    data[len(data) * one_in // 20] ^= 1 << one_in % 8
    given.path.write_bytes(data)


def unsigned(given: Given) -> None:
    members = members_of(given.path)
    del members[SIGNATURE]
    rebuilt(given.path, members, rehash=False)


def newer(given: Given) -> None:
    members = members_of(given.path)
    body = json.loads(members[BODY])
    members[BODY] = canonical(body | {"format": "gproof-certificate/99"})
    rebuilt(given.path, members, rehash=False)


def other_limits(given: Given) -> None:
    axes = given.machine.axes
    given.more["machine"] = replace(given.machine, axes=(replace(axes[0], max_velocity=59.0), *axes[1:]))


def other_board(given: Given) -> None:
    board = given.machine.board
    turned = replace(board.motors[0], direction=replace(board.motors[0].direction, inverted=False))
    given.more["machine"] = replace(given.machine, board=replace(board, motors=(turned, *board.motors[1:])))


def other_offsets(given: Given) -> None:
    given.more["setup"] = replace(given.package.setup, work={(1, "x"): Interval(2.5, 2.5)})


def trusting(*signers: bytes | Signer) -> Callable[[Given], None]:
    return lambda given: given.more.update(trusted_keys=list(signers))


def of_the_key(**known: datetime.date) -> Callable[[Given], None]:
    return lambda given: given.more.update(trusted_keys=[Signer(raw=given.key, name="bench", **known)])


TODAY = datetime.datetime.now(datetime.UTC).date()
WRONG: dict[str, Callable[[Given], None]] = {
    **{f"a byte changed at {k} twentieths": lambda given, k=k: changed_byte(given, k) for k in range(20)},
    "unsigned where keys are trusted": unsigned,
    "signed by a stranger": trusting(bytes(31) + b"\x09"),
    "nobody is trusted": trusting(),
    "the key has expired": of_the_key(expires=TODAY - DAY),
    "the key was revoked": of_the_key(revoked=TODAY - DAY),
    "of a newer version": newer,
    "for a machine with other limits": other_limits,
    "for a board with other pins": other_board,
    "with other offsets": other_offsets,
    "no machine file": lambda given: given.more.update(machine=None),
    "no setup": lambda given: given.more.update(setup=None),
}


@dataclass
class Bench:
    """A board that has power: its driver, and how many steps it has made."""

    board: KlipperBoard
    steps: Callable[[], int]


@contextmanager
def on_emulator(machine: Machine, chip_of: Callable[[str], Simulation], **options: Any) -> Iterator[Bench]:
    emulator = Emulator(Options(chip="atmega328p", **options))
    pulse, setup = ticks_of(machine)
    wiring = wiring_of(machine)
    board = KlipperBoard(EmulatedLine(emulator).connect, wiring, pulse=pulse, direction_setup=setup, baud=250_000)

    def steps() -> int:
        emulator.advance(emulator.now + 10**9)
        emulator.finish()
        return len(read(emulator.log.held).steps.tick)

    yield Bench(board, steps)


@contextmanager
def on_firmware(machine: Machine, chip_of: Callable[[str], Simulation], **options: Any) -> Iterator[Bench]:
    simulation = chip_of("328p")

    def steps() -> int:
        now = simulation.until(simulation.flush()[0] + 16_000_000, simulation.written)[0]
        assert now > 0
        pins = {number_of(motor.step): int(not motor.step.inverted) for motor in machine.board.motors}
        edges = simulation.edges()
        # A pin whose step is a falling edge goes high when it is configured; no step falls.
        return sum(int(((edges[:, 1] == pin) & (edges[:, 2] == level)).sum()) for pin, level in pins.items())

    yield Bench(Recorded(simulation, machine), steps)


BOARDS = [
    on_emulator,
    pytest.param(on_firmware, marks=pytest.mark.skipif(bool(MISSING), reason=MISSING)),
]
Board = Callable[..., Any]


@pytest.fixture(scope="module")
def right(tmp_path_factory: pytest.TempPathFactory) -> tuple[bytes, bytes]:
    """A package and the key that signed it."""
    folder = tmp_path_factory.mktemp("right")
    compiled(folder, "job.cnc", PROGRAM, machine_text("eding", x=60, y=60))
    return (folder / "job.gpx").read_bytes(), raw_public(load_or_create_key(folder / "key.pem"))


def given_of(right: tuple[bytes, bytes], folder: Path) -> Given:
    path = folder / "job.gpx"
    path.write_bytes(right[0])
    return Given(path, right[1], read_package(path).machine)


def tried(given: Given, board: KlipperBoard) -> ExecutionRecord:
    package = given.package
    right: dict[str, Any] = {"machine": given.machine, "setup": package.setup, "trusted_keys": [given.key]}
    return run(package, board, **(right | given.more))


@pytest.mark.parametrize("on", BOARDS)
def test_a_package_that_is_not_right_moves_nothing(
    on: Board, right: tuple[bytes, bytes], chip_of: Callable[[str], Simulation], tmp_path: Path
) -> None:  # fmt: skip
    given = given_of(right, tmp_path)
    with on(given.machine, chip_of) as bench:
        bench.board.open()
        for name, change in WRONG.items():
            wrong = given_of(right, tmp_path)
            change(wrong)
            with pytest.raises((RunRefused, CertificateError)):
                tried(wrong, bench.board)
                pytest.fail(f"{name}: it ran")
        assert bench.steps() == 0
        # The same package as it is runs on the same board.
        record = tried(given_of(right, tmp_path), bench.board)
        assert (record.result, record.reason) == (Result.COMPLETED, "")
        assert bench.steps() == sum(record.steps) > 0


@pytest.mark.parametrize("on", BOARDS)
def test_a_board_that_is_another_moves_nothing(
    on: Board, right: tuple[bytes, bytes], chip_of: Callable[[str], Simulation], tmp_path: Path
) -> None:  # fmt: skip
    """Configured for other pins, or with a clock that the stream is not made for."""
    given = given_of(right, tmp_path)
    board = given.machine.board
    swapped = replace(board, motors=(replace(board.motors[0], step=board.motors[1].step), board.motors[1]))
    with on(given.machine, chip_of) as bench:
        bench.board.open()
        bench.board.close()
        other = KlipperBoard(bench.board._connect, wiring_of(given.machine), pulse=99)
        with pytest.raises(BoardError, match="configured for another machine"):
            tried(given, other)
        with pytest.raises(BoardError, match="also a pin"):
            KlipperBoard(bench.board._connect, wiring_of(replace(given.machine, board=swapped))).open()
        slow = KlipperBoard(bench.board._connect, wiring_of(given.machine), frequency=8_000_000)
        with pytest.raises(BoardError, match="ticks a second"):
            tried(given, slow)
        assert bench.steps() == 0


class Skipping(Session):
    """A host that presents no identity, and takes the firmware for one that asks for none."""

    def reach(self) -> None:
        super().reach()
        self.certified = False


class Half(KlipperBoard):
    """A host that presents half an identity."""

    def present(self, identity: bytes) -> None:
        super().present(identity[:16])


@pytest.mark.parametrize("on", BOARDS)
def test_a_host_that_skips_the_identity_moves_nothing(
    on: Board, right: tuple[bytes, bytes], chip_of: Callable[[str], Simulation], tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    given = given_of(right, tmp_path)
    with on(given.machine, chip_of) as bench:
        record = tried(given, Half(bench.board._connect, wiring_of(given.machine)))
        assert record.result is Result.FAULT and "Not certified" in record.reason
        monkeypatch.setattr("gproof.backend.boards.klipper.driver.Session", Skipping)
        record = tried(given, KlipperBoard(bench.board._connect, wiring_of(given.machine)))
        assert record.result is Result.FAULT and "Not certified" in record.reason
        assert sum(record.steps) == 0 == bench.steps()
