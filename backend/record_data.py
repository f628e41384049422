"""The execution record: what the board acknowledged, as canonical JSON, chained onto the certificate.

Whole numbers and text only, no clock times, no host names: the same run of the same job on the virtual board
gives the same bytes. ``docs/execution-record.md`` defines each field; ``record_check`` compares a record with
the package that was run.
"""

from __future__ import annotations

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

from gproof.backend.boards.board import Observed
from gproof.backend.time_map import TimeMap
from gproof.ir import codes
from gproof.ir.finding import Finding, Span
from gproof.ir.record import record

SCHEMA = "gproof-record/1"


class Result(enum.Enum):
    """How a run ended.

    COMPLETED: the program's end. STOPPED: at rest, because the operator or a wait ended it there.
    EMERGENCY_STOP, UNDERRUN, FAULT (the board or the line to it): in the middle of things. REFUSED: at rest,
    because a retimed section did not pass the validator or does not begin where the last one ended.
    """

    COMPLETED = "completed"
    STOPPED = "stopped"
    EMERGENCY_STOP = "emergency-stop"
    UNDERRUN = "underrun"
    FAULT = "fault"
    REFUSED = "refused"


@record(frozen=True, slots=True, kw_only=True)
class Retiming:
    """One retiming of a section, applied to what the ones before it made.

    kind: "override" or "hold"; factor: of the planned speed, as a fraction such as "7/10" (override);
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
class SectionRecord:
    """One section as executed.

    ticks: how far its time ran (its duration when completed); steps: pulses acknowledged, by motor;
    position: in steps at its end, by motor; accepted: runs the board took, by motor; events: (tick, row, op)
    carried out; wait, answer, target: what ended it, what was answered ("": nothing), and where that leads.
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


@record(frozen=True, slots=True, kw_only=True)
class BoardRecord:
    """The board that ran the job; what ``Capabilities`` says of it."""

    name: str
    motors: int
    tick_frequency: int
    fifo_runs: int
    step_pulse: int
    direction_setup: int
    real_time: bool


@record(frozen=True, slots=True, kw_only=True)
class ExecutionRecord:
    """A whole run; see the module's text.

    certificate: SHA-256 of the certificate's body; motors: their names; start: positions in steps before the
    first section; sections in the order of execution; steps: totals by motor; position: where the motors
    ended; observed: what the board measured at its outputs; reason: a sentence when not completed.
    """

    certificate: str
    job: str
    board: BoardRecord
    motors: tuple[str, ...]
    start: tuple[int, ...]
    sections: tuple[SectionRecord, ...]
    steps: tuple[int, ...]
    position: tuple[int, ...]
    observed: Observed
    result: Result
    reason: str = ""

    @property
    def sha256(self) -> str:
        """The hash that chains this record onto its certificate: SHA-256 of the certificate's hash and the body."""
        return _chain(self.certificate, canonical(self._body()))

    def _body(self) -> dict[str, Any]:
        return {"schema": SCHEMA, **_plain(self)}

    def to_json(self) -> bytes:
        """Canonical JSON with the hash, ending in a newline."""
        return canonical({**self._body(), "sha256": self.sha256}) + b"\n"

    def write(self, path: Path) -> None:
        """To a temporary name beside ``path``, then renamed."""
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(self.to_json())
            os.chmod(name, 0o644)
            os.replace(name, path)
        except BaseException:
            Path(name).unlink(missing_ok=True)
            raise

    def findings(self) -> list[Finding]:
        """What the user must hear of the run: underrun, emergency stop, feed holds, what the board saw."""
        place = Span(self.job, 0)
        found = []
        for section in self.sections:
            for change in section.retimings:
                if change.kind == "hold" and change.asked <= section.ticks:
                    what = (
                        f"section {section.number}: feed hold asked at tick {change.asked}, "
                        f"at rest from {change.rest_begins} for {change.rest} ticks"
                    )
                    found.append(codes.FEED_HOLD.at(place, what=what))
        if self.result is Result.UNDERRUN:
            found.append(codes.FIFO_UNDERRUN.at(place, what=self.reason))
        elif self.result is Result.EMERGENCY_STOP:
            found.append(codes.EMERGENCY_STOP.at(place, what=self.reason))
        for motor, name in enumerate(self.motors):
            early = [counts[motor] for counts in (self.observed.overlaps, self.observed.setups) if counts]
            if any(early):
                what = f"the board saw pulses or direction changes of motor {name} come too early"
                found.append(codes.STREAM_PULSE.at(place, what=what))
        return found


def canonical(value: Any) -> bytes:
    """JSON with sorted keys, no blanks, ASCII only."""
    text = json.dumps(value, sort_keys=True, separators=(",", ":"), ensure_ascii=True, allow_nan=False)
    return text.encode("ascii")


def _chain(certificate: str, body: bytes) -> str:
    return hashlib.sha256(bytes.fromhex(certificate) + body).hexdigest()


def _plain(value: Any) -> Any:
    """Dataclasses as objects, tuples as lists, results as their text."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {f.name: _plain(getattr(value, f.name)) for f in dataclasses.fields(value)}
    if isinstance(value, tuple | list):
        return [_plain(v) for v in value]
    if isinstance(value, Result):
        return value.value
    return value
