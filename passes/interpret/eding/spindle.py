"""The spindle: speed, direction, constant surface speed, outputs. Eding CNC manual 3.4.25, 3.5.2, 3.5.8, 3.6.2.

The functions take the state of a run (``Modal``) or the run itself (``Run``) and the line; docs/dialects/eding.md
lists what the manual leaves open.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.finding import Refusal
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import Unknown
from gproof.passes.interpret.core.open_numbers import number_or_open
from gproof.passes.interpret.core.parsed_line import Line
from gproof.passes.interpret.core.spindle_speed import commanded_rpm, is_beyond, true_rpm
from gproof.passes.interpret.eding.ambiguous_words import owned
from gproof.passes.interpret.eding.outputs_and_waits import takes_speed

if TYPE_CHECKING:
    from gproof.passes.interpret.core.run import Run

_DIRECTIONS = {F.SPINDLE_CW: 1, F.SPINDLE_CCW: -1, F.SPINDLE_OFF: 0}
_OUTPUTS = (F.DIRECTION_OUTPUT_ON, F.DIRECTION_OUTPUT_OFF, F.SPEED_OUTPUT_ON, F.SPEED_OUTPUT_OFF)
MM_PER_FOOT = 304.8


def need_turning(run: Run, line: Line, rule: CodeRule) -> None:
    """Refusal GP244 for a spindle that rests; GP266 where it is not known whether it turns."""
    s = run.modal
    if s.spindle_direction == 0 and "spindle" not in s.stated:
        raise Refusal(codes.SPINDLE_STATE_UNKNOWN.at(line.where_code(rule), code=rule.text))
    if s.spindle_direction == 0 or s.spindle_speed == 0.0:
        raise Refusal(codes.CYCLE_SPINDLE_STOPPED.at(line.where_code(rule), code=rule.text))


def note_speed_unknown(run: Run, line: Line, code: str) -> None:
    """GP239 when a feed per revolution meets a speed that is not known."""
    s = run.modal
    if not math.isnan(true_rpm(s)):
        return
    hint = "program S and start the spindle before"
    if s.surface_speed_mode:
        hint = "program G97 before: at constant surface speed (G96) the speed changes along the move"
    elif not s.speed_override_known:
        hint = "program S again: M51 changed the speed by a factor whose unit is not in the manual"
    elif not math.isnan(commanded_rpm(s)):
        hint = "program an S within the range of the spindle"
    run.findings.add(codes.SPINDLE_UNKNOWN.at(line.span, code=code, hint=hint))


# step 4 of table 3-7


def speed_word(run: Run, line: Line) -> None:
    """G96, G97 and S, in this order: the mode tells what S on its line means (3.4.25, 3.6.2)."""
    s = run.modal
    value = None if takes_speed(line) else line.values.get("S")
    if value is not None and not isinstance(value, Unknown) and value < 0:
        raise Refusal(codes.SPINDLE_SPEED_NEGATIVE.at(line.where("S"), value=value))
    rule = line.find(F.SURFACE_SPEED, F.SPINDLE_RPM)
    if rule is not None:
        _mode(run, line, rule)
    if value is None and rule is None:
        return
    if value is not None:
        s.spindle_speed = value
        if s.surface_speed_mode and not isinstance(value, Unknown):
            # Metres a minute in millimetre mode, feet in inch mode (3.4.25); units are read before G20 acts.
            s.spindle_speed = value if s.unit == 1.0 else value * MM_PER_FOOT / 1000.0
        elif not isinstance(value, Unknown) and is_beyond(s, value):
            _warn_range(run, line, value)
    run.state_changed()
    if s.spindle_direction and line.group("M7") is None:
        run.spindle_row(line)


def _mode(run: Run, line: Line, rule: CodeRule) -> None:
    s = run.modal
    if rule.function is F.SPINDLE_RPM:
        if s.surface_speed_mode:
            # The number of one mode means nothing in the other.
            s.spindle_speed = Unknown("the spindle speed after G97 without S")
        s.surface_speed_mode, s.spindle_limit = False, math.nan
        return
    if "S" not in line.values:
        raise Refusal(codes.WORD_MISSING.at(line.where_code(rule), code=rule.text, needed="S"))
    owned(line, rule, "D")
    limit = number_or_open(run, line, "D", rule.text, positive=True)
    if limit is not None and limit <= 0:
        raise Refusal(codes.SURFACE_SPEED_LIMIT.at(line.where("D"), value=limit))
    if limit is None:
        run.findings.add(codes.SURFACE_SPEED_UNBOUNDED.at(line.where_code(rule), code=rule.text))
    s.surface_speed_mode, s.spindle_limit = True, math.nan if limit is None else limit


def _warn_range(run: Run, line: Line, value: float) -> None:
    spindle = run.machine.spindle(run.modal.head)
    assert spindle is not None
    low = "..." if spindle.min_rpm is None else f"{spindle.min_rpm:g}"
    high = "..." if spindle.max_rpm is None else f"{spindle.max_rpm:g}"
    run.findings.add(codes.SPINDLE_RANGE.at(line.where("S"), value=value, low=low, high=high))


# step 7


def direction(run: Run, line: Line) -> None:
    """M3, M4 and M5, then the outputs one by one: M84 and M85, M86 and M87 (3.5.2, 3.5.8)."""
    s = run.modal
    rule = line.group("M7")
    if rule is not None:
        s.spindle_direction = _DIRECTIONS[rule.function]
        # 3.5.8: M3 switches the direction output on, M4 and M5 off.
        s.direction_output = 1 if rule.function is F.SPINDLE_CW else -1
        s.stated.add("spindle")
        run.spindle_row(line)
    for rule in sorted((r for r in line.rules if r.function in _OUTPUTS), key=lambda r: r.tenths):
        _output(run, line, rule)


def _output(run: Run, line: Line, rule: CodeRule) -> None:
    """A spindle turns while its speed output is on, clockwise while the direction output is: M3 and M4 in 3.5.8."""
    s = run.modal
    turns = s.spindle_direction != 0
    if rule.function is F.SPEED_OUTPUT_OFF:
        turns = False
    elif rule.function is F.SPEED_OUTPUT_ON:
        turns = True
    else:
        s.direction_output = 1 if rule.function is F.DIRECTION_OUTPUT_ON else -1
    if turns and not s.direction_output:
        s.spindle_direction = 0
        s.stated.discard("spindle")
        run.fail(codes.UNSUPPORTED_CODE.at(line.where_code(rule), code=f"{rule.text} before M3, M4, M5, M84 or M85"))
        return
    if "spindle" not in s.stated and rule.function in (F.DIRECTION_OUTPUT_ON, F.DIRECTION_OUTPUT_OFF):
        return  # it is not known whether it turns at all
    before = s.spindle_direction
    s.spindle_direction = s.direction_output if turns else 0
    s.stated.add("spindle")
    if before != s.spindle_direction or rule.function in (F.SPEED_OUTPUT_ON, F.SPEED_OUTPUT_OFF):
        run.spindle_row(line)
