"""Programs whose traces were worked out by hand from the controller's manual: gproof agrees, row by row."""

from __future__ import annotations

import dataclasses
import json
import math
from pathlib import Path
from typing import Any

import pytest

from gproof.cli.jsonl import chunk_lines
from gproof.cli.session import Session, open_session
from gproof.ir import codes
from gproof.ir.finding import Finding, Findings, Severity
from gproof.ir.machine import Machine
from gproof.ir.setup import ZERO, Interval, Setup
from gproof.ir.text import parse_ir, print_ir
from gproof.ir.trace import TRACE_ROW
from gproof.passes.boundaries import Boundaries
from gproof.passes.execute import Executor, execute
from gproof.passes.limits import Limits

HERE = Path(__file__).parent
PROGRAMS = sorted(path for path in HERE.glob("*/*/*.jsonl"))
LISTED = frozenset(
    "traverse feed probe arc dwell spindle setpoint output input_wait stop home tool_change message units".split()
)
TOLERANCE = 1e-4
FRAME = [column.name for column in TRACE_ROW.columns].index("frame")
OFF = dict.fromkeys(range(65), 0.0)


def setup_of(stated: dict[str, Any], machine: Machine) -> tuple[Setup, Machine]:
    """The state at the start that README.md says, with what a program states otherwise."""
    columns = {axis.word.lower(): axis.name for axis in machine.axes}
    answers = {n: float(word == "yes") for n, word in enumerate(stated.get("answers", []), 1)}
    inputs = {int(n): float(on) for n, on in stated.get("inputs", {}).items()}
    start = {columns[k]: Interval(v, v) for k, v in stated.get("position", {}).items()}
    setup = dataclasses.replace(ZERO, start=start, inputs=inputs, outputs=OFF, virtual=OFF, answers=answers)
    sign = {"add": 1, "subtract": -1, None: None}[stated.get("workspace_shift")]
    if sign is not None:
        controls = dataclasses.replace(machine.controller.controls, shift_sign=sign)
        machine = dataclasses.replace(machine, controller=dataclasses.replace(machine.controller, controls=controls))
    return setup, machine


def session_of(program: Path) -> Session:
    return open_session(program, machine=program.with_name("WINCNC.INI"), setup="zero", dialect="wincnc")


def run(program: Path, stated: dict[str, Any]) -> tuple[list[dict[str, Any]], list[Finding]]:
    """Rows as in docs/trace-jsonl.md, and what is wrong or unknown."""
    session = session_of(program)
    assert session.program is not None
    setup, machine = setup_of(stated, session.machine)
    findings: Findings = session.findings
    executor = Executor(session.program, setup, machine, findings)
    checks = [Limits(machine, setup, findings), Boundaries(machine, setup, findings)]
    rows: list[dict[str, Any]] = []
    symbols = executor.trace.symbols
    for chunk in executor.run():
        for check in checks:
            check.feed(chunk)
        for text, row in zip(chunk_lines(chunk, machine, str(program)), chunk.rows.rows(), strict=True):
            made = json.loads(text)
            starts = [0.0] * 6 if rows else list(chunk.start)
            made["start"] = {axis.word.lower(): (starts[axis.index],) * 2 for axis in machine.axes}
            if "to" in made:
                columns = {axis.word.lower(): axis.index for axis in machine.axes}
                frame = chunk.trace.frames[row[FRAME]]
                made["ranges"] = {name: _range(made["to"][name], frame[n], symbols) for name, n in columns.items()}
            rows.append(made)
    for check in checks:
        check.finish()
    return rows, [f for f in findings.kept if f.severity in (Severity.ERROR, Severity.UNKNOWN)]


def _range(value: float, form: tuple, symbols: dict[str, Interval]) -> tuple[float, float]:
    low = high = value
    for symbol, coefficient in form:
        known = symbols.get(symbol)
        if known is None:
            return -math.inf, math.inf
        ends = known.low * coefficient, known.high * coefficient
        low, high = low + min(ends), high + max(ends)
    return low, high


def same(wanted: Any, found: Any) -> bool:
    if isinstance(wanted, float | int) and isinstance(found, float | int):
        return abs(wanted - found) <= TOLERANCE
    if isinstance(wanted, list) and isinstance(found, list):
        return len(wanted) == len(found) and all(map(same, wanted, found))
    return bool(wanted == found)


def fits(wanted: dict[str, Any], found: dict[str, Any], files: str) -> str:
    """What is different between a row that is expected and one that was made, "" for nothing."""
    ops = {wanted["op"]} | ({"probe"} if wanted["op"] == "feed" else set())
    if wanted["op"] == "spindle" and found["op"] == "setpoint":
        found = {**found, "op": "spindle", "rpm": found["value"]}
    if found["op"] not in ops and not (wanted["op"] == "dwell" and "seconds" not in wanted and found["op"] == "stop"):
        return f"{found['op']} in place of {wanted['op']}"
    for key, value in wanted.items():
        if key == "to":
            for axis, place in value.items():
                low, high = found["ranges"][axis]
                ends = (place["from"], place["to"]) if isinstance(place, dict) else (place, place)
                if place is None:
                    if low == high:
                        return f"{axis} is known to be {low}"
                elif isinstance(place, dict) and low == high and any(same(end, low) for end in ends):
                    continue  # the way to a switch, to its end
                elif not (same(min(ends), low) and same(max(ends), high)):
                    return f"{axis} is {low} to {high}, not {place}"
        elif key == "file":
            if Path(found.get("file", files)).name.lower() != value.lower():
                return f"file {found.get('file')}"
        elif key == "line":
            if found["line"] != value:
                return f"line {found['line']}, not {value}"
        elif key != "op" and key in found and not same(value, found[key]):
            return f"{key} is {found[key]!r}, not {value!r}"
    return ""


def _near(one: dict[str, Any], other: dict[str, Any]) -> bool:
    return all(a == b or abs(a - b) < 1e-9 for name in one for a, b in zip(one[name], other[name], strict=True))


def lengthless(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Without moves that stay where they are."""
    kept: list[dict[str, Any]] = []
    before: Any = rows[0]["start"] if rows else None
    for n, row in enumerate(rows):
        behind = rows[n + 1] if n + 1 < len(rows) else {}
        if row["op"] == "message" and behind.get("op") == "stop" and behind["line"] == row["line"]:
            continue  # the text of a wait
        if row["op"] == "setpoint" and row["name"] != "spindle_speed":
            continue
        if "to" in row:
            if row["op"] != "arc" and before is not None and _near(row["ranges"], before):
                continue
            before = row["ranges"]
        elif row["op"] == "home":
            before = None  # places count from elsewhere
        kept.append(row)
    return kept


TAPS = [path.with_suffix(".tap") for path in PROGRAMS]


@pytest.mark.parametrize("shop", sorted({path.parent for path in TAPS}), ids=lambda path: path.name)
def test_text_forms_parse_back(shop: Path) -> None:
    """Machine, Program and Trace of every program: the same text, the same value."""
    for program in (path for path in TAPS if path.parent == shop):
        session = session_of(program)
        assert session.program is not None
        trace = execute(session.program, ZERO, session.machine, Findings())
        trace.verify()
        for stage in (session.machine, session.program, trace):
            text = print_ir(stage)
            again = parse_ir(text)
            assert print_ir(again) == text, program
        assert parse_ir(print_ir(session.program)) == session.program, program


@pytest.mark.parametrize("expected", PROGRAMS, ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_trace_is_that_of_the_manual(expected: Path) -> None:
    about, *wanted = [json.loads(text) for text in expected.read_text("utf-8").splitlines() if text.strip()]
    assert about["op"] == "about"
    program = expected.with_suffix(".tap")
    rows, findings = run(program, about.get("setup", {}))
    rows = lengthless([row for row in rows if row["op"] in LISTED])
    told = [row for row in wanted if row["op"] == "finding"]
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
