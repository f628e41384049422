"""Jobs with stock, judged inside this process by the check of what is left of it."""

from __future__ import annotations

import dataclasses
from pathlib import Path

from gproof.driver.running import begin
from gproof.driver.session import Running, open_session
from gproof.ir.finding import Findings
from gproof.ir.machine import Tool
from gproof.ir.trace import Chunk
from gproof.ir.verdict import PropertyResult
from gproof.ir.workpiece import Body, Box, Placed, Workpiece
from gproof.passes.checks.stock.stock import StockLeft

MACHINE = """schema = "gproof-machine/1"
units = "mm"
[axes.x]
[axes.y]
[axes.z]
"""
START = "G21 G17 G90 G94 G54 G40\nT1 M6\nF600\n"
FLAT = Tool(number=1, shape="flat", diameter=6.0, flute_length=20.0, shank_diameter=6.0, stickout=40.0)
BLOCK = Box(low=(0.0, 0.0, -10.0), high=(50.0, 40.0, 0.0))


class Judged:
    """A job, and what the check said of it."""

    def __init__(
        self, folder: Path, text: str, *, tools: tuple[Tool, ...] = (FLAT,), stock: tuple[Body, ...] = (BLOCK,),
        cell: float = 0.5, clearance: float = 0.0, pieces: int = 0, start: str = START, name: str = "job.cnc",
        setup: str = "", machine: str = MACHINE,
    ) -> None:  # fmt: skip
        """pieces: the rows of so many at a time, 0: as they come."""
        (folder / "machine.toml").write_text(machine)
        (folder / "setup.toml").write_text('schema = "gproof-setup/1"\n' + setup)
        job = folder / name
        job.write_text(start + text)
        session = open_session(job, machine=folder / "machine.toml", setup=str(folder / "setup.toml"), dialect=None)
        assert session.program is not None
        armed = dataclasses.replace(session.machine, tools=tools)
        bodies = tuple(Placed(name=f"stock {n}", body=body) for n, body in enumerate(stock, 1))
        around = Workpiece(stock=bodies, cell=cell, clearance=clearance)
        given = dataclasses.replace(session.setup, workpiece=around)
        self.findings = Findings(limit=1000)
        executor = begin(session.program, given, armed, session.findings, **session.options(Running()))
        self.check = StockLeft(session.program, armed, given, self.findings, executor.modal.copy().zero_at_start)
        for chunk in executor.chunks():
            for piece in split(chunk, pieces):
                self.check.feed(piece)
        self.result: PropertyResult = self.check.finish()
        self.first = start.count("\n")

    @property
    def verdict(self) -> str:
        return self.result.verdict.value

    def told(self) -> list[tuple[int, int]]:
        """(line behind the start, code) in the order of lines."""
        return sorted({(f.span.line - self.first, f.code.number) for f in self.findings.kept})


def split(chunk: Chunk, size: int) -> list[Chunk]:
    """The same rows in pieces."""
    if size <= 0 or len(chunk.rows) <= size:
        return [chunk]
    starts, frames = chunk.starts(), chunk.start_frames()
    out = []
    for at in range(0, len(chunk.rows), size):
        last = at + size >= len(chunk.rows)
        out.append(
            Chunk(
                trace=chunk.trace, section=chunk.section, begin=chunk.begin + at, start=tuple(starts[at].tolist()),
                start_frame=int(frames[at]), rows=chunk.rows.slice(at, at + size), last=chunk.last and last,
                edges=chunk.edges if last else (),
            )
        )  # fmt: skip
    return out
