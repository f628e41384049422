"""What the host puts through a serial line to the board emulator, and what that takes of a processor.

Runs of one step, so that the line carries as many ``queue_step`` as there are steps. The line's share: the bytes sent
for them, of those that 10 bits a byte allow in the time that the section lasts. Called as a program it prints JSON.
"""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Mapping
from typing import Any

BAUD = 250_000
RATES = (2_500, 2_900)
"""Runs a second of all motors together."""
SECONDS = 8.0
GOAL_SHARE, GOAL_CPU = 0.84, 0.25
MOTORS = 4
TICKS = 16_000_000
AHEAD = TICKS // 4


def tables(rate: int, seconds: float) -> list[Any]:
    """Runs of one step by motor; intervals differ, so that nothing could be one run."""
    import numpy as np

    from gproof.backend.runs import table

    count, interval = int(rate * seconds / MOTORS), TICKS * MOTORS // rate
    made = []
    for motor in range(MOTORS):
        one = np.ones(count, dtype=np.int64)
        intervals = interval - 6 + (7 * np.arange(count, dtype=np.int64) + motor) % 13
        made.append(table(intervals, one, 0 * one, one.astype(np.int8)))
    return made


def through(port: str, rate: int, seconds: float) -> dict[str, Any]:
    """One section on the board at a port."""
    from gproof.backend.boards.board import BoardState
    from gproof.backend.boards.klipper.driver import KlipperBoard
    from gproof.backend.boards.klipper.lines import SerialLine
    from gproof.backend.boards.klipper.wiring import MotorPins, Wiring
    from gproof.backend.feed import Feeder, Words
    from gproof.ir.columns import Columns
    from gproof.ir.stream import EVENT, StreamSection

    wiring = Wiring(motors=[MotorPins(step=f"PA{2 * k}", direction=f"PA{2 * k + 1}") for k in range(MOTORS)])
    board = KlipperBoard(lambda: SerialLine(port, BAUD), wiring, baud=BAUD)
    words = Words.of(board.open())
    board.present(bytes(32))
    runs = tables(rate, seconds)
    duration = max(int(r["interval"].sum()) for r in runs) + 100
    section = StreamSection(
        number=0, start=(0,) * MOTORS, runs=tuple(runs), events=Columns(EVENT, EVENT.empty(0)), duration=duration
    )  # fmt: skip
    feeder, finished = Feeder(section, words), False
    began, cpu, sent = time.monotonic(), time.process_time(), board.bytes_sent
    base = board.start_section(0, section.start, TICKS // 20)
    while (status := board.status()).state is BoardState.RUNNING:
        now = status.tick - base
        feeder.fill(board, status.free, max(0, now) + AHEAD)
        due = feeder.next_due
        if due is not None:
            board.commit(due - 1)
        elif not finished:
            board.finish_section(duration)
            finished = True
        ahead = duration if due is None else now + max(1, (min(due - 1, now + AHEAD) - now) // 2)
        board.wait(base + min(max(ahead, now + 1), now + TICKS // 20))
    wall, cpu, sent = time.monotonic() - began, time.process_time() - cpu, board.bytes_sent - sent
    board.close()
    return {
        "rate": rate, "state": status.state.value, "runs": sum(status.steps), "seconds": duration / TICKS,
        "share": sent / (duration / TICKS * BAUD / 10), "cpu": cpu / wall, "reason": status.reason,
    }  # fmt: skip


def encoding() -> float:
    """``queue_step`` commands a second that are made, put into blocks and given a checksum, of processor time."""
    from gproof.backend.boards.klipper.blocks import block
    from gproof.backend.boards.klipper.messages import described
    from gproof.backend.boards.klipper.transport import Transport

    message = described("queue_step oid=%c interval=%u count=%hu add=%hi", 9)
    assert message is not None
    count, line = 50_000, Transport(window=1 << 20)
    began = time.process_time()
    for k in range(count):
        line.send(
            message.encoded({"oid": k & 3, "interval": 5_000 + k, "count": 1 + k % 90, "add": k % 60 - 30}), now=False
        )
    while not line.idle:
        line.out(0.0)
        line.feed(block(line.next_sequence, b""), 0.0)
    return count / (time.process_time() - began)


def measured(environment: Mapping[str, str]) -> dict[str, Any]:
    """The figures, from a process of their own."""
    command = [sys.executable, __file__]
    done = subprocess.run(command, env=dict(environment), capture_output=True, text=True, check=False)
    if done.returncode:
        return {"problem": done.stderr.strip().splitlines()[-1] if done.stderr.strip() else "it failed"}
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def show(found: Mapping[str, Any]) -> None:
    """The figures as a table."""
    print(f"\nSerial line of {BAUD:,} baud to the board emulator, host's share of a core")
    if "problem" in found:
        print(f"  ! {found['problem']}")
        return
    print(f"  {found['encoded']:,.0f} queue_step a second encoded into blocks")
    for row in found["rows"]:
        met = row["state"] == "idle" and row["cpu"] <= GOAL_CPU and row["runs"] > 0
        least = min(1.0, row["share"])
        goal = f"at least {GOAL_SHARE:g} of the line, at most {GOAL_CPU:.0%} of a core"
        enough = met and (least >= GOAL_SHARE or row["rate"] == RATES[0])
        print(
            f"  {row['rate']:>6,} runs/s  {row['state']:<9} {least:5.2f} of the line  {row['cpu']:6.1%}  "
            f"{goal}  {'PASS' if enough else 'MISS'}{'  ' + row['reason'] if row['reason'] else ''}"
        )


def main() -> None:
    """Start an emulator for each rate, and measure."""
    rows = []
    for rate in RATES:
        command = [sys.executable, "-m", "gproof.backend.boards.emulator", "--drift", "120", "--linger", "1"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
            try:
                assert process.stdout is not None
                port = process.stdout.readline().partition(": ")[2].strip()
                rows.append(through(port, rate, SECONDS))
            finally:
                process.kill()
    print(json.dumps({"encoded": encoding(), "rows": rows}))


if __name__ == "__main__":
    main()
