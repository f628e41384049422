"""What was executed of a run, from its journal, its mark, its package and the board, and what to do next.

Nothing is changed: no journal is held, no record is made, nothing is sent to a board but questions.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from gproof.backend.boards.board import Known
from gproof.backend.job import CertifiedJob, identity_of, job_from
from gproof.backend.journal import ENDED, Found, is_held, read_journal
from gproof.backend.program_place import Place, place_of
from gproof.backend.record_data import ExecutionRecord, Loss, Result, SectionRecord
from gproof.backend.record_proof import sent
from gproof.backend.run_bounds import Bounds, Told, bounds_of, merged, of_this_run
from gproof.ir.record import record
from gproof.ir.stream import StreamSection
from gproof.verify.certificate.package import CertificateError, read_package

Ask = Callable[[int, bytes], Told | None]
"""Asks a board for so many motors of a stream; BoardError."""

RUNNING, OVER, INTERRUPTED, DAMAGED, NOTHING = "running", "ended", "interrupted", "damaged", "not-started"
"""States of a run: a living process has it; it ended; it did not; its journal is damaged; it was never begun."""


@record(frozen=True, slots=True, kw_only=True)
class RunStatus:
    """One run.

    state: RUNNING …; damaged: number of the journal's line that does not fit (0: none); record: what the journal alone
    gives (None: nothing was begun); bounds: of the last section, where it did not end; position: in steps, by motor,
    None: not known; place: where in the program it is; board: what was learned from the board, "" where it was not
    asked; lost: of the line to the board; notes: what cannot be known, and why; hints: what to do next.
    """

    journal: Path
    state: str
    started: str
    damaged: int
    record: ExecutionRecord | None
    bounds: Bounds | None = None
    position: tuple[int, ...] | None = None
    place: Place | None = None
    board: str = ""
    notes: tuple[str, ...] = ()
    hints: tuple[str, ...] = ()

    @property
    def least(self) -> tuple[int, ...]:
        """Steps made at least in the whole run, by motor."""
        assert self.record is not None
        if self.bounds is None:
            return self.record.steps
        done = self.record.sections[:-1]
        return tuple(sum(s.steps[m] for s in done) + b for m, b in enumerate(self.bounds.least))

    @property
    def most(self) -> tuple[int, ...] | None:
        """Steps made at most in the whole run, by motor; None where no number is known."""
        if self.record is None or self.state == DAMAGED:
            return None
        if self.bounds is not None:
            if self.bounds.most is None or self.bounds.contradiction:
                return None
            extra = zip(self.least, self.bounds.least, self.bounds.most, strict=True)
            return tuple(all_ - least + most for all_, least, most in extra)
        last = self.record.sections[-1] if self.record.sections else None
        if last is not None and last.known is Known.UNKNOWN:
            return None
        if last is None or not last.most:
            exact = last is None or last.known is Known.EXACT
            return self.record.steps if exact else None
        return tuple(
            total - made + most for total, made, most in zip(self.record.steps, last.steps, last.most, strict=True)
        )

    @property
    def exact(self) -> bool:
        """True where what was executed is known to the step."""
        if self.record is None:
            return self.state == NOTHING
        return self.least == self.most

    @property
    def contradiction(self) -> str:
        """Why what was read does not fit together; "" where it does."""
        if self.state == DAMAGED:
            return f"line {self.damaged} of the journal does not fit" if self.damaged else "the journal is damaged"
        return self.bounds.contradiction if self.bounds is not None else ""

    def losses(self) -> list[tuple[int, Loss]]:
        """Losses of the line to the board, with their sections."""
        sections = self.record.sections if self.record is not None else ()
        return [(section.number, loss) for section in sections for loss in section.losses]


def journals_in(folder: Path, certificate: str = "") -> list[Path]:
    """Journals that are worth a word: all that are open or damaged, and the newest that ended; the oldest first.

    certificate: only of that package. OSError.
    """
    if not folder.is_dir():
        return []
    found = sorted(path for path in folder.iterdir() if path.suffix in (".journal", ".damaged"))
    ended = sorted(folder.glob(f"*{ENDED}"), reverse=True)
    if certificate:
        found = [path for path in found if read_journal(path).field("certificate") == certificate]
    newest = next((p for p in ended if not certificate or read_journal(p).field("certificate") == certificate), None)
    return sorted([*found, *([newest] if newest is not None else [])])


def status_of(path: Path, package: Path | None, ask: Ask | None = None) -> RunStatus:
    """What was executed of the run of a journal; package: the one that was run, where it is not where it was. OSError,
    BoardError."""
    found = read_journal(path)
    trail = found.trail()
    started = found.field("time")
    if not trail.begun:
        return _not_begun(found)
    record = trail.record()
    job, why = _job(found, record, package)
    notes = [why] if why else []
    state = RUNNING if is_held(path) else OVER if trail.ended else INTERRUPTED
    if trail.damaged and not (trail.ended or trail.at_rest):
        state = DAMAGED
    bounds, place, told = None, None, ""
    position = record.position
    section = trail.open_section
    if section is not None:
        planned = None if job is None else job.stream.sections[section.number]
        whole = None if planned is None else [int(runs["count"].sum()) for runs in planned.runs]
        mark = found.given()
        bounds = bounds_of(trail, mark, whole)
        if mark is None and found.field("mark"):
            notes.append("the mark of the run is gone: all of its last section may have been sent")
        if ask is not None and state != RUNNING:
            here = mark is not None and mark.place == trail.started and mark.begun
            begun = here or any(section.accepted) or any(section.steps)
            bounds, told = _asked(ask, bounds, section, planned, (job, record), begun=begun)
        if state != DAMAGED and planned is not None:
            position = _position(planned, bounds)
    elif ask is not None:
        told = "not asked: no section of the run was open"
    if job is not None and record.sections:
        last = record.sections[-1]
        least = bounds.least if bounds is not None else last.steps
        most = bounds.most if bounds is not None else (last.most or last.steps)
        if not (bounds is not None and bounds.contradiction) and last.known is not Known.UNKNOWN:
            motors = job.stream.motors
            planned = job.stream.sections[last.number]
            place = place_of(planned, job.trace, job.machine, motors, least=least, most=most)
    status = RunStatus(
        journal=path, state=state, started=started, damaged=found.damaged, record=record, bounds=bounds,
        position=position, place=place, board=told, notes=tuple(notes),
    )  # fmt: skip
    return _with_hints(status, asked=ask is not None)


def _not_begun(found: Found) -> RunStatus:
    state, hint = NOTHING, "nothing was moved: run the job again"
    if found.damaged:
        state, hint = DAMAGED, "the journal cannot be read: home the machine, and check tool and part"
    elif is_held(found.path):
        state, hint = RUNNING, "the run is about to start"
    return RunStatus(
        journal=found.path, state=state, started="", damaged=found.damaged, record=None, hints=(hint,),
        notes=() if state != DAMAGED else ("what was executed and where the axes are is not known",),
    )  # fmt: skip


def _job(found: Found, record: ExecutionRecord, package: Path | None) -> tuple[CertifiedJob | None, str]:
    """The job that was run, or why it is not at hand."""
    path = package or Path(found.field("package"))
    if not found.field("package") and package is None:
        return None, "the journal names no package: bounds and program lines are missing"
    try:
        there = read_package(path)
        if there.sha256 != record.certificate:
            return None, f"{path} is not the package that was run: bounds and program lines are missing"
        return job_from(there, record.start), ""
    except (CertificateError, OSError, ValueError):
        return None, f"the package {path} cannot be read: bounds and program lines are missing (--package)"


def _asked(
    ask: Ask, bounds: Bounds, section: SectionRecord, planned: StreamSection | None,
    of: tuple[CertifiedJob | None, ExecutionRecord], *, begun: bool,
) -> tuple[Bounds, str]:  # fmt: skip
    """Bounds with what the board says, and that in words."""
    job, record = of
    identity = identity_of(record.certificate)
    told = ask(len(record.motors), identity)
    if told is None:
        return bounds, "its firmware does not count what it executes"
    why = of_this_run(told, identity, section.number, len(record.motors))
    if why:
        return bounds, why
    as_sent = None
    if planned is not None and job is not None:
        try:
            as_sent = sent(section, planned, job)
        except ValueError:
            as_sent = None
    found = merged(bounds, told, section, as_sent, record, begun=begun)
    if found.contradiction:
        return found, found.contradiction
    if told.moving and not found.exact:
        return found, "it is still in the section: ask again when it has stopped"
    if not begun:
        return found, "it may mean an earlier run of the same section: this one acknowledged nothing"
    proof = "and their CRC-32 is that of the stream" if found.proved else "the CRC-32 was not compared with the stream"
    if as_sent is not None and not found.proved and record.board.counting is not None:
        proof = "but their CRC-32 is not that of the stream as the journal knows it: they are not believed"
    counts = ", ".join(str(one.steps) for one in told.executed)
    return found, f"it counts {counts} steps, {proof}"


def _position(planned: StreamSection, bounds: Bounds) -> tuple[int, ...] | None:
    """Where the motors are after exactly known steps."""
    if not bounds.exact:
        return None
    found = []
    for start, runs, steps in zip(planned.start, planned.runs, bounds.least, strict=True):
        net, left = int(start), steps
        for count, direction in zip(runs["count"].tolist(), runs["direction"].tolist(), strict=True):
            made = min(left, count)
            net += made * direction
            left -= made
            if not left:
                break
        found.append(net)
    return tuple(found)


def _with_hints(status: RunStatus, *, asked: bool) -> RunStatus:
    """What to do next."""
    from dataclasses import replace

    record = status.record
    assert record is not None
    hints: list[str] = []
    if status.state == RUNNING:
        hints.append("the run goes on: this is what it has said so far")
    elif record.result is Result.COMPLETED:
        hints.append("nothing is left to do: the program's end was reached")
    else:
        if status.state == DAMAGED:
            hints.append("what follows the damage may have been further motion: home the machine, check tool and part")
        elif status.bounds is not None and not status.exact and not asked and record.board.counting is not None:
            hints.append("the board counts what it executes: do not switch it off, and ask it with --port")
        if status.position is None:
            hints.append("home the machine: where the axes are is not known")
        elif status.bounds is not None:
            hints.append("home the machine: motors that are stopped at speed may slip, which no count shows")
        if status.state == INTERRUPTED:
            hints.append("then run with --after-interruption; the next run writes the record of this one")
    return replace(status, hints=tuple(hints))
