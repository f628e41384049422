"""Whether a section can be sent in time: bytes of the link and places of the board at every instant, before it moves.

Messages go out one after the other, in the order in which they are due. Each waits until the one before it is on the
wire, until the board has a place for it, and until it is within what the host sends ahead. When it has arrived follows
from this by a running maximum, exactly, so that no window of the section is left out; what is not known exactly (how
long messages are, when the host takes its turns, where it cuts runs) counts with its worst.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from gproof.backend.runs import Ints, ends, spans
from gproof.ir.columns import Columns
from gproof.ir.record import record
from gproof.ir.stream import StreamSection

_LONG_AGO = -(2**62)

WINDOW, LEAST_SPARE = 0.25, 0.01
"""Seconds before a message is due over which the steps count that the board makes meanwhile; the part of its processor
that they leave at least."""


@record(frozen=True, slots=True, kw_only=True)
class Link:
    """Between host and board. rate: bytes a second, 0: no limit is known; sizes: (motor, runs) -> bytes of each at
    most; event_bytes: of one event at most; places: runs and events that the board stores. In ticks: latency: from the
    end of sending until it is stored; ahead: what the host sends ahead at most; turn: at most between two looks of the
    host for what can be sent. run_ticks, step_ticks: what the board's processor takes for a message and for a step, 0
    where it states nothing."""

    tick_frequency: int
    rate: float
    sizes: Callable[[int, Columns], Ints]
    event_bytes: int
    places: int
    latency: int
    ahead: int
    turn: int
    run_ticks: int = 0
    step_ticks: int = 0


@record(frozen=True, slots=True, kw_only=True)
class Shortage:
    """The first message that comes too late. due, late: ticks; begin: where the crowded time begins; messages, bytes:
    in it; places: the board has no free place, else the link is too slow."""

    due: int
    late: int
    begin: int
    messages: int
    bytes: int
    places: bool


@record(frozen=True, slots=True, kw_only=True)
class LinkPlan:
    """lead: ticks before tick 0 at which sending has to begin; slack: ticks by which the message that is closest to
    being late comes early, with that lead; shortage: None where all come in time; where not, the slack is below 0."""

    lead: int
    slack: int
    shortage: Shortage | None


def link_plan(section: StreamSection, link: Link) -> LinkPlan:
    """How a section goes over a link. Runs are those that the board's words hold."""
    due, finish, size = _messages(section, link)
    if not len(due):
        return LinkPlan(lead=link.latency + link.turn, slack=link.ahead, shortage=None)
    motors = len(section.runs)
    on_wire = np.maximum(_ticks_on_wire(size, link, motors * int(size.max())), _ticks_of_processor(due, section, link))
    passed = np.cumsum(on_wire)
    before = passed - on_wire
    # What has ended by the time that a message is due was due before it: it counts all that it may count, where nothing
    # is late. Each turn of the host may cut a run of every motor: one place more each.
    places = max(1, link.places - motors)
    free = np.full(len(due), _LONG_AGO, dtype=np.int64)
    if len(due) > places:
        free[places:] = np.sort(finish)[: len(due) - places] + link.latency
    may_begin = np.maximum(free, due - link.ahead) + link.turn
    # Whatever happens later, all that is on the wire by then has to be there: no lesser lead can do.
    lead = min(link.ahead, max(0, int((passed - due).max())) + link.latency + link.turn)
    # Sending begins at -lead with what is within reach then, and waits for no turn.
    starts = np.where((free == _LONG_AGO) & (due - link.ahead <= -lead), -lead, may_begin)
    arrived = passed + np.maximum.accumulate(starts - before) + link.latency
    early = due - arrived
    worst = int(early.min())
    if worst >= 0:
        return LinkPlan(lead=lead, slack=worst, shortage=None)
    late = int(np.argmax(early < 0))
    begin = int(np.argmax((starts - before)[: late + 1]))
    shortage = Shortage(
        due=int(due[late]), late=-int(early[late]), begin=int(starts[begin]), messages=late - begin + 1,
        bytes=int(size[begin : late + 1].sum()), places=bool(free[begin] + link.turn >= may_begin[begin]),
    )  # fmt: skip
    return LinkPlan(lead=lead, slack=worst, shortage=shortage)


def shortage_text(found: Shortage, tick_frequency: int, number: int, links: str) -> str:
    """In words; number: of the section; links: how fast the link is."""
    seconds = found.due / tick_frequency
    crowd = f"{found.messages} messages of {found.bytes} bytes are due from {found.begin / tick_frequency:.3f} s on"
    why = "the board has no place for them in time" if found.places else links
    return (
        f"section {number}, {seconds:.3f} s after its start (tick {found.due}): a step would come"
        f" {found.late / tick_frequency * 1000:.1f} ms too late; {crowd}, and {why}"
    )


def _messages(section: StreamSection, link: Link) -> tuple[Ints, Ints, Ints]:
    """(tick when it is due, tick when its place is free again, bytes) of all messages, in the order in which they are
    due."""
    due, finish, size = [section.events["tick"].astype(np.int64)], [section.events["tick"].astype(np.int64)], []
    size.append(np.full(len(section.events), link.event_bytes, dtype=np.int64))
    for motor, runs in enumerate(section.runs):
        end = ends(runs)
        due.append(end - spans(runs) + runs["interval"])
        finish.append(end)
        size.append(link.sizes(motor, runs).astype(np.int64))
    all_due, all_finish, all_size = np.concatenate(due), np.concatenate(finish), np.concatenate(size)
    order = np.argsort(all_due, kind="stable")
    return all_due[order], all_finish[order], all_size[order]


def _ticks_on_wire(size: Ints, link: Link, cuts: int) -> Ints:
    """How long each message takes; cuts: bytes that those of the host cost in a turn, which are spread over all."""
    if not link.rate:
        return np.zeros(len(size), dtype=np.int64)
    rate = link.rate - (cuts * link.tick_frequency / link.turn if link.turn else 0.0)
    if rate <= 0:
        return np.full(len(size), 2**31, dtype=np.int64)
    found: Ints = np.ceil(size * (link.tick_frequency / rate)).astype(np.int64)
    return found


def _ticks_of_processor(due: Ints, section: StreamSection, link: Link) -> Ints:
    """How long the board works at each message beside the steps that it makes while the message comes."""
    if not link.run_ticks:
        return np.zeros(len(due), dtype=np.int64)
    window = max(1, min(link.ahead, int(WINDOW * link.tick_frequency)))
    steps = np.zeros(len(due))
    for runs in section.runs:
        ticks, made = np.r_[0, ends(runs)], np.r_[0, np.cumsum(runs["count"], dtype=np.int64)]
        steps += np.interp(due, ticks, made) - np.interp(due - window, ticks, made)
    spare = np.maximum(LEAST_SPARE, 1 - steps * link.step_ticks / window)
    found: Ints = np.ceil(link.run_ticks / spare).astype(np.int64)
    return found
