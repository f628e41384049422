"""Where a long job is cut into pieces, and whether a second processor reads ahead, changes nothing of the answer."""

from __future__ import annotations

import contextlib
import importlib.util
import io
import json
import random
import threading
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any
from unittest import mock

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.bundles import unpacked
from support.campaigns import examples
from support.goldens import ROOT
from support.paths import Offsets, RandomPath

from gproof.cli.main import main
from gproof.ir import prefetch as beside
from gproof.ir.columns import Columns
from gproof.ir.finding import Findings
from gproof.ir.program import BlockTable, SourceFile
from gproof.passes.interpret.core import block_tables as straight
from gproof.passes.interpret.core import row_buffer as rows

MACHINES = {".ngc": "machine.toml", ".tap": "WINCNC.INI", ".din": "mcuwin.toml"}
EVENTS = {
    ".ngc": ("G4 P0.1", "M8", "G54", "(note)", "/X3", "G1 X2000", "G2 X1 Y1 I9 J0 F900", "X#1", "G91", "G90", "M0"),
    ".tap": ("G4 X0.1", "[note]", "G1 X2000", "G2 X1 Y1 I9 J0 F900", "X{1+1}", "G91", "G90", "M5"),
    ".din": ("G04 X100", "'note", "G01 X2000", "G02 X1 Y1 I9 J0", "G02 X1 Y2 J3", "X(1+1)", "G91", "G90", "F900"),
}  # fmt: skip
LOADS = "gproof.frontend.eding.load", "gproof.frontend.wincnc.load", "gproof.frontend.mcuwin.load"


def programs() -> ModuleType:
    spec = importlib.util.spec_from_file_location("bench_programs", ROOT / "bench/programs.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


PROGRAMS = programs()


def write_job(path: Path, shape: str, seed: int) -> None:
    """Some plain lines with others among them, some of which are mistakes or leave the machine.

    Few enough that every finding is told: of one piece the limits tell 64 places at most.
    """
    rng = random.Random(seed)
    if shape == "path":
        job = RandomPath(rng, [0.0, 0.0, 0.0], Offsets())
        for _ in range(15):
            job.random_move()
        path.write_text(job.text)
        return
    PROGRAMS.write_program(shape, 26, path)
    lines = path.read_text().splitlines()
    for _ in range(rng.randint(0, 6)):
        lines.insert(rng.randint(6, len(lines) - 2), rng.choice(EVENTS[path.suffix]))
    path.write_text("\n".join(lines) + "\n")


def answer(path: Path, zero: bool) -> Any:
    words = [
        "check",
        str(path),
        "--machine",
        str(unpacked("bench") / "machines" / MACHINES[path.suffix]),
        "--format",
        "json",
    ]
    out = io.StringIO()
    with contextlib.redirect_stdout(out), mock.patch("gproof.driver.session.Findings", lambda: Findings(limit=10**6)):
        main([*words, *(["--setup", "zero"] if zero else [])])
    report = json.loads(out.getvalue())
    # Findings come from the run and from the checks: who is first depends on the pieces.
    report["findings"].sort(key=json.dumps)
    return report


@contextlib.contextmanager
def in_pieces(chunk: int, first: int, capacity: int, processors: int) -> Iterator[None]:
    """No table holds its words; pieces of so many bytes and rows; with two processors threads help from the start."""
    with contextlib.ExitStack() as stack:
        for name in LOADS:
            stack.enter_context(mock.patch(f"{name}.HELD_IN_ALL", 0))
        stack.enter_context(mock.patch.object(straight, "CHUNK_BYTES", chunk))
        stack.enter_context(mock.patch.object(rows, "FIRST_CAPACITY", first))
        stack.enter_context(mock.patch.object(rows, "CAPACITY", capacity))
        stack.enter_context(mock.patch.object(beside, "LONG_TABLE", 0))
        stack.enter_context(mock.patch.object(beside, "LONG_RUN", 0))
        stack.enter_context(mock.patch.object(beside, "processors", lambda: processors))
        yield


@examples(30, 3000)
@given(
    st.sampled_from([".ngc", ".tap", ".din"]), st.sampled_from(["raster", "arcs", "modal", "beside", "path"]),
    st.integers(0, 10**6), st.integers(1, 400), st.integers(1, 9), st.integers(1, 40), st.integers(1, 2), st.booleans(),
)  # fmt: skip
def test_pieces_of_any_size_give_the_same_answer(
    tmp_path_factory: pytest.TempPathFactory, suffix: str, shape: str, seed: int, chunk: int, first: int,
    capacity: int, processors: int, zero: bool,
) -> None:  # fmt: skip
    if shape in ("beside", "path"):
        suffix = ".ngc"
    path = tmp_path_factory.mktemp("pieces") / f"job{suffix}"
    write_job(path, shape, seed)
    whole = answer(path, zero)
    with in_pieces(chunk, first, capacity, processors):
        assert answer(path, zero) == whole


class Tables:
    """Stands for a program: pieces of one byte, a mistake at byte ``bad``; notes which thread read."""

    def __init__(self, bad: int) -> None:
        self.bad = bad
        self.threads: set[str] = set()
        self.files = [SourceFile(name="job", sha256="")]

    def load(self, table: BlockTable, begin: int, line: int, limit: int) -> tuple[str, int, int]:
        self.threads.add(threading.current_thread().name)
        if begin == self.bad:
            raise OSError("the disk")
        return f"{table.begin}:{begin}", begin + 1, line + 1


def table(begin: int, end: int, words: Columns | None = None) -> BlockTable:
    return BlockTable(file=0, first_line=1, last_line=9, begin=begin, end=end, words=words)


def test_tables_that_take_turns_and_a_mistake_in_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(beside, "LONG_TABLE", 0)
    monkeypatch.setattr(beside, "processors", lambda: 2)
    program: Any = Tables(bad=4)
    ahead = beside.Ahead(program)
    one, other = table(0, 9), table(100, 109)
    got = [ahead.load(which, at, 1 + at, 5)[0] for which, at in ((one, 0), (one, 1), (other, 100), (one, 2), (one, 3))]
    assert got == ["0:0", "0:1", "100:100", "0:2", "0:3"]
    assert len(program.threads) == 2
    # Told where the piece is asked for, not where it was read.
    with pytest.raises(OSError, match="the disk"):
        ahead.load(one, 4, 5, 5)


def test_calls_beside_come_in_order_and_raise_where_they_are_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(beside, "LONG_RUN", 1)
    monkeypatch.setattr(beside, "processors", lambda: 2)
    seen: list[int] = []

    def take(number: int) -> None:
        if number == 50:
            raise ValueError("fifty")
        seen.append(number)

    calls = beside.InOrder(take)
    for number in range(40):
        calls(number, 1)
    calls.wait()
    assert seen == list(range(40))
    with pytest.raises(ValueError, match="fifty"):
        for number in range(50, 60):
            calls(number, 1)
        calls.wait()
