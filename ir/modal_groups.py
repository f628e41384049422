"""What each function may change, by modal group, and which groups it states whole: one table for all dialects.

A line that is refused or not understood may have changed these; ``passes/interpret/core/refused_lines.py`` is based on
it. The names of groups are words for messages. A function without a row may have changed anything.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache

from gproof.ir.rules import Function as F
from gproof.ir.rules import LanguageRules

PLACE, MOTION, FEED, SPINDLE, SPEED, TOOL = "place", "motion", "feed", "spindle", "spindle speed", "tool"
UNITS, DISTANCES, PLANE, FEED_MODE, PATH, RETRACT = (
    "units", "distances", "plane", "feed mode", "path mode", "return of cycles",
)  # fmt: skip
WORK, LOCAL, LENGTH, RADIUS = "work offset", "local offset", "tool length", "radius compensation"
ROTATION, SCALING, REFLECTION, FACTORS = "rotation", "scaling", "reflection", "mirror factors"
MAPPING, COUPLING, LOCKS, AXES, CYLINDER, SPLINE, CENTERS = (
    "mapping of axes", "coupling of axes", "locks of axes", "interpolation axes", "effective radius", "spline",
    "arc centres",
)  # fmt: skip
GUARDS, LOW, HIGH, CLAMP, DRIVES, HEAD, RESOLUTION = (
    "limit switches", "low boundaries", "high boundaries", "clamp", "drives", "head", "resolution of axes",
)  # fmt: skip
OVERRIDE, COOLANT, KNIFE, SAW, HEIGHT, MEASURES, DYNAMICS, BACKLASH, VARIABLES, MAP, OUTPUTS, MACHINE_ZERO = (
    "feed override", "coolant", "knife", "saw", "height control", "stored measures", "dynamics", "backlash",
    "variables", "axis map", "outputs", "machine zero",
)  # fmt: skip

MOVES = frozenset((
    F.TRAVERSE, F.FEED, F.ARC_CW, F.ARC_CCW, F.DRILL, F.DRILL_DWELL, F.DRILL_PECK, F.DRILL_CHIP_BREAK, F.BORE,
    F.BORE_STOP, F.BORE_DWELL, F.BORE_BACK, F.BORE_MANUAL, F.TAP_RIGHT, F.TAP_LEFT, F.PROBE, F.SYNCHRONISED,
    F.SYNCHRONISED_RETURN, F.THREADING, F.TRAVERSE_LIFTED, F.MACHINE_TRAVERSE, F.PARK_1, F.PARK_2,
))  # fmt: skip
"""Functions that send axes somewhere by words read in the modes in force."""

_NOTHING: tuple[str, ...] = ()

CHANGES: dict[F, tuple[str, ...]] = {
    **dict.fromkeys(MOVES, (PLACE, MOTION)),
    F.MOTION_CANCEL: (MOTION,),
    F.DWELL: _NOTHING,
    F.SET_COORDINATES: (WORK,),
    F.PLANE_XY: (PLANE,), F.PLANE_XZ: (PLANE,), F.PLANE_YZ: (PLANE,),
    F.UNITS_INCH: (UNITS, FEED), F.UNITS_MM: (UNITS, FEED), F.UNITS_CM: (UNITS, FEED), F.UNITS_LAST: (UNITS, FEED),
    F.COMPENSATION_OFF: (RADIUS,), F.COMPENSATION_LEFT: (RADIUS,), F.COMPENSATION_RIGHT: (RADIUS,),
    F.TOOL_OFFSET_ON: (LENGTH,), F.TOOL_OFFSET_DYNAMIC: (LENGTH,), F.TOOL_OFFSET_OFF: (LENGTH,),
    F.MACHINE_COORDINATES: _NOTHING,
    F.SELECT_COORDINATES: (WORK,),
    F.WORKSPACE: (WORK, PLACE),
    F.EXACT_PATH: (PATH,), F.EXACT_STOP: (PATH,), F.CONTINUOUS: (PATH,),
    F.ABSOLUTE: (DISTANCES,), F.INCREMENTAL: (DISTANCES,),
    F.ABSOLUTE_ONCE: _NOTHING, F.INCREMENTAL_ONCE: _NOTHING,
    F.AXIS_OFFSET_SET: (LOCAL,), F.AXIS_OFFSET_RESET: (LOCAL,), F.AXIS_OFFSET_SUSPEND: (LOCAL,),
    F.AXIS_OFFSET_RESTORE: (LOCAL,),
    F.FEED_INVERSE_TIME: (FEED_MODE, FEED), F.FEED_PER_MINUTE: (FEED_MODE, FEED),
    F.FEED_PER_REVOLUTION: (FEED_MODE, FEED),
    F.RETRACT_INITIAL: (RETRACT,), F.RETRACT_R: (RETRACT,),
    **dict.fromkeys((F.STOP, F.OPTIONAL_STOP, F.END, F.END_RESET, F.STOP_KEEP), _NOTHING),
    **dict.fromkeys((F.SPINDLE_CW, F.SPINDLE_CCW, F.SPINDLE_OFF), (SPINDLE,)),
    F.TOOL_CHANGE: (TOOL, LENGTH, RADIUS, SPINDLE, PLACE),
    F.MIST_ON: (COOLANT,), F.FLOOD_ON: (COOLANT,), F.COOLANT_OFF: (COOLANT,),
    F.OVERRIDES_ON: (OVERRIDE,), F.OVERRIDES_OFF: (OVERRIDE,),
    **dict.fromkeys((
        F.OUTPUT_ON, F.OUTPUT_OFF, F.OUTPUT_WORD, F.OUTPUT_ON_MOVING, F.OUTPUT_OFF_MOVING, F.ANALOG, F.DEVICE,
        F.VIRTUAL_ON, F.VIRTUAL_OFF, F.FAN_ON, F.FAN_OFF, F.TEMPERATURE, F.TEMPERATURE_WAIT, F.SHELL,
        F.AUTO_OUTPUT_ON, F.AUTO_OUTPUT_OFF, F.DIRECTION_OUTPUT_ON, F.DIRECTION_OUTPUT_OFF, F.SPEED_OUTPUT_ON,
        F.SPEED_OUTPUT_OFF,
    ), (OUTPUTS, SPINDLE)),
    F.INPUT_READ: (VARIABLES,),
    F.ROTATION_ON: (ROTATION,), F.ROTATION_OFF: (ROTATION,), F.ROTATION_LINE: (ROTATION,),
    F.SCALING_ON: (SCALING,), F.SCALING_OFF: (SCALING,), F.TRANSFORM_OFF: (ROTATION, SCALING),
    F.HEIGHT_CONTROL: (HEIGHT, PLACE), F.HEIGHT_SETPOINT: (HEIGHT,), F.HEIGHT_ON: (HEIGHT, PLACE),
    F.HEIGHT_OFF: (HEIGHT, PLACE), F.TORCH_ON: (HEIGHT, PLACE, OUTPUTS), F.TORCH_OFF: (HEIGHT, PLACE, OUTPUTS),
    F.CLAMP_ON: (CLAMP,), F.CLAMP_OFF: (CLAMP,),
    F.DRIVES_ON: (DRIVES, PLACE), F.DRIVES_OFF: (DRIVES, PLACE),
    F.AXIS_RESOLUTION: (RESOLUTION, PLACE),
    F.SURFACE_SPEED: (SPINDLE, SPEED, FEED), F.SPINDLE_RPM: (SPINDLE, SPEED, FEED),
    F.FEED_OVERRIDE: (OVERRIDE, FEED), F.SPEED_OVERRIDE: (OVERRIDE, SPEED), F.FEED_OVERRIDE_INPUT: (OVERRIDE, FEED),
    F.FEED_HOLD_INPUT: (OVERRIDE,),
    F.HEAD: (HEAD, SPINDLE),
    F.SMOOTHING: (PATH,), F.STOP_PARSING: _NOTHING,
    F.HOME: (PLACE,),
    F.LOCAL_SET: (LOCAL,), F.LOCAL_SHIFT_MACHINE: (LOCAL,), F.LOCAL_SHIFT: (LOCAL,), F.LOCAL_SWITCH: (LOCAL,),
    F.LOCAL_CROSSING: (LOCAL,),
    F.FEED_ROTARY: (FEED, FEED_MODE),
    F.DIALOG: _NOTHING,
    F.STORE_REGISTER: (MEASURES, VARIABLES), F.LOAD_REGISTERS: (MEASURES, VARIABLES),
    F.STORE_HOME: (MEASURES,), F.RETURN_HOME: (PLACE,),
    F.DYNAMICS: (DYNAMICS,),
    F.BACKLASH: (BACKLASH,),
    F.ARRAY: (PLACE,),
    F.MAP_WORDS: (MAPPING,), F.MAP_HEADS: (MAPPING,), F.MAP_PULSES: (COUPLING,),
    F.LIMITS_ON: (GUARDS,), F.LIMITS_OFF: (GUARDS,),
    F.LOW_BOUNDARY: (LOW,), F.LOW_BOUNDARY_RESTORE: (LOW,),
    F.HIGH_BOUNDARY: (HIGH,), F.HIGH_BOUNDARY_RESTORE: (HIGH,),
    F.SET_MACHINE: (PLACE, MACHINE_ZERO), F.WRAP_ROTARY: (PLACE,),
    F.KNIFE_ON: (KNIFE, PLACE), F.KNIFE_OFF: (KNIFE, PLACE), F.KNIFE_SETTING: (KNIFE,),
    F.SAW_ON: (SAW, PLACE), F.SAW_OFF: (SAW, PLACE),
    F.LEVEL_HEADS: (PLACE,),
    F.MEASURE_SURFACE: (PLACE, LOCAL, LENGTH), F.MEASURE_DEPTH: (PLACE, LOCAL, LENGTH),
    F.KEEP_LOCAL: (LOCAL,),
    F.TOOL_NUMBER: (TOOL, LENGTH),
    F.CONDITION: _NOTHING,
    F.LOCK_AXIS: (LOCKS,), F.UNLOCK_AXIS: (LOCKS,),
    F.RECALL_POSITIONS: (PLACE,), F.STORE_POSITION: (MEASURES,), F.STORE_TOOL: (MEASURES, LENGTH),
    F.STORE_LOCAL_POSITION: (MEASURES,),
    F.WAIT_ON: _NOTHING, F.WAIT_OFF: _NOTHING,
    F.LIMIT_STOPS_AXIS: (PLACE,), F.LIMIT_STOPS_LINE: (PLACE,),
    F.MEASURE_TOOL: (LENGTH,), F.MEASURE_SWITCH: (MEASURES,), F.SHIFT_MEASURES: (LENGTH, MEASURES, WORK),
    F.ABORT: _NOTHING,
    F.PROBE_ON: _NOTHING, F.PROBE_OFF: _NOTHING,
    F.REFLECT: (REFLECTION,), F.REFLECT_OFF: (REFLECTION, FACTORS), F.POSITION_FACTOR: (FACTORS,),
    F.EFFECTIVE_RADIUS: (CYLINDER,),
    F.ZERO_OFFSET_OFF: (WORK, DISTANCES), F.ZERO_OFFSET_SET: (WORK,), F.ZERO_OFFSET_RESTORE: (WORK,),
    F.ZERO_OFFSET_READ: (VARIABLES,),
    F.INTERPOLATION_AXES: (AXES,),
    F.LIMIT_LEFT: (LOW,), F.LIMIT_RIGHT: (HIGH,),
    F.SPLINE_OFF: (SPLINE,), F.SPLINE_ON: (SPLINE,),
    F.CENTERS_ABSOLUTE: (CENTERS,), F.CENTERS_RELATIVE: (CENTERS,),
    F.SAVE_VARIABLE: (VARIABLES,), F.RESTORE_VARIABLE: (VARIABLES,),
    F.MAP_ADJUSTMENT: (MAP, PLACE),
}  # fmt: skip
"""By function the groups that it may change. ``CALL``, ``RETURN``, ``JUMP``, ``APPLICATION`` and ``UNSUPPORTED``, which
have no row, may change all of them: what would have run is not known."""

STATES: dict[F, tuple[str, ...]] = {
    F.PLANE_XY: (PLANE,), F.PLANE_XZ: (PLANE,), F.PLANE_YZ: (PLANE,),
    F.UNITS_INCH: (UNITS,), F.UNITS_MM: (UNITS,), F.UNITS_CM: (UNITS,),
    F.ABSOLUTE: (DISTANCES,), F.INCREMENTAL: (DISTANCES,),
    F.SELECT_COORDINATES: (WORK,), F.WORKSPACE: (WORK,),
    F.AXIS_OFFSET_RESET: (LOCAL,), F.AXIS_OFFSET_SUSPEND: (LOCAL,),
    F.ZERO_OFFSET_OFF: (WORK,),
    F.TOOL_OFFSET_OFF: (LENGTH,),
    F.COMPENSATION_OFF: (RADIUS,),
    F.ROTATION_OFF: (ROTATION,), F.SCALING_OFF: (SCALING,), F.TRANSFORM_OFF: (ROTATION, SCALING),
    F.REFLECT_OFF: (REFLECTION,),
    F.SPLINE_OFF: (SPLINE,),
    F.CENTERS_ABSOLUTE: (CENTERS,), F.CENTERS_RELATIVE: (CENTERS,),
    F.FEED_INVERSE_TIME: (FEED_MODE,), F.FEED_PER_MINUTE: (FEED_MODE,), F.FEED_PER_REVOLUTION: (FEED_MODE,),
    F.RETRACT_INITIAL: (RETRACT,), F.RETRACT_R: (RETRACT,),
    F.EXACT_PATH: (PATH,), F.EXACT_STOP: (PATH,), F.CONTINUOUS: (PATH,),
    F.SPINDLE_CW: (SPINDLE,), F.SPINDLE_CCW: (SPINDLE,), F.SPINDLE_OFF: (SPINDLE,),
    F.MOTION_CANCEL: (MOTION,),
    F.LIMITS_ON: (GUARDS,), F.LIMITS_OFF: (GUARDS,),
    F.LOW_BOUNDARY_RESTORE: (LOW,), F.HIGH_BOUNDARY_RESTORE: (HIGH,),
    F.CLAMP_OFF: (CLAMP,), F.CLAMP_ON: (CLAMP,),
    F.KNIFE_OFF: (KNIFE,), F.SAW_OFF: (SAW,), F.HEIGHT_OFF: (HEIGHT,),
    F.MAP_WORDS: (MAPPING,), F.MAP_HEADS: (MAPPING,), F.MAP_PULSES: (COUPLING,), F.UNLOCK_AXIS: (LOCKS,),
    F.LOCAL_SET: (LOCAL,), F.LOW_BOUNDARY: (LOW,), F.HIGH_BOUNDARY: (HIGH,),
    F.HEAD: (HEAD,), F.INTERPOLATION_AXES: (AXES,),
    F.HOME: _NOTHING, F.TOOL_CHANGE: _NOTHING, F.TOOL_OFFSET_ON: _NOTHING, F.RETURN_HOME: _NOTHING,
}  # fmt: skip
"""By function the groups that are known again after it, whatever they were before; of one that takes axis words only
where it has none (``WITH_WORDS``: with them). With an empty row it rests on no group that words are read in."""
WITH_WORDS = frozenset((F.INTERPOLATION_AXES,))

VALUES = frozenset((
    PLACE, MOTION, FEED, SPEED, SPINDLE, TOOL, OVERRIDE, COOLANT, FACTORS, MEASURES, VARIABLES,
))  # fmt: skip
"""Groups that are values by themselves: known again as soon as something gives a new one."""

ORDER = (
    UNITS, DISTANCES, WORK, LOCAL, LENGTH, RADIUS, ROTATION, SCALING, REFLECTION, MAPPING, COUPLING, LOCKS, AXES,
    CYLINDER, SPLINE, LOW, HIGH, CLAMP, HEAD, RESOLUTION, KNIFE, SAW, HEIGHT, BACKLASH, MAP, MACHINE_ZERO,
)  # fmt: skip
"""Groups on which it rests where axis words send a straight move, or what holds there, in the order of messages."""
OF_PLACES = frozenset(ORDER)
OF_ORIGINS = OF_PLACES - {DISTANCES, LOW, HIGH, CLAMP, BACKLASH, LOCKS, AXES, SPLINE}
"""Groups on which it rests where the program's zero is, and in what it counts."""
OF_MACHINE_PLACES = OF_PLACES - {WORK, LOCAL, LENGTH, HEAD}
"""The same for words that are machine coordinates."""
OF_ARCS = frozenset((PLANE, RETRACT, CENTERS))
"""Groups on which it rests besides where words of arcs and cycles send the axes."""
OF_FEEDS = frozenset((UNITS, FEED_MODE))
"""Groups in which the number of an F counts."""
TRACKED = OF_PLACES | {PLANE, RETRACT, CENTERS, MOTION, SPINDLE, FEED_MODE}
"""Groups that stay lost until a code states them."""


def changed_by(functions: Iterable[F]) -> frozenset[str] | None:
    """The groups that codes of these functions may change; None for one that may change all."""
    found = frozenset[str]()
    for function in functions:
        if function not in CHANGES:
            return None
        found |= set(CHANGES[function])
    return found


@lru_cache(maxsize=8)
def everything(rules: LanguageRules) -> frozenset[str]:
    """What a text that nobody understands may have changed: the groups that codes of the language change.

    Of those that are no values by themselves the ones that some code states whole: what it takes to know them again.
    """
    functions = {rule.function for rule in rules.codes.values()}
    changed = {group for function in functions for group in CHANGES.get(function, ())}
    stated = {group for function in functions for group in STATES.get(function, ())}
    return frozenset(changed & (stated | VALUES)) | {PLACE, MOTION, FEED, SPEED, TOOL}
