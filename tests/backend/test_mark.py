"""The mark beside a journal, and a journal whose entries in motion are written behind."""

from __future__ import annotations

import errno
import os
import threading
import time
from dataclasses import replace
from pathlib import Path

import pytest
from backend.jobs import job

from gproof.backend import journal as journals
from gproof.backend import mark as marks
from gproof.backend.boards.board import Counting, Known
from gproof.backend.journal import read_journal
from gproof.backend.mark import PLACE, Given, Mark, read_mark
from gproof.backend.program_place import place_of, tick_of_step
from gproof.backend.run_bounds import Source, Told, bounds_of, merged, of_this_run
from gproof.backend.trail import Trail

GIVEN = Given(place=2, begun=True, tick=500, steps=(10, 0), accepted=(3, 0), given=(40, 8))
FIELDS = {"place": 2, "begun": True, "tick": 500, "steps": [10, 0], "accepted": [3, 0], "given": [40, 8]}


@pytest.fixture
def mark(tmp_path: Path) -> Mark:
    return Mark(tmp_path, "run-1")


def test_what_is_written_is_read(mark: Mark) -> None:
    assert read_mark(mark.path, "run-1") is None, "nothing was written yet"
    mark.write(FIELDS)
    assert read_mark(mark.path, "run-1") == GIVEN
    for given in range(41, 50):
        mark.write({**FIELDS, "given": [given, 8]})
        assert read_mark(mark.path, "run-1") == replace(GIVEN, given=(given, 8))
    assert mark.path.stat().st_size == 2 * PLACE
    assert mark.path.stat().st_mode & 0o777 == 0o600


def test_a_mark_cut_in_its_writing_leaves_the_one_before(mark: Mark) -> None:
    mark.write(FIELDS)
    mark.write({**FIELDS, "given": [99, 8]})
    data = mark.path.read_bytes()
    place = PLACE * (mark._number % 2)
    for cut in (1, 30, 64, 66, 100):
        mark.path.write_bytes(data[: place + cut] + bytes(PLACE - cut) + data[place + PLACE :])
        assert read_mark(mark.path, "run-1") == GIVEN, cut


def test_what_is_no_mark_of_this_run_is_not_believed(mark: Mark, monkeypatch: pytest.MonkeyPatch) -> None:
    mark.write(FIELDS)
    data = mark.path.read_bytes()
    assert read_mark(mark.path, "run-2") is None
    link = mark.path.with_name("link.mark")
    link.symlink_to(mark.path)
    assert read_mark(link, "run-1") is None
    assert read_mark(mark.path.with_name("none"), "run-1") is None
    assert read_mark(Path("a\0b"), "run-1") is None
    for other in (data[:-1], data + b"x", b"", bytes(2 * PLACE), data.replace(b'"tick":500', b'"tick":501')):
        mark.path.write_bytes(other)
        assert read_mark(mark.path, "run-1") is None
    mark.path.write_bytes(data)
    monkeypatch.setattr(marks, "boot", lambda: "another start of the computer")
    assert read_mark(mark.path, "run-1") is None


def test_a_mark_that_cannot_be_written_is_removed(mark: Mark, monkeypatch: pytest.MonkeyPatch) -> None:
    mark.write(FIELDS)

    def full(*_: object) -> int:
        raise OSError(errno.EIO, "Input/output error")

    monkeypatch.setattr(os, "pwrite", full)
    with pytest.raises(OSError, match="Input/output"):
        mark.write(FIELDS)
    assert not mark.path.exists()


def test_a_journal_removes_its_mark_when_nothing_is_left_to_do(tmp_path: Path) -> None:
    journal = journals.begin(tmp_path / "runs", "klipper", {}, marks=tmp_path)
    journal.note("begin", {}, sync=True)
    journal.mark(FIELDS)
    assert read_journal(journal.path).given() == GIVEN
    journal.close("there.json")
    assert not list(tmp_path.glob("*.mark"))


# Written behind.


def test_a_slow_disk_does_not_hold_up_who_notes_in_motion(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    synced = []

    def slow(_: int) -> None:
        time.sleep(0.05)
        synced.append(threading.current_thread().name)

    journal = journals.begin(tmp_path, "klipper", {}, behind=True)
    monkeypatch.setattr(os, "fsync", slow)
    journal.note("begin", {}, sync=True)
    assert synced == ["MainThread"]
    began = time.perf_counter()
    for n in range(40):
        journal.note("at", {"tick": n}, sync=False)
    assert time.perf_counter() - began < 1.0, "40 times 50 ms are 2 s"
    journal.note("ended", {}, sync=True)
    kinds = [kind for kind, _ in read_journal(journal.path).entries]
    assert kinds == ["begin", *["at"] * 40, "ended"]
    journal.note("at", {"tick": 99}, sync=False)
    journal.let_go()
    assert read_journal(journal.path).entries[-1][1]["tick"] == 99
    assert "journal" in synced


def test_what_goes_wrong_behind_is_told_by_the_next_note(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    journal = journals.begin(tmp_path, "klipper", {}, behind=True)
    journal.note("begin", {}, sync=True)
    write = os.write

    def full(handle: int, data: bytes) -> int:
        write(handle, data[:10])
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "write", full)
    journal.note("at", {"tick": 1}, sync=False)
    with pytest.raises(OSError, match="No space"):
        for n in range(2, 200):
            time.sleep(0.005)
            journal.note("at", {"tick": n}, sync=False)
    monkeypatch.setattr(os, "write", write)
    journal.note("ended", {}, sync=True)
    found = read_journal(journal.path)
    assert (found.damaged, found.entries[1][1]["tick"], found.entries[-1][0]) == (0, 1, "ended")
    journal.let_go()


# Bounds.

TWO = job([(4.0, 0.0), (4.0, 3.0)], [(0.0, 0.0)])
WHOLE = [int(runs["count"].sum()) for runs in TWO.stream.sections[0].runs]


def open_trail() -> Trail:
    from gproof.backend.boards.virtual import VirtualBoard
    from gproof.backend.record_data import BoardRecord, plain

    board = VirtualBoard(2, tick_frequency=TWO.stream.tick_frequency, step_pulse=2, direction_setup=5).open()
    trail = Trail()
    begin = {"certificate": TWO.certificate, "job": "job.cnc", "motors": ["x", "y"], "start": [0, 0]}
    trail.add("begin", {**begin, "accepted": "any-signer", "board": plain(BoardRecord.of(board))})
    trail.add("section", {"number": 0, "start": [0, 0], "retimings": []})
    at = {"tick": 9, "steps": [20, 0], "position": [20, 0], "accepted": [1, 0], "events": [], "known": "exact"}
    trail.add("at", {**at, "most": []})
    return trail


def given(**more: object) -> Given:
    return replace(Given(place=1, begun=True, tick=0, steps=(25, 0), accepted=(1, 0), given=(60, 4)), **more)


def test_bounds_by_journal_and_mark() -> None:
    trail = open_trail()
    found = bounds_of(trail, None, None)
    assert (found.least, found.most, found.source) == ((20, 0), None, Source.JOURNAL)
    assert bounds_of(trail, None, WHOLE).most == tuple(WHOLE)
    found = bounds_of(trail, given(), WHOLE)
    assert (found.least, found.most, found.source, found.exact) == ((25, 0), (60, 4), Source.MARK, False)
    assert bounds_of(trail, given(given=(25, 0)), WHOLE).exact
    # Of the section before: nothing of this one was sent, which what was acknowledged contradicts.
    assert bounds_of(trail, given(place=0), WHOLE).contradiction
    assert "lost lines" in bounds_of(trail, given(place=2), WHOLE).contradiction
    assert bounds_of(trail, given(given=(10, 0), steps=(5, 0)), WHOLE).contradiction
    loss = {"tick": 30, "reason": "cable", "steps": [22, 0], "most": [50, 2], "found": False, "known": "between"}
    trail.add("lost", loss)
    assert bounds_of(trail, None, WHOLE).most == (50, 2)
    assert bounds_of(trail, given(), WHOLE).most == (50, 2)
    trail.damaged = True
    assert bounds_of(trail, given(), WHOLE).most == tuple(WHOLE)


def told(counts: tuple[int, int], **more: object) -> Told:
    from gproof.backend.boards.board import Executed

    made = tuple(Executed(count, 0) for count in counts)
    base = Told(moving=False, section=0, identity=bytes.fromhex(TWO.certificate), executed=made)
    return replace(base, **more)


def test_what_the_board_says_counts_only_where_it_is_of_this_run() -> None:
    identity = bytes.fromhex(TWO.certificate)
    assert of_this_run(told((1, 1)), identity, 0, 2) == ""
    assert "another stream" in of_this_run(told((1, 1), identity=bytes(32)), identity, 0, 2)
    assert "section 0, not of 1" in of_this_run(told((1, 1)), identity, 1, 2)
    assert "knows no stream" in of_this_run(told((1, 1), section=None), identity, 0, 2)
    assert "2 motors, not 3" in of_this_run(told((1, 1)), identity, 0, 3)
    trail = open_trail()
    before, section, record = bounds_of(trail, given(), WHOLE), trail.open_section, trail.record()
    assert section is not None and section.known is Known.BETWEEN
    found = merged(before, told((40, 2)), section, None, record, begun=True)
    assert (found.least, found.most, found.source) == ((40, 2), (40, 2), Source.BOARD)
    counting = replace(
        record, board=replace(record.board, counting=Counting(levels=(1, 1), rest=1 << 30, lead=1 << 16))
    )
    other = merged(before, told((40, 2)), section, TWO.stream.sections[0], counting, begun=True)
    assert (other.least, other.most, other.proved) == ((25, 0), (60, 4), False), "another CRC: not believed"
    # An earlier run of the same section: no more than so many, and none that this run is known to have made.
    found = merged(before, told((40, 2)), section, None, record, begun=False)
    assert (found.least, found.most) == ((25, 0), (40, 2))
    found = merged(before, told((40, 2), moving=True), section, None, record, begun=True)
    assert (found.least, found.most) == ((40, 2), (60, 4))
    for counts in ((24, 0), (61, 0), (40, 5)):
        assert merged(before, told(counts), section, None, record, begun=True).contradiction


def test_the_place_in_the_program_holds_every_step() -> None:
    section = TWO.stream.sections[0]
    ticks = [
        [tick_of_step(runs, n) for n in range(1, count + 1)] for runs, count in zip(section.runs, WHOLE, strict=True)
    ]
    for least, lines in (((0, 0), (1, 1)), ((WHOLE[0] // 2, 0), (1, 1)), ((WHOLE[0], WHOLE[1] // 2), (2, 2))):
        place = place_of(section, TWO.trace, TWO.machine, TWO.stream.motors, least=least, most=least)
        assert place is not None
        assert (place.from_line[1], place.to_line[1]) == lines, least
        assert place.begin == max((t[n - 1] for t, n in zip(ticks, least, strict=True) if n), default=0)
    place = place_of(section, TWO.trace, TWO.machine, TWO.stream.motors, least=(1, 0), most=None)
    assert place is not None and place.end == section.duration and place.from_line[1] == 1
