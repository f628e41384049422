"""What the runtime notes of a run, as plain JSON values: from the board's answers before, in and after a section.

``trail.py`` takes the entries and makes the record from them; ``docs/execution-record.md`` lists them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from gproof.backend.boards.board import Capabilities, EventDone, Executed, Known, Status
from gproof.backend.job import CertifiedJob
from gproof.backend.record_data import BoardRecord, Loss, Retiming, SectionRecord, plain
from gproof.backend.section_run import SectionRun


def begin_fields(job: CertifiedJob, is_: Capabilities) -> dict[str, Any]:
    """Everything that the record says of a run that has not moved yet."""
    return {
        "certificate": job.certificate,
        "job": job.name,
        "board": plain(BoardRecord.of(is_)),
        "motors": [m.name for m in job.stream.motors],
        "start": list(job.stream.sections[0].start),
        "accepted": job.accepted,
        "signer": job.signer,
    }


def since(before: Sequence[int], after: Sequence[int]) -> tuple[int, ...]:
    """Counts of a section from those since the board was opened."""
    return tuple(int(b - a) for a, b in zip(before, after, strict=True))


def at_fields(tick: int, before: Status, seen: Status, events: Sequence[EventDone], base: int) -> dict[str, Any]:
    """How far a section has come; base: clock tick of its tick 0."""
    return {
        "tick": tick,
        "steps": list(since(before.steps, seen.steps)),
        "position": [int(place) for place in seen.position],
        "accepted": list(since(before.accepted, seen.accepted)),
        "events": [[e.tick - base, e.row, e.op] for e in events],
        "known": seen.known.value,
        "most": list(since(before.steps, seen.most)) if seen.most else [],
    }


def loss_of(before: Status, status: Status, base: int, reason: str, found: Status | None = None) -> Loss:
    """A board that is not heard any more; found: what it said when it was found again."""
    tick = status.tick if status.stopped_at is None else status.stopped_at
    return Loss(
        tick=max(0, int(tick - base)),
        reason=reason,
        steps=since(before.steps, status.steps),
        most=since(before.steps, status.most) if status.most else (),
        found=found is not None,
        known=status.known if found is None else found.known,
    )


def section_fields(
    before: Status, run: SectionRun, planned: list[Retiming], events: Sequence[EventDone],
    executed: tuple[Executed, ...], losses: tuple[Loss, ...],
) -> dict[str, Any]:  # fmt: skip
    """How a section went, from the board's first and last answers; losses: of its line."""
    ended = run.ended
    after = run.seen or before
    known = after.known
    if not ended.known and known is Known.EXACT:
        # It could not be asked after it had stopped: it is what was heard last.
        known = Known.BETWEEN
    done = SectionRecord(
        number=ended.section.number,
        outcome=ended.outcome,
        ticks=ended.ticks,
        retimings=(*planned, *ended.retimings),
        steps=since(before.steps, after.steps),
        position=tuple(int(place) for place in after.position),
        accepted=since(before.accepted, after.accepted),
        events=tuple((e.tick - run.base, e.row, e.op) for e in events),
        known=known,
        most=since(before.steps, after.most) if after.most else (),
        executed=executed,
        losses=losses,
    )
    return {"section": plain(done), "reason": ended.reason, "known": ended.known}
