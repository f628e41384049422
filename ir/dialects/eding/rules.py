"""The Eding CNC dialect (RS274/NGC): codes, modal groups, numbered parameters.

Source: Eding CNC manual 4.01; sections are given with each row. Modal groups: section 3.3, table 3-3;
codes: tables 3-4 and 3-6; parameters: section 3.1.1.
"""

from __future__ import annotations

from gproof.ir.rules import CodeRule, LanguageRules, ParameterRange
from gproof.ir.rules import Function as F

_MOTION, _PLANE, _DISTANCE, _FEED_MODE, _UNITS = "G1", "G2", "G3", "G5", "G6"
_CUTTER, _LENGTH, _RETRACT, _COORDINATES, _PATH, _ROTATION = "G7", "G8", "G10", "G12", "G13", "G14"
_ONCE = "G0"
_SPINDLE_MODE = "G96, G97"
"""In no group of table 3-3; one line can only select one of the two."""


def _g(number: float, function: F, group: str, source: str, axes: bool = False, value: int = 0) -> CodeRule:
    return CodeRule(
        letter="G",
        tenths=round(number * 10),
        function=function,
        group=group,
        source=source,
        uses_axes=axes,
        value=value,
    )


def _m(number: int, function: F, group: str, source: str, value: int = 0, reason: str = "") -> CodeRule:
    return CodeRule(
        letter="M", tenths=number * 10, function=function, group=group, source=source, value=value, open=reason
    )


_SUPPORTED = (
    _g(0, F.TRAVERSE, _MOTION, "3.4.1", axes=True),
    _g(1, F.FEED, _MOTION, "3.4.2", axes=True),
    _g(2, F.ARC_CW, _MOTION, "3.4.3", axes=True),
    _g(3, F.ARC_CCW, _MOTION, "3.4.3", axes=True),
    _g(4, F.DWELL, _ONCE, "3.4.4"),
    _g(10, F.SET_COORDINATES, _ONCE, "3.4.5", axes=True),
    _g(17, F.PLANE_XY, _PLANE, "3.4.6"),
    _g(18, F.PLANE_XZ, _PLANE, "3.4.6"),
    _g(19, F.PLANE_YZ, _PLANE, "3.4.6"),
    _g(20, F.UNITS_INCH, _UNITS, "3.4.7"),
    _g(21, F.UNITS_MM, _UNITS, "3.4.7"),
    _g(70, F.UNITS_INCH, _UNITS, "3.4.7"),
    _g(71, F.UNITS_MM, _UNITS, "3.4.7"),
    _g(28, F.PARK_1, _ONCE, "3.4.8", axes=True),
    _g(30, F.PARK_2, _ONCE, "3.4.8", axes=True),
    _g(38.2, F.PROBE, _MOTION, "3.4.10", axes=True),
    _g(40, F.COMPENSATION_OFF, _CUTTER, "3.4.11"),
    _g(41, F.COMPENSATION_LEFT, _CUTTER, "3.4.11"),
    _g(42, F.COMPENSATION_RIGHT, _CUTTER, "3.4.11"),
    # value 1: D is a diameter.
    _g(41.1, F.COMPENSATION_LEFT, _CUTTER, "3.4.11", value=1),
    _g(42.1, F.COMPENSATION_RIGHT, _CUTTER, "3.4.11", value=1),
    _g(43, F.TOOL_OFFSET_ON, _LENGTH, "3.4.12"),
    _g(43.1, F.TOOL_OFFSET_DYNAMIC, _LENGTH, "3.4.12"),
    _g(49, F.TOOL_OFFSET_OFF, _LENGTH, "3.4.12"),
    _g(53, F.MACHINE_COORDINATES, _ONCE, "3.4.14"),
    *(_g(54 + k, F.SELECT_COORDINATES, _COORDINATES, "3.4.15", value=1 + k) for k in range(6)),
    *(_g(59 + k / 10, F.SELECT_COORDINATES, _COORDINATES, "3.4.15", value=6 + k) for k in (1, 2, 3)),
    _g(61, F.EXACT_PATH, _PATH, "3.4.16"),
    _g(61.1, F.EXACT_STOP, _PATH, "3.4.16"),
    _g(64, F.CONTINUOUS, _PATH, "3.4.16"),
    _g(50, F.SCALING_OFF, "", "3.4.13"),
    _g(51, F.SCALING_ON, "", "3.4.13", axes=True),
    _g(68, F.ROTATION_ON, _ROTATION, "3.4.18", axes=True),
    _g(69, F.ROTATION_OFF, _ROTATION, "3.4.18"),
    _g(80, F.MOTION_CANCEL, _MOTION, "3.4.20"),
    _g(81, F.DRILL, _MOTION, "3.4.21.2", axes=True),
    _g(82, F.DRILL_DWELL, _MOTION, "3.4.21.3", axes=True),
    _g(83, F.DRILL_PECK, _MOTION, "3.4.21.4", axes=True),
    _g(73, F.DRILL_CHIP_BREAK, _MOTION, "3.4.21.5", axes=True),
    _g(33, F.SYNCHRONISED, _MOTION, "3.4.9", axes=True),
    _g(33.1, F.SYNCHRONISED_RETURN, _MOTION, "3.4.9", axes=True),
    _g(76, F.THREADING, _MOTION, "3.4.19", axes=True),
    _g(84, F.TAP_RIGHT, _MOTION, "3.4.21.6", axes=True),
    _g(74, F.TAP_LEFT, _MOTION, "3.4.21.7", axes=True),
    _g(85, F.BORE, _MOTION, "3.4.21.8", axes=True),
    _g(86, F.BORE_STOP, _MOTION, "3.4.21.9", axes=True),
    _g(87, F.BORE_BACK, _MOTION, "3.4.21.10", axes=True),
    _g(88, F.BORE_MANUAL, _MOTION, "3.4.21.11", axes=True),
    _g(89, F.BORE_DWELL, _MOTION, "3.4.21.12", axes=True),
    _g(90, F.ABSOLUTE, _DISTANCE, "3.4.22"),
    _g(91, F.INCREMENTAL, _DISTANCE, "3.4.22"),
    _g(92, F.AXIS_OFFSET_SET, _ONCE, "3.4.23", axes=True),
    _g(92.1, F.AXIS_OFFSET_RESET, _ONCE, "3.4.23"),
    _g(92.2, F.AXIS_OFFSET_SUSPEND, _ONCE, "3.4.23"),
    _g(92.3, F.AXIS_OFFSET_RESTORE, _ONCE, "3.4.23"),
    _g(93, F.FEED_INVERSE_TIME, _FEED_MODE, "3.4.24"),
    _g(94, F.FEED_PER_MINUTE, _FEED_MODE, "3.4.24"),
    _g(95, F.FEED_PER_REVOLUTION, _FEED_MODE, "3.4.24"),
    _g(96, F.SURFACE_SPEED, _SPINDLE_MODE, "3.4.25"),
    _g(97, F.SPINDLE_RPM, _SPINDLE_MODE, "3.4.25"),
    _g(98, F.RETRACT_INITIAL, _RETRACT, "3.4.26"),
    _g(99, F.RETRACT_R, _RETRACT, "3.4.26"),
    _m(0, F.STOP, "M4", "3.5.1"),
    _m(1, F.OPTIONAL_STOP, "M4", "3.5.1"),
    _m(2, F.END, "M4", "3.5.1"),
    _m(30, F.END_RESET, "M4", "3.5.1"),
    _m(60, F.STOP_KEEP, "M4", "3.5.1"),
    _m(3, F.SPINDLE_CW, "M7", "3.5.2"),
    _m(4, F.SPINDLE_CCW, "M7", "3.5.2"),
    _m(5, F.SPINDLE_OFF, "M7", "3.5.2"),
    _m(6, F.TOOL_CHANGE, "M6", "3.5.3"),
    _m(7, F.MIST_ON, "M8", "3.5.4"),
    _m(8, F.FLOOD_ON, "M8", "3.5.4"),
    _m(9, F.COOLANT_OFF, "M8", "3.5.4"),
    _m(54, F.OUTPUT_ON, "M5", "3.5.9"),
    _m(55, F.OUTPUT_OFF, "M5", "3.5.9"),
    _m(56, F.INPUT_READ, "M5", "3.5.9"),
    _m(20, F.HEIGHT_CONTROL, "", "3.5.11"),
    _m(21, F.HEIGHT_CONTROL, "", "3.5.11"),
    _m(23, F.HEIGHT_SETPOINT, "", "3.5"),
    _m(26, F.CLAMP_ON, "", "3.5.10"),
    _m(27, F.CLAMP_OFF, "", "3.5.10"),
    _m(80, F.DRIVES_ON, "", "3.5.8"),
    _m(81, F.DRIVES_OFF, "", "3.5.8"),
    _m(100, F.AXIS_RESOLUTION, "", "3.5.12"),
    _m(104, F.TEMPERATURE, "", "3.5.12", value=0),
    _m(106, F.FAN_ON, "", "3.5.12"),
    _m(107, F.FAN_OFF, "", "3.5.12"),
    _m(109, F.TEMPERATURE_WAIT, "", "3.5.12", value=0),
    _m(140, F.TEMPERATURE, "", "3.5.12", value=1),
    _m(143, F.TEMPERATURE, "", "3.5.12", value=2),
    _m(190, F.TEMPERATURE_WAIT, "", "3.5.12", value=1),
    _m(48, F.OVERRIDES_ON, "M9", "3.5.5"),
    _m(49, F.OVERRIDES_OFF, "M9", "3.5.5"),
    _m(50, F.FEED_OVERRIDE, "M9", "3.5.5"),
    _m(51, F.SPEED_OVERRIDE, "M9", "3.5.5"),
    _m(52, F.FEED_OVERRIDE_INPUT, "M9", "3.5.5"),
    _m(53, F.FEED_HOLD_INPUT, "", "3.5.5"),
    _m(84, F.DIRECTION_OUTPUT_ON, "", "3.5.8"),
    _m(85, F.DIRECTION_OUTPUT_OFF, "", "3.5.8"),
    _m(86, F.SPEED_OUTPUT_ON, "", "3.5.8"),
    _m(87, F.SPEED_OUTPUT_OFF, "", "3.5.8"),
    *(_m(n, F.HEAD, "M10", "3.5.6", value=head) for n, head in ((90, 0), (91, 1), (92, 2))),
    _m(93, F.HEAD, "M10", "3.5, table 3-6", value=2),
    _m(95, F.HEAD, "M10", "2.1.19", value=4),
    _m(97, F.HEAD, "M10", "2.1.20", value=5),
)

# Codes that the manual names and does not describe.
_NAMED_ONLY = "table 3-3 lists it with the inputs and outputs, and the manual does not say what it does"
_UNSUPPORTED = (
    *(_m(n, F.UNSUPPORTED, "M5", "table 3-3", reason=_NAMED_ONLY) for n in (64, 65, 66)),
    _m(
        22,
        F.UNSUPPORTED,
        "",
        "table 3-6",
        reason="its text in table 3-6 is that of M23, and 3.5.11 has only M20 and M21",
    ),
)


def _p(first: int, last: int, kind: str, meaning: str, writable: bool = True) -> ParameterRange:
    return ParameterRange(first=first, last=last, kind=kind, meaning=meaning, source="3.1.1", writable=writable)


_LISTED = (
    _p(1, 3999, "free", "free"),
    _p(4000, 4999, "persistent", "free, persistent"),
    _p(5001, 5006, "position", "work position", writable=False),
    _p(5008, 5008, "tool", "actual tool", writable=False),
    _p(5009, 5009, "tool_radius", "actual tool radius", writable=False),
    _p(5010, 5010, "tool_z", "actual tool length", writable=False),
    _p(5011, 5011, "new_tool", "new tool during tool change", writable=False),
    _p(5012, 5012, "tool_x", "actual tool X offset", writable=False),
    _p(5013, 5013, "offset_z", "active length offset", writable=False),
    _p(5014, 5014, "offset_x", "active X offset", writable=False),
    _p(5015, 5050, "free", "used in tool change subprograms"),
    _p(5051, 5056, "probe_machine", "probe contact, machine coordinates", writable=False),
    _p(5061, 5066, "probe_work", "probe contact, work coordinates", writable=False),
    _p(5067, 5067, "probe_hit", "1 when the probe has touched", writable=False),
    _p(5068, 5068, "probe_input", "the probe's input", writable=False),
    _p(5069, 5069, "hand_wheel", "hand wheel counter", writable=False),
    _p(5071, 5076, "machine_position", "machine position", writable=False),
    _p(5081, 5086, "probe_machine", "probe contact, joint coordinates", writable=False),
    _p(5101, 5106, "lower_limit", "machine area, negative limits", writable=False),
    _p(5111, 5116, "upper_limit", "machine area, positive limits", writable=False),
    _p(5121, 5126, "home_position", "home position", writable=False),
    _p(5131, 5133, "area_lower", "tool change area, negative limits", writable=False),
    _p(5141, 5143, "area_upper", "tool change area, positive limits", writable=False),
    _p(5150, 5150, "kinematics", "active kinematics", writable=False),
    _p(5151, 5151, "height_map", "height compensation is on", writable=False),
    _p(5161, 5166, "park_1", "G28 position"),
    _p(5181, 5186, "park_2", "G30 position"),
    _p(5211, 5216, "g92", "G92 offset"),
    _p(5220, 5220, "work_number", "active coordinate system", writable=False),
    *(_p(5221 + 20 * k, 5226 + 20 * k, "work", f"coordinate system {k + 1}") for k in range(9)),
    *(_p(5230 + 20 * k, 5230 + 20 * k, "rotation", "reserved for a rotation", writable=False) for k in range(8)),
    _p(5380, 5380, "simulation", "simulation mode", writable=False),
    _p(5390, 5390, "head", "spindle selection", writable=False),
    _p(5391, 5393, "head_offset", "offset of the alternate spindle", writable=False),
    _p(5394, 5396, "head_speed", "highest speed of each spindle", writable=False),
    _p(5397, 5397, "rendering", "rendering", writable=False),
    _p(5398, 5399, "free", "answers of dialogs and inputs"),
    _p(5401, 5499, "tool_length", "tool length"),
    _p(5501, 5599, "tool_diameter", "tool diameter"),
    _p(5601, 5699, "tool_x_offset", "tool X offset"),
    _p(5701, 5799, "tool_orientation", "tool orientation"),
    # The lists of the tool table start with tool 1, and the sentence below them with tool 0.
    *(_p(number, number, "tool_zero", "the number before those of tool 1") for number in range(5400, 5701, 100)),
    _p(5800, 5999, "later", "not in the manual, which lists numbers up to 5799"),
)


FREE = "free, as all that the list leaves out up to 5399"
_HIGHEST_FREE = 5399  # 3.2.2.2


def _gaps(listed: tuple[ParameterRange, ...]) -> tuple[ParameterRange, ...]:
    """What 3.1.1 says of all other parameters: they are free."""
    rows: list[ParameterRange] = []
    following = 1
    for row in sorted(listed, key=lambda each: each.first):
        if following < row.first <= _HIGHEST_FREE:
            rows.append(_p(following, row.first - 1, "free", FREE))
        following = row.last + 1
    return tuple(rows)


_PARAMETERS = (*_LISTED, *_gaps(_LISTED))

EDING = LanguageRules(
    name="eding",
    codes={(rule.letter, rule.tenths): rule for rule in (*_SUPPORTED, *_UNSUPPORTED)},
    parameters=_PARAMETERS,
    highest_parameter=5999,
    arc_tolerance_mm=0.002,  # 3.4.3.2
    arc_tolerance_inch=0.0002,  # 3.4.3.2
    line_length=256,  # 3.2
    m_codes_in_line=4,  # 3.2.5
    highest_tool=99,  # 3.1.2
    integer_tolerance=0.0001,  # 3.2.2.1
    peck_clearance_mm=0.254,  # 3.4.21.4 says "a bit"; the value is that of RS274/NGC, 0.010 inch
    call_depth=50,
    straight_traverse=True,  # 3.4.1: coordinated linear motion
    later=frozenset({("G", 370)}),  # V4.03 measures a tool with it
)
