"""How far ``gproof run`` is: a line on a terminal, or JSON lines for a program, both on standard error.

Standard output has the report of the run and the questions. docs/boards.md defines the JSON lines.
"""

from __future__ import annotations

import json
import select
import shutil
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Protocol

from gproof.driver.escape import in_one_line

if TYPE_CHECKING:
    from gproof.backend.operators import HoldRequest, Operator, WaitRequest
    from gproof.backend.record_data import ExecutionRecord
    from gproof.backend.watch import Moment

AUTO, JSONL, OFF = "auto", "jsonl", "off"
CHOICES = (AUTO, JSONL, OFF)
SCHEMA = "gproof-progress/1"

PATIENCE = 1.0
"""Seconds that a reader has to take a line, while nothing moves."""

COLUMNS = 80
"""Of a terminal that does not say how many it has."""


def may_write(patience: float = 0.0) -> bool:
    """Whether standard error takes a line now: a reader that stands still must not keep the board from its steps."""
    try:
        return bool(select.select([], [sys.stderr.fileno()], [], patience)[1])
    except (OSError, ValueError, AttributeError):
        return True


class Shown(Protocol):
    """What a run is shown with."""

    def start(self, job: str, board: str, motors: Sequence[str]) -> None:
        """It is about to open the board."""

    def moment(self, moment: Moment) -> None:
        """Where it is; OSError when nobody watches any more."""

    def asks(self, request: WaitRequest | HoldRequest) -> None:
        """It rests and asks."""

    def end(self, done: ExecutionRecord | None) -> None:
        """It is over; None: nothing was moved."""


class Line:
    """One line of a terminal, written over again and again."""

    def __init__(self) -> None:
        self._there = ""
        self._motors: Sequence[str] = ()

    def start(self, job: str, board: str, motors: Sequence[str]) -> None:
        """See Shown."""
        self._motors = motors

    def moment(self, moment: Moment) -> None:
        """See Shown."""
        if may_write():
            self._write(line_of(moment, self._motors))

    def asks(self, request: WaitRequest | HoldRequest) -> None:
        """See Shown; the question has the line to itself."""
        self._write("")

    def end(self, done: ExecutionRecord | None) -> None:
        """See Shown."""
        with suppress(OSError):
            self._write("")

    def _write(self, text: str) -> None:
        if not text and not self._there:
            return
        columns = shutil.get_terminal_size((COLUMNS, 24)).columns
        text = in_one_line(text)[: max(1, columns - 1)]
        sys.stderr.write("\r" + text + " " * (len(self._there) - len(text)) + ("" if text else "\r"))
        sys.stderr.flush()
        self._there = text


def line_of(moment: Moment, motors: Sequence[str]) -> str:
    """``line 12  34.5 %  0:02:10 left  X 12.500  Y 3.000``."""
    places = "  ".join(f"{name} {place:.3f}" for name, place in zip(motors, moment.position, strict=True))
    where = f"line {moment.line}  " if moment.line else ""
    return f"{where}{100 * moment.part:.1f} %  {time_left(moment.left)} left  {places}"


def time_left(left: tuple[float, float]) -> str:
    """``0:02:10``, or ``0:02:10 to 0:02:40``; the upper end rounded up."""
    low, high = clock(int(left[0])), clock(-int(-left[1] // 1))
    return low if low == high or left[1] - left[0] < 1 else f"{low} to {high}"


def clock(seconds: int) -> str:
    """``1:02:03``."""
    return f"{seconds // 3600}:{seconds // 60 % 60:02}:{seconds % 60:02}"


class Lines:
    """JSON objects, one a line, on standard error."""

    def __init__(self) -> None:
        self._motors: Sequence[str] = ()

    def start(self, job: str, board: str, motors: Sequence[str]) -> None:
        """See Shown."""
        self._motors = motors
        self._write({"kind": "start", "schema": SCHEMA, "job": job, "board": board, "motors": list(motors)})

    def moment(self, moment: Moment) -> None:
        """See Shown."""
        if not may_write():
            return
        self._write({
            "kind": "at",
            "section": moment.section,
            "sections": moment.sections,
            "line": moment.line or None,
            "file": moment.file or None,
            "percent": round(100 * moment.part, 3),
            "left_s": [round(seconds, 3) for seconds in moment.left],
            "position": dict(zip(self._motors, (round(place, 6) for place in moment.position), strict=True)),
            "steps": dict(zip(self._motors, moment.steps, strict=True)),
        })  # fmt: skip

    def asks(self, request: WaitRequest | HoldRequest) -> None:
        """See Shown."""
        from gproof.backend.operators import HoldRequest

        if isinstance(request, HoldRequest):
            told: dict[str, Any] = {"kind": "hold", "section": request.section, "tick": request.tick}
        else:
            told = {
                "kind": "wait", "section": request.section, "line": request.line, "file": request.file or None,
                "wait": request.wait.value, "text": request.text, "outcomes": list(request.outcomes),
            }  # fmt: skip
        self._write_at_rest(told)

    def end(self, done: ExecutionRecord | None) -> None:
        """See Shown."""
        told: dict[str, Any] = {"kind": "end", "result": None, "reason": "nothing was moved", "record": None}
        if done is not None:
            told |= {"result": done.result.value, "reason": done.reason, "record": done.sha256}
        self._write_at_rest(told)

    def _write_at_rest(self, told: dict[str, Any]) -> None:
        with suppress(OSError):
            if may_write(PATIENCE):
                self._write(told)

    def _write(self, told: dict[str, Any]) -> None:
        sys.stderr.write(json.dumps(told, separators=(",", ":")) + "\n")
        sys.stderr.flush()


class Asking:
    """An operator before whose answers who watches is told."""

    def __init__(self, operator: Operator, told: Callable[[WaitRequest | HoldRequest], None]) -> None:
        self._operator, self._told = operator, told

    def wait(self, request: WaitRequest) -> str | None:
        """See Operator."""
        self._told(request)
        return self._operator.wait(request)

    def held(self, request: HoldRequest) -> bool:
        """See Operator."""
        self._told(request)
        return self._operator.held(request)


def shown(kind: str) -> Shown | None:
    """What a run is shown with; None for nothing."""
    if kind == JSONL and sys.stderr is not None:
        return Lines()
    return Line() if kind == AUTO and sys.stderr is not None and sys.stderr.isatty() else None
