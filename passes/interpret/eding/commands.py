"""Commands to the controller that are no blocks of words (``Device`` nodes): homing, logs, the look-ahead angle.

Eding CNC manual 4.2 (special commands), 2.10 (homing, tandem axes). What a command does to positions is followed;
what only concerns screens and files is an event.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.finding import Refusal
from gproof.ir.machine import AXIS_NAMES
from gproof.ir.program import Device, Text
from gproof.ir.symbolic import Position, Unknown
from gproof.ir.trace import Op, Wait
from gproof.passes.interpret.core.expressions import describe_parts
from gproof.passes.interpret.core.moves import CLAMPED
from gproof.passes.interpret.eding.device_commands import DEVICES

if TYPE_CHECKING:
    from gproof.passes.interpret.core.run import Run

Handler = Callable[["Run", Device], None]


def run_command(run: Run, node: Device) -> None:
    """Execute one; Refusal GP113 for a command that is not modelled."""
    handler = HANDLERS.get(node.name)
    if handler is None:
        raise Refusal(codes.UNSUPPORTED_CODE.at(node.span, code=node.name))
    handler(run, node)


def _home(run: Run, node: Device) -> None:
    """The axis runs to its sensor and a little back (2.10.2): afterwards it is near its home position."""
    names = [part.value for part in node.arguments if isinstance(part, Text)]
    run.event(Op.HOME, node.span, text=run.text_number(" ".join(names)))
    for name in names:
        axis = AXIS_NAMES.index(name)
        if not run.modal.has_axis(axis):
            raise Refusal(codes.AXIS_NOT_THERE.at(node.span, axis=name.upper()))
        if axis == CLAMPED and run.modal.clamped:
            run.fail(codes.AXIS_CLAMPED.at(node.span, axis=name.upper(), hint="program M27 before"))
        run.modal.position[axis] = run.unknown_place("home", axis, (-math.inf, math.inf), Position(0.0))
    run.modal.unhomed -= {AXIS_NAMES.index(name) for name in names}
    run.assumed["homing moves do not leave the machine"] = None
    run.findings.add(codes.HOMING.at(node.span, axes=" ".join(name.upper() for name in names)))
    run.end_section(Wait.HOME, "homed", None, node.span)


def _align(run: Run, node: Device) -> None:
    """The second motor goes to the place of the first: the axis stays where it is (2.10.3)."""
    names = [part.value for part in node.arguments if isinstance(part, Text)]
    run.event(Op.HOME, node.span, text=run.text_number(" ".join(names)))
    run.end_section(Wait.HOME, "aligned", None, node.span)


def _laf_angle(run: Run, node: Device) -> None:
    value = run.evaluator.value(node.arguments[0])
    if isinstance(value, Unknown):
        raise Refusal(codes.UNKNOWN_CONDITION.at(node.span, cause=value.cause))
    if not 0 <= value <= 180:
        what = f"a look-ahead angle of {value:g} degrees; 0 to 180 degrees make sense"
        raise Refusal(codes.ARITHMETIC.at(node.span, what=what))
    run.modal.laf_angle = value
    run.state_changed()
    run.event(Op.PATH_MODE, node.span, arg=(float(run.modal.path_mode), run.modal.path_tolerance))


def _note(run: Run, node: Device) -> None:
    """Files and switches that move nothing."""
    what = f"{node.name} {describe_parts(node.arguments, run.evaluator)}"
    run.event(Op.MESSAGE, node.span, text=run.text_number(what.strip()))


def _nesting(run: Run, node: Device) -> None:
    """A preset of the nesting dialog (2.2.4.4): the job repeats only when the operator applies it."""
    _note(run, node)
    run.findings.add(codes.NESTING_PRESET.at(node.span))


HANDLERS: dict[str, Handler] = {
    "home": _home,
    "home_tandem": _home,
    "prepare_tandem_home": _home,
    "align_slave": _align,
    "laf_angle": _laf_angle,
    "home_is_stop": _note,
    "store_position": _note,
    "log_file": _note,
    "nesting": _nesting,
    **DEVICES,
}
"""What each command of ``rules.DEVICES`` does."""
