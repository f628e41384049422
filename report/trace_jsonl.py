"""The trace as JSON Lines: one object a line, in order of execution; docs/trace-jsonl.md defines the keys."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from typing import Any

from gproof.ir.finding import Finding
from gproof.ir.machine import AXIS_NAMES, Machine
from gproof.ir.symbolic import ORIGIN, Position
from gproof.ir.symbols import describe
from gproof.ir.trace import Chunk, Edge, Op, Plane, State, Trace, Wait
from gproof.report.escape import json_text

_PLANES = {Plane.XY: ("XY", 0, 1), Plane.XZ: ("XZ", 0, 2), Plane.YZ: ("YZ", 1, 2)}
_PAIRS = {Plane.XY: "xy", Plane.XZ: "zx"}
_DIRECTIONS = {1: "cw", -1: "ccw", 0: "off"}
_PATH_MODES = ("exact_path", "exact_stop", "continuous")


def _number(value: float) -> float | None:
    return None if math.isnan(value) else value


def marked_lines(chunk: Chunk, machine: Machine, job: str, before: int | None = None) -> Iterator[str]:
    """The rows of a chunk between the marks of sections; before: none from this row on."""
    if chunk.section and not chunk.begin:
        yield _section(chunk, _columns(machine), job)
    yield from itertools.islice(chunk_lines(chunk, machine, job), before)
    if chunk.last and before is None:
        for edge in chunk.edges:
            if edge.wait is not Wait.END:
                yield _branch(chunk, edge, job)


def _columns(machine: Machine) -> dict[str, int]:
    """Columns by the words of the machine's axes."""
    return {axis.word.lower(): axis.index for axis in machine.axes}


def _section(chunk: Chunk, columns: dict[str, int], job: str) -> str:
    """Where a section except the first starts: rows that follow continue from here, not from those before."""
    line = int(chunk.rows["line"][0]) if len(chunk.rows) else 0
    state = chunk.trace.states[int(chunk.rows["state"][0])] if len(chunk.rows) else None
    out: dict[str, Any] = {"op": "section", "line": line}
    if line and chunk.trace.files[int(chunk.rows["file"][0])] != job:
        out["file"] = chunk.trace.files[int(chunk.rows["file"][0])]
    return json_text(
        out | {"section": chunk.section} | _place(chunk.trace, chunk.start, chunk.start_frame, columns, _zeros(state))
    )


def _branch(chunk: Chunk, edge: Edge, job: str) -> str:
    """What ends the wait at the end of a section, and which section follows then; none: the program is over."""
    out: dict[str, Any] = {"op": "branch", "line": edge.line}
    if chunk.trace.files and chunk.trace.files[edge.file] != job:
        out["file"] = chunk.trace.files[edge.file]
    out |= {"section": chunk.section, "wait": edge.wait.name.lower(), "outcome": edge.outcome}
    return json_text({**out, "target": None if edge.target < 0 else edge.target})


def _zeros(state: State | None) -> dict[int, Position]:
    """Where the controller's machine zero is, by axis, where a program has moved it (L28)."""
    edges = state.boundaries if state is not None else ()
    held = (edge for edge in edges if edge.limit and not edge.open)
    return {edge.axis: Position(edge.shift, edge.form) for edge in held if edge.shift or edge.form}


def _place(
    trace: Trace, at: Sequence[float], frame: int, columns: dict[str, int], zeros: dict[int, Position]
) -> dict[str, Any]:
    """A position by axis as the controller counts it, with what has to be added to it."""
    forms = trace.frames[frame]
    places = {
        name: Position(at[column], forms[column]).minus(zeros.get(column, ORIGIN)) for name, column in columns.items()
    }
    unknown = {name: describe(place.form) for name, place in places.items() if place.form}
    place = {"to": {name: place.value for name, place in places.items()}}
    return {**place, "relative_to": unknown} if unknown else place


def chunk_lines(chunk: Chunk, machine: Machine, job: str) -> Iterator[str]:
    """The rows of a chunk, a JSON object each."""
    trace, rows = chunk.trace, chunk.rows
    columns = _columns(machine)
    cells = {c.name: rows[c.name].tolist() for c in rows.schema.columns}
    for i in range(len(rows)):
        row = {name: values[i] for name, values in cells.items()}
        op = Op(row["op"])
        out: dict[str, Any] = {"op": op.name.lower(), "line": row["line"]}
        if trace.files[row["file"]] != job:
            out["file"] = trace.files[row["file"]]
        if op < Op.DWELL:
            zeros = _zeros(trace.states[row["state"]])
            out |= _place(trace, row["to"], row["frame"], columns, zeros)
            if op is not Op.TRAVERSE:
                out["feed"] = _number(row["feed"])
                if trace.states[row["state"]].synchronised:
                    out["synchronised"] = True
            if op is Op.ARC:
                name, p, q = _PLANES[Plane(row["plane"])]
                center = [row["center"][axis] - zeros.get(axis, ORIGIN).value for axis in (p, q)]
                out |= {"plane": name, "center": center, "turns": row["turns"]}
            side = trace.states[row["state"]].compensation
            if side:
                out["compensation"] = "left" if side > 0 else "right"
                out["programmed"] = dict(zip(_PAIRS[Plane(abs(side))], row["arg"], strict=True))
        else:
            out |= _event(op, row["arg"], trace.texts, row["text"])
        yield json_text(out)


def _event(op: Op, arg: list[float], texts: list[str], text: int) -> dict[str, Any]:
    first, second = arg
    match op:
        case Op.DWELL:
            return {"seconds": _number(first)}
        case Op.SPINDLE:
            return {"dir": _DIRECTIONS[int(first)], "rpm": _number(second)}
        case Op.COOLANT:
            return {"mist": bool(first), "flood": bool(second)}
        case Op.TOOL_CHANGE | Op.TOOL_OFFSET:
            return {"tool": None if math.isnan(first) else int(first)}
        case Op.OUTPUT:
            of = {"word": AXIS_NAMES[-1 - text]} if text < 0 else {}
            return {"channel": int(first), "value": second, "synchronised": text > 0, **of}
        case Op.SETPOINT:
            return {"name": texts[text], "channel": int(first), "value": _number(second)}
        case Op.INPUT_WAIT:
            return {"channel": int(first), "value": _number(second)}
        case Op.HOME:
            return {"axes": texts[text].split()}
        case Op.STOP:
            return {"optional": bool(first)}
        case Op.OFFSET:
            return {"coordinate_system": int(first), **({"stops": True} if second else {})}
        case Op.UNITS:
            return {"mm": first}
        case Op.PLANE:
            return {"plane": Plane(int(first)).name}
        case Op.OVERRIDE:
            return {"allowed": bool(first)}
        case Op.HEAD:
            return {"head": int(first)}
        case Op.PATH_MODE:
            return {"mode": _PATH_MODES[int(first)], "tolerance": second if math.isfinite(second) else None}
        case Op.GUARD:
            return {"name": texts[text], "on": bool(first)}
        case Op.MESSAGE | Op.DEVICE:
            return {"text": texts[text]}
    return {}


def error_line(finding: Finding) -> str:
    """The last line of a trace that ends in an error."""
    return json_text({"op": "error", "line": finding.span.line, "code": finding.code.label, "text": finding.message})
