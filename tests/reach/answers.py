"""What gproof answers of a job, target by target, in a form that can be compared, for a machine and a setup in memory.

A target is a property, the plan or the stream: whatever a stated fact can reach.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from pathlib import Path

from gproof.driver.judge import judge
from gproof.driver.pipeline import lower
from gproof.driver.session import Running, Session, open_session
from gproof.ir import codes
from gproof.ir.dialects.eding.settings import eding_settings
from gproof.ir.finding import Findings, Severity
from gproof.ir.machine import Machine
from gproof.ir.program import Program
from gproof.ir.setup import Setup
from gproof.ir.text import print_ir
from gproof.passes.checks.registry import every_property

TARGETS = ("trace", *every_property(), "plan", "stream")
BLOCKS = Running(20_000)
"""Blocks that a job of these tests may execute: none of the corpus needs as many."""


NOTED = codes.CONTOUR_BREAK.label
"""What is said of motion beside the plan itself."""


@dataclass(frozen=True)
class Place:
    """A job with its files: program, machine file, and setup: a file, ``zero`` or None."""

    program: Path
    machine: Path
    setup: str | None
    dialect: str

    def session(self) -> Session:
        """Everything read as ``gproof check`` reads it."""
        return open_session(self.program, machine=self.machine, setup=self.setup, dialect=self.dialect)


def again(place: Place, session: Session, machine: Machine, setup: Setup) -> Session:
    """The same job for other facts, read anew: how lines are read can rest on the machine."""
    findings = Findings()
    program: Program | None
    if place.dialect == "wincnc":
        from gproof.frontend.wincnc.load import load_program as load_wincnc

        read = [Path(name) for name, _, role in session.inputs if role == "machine"]
        program = load_wincnc(place.program, findings, machine, place.machine, read)
    elif place.dialect == "mcuwin":
        from gproof.frontend.mcuwin.load import load_program as load_mcuwin

        program = load_mcuwin(place.program, findings, machine, place.machine)
    else:
        from gproof.frontend.eding.job import _macro_file
        from gproof.frontend.eding.load import load_program
        from gproof.frontend.eding.long_file import judge_length

        macro, machine = _macro_file(machine, place.machine, place.program)
        program = load_program(place.program, findings, macro)
        if program is not None:
            judge_length(program, eding_settings(machine).super_long_file, findings)
    return replace(session, program=program, machine=machine, setup=setup, findings=findings)


def answers(session: Session) -> dict[str, str]:
    """By target what is answered: of a property verdict, conditions and findings, of plan and stream a digest."""
    judgement = judge(session, running=BLOCKS, properties=every_property())
    told: dict[str, list[str]] = {}
    for finding in judgement.findings.kept:
        told.setdefault(finding.code.decides, []).append(f"{finding.code.label} {finding.span.line} {finding.message}")
    found = {}
    for result in judgement.properties:
        more = (*told.get(result.name, ()), *(told.get("files", ()) if result.name == "language" else ()))
        conditions = ", ".join(f"{c.low} <= {c.terms} <= {c.high}" for c in result.conditions)
        found[result.name] = "\n".join((result.verdict.name, conditions, *sorted(more)))
    found["trace"] = found["plan"] = found["stream"] = "none"
    session.findings = Findings()
    if session.program is not None and not judgement.findings.has(Severity.ERROR, ("language", "files")):
        lowered = lower(session, BLOCKS, "stream")
        why = " ".join(sorted({f.code.label for f in session.findings.kept if f.severity is not Severity.NOTE}))
        found["trace"] = _digest(print_ir(lowered.trace))
        for name, stage in (("plan", lowered.plan), ("stream", lowered.stream)):
            found[name] = f"none: {why}" if stage is None else _digest(print_ir(stage))
    found["plan"] += "".join(f"\n{one}" for one in sorted(told.get("motion", ())) if one.startswith(NOTED))
    return found


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()
