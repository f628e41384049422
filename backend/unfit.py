"""What keeps a board from running a job, known from the job and from what the board says that it is."""

from __future__ import annotations

from collections.abc import Iterator

from gproof.backend.boards.board import MOVES_NOTHING, Capabilities, ticks_up
from gproof.backend.feed import Words
from gproof.backend.job import CertifiedJob
from gproof.backend.manual_events import words_of_outputs
from gproof.backend.record_data import TRUSTED
from gproof.backend.step_rate import too_fast, too_fast_text
from gproof.ir import codes
from gproof.ir.finding import Finding, Span
from gproof.ir.trace import Wait

SENSED = frozenset({Wait.PROBE, Wait.HOME})
"""Waits that a switch ends in the middle of a move: steps sent regardless would go on through the contact."""


def unfit(job: CertifiedJob, is_: Capabilities) -> Iterator[Finding]:
    """Why a board cannot run a job."""
    where = Span(job.name, 0)
    if is_.name not in MOVES_NOTHING:
        if job.accepted != TRUSTED:
            what = f"board {is_.name} moves a machine: it takes only what a trusted key has signed"
            yield codes.CERTIFICATE_UNTRUSTED.at(where, what=what)
        if not (job.machine_at_hand and job.setup_at_hand):
            what = f"board {is_.name} moves a machine: it needs the machine file and the setup (--machine, --setup)"
            yield codes.CERTIFICATE_MACHINE.at(where, what=what)
        if job.machine.board.motors and job.machine.board.name != is_.name:
            what = f"its wiring is that of a board {job.machine.board.name}, and this one is {is_.name}"
            yield codes.CERTIFICATE_MACHINE.at(where, what=what)
    board, ticks = job.machine.board, job.stream.tick_frequency
    wanted = (
        (
            bool(is_.motor_names) and is_.motor_names != tuple(m.name for m in job.stream.motors),
            f"has pins for motors {', '.join(is_.motor_names)}, the stream is for "
            + ", ".join(m.name for m in job.stream.motors),
        ),
        (is_.motors != len(job.stream.motors), f"drives {is_.motors} motors, the stream has {len(job.stream.motors)}"),
        (is_.tick_frequency != ticks, f"counts {is_.tick_frequency} ticks per second, the stream {ticks}"),
        (
            is_.step_pulse > ticks_up(board.step_pulse, ticks),
            f"needs step pulses of {is_.step_pulse} ticks, the machine file says {board.step_pulse:g} s",
        ),
        (
            is_.direction_setup > ticks_up(board.direction_setup, ticks),
            f"needs {is_.direction_setup} ticks to change direction, the machine file says {board.direction_setup:g} s",
        ),
    )
    for wrong, what in wanted:
        if wrong:
            yield codes.CERTIFICATE_MACHINE.at(Span(job.name, 0), what=f"board {is_.name} {what}")
    for number, row in words_of_outputs(job.stream, job.trace) if not is_.acts_alone else ():
        line = int(job.trace.sections[number].rows["line"][row])
        what = f"board {is_.name} cannot switch all outputs of an axis at once, as line {line} does"
        yield codes.CERTIFICATE_MACHINE.at(where, what=what)
    if is_.step_rate:
        names = [motor.name for motor in job.stream.motors]
        for part in job.stream.sections:
            if (fast := too_fast(part, is_.step_rate, ticks)) is not None:
                what = too_fast_text(fast, is_.step_rate, ticks, part, names)
                yield codes.STEPS_TOO_FAST.at(where, what=f"board {is_.name}: {what}")
    words = Words.of(is_)
    for part in job.stream.sections:
        for motor, runs in zip(job.stream.motors, part.runs, strict=True):
            if (wide := words.problem(runs)) is not None:
                what = f"board {is_.name} cannot take section {part.number}: {motor.name} has {wide}"
                yield codes.CERTIFICATE_MACHINE.at(where, what=what)
    for section in job.trace.sections:
        for wait in sorted({edge.wait.value for edge in section.edges if edge.wait in SENSED}):
            what = f"board {is_.name} cannot read a {wait} switch, and section {section.number} waits for one"
            yield codes.CERTIFICATE_MACHINE.at(Span(job.name, 0), what=what)
