"""The McuWIN dialect: DIN 66025 codes of the APCI-8001, numbered variables.

Source: APCI-8001 and APCI-8008 G-Code Interface, McuWIN V 2.5.3.133; ``source`` of a row is the section.
docs/dialects/mcuwin.md says how what the manual leaves open is read. Statements of rw_SymPas are nodes of their own.
"""

from __future__ import annotations

from gproof.ir.dialects.mcuwin.settings import VERSIONS
from gproof.ir.program import PARAMETER
from gproof.ir.rules import CodeRule, LanguageRules, ParameterRange
from gproof.ir.rules import Function as F

MOTION, PLANE, MIRROR, RADIUS, OFFSET = "motion", "plane", "reflection", "radius", "offset"
UNITS, DISTANCE, SPINDLE_MODE, SPLINE, CENTERS = "units", "distance", "speed mode", "spline", "centres"
SPINDLE, COOLANT = "spindle", "coolant"
USER = "user"
"""Group of G200 to G299 and M200 to M299, which the application defines."""


def _g(
    number: int, function: F, source: str, group: str = "", *, axes: bool = False, takes: str = "", value: int = 0,
    needs: str = "",
) -> CodeRule:  # fmt: skip
    return CodeRule(
        letter="G", tenths=number * 10, function=function, group=group, source=source, uses_axes=axes, takes=takes,
        value=value, needs=needs,
    )  # fmt: skip


def _m(
    number: int, function: F, source: str, group: str = "", *, axes: bool = False, takes: str = "", value: int = 0,
    needs: str = "",
) -> CodeRule:  # fmt: skip
    return CodeRule(
        letter="M", tenths=number * 10, function=function, group=group, source=source, uses_axes=axes, takes=takes,
        value=value, needs=needs,
    )  # fmt: skip


_G = (
    _g(0, F.TRAVERSE, "3.1", MOTION, axes=True),
    _g(1, F.FEED, "3.2", MOTION, axes=True, takes="F"),
    _g(2, F.ARC_CW, "3.3", MOTION, axes=True, takes="IJKF"),
    _g(3, F.ARC_CCW, "3.4", MOTION, axes=True, takes="IJKF"),
    _g(4, F.DWELL, "3.5", takes=PARAMETER, needs=PARAMETER),
    _g(17, F.PLANE_XY, "3.6", PLANE),
    _g(18, F.PLANE_XZ, "3.7", PLANE),
    _g(19, F.PLANE_YZ, "3.8", PLANE),
    # value: 1 for X, 2 for Y.
    _g(21, F.REFLECT, "3.9", MIRROR, value=2),
    _g(22, F.REFLECT, "3.10", MIRROR, value=1),
    _g(23, F.REFLECT, "3.11", MIRROR, value=3),
    _g(24, F.REFLECT_OFF, "3.12", MIRROR),
    _g(39, F.POSITION_FACTOR, "3.13", axes=True),
    _g(40, F.COMPENSATION_OFF, "3.14", RADIUS),
    _g(41, F.COMPENSATION_LEFT, "3.15", RADIUS),
    _g(42, F.COMPENSATION_RIGHT, "3.16", RADIUS),
    _g(51, F.EFFECTIVE_RADIUS, "3.17", axes=True),
    _g(53, F.ZERO_OFFSET_OFF, "3.18", OFFSET),
    *(_g(54 + k, F.SELECT_COORDINATES, "3.19", OFFSET, value=k + 1) for k in range(5)),
    _g(60, F.INTERPOLATION_AXES, "3.20", axes=True),
    _g(70, F.UNITS_INCH, "3.21", UNITS),
    _g(71, F.UNITS_MM, "3.22", UNITS),
    _g(74, F.HOME, "3.23", axes=True),
    _g(90, F.ABSOLUTE, "3.24", DISTANCE),
    _g(91, F.INCREMENTAL, "3.25", DISTANCE),
    _g(92, F.ZERO_OFFSET_SET, "3.26", OFFSET, axes=True),
    _g(93, F.FEED_INVERSE_TIME, "3.27"),
    _g(94, F.FEED_PER_MINUTE, "3.28"),
    # Without a heading of their own.
    _g(96, F.SURFACE_SPEED, "3.28", SPINDLE_MODE),
    _g(97, F.SPINDLE_RPM, "3.28", SPINDLE_MODE),
    _g(98, F.LIMIT_LEFT, "3.29", axes=True),
    _g(99, F.LIMIT_RIGHT, "3.30", axes=True),
    _g(150, F.SPLINE_OFF, "3.31", SPLINE),
    _g(151, F.SPLINE_ON, "3.32", SPLINE),
    _g(153, F.ZERO_OFFSET_READ, "3.33"),
    _g(154, F.ZERO_OFFSET_RESTORE, "3.34"),
    _g(161, F.CENTERS_ABSOLUTE, "3.35", CENTERS),
    _g(162, F.CENTERS_RELATIVE, "3.36", CENTERS),
)

_M = (
    _m(0, F.STOP, "4.1"),
    _m(1, F.OPTIONAL_STOP, "4.2"),
    _m(2, F.END, "4.3"),
    _m(3, F.SPINDLE_CW, "4.4", SPINDLE),
    _m(4, F.SPINDLE_CCW, "4.5", SPINDLE),
    _m(5, F.SPINDLE_OFF, "4.6", SPINDLE),
    _m(6, F.TOOL_CHANGE, "4.7"),
    _m(8, F.FLOOD_ON, "4.8", COOLANT),
    _m(9, F.COOLANT_OFF, "4.9", COOLANT),
    _m(17, F.RETURN, "4.10"),
    _m(26, F.OUTPUT_ON, "4.11", takes=PARAMETER, needs=PARAMETER),
    _m(27, F.OUTPUT_OFF, "4.12", takes=PARAMETER, needs=PARAMETER),
    _m(30, F.END_RESET, "4.13"),
    _m(80, F.OUTPUT_WORD, "4.14", axes=True),
    _m(96, F.JUMP, "4.15", takes="L", needs="L"),
    _m(98, F.CALL, "4.16", takes="LO", needs="L"),
    _m(100, F.APPLICATION, "4.17"),
    _m(150, F.DEVICE, "4.18"),
    # value: 1 for whole numbers (CI), 0 for others (CD).
    _m(901, F.SAVE_VARIABLE, "4.19", takes=PARAMETER, needs=PARAMETER, value=1),
    _m(902, F.RESTORE_VARIABLE, "4.20", takes=PARAMETER, needs=PARAMETER, value=1),
    _m(903, F.SAVE_VARIABLE, "4.21", takes=PARAMETER, needs=PARAMETER),
    _m(904, F.RESTORE_VARIABLE, "4.22", takes=PARAMETER, needs=PARAMETER),
    _m(910, F.DEVICE, "4.23"),
    _m(911, F.DEVICE, "4.24"),
)

LATER = frozenset((("G", 96), ("G", 97), *(("M", number) for number in (80, 901, 902, 903, 904, 910, 911))))
"""Codes that the manual of the older version does not have (14: 2.5.3.78, .88, .93, .117)."""


def has_code(letter: str, number: int, version: str) -> bool:
    """Whether a version of McuWIN has a code of its own."""
    if version == VERSIONS[1] and (letter, number) in LATER:
        return False
    return (letter, number * 10) in MCUWIN.codes


WORDS = {
    "F": ("feed of G01, G02 and G03", "5.3"),
    "S": ("speed of the main spindle, by Task 0", "5.4"),
    "T": ("tool change by Task 0, and record of the tool radius table", "5.5"),
    "D": ("tool correction table, by Task 0", "5.6"),
    "L": ("label", "5.1"),
    "O": ("how often a subprogram runs", "4.16"),
    "I": ("centre of an arc, first axis", "3.3"),
    "J": ("centre of an arc, second axis", "3.3"),
    "K": ("centre of an arc, third axis", "3.3"),
}
"""Letters other than those of the axes: meaning, section."""

COMMON = 1000
"""Numbers of CD and of CI, each from 0 (11)."""
PROTECTED = 600
"""Below it common variables belong to the controller (4.20, 11)."""
RESERVED = 100
"""So many from PROTECTED on are reserved for the user (11)."""
DECLARED = 2 * COMMON
"""Number of the first variable that a program declares."""
OFFSETS_AT = 50
"""CD 50 holds the zero offset of the first axis (3.33)."""

_PARAMETERS = (
    ParameterRange(first=0, last=OFFSETS_AT - 1, kind="system", meaning="common double variables of the controller",
                   source="11", prefix="CD"),
    ParameterRange(first=OFFSETS_AT, last=OFFSETS_AT + 9, kind="free", meaning="zero offsets of G153 and G154",
                   source="3.33", prefix="CD", base=OFFSETS_AT),
    ParameterRange(first=OFFSETS_AT + 10, last=PROTECTED - 1, kind="system",
                   meaning="common double variables of the controller", source="11", prefix="CD", base=OFFSETS_AT + 10),
    ParameterRange(first=PROTECTED, last=COMMON - 1, kind="free", meaning="common double variables", source="11",
                   prefix="CD", base=PROTECTED),
    ParameterRange(first=COMMON, last=COMMON + PROTECTED - 1, kind="system",
                   meaning="common integer variables of the controller", source="11", prefix="CI"),
    ParameterRange(first=COMMON + PROTECTED, last=DECLARED - 1, kind="free", meaning="common integer variables",
                   source="11", prefix="CI", base=PROTECTED),
    ParameterRange(first=DECLARED, last=999_999, kind="free", meaning="variables that the program declares",
                   source="12", prefix="variable "),
)  # fmt: skip

MCUWIN = LanguageRules(
    name="mcuwin",
    codes={(rule.letter, rule.tenths): rule for rule in (*_G, *_M)},
    parameters=_PARAMETERS,
    highest_parameter=999_999,
    arc_tolerance_mm=0.001,  # where the machine file has none; error 2000 has no number in the manual
    arc_tolerance_inch=0.001 / 25.4,
    line_length=1_000_000,
    m_codes_in_line=1_000,
    highest_tool=999_999,
    integer_tolerance=1e-9,
    peck_clearance_mm=0.0,
    call_depth=1_000,  # none is stated: the executor's own limit of nested blocks comes first
    straight_traverse=False,  # 3.1: each axis has its own velocity and acceleration
    zeros_end_contours=True,  # 3.18, 3.19, 3.26
)
