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
from gproof.passes.interpret.eding.device_commands import DEVICES
from gproof.passes.interpret.eding.outputs_and_waits import CLAMPED

if TYPE_CHECKING:
    from gproof.passes.interpret.core.trace_writer import Emitter

Handler = Callable[["Emitter", Device], None]


def run_command(ex: Emitter, node: Device) -> None:
    """Execute one; Refusal GP113 for a command that is not modelled."""
    handler = HANDLERS.get(node.name)
    if handler is None:
        raise Refusal(codes.UNSUPPORTED_CODE.at(node.span, code=node.name))
    handler(ex, node)


def _home(ex: Emitter, node: Device) -> None:
    """The axis runs to its sensor and a little back (2.10.2): afterwards it stands near its home position."""
    names = [part.value for part in node.arguments if isinstance(part, Text)]
    ex.event(Op.HOME, node.span, text=ex._text(" ".join(names)))
    for name in names:
        axis = AXIS_NAMES.index(name)
        if not ex.modal.has_axis(axis):
            raise Refusal(codes.AXIS_NOT_THERE.at(node.span, axis=name.upper()))
        if axis == CLAMPED and ex.modal.clamped:
            ex._fail(codes.AXIS_CLAMPED.at(node.span, axis=name.upper(), hint="M27 before"))
        ex.modal.position[axis] = ex.unknown_place("home", axis, (-math.inf, math.inf), Position(0.0))
    ex.modal.unhomed -= {AXIS_NAMES.index(name) for name in names}
    ex.assumed["homing moves do not leave the machine"] = None
    ex.findings.add(codes.HOMING.at(node.span, axes=" ".join(name.upper() for name in names)))
    ex._end_section(Wait.HOME, "homed", None, node.span)


def _align(ex: Emitter, node: Device) -> None:
    """The second motor goes to the place of the first: the axis stays where it is (2.10.3)."""
    names = [part.value for part in node.arguments if isinstance(part, Text)]
    ex.event(Op.HOME, node.span, text=ex._text(" ".join(names)))
    ex._end_section(Wait.HOME, "aligned", None, node.span)


def _laf_angle(ex: Emitter, node: Device) -> None:
    value = ex.evaluator.value(node.arguments[0])
    if isinstance(value, Unknown):
        raise Refusal(codes.UNKNOWN_CONDITION.at(node.span, cause=value.cause))
    if not 0 <= value <= 180:
        what = f"a look-ahead angle of {value:g} degrees; 0 to 180 make sense"
        raise Refusal(codes.ARITHMETIC.at(node.span, what=what))
    ex.modal.laf_angle = value
    ex._state_changed()
    ex.event(Op.PATH_MODE, node.span, arg=(float(ex.modal.path_mode), ex.modal.path_tolerance))


def _note(ex: Emitter, node: Device) -> None:
    """Files and switches that move nothing."""
    what = f"{node.name} {describe_parts(node.arguments, ex.evaluator)}"
    ex.event(Op.MESSAGE, node.span, text=ex._text(what.strip()))


def _nesting(ex: Emitter, node: Device) -> None:
    """A preset of the nesting dialog (2.2.4.4): the job repeats only when the operator applies it."""
    _note(ex, node)
    ex.findings.add(codes.NESTING_PRESET.at(node.span))


def _wait(ex: Emitter, node: Device) -> None:
    from gproof.passes.interpret.mcuwin.outputs_and_waits import wait

    wait(ex, ex.evaluator.value(node.arguments[0]), node.span)


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
    "wait": _wait,
    **DEVICES,
}
"""What each command of ``rules.DEVICES`` does."""
