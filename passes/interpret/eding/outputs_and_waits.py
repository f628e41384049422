"""Outputs and devices of the controller: M54 M55, torch height, axis clamp, drives, heaters and fans.

Eding CNC manual 3.5.8 to 3.5.12 and table 3-6. What takes the axes out of the program's hands is reported: a torch
height control that may be on (GP280), drives that were off (GP281), an axis whose resolution was changed (GP282).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gproof.ir import codes
from gproof.ir.finding import Refusal
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.ir.symbolic import NOWHERE
from gproof.ir.trace import Op, Wait
from gproof.passes.interpret.core.parsed_line import Line

if TYPE_CHECKING:
    from gproof.passes.interpret.core.run import Run

RESIZED = 3
"""The axis that M26 clamps and M100 resizes: A."""
HEATERS = ("extruder_temperature", "bed_temperature", "extruder_maximum")
"""What a TEMPERATURE code sets, by its value."""
OWN_S = (F.TEMPERATURE, F.TEMPERATURE_WAIT, F.FAN_ON)
"""Functions to which the S word of their line belongs."""
_SPINDLES = (F.SPINDLE_CW, F.SPINDLE_CCW, F.SPINDLE_OFF)
_PROMILLE = 1000.0


def run_outputs(run: Run, line: Line) -> None:
    """Execute the codes of this family on a line, in its order; Refusal with GP275, GP283 or GP113."""
    for rule in line.rules:
        act = _ACTS.get(rule.function)
        if act is not None:
            act(run, line, rule)


def takes_speed(line: Line) -> bool:
    """Whether the S word of a line is no spindle speed; Refusal GP113 where it could be both."""
    owner = line.find(*OWN_S)
    if owner is None:
        return False
    spindle = line.find(*_SPINDLES)
    if spindle is not None and "S" in line.values:
        raise Refusal(
            codes.UNSUPPORTED_CODE.at(line.span, code=f"S together with both {owner.text} and {spindle.text}")
        )
    return True


def _output(run: Run, line: Line, rule: CodeRule) -> None:
    """M54 P, M55 P: an output; M54 E Q: the pulse width of one, in thousandths (3.5.9)."""
    tolerance = run.program.rules.integer_tolerance
    on = rule.function is F.OUTPUT_ON
    channel, pwm = line.whole("P", tolerance), line.whole("E", tolerance)
    if pwm is not None and not on:
        raise Refusal(codes.UNSUPPORTED_CODE.at(line.where("E"), code=f"{rule.text} E"))
    if channel is not None and pwm is not None:
        raise Refusal(codes.OUTPUT_VALUE.at(line.where("E"), code=rule.text, what="one output, in P or in E"))
    letter, number = ("P", channel) if pwm is None else ("E", pwm)
    if number is not None and number < 0:
        raise Refusal(codes.OUTPUT_VALUE.at(line.where(letter), code=rule.text, what=f"there is no output {number}"))
    if pwm is None:
        if channel is None:
            raise Refusal(codes.WORD_MISSING.at(line.where_code(rule), code=rule.text, needed="its output in P"))
        run.event(Op.OUTPUT, line.span, arg=(float(channel), float(on)))
        return
    width = line.number("Q")
    if width is None:
        raise Refusal(codes.WORD_MISSING.at(line.where_code(rule), code=f"{rule.text} E", needed="its value in Q"))
    if not 0.0 <= width <= _PROMILLE:
        raise Refusal(codes.OUTPUT_VALUE.at(line.where("Q"), code=rule.text, what=f"Q is 0 to 1000, not {width:g}"))
    _set(run, line, "pwm", float(pwm), width / _PROMILLE)


def _height_control(run: Run, line: Line, rule: CodeRule) -> None:
    """M20 and M21: one switches on, one off, and 3.5.11 and table 3-6 contradict each other."""
    run.modal.not_programmed = tuple(sorted({*run.modal.not_programmed, 2}))
    run.modal.position[2] = NOWHERE
    _set(run, line, "height_control", 0.0, math.nan)
    run.fail(codes.HEIGHT_CONTROL.at(line.where_code(rule), code=rule.text))


def _height_setpoint(run: Run, line: Line, rule: CodeRule) -> None:
    value = line.number("Q")
    if value is None:
        raise Refusal(codes.WORD_MISSING.at(line.where_code(rule), code=rule.text, needed="its set point in Q"))
    _set(run, line, "height_setpoint", 0.0, value)


def _clamp(run: Run, line: Line, rule: CodeRule) -> None:
    """M26, M27 (3.5.10); P: the output that works the brake."""
    channel = line.whole("P", run.program.rules.integer_tolerance)
    run.modal.clamped = rule.function is F.CLAMP_ON
    if channel is not None:
        run.event(Op.OUTPUT, line.span, arg=(float(channel), float(run.modal.clamped)))


def _drives(run: Run, line: Line, rule: CodeRule) -> None:
    """M80, M81 (3.5.8). Without power an axis can be moved, or sink: where it is afterwards is not known."""
    on = rule.function is F.DRIVES_ON
    if not on:
        run.modal.drives_were_off = True
    _set(run, line, "drives", 0.0, float(on))


def _resolution(run: Run, line: Line, rule: CodeRule) -> None:
    """M100 P (3.5.12)."""
    factor = line.number("P")
    if factor is None:
        raise Refusal(codes.WORD_MISSING.at(line.where_code(rule), code=rule.text, needed="its factor in P"))
    if factor == 1.0 and RESIZED not in run.modal.not_programmed:
        return
    run.modal.not_programmed = tuple(sorted({*run.modal.not_programmed, RESIZED}))
    run.modal.position[RESIZED] = NOWHERE
    run.fail(codes.AXIS_RESIZED.at(line.where_code(rule), code=rule.text, factor=factor))


def _temperature(run: Run, line: Line, rule: CodeRule) -> None:
    """M104, M140, M143: S in degrees Celsius; M109, M190 wait for it (3.5.12)."""
    waits = rule.function is F.TEMPERATURE_WAIT
    name = HEATERS[rule.value]
    value = line.number("S")
    if value is None and not (waits and rule.value == 1):
        raise Refusal(codes.WORD_MISSING.at(line.where_code(rule), code=rule.text, needed="its temperature in S"))
    if value is not None:
        if value < 0.0:
            raise Refusal(codes.OUTPUT_VALUE.at(line.where("S"), code=rule.text, what=f"S {value:g} is negative"))
        _set(run, line, name, 0.0, value)
    if waits:
        run.note_stop(line, rule.text)
        run.end_section(Wait.INPUT, f"{name.replace('_', ' ')} reached", None, line.span)


def _fan(run: Run, line: Line, rule: CodeRule) -> None:
    """M106, M107. S is 0 to 255 by table 3-6 and 0 to 100 by 3.5.12: between the ends its share is not known."""
    value = line.number("S") if rule.function is F.FAN_ON else 0.0
    if value is not None and not 0.0 <= value <= 255.0:
        raise Refusal(codes.OUTPUT_VALUE.at(line.where("S"), code=rule.text, what=f"S is 0 to 255, not {value:g}"))
    known = {None: 1.0, 0.0: 0.0, 255.0: 1.0}
    _set(run, line, "fan", 0.0, known.get(value, math.nan))


def _set(run: Run, line: Line, name: str, channel: float, value: float) -> None:
    run.event(Op.SETPOINT, line.span, arg=(channel, value), text=run.text_number(name))


_ACTS = {
    F.OUTPUT_ON: _output,
    F.OUTPUT_OFF: _output,
    F.HEIGHT_CONTROL: _height_control,
    F.HEIGHT_SETPOINT: _height_setpoint,
    F.CLAMP_ON: _clamp,
    F.CLAMP_OFF: _clamp,
    F.DRIVES_ON: _drives,
    F.DRIVES_OFF: _drives,
    F.AXIS_RESOLUTION: _resolution,
    F.TEMPERATURE: _temperature,
    F.TEMPERATURE_WAIT: _temperature,
    F.FAN_ON: _fan,
    F.FAN_OFF: _fan,
}
