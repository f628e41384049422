"""How far a run is: the line whose steps were made, time left over every way, JSON lines, a line on a terminal."""

from __future__ import annotations

import io
import json
import os
import sys
import time
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path

import pytest
from backend.jobs import job
from cli.packages import MACHINE, Shop

from gproof.backend.boards.virtual import VirtualBoard
from gproof.backend.runtime import walk
from gproof.backend.watch import Moment, Watch
from gproof.cli.run_progress import Line, Lines, line_of, time_left
from gproof.ir.trace import Wait

TWO_AXES = (MACHINE + MACHINE[MACHINE.index("[axes.x]") :].replace("axes.x", "axes.y")).replace("min = 0", "min = -9")
TWO_AXES += "[controller]\nfifo_time = 2  # a computer that is busy otherwise must not run the board dry\n"
# 100 steps a mm. Line 2: 200 steps of X. Line 3: half a circle of radius 1 mm, 200 of X and 200 of Y (up and down).
# Line 4: a whole circle, 400 and 400. Line 6: 300 of Y.
JOB = "G21 G90 G17\nG1 F600 X2\nG2 X4 I1\nG3 X4 Y0 I-1 J0\nM8\nG1 Y3\nM30\n"
REACHED = [
    (1, 2), (200, 2), (201, 3), (400, 3), (600, 3), (601, 4), (1000, 4), (1400, 4), (1401, 6), (1700, 6), (2000, 6)
]  # fmt: skip


@pytest.fixture(scope="module")
def shop(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Shop]:
    with pytest.MonkeyPatch.context() as patch:
        shop = Shop(tmp_path_factory.mktemp("progress"), patch.setenv)
        (shop.folder / "machine.toml").write_text(TWO_AXES)
        (shop.folder / "job.cnc").write_text(JOB)
        shop.compile()
        yield shop


def test_the_line_is_the_one_whose_steps_are_made(shop: Shop) -> None:
    from gproof.backend.job import job_of
    from gproof.verify.certificate.package import read_package

    certified = job_of(read_package(shop.folder / "made.gpx"))
    section = certified.stream.sections[0]
    assert sum(int(runs["count"].sum()) for runs in section.runs) == 1700
    watch = Watch(certified, Fraction(1))
    found = [(made, watch.moment(section, 0, 0.0, made, (0, 0)).line) for made, _ in REACHED]
    # The rounding of a curve's ends may put the step on the border on either side.
    assert [line for _, line in found] == [line for _, line in REACHED], found


def test_time_left_is_over_the_shortest_and_the_longest_way() -> None:
    made = job([(4.0,)], [(0.0,)], [(8.0,)], waits=(Wait.OPERATOR, Wait.OPERATOR), axes="x")
    first, second, third = (section.duration for section in made.stream.sections)
    hertz = made.stream.tick_frequency
    moment = Watch(made, Fraction(1)).moment(made.stream.sections[0], 1000, 0.25, 10, (10,))
    assert moment.left == ((first - 1000 + second + third) / hertz,) * 2
    assert (moment.section, moment.sections, moment.part) == (0, 3, 0.25)
    assert moment.position == (10 / float(made.stream.motors[0].steps_per_unit),)
    slow = Watch(made, Fraction(1, 2)).moment(made.stream.sections[1], 0, 0.5, 0, (0,))
    assert slow.left == ((second + third) / hertz, (second + 2 * third) / hertz)


def test_who_watches_is_told_where_it_is_and_may_go(monkeypatch: pytest.MonkeyPatch) -> None:
    from gproof.backend import runtime

    monkeypatch.setattr(runtime, "EVERY", 0.0)
    made = job([(1.0, 0.5), (0.0, 1.0)], [(2.0, 2.0)])
    told: list[Moment] = []
    plain = walk(made, VirtualBoard.for_machine(made.machine, 2))
    assert walk(made, VirtualBoard.for_machine(made.machine, 2), on_moment=told.append) == plain
    parts = [moment.part for moment in told]
    assert parts == sorted(parts) and parts[-1] == 1.0
    assert {moment.line for moment in told if moment.section == 0} == {1, 2}
    assert told[-1].steps == made.stream.sections[-1].end()

    def gone(moment: Moment) -> None:
        raise BrokenPipeError

    assert walk(made, VirtualBoard.for_machine(made.machine, 2), on_moment=gone) == plain


def test_json_lines(shop: Shop) -> None:
    words = ("--progress", "jsonl", "--record", "told.json", "--replace-record")
    for _ in range(3):
        done = shop("run", "made.gpx", "--board", "emulator", *words)
        # Two processes in real time: where the computer held one of them, its clock was taken for a wrong one.
        if "runs at another rate" not in done.err:
            break
    assert done.exit == 0, done
    told = [json.loads(line) for line in done.err.splitlines()]
    assert told[0] == {
        "kind": "start", "schema": "gproof-progress/1", "job": "job.cnc", "board": "emulator", "motors": ["X", "Y"],
    }  # fmt: skip
    # Coolant has no pin in this machine file.
    assert [line for line in told if line["kind"] == "wait"] == [
        {"kind": "wait", "section": 0, "line": 5, "file": None, "wait": "operator", "text": "mist: off; flood: on",
         "outcomes": ["done"]},
        {"kind": "wait", "section": 0, "line": 7, "file": None, "wait": "operator", "text": "flood: off",
         "outcomes": ["done"]},
    ]  # fmt: skip
    at = [line for line in told if line["kind"] == "at"]
    assert at[-1] == {
        "kind": "at", "section": 0, "sections": 1, "line": 6, "file": "job.cnc", "percent": 100.0, "left_s": [0.0, 0.0],
        "position": {"X": 4.0, "Y": 3.0}, "steps": {"X": 400, "Y": 300},
    }  # fmt: skip
    assert all(set(line) == set(at[-1]) for line in at)
    assert {line["line"] for line in at} >= {2, 4, 6}
    record = json.loads((shop.folder / "told.json").read_text())
    assert told[-1] == {"kind": "end", "result": "completed", "reason": "", "record": record["sha256"]}


def test_a_run_that_is_refused_says_so_to_a_program(shop: Shop) -> None:
    words = ("--machine", "machine.toml", "--setup", "zero", "--progress", "jsonl")
    done = shop("run", "made.gpx", "--board", "klipper", "--port", "/dev/not-there", *words)
    assert done.exit == 1, done
    kinds = [json.loads(line)["kind"] for line in done.err.splitlines() if line.startswith("{")]
    assert kinds == ["start", "end"]
    assert '"result":null' in done.err


def test_nothing_is_shown_where_nobody_looks(shop: Shop) -> None:
    assert shop("run", "made.gpx", "--board", "virtual").err == ""
    assert shop("run", "made.gpx", "--board", "virtual", "--progress", "off").err == ""


def test_a_reader_that_stands_still_holds_nothing_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """The board would starve: what is not taken is left out."""
    from gproof.cli import run_progress

    monkeypatch.setattr(run_progress, "PATIENCE", 0.01)
    reader, writer = os.pipe()
    moment = Moment(
        section=0, sections=1, line=1, file="job.cnc", part=0.5, left=(1.0, 1.0), position=(1.0,), steps=(100,)
    )  # fmt: skip
    with os.fdopen(writer, "w") as stream, os.fdopen(reader) as other:
        monkeypatch.setattr(sys, "stderr", stream)
        lines = Lines()
        lines.start("job.cnc", "klipper", ("X",))
        began = time.monotonic()
        for _ in range(2000):
            lines.moment(moment)
        lines.end(None)
        assert time.monotonic() - began < 5
        stream.close()
        told = [json.loads(line) for line in other]
    assert 10 < len(told) < 2000 and told[-1]["kind"] == "at"


def test_the_line_on_a_terminal(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    moment = Moment(
        section=0, sections=1, line=12, file="job.cnc", part=0.345, left=(129.2, 160.0), position=(12.5, -3.0),
        steps=(1250, -300),
    )  # fmt: skip
    whole = "line 12  34.5 %  0:02:09 to 0:02:40 left  X 12.500  Y -3.000"
    assert line_of(moment, ("X", "Y")) == whole
    assert [time_left(left) for left in ((0.0, 0.0), (3661.0, 3661.5), (59.0, 61.0))] == [
        "0:00:00", "1:01:01", "0:00:59 to 0:01:01",
    ]  # fmt: skip
    screen = io.StringIO()
    monkeypatch.setattr(sys, "stderr", screen)
    monkeypatch.setenv("COLUMNS", "40")
    line = Line()
    line.start("job.cnc", "klipper", ("X", "Y"))
    line.moment(moment)
    assert screen.getvalue() == "\r" + whole[:39]
    line.end(None)
    line.end(None)
    # It is wiped once, so that what follows starts on an empty line.
    assert screen.getvalue() == "\r" + whole[:39] + "\r" + " " * 39 + "\r"
