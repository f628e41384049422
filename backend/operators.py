"""Who answers when a job waits: the ``Operator`` protocol and three ready-made answers."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Protocol

from gproof.ir.record import record
from gproof.ir.trace import Op, Trace, TraceSection, Wait


@record(frozen=True, slots=True, kw_only=True)
class WaitRequest:
    """A section has ended and waits. text: what is waited for; outcomes: the answers there are.

    file: the source file of ``line`` where it is another than the job.
    """

    wait: Wait
    section: int
    line: int
    text: str
    outcomes: tuple[str, ...]
    optional: bool = False
    file: str = ""


@record(frozen=True, slots=True, kw_only=True)
class HoldRequest:
    """The machine has come to rest in a feed hold, ``tick`` ticks after the section's start."""

    section: int
    tick: int


class Operator(Protocol):
    """Answers are given while the machine is at rest."""

    def wait(self, request: WaitRequest) -> str | None:
        """One of the outcomes, or None to end the job here."""

    def held(self, request: HoldRequest) -> bool:
        """True to go on, False to end the job here."""


class AutoContinue:
    """Nobody asks: goes on where only an operator would be waited for, ends where an answer is a guess.

    resume: whether a feed hold goes on by itself.
    """

    def __init__(self, *, resume: bool = False) -> None:
        self.resume = resume

    def wait(self, request: WaitRequest) -> str | None:
        """The only outcome of an operator's wait or a tool change."""
        if request.wait in (Wait.OPERATOR, Wait.TOOL_CHANGE) and len(request.outcomes) == 1:
            return request.outcomes[0]
        return None

    def held(self, request: HoldRequest) -> bool:
        """As said when it was made."""
        return self.resume


class RefuseAll:
    """Ends the job at its first wait."""

    def wait(self, request: WaitRequest) -> str | None:
        """Never."""
        return None

    def held(self, request: HoldRequest) -> bool:
        """Never."""
        return False


class Terminal:
    """Asks a person; ``ask`` reads a line, ``tell`` prints one."""

    def __init__(self, ask: Callable[[str], str] = input, tell: Callable[[str], None] = print) -> None:
        self.ask = ask
        self.tell = tell

    def wait(self, request: WaitRequest) -> str | None:
        """Enter takes the only outcome; several are numbered; q ends the job."""
        where = f"{request.file}, " if request.file else ""
        self.tell(f"{where}line {request.line}: {request.text}")
        if len(request.outcomes) == 1:
            answer = self._read(f"Press Enter: {request.outcomes[0]}, or q to end the job here: ")
            return None if answer is None else request.outcomes[0]
        for number, outcome in enumerate(request.outcomes, start=1):
            self.tell(f"  {number}: {outcome}")
        while True:
            answer = self._read("Enter a number, or q to end the job here: ")
            if answer is None:
                return None
            if answer.isdecimal() and 1 <= int(answer) <= len(request.outcomes):
                return request.outcomes[int(answer) - 1]

    def held(self, request: HoldRequest) -> bool:
        """Enter goes on, q ends the job."""
        return self._read("Feed hold. Press Enter to go on, or q to end the job here: ") is not None

    def _read(self, prompt: str) -> str | None:
        """A line, None for q or the end of input."""
        try:
            answer = self.ask(prompt).strip()
        except EOFError:
            return None
        return None if answer.lower() in ("q", "quit") else answer


def request_at_end(trace: Trace, section: TraceSection) -> WaitRequest:
    """What to ask at the end of a section: its last message, tool or stop row says."""
    edge = section.edges[0]
    text, optional = edge.outcome, False
    for k in range(len(section.rows) - 1, max(-1, len(section.rows) - 16), -1):
        op = section.rows["op"][k]
        if op == Op.MESSAGE:
            text = trace.texts[int(section.rows["text"][k])]
        elif op == Op.TOOL_CHANGE:
            tool = float(section.rows["arg"][k, 0])
            text = "change the tool" if math.isnan(tool) else f"insert tool {tool:g}"
        elif op == Op.STOP:
            optional = bool(section.rows["arg"][k, 0])
            continue
        elif op == Op.END or op >= Op.OFFSET:
            continue
        break
    return WaitRequest(
        wait=edge.wait,
        section=section.number,
        line=edge.line,
        file=trace.files[edge.file] if edge.file else "",
        text=text,
        outcomes=tuple(edge.outcome for edge in section.edges),
        optional=optional,
    )
