"""Rows that were worked out by hand, and rows that gproof made: what is different between them."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from gproof.ir.finding import Finding, Severity
from gproof.ir.machine import Machine
from gproof.ir.setup import Interval
from gproof.ir.trace import TRACE_ROW
from gproof.passes.interpret.core.run import Run
from gproof.report.trace_jsonl import chunk_lines

LISTED = frozenset(
    "traverse feed probe arc dwell spindle setpoint output input_wait stop home tool_change message units".split()
)
TOLERANCE = 1e-4
FRAME = [column.name for column in TRACE_ROW.columns].index("frame")


def rows_of(executor: Run, machine: Machine, checks: Iterable[Any], program: Path) -> list[dict[str, Any]]:
    """Rows as in docs/trace-jsonl.md, each with where its axes may be; checks: are fed with the trace."""
    rows: list[dict[str, Any]] = []
    symbols = executor.trace.symbols
    for chunk in executor.chunks():
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
    return rows


def open_or_wrong(findings: Iterable[Finding]) -> list[Finding]:
    """Those that are errors or unknown."""
    return [f for f in findings if f.severity in (Severity.ERROR, Severity.UNKNOWN)]


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
