"""Execution records: the data, reading them back, and comparing one with the package it was made from.

``verify_record`` says whether a record is one that running the package can give: order of sections, steps,
positions and events, all made again from the certified stream and the retimings that the record names.
"""

from __future__ import annotations

from collections.abc import Iterator

from gproof.backend.boards.board import VIRTUAL, Known, Observed
from gproof.backend.job import CertifiedJob, job_from
from gproof.backend.record_data import ExecutionRecord, Result, SectionRecord
from gproof.backend.record_parse import parse_record, read_record
from gproof.backend.record_proof import executed_problems, sent
from gproof.backend.runs import Done, done_by, expand
from gproof.ir import codes
from gproof.ir.finding import Finding, Span
from gproof.ir.stream import StreamSection
from gproof.ir.trace import Wait
from gproof.verify.certificate.package import Package

__all__ = ["ExecutionRecord", "Result", "parse_record", "problems", "read_record", "verify_record"]


def verify_record(record: ExecutionRecord, package: Package) -> list[Finding]:
    """GP833 for everything in which a record does not fit its package; none when it does."""
    place = Span(record.job, 0)
    return [codes.RECORD_MISMATCH.at(place, what=what) for what in problems(record, job_from(package, record.start))]


def problems(record: ExecutionRecord, job: CertifiedJob) -> Iterator[str]:
    """What does not fit, as sentences; none when the record is one that running the job can give."""
    stream = job.stream
    if record.certificate != job.certificate:
        yield f"the record is of certificate {record.certificate[:16]}…, not {job.certificate[:16]}…"
        return
    if record.motors != tuple(m.name for m in stream.motors):
        yield f"motors {list(record.motors)} differ from those of the stream"
        return
    if record.board.tick_frequency != stream.tick_frequency:
        yield f"the board counted {record.board.tick_frequency} ticks a second, not {stream.tick_frequency}"
    motors = len(stream.motors)
    lists = [record.start, record.steps, record.last_position if record.position is None else record.position]
    lists += [v for s in record.sections for v in (s.steps, s.position, s.accepted, s.most or s.steps)]
    lists += [v for s in record.sections for one in s.losses for v in (one.steps, one.most or one.steps)]
    if any(len(v) != motors for v in lists):
        yield "not one count for each motor"
        return
    if record.start != stream.sections[0].start:
        yield f"started at {list(record.start)}, but the stream starts at {list(stream.sections[0].start)}"
    yield from _order(record, job)
    at = record.start
    for section in record.sections:
        if 0 <= section.number < len(stream.sections):
            yield from _section(section, stream.sections[section.number], at, job, record)
        at = section.position
    totals = tuple(sum(s.steps[m] for s in record.sections) for m in range(motors))
    if record.steps != totals:
        yield f"{list(record.steps)} steps in all, {list(totals)} in the sections"
    known = record.sections[-1].known if record.sections else Known.EXACT
    if record.position is None:
        if record.result not in (Result.INTERRUPTED, Result.FAULT) and known is Known.EXACT:
            yield f"the position is not known, but the result is {record.result.value}"
    elif record.sections and record.sections[-1].outcome is Result.INTERRUPTED:
        yield f"section {record.sections[-1].number} was interrupted, but the record says that the position is known"
    elif known is not Known.EXACT:
        yield f"of section {record.sections[-1].number} the position is not known, but the record says that it is"
    elif record.position != at:
        yield f"ended at {list(record.position)}, but the last section ended at {list(at)}"
    if not record.observed.clean:
        yield f"the board reported pulses or direction changes that came too early: {_seen(record.observed)}"


def _seen(observed: Observed) -> str:
    return f"{sum(observed.overlaps)} pulses, {sum(observed.setups)} direction changes"


def _order(record: ExecutionRecord, job: CertifiedJob) -> Iterator[str]:
    """Sections follow the edges that were taken, and the result says how it ended."""
    expected = 0
    over = False
    for place, section in enumerate(record.sections):
        if over or section.number != expected or not 0 <= section.number < len(job.trace.sections):
            yield f"section {section.number} was executed in place {place}"
            return
        if section.outcome is not Result.COMPLETED:
            over = True
            if record.result is not section.outcome:
                yield f"the result is {record.result.value}, section {section.number} {section.outcome.value}"
            continue
        edges = job.trace.sections[section.number].edges
        taken = [e for e in edges if (e.wait.value, e.outcome, e.target) == _edge(section)]
        if not taken:
            stopped = not section.answer and section.target == -1
            if not stopped or (edges and record.result is Result.COMPLETED):
                yield f"section {section.number} has no answer {section.answer!r} to section {section.target}"
            over = True
            continue
        expected, over = section.target, section.target < 0
        if over and (taken[0].wait is Wait.END) != (record.result is Result.COMPLETED):
            yield f"the result is {record.result.value}, the last wait was {section.wait}"
    if record.result is Result.COMPLETED and (not record.sections or not over):
        yield "completed, but the end of the program was not reached"


def _edge(section: SectionRecord) -> tuple[str, str, int]:
    return section.wait, section.answer, section.target


def _section(
    done: SectionRecord, planned: StreamSection, at: tuple[int, ...], job: CertifiedJob, record: ExecutionRecord
) -> Iterator[str]:  # fmt: skip
    """Steps, position and events of one section."""
    where = f"section {done.number}"
    if at != planned.start:
        yield f"{where} starts at {list(planned.start)}, but the motors were at {list(at)}"
    try:
        section = sent(done, planned, job)
    except ValueError as error:
        yield f"{where}: {error}"
        return
    complete = done.outcome is Result.COMPLETED
    if complete and done.ticks != section.duration:
        yield f"{where}: completed after {done.ticks} ticks; it takes {section.duration}"
    broken = done.outcome in (Result.UNDERRUN, Result.FAULT, Result.INTERRUPTED)
    # A board with a clock of its own states when it stopped, or was heard to have: some steps may be due before.
    broken |= done.outcome is Result.EMERGENCY_STOP and record.board.name != VIRTUAL
    for motor, runs, start, steps, position in zip(
        job.stream.motors, section.runs, section.start, done.steps, done.position, strict=True
    ):
        due = done_by(runs, section.duration if complete else done.ticks)
        if steps > due.steps or (steps < due.steps and not broken):
            yield f"{where}: motor {motor.name} made {steps} steps instead of {due.steps}"
            continue
        if steps < due.steps:
            _, directions = expand(runs)
            due = Done(steps, int(directions[:steps].sum(dtype="int64")), 0)
        if done.known is not Known.UNKNOWN and position != start + due.net:
            yield f"{where}: motor {motor.name} ended at {position}; its steps lead to {start + due.net}"
    yield from _bounds(done, section, where, broken)
    yield from executed_problems(done, section, record, where)
    table = zip(*(section.events[n].tolist() for n in ("tick", "row", "op")), strict=True)
    events = tuple(e for e in table if complete or e[0] <= done.ticks)
    if done.events != events and not (broken and done.events == events[: len(done.events)]):
        yield f"{where}: {len(done.events)} events were executed, which are not the {len(events)} of the stream"


def _bounds(done: SectionRecord, section: StreamSection, where: str, broken: bool) -> Iterator[str]:
    """What is not known of a section, and what was lost in it."""
    if not broken and (done.known is not Known.EXACT or done.most or done.losses):
        yield f"{where}: {done.outcome.value}, but not all is known of it"
    whole = tuple(int(runs["count"].sum()) for runs in section.runs)
    if any(not least <= most <= all_ for least, most, all_ in zip(done.steps, done.most, whole, strict=False)):
        yield f"{where}: {list(done.most)} steps at most, {list(done.steps)} at least, {list(whole)} in the stream"
    for loss in done.losses:
        # The journal of a host that was killed just then says more of the loss than of the section.
        later = done.outcome is not Result.INTERRUPTED and any(
            least > made for least, made in zip(loss.steps, done.steps, strict=True)
        )
        if later or any(least > most for least, most in zip(loss.steps, loss.most, strict=False)):
            yield f"{where}: {list(loss.steps)} steps were known when the board was lost, {list(done.steps)} later"
