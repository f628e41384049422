"""`gproof run` and what it leaves: records, journals, what the next start says of a run that did not end."""

from __future__ import annotations

import dataclasses
import errno
import json
import os
import shutil
import signal
import subprocess
import time
from pathlib import Path
from typing import Any

import pytest
from support.command import COMMAND, Done, in_this_process

from gproof.backend.journal import DAMAGED, ENDED, SUFFIX, read_journal
from gproof.backend.record import parse_record, read_record
from gproof.backend.record_data import ExecutionRecord, Result, canonical
from gproof.cli import run_journal
from gproof.cli.run_journal import Keeper
from gproof.driver.errors import UsageError
from gproof.verify.certificate.keys import create_key, load_or_create_key, public_key_text

MACHINE = """schema = "gproof-machine/1"
units = "mm"
[axes.x]
min = 0
max = 100
steps_per_unit = 100
max_velocity = 10
max_acceleration = 100
[controller]
fifo_time = 2  # a machine that is busy otherwise must not run the board dry
"""
JOB = "G21 G90\nG1 F300 X4\nM0\nG1 X0\nM30\n"
LONG = "G21 G90\nG1 F300 X40\nM0\nG1 X90\nM30\n"
RUN = ["run", "job.gpx", "--board", "virtual"]


@pytest.fixture(scope="module")
def packages(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("packages")
    (folder / "machine.toml").write_text(MACHINE)
    create_key(folder / "signing-key.pem")
    for name, text in (("job", JOB), ("long", LONG)):
        (folder / f"{name}.cnc").write_text(text)
        words = ["compile", f"{name}.cnc", "--machine", "machine.toml", "--setup", "zero", "-o", f"{name}.gpx"]
        words += ["--key", "signing-key.pem"]
        assert in_this_process(words, folder).exit == 0
    return folder


@pytest.fixture
def shop(packages: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with two packages, and a user's folder of its own."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    keys = tmp_path / "config" / "gproof"
    keys.mkdir(parents=True, mode=0o700)
    shutil.copy(packages / "signing-key.pem", keys)
    shop = tmp_path / "shop"
    shop.mkdir()
    for name in ("job", "long"):
        (shop / f"{name}.gpx").write_bytes((packages / f"{name}.gpx").read_bytes())
    return shop


def runs(shop: Path) -> Path:
    return shop.parent / "config" / "gproof" / "runs"


def only(shop: Path, suffix: str) -> Path:
    (path,) = runs(shop).glob(f"*{suffix}")
    return path


def run(shop: Path, *more: str) -> Done:
    return in_this_process([*RUN, *more], shop)


def test_a_run_leaves_a_signed_record_and_a_closed_journal(shop: Path) -> None:
    done = run(shop, "--record", "record.json")
    assert (done.exit, done.err) == (0, "")
    assert "in record.json" in done.out
    assert read_journal(only(shop, ENDED)).closed
    assert not list(runs(shop).glob(f"*{SUFFIX}"))
    value = json.loads((shop / "record.json").read_bytes())
    assert value["signature"]["created"]
    assert value["accepted"] == "trusted-key"
    assert "sections.steps" in value["unproved"]
    record = read_record(shop / "record.json")
    assert record.result is Result.COMPLETED
    assert run(shop, "--record", "record.json", "--replace-record").exit == 0
    assert read_record(shop / "record.json") == record


def test_a_record_is_kept_when_nobody_asked_for_it(shop: Path) -> None:
    done = run(shop)
    record = read_record(only(shop, ".record.json"))
    assert f"  record      {record.sha256}\n" in done.out
    given = run(shop, "--runs", str(shop / "here"))
    assert given.exit == 0
    assert len(list((shop / "here").glob("*.record.json"))) == 1


# Whom a record may replace.


@pytest.mark.parametrize("text", ["my notes", "{}", '{"schema":"gproof-machine/1"}', "", "[" * 5000, "\xff"])
def test_what_is_no_record_is_never_overwritten(text: str, shop: Path) -> None:
    (shop / "record.json").write_text(text)
    for more in ([], ["--replace-record"]):
        done = run(shop, "--record", "record.json", *more)
        assert done.exit == 3
        assert "is not an execution record; choose another name" in done.err
    assert (shop / "record.json").read_text() == text
    assert not runs(shop).exists()


def test_a_record_of_an_earlier_run_is_replaced_when_somebody_says_so(
    shop: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert run(shop, "--record", "record.json").exit == 0
    before = (shop / "record.json").read_bytes()
    done = run(shop, "--record", "record.json")
    assert (done.exit, done.out) == (3, "")
    assert "record record.json: already exists; use --replace-record to replace it" in done.err
    monkeypatch.setattr(run_journal, "_somebody_is_there", lambda: True)
    monkeypatch.setattr(run_journal.click, "confirm", lambda *_, **__: False)
    assert run(shop, "--record", "record.json").exit == 3
    assert (shop / "record.json").read_bytes() == before
    monkeypatch.setattr(run_journal.click, "confirm", lambda *_, **__: True)
    assert run(shop, "--record", "record.json").exit == 0
    assert (shop / "record.json").read_bytes() != before


def test_what_came_there_during_the_run_is_not_overwritten(shop: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    keep = Keeper.keep

    def late(self: Keeper, record: ExecutionRecord) -> Any:
        (shop / "record.json").write_text("a letter")
        return keep(self, record)

    monkeypatch.setattr(Keeper, "keep", late)
    done = run(shop, "--record", "record.json")
    assert done.exit == 0
    assert (shop / "record.json").read_text() == "a letter"
    assert "warning GP838" in done.out
    assert read_record(only(shop, ".record.json")).result is Result.COMPLETED


# Full disks, closed streams, signals while closing.


def full(monkeypatch: pytest.MonkeyPatch, *places: str) -> None:
    write = ExecutionRecord.write

    def writing(self: ExecutionRecord, path: Path, signature: dict[str, str] | None = None) -> None:
        if any(place in str(path.absolute()) for place in places):
            raise OSError(errno.ENOSPC, "No space left on device")
        write(self, path, signature)

    monkeypatch.setattr(ExecutionRecord, "write", writing)


def test_a_record_that_finds_no_room_goes_elsewhere(shop: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(shop.parent / "scratch"))
    (shop.parent / "scratch").mkdir()
    full(monkeypatch, "/shop/")
    done = run(shop, "--record", "record.json")
    assert done.exit == 0
    assert "the record cannot be written to record.json (No space left on device)" in done.out
    assert f", in {only(shop, '.record.json')}\n" in done.out, "whole, however long"
    full(monkeypatch, "/shop/", "/config/")
    done = run(shop, "--record", "record.json")
    (scratch,) = (shop.parent / "scratch").iterdir()
    assert read_record(scratch).result is Result.COMPLETED
    assert f"in {scratch}\n" in done.out
    assert "motor X" in done.out


def test_a_record_that_no_folder_takes_is_printed(shop: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    full(monkeypatch, "/")
    done = run(shop)
    assert done.exit == 0
    line = next(line for line in done.err.splitlines() if line.startswith("{"))
    assert parse_record(line.encode()).result is Result.COMPLETED
    assert "motor X" in done.out
    # The journal stays open: the next start makes the record, and has nothing to ask.
    monkeypatch.undo()
    monkeypatch.setenv("XDG_CONFIG_HOME", str(shop.parent / "config"))
    again = run(shop)
    assert again.exit == 0
    assert "did not close its journal" in again.err
    assert "result      completed" in again.err
    assert len(list(runs(shop).glob(f"*{ENDED}"))) == 2


def test_a_disk_that_fills_up_during_the_run_ends_it_at_rest(shop: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write, count = os.write, [0]

    def writing(handle: int, data: bytes) -> int:
        count[0] += 1
        if count[0] >= 4:
            raise OSError(errno.ENOSPC, "No space left on device")
        return write(handle, data)

    monkeypatch.setattr(os, "write", writing)
    done = in_this_process(["run", "long.gpx", "--board", "virtual"], shop)
    monkeypatch.undo()
    monkeypatch.setenv("XDG_CONFIG_HOME", str(shop.parent / "config"))
    assert done.exit == 1
    assert "long.gpx: stopped: section 0: the journal cannot be written (No space left on device)" in done.out
    assert "motor X" in done.out
    record = read_record(only(shop, ".record.json"))
    assert record.result is Result.STOPPED
    assert 0 < record.position[0] < 4000


@pytest.mark.parametrize("spoilt", [False, True])
def test_the_record_of_a_run_that_found_the_disk_full_is_not_replaced_by_one_that_says_less(
    spoilt: bool, shop: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The run could tell how it ended, its journal could not; the disk is full still when the next start looks."""
    scratch = shop.parent / "scratch"
    scratch.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(scratch))
    full(monkeypatch, "/shop/", "/config/")
    write, count = os.write, [0]

    def writing(handle: int, data: bytes) -> int:
        if b'"kind"' in bytes(data):
            count[0] += 1
            if count[0] > 4:
                raise OSError(errno.ENOSPC, "No space left on device")
        return write(handle, data)

    monkeypatch.setattr(os, "write", writing)
    done = run(shop, "--record", "record.json")
    assert done.exit == 1
    (kept,) = scratch.iterdir()
    before = kept.read_bytes()
    known = read_record(kept).position
    assert known is not None
    if spoilt:  # Of another run, and no record of this one any more.
        kept.write_bytes(before.replace(b'"created":"2', b'"created":"3'))
        before = kept.read_bytes()
    monkeypatch.setattr(os, "write", write)
    again = run(shop)
    assert kept.read_bytes() == before
    if spoilt:
        assert (again.exit, "gproof was killed" in again.err) == (2, True)
        return
    assert f", at step {known[0]} " in again.err.replace("\n", " ")
    assert "gproof was killed" not in again.err
    assert str(kept) in again.err
    assert again.exit == 0, "nobody has to be asked"
    assert not list(runs(shop).glob(f"*{SUFFIX}"))


def test_a_run_that_can_leave_no_trace_does_not_begin(shop: Path) -> None:
    runs(shop).write_text("a file where the folder should be")
    done = run(shop)
    assert (done.exit, done.out) == (3, "")
    assert "nothing was moved" in done.err
    assert len(done.err.splitlines()) <= 2


def test_journals_that_others_can_write_are_not_used(shop: Path) -> None:
    (shop / "open").mkdir()
    (shop / "open").chmod(0o777)
    (shop / "link").symlink_to(shop / "own")
    for place in ("open", "open/deeper", "link"):
        done = run(shop, "--runs", place)
        assert (done.exit, done.out) == (3, "")
        assert "choose with --runs a folder that only you can write" in done.err
    assert list((shop / "open").iterdir()) == []
    assert run(shop, "--runs", "own/deeper").exit == 0
    assert (shop / "own").stat().st_mode & 0o777 == 0o700


def test_a_board_runs_one_job_at_a_time_and_virtual_ones_are_many(shop: Path) -> None:
    folder = shop / "held"
    with run_journal.alone(folder, "port-1"), run_journal.alone(folder, "port-2"):
        with pytest.raises(UsageError, match="another run is using it"), run_journal.alone(folder, "port-1"):
            raise AssertionError
        with run_journal.alone(folder, "virtual"), run_journal.alone(folder, "virtual"):
            assert run(shop).exit == 0
    with run_journal.alone(folder, "port-1"):
        pass
    with pytest.raises(UsageError, match="journals cannot be kept"), run_journal.alone(shop / "job.gpx", "port-1"):
        raise AssertionError


def test_a_closed_standard_output_loses_neither_record_nor_positions(shop: Path) -> None:
    command = subprocess.list2cmdline([*COMMAND, *RUN, "--record", "record.json"])
    done = subprocess.run(
        ["bash", "-c", f"{command} >/dev/full"], cwd=shop, capture_output=True, text=True, check=False
    )
    assert done.returncode == 3
    assert "  motor X     800 steps, ends at step 0 (0.0000)\n" in done.stderr
    assert read_record(shop / "record.json").result is Result.COMPLETED
    with subprocess.Popen([*COMMAND, *RUN], cwd=shop, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        told = process.stderr.read().decode()
        assert process.wait(60) == 3
    assert "motor X" in told
    assert len(list(runs(shop).glob("*.record.json"))) == 1
    assert not list(runs(shop).glob(f"*{SUFFIX}"))


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_signals_while_closing_do_no_harm(number: signal.Signals, shop: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    keep, say = Keeper.keep, run_journal.write_record

    def kept(self: Keeper, record: ExecutionRecord) -> Any:
        os.kill(os.getpid(), number)
        return keep(self, record)

    def written(*words: Any) -> Any:
        os.kill(os.getpid(), number)
        os.kill(os.getpid(), number)
        return say(*words)

    monkeypatch.setattr(Keeper, "keep", kept)
    monkeypatch.setattr(run_journal, "write_record", written)
    done = run(shop, "--record", "record.json")
    assert (done.exit, done.err) == (0, "")
    assert read_record(shop / "record.json").result is Result.COMPLETED
    assert "motor X" in done.out
    assert not list(runs(shop).glob(f"*{SUFFIX}"))


WATCHED = """
import os, signal, sys
from gproof.cli.main import main
sys.argv[1:] = {words!r}
code = main()
os.kill(os.getpid(), signal.{name})
os.kill(os.getpid(), signal.{name})
print("still there")
sys.exit(code)
"""


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP"])
def test_signals_after_the_run_change_neither_exit_code_nor_what_is_said(name: str, shop: Path) -> None:
    import sys

    text = WATCHED.format(words=RUN, name=name)
    done = subprocess.run([sys.executable, "-c", text], cwd=shop, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.endswith("still there\n")


def test_a_program_that_calls_the_command_hears_its_signals_afterwards(shop: Path) -> None:
    before = [signal.getsignal(n) for n in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)]
    assert run(shop).exit == 0
    assert [signal.getsignal(n) for n in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)] == before


def test_a_closed_standard_input_answers_nothing(shop: Path) -> None:
    command = subprocess.list2cmdline([*COMMAND, *RUN, "--ask"])
    done = subprocess.run(["bash", "-c", f"{command} <&-"], cwd=shop, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "stopped: section 0: ended while waiting (operator)" in done.stdout


# Processes that are ended in the middle.


def begun(shop: Path, *more: str) -> subprocess.Popen[str]:
    """A run in real time that is under way: its journal says that the board has acknowledged something."""
    command = [*COMMAND, "run", "long.gpx", "--board", "virtual", "--real-time", *more]
    process = subprocess.Popen(
        command, cwd=shop, stdout=subprocess.PIPE, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL, text=True
    )
    for _ in range(2400):
        paths = list(runs(shop).glob(f"*{SUFFIX}"))
        if paths and any(kind == "at" for kind, _ in read_journal(paths[0]).entries):
            return process
        time.sleep(0.05)
    raise AssertionError(process.communicate())


@pytest.mark.parametrize(
    ("number", "result"),
    [
        (signal.SIGTERM, Result.EMERGENCY_STOP),
        (signal.SIGHUP, Result.EMERGENCY_STOP),
        (signal.SIGINT, Result.STOPPED),
    ],
)
def test_a_signal_stops_the_board_and_closes(number: signal.Signals, result: Result, shop: Path) -> None:
    process = begun(shop, "--record", "record.json")
    process.send_signal(number)
    out, err = process.communicate(timeout=120)
    assert process.returncode == 130, err
    assert f"long.gpx: {result.value}" in out
    record = read_record(shop / "record.json")
    assert record.result is result
    assert 0 < record.position[0] < 9000
    assert f"ends at step {record.position[0]}" in out
    assert not list(runs(shop).glob(f"*{SUFFIX}"))


def test_a_killed_run_is_told_and_asked_about_at_the_next_start(shop: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    process = begun(shop, "--record", "record.json")
    # Nobody else has it while its process lives.
    assert run(shop).exit == 0
    process.kill()
    process.communicate()
    refused = run(shop)
    assert (refused.exit, refused.out) == (2, "")
    assert "unknown GP837 [run-interrupted]" in refused.err
    assert "position not known, last acknowledged at step" in refused.err
    assert "--after-interruption" in refused.err
    record = read_record(shop / "record.json")
    assert record.result is Result.INTERRUPTED
    assert record.position is None
    assert record.steps[0] > 0
    written = (shop / "record.json").read_bytes()
    assert json.loads(written)["signature"]["created"]
    checked = in_this_process(["verify", "record.json", "--package", "long.gpx"], shop)
    assert (checked.exit, checked.err) == (0, "")
    assert "position not known" in checked.out
    # It is asked until somebody answers; the record is made once.
    assert run(shop).exit == 2
    monkeypatch.setattr(run_journal, "_somebody_is_there", lambda: True)
    monkeypatch.setattr(run_journal.click, "confirm", lambda *_, **__: False)
    assert run(shop).exit == 2
    assert (shop / "record.json").read_bytes() == written
    monkeypatch.setattr(run_journal.click, "confirm", lambda *_, **__: True)
    assert run(shop).exit == 0
    monkeypatch.setattr(run_journal, "_somebody_is_there", lambda: False)
    assert run(shop).exit == 0
    assert (shop / "record.json").read_bytes() == written


def test_the_record_of_a_killed_run_is_not_overwritten_by_the_next_one(shop: Path) -> None:
    process = begun(shop, "--record", "record.json")
    process.kill()
    process.communicate()
    done = run(shop, "--record", "record.json", "--after-interruption")
    assert done.exit == 0
    assert "the record cannot be written to record.json (a file with this name" in done.out
    assert read_record(shop / "record.json").result is Result.INTERRUPTED
    assert read_record(only(shop, ".record.json")).result is Result.COMPLETED


def test_an_answer_beforehand_and_a_damaged_journal(shop: Path) -> None:
    process = begun(shop)
    process.kill()
    process.communicate()
    (path,) = runs(shop).glob(f"*{SUFFIX}")
    data = path.read_bytes()
    path.write_bytes(data[:30] + b"?" + data[31:])
    refused = run(shop)
    assert refused.exit == 2
    assert "damaged from its first line" in refused.err
    done = run(shop, "--after-interruption")
    assert done.exit == 0
    assert only(shop, DAMAGED).read_bytes() == data[:30] + b"?" + data[31:]
    assert run(shop).exit == 0


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes")
@pytest.mark.parametrize(
    "words", [("verify", "pipe"), ("verify", "pipe", "--package", "job.gpx"), ("run", "pipe", "--board", "virtual")]
)
def test_a_pipe_for_a_package_or_record_keeps_nobody_waiting(words: tuple[str, ...], shop: Path) -> None:
    os.mkfifo(shop / "pipe")
    done = subprocess.run([*COMMAND, *words], cwd=shop, capture_output=True, text=True, check=False, timeout=100)
    assert (done.returncode, done.stdout) == (3, "")
    assert done.stderr.count("\n") == 1


def test_what_is_no_file_among_the_journals_keeps_nobody_waiting(shop: Path) -> None:
    runs(shop).mkdir(parents=True, mode=0o700)
    for make in (os.mkfifo, os.mkdir):
        there = runs(shop) / "x.journal"
        make(there)
        done = run(shop)
        assert (done.exit, done.out) == (3, "")
        assert "x.journal" in done.err
        there.rmdir() if there.is_dir() else there.unlink()


@pytest.mark.parametrize("data", [bytes(4096), b"\xff" * 10, b"0123 {}", b"f" * 65])
def test_an_end_that_is_no_line_is_damage(data: bytes, shop: Path) -> None:
    """Blocks of nothing, as file systems leave them where the power went; nobody knows what stood there."""
    runs(shop).mkdir(parents=True, mode=0o700)
    (runs(shop) / "20260101T000000Z-virtual-0.journal").write_bytes(data)
    done = run(shop)
    assert (done.exit, "damaged from its first line" in done.err) == (2, True)


def test_a_start_that_was_killed_before_it_began_leaves_nothing(shop: Path) -> None:
    runs(shop).mkdir(parents=True)
    (runs(shop) / "20260101T000000Z-virtual-0.journal").write_bytes(b"")
    (runs(shop) / "20260101T000000Z-virtual-1.journal").write_bytes(b"0123456789")
    assert run(shop).exit == 0
    assert not list(runs(shop).glob(f"*{SUFFIX}"))


def test_an_interrupt_before_anything_moves_leaves_nothing(shop: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def checking(*_: object) -> None:
        os.kill(os.getpid(), signal.SIGTERM)

    monkeypatch.setattr("gproof.backend.job.check_package", checking)
    done = run(shop)
    assert (done.exit, done.out, done.err) == (130, "", "gproof: interrupted\n")
    assert list(runs(shop).iterdir()) == []


# Records, checked.


@pytest.fixture
def made(shop: Path) -> Path:
    assert run(shop, "--record", "record.json", "--estop-at", "0.5").exit == 1
    return shop


def verify(shop: Path, *more: str) -> Done:
    return in_this_process(["verify", "record.json", *more], shop)


def test_a_record_of_the_own_key_holds(made: Path) -> None:
    done = verify(made)
    assert (done.exit, done.err) == (0, "")
    assert done.out.startswith("record.json: the record is valid\n")
    assert "(your own key)" in done.out
    assert "compared    with nothing" in done.out
    assert "not proved" in done.out
    assert "result      emergency-stop" in done.out
    assert verify(made, "--package", "job.gpx").exit == 0


def test_a_record_of_another_package_does_not_hold(made: Path) -> None:
    done = verify(made, "--package", "long.gpx")
    assert done.exit == 1
    assert "error GP833" in done.out
    assert "record.json: the record is not valid" in done.out


def test_a_record_is_compared_with_no_package_that_cannot_be_read(made: Path) -> None:
    (made / "spoilt.gpx").write_bytes((made / "job.gpx").read_bytes()[:-100])
    done = verify(made, "--package", "spoilt.gpx")
    assert done.exit == 1
    assert "compared    with nothing; spoilt.gpx cannot be compared with" in done.out


def test_changed_records_do_not_hold(made: Path) -> None:
    value = json.loads((made / "record.json").read_bytes())

    def written(change: Any) -> None:
        other = json.loads(json.dumps(value))
        change(other)
        (made / "record.json").write_text(json.dumps(other, sort_keys=True, separators=(",", ":")))

    def told(code: str, exit_code: int = 1) -> None:
        done = verify(made)
        assert done.exit == exit_code, done
        assert code in done.out

    written(lambda v: v["steps"].__setitem__(0, 5))
    told("GP834")
    written(lambda v: v["signature"].__setitem__("created", "2020-01-01T00:00:00+00:00"))
    told("GP835")
    written(lambda v: v["signature"].__setitem__("package_signer", ""))
    told("GP835")
    written(lambda v: v["signature"].pop("comment"))
    told("GP835")
    written(lambda v: v["signature"].__setitem__("public_key", "AAAA"))
    told("GP835")
    written(lambda v: v.pop("signature"))
    told("GP836", 2)
    written(lambda v: v.__setitem__("signature", 5))
    told("GP834")
    written(lambda v: v.__setitem__("schema", "gproof-record/9"))
    told("GP834")
    (made / "record.json").write_text("{")
    told("GP834")
    # What other programs would read otherwise: a key twice, blanks, another order.
    whole = canonical(value)
    for other_spelling in (
        whole.replace(b'{"accepted":', b'{"accepted":"trusted-key","accepted":', 1),
        json.dumps(value, sort_keys=True).encode(),
        json.dumps(dict(reversed(value.items())), separators=(",", ":")).encode(),
        b"\xef\xbb\xbf" + whole,
        whole + b"\n\n",
    ):
        (made / "record.json").write_bytes(other_spelling)
        told("GP834" if other_spelling[:1] == b"{" else "")
    # Made anew with a hash that fits: the signature does not.
    record = parse_record(canonical(value))

    other = dataclasses.replace(
        record, position=(1,), sections=(dataclasses.replace(record.sections[0], position=(1,)),)
    )
    (made / "record.json").write_bytes(other.to_json(value["signature"]))
    told("GP835")


def test_a_record_of_a_stranger_holds_for_who_trusts_him(
    made: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    key = load_or_create_key(tmp_path / "config" / "gproof" / "signing-key.pem")
    (made / "friend.pem").write_text(public_key_text(key))
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "elsewhere"))
    done = verify(made)
    assert done.exit == 2
    assert "unknown GP836" in done.out
    assert verify(made, "--trust", "friend.pem").exit == 0
    assert not (tmp_path / "elsewhere").exists()


def test_options_of_packages_and_of_records(made: Path) -> None:
    for words in (
        ["verify", "job.gpx", "--package", "job.gpx"],
        ["verify", "record.json", "--machine", "job.gpx"],
        ["verify", "record.json", "--package", "nothere.gpx"],
        ["verify", "record.json", "--trust", "record.json"],
    ):
        done = in_this_process(words, made)
        assert (done.exit, done.out) == (3, ""), words
        assert len(done.err.splitlines()) == 1


def test_a_key_that_others_can_read_signs_nothing_and_stops_nothing(shop: Path) -> None:
    place = shop.parent / "config" / "gproof" / "signing-key.pem"
    load_or_create_key(place)
    place.chmod(0o644)
    done = run(shop)
    assert (done.exit, "GP827" in done.out) == (2, True), "who reads it signs with it too"
    done = run(shop, "--record", "record.json", "--allow-untrusted")
    assert done.exit == 0
    assert "your own key is not trusted" in done.err
    assert "warning: the record will not be signed" in done.err
    assert verify(shop).exit == 2
