"""What a Trace notes of a section besides its rows: what it leaves where a program ends, what its two outcomes rest on.

For who compares programs (``verify/translation``); nothing of a verdict rests on it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from gproof.ir.end_state import EndState, Left, Question
from gproof.ir.machine import AXES, AXIS_NAMES
from gproof.ir.program import Binary, Expr, Input, Unary
from gproof.ir.symbolic import Position, Unknown
from gproof.ir.trace import PathMode, Plane

if TYPE_CHECKING:
    from gproof.passes.interpret.core.modal_state import Modal
    from gproof.passes.interpret.core.run import Run

_ASKED = ("input", "output", "virtual", "answer")


def left(places: dict[str, Position]) -> Left:
    """Places by name as a record has them."""
    return tuple((name, place.value, place.form) for name, place in places.items())


def end_state(run: Run, modes: tuple[tuple[str, str], ...]) -> EndState:
    """What a program leaves where everything stays as it is: offsets, tool length, guards."""
    now = run.modal
    first = run.dialect.first_state(run.program, run.setup, run.machine)
    table = {
        f"work.{number}.{AXIS_NAMES[axis]}": place
        for (number, axis), place in {**now.work_offsets, **now.written_work}.items()
        if number and place != first.work_offsets.get((number, axis))
    }
    lengths = {
        AXIS_NAMES[axis]: now.tool_offset[axis]
        for axis in range(AXES)
        if now.tool_offset[axis] != first.tool_offset[axis]
    }
    return EndState(
        zero=left(zero(now, now.g92)), table=left(table), length=left(lengths), guards_off=now.guards_off, modes=modes
    )


def zero(modal: Modal, local: Sequence[Position]) -> dict[str, Position]:
    """By axis the zero that numbers count from, with these local offsets and the tool length in force."""
    return {
        AXIS_NAMES[axis]: modal.work_offsets[modal.work, axis].plus(local[axis]).plus(modal.tool_offset[axis])
        for axis in range(AXES)
        if modal.has_axis(axis)
    }


def common_modes(modal: Modal, language: str) -> tuple[tuple[str, str], ...]:
    """Modes that all languages keep in the same fields."""
    return (
        (f"{language}: unit", f"{modal.unit:g} mm"),
        (f"{language}: distances", "absolute" if modal.absolute else "relative"),
        (f"{language}: plane", Plane(modal.plane).name),
        (f"{language}: path mode", f"{PathMode(modal.path_mode).name} {modal.path_tolerance:g} {modal.simplify:g}"),
        (f"{language}: feed mode", str(modal.feed_mode)),
        (f"{language}: rotation and scaling", repr(modal.transform.numbers) if modal.transform.on else "off"),
        (f"{language}: overrides", "on" if modal.overrides else "off"),
        (f"{language}: coordinate system", str(modal.work)),
    )


def question_of(run: Run, condition: Expr) -> Question | None:
    """The channel that a condition asks for, where it asks for nothing else."""
    inner, on = condition, True
    while isinstance(inner, Unary) and inner.operator == "not":
        inner, on = inner.operand, not on
    if isinstance(inner, Input):
        number = run.evaluator.value(inner.number)
        if inner.kind not in _ASKED or isinstance(number, Unknown):
            return None
        return Question(kind=inner.kind, channel=round(number), on=on)
    if isinstance(inner, Binary) and inner.operator in ("==", "<>"):
        value, wanted = run.evaluator.value(inner.left), run.evaluator.value(inner.right)
        if isinstance(wanted, Unknown):
            value, wanted = wanted, value
        if isinstance(wanted, Unknown) or wanted not in (0.0, 1.0) or not isinstance(value, Unknown):
            return None
        read = run.inputs_read.get(id(value))
        # What was read before the last row was the input then, and not now.
        if read is not None and read[2] == run.rows.section and not run.rows.begin and not run.rows.count:
            return Question(kind="input", channel=read[1], on=on == ((inner.operator == "==") == (wanted == 1.0)))
        if isinstance(inner.left, Input) and inner.left.kind in _ASKED:
            number = run.evaluator.value(inner.left.number)
            if not isinstance(number, Unknown):
                is_on = on == ((inner.operator == "==") == (wanted == 1.0))
                return Question(kind=inner.left.kind, channel=round(number), on=is_on)
    return None
