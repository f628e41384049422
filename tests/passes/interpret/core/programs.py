"""Small programs for tests of the executor: written, loaded, executed, and their traces in short forms."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any

from gproof.driver.running import execute
from gproof.frontend.eding.load import load_program
from gproof.ir.dialects.eding.settings import EdingSettings
from gproof.ir.finding import Findings
from gproof.ir.machine import NO_MACHINE, Machine
from gproof.ir.setup import ZERO, Setup
from gproof.ir.trace import Op, Trace

HEAD = "G21 G17 G90 G94 G54 G40 G49 G80 G98\n"
LATHE = "G21 G18 G90 G94 G54 G40 G49 G80 G98\n"
OFFSET = dataclasses.replace(NO_MACHINE, settings=EdingSettings(thread_peak="offset"))
POSITION = dataclasses.replace(NO_MACHINE, settings=EdingSettings(thread_peak="position"))

Row = tuple[str | float | None, ...]


def run_whole(
    folder: Path, text: str, *, setup: Setup = ZERO, machine: Machine = NO_MACHINE,
    macro: str | None = None, max_branches: int = 4096, render: bool = False,
) -> tuple[Trace, Findings]:  # fmt: skip
    """The verified trace of a program, and what was found; macro: the text of macro.cnc beside it."""
    job = folder / "job.cnc"
    job.write_text(text)
    if macro is not None:
        (folder / "macro.cnc").write_text(macro)
    findings = Findings()
    program = load_program(job, findings)
    assert program is not None
    program.verify()
    trace = execute(program, setup, machine, findings, max_branches=max_branches, render=render)
    trace.verify()
    return trace, findings


def run(folder: Path, text: str, **more: Any) -> tuple[Trace, Findings]:
    """Execute ``text`` behind the usual first line; more: see ``run_whole``."""
    return run_whole(folder, HEAD + text, **more)


def labels(findings: Findings) -> list[str]:
    """Codes of the findings in order, notes and warnings included."""
    return [f.code.label for f in findings.kept]


def codes_of(findings: Findings) -> list[str]:
    """Codes in order; GP243, a note at each stop, left out."""
    return [f.code.label for f in findings.kept if f.code.label != "GP243"]


def shown(trace: Trace, *, after_line: int = 0) -> list[Row]:
    """Rows behind a line.

    ("go", x, y, z), ("feed", x, y, z, mm/min), ("sync", x, y, z, mm/min), ("spindle", signed rpm), ("dwell", s), and
    the names of other events; None for a feed or speed that is not known.
    """
    out: list[Row] = []
    for section in trace.sections:
        rows = section.rows
        for i in range(len(rows)):
            op = Op(int(rows["op"][i]))
            if rows["line"][i] <= after_line or op in (Op.PLANE, Op.UNITS, Op.OVERRIDE, Op.END, Op.TOOL_OFFSET):
                continue
            to = [round(float(v), 6) + 0.0 for v in rows["to"][i][:3]]
            if op is Op.TRAVERSE:
                out.append(("go", *to))
            elif op is Op.FEED:
                follows = trace.states[int(rows["state"][i])].synchronised
                out.append(("sync" if follows else "feed", *to, _number(float(rows["feed"][i]))))
            elif op is Op.SPINDLE:
                out.append(("spindle", _number(float(rows["arg"][i][0]) * float(rows["arg"][i][1]))))
            elif op is Op.DWELL:
                out.append(("dwell", float(rows["arg"][i][0])))
            elif op not in (Op.OFFSET, Op.PATH_MODE):
                out.append((op.name.lower(),))
    return out


def _number(value: float) -> float | None:
    return None if math.isnan(value) else round(value, 6) + 0.0


def ways(trace: Trace, limit: int = 1000) -> list[list[tuple[str, tuple[float, ...]]]]:
    """Every way through the graph of sections: the moves on it as (op, end of X Y Z); loops are taken once."""
    out = []
    todo: list[tuple[int, list[tuple[str, tuple[float, ...]]], frozenset[int]]] = [(0, [], frozenset())]
    while todo and len(out) < limit:
        number, moves, been = todo.pop()
        section = trace.sections[number]
        rows = section.rows
        here = [
            (Op(op).name.lower(), tuple(to[:3]))
            for op, to in zip(rows["op"].tolist(), rows["to"].tolist(), strict=True)
            if op < Op.DWELL
        ]
        moves = [*moves, *here]
        targets = [edge.target for edge in section.edges if edge.target >= 0 and edge.target not in been]
        if not targets:
            out.append(moves)
        todo += [(target, moves, been | {number}) for target in reversed(targets)]
    return out
