"""Small programs for tests of the executor: written, loaded, executed."""

from __future__ import annotations

from pathlib import Path

from gproof.frontend.eding.load import load_program
from gproof.ir.finding import Findings
from gproof.ir.machine import NO_MACHINE, Machine
from gproof.ir.setup import ZERO, Setup
from gproof.ir.trace import Op, Trace
from gproof.passes.execute import execute

HEAD = "G21 G17 G90 G94 G40 G49 G54\n"


def run(
    folder: Path, text: str, *, setup: Setup = ZERO, machine: Machine = NO_MACHINE, macro: str | None = None,
    max_branches: int = 4096, render: bool = False,
) -> tuple[Trace, Findings]:  # fmt: skip
    """Execute ``text`` behind the usual first line; macro: the text of macro.cnc beside it."""
    job = folder / "job.cnc"
    job.write_text(HEAD + text)
    if macro is not None:
        (folder / "macro.cnc").write_text(macro)
    findings = Findings()
    program = load_program(job, findings)
    assert program is not None
    program.verify()
    trace = execute(program, setup, machine, findings, max_branches=max_branches, render=render)
    trace.verify()
    return trace, findings


def labels(findings: Findings) -> list[str]:
    """Codes of the findings in order, notes and warnings included."""
    return [f.code.label for f in findings.kept]


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
