"""LanguageRules: what a dialect's manual decides, as data that the executor follows.

A code is a letter and its number in tenths (G38.2 is ("G", 382)). Its ``Function`` is neutral: the executor
knows functions, never dialects. Each rule names the section of the manual it stands on.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass, field


class Function(enum.IntEnum):
    """Neutral machine functions. Motion that a kernel executes has the numbers 1 to 4."""

    TRAVERSE = 1
    FEED = 2
    ARC_CW = 3
    ARC_CCW = 4
    MOTION_CANCEL = 5
    DRILL = 6
    DRILL_DWELL = 7
    DRILL_PECK = 8
    DRILL_CHIP_BREAK = 9
    BORE = 10
    BORE_STOP = 11
    BORE_DWELL = 12
    DWELL = 20
    SET_COORDINATES = 21
    PLANE_XY = 22
    PLANE_XZ = 23
    PLANE_YZ = 24
    UNITS_INCH = 25
    UNITS_MM = 26
    PARK_1 = 27
    PARK_2 = 28
    COMPENSATION_OFF = 29
    COMPENSATION_LEFT = 30
    COMPENSATION_RIGHT = 31
    TOOL_OFFSET_ON = 32
    TOOL_OFFSET_DYNAMIC = 33
    TOOL_OFFSET_OFF = 34
    MACHINE_COORDINATES = 35
    SELECT_COORDINATES = 36
    EXACT_PATH = 37
    EXACT_STOP = 38
    CONTINUOUS = 39
    ABSOLUTE = 40
    INCREMENTAL = 41
    AXIS_OFFSET_SET = 42
    AXIS_OFFSET_RESET = 43
    AXIS_OFFSET_SUSPEND = 44
    AXIS_OFFSET_RESTORE = 45
    FEED_INVERSE_TIME = 46
    FEED_PER_MINUTE = 47
    FEED_PER_REVOLUTION = 48
    RETRACT_INITIAL = 49
    RETRACT_R = 50
    STOP = 60
    OPTIONAL_STOP = 61
    END = 62
    END_RESET = 63
    STOP_KEEP = 64
    SPINDLE_CW = 65
    SPINDLE_CCW = 66
    SPINDLE_OFF = 67
    TOOL_CHANGE = 68
    MIST_ON = 69
    FLOOD_ON = 70
    COOLANT_OFF = 71
    OVERRIDES_ON = 72
    OVERRIDES_OFF = 73
    OUTPUT_ON = 74
    OUTPUT_OFF = 75
    UNSUPPORTED = 99


@dataclass(frozen=True, slots=True, kw_only=True)
class CodeRule:
    """One code. group: modal group, as the manual names it ("" for codes it lists in none);
    uses_axes: takes the line's axis words; value: argument of the function (coordinate system number);
    source: section of the manual."""

    letter: str
    tenths: int
    function: Function
    group: str
    source: str
    uses_axes: bool = False
    value: int = 0

    @property
    def text(self) -> str:
        """As written: ``G38.2``, ``M6``."""
        whole, tenth = divmod(self.tenths, 10)
        return f"{self.letter}{whole}.{tenth}" if tenth else f"{self.letter}{whole}"


@dataclass(frozen=True, slots=True, kw_only=True)
class ParameterRange:
    """Numbered variables first..last: meaning, whether a program may write them, section of the manual.

    kind: how the executor finds the live value: ``free``, ``persistent``, ``position`` (work),
    ``machine_position``, ``tool``, ``g92``, ``work`` (stride 20 from first), ``work_number``, ``park_1``,
    ``park_2``, ``tool_length``, ``other``.
    """

    first: int
    last: int
    kind: str
    meaning: str
    source: str
    writable: bool = True


@dataclass(frozen=True, slots=True, kw_only=True)
class LanguageRules:
    """Everything the executor must know about a language; see the module's text."""

    name: str
    codes: dict[tuple[str, int], CodeRule] = field(repr=False)
    parameters: tuple[ParameterRange, ...] = field(repr=False)
    highest_parameter: int
    arc_tolerance_mm: float
    arc_tolerance_inch: float
    line_length: int
    m_codes_in_line: int
    highest_tool: int
    integer_tolerance: float
    peck_clearance_mm: float
    call_depth: int

    def __eq__(self, other: object) -> bool:
        return isinstance(other, LanguageRules) and other.name == self.name

    def __hash__(self) -> int:
        return hash(self.name)


UNARY = (
    "neg", "pos", "abs", "acos", "asin", "atan", "cos", "exp", "fix", "fup", "int", "ln", "round", "sin", "sqrt",
    "tan", "not",
)  # fmt: skip
"""Unary operators; angles in degrees."""

BINARY = (
    "+", "-", "*", "/", "**", "mod", "atan", "and", "or", "xor", ">", ">=", "<", "<=", "==", "<>", "band", "bor",
    "bxor", "<<", ">>",
)  # fmt: skip
"""Binary operators; ``atan`` is the two-argument arc tangent of left over right, in degrees."""
