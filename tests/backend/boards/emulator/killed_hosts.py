"""Hosts that are killed in the middle of a run on an emulated board: a process that forks one for each point.

`python killed_hosts.py FOLDER PROFILE JOB POINT...`: a child runs a job with a journal in FOLDER/POINT and is killed
(SIGKILL) when its POINT-th call begins or ends: writes and reads of the line, writes and syncs of the journal, writes
of the mark; `half` before the number: a write is cut in the middle first. The board lives on in a process that was
forked off at that moment, and when its motors are at rest says what it made, and what `status` says of the run. `count`
as the only point prints how many calls there are. A line of JSON for each point.
"""

from __future__ import annotations

import json
import os
import signal
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any
from unittest import mock

from backend.boards.emulator.emulated_line import EmulatedLine
from backend.boards.emulator.link_campaign import PINS, WIRING, jobs
from backend.streams import FREQUENCY

from gproof.backend import journal as journals
from gproof.backend import runtime
from gproof.backend.boards.emulator.emulator import Emulator, Options
from gproof.backend.boards.emulator.log_reader import read
from gproof.backend.boards.klipper.counts import asked
from gproof.backend.boards.klipper.driver import KlipperBoard
from gproof.driver import run_status

runtime.NOTED = 0.1
SYNCED = ("begin", "section", "ended", "end", "lost", "found")


class Bomb:
    """Counts calls and fires at one of them. Several threads may call."""

    def __init__(self, at: int, half: bool, fire: Callable[[], None]) -> None:
        self.at, self.half, self.fire = at, half, fire
        self.count = 0

    def tick(self) -> bool:
        self.count += 1
        return self.count == self.at

    def wrap(self, call: Any, data: int | None = None) -> Any:
        """data: which argument holds the bytes of a write."""

        def counted(*words: Any) -> Any:
            if self.tick():
                if data is not None and self.half:
                    call(*words[:data], words[data][: len(words[data]) // 2], *words[data + 1 :])
                self.fire()
            out = call(*words)
            if self.tick():
                self.fire()
            return out

        return counted


def made_by(board: Emulator) -> tuple[list[int], list[int]]:
    """Steps and positions by motor, from the board's own log."""
    board.finish()
    told = read(board.log.held)
    parts = [told.steps.of(pin) for pin in PINS]
    return [len(ticks) for ticks, _ in parts], [int(directions.sum()) for _, directions in parts]


def said(status: run_status.RunStatus) -> dict[str, Any]:
    """What `status` says, as plain values."""
    out: dict[str, Any] = {"state": status.state, "contradiction": status.contradiction}
    if status.record is None:
        return out
    most = status.most
    out |= {"least": status.least, "most": most, "position": status.position, "exact": status.exact}
    out |= {"result": status.record.result.value, "board": status.board}
    if status.place is not None:
        out |= {"window": [status.place.begin, status.place.end], "section": status.record.sections[-1].number}
    return out


def judge(place: Path, board: Emulator, job_number: int) -> dict[str, Any]:
    """What the board had made when its host died, what it made at the end, and what `status` says of it."""
    one = jobs()[job_number]
    at_kill, _ = made_by(board)
    board.connected = True
    board.advance(board.now + 40 * 10**9)
    made, position = made_by(board)
    found = sorted(place.glob("*.journal")) + sorted(place.glob("*.ended"))
    told: dict[str, Any] = {"at_kill": at_kill, "made": made, "position": position, "journals": len(found)}
    if not found:
        return told
    with (
        mock.patch.object(run_status, "_job", lambda *_: (one, "")),
        mock.patch.object(run_status, "is_held", lambda _: False),
    ):
        told["alone"] = said(run_status.status_of(found[0], None))
        line = EmulatedLine(board)
        told["asked"] = said(
            run_status.status_of(found[0], None, lambda motors, identity: asked(line, motors, identity))
        )
        # After a power failure: no mark, and of the journal only what was synced.
        for mark in place.glob("*.mark"):
            mark.unlink()
        lines = found[0].read_bytes().splitlines(keepends=True)
        whole = [line for line in lines if line.endswith(b"\n")]
        kinds = [json.loads(line[65:])["kind"] for line in whole]
        last = max((k for k, kind in enumerate(kinds) if kind in SYNCED), default=-1)
        found[0].write_bytes(b"".join(whole[: last + 1]))
        told["power"] = said(run_status.status_of(found[0], None))
    return told


def run(place: Path, at: int, half: bool, certified: bool, job_number: int, out: int) -> int:
    """The run of a child that is killed; how many calls there were where it is not."""
    board = Emulator(Options(certified=certified, frequency=FREQUENCY, baud=1_000_000))
    line = EmulatedLine(board)

    def fire() -> None:
        alive, parent = os.pipe()
        if os.fork():
            os.kill(os.getpid(), signal.SIGKILL)
        os.close(parent)
        os.read(alive, 1)  # Until the host is dead.
        with os.fdopen(out, "w") as file:
            json.dump(judge(place, board, job_number), file)
        os._exit(0)

    bomb = Bomb(at, half, fire)
    line.read, line.write = bomb.wrap(line.read), bomb.wrap(line.write)  # type: ignore[method-assign]
    os.write, os.fsync = bomb.wrap(os.write, 1), bomb.wrap(os.fsync)
    os.pwrite = bomb.wrap(os.pwrite, 1)
    journal = journals.begin(place, "klipper", {"package": "job.gpx"}, marks=place, behind=True)
    runtime.walk(
        jobs()[job_number], KlipperBoard(line.connect, WIRING, pulse=2, direction_setup=5), journal=journal,
        override=0.7 if certified else 1,
    )  # fmt: skip
    journal.close("record.json")
    return bomb.count


def main() -> None:
    folder, certified, job_number = Path(sys.argv[1]), sys.argv[2] == "certified", int(sys.argv[3])
    for point in sys.argv[4:]:
        place = folder / f"{sys.argv[2]}-{job_number}-{point}"
        place.mkdir(parents=True)
        ready, out = os.pipe()
        child = os.fork()
        if child == 0:
            os.close(ready)
            at = 0 if point == "count" else int(point.removeprefix("half"))
            count = run(place, at, point.startswith("half"), certified, job_number, out)
            with os.fdopen(out, "w") as file:
                json.dump({"count": count}, file)
            os._exit(0)
        os.close(out)
        with os.fdopen(ready) as file:
            told = json.load(file)
        _, status = os.waitpid(child, 0)
        print(json.dumps({"point": point, "status": os.waitstatus_to_exitcode(status), **told}), flush=True)


if __name__ == "__main__":
    main()
