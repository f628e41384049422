"""McuWIN programs whose traces were worked out by hand from the manual: gproof agrees, row by row."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any

import pytest
from hand.compare import LISTED, fits, lengthless, open_or_wrong, rows_of
from support.bundles import unpacked
from support.campaigns import share

from gproof.driver.running import begin, execute
from gproof.driver.session import Session, open_session
from gproof.ir.finding import Finding, Findings
from gproof.ir.setup import ZERO
from gproof.ir.text import parse_ir, print_ir
from gproof.passes.checks.arc_radius import ArcRadius
from gproof.passes.checks.limits.soft_limits import Limits
from gproof.passes.checks.limits.work_boundaries import Boundaries

HAND = unpacked("tests/hand")
PROGRAMS = sorted(HAND.glob("mcuwin/*/*.jsonl"))
UNLISTED = {"units", "setpoint"}
GO_ON = {"veteran/feed-of-nothing"}
"""Behind the finding of these the program goes on."""


def session_of(program: Path) -> Session:
    return open_session(program, machine=program.with_name("machine.toml"), setup="zero", dialect="mcuwin")


def run(program: Path, stated: dict[str, Any]) -> tuple[list[dict[str, Any]], list[Finding]]:
    """Rows as in docs/trace-jsonl.md, and what is wrong or unknown."""
    session = session_of(program)
    if session.program is None:
        return [], open_or_wrong(session.findings.kept)
    inputs = {int(n): float(on) for n, on in stated.get("inputs", {}).items()}
    setup = dataclasses.replace(ZERO, inputs=inputs, default_parameter=None, optional_stop=None)
    findings: Findings = session.findings
    executor = begin(session.program, setup, session.machine, findings)
    given = session.machine, setup, findings
    checks = [Limits(*given), Boundaries(*given), ArcRadius(*given)]
    rows = rows_of(executor, session.machine, checks, program)
    return rows, open_or_wrong(findings.kept)


def as_written(row: dict[str, Any]) -> dict[str, Any]:
    """A row in the words of README.md: a channel is on or off, texts have no blanks."""
    if row["op"] == "output" and "on" not in row:
        return {**row, "on": row["value"] == 1.0}
    if row["op"] == "message":
        return {**row, "text": "".join(str(row["text"]).split())}
    return row


@pytest.mark.parametrize("shop", share(sorted({path.parent for path in PROGRAMS}), 4), ids=lambda path: path.name)
def test_text_forms_parse_back(shop: Path) -> None:
    """Machine, Program and Trace of every program: the same text, the same value."""
    machines: list[Any] = []  # all that differ: the programs of a shop share theirs
    for program in (path.with_suffix(".din") for path in PROGRAMS if path.parent == shop):
        session = session_of(program)
        if session.program is None:
            continue
        # Every section of a loop over what nobody knows has the same form.
        trace = execute(session.program, ZERO, session.machine, Findings(), max_branches=64)
        trace.verify()
        stages = [session.program, trace]
        if session.machine not in machines:
            machines.append(session.machine)
            stages.append(session.machine)
        for stage in stages:
            text = print_ir(stage)
            again = parse_ir(text)
            assert print_ir(again) == text, program
            assert stage is not session.program or again == stage, program


@pytest.mark.parametrize("expected", PROGRAMS, ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_trace_is_that_of_the_manual(expected: Path) -> None:
    about, *wanted = [json.loads(text) for text in expected.read_text("utf-8").splitlines() if text.strip()]
    assert about["op"] == "about"
    program = expected.with_suffix(".din")
    rows, findings = run(program, about.get("setup", {}))
    rows = [as_written(row) for row in lengthless([r for r in rows if r["op"] in LISTED - UNLISTED])]
    rows = [row for row in rows if row["op"] != "dwell" or row["seconds"] > 0.0]
    told = [row for row in wanted if row["op"] == "finding"]
    for finding in told:
        lines = [(f.span.line, f.severity.value) for f in findings]
        if "line" not in finding:
            assert findings, finding
        elif finding["severity"] == "error":
            assert (finding["line"], "error") in lines, (finding, findings)
        else:
            assert any(line >= finding["line"] for line, _ in lines), (finding, findings)
    if not told:
        assert not findings, [f"{f.span.line}: {f.code.label} {f.message}" for f in findings]
    at = 0
    for row in (as_written(row) for row in wanted if row["op"] != "finding"):
        assert at < len(rows), f"no row for {row}"
        difference = fits(row, rows[at], str(program))
        assert not difference, f"{difference}: {rows[at]} in place of {row}"
        at += 1
    if not told or f"{expected.parent.name}/{expected.stem}" in GO_ON:
        assert rows[at:] == [], rows[at:]
