"""A host that is killed at any point of a run: what `status` says of it, judged by the board's own log.

Never a step that the board has not made, nor one missed but those that were sent and not heard of; to the step where a
board that counts is asked; and never less than the truth after a power failure, when only what was synced is left.
"""

from __future__ import annotations

import errno
import json
import os
import random
import signal
import subprocess
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import pytest
from backend.boards.emulator.emulated_line import EmulatedLine
from backend.boards.emulator.link_campaign import PINS, WIRING, jobs
from backend.streams import FREQUENCY, steps_of
from support.campaigns import sizes

from gproof.backend import journal as journals
from gproof.backend import runtime
from gproof.backend.boards.emulator.emulator import Emulator, Options
from gproof.backend.boards.emulator.log_reader import read
from gproof.backend.boards.klipper.driver import KlipperBoard
from gproof.driver import run_status

HERE = Path(__file__).parent
TESTS = HERE.parents[2]

HEARD = 160_000
"""Ticks (0.16 s) that what the board has made may not have been heard of: readings of the clock are 0.1 s apart, and a
turn of the runtime is 0.05 s."""

AHEAD = 250_000
"""Ticks that are sent ahead at most."""


def killed(folder: Path, profile: str, job: int, points: list[str]) -> list[dict[str, Any]]:
    command = [sys.executable, "-W", "ignore", str(HERE / "killed_hosts.py"), str(folder), profile, str(job), *points]
    done = subprocess.run(
        command, env={**os.environ, "PYTHONPATH": str(TESTS)}, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return [json.loads(line) for line in done.stdout.splitlines()]


def fits(told: dict[str, Any], went: dict[str, Any], *, now: bool = True) -> None:
    """Nothing that `status` says is untrue."""
    if "least" not in told:
        assert went["made"] == [0, 0]
        return
    made = went["made"]
    assert not told["contradiction"]
    claimed = went["at_kill"] if now else made
    assert all(a <= b for a, b in zip(told["least"], claimed, strict=True)), "more is claimed than was made"
    assert told["most"] is not None and all(a <= b for a, b in zip(made, told["most"], strict=True)), "steps are missed"
    assert told["position"] is None or told["position"] == went["position"], "another position"
    assert (told["least"] == told["most"]) == told["exact"]


def in_time(told: dict[str, Any], went: dict[str, Any], job: int) -> None:
    """Where the program is holds the truth, and is no wider than what was on its way and not heard of."""
    if "window" not in told:
        return
    begin, end = told["window"]
    sections = jobs()[job].stream.sections
    number = told["section"]
    motors = [[tick for tick, _ in steps_of(runs)] for runs in sections[number].runs]
    before = [sum(len(steps_of(section.runs[k])) for section in sections[:number]) for k in range(len(motors))]
    for counts in (went["at_kill"], went["made"]):
        made = [count - past for count, past in zip(counts, before, strict=True)]
        if min(made) >= 0 and all(count <= len(ticks) for count, ticks in zip(made, motors, strict=True)):
            last = max((ticks[count - 1] for count, ticks in zip(made, motors, strict=True) if count), default=0)
            coming = [ticks[count] for count, ticks in zip(made, motors, strict=True) if count < len(ticks)]
            assert begin <= min(coming, default=sections[number].duration) and end >= last
    assert end - begin <= HEARD + AHEAD


def judged(went: dict[str, Any], certified: bool, job: int) -> str:
    """What the status of a killed run was; AssertionError: it is wrong."""
    if went["status"] == 0:
        return "not killed"
    assert went["status"] == -signal.SIGKILL
    if not went["journals"]:
        assert went["made"] == [0, 0]
        return "nothing begun"
    alone, asked, power = went["alone"], went["asked"], went["power"]
    fits(alone, went)
    fits(asked, went, now=False)
    fits(power, went)
    if "least" not in alone:
        return "nothing begun"
    in_time(alone, went, job)
    if alone["exact"] and alone["position"] is not None:
        return "known to the step by the journal"
    if certified and asked["exact"]:
        assert asked["least"] == went["made"]
        assert asked["least"] == alone["least"] or "is that of the stream" in asked["board"], asked
        return "known to the step by the board"
    if certified:
        assert any(why in asked["board"] for why in ("acknowledged nothing", "knows no stream", "speaks of")), asked
        return "between, before the first acknowledgement"
    return "between"


@pytest.mark.parametrize("many", sizes(10, 500))
def test_killed_at_any_point_status_says_the_truth(many: int, tmp_path: Path) -> None:
    results: Counter[tuple[str, str]] = Counter()
    for profile, job in (("certified", 0), ("plain", 1)):
        (counted,) = killed(tmp_path / "whole", profile, job, ["count"])
        chance = random.Random(many)
        chosen = chance.sample(range(counted["count"] // 6, counted["count"] + 1), min(many, counted["count"] // 2))
        points = [f"half{n}" if chance.random() < 0.3 else str(n) for n in chosen]
        for went in killed(tmp_path / "runs", profile, job, points):
            try:
                results[profile, judged(went, profile == "certified", job)] += 1
            except AssertionError as error:
                raise AssertionError(f"{profile}, job {job}, point {went['point']}: {error}: {went}") from error
    for (profile, result), times in sorted(results.items()):
        print(f"{profile:9}  {result:45}  {times:5}")
    assert sum(times for (_, result), times in results.items() if "to the step" in result) >= many // 4


@pytest.mark.parametrize("first", [3, 4, 6, 9])
def test_after_a_full_disk_the_mark_still_knows(first: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """From a write on the journal takes nothing more: the run ends at rest, and `status` says what was made."""
    monkeypatch.setattr(runtime, "NOTED", 0.05)
    board = Emulator(Options(frequency=FREQUENCY, baud=1_000_000))
    line = EmulatedLine(board)
    journal = journals.begin(tmp_path / "runs", "klipper", {"package": "job.gpx"}, marks=tmp_path, behind=True)
    write, count = os.write, [0]

    def writing(handle: int, data: bytes) -> int:
        count[0] += 1
        if count[0] >= first:
            raise OSError(errno.ENOSPC, "No space left on device")
        return write(handle, data)

    with monkeypatch.context() as full:
        full.setattr(os, "write", writing)
        record = runtime.walk(
            jobs()[0], KlipperBoard(line.connect, WIRING, pulse=2, direction_setup=5), journal=journal
        )  # fmt: skip
        journal.let_go()
    board.advance(board.now + 40 * 10**9)
    board.finish()
    told = read(board.log.held)
    made = [len(told.steps.of(pin)[0]) for pin in PINS]
    assert list(record.steps) == made
    monkeypatch.setattr(run_status, "_job", lambda *_: (jobs()[0], ""))
    (path,) = (tmp_path / "runs").glob("*.journal")
    status = run_status.status_of(path, None)
    assert status.state == run_status.INTERRUPTED
    assert not status.contradiction
    assert status.most is not None
    assert all(a <= n <= b for a, n, b in zip(status.least, made, status.most, strict=True)), (status.least, made)
    assert status.exact
    assert status.position == record.position
