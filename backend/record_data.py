"""The execution record: what the board acknowledged, as canonical JSON, chained onto the certificate.

Whole numbers and text only, no clock times, no host names: the same run of the same job on the virtual board
gives the same bytes. ``docs/execution-record.md`` defines each field; ``record.py`` compares a record with the
package that was run, ``record_signature.py`` signs one.
"""

from __future__ import annotations

import contextlib
import dataclasses
import enum
import hashlib
import json
import os
import tempfile
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from gproof.backend.boards.board import Capabilities, Counting, Executed, Known, Observed
from gproof.backend.time_map import TimeMap
from gproof.ir import codes
from gproof.ir.finding import Finding, Span
from gproof.ir.record import record

SCHEMA = "gproof-record/3"
SECOND_SCHEMA = "gproof-record/2"
FIRST_SCHEMA = "gproof-record/1"
"""Still read. Both say nothing of what a board counts, of losses and of bounds; the first has no ``accepted`` and no
``unproved``, and its position was always taken to be known."""

SCHEMAS = (FIRST_SCHEMA, SECOND_SCHEMA, SCHEMA)

NEW_OF_BOARD = ("counting", "firmware", "identity", "longest", "longest_rest", "most_add", "watched")
NEW_OF_SECTION = ("executed", "known", "losses", "most")
"""Fields that came with ``SCHEMA``."""

EARLIER_UNPROVED = (
    "board",
    "observed",
    "reason",
    "sections.accepted",
    "sections.answer",
    "sections.events",
    "sections.outcome",
    "sections.position",
    "sections.steps",
    "sections.ticks",
)
UNPROVED = tuple(sorted((*EARLIER_UNPROVED, "sections.executed", "sections.known", "sections.losses", "sections.most")))
"""Fields that rest on what the board, or who was asked, said: comparing with the package shows that they can be so."""

TRUSTED, ANY_SIGNER, ALLOWED = "trusted-key", "any-signer", "allow-untrusted"
"""Why the package might run: signed by a trusted key; no key was required; untrusted, and allowed to run."""


class Result(enum.Enum):
    """How a run ended.

    COMPLETED: the program's end. STOPPED: at rest, because the operator or a wait ended it there.
    EMERGENCY_STOP, UNDERRUN, FAULT (the board or the line to it): in the middle of things. REFUSED: at rest,
    because a retimed section did not pass the validator or does not start where the last one ended.
    INTERRUPTED: gproof was killed or lost its computer; the record was made from the journal afterwards.
    """

    COMPLETED = "completed"
    STOPPED = "stopped"
    EMERGENCY_STOP = "emergency-stop"
    UNDERRUN = "underrun"
    FAULT = "fault"
    REFUSED = "refused"
    INTERRUPTED = "interrupted"


@record(frozen=True, slots=True, kw_only=True)
class Retiming:
    """One retiming of a section, applied to what the ones before it made.

    kind: "override", "change" (of the override, in the middle) or "hold"; factor: of the planned speed, as a fraction
    such as "7/10" (override, change);
    asked: tick of the request; rest_begins, rest: ticks (hold); exact: steps on their mapped ticks, no room
    for longer runs; source, target: the breakpoints of the time map.
    """

    kind: str
    factor: str = "1"
    asked: int = 0
    rest_begins: int = 0
    rest: int = 0
    exact: bool = False
    source: tuple[int, ...]
    target: tuple[int, ...]

    def factor_value(self) -> Fraction:
        """The factor as a number; ValueError."""
        try:
            return Fraction(self.factor)
        except ArithmeticError:
            raise ValueError(f"override {self.factor!r}") from None

    def times(self) -> TimeMap:
        """The map, verified; ValueError."""
        found = TimeMap(np.array(self.source, dtype=np.int64), np.array(self.target, dtype=np.int64))
        found.verify()
        return found


@record(frozen=True, slots=True, kw_only=True)
class Loss:
    """A board that was not heard any more.

    tick: of the section, when it was heard last; steps: certainly made by then, by motor; most: all that it can have
    made (empty: not known); reason: what was lost; found: whether it was reached again; known: how well it then said
    where its motors are.
    """

    tick: int
    reason: str
    steps: tuple[int, ...]
    most: tuple[int, ...] = ()
    found: bool = False
    known: Known = Known.BETWEEN


@record(frozen=True, slots=True, kw_only=True)
class SectionRecord:
    """One section as executed.

    ticks: how far its time ran (its duration when completed); steps: pulses acknowledged, by motor;
    position: in steps at its end, by motor; accepted: runs the board took, by motor; events: (tick, row, op)
    carried out; wait, answer, target: what ended it, what was answered ("": nothing), and where that leads.
    Of an interrupted section steps, position, ticks, accepted and events are what was acknowledged last: it
    had come at least so far. known: how well the board knew its position; most: steps that it made at most, by motor
    (empty: ``steps`` where it is known exactly, else not known); executed: what it counted itself, by motor (empty: it
    does not count, or was not asked); losses: of the line to it.
    """

    number: int
    outcome: Result
    ticks: int
    retimings: tuple[Retiming, ...] = ()
    steps: tuple[int, ...]
    position: tuple[int, ...]
    accepted: tuple[int, ...]
    events: tuple[tuple[int, int, int], ...] = ()
    wait: str = ""
    answer: str = ""
    target: int = -1
    known: Known = Known.EXACT
    most: tuple[int, ...] = ()
    executed: tuple[Executed, ...] = ()
    losses: tuple[Loss, ...] = ()


@record(frozen=True, slots=True, kw_only=True)
class BoardRecord:
    """The board that ran the job; what ``Capabilities`` says of it. longest: its ``max_interval``; longest_rest: its
    ``max_rest``; most_add: its ``max_add``."""

    name: str
    motors: int
    tick_frequency: int
    fifo_runs: int
    step_pulse: int
    direction_setup: int
    real_time: bool
    identity: str = ""
    firmware: str = ""
    watched: bool = True
    most_add: int = 2**61
    longest: int = 2**61
    longest_rest: int = 0
    counting: Counting | None = None

    @classmethod
    def of(cls, is_: Capabilities) -> BoardRecord:
        """Of a board that was opened."""
        return cls(
            name=is_.name, motors=is_.motors, tick_frequency=is_.tick_frequency, fifo_runs=is_.fifo_runs,
            step_pulse=is_.step_pulse, direction_setup=is_.direction_setup, real_time=is_.real_time,
            identity=is_.identity, firmware=is_.firmware, watched=is_.watched, most_add=is_.max_add,
            longest=is_.max_interval, longest_rest=is_.max_rest, counting=is_.counting,
        )  # fmt: skip


@record(frozen=True, slots=True, kw_only=True)
class ExecutionRecord:
    """A whole run; see the module's text.

    certificate: SHA-256 of the certificate's body; motors: their names; start: positions in steps before the
    first section; sections in the order of execution; steps: totals by motor; position: where the motors
    ended (None: not known); observed: what the board measured at its outputs; reason: a sentence when not
    completed; accepted: why the package might run (``TRUSTED`` …); schema: in which it is written.
    """

    certificate: str
    job: str
    board: BoardRecord
    motors: tuple[str, ...]
    start: tuple[int, ...]
    sections: tuple[SectionRecord, ...]
    steps: tuple[int, ...]
    position: tuple[int, ...] | None
    observed: Observed
    result: Result
    reason: str = ""
    accepted: str = ANY_SIGNER
    schema: str = SCHEMA

    @property
    def last_position(self) -> tuple[int, ...]:
        """The positions in steps that were acknowledged last, by motor."""
        return self.sections[-1].position if self.sections else self.start

    @property
    def sha256(self) -> str:
        """The hash that chains this record onto its certificate: SHA-256 of the certificate's hash and the body."""
        return _chain(self.certificate, canonical(self.body()))

    def body(self) -> dict[str, Any]:
        """Everything that the hash covers, as plain JSON values."""
        body = plain(self)
        if self.schema != SCHEMA:
            for name in NEW_OF_BOARD:
                del body["board"][name]
            for section in body["sections"]:
                for name in NEW_OF_SECTION:
                    del section[name]
        if self.schema == FIRST_SCHEMA:
            del body["accepted"]
        else:
            body["unproved"] = list(UNPROVED if self.schema == SCHEMA else EARLIER_UNPROVED)
        return dict(body)

    def to_json(self, signature: dict[str, str] | None = None) -> bytes:
        """Canonical JSON with the hash, and the signature if there is one, ending in a newline."""
        signed = {} if signature is None else {"signature": signature}
        return canonical({**self.body(), "sha256": self.sha256, **signed}) + b"\n"

    def write(self, path: Path, signature: dict[str, str] | None = None) -> None:
        """To a temporary name next to ``path``, on the disk, then renamed; OSError, and nothing written."""
        write_whole(path, self.to_json(signature))

    def _time(self, tick: int) -> str:
        """A tick of a section, with its seconds."""
        return f"tick {tick} ({tick / self.board.tick_frequency:.3f} s)"

    def findings(self) -> list[Finding]:
        """What the user must hear of the run: underrun, emergency stop, feed holds, what the board saw."""
        place = Span(self.job, 0)
        found = []
        for section in self.sections:
            for change in section.retimings:
                if change.kind == "hold" and change.asked <= section.ticks:
                    what = (
                        f"section {section.number}: requested at {self._time(change.asked)}, at rest from "
                        f"{self._time(change.rest_begins)} for {change.rest} ticks"
                    )
                    found.append(codes.FEED_HOLD.at(place, what=what))
        if self.result is Result.INTERRUPTED:
            found.append(codes.RUN_INTERRUPTED.at(place, what=self.reason))
        elif self.result is Result.UNDERRUN:
            found.append(codes.FIFO_UNDERRUN.at(place, what=self.reason))
        elif self.result is Result.EMERGENCY_STOP:
            found.append(codes.EMERGENCY_STOP.at(place, what=self.reason.removesuffix(": emergency stop")))
        for motor, name in enumerate(self.motors):
            early = [counts[motor] for counts in (self.observed.overlaps, self.observed.setups) if counts]
            if any(early):
                what = f"pulses or direction changes of motor {name} came too early at the board"
                found.append(codes.STREAM_PULSE.at(place, what=what))
        return found


def write_whole(path: Path, data: bytes) -> None:
    """Bytes to a temporary name next to ``path``, on the disk, then renamed; OSError, and nothing left over."""
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.chmod(name, 0o644)
        os.replace(name, path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise
    sync_folder(path.parent)


def sync_folder(folder: Path) -> None:
    """The names in a folder, on the disk; nothing where the file system cannot do that."""
    with contextlib.suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def canonical(value: Any) -> bytes:
    """JSON with sorted keys, no blanks, ASCII only."""
    text = json.dumps(value, sort_keys=True, separators=(",", ":"), ensure_ascii=True, allow_nan=False)
    return text.encode("ascii")


def _chain(certificate: str, body: bytes) -> str:
    return hashlib.sha256(bytes.fromhex(certificate) + body).hexdigest()


def plain(value: Any) -> Any:
    """Dataclasses as objects, tuples as lists, results as their text."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {f.name: plain(getattr(value, f.name)) for f in dataclasses.fields(value)}
    if isinstance(value, tuple | list):
        return [plain(v) for v in value]
    if isinstance(value, Result | Known):
        return value.value
    return value
