"""What the host puts through a serial line to the board emulator, and what that takes of a processor.

Runs of one step, so that the line carries as many ``queue_step`` as there are steps. The line's share: the bytes sent
for them, of those that 10 bits a byte allow in the time that the section lasts. Called as a program it prints JSON.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

BAUD = 250_000
RATES = (2_500, 2_900)
"""Runs a second of all motors together."""
SECONDS = 8.0
GOAL_SHARE, GOAL_CPU = 0.84, 0.25
TAKEN = 2_967
"""``queue_step`` a second that unmodified firmware takes on this line."""
HELD = (500, 20_000)
"""Lines of the sections in which a feed hold is requested."""
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
    is_ = board.open()
    words = Words.of(is_)
    board.present(bytes(32))
    runs = tables(rate, seconds)
    duration = max(int(r["interval"].sum()) for r in runs) + 100
    section = StreamSection(
        number=0, start=(0,) * MOTORS, runs=tuple(runs), events=Columns(EVENT, EVENT.empty(0)), duration=duration
    )  # fmt: skip
    feeder, finished = Feeder(section, words), False
    began, cpu, sent = time.monotonic(), time.process_time(), board.bytes_sent
    base = board.start_section(0, section.start, _lead(board, is_, section))
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


def _lead(board: Any, is_: Any, section: Any) -> int:
    """Ticks before tick 0 in which the first messages arrive, reckoned as the runtime does."""
    from gproof.backend.link import Link, link_plan
    from gproof.backend.runtime import LATENCY
    from gproof.backend.section_run import SLICE

    link = Link(
        tick_frequency=TICKS, rate=is_.link_rate, sizes=board.wire_bytes, event_bytes=is_.event_bytes,
        places=is_.fifo_runs, latency=int(LATENCY * TICKS), ahead=AHEAD, turn=int(SLICE * TICKS),
    )  # fmt: skip
    return max(TICKS // 20, link_plan(section, link).lead)


def held(lines: int, folder: Path) -> dict[str, Any]:
    """A feed hold in a raster of so many lines, on the emulator in real time: seconds from the request until the axes
    start to slow down, and what the validator takes for the rest of the section."""
    from programs import MACHINES, write_program

    from gproof.backend.boards.emulated import EmulatedBoard
    from gproof.backend.control import Control
    from gproof.backend.job import CertifiedJob
    from gproof.backend.runtime import walk
    from gproof.driver.dialects import load_machine
    from gproof.driver.running import execute
    from gproof.frontend.eding.load import load_program
    from gproof.ir.finding import Findings
    from gproof.ir.setup import ZERO
    from gproof.passes.motion.plan import plan
    from gproof.passes.motion.step import step
    from gproof.verify.stream import validate

    findings, path = Findings(), folder / "held.ngc"
    write_program("raster", lines, path)
    machine, _ = load_machine(MACHINES / "machine.toml", findings)
    program = load_program(path, findings)
    assert machine is not None and program is not None, findings.kept
    trace = execute(program, ZERO, machine, findings)
    planned = plan(trace, machine, findings)
    stream = step(trace, planned, machine, findings) if planned is not None else None
    assert stream is not None, findings.kept
    one = CertifiedJob(
        name="held.ngc", certificate="00" * 32, trace=trace, machine=machine, setup=ZERO, stream=stream
    )  # fmt: skip
    whole, control = stream.sections[0].duration, Control()
    places: list[float] = []

    def request(part: float) -> None:
        if part * whole > 2 * stream.tick_frequency and not places:
            places.append(part * sum(section.duration for section in stream.sections))
            control.hold()

    record = walk(one, EmulatedBoard(machine, len(stream.motors)), control=control, on_progress=request)
    (asked,) = (change.asked for change in record.sections[0].retimings)
    took = []
    for _ in range(2):
        began = time.monotonic()
        validate(stream, trace, machine, ZERO, stretched=True, sections=(0,))
        took.append(time.monotonic() - began)
    rest = min(took) * (1 - asked / whole)
    begins = (asked - places[0]) / stream.tick_frequency
    return {"lines": lines, "begins": begins, "validator": rest, "goal": 0.3 + 2 * rest, "result": record.result.value}


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
        least = min(1.0, row["share"])
        # The first rate is that share of what unmodified firmware takes; the second is as much of the line's bytes.
        most = row["rate"] == RATES[-1]
        goal = f"at least {GOAL_SHARE:g} of " + ("the line" if most else f"{TAKEN:,} a second")
        goal += f", at most {GOAL_CPU:.0%} of a core"
        share = least if most else round(row["rate"] / TAKEN, 2)
        enough = row["state"] == "idle" and row["runs"] > 0 and row["cpu"] <= GOAL_CPU and share >= GOAL_SHARE
        print(
            f"  {row['rate']:>6,} runs/s  {row['state']:<9} {least:5.2f} of the line  {row['cpu']:6.1%}  "
            f"{goal}  {'PASS' if enough else 'MISS'}{'  ' + row['reason'] if row['reason'] else ''}"
        )
    for row in found["holds"]:
        met = row["result"] == "stopped" and row["begins"] <= row["goal"]
        print(
            f"  feed hold in {row['lines']:>7,} lines  starts after {row['begins']:.2f} s  "
            f"validator {row['validator']:.2f} s  at most {row['goal']:.2f} s  {'PASS' if met else 'MISS'}"
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
    with tempfile.TemporaryDirectory() as folder:
        holds = [held(lines, Path(folder)) for lines in HELD]
    print(json.dumps({"encoded": encoding(), "rows": rows, "holds": holds}))


if __name__ == "__main__":
    main()
