"""Finding codes 3xx: limits and areas."""

from __future__ import annotations

from gproof.ir.codes.declared import code
from gproof.ir.finding import Severity

_E, _U, _W, _N = Severity.ERROR, Severity.UNKNOWN, Severity.WARNING, Severity.NOTE

ONLY_SUBPROGRAMS = code(340, "only-subprograms", _W, "the file holds only subprograms: nothing of it was executed")
SOFT_LIMIT = code(
    301,
    "soft-limit",
    _E,
    "{axis} would reach {reached:.4f} {unit}, {over:.4f} past its {side} limit {limit:.4f}",
    "limits",
)
LIMIT_UNKNOWN = code(302, "limit-unknown", _U, "no {side} limit of {axis} is known", "limits")
NO_SAFE_OFFSET = code(
    303,
    "no-safe-offset",
    _E,
    "{what} {extent:.4f} {unit} and {other} {room:.4f}",
    "limits",
)
POSITION_UNKNOWN = code(304, "position-unknown", _U, "the position of {axis} depends on {cause}", "limits")
START_OUTSIDE_LIMITS = code(
    306, "start-outside-limits", _E, "the stated start {axis} {value:.4f} {unit} lies outside its limits", "limits"
)
SOFT_LIMIT_GUARD_OFF = code(
    307,
    "soft-limit-guard-off",
    _W,
    "{axis} goes to {reached:.4f} {unit}, past its {side} limit {limit:.4f}, with the guard off",
    "limits",
)
TOOL_CHANGE_AREA = code(310, "tool-change-area", _E, "the path enters the tool change area at {where}", "areas")
KEEP_OUT_ZONE = code(
    336,
    "keep-out-zone",
    _E,
    "the path enters the keep-out zone {name} at {where}, and goes {depth:.4f} mm into it",
    "areas",
)
KEEP_OUT_UNKNOWN = code(
    337, "keep-out-unknown", _U, "whether the path enters the keep-out zone {name} depends on {cause}", "areas"
)
TOOL_CHANGE_AREA_UNKNOWN = code(
    311,
    "tool-change-area-unknown",
    _U,
    "whether the path enters the tool change area depends on {cause}",
    "areas",
)
TOOL_CHANGE_AREA_GUARD_OFF = code(
    312, "tool-change-area-guard-off", _N, "the path enters the tool change area with its guard off", "areas"
)
GUARD_OFF_STRETCH = code(
    338, "guard-off-stretch", _N, "{guards}: off from here to line {last}, for {moves}{where}", "limits"
)
TOOL_CHANGE_TOO_LOW = code(
    339,
    "tool-change-too-low",
    _E,
    "{what} at Z {z:.4f} mm, {under:.4f} mm under the clearance height {clear:.4f}",
    "areas",
)
TOOL_CHANGE_HEIGHT_UNKNOWN = code(
    341,
    "tool-change-height-unknown",
    _U,
    "{what} at a height that depends on {cause}; Z must be at {clear:.4f} mm at least",
    "areas",
)
MOTOR_LIMIT = code(
    320,
    "motor-limit",
    _U,
    "{axis} at {reached:.4f} {unit} is inside its {side} limit {limit:.4f}, but {what} may carry its motor past it",
    "limits",
)
MAPPED_AXIS = code(321, "mapped-axis", _U, "Y is mapped onto A, and {what}", "limits")
HEIGHT_MAP_UNKNOWN = code(322, "height-map-unknown", _U, "height compensation: {what}", "limits")
KNIFE_UNKNOWN = code(323, "knife-unknown", _U, "tangential knife: {what}", "limits")
BOUNDARY_EXCEEDED = code(
    330,
    "boundary-exceeded",
    _E,
    "{axis} would reach {reached:.4f} {unit} in its workspace, {over:.4f} past its {side} boundary {limit:.4f}",
    "limits",
)
FORCED_LIMIT_EXCEEDED = code(
    331,
    "forced-limit-exceeded",
    _E,
    "{axis} would reach {reached:.4f} {unit}, {over:.4f} past the forced {side} limit {limit:.4f}",
    "limits",
)
BOUNDARY_GUARD_OFF = code(
    332,
    "boundary-guard-off",
    _W,
    "{axis} goes to {reached:.4f} {unit} in its workspace, past its {side} boundary {limit:.4f}, {why}",
    "limits",
)
LIMIT_ADJUSTED = code(
    333,
    "limit-adjusted",
    _W,
    "the controller lets {axis} go to its {side} {kind} {limit:.4f} {unit} only, not to {wanted:.4f} as programmed",
    "limits",
)
OFFSET_KEPT = code(
    335, "offset-kept", _W, "{code} gives {axes} another machine zero, and {what} in force there: it is kept", "limits"
)
MACHINE_ZERO_MOVED = code(
    334,
    "machine-zero-moved",
    _U,
    "{code} of an axis that has followed another one: where machine zero and the limits are then is not known",
    "limits",
)
