"""A run of a program in its own language: started, or complete."""

from __future__ import annotations

from typing import Any

from gproof.driver.dialects import semantics_of
from gproof.ir.columns import Columns, concatenate
from gproof.ir.finding import Findings
from gproof.ir.machine import Machine
from gproof.ir.program import Program
from gproof.ir.setup import Setup
from gproof.ir.trace import TRACE_ROW, Chunk, Trace, TraceSection
from gproof.passes.interpret.core import control_flow
from gproof.passes.interpret.core.run import Run
from gproof.passes.motion.knife_axis import follow_knife


def begin(program: Program, setup: Setup, machine: Machine, findings: Findings, **options: Any) -> Run:
    """A run that has not done anything yet; options: keyword arguments of ``Run``."""
    return control_flow.begin(program, setup, machine, findings, semantics_of(program), **options)


def execute(program: Program, setup: Setup, machine: Machine, findings: Findings, **options: Any) -> Trace:
    """The whole Trace at once, for stages that need all of it."""
    return collect(begin(program, setup, machine, findings, **options))


def collect(run: Run) -> Trace:
    """Execute a run to its end and put its chunks together."""
    parts: list[Columns] = []
    first: Chunk | None = None
    for chunk in follow_knife(run.chunks(), run.machine, run.findings):
        first = first or chunk
        parts.append(chunk.rows)
        if chunk.last:
            run.trace.sections.append(
                TraceSection(
                    number=chunk.section, start=first.start, start_frame=first.start_frame,
                    rows=concatenate(TRACE_ROW, parts), edges=chunk.edges,
                )
            )  # fmt: skip
            parts, first = [], None
    run.trace.sections.sort(key=lambda section: section.number)
    return run.trace
