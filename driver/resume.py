"""A new program that goes on with a job in its middle; the job's own rows after its way there, or none.

The dialect writes the text (``Frontend.resumed``). It is executed as any other, and every row after the way there must
be the row of the job: position, feed, modes, tool, spindle, coolant and outputs. So nothing that was in force can be
forgotten without notice.
"""

from __future__ import annotations

import dataclasses
import os
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from gproof.driver.dialects import DIALECTS
from gproof.driver.errors import UsageError
from gproof.driver.running import execute
from gproof.driver.session import Running, Session, open_session
from gproof.frontend.common.resuming import CannotResume, Resumed, Start
from gproof.ir.columns import Columns, joined
from gproof.ir.finding import Severity
from gproof.ir.record import record
from gproof.ir.trace import KNOWN_FRAME, TRACE_ROW, Op, Trace

CLOSE = 1e-4
"""Mm and degrees by which places of the two programs may differ: positions are printed with seven decimals."""


@record(frozen=True, slots=True, kw_only=True)
class Continued:
    """The new program; line: of the job where it goes on; start: machine position there; rows: of the job that it has
    again, of so many."""

    resumed: Resumed
    line: int
    start: Start
    rows: int
    of: int


def resume(
    job: Path, line: int, output: Path, *, machine: Path, setup: str, dialect: str | None, running: Running
) -> Continued:  # fmt: skip
    """Write the program that goes on at a line; UsageError, with what is in the way, and nothing is left over."""
    session = open_session(job, machine=machine, setup=setup, dialect=dialect)
    writer = DIALECTS[session.dialect].frontend.resumed
    if writer is None:
        raise UsageError(f"{job}: resume does not work for programs of {DIALECTS[session.dialect].frontend.title}")
    trace, rows = _executed(session, running, job)
    lines = job.read_text(encoding="utf-8", errors="surrogateescape").splitlines()
    if not 1 <= line <= len(lines):
        raise UsageError(f"--from-line {line}: {job} has {len(lines)} lines")
    if int(np.searchsorted(rows["line"], line)) == len(rows):
        raise UsageError(f"--from-line {line}: nothing of {job} is left from there on")
    opened = {"machine": machine, "setup": setup, "dialect": session.dialect}
    whole = _Job(session, trace, rows, tuple(lines))
    try:
        return _written(whole, line, output, running, opened)
    except CannotResume as error:
        hint = _before(whole, error.line, line, output, running, opened)
        raise UsageError(f"{job} cannot go on at line {line}: {error}{hint}") from None


@record(frozen=True, slots=True)
class _Job:
    """The job: its session, trace, rows in their order, and lines."""

    session: Session
    trace: Trace
    rows: Columns
    lines: tuple[str, ...]


def _written(
    job: _Job, line: int, output: Path, running: Running, opened: dict[str, Any], *,
    keep: bool = True, start: Start | None = None,
) -> Continued:  # fmt: skip
    """The program, compared with the job and then written if it is to be kept; CannotResume, UsageError: no file."""
    trace, rows = job.trace, job.rows
    first = int(np.searchsorted(rows["line"], line))
    start = start or _start(job.session, trace, rows, first, line)
    writer = DIALECTS[job.session.dialect].frontend.resumed
    assert writer is not None
    made = writer(job.lines, start)
    # Under a name of its own until it is compared: a program that nobody judged must not be left under the right one.
    draft = output.with_name(f".{os.getpid()}.{output.name}")
    try:
        draft.write_text(made.text, encoding="utf-8", errors="surrogateescape")
        again = open_session(draft, **opened)
        try:
            new_trace, new_rows = _executed(again, running, output)
        except UsageError as error:
            raise CannotResume(f"the new program would not run ({error})") from None
        added = len(made.added)
        new_first = int(np.searchsorted(new_rows["line"], added + 1))
        ahead = new_rows.slice(0, new_first)
        if start.work and not any(start.work) and any(zero := _zero(again, start, ahead)):
            return _written(job, line, output, running, opened, keep=keep, start=dataclasses.replace(start, work=zero))
        why = _way_there(again, start, ahead, new_trace)
        frame = int(rows["frame"][first - 1]) if first else trace.sections[0].start_frame
        if not why and trace.frames[frame] != new_trace.frames[int(ahead["frame"][-1])]:
            why = "the path there would end on other offsets"
        why = why or _other(
            (trace, rows.slice(first, len(rows)), line - 1),
            (new_trace, new_rows.slice(new_first, len(new_rows)), added),
        )  # fmt: skip
        if not why and _coolant(rows, first) != _coolant(new_rows, new_first):
            why = "its coolant would not be on or off as it was"
        if not why and _outputs(rows, first) != _outputs(new_rows, new_first):
            why = "its outputs would not be on or off as they were"
        if why:
            raise CannotResume(why)
        if keep:
            os.replace(draft, output)
    except OSError as error:
        raise UsageError(f"output {output}: {error.strerror or error}") from None
    finally:
        with suppress(OSError):
            draft.unlink()
    return Continued(resumed=made, line=line, start=start, rows=len(rows) - first, of=len(rows))


TRIED = 4
"""Lines before that are tried for a hint, each by writing and executing the program."""

SHORT = 20_000
"""Rows of a job for which that is quick."""


def _before(job: _Job, in_the_way: int, line: int, output: Path, running: Running, opened: dict[str, Any]) -> str:
    """A line before at which the job can go on, as the end of a message; "" where none was found."""
    if len(job.rows) > SHORT:
        return ""
    last = in_the_way if 0 < in_the_way < line else line - 1
    for place in range(last, max(last - TRIED, 0), -1):
        try:
            _written(job, place, output, running, opened, keep=False)
        except (CannotResume, UsageError):
            continue
        return f"; line {place} can"
    return ""


def _zero(session: Session, start: Start, rows: Columns) -> tuple[float, ...]:
    """The known part of the zero, by which a way there ends off that was written without it."""
    axes = {axis.word: axis.index for axis in session.machine.axes}
    places = rows["to"][rows["op"] < Op.DWELL]
    if not len(places):
        return ()
    last = places[-1]
    off = [float(last[axes[word]]) - value for word, value in start.at]
    return tuple(value if abs(value) > CLOSE else 0.0 for value in off)


def _way_there(session: Session, start: Start, rows: Columns, trace: Trace) -> str:
    """What is wrong with the way there; "" where it goes across at the top alone and ends where the job was."""
    moves = rows["op"] < Op.DWELL
    places = rows["to"][moves]
    axes = {axis.word: axis.index for axis in session.machine.axes}
    at = np.array([value for _, value in start.at])
    if not len(places) or not np.allclose(places[-1][[axes[word] for word, _ in start.at]], at, rtol=0, atol=CLOSE):
        return "the path there would end at another place"
    others = [axes[word] for word, _ in start.at if word != "Z"]
    across = (np.abs(np.diff(places[:, others], axis=0)) > CLOSE).any(axis=1)
    height = places[:, axes["Z"]]
    up = np.array([not frame[2] for frame in trace.frames], dtype=bool)[rows["frame"][moves]]
    if not up[0] or not up[1:][across].all():
        return "the path there would not come from above"
    if abs(height[0] - start.top) > CLOSE or (np.abs(height[1:][across] - start.top) > CLOSE).any():
        return "the path there would not come from above"
    return ""


def _executed(session: Session, running: Running, path: Path) -> tuple[Trace, Columns]:
    """The trace of a job and its rows in the order in which they happen; UsageError where there is no one order."""
    if session.program is None or session.findings.has(Severity.ERROR):
        raise UsageError(f"{path}: has errors; see gproof check")
    trace = execute(
        session.program, session.setup, session.machine, session.findings, **session.options(running),
        block_delete=bool(session.setup.block_delete),
    )  # fmt: skip
    if session.findings.has(Severity.ERROR):
        raise UsageError(f"{path}: has errors; see gproof check")
    tables, number, seen = [], 0, set()
    while number >= 0:
        if number in seen or number >= len(trace.sections):
            raise UsageError(f"{path}: does not run straight through")
        seen.add(number)
        section = trace.sections[number]
        tables.append(section.rows)
        targets = {edge.target for edge in section.edges}
        if len(targets) > 1:
            raise UsageError(f"{path}: what it does after section {number} depends on an answer")
        number = targets.pop() if targets else -1
    rows = joined(TRACE_ROW, tables)
    outside = (rows["file"] != rows["file"][0]) | (rows["call"] != 0) if len(rows) else np.zeros(0, dtype=bool)
    if outside.any():
        place = int(np.flatnonzero(outside)[0])
        raise UsageError(
            f"{path}: line {int(rows['line'][place])} is in a subprogram or macro: resume needs one without"
        )
    if (np.diff(rows["line"]) < 0).any():
        raise UsageError(f"{path}: its lines do not run in their order")
    return trace, rows


def _start(session: Session, trace: Trace, rows: Columns, first: int, line: int) -> Start:
    """Where the axes are before a row, and how high they have to go to get there."""
    begin = trace.sections[0].start
    at = rows["to"][first - 1] if first else np.array(begin)
    frame = int(rows["frame"][first - 1]) if first else trace.sections[0].start_frame
    known = trace.frames[frame] == KNOWN_FRAME
    axes = {axis.word: axis for axis in session.machine.axes}
    if "Z" not in axes or axes["Z"].upper is None:
        raise CannotResume("the machine file states no upper limit of Z, to which the tool could be raised")
    before = np.vstack([np.array(begin), rows["to"][: first - 1]]) if first else np.zeros((0, 6))
    after = rows["to"][:first]
    # Heights compare only where they rest on the same offsets.
    rests = np.array([place[2] == trace.frames[frame][2] for place in trace.frames], dtype=bool)[rows["frame"][:first]]
    rapid = (rows["op"][:first] == Op.TRAVERSE) & (np.abs(after - before)[:, :2] > 0).any(axis=1) & rests
    height = float(after[rapid, 2].max(initial=-np.inf))
    down = (rows["op"][:first] == Op.FEED) & ((after - before)[:, 2] < 0) & (rows["feed"][:first] > 0)
    plunge = float(rows["feed"][:first][down].min()) if down.any() else None
    here, top = float(at[2]), float(axes["Z"].upper)
    moves = np.flatnonzero((rows["op"][:first] < Op.DWELL) & (np.abs(after - before) > 0).any(axis=1))
    # Where the job itself came at rapid, or never was anywhere else, the new program may too.
    at_rapid = not len(moves) or rows["op"][moves[-1]] == Op.TRAVERSE
    if not known and not at_rapid and not np.isfinite(height):
        raise CannotResume("where Z is there rests on an offset that is not known, and the job has not gone across yet")
    plane = here if at_rapid else max(here, height) if np.isfinite(height) else top
    plane = min(top, plane) if known else plane

    def earlier(number: int) -> dict[str, float] | None:
        row = int(np.searchsorted(rows["line"], number)) - 1
        if row >= 0 and trace.frames[int(rows["frame"][row])] != KNOWN_FRAME:
            return None
        place = rows["to"][row] if row >= 0 else np.array(begin)
        return {word: float(place[axis.index]) for word, axis in axes.items()}

    return Start(
        before=earlier, line=line, job=session.job.name,
        at=tuple((word, float(at[axis.index])) for word, axis in axes.items()),
        top=top, plane=plane, plunge=plunge, work=() if known else (0.0,) * len(axes),
    )  # fmt: skip


def _coolant(rows: Columns, until: int) -> tuple[float, float]:
    """Mist and flood before a row."""
    told = np.flatnonzero(rows["op"][:until] == Op.COOLANT)
    mist, flood = rows["arg"][told[-1]].tolist() if len(told) else (0.0, 0.0)
    return float(mist), float(flood)


def _outputs(rows: Columns, until: int) -> dict[float, float]:
    """Number of an output -> its value before a row, of those that were switched."""
    told = rows["arg"][:until][rows["op"][:until] == Op.OUTPUT]
    return {float(number): float(value) for number, value in told[:, :2].tolist()}


Side = tuple[Trace, Columns, int]
"""A trace, those of its rows that count, and the number of the line before theirs."""


def _other(job: Side, new: Side) -> str:
    """Why the new program is not the rest of the job; "" when it is."""
    (trace, rows, before), (new_trace, new_rows, added) = job, new
    if len(new_rows) != len(rows):
        return f"the new program would have {len(new_rows)} steps of execution, and the job has {len(rows)} left"
    lines = rows["line"]

    def at(wrong: Any, what: str) -> str:
        return f"line {int(lines[np.flatnonzero(wrong)[0]])} would have another {what} in the new program"

    for name, what in (("op", "operation"), ("turns", "arc"), ("plane", "plane")):
        if (wrong := rows[name] != new_rows[name]).any():
            return at(wrong, what)
    if (wrong := rows["line"] - before != new_rows["line"] - added).any():
        return at(wrong, "line")
    for name, what in (("to", "place"), ("center", "centre"), ("feed", "feed"), ("arg", "argument")):
        same = np.isclose(rows[name], new_rows[name], rtol=0, atol=CLOSE, equal_nan=True)
        if (wrong := ~(same if same.ndim == 1 else same.all(axis=1))).any():
            return at(wrong, what)
    pairs = np.unique(np.stack([rows["state"], new_rows["state"]], axis=1), axis=0)
    for old, other in pairs.tolist():
        mine, theirs = trace.states[old], new_trace.states[other]
        if mine != theirs:
            field = next(f.name for f in dataclasses.fields(mine) if _text(mine, f.name) != _text(theirs, f.name))
            return at(rows["state"] == old, f"{field.replace('_', ' ')} in force")
    frames = np.unique(np.stack([rows["frame"], new_rows["frame"]], axis=1), axis=0)
    if any(trace.frames[old] != new_trace.frames[other] for old, other in frames.tolist()):
        return "its places would rest on other offsets"
    return ""


def _text(state: object, name: str) -> str:
    return repr(getattr(state, name))
