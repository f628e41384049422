"""Whose an argument word is when several codes of a line take it: a guess, so UNKNOWN (Eding CNC manual 3.2.5, 3.7).

The manual gives each code its words and no rule for two codes that share one; a letter is in a line once.
"""

from __future__ import annotations

from gproof.ir import codes
from gproof.ir.finding import Refusal
from gproof.ir.rules import CodeRule
from gproof.ir.rules import Function as F
from gproof.passes.interpret.core.parsed_line import Line

_PATH = (F.EXACT_PATH, F.EXACT_STOP, F.CONTINUOUS)
_DWELL_CYCLES = (F.DRILL_DWELL, F.BORE_STOP, F.BORE_MANUAL, F.BORE_DWELL)
_OVERRIDES = (F.FEED_OVERRIDE, F.SPEED_OVERRIDE, F.FEED_OVERRIDE_INPUT, F.FEED_HOLD_INPUT)
_SIDES = (F.COMPENSATION_LEFT, F.COMPENSATION_RIGHT)

_TAKERS: dict[str, tuple[F, ...]] = {
    "D": (*_SIDES, F.SURFACE_SPEED),
    "E": (F.OUTPUT_ON, F.INPUT_READ, F.THREADING),
    "H": (F.TOOL_OFFSET_ON, F.THREADING),
    "I": (F.TOOL_OFFSET_DYNAMIC, F.SCALING_ON, F.THREADING, F.BORE_BACK),
    "J": (F.SCALING_ON, F.THREADING, F.BORE_BACK),
    "K": (F.TOOL_OFFSET_DYNAMIC, F.THREADING, F.BORE_BACK, F.SYNCHRONISED, F.SYNCHRONISED_RETURN),
    "L": (F.SET_COORDINATES, F.INPUT_READ, F.THREADING),
    "P": (
        F.DWELL, F.SET_COORDINATES, *_PATH, F.OUTPUT_ON, F.OUTPUT_OFF, F.INPUT_READ, F.SCALING_ON, F.THREADING,
        *_DWELL_CYCLES, *_OVERRIDES, F.HEAD, F.CLAMP_ON, F.CLAMP_OFF, F.AXIS_RESOLUTION,
    ),
    "Q": (*_PATH, F.OUTPUT_ON, F.INPUT_READ, F.THREADING, F.DRILL_PECK, F.DRILL_CHIP_BREAK, F.HEAD, F.HEIGHT_SETPOINT),
    "R": (*_PATH, F.ROTATION_ON, F.THREADING),
}  # fmt: skip
"""Functions that take a letter; cycles, which all take R and L, are named by the caller."""


def owned(line: Line, rule: CodeRule, letters: str) -> None:
    """Refusal GP113 where another code of the line takes one of these letters too."""
    for letter in letters:
        if letter not in line.values:
            continue
        for other in line.rules:
            if other is not rule and other.function in _TAKERS[letter]:
                what = f"{letter} together with both {rule.text} and {other.text}"
                raise Refusal(codes.UNSUPPORTED_CODE.at(line.where(letter), code=what))
