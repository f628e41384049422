"""Events of a stream that no pin of the board carries out: waits for the operator, at rest and before they are due.

Every event of a stream happens at rest (``passes/motion/plan_kernels.py``), so a wait moves no step: it only makes a
rest longer. Several events between which nothing moves and nothing dwells are one wait.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from gproof.backend.boards.outputs import Manual, left_of
from gproof.backend.operators import WaitRequest
from gproof.ir.machine import WiredOutput
from gproof.ir.record import record
from gproof.ir.stream import StepStream, StreamSection
from gproof.ir.trace import Op, Trace, Wait

DONE = "done"
"""The answer."""

_SWITCHING = (Op.SPINDLE, Op.COOLANT, Op.OUTPUT, Op.SETPOINT)


@record(frozen=True, slots=True, kw_only=True)
class ManualWait:
    """event: the first event of the section that waits for it, by its place in the table; request: what to ask."""

    event: int
    request: WaitRequest


def manual_waits(section: StreamSection, trace: Trace, outputs: Sequence[WiredOutput]) -> list[ManualWait]:
    """The waits of a section, in order. What an event leaves as the one before it in the section is not asked again."""
    rows = trace.sections[section.number].rows
    state: dict[str, str] = {}
    groups: list[tuple[int, list[Manual]]] = []
    last = -1
    for event, (_, row, op, arg) in enumerate(section.events.rows()):
        if op not in _SWITCHING:
            continue
        text = int(rows["text"][row])
        named = trace.texts[text] if op == Op.SETPOINT and 0 <= text < len(trace.texts) else ""
        left = [m for m in left_of(op, (int(arg[0]), int(arg[1])), outputs, named) if state.get(m.what) != m.to]
        if not left:
            continue
        state.update((manual.what, manual.to) for manual in left)
        if not groups or (rows["op"][last + 1 : row] <= Op.DWELL).any():
            groups.append((event, []))
        groups[-1][1].extend(left)
        last = int(row)
    at = section.events["row"]
    return [ManualWait(event=e, request=_request(section.number, int(at[e]), trace, _said(m))) for e, m in groups]


def all_manual(stream: StepStream, trace: Trace, outputs: Sequence[WiredOutput]) -> Iterator[WaitRequest]:
    """What a run will ask at most, section by section."""
    for section in stream.sections:
        for wait in manual_waits(section, trace, outputs):
            yield wait.request


def words_of_outputs(stream: StepStream, trace: Trace) -> Iterator[tuple[int, int]]:
    """(section, row) of events that write a word of all outputs of an axis at once: no pin and no operator does it."""
    for section in stream.sections:
        rows = trace.sections[section.number].rows
        for row in section.events["row"][section.events["op"] == Op.OUTPUT].tolist():
            if rows["text"][row] < 0:
                yield section.number, row


def _said(left: Sequence[Manual]) -> str:
    return "; ".join(f"{manual.what}: {manual.to}" for manual in left)


def _request(number: int, row: int, trace: Trace, text: str) -> WaitRequest:
    rows = trace.sections[number].rows
    file = int(rows["file"][row])
    return WaitRequest(
        wait=Wait.OPERATOR, section=number, line=int(rows["line"][row]), file=trace.files[file] if file else "",
        text=text, outcomes=(DONE,),
    )  # fmt: skip
