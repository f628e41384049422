"""Programs whose traces were worked out by hand from the controller's manual: gproof agrees, row by row."""

from __future__ import annotations

import dataclasses
import json
import shutil
from pathlib import Path
from typing import Any

import pytest
from hand.compare import LISTED, fits, lengthless, open_or_wrong, rows_of
from support.bundles import unpacked
from support.campaigns import share

from gproof.driver.running import begin, execute
from gproof.driver.session import Session, open_session
from gproof.ir import codes
from gproof.ir.dialects.wincnc.settings import wincnc_settings
from gproof.ir.finding import Finding, Findings, Severity
from gproof.ir.machine import Machine
from gproof.ir.setup import ZERO, Interval, Setup
from gproof.ir.text import parse_ir, print_ir
from gproof.passes.checks.limits.soft_limits import Limits
from gproof.passes.checks.limits.work_boundaries import Boundaries

HAND = unpacked("tests/hand")
PROGRAMS = sorted(HAND.glob("wincnc/*/*.jsonl"))
OFF = dict.fromkeys(range(65), 0.0)


def setup_of(stated: dict[str, Any], machine: Machine) -> tuple[Setup, Machine]:
    """The state at the start that README.md says, with what a program states otherwise."""
    columns = {axis.word.lower(): axis.name for axis in machine.axes}
    answers = {n: float(word == "yes") for n, word in enumerate(stated.get("answers", []), 1)}
    inputs = {int(n): float(on) for n, on in stated.get("inputs", {}).items()}
    start = {columns[k]: Interval(v, v) for k, v in stated.get("position", {}).items()}
    measured = stated.get("measured", True)
    measures = {axis.name: Interval(0.0, 0.0) for axis in machine.axes if axis.word in "ZWUV"} if measured else {}
    setup = dataclasses.replace(
        ZERO, start=start, inputs=inputs, outputs=OFF, virtual=OFF, answers=answers, measures=measures
    )
    sign = {"add": 1, "subtract": -1, None: None}[stated.get("workspace_shift")]
    if sign is not None:
        settings = dataclasses.replace(wincnc_settings(machine), shift_sign=sign)
        machine = dataclasses.replace(machine, settings=settings)
    return setup, machine


def session_of(program: Path) -> Session:
    return open_session(program, machine=program.with_name("WINCNC.INI"), setup="zero", dialect="wincnc")


def run(program: Path, stated: dict[str, Any]) -> tuple[list[dict[str, Any]], list[Finding]]:
    """Rows as in docs/trace-jsonl.md, and what is wrong or unknown."""
    session = session_of(program)
    assert session.program is not None
    setup, machine = setup_of(stated, session.machine)
    findings: Findings = session.findings
    executor = begin(session.program, setup, machine, findings)
    checks = [Limits(machine, setup, findings), Boundaries(machine, setup, findings)]
    return rows_of(executor, machine, checks, program), open_or_wrong(findings.kept)


TAPS = [path.with_suffix(".tap") for path in PROGRAMS]


@pytest.mark.parametrize("shop", share(sorted({path.parent for path in TAPS}), 8), ids=lambda path: path.name)
def test_text_forms_parse_back(shop: Path) -> None:
    """Machine, Program and Trace of every program: the same text, the same value."""
    machines: list[Any] = []  # all that differ: the programs of a shop share theirs
    for program in (path for path in TAPS if path.parent == shop):
        session = session_of(program)
        assert session.program is not None
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


def without(program: Path, lines: set[int], folder: Path) -> Path:
    """A copy of a program in a folder of its shop's files, with some of its lines empty."""
    copy = folder / program.parent.name / program.name
    if not copy.parent.is_dir():
        shutil.copytree(program.parent, copy.parent)
    texts = program.read_bytes().split(b"\n")
    copy.write_bytes(b"\n".join(b"" if n in lines else text for n, text in enumerate(texts, 1)))
    return copy


@pytest.mark.parametrize("expected", PROGRAMS, ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_trace_is_that_of_the_manual(expected: Path, tmp_path: Path) -> None:
    """Row by row. No controller comes by a line that it refuses: what follows is judged without that line, and each
    of several by itself."""
    about, *wanted = [json.loads(text) for text in expected.read_text("utf-8").splitlines() if text.strip()]
    assert about["op"] == "about"
    program = expected.with_suffix(".tap")
    stated = about.get("setup", {})
    rows, findings = run(program, stated)
    told = [row for row in wanted if row["op"] == "finding"]
    beyond = {f.span.line for f in findings if f.code.decides in ("limits", "areas")}
    refused = {row["line"] for row in told if row["severity"] == "error" and "file" not in row} - beyond
    if refused and {f.span.file for f in findings} == {str(program)}:
        rows, _ = run(without(program, refused, tmp_path), stated)
        for line in refused if len(refused) > 1 else ():
            findings += run(without(program, refused - {line}, tmp_path), stated)[1]
    rows = lengthless([row for row in rows if row["op"] in LISTED])
    for finding in told:
        lines = [(f.span.line, f.severity.value) for f in findings]
        if finding["severity"] == "error":
            assert (finding["line"], "error") in lines, (finding, findings)
        else:
            assert any(line >= finding["line"] for line, _ in lines), (finding, findings)
    if not told:
        # What nobody can say of the machine's limits is no matter of the trace.
        findings = [f for f in findings if f.severity is Severity.ERROR or f.code.decides != "limits"]
        assert not findings, [f"{f.span.line}: {f.message}" for f in findings]
    # Behind a limit the file lists nothing.
    is_cut = any(f.code in {codes.SOFT_LIMIT, codes.BOUNDARY_EXCEEDED} for f in findings)
    at = 0
    for row in (row for row in wanted if row["op"] != "finding"):
        assert at < len(rows), f"no row for {row}"
        difference = fits(row, rows[at], str(program))
        assert not difference, f"{difference}: {rows[at]} in place of {row}"
        at += 1
    if not is_cut and not any(row["op"] == "finding" and row["severity"] == "unknown" for row in wanted):
        assert rows[at:] == [], rows[at:]
