"""The journal: what is on the disk when a run ends in the middle, and the record that is made from it.

The independent word on what was executed is that of the board itself, kept where the end of the process does not
reach it (`killed_runs.py`), and the steps of the stream one by one (`reference`).
"""

from __future__ import annotations

import errno
import json
import os
import random
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from backend.jobs import job
from backend.test_runtime import TWO, Broken, Tap, at_part
from backend.test_virtual_board import reference
from support.campaigns import share, sizes

from gproof.backend import journal as journals
from gproof.backend import runtime
from gproof.backend.boards.board import BoardError, BoardState
from gproof.backend.control import Control
from gproof.backend.journal import Found, read_journal
from gproof.backend.record import parse_record, problems
from gproof.backend.record_data import ExecutionRecord, Result
from gproof.backend.runtime import Hold
from gproof.ir.trace import Wait


def begun(folder: Path, board: str = "virtual", **heading: str) -> journals.Journal:
    return journals.begin(folder, board, heading)


def only(folder: Path, suffix: str = journals.SUFFIX) -> Path:
    (path,) = folder.glob(f"*{suffix}")
    return path


RUNS: dict[str, dict[str, Any]] = {
    "to its end": {},
    "slowly, with holds": {"override": 0.5, "hold_at": [Hold(at=100_000, rest=1000), Hold(at=900_000, rest=50)]},
    "emergency stop": {"estop_at": 700_000},
    "held by itself": {"hold_by": 0.4},
}


@pytest.mark.parametrize("name", RUNS)
def test_the_record_is_made_from_the_journal_alone(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(runtime, "NOTED", 0.01)
    more = dict(RUNS[name])
    control = Control()
    if "hold_by" in more:
        more["on_progress"] = at_part(more.pop("hold_by"), control.hold)
    journal = begun(tmp_path)
    record = runtime.walk(TWO, Tap(2, fifo_runs=100), journal=journal, control=control, **more)
    found = read_journal(journal.path)
    assert found.damaged == 0
    assert found.trail().ended
    again = found.trail().record()
    assert again == record
    assert again.to_json() == record.to_json()
    assert list(problems(again, TWO)) == []
    assert sum(kind == "at" for kind, _ in found.entries) > 20


def test_the_same_run_has_the_same_record_with_and_without_a_journal(tmp_path: Path) -> None:
    plain = runtime.walk(TWO, Tap(2), override=0.5, hold_at=300_000)
    noted = runtime.walk(TWO, Tap(2), override=0.5, hold_at=300_000, journal=begun(tmp_path))
    assert noted.to_json() == plain.to_json()


class Slow(Tap):
    """Says at each start of a section what is on the disk."""

    def __init__(self, folder: Path) -> None:
        super().__init__(2)
        self.folder = folder
        self.there: list[list[str]] = []

    def start_section(self, number: int, start: tuple[int, ...], lead: int) -> int:
        self.there.append([kind for kind, _ in read_journal(only(self.folder)).entries])
        return super().start_section(number, start, lead)


def test_nothing_moves_before_the_journal_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    synced: list[int] = []
    sync = os.fsync
    monkeypatch.setattr(os, "fsync", lambda handle: (sync(handle), synced.append(os.fstat(handle).st_size)))
    board = Slow(tmp_path)
    journal = begun(tmp_path, signed_by="somebody")
    runtime.walk(TWO, board, journal=journal)
    assert board.there[0] == ["begin", "section"]
    assert [kinds[-1] for kinds in board.there] == ["section"] * 3
    assert [kinds.count("ended") for kinds in board.there] == [0, 1, 2]
    # Each of these lines was on the disk, not only on its way there.
    sizes, at = [], 0
    for line in journal.path.read_bytes().splitlines(keepends=True):
        at += len(line)
        if json.loads(line[65:])["kind"] in ("begin", "section", "ended", "end"):
            sizes.append(at)
    assert set(sizes) <= set(synced)
    assert read_journal(journal.path).field("signed_by") == "somebody"
    assert read_journal(journal.path).field("place") == "virtual"


# Reading.


@pytest.fixture
def whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> bytes:
    monkeypatch.setattr(runtime, "NOTED", 0.1)
    journal = begun(tmp_path / "whole")
    runtime.walk(TWO, Tap(2), journal=journal)
    return journal.path.read_bytes()


def parsed(tmp_path: Path, data: bytes) -> Found:
    path = tmp_path / "some.journal"
    path.write_bytes(data)
    return read_journal(path)


def truthful(record: ExecutionRecord) -> None:
    """What a record of an unfinished run may say, by the stream's own steps."""
    assert parse_record(record.to_json()) == record
    assert list(problems(record, TWO)) == []
    for section in record.sections:
        planned = TWO.stream.sections[section.number]
        if not section.retimings:
            assert section.position == reference(planned, section.ticks)
    if record.position is not None:
        assert record.position == record.last_position
        assert not record.sections or record.sections[-1].outcome is not Result.INTERRUPTED


def test_cut_anywhere_it_says_what_was_said_before(whole: bytes, tmp_path: Path) -> None:
    ends = [k + 1 for k, byte in enumerate(whole) if byte == 10]
    for cut in [*range(0, len(whole), 61), *ends]:
        found = parsed(tmp_path, whole[:cut])
        assert found.damaged == 0
        assert len(found.entries) == sum(end <= cut for end in ends)
        if found.entries:
            truthful(found.trail().record())


def test_damage_in_the_middle_makes_the_position_unknown(whole: bytes, tmp_path: Path) -> None:
    lines = whole.splitlines(keepends=True)
    for place in range(40, len(whole) - 1, 97):
        if whole[place] == 10:
            continue
        found = parsed(tmp_path, whole[:place] + bytes([whole[place] ^ 1]) + whole[place + 1 :])
        assert found.damaged > 0
        if found.entries:
            record = found.trail().record()
            assert list(problems(record, TWO)) == []
            if any(section.wait == "end" for section in record.sections):
                assert record.result is Result.COMPLETED
                continue
            assert record.result is Result.INTERRUPTED
            assert record.position is None
            assert "damaged" in record.reason
    # Lines left out, moved, doubled.
    for other in (lines[:2] + lines[3:], [lines[0], lines[2], lines[1], *lines[3:]], [*lines[:3], *lines[2:]]):
        assert parsed(tmp_path, b"".join(other)).trail().record().position is None
    for none in (b"\n", b"\0" * 400 + b"\n", lines[1], b"x" * 65 + b"{}\n"):
        assert not parsed(tmp_path, none).trail().begun
    # Blocks that a file system had not written yet: what stood there is not known, so that nothing is at rest.
    for end in (b"\0" * 900, b"\0", b"x"):
        found = parsed(tmp_path, lines[0] + lines[1] + end)
        assert (len(found.entries), found.damaged) == (2, 3)
        assert found.trail().record().position is None


def test_lines_of_another_kind_are_not_believed(tmp_path: Path) -> None:
    good = runtime.walk(TWO, Tap(2), journal=(journal := begun(tmp_path)))
    entries = read_journal(journal.path).entries
    assert good.result is Result.COMPLETED
    for kind, fields in [
        ("at", {}),
        ("at", {"tick": "soon", "steps": [0, 0], "position": [0, 0], "accepted": [0, 0], "events": []}),
        ("at", {"tick": 5, "steps": [0], "position": [0, 0], "accepted": [0, 0], "events": []}),
        ("at", {"tick": 5, "steps": [0, 0], "position": [0, 0], "accepted": [0, 0], "events": [[1]]}),
        ("begin", entries[0][1]),
        ("section", {"number": 0}),
        ("section", {"number": 0, "start": [0], "retimings": []}),
        ("retimed", {"retimings": [{"kind": "hold"}]}),
        ("ended", {"section": {}, "reason": ""}),
        ("answer", {"wait": "operator", "answer": "on", "target": None}),
        ("end", {"result": "fine", "reason": "", "observed": {}}),
        ("sung", {}),
    ]:
        wrong = [*entries[:2], (kind, fields)]
        trail = Found(path=journal.path, entries=tuple(wrong)).trail()
        assert trail.damaged, kind
        assert trail.record().position is None


# Who holds it, and what is left.


def test_a_journal_is_left_by_who_died_and_held_by_who_lives(tmp_path: Path) -> None:
    journal = begun(tmp_path)
    runtime.walk(TWO, Tap(2), journal=journal)
    assert journals.left_open(tmp_path, "virtual") == []
    journal.let_go()
    assert journals.left_open(tmp_path, "klipper-1") == []
    (left,) = journals.left_open(tmp_path, "virtual")
    assert journals.left_open(tmp_path, "virtual") == []
    left.note("recorded", {"path": "there.json"})
    assert left.found.recorded == "there.json"
    left.close()
    assert journals.left_open(tmp_path, "virtual") == []
    assert read_journal(only(tmp_path, journals.ENDED)).closed


def test_half_a_line_is_cut_off_before_more_is_said(tmp_path: Path) -> None:
    journal = begun(tmp_path)
    runtime.walk(TWO, Tap(2), journal=journal)
    journal.let_go()
    data = journal.path.read_bytes()
    journal.path.write_bytes(data[:-30])
    (left,) = journals.left_open(tmp_path, "virtual")
    left.close()
    found = read_journal(only(tmp_path, journals.ENDED))
    assert found.closed
    assert found.damaged == 0


def test_a_damaged_journal_is_put_aside_as_it_is(tmp_path: Path) -> None:
    journal = begun(tmp_path)
    runtime.walk(TWO, Tap(2), journal=journal)
    journal.let_go()
    data = journal.path.read_bytes()
    journal.path.write_bytes(data[:300] + b"?" + data[301:])
    (left,) = journals.left_open(tmp_path, "virtual")
    left.note("recorded", {"path": "there.json"})
    left.close()
    assert only(tmp_path, journals.DAMAGED).read_bytes() == data[:300] + b"?" + data[301:]
    assert journals.left_open(tmp_path, "virtual") == []


def test_a_board_is_held_by_one_process_at_a_time(tmp_path: Path) -> None:
    with journals.held(tmp_path, "port 1") as first, journals.held(tmp_path, "port 1") as second:
        assert (first, second) == (True, False)
    with journals.held(tmp_path, "port 1") as again, journals.held(tmp_path, "port 2") as other:
        assert (again, other) == (True, True)


def test_old_journals_go_and_open_ones_stay(tmp_path: Path) -> None:
    for n in range(journals.KEPT + 20):
        (tmp_path / f"2020{n:03}.ended").write_text("")
    (tmp_path / "2019.journal").write_text("")
    begun(tmp_path).close("x")
    kept = sorted(path.name for path in tmp_path.glob("*.ended"))
    assert len(kept) == journals.KEPT + 1
    assert kept[0] == "2020020.ended"
    assert (tmp_path / "2019.journal").exists()


# A full disk.

WRITES = 200


def dense(folder: Path) -> tuple[journals.Journal, Tap]:
    """A run that writes two hundred times."""
    return begun(folder), Tap(2, fifo_runs=48)


def full_from(monkeypatch: pytest.MonkeyPatch, first: int, last: int) -> list[int]:
    """Calls `first` to `last` of writing and syncing find a full disk; a write keeps half of its bytes."""
    counted = [0]

    def fails() -> bool:
        counted[0] += 1
        return first <= counted[0] <= last

    write, sync = os.write, os.fsync

    def writing(handle: int, data: bytes) -> int:
        if not fails():
            return write(handle, data)
        write(handle, data[: len(data) // 2])
        raise OSError(errno.ENOSPC, "No space left on device")

    def syncing(handle: int) -> None:
        if fails():
            raise OSError(errno.ENOSPC, "No space left on device")
        sync(handle)

    monkeypatch.setattr(os, "write", writing)
    monkeypatch.setattr(os, "fsync", syncing)
    return counted


def test_a_run_that_writes_often_enough(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(runtime, "NOTED", 0.001)
    counted = full_from(monkeypatch, 10**9, 10**9)
    journal, board = dense(tmp_path)
    runtime.walk(TWO, board, journal=journal)
    assert counted[0] >= WRITES


@pytest.mark.parametrize(("point", "space"), share([(p, s) for p in range(2, WRITES + 2) for s in (0, 10**9)], 10))
def test_a_full_disk_at_any_write(point: int, space: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """space: how many calls later there is room again. The run ends at rest, and both records say the truth."""
    monkeypatch.setattr(runtime, "NOTED", 0.001)
    with monkeypatch.context() as patched:
        journal, board = dense(tmp_path)
        full_from(patched, point, point if space == 0 else 10**9)
        try:
            record = runtime.walk(TWO, board, journal=journal)
        except OSError:
            assert board.seen == [[], []]
            return
        assert list(problems(record, TWO)) == []
        status = board.status()
        assert (record.steps, record.position) == (status.steps, status.position)
        assert record.result in (Result.STOPPED, Result.COMPLETED)
        if record.result is Result.STOPPED:
            assert "journal cannot be written (No space left on device)" in record.reason
        else:
            assert record.sections[-1].number == 2
    journal.let_go()
    (left,) = journals.left_open(tmp_path, "virtual")
    later = left.found.trail()
    assert left.found.damaged == 0
    assert later.begun
    found = later.record()
    assert list(problems(found, TWO)) == []
    assert all(a <= b for a, b in zip(found.steps, status.steps, strict=True))
    assert found.position in (None, status.position)
    if space == 0:
        assert found == record


def test_where_no_feed_hold_is_possible_the_section_goes_on_to_its_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An emergency stop may lose the position; a journal that can not be written is no reason for one."""
    monkeypatch.setattr(runtime, "NOTED", 0.01)
    monkeypatch.setattr(runtime._Walk, "_accept", lambda *_: False)
    journal, board = begun(tmp_path), Tap(2)
    full_from(monkeypatch, 8, 10**9)
    record = runtime.walk(TWO, board, journal=journal)
    assert record.result is Result.STOPPED
    assert [s.outcome for s in record.sections] == [Result.COMPLETED]
    assert record.position == TWO.stream.sections[0].end()
    assert list(problems(record, TWO)) == []


def test_the_first_interrupt_during_such_a_hold_is_no_emergency_stop() -> None:
    control = Control()
    control.end_at_rest("the journal cannot be written")
    control.interrupt()
    assert not control.stop_asked
    control.interrupt()
    assert control.stop_asked


def test_a_disk_that_is_full_from_the_start_moves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    board = Tap(2)
    journal = begun(tmp_path)
    full_from(monkeypatch, 1, 10**9)
    with pytest.raises(OSError, match="No space left"):
        runtime.walk(TWO, board, journal=journal)
    assert board.seen == [[], []]
    assert board.status().state is BoardState.CLOSED


# Positions that nobody knows.


class Deaf(Broken):
    """A board whose line breaks for good."""

    def status(self):
        if self.calls < 0:
            raise BoardError("the line is dead")
        return super().status()

    def emergency_stop(self) -> None:
        raise BoardError("the line is dead")


def test_a_board_that_does_not_answer_any_more_has_no_known_position(tmp_path: Path) -> None:
    board = Deaf(2, fifo_runs=40)
    journal = begun(tmp_path)
    record = runtime.walk(TWO, board, journal=journal)
    assert record.result is Result.FAULT
    assert record.position is None
    assert 0 < sum(record.steps) < TWO.stream.steps()
    assert list(problems(record, TWO)) == []
    assert read_journal(journal.path).trail().record() == record


# Signals and kills at many points.

SIGNALS = ("SIGKILL", "SIGTERM", "SIGHUP", "SIGINT")
TESTS = Path(__file__).parents[1]


def killed(folder: Path, number: str, points: list[str]) -> list[dict[str, Any]]:
    """How runs went that got a signal at each of the points."""
    folder.mkdir(exist_ok=True)
    command = [sys.executable, "-W", "ignore", str(TESTS / "backend" / "killed_runs.py"), str(folder), number, *points]
    done = subprocess.run(
        command, env={**os.environ, "PYTHONPATH": str(TESTS)}, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return [json.loads(line) for line in done.stdout.splitlines()]


def points_of(folder: Path, seed: int, many: int) -> list[str]:
    """So many of the calls of a whole run, some of them in the middle of a write: the same ones for a seed."""
    killed(folder / "whole", "SIGKILL", ["count"])
    calls = int((folder / "whole" / "count.txt").read_text())
    chance = random.Random(seed)
    points = chance.sample(range(1, calls + 1), many)
    return [f"half{p}" if chance.random() < 0.3 else str(p) for p in points]


def check_killed(folder: Path, went: dict[str, Any]) -> str:
    """The record of a run that was killed says what the board did, or less, or that it is not known."""
    place = folder / went["point"]
    if (place / "record.json").exists() and not list(place.glob("*.journal")):
        record = parse_record((place / "record.json").read_bytes())
        assert record.result is Result.COMPLETED
        assert [*record.steps, *(record.position or ())] == went["steps"] + went["position"]
        return "completed"
    lefts = journals.left_open(place, "virtual")
    if not lefts:
        assert went["steps"] == [0, 0]
        return "nothing"
    (left,) = lefts
    trail = left.found.trail()
    assert left.found.damaged == 0, went
    if not trail.begun:
        assert went["steps"] == [0, 0]
        left.close()
        return "nothing"
    record = trail.record()
    truthful(record)
    assert all(a <= b for a, b in zip(record.steps, went["steps"], strict=True)), went
    assert record.position is None or list(record.position) == went["position"], went
    if trail.ended:
        assert list(record.steps) == went["steps"]
    left.close()
    return record.result.value if record.position is not None else "unknown"


@pytest.mark.parametrize("seed", [1])
@pytest.mark.parametrize("many", sizes(24, 400))
def test_killed_at_any_point_the_record_says_the_truth(seed: int, many: int, tmp_path: Path) -> None:
    points = points_of(tmp_path, seed, many)
    results: dict[str, int] = {}
    for went in killed(tmp_path / "runs", "SIGKILL", points):
        assert went["status"] == -signal.SIGKILL or went["status"] == 0, went
        result = check_killed(tmp_path / "runs", went)
        results[result] = results.get(result, 0) + 1
    # Which of the two depends on what the disk had at that moment; many points have both.
    assert set(results) & {"unknown", "interrupted"}, results
    if many > 100:
        assert results["unknown"] > many // 4, results
        assert results["interrupted"] >= 1, results


@pytest.mark.parametrize("number", SIGNALS[1:])
@pytest.mark.parametrize("many", sizes(8, 200))
def test_a_signal_at_any_point_stops_and_closes(number: str, many: int, tmp_path: Path) -> None:
    chance = random.Random(3)
    points = [point.removeprefix("half") for point in points_of(tmp_path, 2, many)]
    # Half of them get it twice, most of these while they are closing.
    points = [f"{p},{int(p) + chance.choice([1, 2, 5, 9, 40])}" if chance.random() < 0.5 else p for p in points]
    results: dict[str, int] = {}
    for went in killed(tmp_path / "runs", number, points):
        place = tmp_path / "runs" / went["point"]
        if went["status"] == -signal.SIGINT:  # before the run was running: nothing was begun
            assert went["steps"] == [0, 0]
            assert not any(left.found.trail().begun for left in journals.left_open(place, "virtual"))
            continue
        assert went["status"] == 0, went
        record = parse_record((place / "record.json").read_bytes())
        assert list(problems(record, TWO)) == []
        assert [*record.steps, *(record.position or ())] == went["steps"] + went["position"]
        assert read_journal(only(place, journals.ENDED)).closed
        results[record.result.value] = results.get(record.result.value, 0) + 1
    stopped = "stopped" if number == "SIGINT" else "emergency-stop"
    assert results[stopped] > len(points) // 3, results
    assert set(results) <= {"emergency-stop", "completed", "stopped"}


# A record of the first schema.


def test_a_record_of_the_first_schema_is_read_and_compared() -> None:
    data = (Path(__file__).parent / "records" / "schema-1.json").read_bytes()
    record = parse_record(data)
    assert record.schema == "gproof-record/1"
    assert record.result is Result.EMERGENCY_STOP
    assert record.to_json() == data
    assert list(problems(record, TWO)) == []
    assert record.findings()
    with pytest.raises(ValueError, match="hash"):
        parse_record(data.replace(b'"position":[291,204],"reason"', b'"position":[291,205],"reason"'))
    with pytest.raises(ValueError, match=r".+"):
        parse_record(data.replace(b"gproof-record/1", b"gproof-record/2"))


def test_a_record_and_a_journal_of_before_real_boards_are_read_and_compared(tmp_path: Path) -> None:
    data = (Path(__file__).parent / "records" / "schema-2.json").read_bytes()
    record = parse_record(data)
    assert record.schema == "gproof-record/2"
    assert record.to_json() == data
    assert list(problems(record, TWO)) == []
    with pytest.raises(ValueError, match=r".+"):
        parse_record(data.replace(b"gproof-record/2", b"gproof-record/3"))
    path = tmp_path / "old.journal"
    path.write_bytes((Path(__file__).parent / "records" / "journal-1.journal").read_bytes())
    found = read_journal(path)
    assert (found.damaged, [kind for kind, _ in found.entries]) == (0, ["begin", "section", "at", "at", "at"])
    made = found.trail().record()
    assert (made.result, made.position, made.schema) == (Result.INTERRUPTED, None, "gproof-record/3")
    assert made.steps[0] > 0
    assert list(problems(made, TWO)) == []
    (left,) = journals.left_open(tmp_path, "virtual")
    left.note("recorded", {"path": "there.json"})
    assert left.found.damaged == 0
    left.close()


def test_waits_are_left_out_of_nothing(tmp_path: Path) -> None:
    """A wait that nobody answers is told as such by both records."""
    asks = job([(1.0, 0.0)], [(2.0, 0.0)], waits=(Wait.INPUT,))
    journal = begun(tmp_path)
    record = runtime.walk(asks, Tap(2), journal=journal)
    assert record.result is Result.STOPPED
    assert read_journal(journal.path).trail().record() == record
