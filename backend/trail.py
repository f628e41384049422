"""The trail of a run: entries that say what was started, acknowledged and answered, and the record that they give.

The runtime makes the entries and ``journal.py`` keeps them on the disk; from either the same ``ExecutionRecord`` is
made, here and in no other place. A trail without its end gives a record that claims what was acknowledged, and no more.
``docs/execution-record.md`` lists the entries.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from gproof.backend.boards.board import Known, Observed
from gproof.backend.record_data import BoardRecord, ExecutionRecord, Result, SectionRecord
from gproof.backend.record_parse import (
    board_of,
    hex_of,
    int_of,
    ints_of,
    loss_of,
    observed_of,
    retiming_of,
    section_of,
    text_of,
)
from gproof.ir.trace import Wait

Entry = tuple[str, dict[str, Any]]
"""What kind of entry, and its fields as plain JSON values."""


class Trail:
    """Entries in their order. ``add`` takes one; the record can be requested at any moment. started: sections that
    were started, as the mark of a journal counts them."""

    def __init__(self) -> None:
        self.ended = False
        self.damaged = False
        self._begun: dict[str, Any] | None = None
        self._board: BoardRecord | None = None
        self._sections: list[SectionRecord] = []
        self._open: SectionRecord | None = None
        self.started = 0
        self._why, self._known = "", True
        self._result = Result.INTERRUPTED
        self._reason = ""
        self._observed = Observed()

    @property
    def begun(self) -> bool:
        """True when the run was started: its record can be made."""
        return self._begun is not None

    @property
    def at_rest(self) -> bool:
        """True when no section is open and the board said where its motors are: nothing has moved since."""
        return self._open is None and self._known and (self._over or not self.damaged)

    @property
    def _over(self) -> bool:
        """True when the program's end was reached: no section can follow."""
        return self.ended or bool(self._sections and self._sections[-1].wait == Wait.END.value)

    @property
    def open_section(self) -> SectionRecord | None:
        """The section that was started and has not ended."""
        return self._open

    @property
    def sections(self) -> list[SectionRecord]:
        """Sections that were executed, the one that is open not among them."""
        return self._sections

    def add(self, kind: str, fields: dict[str, Any]) -> None:
        """Take the next entry; ValueError when it is none, or none that can follow."""
        try:
            self._add(kind, fields)
        except (LookupError, TypeError, AttributeError, ArithmeticError) as error:
            raise ValueError(f"entry {kind!r} is not of its form: {error}") from None

    def _add(self, kind: str, fields: dict[str, Any]) -> None:
        if (self._begun is None) != (kind == "begin") or (kind == "section" and self._open is not None):
            raise ValueError(f"entry {kind!r} cannot follow here")
        if kind == "begin":
            self._board = board_of(fields["board"])
            self._begun = {
                "certificate": hex_of(fields["certificate"]),
                "job": text_of(fields["job"]),
                "motors": tuple(text_of(name) for name in fields["motors"]),
                "start": ints_of(fields["start"]),
                "accepted": text_of(fields["accepted"]),
            }
            if len(self._begun["start"]) != len(self._begun["motors"]):
                raise ValueError("not one position for each motor")
        elif kind == "section":
            self._open = SectionRecord(
                number=int_of(fields["number"]),
                outcome=Result.INTERRUPTED,
                ticks=0,
                retimings=tuple(retiming_of(v) for v in fields["retimings"]),
                steps=(0,) * len(self._start),
                position=self._motors(fields["start"]),
                accepted=(0,) * len(self._start),
                known=Known.BETWEEN,
            )
            self.started += 1
        elif kind == "withdrawn":
            self._open = None
            self.started -= 1
        elif kind in ("lost", "found"):
            self._heard_of_loss(fields, found=kind == "found")
        elif kind == "retimed":
            self._open = replace(self._now, retimings=tuple(retiming_of(v) for v in fields["retimings"]))
        elif kind == "at":
            events = [ints_of(v) for v in fields["events"]]
            if any(len(event) != 3 for event in events):
                raise ValueError("an event has a tick, a row and an op")
            self._open = replace(
                self._now,
                ticks=int_of(fields["tick"]),
                steps=self._motors(fields["steps"]),
                position=self._motors(fields["position"]),
                accepted=self._motors(fields["accepted"]),
                events=(*self._now.events, *((e[0], e[1], e[2]) for e in events)),
            )
        elif kind == "ended":
            done = section_of(fields["section"])
            for counts in (done.steps, done.position, done.accepted, done.most or done.steps):
                self._motors(list(counts))
            self._sections.append(done)
            self._open, self._why = None, text_of(fields["reason"])
            self._known = fields["known"] is True
        elif kind == "answer":
            self._sections[-1] = replace(
                self._sections[-1],
                wait=text_of(fields["wait"]),
                answer=text_of(fields["answer"]),
                target=int_of(fields["target"]),
            )
        elif kind == "end":
            self._result, self._reason = Result(fields["result"]), text_of(fields["reason"])
            self._observed = observed_of(fields["observed"])
            self.ended = True
        else:
            raise ValueError(f"an entry of kind {kind!r} is not known")

    def _heard_of_loss(self, fields: dict[str, Any], *, found: bool) -> None:
        loss = loss_of({name: value for name, value in fields.items() if name != "time"})
        before = self._now.losses
        if loss.found is not found or (found and not (before and not before[-1].found)):
            raise ValueError("a board is lost before it is found")
        for counts in (loss.steps, loss.most or loss.steps):
            self._motors(list(counts))
        most = self._now.most if found else loss.most
        self._open = replace(self._now, losses=(*(before[:-1] if found else before), loss), most=most)

    @property
    def _start(self) -> tuple[int, ...]:
        assert self._begun is not None
        start: tuple[int, ...] = self._begun["start"]
        return start

    @property
    def _now(self) -> SectionRecord:
        if self._open is None:
            raise ValueError("no section is open")
        return self._open

    def _motors(self, value: list[Any]) -> tuple[int, ...]:
        """One whole number for each motor; ValueError."""
        counts = ints_of(value)
        if len(counts) != len(self._start):
            raise ValueError("not one count for each motor")
        return counts

    def record(self) -> ExecutionRecord:
        """The record; ValueError when the run was not even started."""
        if self._begun is None or self._board is None:
            raise ValueError("the run was not started")
        sections = (*self._sections, *(() if self._open is None else (self._open,)))
        result, reason = self._ending()
        last = sections[-1].position if sections else self._start
        return ExecutionRecord(
            **self._begun,
            board=self._board,
            sections=sections,
            steps=tuple(sum(s.steps[m] for s in sections) for m in range(len(self._start))),
            position=last if self.at_rest else None,
            observed=self._observed,
            result=result,
            reason=reason,
        )

    def _ending(self) -> tuple[Result, str]:
        """The result and its reason: those of the entry ``end``, else what the entries before it make certain."""
        if self.ended:
            return self._result, self._reason
        why = "gproof was killed, the computer lost power or its disk was full"
        if self.damaged and not self._over:
            return Result.INTERRUPTED, f"{why}; the journal is damaged: the position is not known"
        if self._open is not None:
            where = f"section {self._open.number}; the board acknowledged it up to tick {self._open.ticks}"
            return Result.INTERRUPTED, f"{why} in {where}: the position is not known"
        if not self._sections:
            return Result.INTERRUPTED, f"{why}, before anything moved"
        last = self._sections[-1]
        if last.outcome is not Result.COMPLETED:
            return last.outcome, self._why
        if last.wait == Wait.END.value:
            return Result.COMPLETED, ""
        return Result.INTERRUPTED, f"{why}, at rest after section {last.number}"
