"""From a package on disk to a record: what holds runs, everything else is refused before any motion."""

import dataclasses
from collections.abc import Callable
from pathlib import Path

import pytest
from backend.jobs import job
from backend.streams import FREQUENCY
from backend.test_runtime import Tap

from gproof.backend.boards.virtual import VirtualBoard
from gproof.backend.record import parse_record, read_record, verify_record
from gproof.backend.runtime import RunRefused, run
from gproof.ir.machine import Board
from gproof.ir.setup import ZERO, Interval
from gproof.ir.verdict import DEFAULT_POLICY, Condition, PropertyResult, Verdict
from gproof.verify.certificate.check import check_package
from gproof.verify.certificate.keys import load_or_create_key, raw_public
from gproof.verify.certificate.package import CertificateError, Package, read_package
from gproof.verify.certificate.write import write_package
from gproof.verify.stream import validate

Make = Callable[..., Package]
JOB = job([(6.0, 0.0), (6.0, 5.0)], [(0.0, 0.0)])


@pytest.fixture
def make(tmp_path: Path) -> Make:
    """Writes a package and reads it back; keywords change what it says."""

    def package(
        what=JOB, conditions: tuple[Condition, ...] = (), verdict: Verdict = Verdict.SAFE, setup=ZERO
    ) -> Package:
        path = tmp_path / "job.gpx"
        write_package(
            path,
            job=what.name,
            version="0",
            inputs=[],
            properties=[PropertyResult(name=name, verdict=verdict, conditions=conditions) for name in DEFAULT_POLICY],
            not_judged=[],
            assumptions=[],
            machine=what.machine,
            setup=setup,
            trace=what.trace,
            stream=what.stream,
            report=validate(what.stream, what.trace, what.machine, setup),
        )
        return read_package(path)

    return package


def refused(*arguments, **more) -> set[int]:
    board = Tap(2)
    with pytest.raises(RunRefused) as refusal:
        run(*arguments[:1], board, *arguments[1:], **more)
    assert board.status().state.value == "closed"
    assert board.seen == [[], []]
    assert str(refusal.value)
    made: list[Tap] = []
    with pytest.raises(RunRefused):
        run(*arguments[:1], lambda: made.append(Tap(2)) or made[0], *arguments[1:], **more)
    assert made == [], "the board is made after the check"
    return {f.code.number for f in refusal.value.findings} - {826}


def test_a_package_runs_and_its_record_fits(make: Make, tmp_path: Path) -> None:
    package = make()
    board = VirtualBoard.for_machine(package.machine, len(package.stream.motors))
    record = run(package, board, override=0.5, hold_at=200_000, machine=package.machine, setup=ZERO)
    assert record.result.value == "completed"
    assert record.certificate == package.sha256
    assert record.job == "job.cnc"
    assert sum(record.steps) == package.stream.steps()
    record.write(tmp_path / "record.json")
    assert verify_record(read_record(tmp_path / "record.json"), package) == []
    other = dataclasses.replace(record, position=(0, 1))
    assert [f.code.label for f in verify_record(parse_record(other.to_json()), package)] == ["GP833"]


def test_another_machine_is_refused(make: Make) -> None:
    package = make()
    other = dataclasses.replace(package.machine, board=Board(tick_frequency=FREQUENCY, step_pulse=1e-6))
    assert refused(package, machine=other) == {823}


def test_other_offsets_are_refused(make: Make) -> None:
    condition = Condition(terms=(("work.1.x", 1),), low=0.0, high=2.0)
    package = make(conditions=(condition,))
    assert check_package(package).valid
    setup = dataclasses.replace(ZERO, work={(1, "x"): Interval(2.5, 2.5)})
    assert refused(package, setup=setup) == {825}


def test_what_is_not_safe_is_refused(make: Make) -> None:
    assert refused(make(verdict=Verdict.UNKNOWN)) == {824}


def test_a_stream_that_does_not_hold_is_refused(make: Make) -> None:
    bad = job([(6.0, 0.0)])
    bad.stream.sections[0].runs[0]["interval"][5] += 4000
    assert refused(make(bad)) & set(range(801, 811))


def test_an_unsigned_package_is_refused_where_signers_are_named(make: Make) -> None:
    assert refused(make(), trusted_keys=[b"x" * 32]) == {827}


def test_an_untrusted_package_runs_where_that_is_allowed_and_the_record_says_so(make: Make) -> None:
    package = make()
    board = VirtualBoard.for_machine(package.machine, len(package.stream.motors))
    record = run(package, board, trusted_keys=[], allow_untrusted=True)
    assert (record.result.value, record.accepted) == ("completed", "allow-untrusted")
    # Allowed is only that: whatever else is wrong is refused as ever.
    assert refused(make(verdict=Verdict.UNKNOWN), trusted_keys=[], allow_untrusted=True) == {824, 827}


class Emulator(Tap):
    """The same board behind a port, or so it could be: it has another name."""

    def open(self):
        return dataclasses.replace(super().open(), name="mill simulator")


@pytest.mark.parametrize("left_out", [(), ("machine",), ("setup",), ("trusted_keys",), ("allow",)])
def test_a_board_of_another_name_asks_for_machine_setup_and_trusted_keys(
    left_out: tuple[str, ...], tmp_path: Path
) -> None:
    key = load_or_create_key(tmp_path / "key.pem")
    path = tmp_path / "job.gpx"
    write_package(
        path, job="job.cnc", version="0", inputs=[],
        properties=[PropertyResult(name=name, verdict=Verdict.SAFE) for name in DEFAULT_POLICY],
        not_judged=[], assumptions=[], machine=JOB.machine, setup=ZERO, trace=JOB.trace, stream=JOB.stream,
        report=validate(JOB.stream, JOB.trace, JOB.machine, ZERO), key=key,
    )  # fmt: skip
    package = read_package(path)
    more = {"machine": package.machine, "setup": ZERO, "trusted_keys": [raw_public(key)]}
    if left_out == ("allow",):
        more |= {"trusted_keys": [], "allow_untrusted": True}
    board = Emulator(2)
    if not left_out:
        assert run(package, board, **more).result.value == "completed"
        return
    with pytest.raises(RunRefused) as refusal:
        run(package, board, **{name: value for name, value in more.items() if name not in left_out})
    assert board.status().state.value == "closed"
    assert board.seen == [[], []]
    wanted = 823 if left_out[0] in ("machine", "setup") else 827
    assert [f.code.number for f in refusal.value.findings] == [wanted]


def test_a_changed_file_is_not_even_read(make: Make) -> None:
    package = make()
    path = Path(package.path)
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    path.write_bytes(data)
    with pytest.raises(CertificateError):
        read_package(path)


@pytest.mark.parametrize("fifo_time", [0.001, 0.25, 60.0])
def test_a_fifo_time_of_a_stranger_costs_no_minutes(make: Make, fifo_time: float) -> None:
    """The board is asked some ten times a second of motion, not two thousand times; nothing of the steps changes."""
    machine = dataclasses.replace(
        JOB.machine, controller=dataclasses.replace(JOB.machine.controller, fifo_time=fifo_time)
    )
    package = make(dataclasses.replace(JOB, machine=machine))

    class Counting(VirtualBoard):
        waits = 0

        def wait(self, tick: int) -> None:
            self.waits += 1
            super().wait(tick)

    board = Counting.for_machine(machine, len(package.stream.motors))
    assert isinstance(board, Counting)
    record = run(package, board)
    assert record.result.value == "completed"
    assert sum(record.steps) == package.stream.steps()
    seconds = sum(s.duration for s in package.stream.sections) / package.stream.tick_frequency
    assert board.waits <= 20 * seconds + 60 * len(package.stream.sections)
