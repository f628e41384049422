"""Runs that end in the middle: a process that forks one for each point and says how it went.

`python killed_runs.py FOLDER SIGNAL POINT...`: for each point a child runs the job `TWO` on a virtual board, with a
journal in FOLDER/POINT, and gets the signal when its POINT-th call begins or ends (calls of the board, writes and syncs
of the file system count; `half` before the number: a write is cut in the middle first; two numbers with a comma
between: it gets the signal twice). What the board really did
goes into a map of shared memory as it happens, which nothing that ends the process can lose. `count` as the only point
prints how many there are. Prints a line of JSON for each: exit status, what the board did, the record that came back.
"""

from __future__ import annotations

import json
import mmap
import os
import signal
import struct
import sys
from pathlib import Path
from typing import Any

from backend.test_runtime import TWO, Tap

from gproof.backend import journal as journals
from gproof.backend import runtime
from gproof.backend.boards.board import Status
from gproof.backend.control import Control
from gproof.backend.interrupts import interrupts

WORDS = 6
runtime.NOTED = 0.1


class Bomb:
    """Counts calls and fires at one of them."""

    def __init__(self, at: set[int], number: signal.Signals, half: bool) -> None:
        self.at, self.number, self.half = at, number, half
        self.count = 0

    def tick(self) -> bool:
        self.count += 1
        return self.count in self.at

    def fire(self) -> None:
        os.kill(os.getpid(), self.number)

    def wrap(self, call: Any, *, writes: bool = False) -> Any:
        def counted(*words: Any) -> Any:
            if self.tick():
                if writes and self.half:
                    call(words[0], words[1][: len(words[1]) // 2])
                self.fire()
            out = call(*words)
            if self.tick():
                self.fire()
            return out

        return counted


class Watched(Tap):
    """A virtual board whose doings are written down where the end of the process does not reach them."""

    def __init__(self, memory: mmap.mmap) -> None:
        self.memory = memory
        super().__init__(2, fifo_runs=200)

    def _run(self, until: int) -> None:
        super()._run(until)
        self._tell()

    def start_section(self, number: int, start: tuple[int, ...], lead: int) -> int:
        base = super().start_section(number, start, lead)
        self._tell()
        return base

    def _tell(self) -> None:
        status: Status = super().status()
        words = [*status.steps, *status.position, self._now, status.events]
        self.memory[: 8 * WORDS] = struct.pack(f"={WORDS}q", *words)


def run(folder: Path, bomb: Bomb, memory: mmap.mmap) -> None:
    """The run of a child."""
    board: Any = Watched(memory)
    for name in ("start_section", "queue_runs", "commit", "wait", "status", "finish_section", "take_events", "close"):
        setattr(board, name, bomb.wrap(getattr(board, name)))
    os.write, os.fsync = bomb.wrap(os.write, writes=True), bomb.wrap(os.fsync)
    control = Control()
    with interrupts(control):
        journal = journals.begin(folder, "virtual", {})
        done = runtime.walk(TWO, board, control=control, journal=journal)
        control.closing()
        done.write(folder / "record.json")
        journal.close(str(folder / "record.json"))


def main() -> None:
    folder, number = Path(sys.argv[1]), signal.Signals[sys.argv[2]]
    for point in sys.argv[3:]:
        place = folder / point
        memory = mmap.mmap(-1, 8 * WORDS)
        child = os.fork()
        if child == 0:
            half = point.startswith("half")
            at = set() if point == "count" else {int(number) for number in point.removeprefix("half").split(",")}
            bomb = Bomb(at, number, half)
            run(place, bomb, memory)
            if point == "count":
                (folder / "count").with_suffix(".txt").write_text(str(bomb.count))
            os._exit(0)
        _, status = os.waitpid(child, 0)
        words = struct.unpack(f"={WORDS}q", memory[: 8 * WORDS])
        done = {"point": point, "steps": words[:2], "position": words[2:4], "tick": words[4], "events": words[5]}
        print(json.dumps({**done, "status": os.waitstatus_to_exitcode(status)}), flush=True)


if __name__ == "__main__":
    main()
