"""The properties feeds and cutting on random programs: against an interpreter of a few lines, and in small chunks.

The interpreter knows nothing of traces: it walks the lines that it has made itself.
"""

from __future__ import annotations

import dataclasses
import random
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest
from support.campaigns import seeds

from gproof.driver.running import execute
from gproof.frontend.eding.load import load_program
from gproof.ir.columns import Columns
from gproof.ir.finding import Findings
from gproof.ir.machine import NO_MACHINE, Machine, Spindle, Tool
from gproof.ir.setup import ZERO
from gproof.ir.trace import TRACE_ROW, Chunk, Trace, chunks
from gproof.passes.checks.cutting.cutting import Cutting
from gproof.passes.checks.cutting.feeds import Feeds

HEAD = "G21 G17 G90 G94 G40 G49 G54\nG0 X0 Y0 Z50\n"
MACHINE = dataclasses.replace(
    NO_MACHINE,
    tools=(
        Tool(number=1, max_rpm=10_000.0, max_feed=10.0, max_plunge=4.0),
        Tool(number=2, min_rpm=8_000.0, max_plunge=6.0),
    ),
    spindles=(Spindle(number=0, spin_up=2.0),),
)


KINDS = (
    "on", "back", "off", "speed", "tool", "up", "down", "across", "slope", "rapid", "dwell", "wet", "dry",
)  # fmt: skip


class Line(NamedTuple):
    """A line as the interpreter reads it; of its numbers those that its kind has."""

    kind: str
    feed: float
    speed: float
    tool: int


def program(rng: random.Random) -> list[tuple[str, Line]]:
    """Lines, each with what it means to the interpreter; the feed is always given."""
    lines: list[tuple[str, Line]] = []
    for _ in range(rng.randint(5, 30)):
        kind = rng.choice(KINDS)
        feed = rng.choice([100, 300, 900])
        value = rng.choice([0, 5000, 9000, 12000])
        tool = rng.choice([0, 1, 2])
        line = {
            "on": "M3", "back": "M4", "off": "M5", "speed": f"S{value}", "tool": f"T{tool} M6",
            "up": f"G91 G1 Z1 F{feed}", "down": f"G91 G1 Z-1 F{feed}", "across": f"G91 G1 X1 F{feed}",
            "slope": f"G91 G1 X4 Z-3 F{feed}", "rapid": "G91 G0 X5 Z1", "dwell": "G4 P1.5", "wet": "M8", "dry": "M9",
        }[kind]  # fmt: skip
        lines.append((line, Line(kind, feed, value, tool)))
    return lines


def expected(lines: list[tuple[str, Line]]) -> dict[int, int]:
    """By code how many moves have it. The setup zero says S0 and tool 0, which counts once the job changes tools."""
    direction, speed, tool, named, starts = 0, 0.0, 0, False, True  # the M5 at the end
    count = dict.fromkeys((530, 533, 534, 535, 537, 545, 546), 0)
    for _, what in lines:
        if what.kind in ("on", "back", "off"):
            direction = {"on": 1, "back": -1, "off": 0}[what.kind]
        elif what.kind == "speed":
            speed = what.speed
        elif what.kind == "tool":
            # A tool change stops the spindle (manual 3.5.3).
            tool, named, direction = what.tool, True, 0
        if what.kind not in ("down", "across", "slope"):
            continue
        rpm = direction * speed
        count[530] += rpm == 0 and starts
        count[533] += tool == 0 and named
        count[537] += rpm < 0
        count[534] += tool == 1 and abs(rpm) > 10_000
        count[535] += tool == 2 and rpm != 0 and abs(rpm) < 8_000
        share = {"down": 1.0, "slope": 0.6}.get(what.kind, 0.0)
        count[545] += tool == 1 and what.feed > 600
        count[546] += (tool == 1 and what.feed * share > 240) or (tool == 2 and what.feed * share > 360)
    return {code: number for code, number in count.items() if number}


def split(trace: Trace, rng: random.Random) -> Iterator[Chunk]:
    """A trace in chunks of one to four rows."""
    for chunk in chunks(trace):
        done, start, frame = 0, chunk.start, chunk.start_frame
        while done < len(chunk.rows) or not done:
            end = min(len(chunk.rows), done + rng.randint(1, 4))
            rows = Columns(TRACE_ROW, {name: array[done:end] for name, array in chunk.rows.arrays.items()})
            last = end >= len(chunk.rows)
            yield dataclasses.replace(
                chunk, begin=done, start=start, start_frame=frame, rows=rows, last=last,
                edges=chunk.edges if last else (),
            )  # fmt: skip
            if len(rows):
                start, frame = tuple(rows["to"][-1].tolist()), int(rows["frame"][-1])
            if last:
                break
            done = end


def run(path: Path, machine: Machine, pieces: random.Random | None) -> Findings:
    """The findings of both checks on a job."""
    loaded = load_program(path, Findings())
    assert loaded is not None
    trace = execute(loaded, ZERO, machine, Findings())
    found = Findings(limit=1000)
    checks = [Feeds(loaded, machine, ZERO, found), Cutting(loaded, machine, ZERO, found)]
    for chunk in chunks(trace) if pieces is None else split(trace, pieces):
        for check in checks:
            check.feed(chunk)
    for check in checks:
        check.finish()
    return found


@pytest.mark.parametrize("seed", seeds(15, 1000))
def test_random_programs(seed: int, tmp_path: Path) -> None:
    rng = random.Random(seed)
    lines = program(rng)
    job = tmp_path / "job.cnc"
    text = HEAD + "\n".join(line for line, _ in lines) + "\nG90 G0 Z90\nM5\nM30\n"
    job.write_text(text, encoding="utf-8")
    whole, pieces = run(job, MACHINE, None), run(job, MACHINE, rng)
    assert whole.kept == pieces.kept, f"seed {seed}\n{text}"
    wanted = expected(lines)
    found: dict[int, int] = {}
    for finding in whole.kept:
        number = finding.code.number
        if number in wanted or number in (530, 531, 533, 534, 535, 537, 545, 546):
            moves = dict(finding.values)["moves"]
            found[number] = found.get(number, 0) + int(str(moves))
    assert found == wanted, f"seed {seed}\n{text}"
