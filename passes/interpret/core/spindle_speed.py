"""How fast the spindle turns, in all languages, as the state of a run knows it. Eding CNC manual 2.1.11, 3.5.2."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gproof.ir.modal_groups import SPINDLE
from gproof.ir.symbolic import Unknown

if TYPE_CHECKING:
    from gproof.passes.interpret.core.modal_state import Modal


def commanded_rpm(s: Modal) -> float:
    """Revolutions a minute that the program requires while it turns; 0 at rest, NaN not known."""
    if SPINDLE in s.unknown_modes:
        return math.nan
    if s.spindle_direction == 0:
        return 0.0
    if s.surface_speed_mode or not s.speed_override_known or isinstance(s.spindle_speed, Unknown):
        return math.nan
    return s.spindle_speed


def true_rpm(s: Modal) -> float:
    """Revolutions a minute that it turns with: NaN too for a speed that the machine cannot give (2.1.11)."""
    rpm = commanded_rpm(s)
    return math.nan if is_beyond(s, rpm) else rpm


def is_beyond(s: Modal, rpm: float) -> bool:
    """Whether a speed is none that the spindle in use can give."""
    spindle = s.machine.spindle(s.head)
    if spindle is None or not rpm > 0:
        return False
    low, high = spindle.min_rpm, spindle.max_rpm
    return (low is not None and rpm < low) or (high is not None and rpm > high)


def own_ramp(s: Modal) -> float:
    """Seconds for a start or a reversal beyond those that every SPINDLE row of that kind lasts (docs/plan.md).

    2.1.11: the software waits the ramp-up time of the spindle between switching on and going on; each head has its own
    (3.5.2). A change of speed is no switching on. Call it before ``Modal.spun`` is set to what turns now.
    """
    direction, head = s.spun
    now = s.spindle_direction
    if commanded_rpm(s) == 0.0 or (now, s.head) == (direction, head):
        return 0.0
    there = s.machine.spindle(s.head)
    common = s.machine.controller.spindle_ramp_time
    own = common if there is None or there.ramp_time is None else there.ramp_time
    return max(0.0, own - common if now != direction else own)


def told(s: Modal) -> tuple[int, int]:
    """``Modal.spun`` of a row that is written now."""
    return s.spindle_direction, s.head if commanded_rpm(s) != 0.0 else -1
