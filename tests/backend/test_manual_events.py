"""What no pin of the board does is a wait at rest, said before the run; what a pin does switches at its tick."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from backend.boards.klipper.emulated_line import EmulatedLine
from backend.boards.klipper.fake_peer import FakePeer
from backend.streams import steps_of
from cli.packages import MACHINE, Shop

from gproof.backend.boards.emulator.emulator import Options
from gproof.backend.boards.klipper.driver import KlipperBoard
from gproof.backend.boards.klipper.wiring import MotorPins, OutputPin, Wiring
from gproof.backend.boards.outputs import Manual, left_of, pins_of
from gproof.backend.boards.virtual import VirtualBoard
from gproof.backend.control import Control
from gproof.backend.job import CertifiedJob, job_of
from gproof.backend.manual_events import all_manual
from gproof.backend.operators import HoldRequest, WaitRequest
from gproof.backend.record import problems
from gproof.backend.record_data import TRUSTED, ExecutionRecord, Result
from gproof.backend.runtime import walk
from gproof.ir.machine import Pin, WiredOutput
from gproof.ir.trace import Op
from gproof.verify.certificate.package import read_package

JOB = "G21 G90\nM3 S9000\nG1 X1 F600\nM8\nM3 S12000\nG1 X0.5\nM9\nG4 P0.2\nM8\nG1 X1\nM5\nM30\n"
TICKS = 16_000_000


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("manual")


@pytest.fixture(scope="module")
def certified(folder: Path) -> CertifiedJob:
    with pytest.MonkeyPatch.context() as patch:
        shop = Shop(folder, patch.setenv)
        (folder / "machine.toml").write_text(MACHINE)
        (folder / "job.cnc").write_text(JOB)
        package = read_package(shop.compile())
    return replace(job_of(package), accepted=TRUSTED, machine_at_hand=True, setup_at_hand=True)


def with_outputs(job: CertifiedJob, *outputs: WiredOutput) -> CertifiedJob:
    return replace(job, machine=replace(job.machine, board=replace(job.machine.board, outputs=outputs)))


class Person:
    """Answers after a time of the board's; keeps what was asked, when, and how many steps had been made."""

    def __init__(self, peer: FakePeer, seconds: float, answer: Callable[[int], bool] = lambda _: True) -> None:
        self.peer, self.seconds, self.answer = peer, seconds, answer
        self.asked: list[tuple[int, str, int, int]] = []
        self.holds: list[int] = []

    def wait(self, request: WaitRequest) -> str | None:
        before = sum(self.peer.made())
        began = self.peer.clock()
        self.peer.t += self.seconds
        assert sum(self.peer.made()) == before, "it moves while somebody has his hands in it"
        self.asked.append((request.line, request.text, before, began))
        return request.outcomes[0] if self.answer(len(self.asked)) else None

    def held(self, request: HoldRequest) -> bool:
        self.holds.append(request.tick)
        return True


def on_a_board(
    job: CertifiedJob, person: Person, outputs: dict[str, OutputPin] | None = None, control: Control | None = None
) -> tuple[ExecutionRecord, list[WaitRequest]]:
    said: list[WaitRequest] = []
    wiring = Wiring(motors=[MotorPins(step="PA0", direction="PA1")], outputs=outputs or {})
    board = KlipperBoard(lambda: person.peer, wiring)
    done = walk(job, board, operator=person, announce=said.extend, control=control)
    return done, said


ALL = ("spindle", "spindle_reverse", "mist", "flood", "3")
CASES = [
    # op, arguments in thousandths, wired, pins, what is left
    (Op.SPINDLE, (1000, 9_000_000), ALL, (("spindle_reverse", False), ("spindle", True)), ("spindle speed",)),
    (Op.SPINDLE, (-1000, 9_000_000), ALL, (("spindle", False), ("spindle_reverse", True)), ("spindle speed",)),
    (Op.SPINDLE, (0, 0), ALL, (("spindle", False), ("spindle_reverse", False)), ()),
    (Op.SPINDLE, (-1000, 9_000_000), ("spindle",), (("spindle", False),), ("spindle",)),
    (Op.SPINDLE, (1000, 9_000_000), (), (), ("spindle",)),
    (Op.SPINDLE, (0, 0), (), (), ("spindle",)),
    (Op.COOLANT, (0, 1000), ALL, (("mist", False), ("flood", True)), ()),
    (Op.COOLANT, (1000, 0), ("flood",), (("flood", False),), ("mist",)),
    (Op.OUTPUT, (3000, 1000), ALL, (("3", True),), ()),
    (Op.OUTPUT, (3000, 0), ALL, (("3", False),), ()),
    (Op.OUTPUT, (4000, 1000), ALL, (), ("output 4",)),
    # The bits of a group are no level of one pin.
    (Op.OUTPUT, (3000, 5000), ALL, (), ("output 3",)),
    (Op.SETPOINT, (0, 500), ALL, (), ("fan",)),
    (Op.DWELL, (2000, 0), ALL, (), ()),
]


def test_what_an_event_switches_and_what_it_leaves() -> None:
    for op, arg, wired, pins, left in CASES:
        outputs = [WiredOutput(output=name, pin=Pin(name=f"P{name}")) for name in wired]
        assert pins_of(op, arg, wired) == pins, (op, arg, wired)
        assert tuple(manual.what for manual in left_of(op, arg, outputs, "fan")) == left, (op, arg, wired)


def test_a_spindle_of_one_speed_is_the_pin_s_alone() -> None:
    outputs = [WiredOutput(output="spindle", pin=Pin(name="PB0"), speed=9000.0)]
    assert left_of(Op.SPINDLE, (1000, 9_000_000), outputs) == ()
    assert left_of(Op.SPINDLE, (1000, 9_001_000), outputs) == (Manual("spindle speed", "9001 rpm"),)


WANTED = [
    (2, "spindle: clockwise, 9000 rpm"),
    (4, "mist: off; flood: on; spindle: clockwise, 12000 rpm"),
    # The dwell between M9 and M8 is a time that passes: two waits.
    (7, "flood: off"),
    (9, "flood: on"),
    (11, "spindle: off; flood: off"),
]


def test_nothing_is_wired_and_everything_is_asked_at_rest(certified: CertifiedJob) -> None:
    peer = FakePeer()
    person = Person(peer, 4.0)
    done, said = on_a_board(certified, person)
    assert done.result is Result.COMPLETED, done.reason
    assert [(request.line, request.text) for request in said] == WANTED
    assert [(line, text) for line, text, _, _ in person.asked] == WANTED
    # 100 steps a mm: 1 mm, 0.5 back, 0.5 forth, each before what comes after it in the program.
    assert [steps for _, _, steps, _ in person.asked] == [0, 100, 150, 150, 200]
    section = certified.stream.sections[0]
    assert [d for _, d in peer.steppers[0].edges] == [d for _, d in steps_of(section.runs[0])]
    assert done.position == section.end()
    assert list(problems(done, certified)) == []


def test_a_question_may_take_an_hour(certified: CertifiedJob) -> None:
    """The clock's 32 bits go round 13 times meanwhile, and nobody hears the line."""
    peer = FakePeer()
    done, _ = on_a_board(certified, Person(peer, 3600.0))
    assert done.result is Result.COMPLETED, done.reason
    assert done.position == certified.stream.sections[0].end()
    assert list(problems(done, certified)) == []


def test_firmware_that_watches_waits_as_long(certified: CertifiedJob) -> None:
    """With the extension nothing is promised while the operator is asked."""
    line = EmulatedLine(Options())

    class Slow(Person):
        def wait(self, request: WaitRequest) -> str | None:
            line.pass_time(900.0)
            return request.outcomes[0]

    board = KlipperBoard(line.connect, Wiring(motors=[MotorPins(step="PA0", direction="PA1")]))
    done = walk(certified, board, operator=Slow(FakePeer(), 0.0))
    assert done.result is Result.COMPLETED, done.reason
    assert done.position == certified.stream.sections[0].end()
    assert list(problems(done, certified)) == []


def test_pins_switch_after_the_operator_is_done(certified: CertifiedJob) -> None:
    """Flood and spindle have a pin, the speed has none: M3 switches when the speed is set."""
    outputs = [WiredOutput(output=name, pin=Pin(name=pin)) for name, pin in (("spindle", "PB0"), ("flood", "PB1"))]
    job = with_outputs(certified, *outputs)
    peer = FakePeer()
    person = Person(peer, 2.0)
    done, _ = on_a_board(job, person, {"spindle": OutputPin(pin="PB0"), "flood": OutputPin(pin="PB1")})
    assert done.result is Result.COMPLETED, done.reason
    assert [(line, text) for line, text, _, _ in person.asked] == [
        (2, "spindle speed: 9000 rpm"),
        (4, "mist: off; spindle speed: 12000 rpm"),
    ]
    spindle = [(tick, on) for oid, tick, on in peer.outputs if oid == 1]
    assert [on for _, on in spindle] == [1, 1, 0, 0]
    for (tick, _), (_, _, _, began) in zip(spindle, person.asked, strict=False):
        assert tick >= began + 2 * TICKS
    assert [on for oid, _, on in peer.outputs if oid == 2] == [1, 0, 1, 0, 0]


def test_who_says_no_ends_the_job_at_rest(certified: CertifiedJob) -> None:
    peer = FakePeer()
    done, _ = on_a_board(certified, Person(peer, 1.0, lambda number: number < 3))
    assert done.result is Result.STOPPED
    assert done.reason == "section 0: ended while waiting for the operator (flood: off)"
    assert (done.position, done.steps, peer.made()) == ((50,), (150,), (150,))
    assert [op for _, _, op in done.sections[0].events] == [Op.SPINDLE, Op.COOLANT, Op.SPINDLE]
    peer = FakePeer()
    done, _ = on_a_board(certified, Person(peer, 1.0, lambda number: False))
    assert (done.result, done.sections, peer.made()) == (Result.STOPPED, (), (0,))


def test_a_feed_hold_that_would_end_at_a_wait_holds_there(certified: CertifiedJob) -> None:
    """0.1 s of motion are left when it is requested: the machine rests at line 4 anyway."""
    control = Control()
    peer = FakePeer()
    person = Person(peer, 1.0)
    reads = peer.read

    def read(until: float) -> bytes:
        # 100 steps at 1000 a second and less; a hold in the last of them.
        if sum(peer.made()) in range(80, 100) and not person.holds:
            control.hold()
        return reads(until)

    peer.read = read  # type: ignore[method-assign]
    done, _ = on_a_board(certified, person, control=control)
    assert done.result is Result.COMPLETED, done.reason
    assert len(person.holds) == 1
    assert [(line, text) for line, text, _, _ in person.asked] == WANTED
    assert done.position == certified.stream.sections[0].end()
    assert list(problems(done, certified)) == []


def test_the_virtual_board_does_everything(certified: CertifiedJob) -> None:
    person = Person(FakePeer(), 1.0)
    said: list[WaitRequest] = []
    board = VirtualBoard.for_machine(certified.machine, 1)
    done = walk(certified, board, operator=person, announce=said.extend)
    assert (done.result, said, person.asked) == (Result.COMPLETED, [], [])
    assert len(list(all_manual(certified.stream, certified.trace, ()))) == len(WANTED)
