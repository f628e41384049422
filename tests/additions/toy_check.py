"""A check from outside: a note for every job that has arcs. Importing it registers it."""

from __future__ import annotations

import numpy as np

from gproof.ir import codes
from gproof.ir.finding import Findings, Severity
from gproof.ir.machine import Machine
from gproof.ir.program import Program
from gproof.ir.setup import Setup
from gproof.ir.trace import Chunk, Op
from gproof.ir.trace_rows import row_span
from gproof.ir.verdict import PropertyResult, Verdict
from gproof.passes.checks import registry
from gproof.passes.checks.base import Check, ZeroAt

FILES = (
    "passes/checks/lint/toy.py",
    "passes/checks/registry.py",
    "docs/toy.md",
    "tests/passes/checks/lint/test_toy.py",
)
REGISTRY = "passes/checks/registry.py"

ARC = codes.code(999, "toy-arc", Severity.NOTE, "an arc, the first of {count} in its chunk", "toy")


class Toy(Check):
    """Arcs, one by one chunk."""

    name = "toy"

    def feed(self, chunk: Chunk) -> None:
        found = np.flatnonzero(chunk.rows["op"] == Op.ARC)
        if len(found):
            self.findings.add(ARC.at(row_span(chunk.trace, chunk.rows, int(found[0])), count=len(found)))

    def finish(self) -> PropertyResult:
        return PropertyResult(name="toy", verdict=Verdict.SAFE)


def make(program: Program, machine: Machine, setup: Setup, findings: Findings, zero: ZeroAt) -> Check:
    return Toy(machine, setup, findings)


registry.CHECKS["toy"] = (make,)
