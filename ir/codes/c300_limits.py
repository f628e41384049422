"""Finding codes 3xx: limits and areas."""

from __future__ import annotations

from gproof.ir.codes.declared import code, saying
from gproof.ir.finding import Severity

_E, _U, _W, _N = Severity.ERROR, Severity.UNKNOWN, Severity.WARNING, Severity.NOTE

ONLY_SUBPROGRAMS = code(340, "only-subprograms", _W, "the file contains only subprograms: nothing was executed")
SOFT_LIMIT = code(
    301,
    "soft-limit",
    _E,
    "{axis} would reach {reached:.3f} {unit}, {over:.3f} {unit} past its {side} travel limit of {limit:.3f} {unit}",
    "limits",
)
LIMIT_UNKNOWN = code(302, "limit-unknown", _U, "the machine file gives no {side} travel limit for {axis}", "limits")
LIMIT_WITHOUT_MACHINE = saying(LIMIT_UNKNOWN, "without a machine file no {side} travel limit is known for {axis}")
NO_SAFE_OFFSET = code(
    303,
    "no-safe-offset",
    _E,
    "no {name} makes the job fit: it spans {extent:.3f} {unit}, and the axis has {room:.3f} {unit}",
    "limits",
)
NEVER_FITS = saying(
    NO_SAFE_OFFSET,
    "whatever {name} is, the job does not fit: it spans {extent:.3f} {unit}, and the axis has {room:.3f} {unit}",
)
OFFSET_TOO_LARGE = saying(
    NO_SAFE_OFFSET,
    "{name} leaves no room for the job: it is at least {extent:.3f} {unit}, and at most {room:.3f} {unit} is safe",
)
OFFSET_TOO_SMALL = saying(
    NO_SAFE_OFFSET,
    "{name} leaves no room for the job: it is at most {extent:.3f} {unit}, and at least {room:.3f} {unit} is safe",
)
POSITION_UNKNOWN = code(304, "position-unknown", _U, "the position of {axis} depends on {cause}", "limits")
START_OUTSIDE_LIMITS = code(
    306,
    "start-outside-limits",
    _E,
    "the start position {axis} {value:.3f} {unit} is outside the travel limits",
    "limits",
)
SOFT_LIMIT_GUARD_OFF = code(
    307,
    "soft-limit-guard-off",
    _W,
    "{axis} moves to {reached:.3f} {unit}, past its {side} travel limit of {limit:.3f} {unit}, with soft limits "
    "switched off",
    "limits",
)
TOOL_CHANGE_AREA = code(310, "tool-change-area", _E, "the path enters the tool change area at {where}", "areas")
KEEP_OUT_ZONE = code(
    336,
    "keep-out-zone",
    _E,
    'the path enters the keep-out zone "{name}" by {depth:.3f} mm at {where}',
    "areas",
)
KEEP_OUT_UNKNOWN = code(
    337, "keep-out-unknown", _U, 'whether the path enters the keep-out zone "{name}" depends on {cause}', "areas"
)
TOOL_CHANGE_AREA_UNKNOWN = code(
    311,
    "tool-change-area-unknown",
    _U,
    "whether the path enters the tool change area depends on {cause}",
    "areas",
)
TOOL_CHANGE_AREA_GUARD_OFF = code(
    312,
    "tool-change-area-guard-off",
    _N,
    "the path enters the tool change area while its guard is switched off",
    "areas",
)
GUARD_OFF_STRETCH = code(
    338, "guard-off-stretch", _N, "{guards}: off from here to line {last}, during {moves}{where}", "limits"
)
TOOL_CHANGE_TOO_LOW = code(
    339,
    "tool-change-too-low",
    _E,
    "{what} at Z{z:.3f} mm, {under:.3f} mm below the clearance height of {clear:.3f} mm",
    "areas",
)
TOOL_CHANGE_HEIGHT_UNKNOWN = code(
    341,
    "tool-change-height-unknown",
    _U,
    "{what} at a height that depends on {cause}; Z must be at least {clear:.3f} mm",
    "areas",
)
MOTOR_LIMIT = code(
    320,
    "motor-limit",
    _U,
    "{axis} at {reached:.3f} {unit} is inside its {side} travel limit of {limit:.3f} {unit}, but {what} may move "
    "its motor past it",
    "limits",
)
MAPPED_AXIS = code(321, "mapped-axis", _U, "Y is mapped onto A: {what}", "limits")
HEIGHT_MAP_UNKNOWN = code(322, "height-map-unknown", _U, "height compensation: {what}", "limits")
KNIFE_UNKNOWN = code(323, "knife-unknown", _U, "tangential knife: {what}", "limits")
BOUNDARY_EXCEEDED = code(
    330,
    "boundary-exceeded",
    _E,
    "{axis} would reach {reached:.3f} {unit} in its workspace, {over:.3f} {unit} past its {side} boundary of "
    "{limit:.3f} {unit}",
    "limits",
)
FORCED_LIMIT_EXCEEDED = code(
    331,
    "forced-limit-exceeded",
    _E,
    "{axis} would reach {reached:.3f} {unit}, {over:.3f} {unit} past the forced {side} limit of {limit:.3f} {unit}",
    "limits",
)
BOUNDARY_GUARD_OFF = code(
    332,
    "boundary-guard-off",
    _W,
    "{axis} moves to {reached:.3f} {unit} in its workspace, past its {side} boundary of {limit:.3f} {unit}, {why}",
    "limits",
)
LIMIT_ADJUSTED = code(
    333,
    "limit-adjusted",
    _W,
    "the controller moves {axis} only to its {side} {kind} at {limit:.3f} {unit}, not to {wanted:.3f} {unit} as "
    "programmed",
    "limits",
)
OFFSET_KEPT = code(
    335, "offset-kept", _W, "{code} gives {axes} a new machine zero while {what} in force: it is kept", "limits"
)
MACHINE_ZERO_MOVED = code(
    334,
    "machine-zero-moved",
    _U,
    "{code} on an axis that has followed another one: its machine zero and its limits are unknown after it",
    "limits",
)
