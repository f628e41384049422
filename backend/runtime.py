"""The runtime: a certified package to a board, section by section, with a record of what came back.

Before any motion the package is checked again, whole; nothing is sent that was not validated, retimed
sections included. Between sections the operator answers. Whatever happens after the board was opened ends in
an ExecutionRecord that says how far it came, and what it is made from goes into a journal as it happens.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

from gproof.backend.boards.board import (
    Board,
    BoardError,
    Capabilities,
    EventDone,
    Executed,
    Observed,
    Status,
)
from gproof.backend.control import GREATEST_FACTOR, LEAST_FACTOR, Control
from gproof.backend.feed import Words, as_sent
from gproof.backend.interrupts import interrupts
from gproof.backend.job import CertifiedJob, RunRefused, checked_job, identity_of
from gproof.backend.journal import Notes
from gproof.backend.link import Link, LinkPlan, link_plan, shortage_text
from gproof.backend.manual_events import ManualWait, all_manual, manual_waits
from gproof.backend.operators import AutoContinue, HoldRequest, Operator, WaitRequest, request_at_end
from gproof.backend.record_data import ExecutionRecord, Loss, Result, Retiming, plain
from gproof.backend.retimer import Retimer
from gproof.backend.section_notes import at_fields, begin_fields, loss_of, section_fields, since
from gproof.backend.section_run import SLICE, Pace, Prepared, SectionRun
from gproof.backend.trail import Trail
from gproof.backend.unfit import unfit
from gproof.backend.watch import Moment, Watch
from gproof.ir import codes
from gproof.ir.finding import Finding, Span
from gproof.ir.machine import Machine
from gproof.ir.record import record
from gproof.ir.setup import Setup
from gproof.ir.stream import StreamSection
from gproof.ir.trace import Edge, Wait
from gproof.ir.verdict import Verdict
from gproof.verify.certificate.package import Package
from gproof.verify.certificate.signers import Trusted
from gproof.verify.stream import validate

__all__ = ["Control", "Hold", "RunFailed", "RunRefused", "run"]

Progress = Callable[[float], None]
Overridden = Callable[[Fraction, float | None], None]
Announce = Callable[[Sequence[WaitRequest]], None]

LEAD = 0.05
"""Seconds between opening a section and its first tick."""

LEAST_AHEAD, LEAST_SIMULATED = 0.05, 0.25
"""Seconds that are sent ahead at least, to a board in real time and to one in simulated time, however short a machine
file says that the controller's own buffer is: no host feeds a board more often, and with a millisecond a job of hours
takes minutes to simulate."""

LATENCY = 0.01
"""Seconds from the end of sending until a board on a link has stored what came, and until the host hears of it."""

PREPARING = 0.02
"""Seconds for calculating a feed hold while a board runs, in addition to one and a half times what a rehearsal took."""

EVERY = 0.1
"""Seconds between two words about where a run is."""

NOTED = 1.0
"""Seconds of motion between two entries of the journal that say how far a section has come."""


class RunFailed(Exception):
    """A callback or the runtime itself failed after the board was opened; ``record`` says how far it came."""

    def __init__(self, record: ExecutionRecord) -> None:
        super().__init__(record.reason)
        self.record = record


@record(frozen=True, slots=True, kw_only=True)
class Hold:
    """A feed hold planned before the run: ``at`` ticks of motion since the start, resting ``rest`` ticks."""

    at: int
    rest: int


def run(
    package: Package,
    board: Board | Callable[[], Board],
    *,
    operator: Operator | None = None,
    on_progress: Progress | None = None,
    hold_at: int | Hold | Sequence[Hold] | None = None,
    override: float | Fraction = 1,
    estop_at: int | None = None,
    machine: Machine | None = None,
    setup: Setup | None = None,
    trusted_keys: Trusted = None,
    allow_untrusted: bool = False,
    control: Control | None = None,
    journal: Notes | None = None,
    announce: Announce | None = None,
    on_moment: Callable[[Moment], None] | None = None,
    on_override: Overridden | None = None,
) -> ExecutionRecord:
    """Run a package on a board; RunRefused before any motion, a record afterwards whatever happens.

    RunFailed, with the record, when a callback raises. OSError when the journal cannot be started: nothing has moved.

    board: one, or how it is made, once the package has been checked. operator: who answers waits (default:
    AutoContinue). on_progress: called with the part of all ticks done.
    hold_at: feed holds, in ticks of motion since the start (an int rests for one second). override: 0.1 to 1,
    of the planned speed. estop_at: emergency stop at that tick of motion. machine, setup: what is at hand, when
    it is known apart from the package; trusted_keys: whose certificates are accepted; a board that moves something
    requires all three. allow_untrusted: on one that moves nothing, nobody has to be trusted. control: requests from
    other threads; Ctrl-C is a feed hold, a second one an emergency stop, and so are SIGTERM and SIGHUP. journal:
    what has to be there when this process ends before the run does; a run that cannot go on writing it ends at rest.
    announce: told before anything moves what no pin of the board does, so that the operator will be asked to.
    on_moment: told some times a second where the run is. on_override: told in how many seconds another one starts.
    """
    job = checked_job(
        package, machine=machine, setup=setup, trusted_keys=trusted_keys, allow_untrusted=allow_untrusted
    )  # fmt: skip
    return walk(
        job,
        board() if callable(board) else board,
        operator=operator,
        on_progress=on_progress,
        hold_at=hold_at,
        override=override,
        estop_at=estop_at,
        control=control,
        journal=journal,
        announce=announce,
        on_moment=on_moment,
        on_override=on_override,
    )


def walk(
    job: CertifiedJob,
    board: Board,
    *,
    operator: Operator | None = None,
    on_progress: Progress | None = None,
    hold_at: int | Hold | Sequence[Hold] | None = None,
    override: float | Fraction = 1,
    estop_at: int | None = None,
    control: Control | None = None,
    journal: Notes | None = None,
    announce: Announce | None = None,
    on_moment: Callable[[Moment], None] | None = None,
    on_override: Overridden | None = None,
) -> ExecutionRecord:
    """``run`` for a job that has been checked; only ``checked_job`` makes one from a package."""
    factor = Fraction(override).limit_denominator(1000)
    if not LEAST_FACTOR <= factor <= GREATEST_FACTOR:
        raise ValueError(f"override {override}: outside {LEAST_FACTOR} to {GREATEST_FACTOR}")
    if isinstance(hold_at, int):
        hold_at = Hold(at=hold_at, rest=job.stream.tick_frequency)
    holds = [hold_at] if isinstance(hold_at, Hold) else sorted(hold_at or (), key=lambda h: h.at)
    walking = _Walk(job, board, operator or AutoContinue(), control or Control())
    walking.factor, walking.holds = factor, holds
    walking.on_progress, walking.journal, walking.announce = on_progress, journal, announce
    walking.estop_at, walking.on_override = estop_at, on_override or walking.on_override
    if on_moment is not None:
        walking.on_moment, walking.watch = on_moment, Watch(job, factor)
    with interrupts(walking.control):
        walking.control.running()
        try:
            return walking.run()
        finally:
            walking.control.closing()


class _Walk:
    """The section graph, one section after the other."""

    def __init__(self, job: CertifiedJob, board: Board, operator: Operator, control: Control) -> None:
        self.job = job
        self.board = board
        self.operator = operator
        self.control = control
        self.factor = Fraction(1)
        self.holds: list[Hold] = []
        self.estop_at: int | None = None
        self.on_progress: Progress | None = None
        self.journal: Notes | None = None
        self.announce: Announce | None = None
        self.on_moment: Callable[[Moment], None] | None = None
        self.watch: Watch | None = None
        self.on_override: Overridden = lambda _, __: None
        self._told = 0.0
        self.trail = Trail()
        self.result = Result.FAULT
        self.reason = ""
        self.done_ticks = 0
        self._shown = -1.0
        self._noted = 0
        self._events: list[EventDone] = []
        self._events_noted = 0
        self._losses: list[Loss] = []
        self._marked: tuple[tuple[int, ...], object] = (), ()
        self._started = 0
        self._all_ticks = 1
        self.observed = Observed()
        self.retimer = Retimer(job.stream.motors, job.machine, job.stream.tick_frequency, self._accept)

    def run(self) -> ExecutionRecord:
        """Open the board, walk, close it."""
        is_ = self.board.open()
        refusals = list(unfit(self.job, is_)) or list(self._starved(is_))
        if refusals:
            self.board.close()
            raise RunRefused(refusals)
        self._all_ticks = int(sum(s.duration for s in self.job.stream.sections) / self.factor) or 1
        try:
            self._announce(is_)
            self._begin(is_)
        except BaseException:
            self.board.close()
            raise
        try:
            try:
                self.board.present(identity_of(self.job.certificate))
                number = 0
                while number >= 0:
                    number = self._section(number, is_)
            finally:
                with contextlib.suppress(BoardError):
                    self.observed = self.board.observed()
                    self.board.close()
        except BoardError as error:
            self.result, self.reason = Result.FAULT, str(error)
        except BaseException as error:
            self.result, self.reason = Result.FAULT, f"{type(error).__name__}: {error}"
            self._end()
            if not isinstance(error, Exception):
                raise
            raise RunFailed(self.trail.record()) from error
        self._end()
        return self.trail.record()

    def _announce(self, is_: Capabilities) -> None:
        """Say what the operator will be asked to do."""
        if self.announce is None or is_.acts_alone:
            return
        job = self.job
        if found := list(all_manual(job.stream, job.trace, job.machine.board.outputs)):
            with contextlib.suppress(OSError):
                self.announce(found)

    # What is noted.

    def _write(self, kind: str, fields: dict[str, Any], *, sync: bool = False) -> None:
        """Note an entry; one that the journal does not take ends the run at the next rest."""
        self.trail.add(kind, fields)
        if self.journal is None:
            return
        try:
            self.journal.note(kind, fields, sync=sync)
        except OSError as error:
            if kind == "begin":
                raise
            self.control.end_at_rest(f"the journal cannot be written ({error.strerror or error})")

    def _begin(self, is_: Capabilities) -> None:
        """Everything that the record says of a run that has not moved yet; OSError when that cannot be kept."""
        self._write("begin", begin_fields(self.job, is_), sync=True)

    def _end(self) -> None:
        fields = {"result": self.result.value, "reason": self.reason, "observed": plain(self.observed)}
        self._write("end", fields, sync=True)

    # One section.

    def _section(self, number: int, is_: Capabilities) -> int:
        """Run a section and what follows it; the next one's number, -1 at the end."""
        planned = self.job.stream.sections[number]
        self._overridden(self.control.override_asked or self.factor, 0.0)
        ready = self._prepared(planned, is_)
        if isinstance(ready, str):
            self.result, self.reason = Result.REFUSED, f"section {number}: {ready}"
            return -1
        section, retimings = ready
        if self.watch is not None:
            self.watch.prepare(number)
        waits = self._waits(is_, section)
        if self.control.signalled and self.control.hold_asked:
            self.result, self.reason = Result.STOPPED, f"section {number} was not started: interrupted, at rest"
            return -1
        while waits and not section.events["tick"][waits[0].event]:
            if not self._done_by_hand(waits.pop(0).request):
                return -1
        pace = self._pace(is_, section)
        before = self.board.status()
        fields = {"number": number, "start": list(section.start), "retimings": plain(retimings)}
        self._write("section", fields, sync=True)
        if self.control.ending:
            self._write("withdrawn", {})
            self.result, self.reason = Result.STOPPED, f"section {number} was not started: {self.control.ending}"
            return -1
        run = SectionRun(
            self.board,
            is_,
            section,
            pace=pace,
            prepare=self.retimer.hold,
            operator=self.operator,
            control=self.control,
            estop_at=None if self.estop_at is None else self.estop_at - self.done_ticks,
            on_tick=self._show,
            rest=lambda section, tick, rest: self.retimer.rest(section, [tick], rest),
            waits=waits,
            on_retimed=lambda held: self._write("retimed", {"retimings": plain([*retimings, *held])}),
        )
        run.on_sending = lambda given: self._mark(before, run, given)
        run.on_lost = lambda lost, found: self._lost(before, run, lost, found)
        run.on_tick = lambda now: self._passed(now, before, run)
        run.factor, run.on_override = self.factor, self._overridden
        if self.job.overridable(number):
            run.change = lambda section, held, tick, factor: self._changed(
                is_, planned, section, ([*retimings, *held], tick, factor)
            )
        self._noted, self._events, self._events_noted, self._losses = 0, [], 0, []
        self._started += 1
        self._mark(before, run, (0,) * len(section.start), begun=False)
        try:
            run.run()
        except KeyboardInterrupt:
            run.interrupted()
        except BoardError as error:
            run.broken(str(error))
        except BaseException as error:
            run.broken(f"{type(error).__name__}: {error}")
            raise
        finally:
            self._note(before, run, retimings)
        ended = run.ended
        self._tell(ended.ticks, before, run)
        if ended.outcome is not Result.COMPLETED:
            self.result, self.reason = ended.outcome, ended.reason
            return -1
        self.done_ticks += ended.ticks
        self._show(0)
        return self._follow(number)

    def _prepared(self, planned: StreamSection, is_: Capabilities) -> tuple[StreamSection, list[Retiming]] | str:
        """The section with the override and the holds that fall into it, or why it cannot be had."""
        section, retimings = planned, []
        if self.factor != 1 and self.job.overridable(planned.number):
            made = self.retimer.override(section, self.factor)
            if made is None:
                return f"at {float(self.factor):g} of its speed the stream does not pass the stream checker"
            section = made.section
            retimings.append(made.retiming)
        while self.holds and self.holds[0].at < self.done_ticks + section.duration:
            hold = self.holds.pop(0)
            made = self.retimer.hold(section, max(0, hold.at - self.done_ticks), hold.rest)
            if made is None:
                return f"with a feed hold at tick {hold.at - self.done_ticks} it does not pass the stream checker"
            section = made.section
            retimings.append(made.retiming)
        stops = [max(0, int(section.events["tick"][wait.event]) - 1) for wait in self._waits(is_, section)]
        if any(stops) and self.retimer.rest(section, [at for at in stops if at], is_.tick_frequency) is None:
            return "with a rest where the operator has something to do it does not pass the stream checker"
        if retimings and is_.link_rate and (found := self._link_plan(is_, section).shortage) is not None:
            return "retimed, " + shortage_text(found, is_.tick_frequency, planned.number, "the link is too slow")
        return section, retimings

    def _changed(
        self, is_: Capabilities, planned: StreamSection, section: StreamSection,
        how: tuple[list[Retiming], int, Fraction],
    ) -> Prepared | None:  # fmt: skip
        """The section with another override from a tick on; None where it does not pass, or holds are planned in it."""
        before, tick, factor = how
        if any(tick < one.rest_begins + one.rest for one in before):
            return None
        made = self.retimer.change(planned, section, before, tick, factor)
        short = made is not None and is_.link_rate and self._link_plan(is_, made.section).shortage is not None
        return None if short else made

    def _overridden(self, factor: Fraction, seconds: float | None) -> None:
        """Another override starts in so many seconds; None: it cannot."""
        if factor == self.factor:
            return
        if seconds is not None:
            self.factor = factor
            if self.watch is not None:
                self.watch.override(factor)
        with contextlib.suppress(OSError):
            self.on_override(factor, seconds)

    def _waits(self, is_: Capabilities, section: StreamSection) -> list[ManualWait]:
        """Where the operator does what no pin of the board does."""
        if is_.acts_alone:
            return []
        return manual_waits(section, self.job.trace, self.job.machine.board.outputs)

    def _done_by_hand(self, request: WaitRequest) -> bool:
        """Whether the operator has done something before a section starts; else the job ends here."""
        if self.control.ask(lambda: self.operator.wait(request)) is not None:
            return True
        why = self.control.ending or f"ended while waiting for the operator ({request.text})"
        self.result, self.reason = Result.STOPPED, f"section {request.section}: {why}"
        return False

    def _accept(self, section: StreamSection) -> bool:
        """The validator's answer for a section in its place."""
        sections = list(self.job.stream.sections)
        sections[section.number] = section
        stream = replace(self.job.stream, sections=sections)
        job = self.job
        report = validate(stream, job.trace, job.machine, job.setup, stretched=True, sections=(section.number,))
        return report.verdict is Verdict.SAFE

    def _pace(self, is_: Capabilities, section: StreamSection) -> Pace:
        """How far ahead to send. On a real board a feed hold is rehearsed while the motors are still at rest."""
        ticks = is_.tick_frequency
        began = time.monotonic()
        if is_.real_time:
            self.retimer.hold(section, section.duration // 2, ticks)
        seconds = PREPARING + 1.5 * (time.monotonic() - began)
        lead = int(LEAD * ticks)
        if is_.link_rate:
            lead = max(lead, self._link_plan(is_, section).lead)
        return Pace(lookahead=self._lookahead(is_), lead=lead, preparing=int(seconds * ticks))

    def _lookahead(self, is_: Capabilities) -> int:
        """Ticks that are sent ahead."""
        ahead = max(self.job.machine.controller.fifo_time, LEAST_AHEAD if is_.real_time else LEAST_SIMULATED)
        return max(1, int(ahead * is_.tick_frequency))

    def _link_plan(self, is_: Capabilities, section: StreamSection) -> LinkPlan:
        """How a section goes over the link of a board."""
        ticks, words = is_.tick_frequency, Words.of(is_)
        link = Link(
            tick_frequency=ticks, rate=is_.link_rate, sizes=self.board.wire_bytes, event_bytes=is_.event_bytes,
            places=is_.fifo_runs, latency=int(LATENCY * ticks), ahead=self._lookahead(is_), turn=int(SLICE * ticks),
            run_ticks=is_.run_ticks, step_ticks=is_.step_ticks,
        )  # fmt: skip
        return link_plan(replace(section, runs=tuple(as_sent(runs, words) for runs in section.runs)), link)

    def _starved(self, is_: Capabilities) -> Iterator[Finding]:
        """Sections that the link of a board is too slow for, or that it has too few places for."""
        for section in self.job.stream.sections if is_.link_rate else ():
            found = self._link_plan(is_, section).shortage
            if found is not None:
                carries = f"the link carries {is_.link_rate} bytes a second"
                what = shortage_text(found, is_.tick_frequency, section.number, carries)
                yield codes.LINK_STARVED.at(Span(self.job.name, 0), what=f"board {is_.name}: {what}")

    def _note(self, before: Status, run: SectionRun, planned: list[Retiming]) -> None:
        """Write down how a section went, from the board's first and last answers."""
        self._take_events()
        executed: tuple[Executed, ...] = ()
        with contextlib.suppress(BoardError):
            executed = self.board.executed()
        fields = section_fields(before, run, planned, self._events, executed, tuple(self._losses))
        self._write("ended", fields, sync=True)

    def _lost(self, before: Status, run: SectionRun, lost: Status, found: Status | None) -> None:
        """The board is not heard any more, or was found again."""
        loss = loss_of(before, lost, run.base, lost.reason, found)
        if found is not None:
            self._losses.pop()
        self._losses.append(loss)
        self._write("lost" if found is None else "found", plain(loss), sync=True)

    def _mark(self, before: Status, run: SectionRun, given: tuple[int, ...], *, begun: bool = True) -> None:
        """How much of the section the board has made, and, before anything is sent, how much it has then been given."""
        seen = run.seen or before
        self._marked = given, (seen.steps, seen.accepted)
        if self.journal is None:
            return
        fields = {
            "place": self._started,
            "begun": begun,
            "tick": 0 if run.seen is None else max(0, seen.tick - run.base),
            "steps": list(since(before.steps, seen.steps)),
            "accepted": list(since(before.accepted, seen.accepted)),
            "given": list(given),
        }
        try:
            self.journal.mark(fields)
        except OSError as error:
            self.control.end_at_rest(f"the journal cannot be written ({error.strerror or error})")

    def _take_events(self) -> None:
        """What the board carried out since it was last asked."""
        with contextlib.suppress(BoardError):
            self._events += self.board.take_events()

    def _passed(self, now: int, before: Status, run: SectionRun) -> None:
        """The board's clock shows tick ``now`` of the section: note it at intervals, and tell the progress."""
        seen = run.seen
        every = int(NOTED * self.job.stream.tick_frequency)
        if seen is not None and now >= self._noted + every:
            self._noted = now
            self._take_events()
            new = [e for e in self._events[self._events_noted :] if e.tick <= seen.tick]
            self._events_noted += len(new)
            self._write("at", at_fields(now, before, seen, new, run.base))
        if seen is not None and (seen.steps, seen.accepted) != self._marked[1]:
            self._mark(before, run, self._marked[0])
        self._show(now)
        if self.on_moment is not None and time.monotonic() >= self._told + EVERY:
            self._tell(now, before, run)

    def _tell(self, now: int, before: Status, run: SectionRun) -> None:
        """Tell who watches where the run is; one that has gone is not told any more, and the machine goes on."""
        if self.on_moment is None or self.watch is None:
            return
        seen = run.seen or before
        made = sum(since(before.steps, seen.steps))
        part = min(1.0, (self.done_ticks + max(0, now)) / self._all_ticks)
        self._told = time.monotonic()
        try:
            self.on_moment(self.watch.moment(run.ended.section, now, part, made, seen.position))
        except KeyboardInterrupt:
            self.control.interrupt()
        except OSError:
            self.on_moment = None

    def _show(self, now: int) -> None:
        """Tell the progress, at most a thousand times."""
        part = min(1.0, (self.done_ticks + max(0, now)) / self._all_ticks)
        if self.on_progress is not None and part >= self._shown + 0.001:
            self._shown = part
            try:
                self.on_progress(part)
            except KeyboardInterrupt:
                self.control.interrupt()
            except OSError:
                # Whoever watched has gone; the machine goes on.
                self.on_progress = None

    # Between sections.

    def _follow(self, number: int) -> int:
        """What comes after a section: the next one's number, or -1 with the result noted."""
        edges = self.job.trace.sections[number].edges
        if not edges or any(edge.wait is Wait.END for edge in edges):
            self._answer(edges[0] if edges else None)
            self.result = Result.COMPLETED
            return -1
        if self.control.stop_asked:
            self.result, self.reason = Result.STOPPED, f"section {number}: stopped by a signal, at rest"
            return -1
        if self.control.hold_asked and not self._go_on(number):
            return -1
        request = request_at_end(self.job.trace, self.job.trace.sections[number])
        answer = self.control.ask(lambda: self.operator.wait(request))
        edge = next((edge for edge in edges if edge.outcome == answer), None)
        self._answer(edge if edge is not None else replace(edges[0], outcome="", target=-1))
        self.result = Result.STOPPED
        if edge is None:
            self.reason = f"section {number}: ended while waiting ({edges[0].wait.value})"
        elif edge.target < 0:
            self.reason = f"section {number}: {edge.outcome}"
        else:
            return self._reached(edge.target)
        return -1

    def _reached(self, target: int) -> int:
        """The next section, when it starts where the motors are."""
        here, there = self.trail.sections[-1].position, self.job.stream.sections[target].start
        if here == there:
            return target
        self.result = Result.REFUSED
        self.reason = f"section {target} starts at {list(there)}, but the motors are at {list(here)}"
        return -1

    def _go_on(self, number: int) -> bool:
        """A feed hold that was requested so late that the section has ended: it holds here."""
        request = HoldRequest(section=number, tick=self.trail.sections[-1].ticks)
        resume = bool(self.control.ask(lambda: self.operator.held(request)))
        self.control.answered()
        if not resume:
            why = self.control.ending or "ended in a feed hold"
            self.result, self.reason = Result.STOPPED, f"section {number}: {why}"
        return resume

    def _answer(self, edge: Edge | None) -> None:
        if edge is not None:
            self._write("answer", {"wait": edge.wait.value, "answer": edge.outcome, "target": edge.target})
