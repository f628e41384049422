"""Finding codes 5xx: motion and time."""

from __future__ import annotations

from gproof.ir.codes.declared import code
from gproof.ir.finding import Severity

_E, _U, _W, _N = Severity.ERROR, Severity.UNKNOWN, Severity.WARNING, Severity.NOTE

FEED_OVER_MAXIMUM = code(
    501, "feed-over-maximum", _W, "feed {feed:g} {unit}/min is more than the axes allow here", "feeds"
)
STEP_FREQUENCY = code(
    502,
    "step-frequency",
    _W,
    "{axis} at {velocity:g} {unit}/s needs {needed:g} steps/s; at most {allowed:g} steps/s are allowed",
    "motion",
)
PLAN_NEEDS_NUMBERS = code(503, "plan-needs-numbers", _U, "steps need exact numbers: {cause}", "motion")
NO_MOTOR_DATA = code(504, "no-motor-data", _U, "{axis} moves, but the machine file has no {missing} for it", "motion")
DRILL_SETTING_OPEN = code(512, "drill-setting-open", _W, "drilling cycle {code}: {what}", "motion")
VELOCITY_ZERO = code(505, "velocity-zero", _E, "{code} with a velocity of 0: the controller stops the program", "feeds")
SYNCHRONISED_TOO_FAST = code(
    510,
    "synchronised-too-fast",
    _E,
    "{code}: {pitch:g} mm/rev at {rpm:g} rpm needs {needed:g} mm/min of {axis}, {over:g} mm/min over its maximum of "
    "{allowed:g} mm/min",
)
SYNCHRONISED_STREAM = code(
    511, "synchronised-stream", _U, "{what}: a step stream has fixed timing and cannot do this", "motion"
)
NOT_STEPPED = code(520, "not-stepped", _U, "{what}: gproof makes no steps for this", "motion")
HEIGHT_JUMP = code(
    521, "height-jump", _U, "Z would have to jump by {jump:.3f} mm where the height map ends or is switched", "motion"
)
ENDLESS_LOOP = code(506, "endless-loop", _W, "the program reaches this line again in the same state: it never ends")
ALIKE_PASSES = code(
    522,
    "alike-passes",
    _N,
    "from pass {done} on all passes of this loop are alike: too many to follow, so it may end after any of them",
)
CONTOUR_BREAK = code(513, "contour-break", _N, "{code} ends the contour: the axes stop before it", "motion")
TASK_UNKNOWN = code(
    514,
    "task-unknown",
    _U,
    "{code}: the machine file does not say what Task 0 does for it: the axis positions after it are unknown",
    "limits",
)
MODULE_END = code(
    515, "module-end", _U, "{name} ends without M02, M30 or M17: the manual does not say what runs after it"
)
MAINTAINED_OFFSET = code(
    517, "maintained-offset", _W, "axis words alone continue {code}: they set the zero offset and move nothing"
)
FEED_UNKNOWN = code(518, "feed-unknown", _U, "{code}: the feed depends on {cause}", "feeds")
NO_WAY = code(
    519, "no-way", _W, "{code} moves nothing: the controller reports a move without a path (status 80, 20 hex)"
)
# 53x, 54x: reported when the properties cutting and feeds are required (docs/cutting-sense.md)
SPINDLE_AT_REST = code(
    530, "spindle-at-rest", _E, "feed moves while the spindle is stopped (moves: {moves})", "cutting"
)
SPINDLE_NOT_TOLD = code(
    531, "spindle-not-told", _U, "feed moves, and it is unknown whether the spindle turns (moves: {moves})", "cutting"
)
SPINDLE_SPEED_NOT_TOLD = code(
    532, "spindle-speed-not-told", _U, "feed moves at an unknown spindle speed (moves: {moves})", "cutting"
)
NO_TOOL = code(533, "no-tool", _E, "feed moves without a tool in the spindle (moves: {moves})", "cutting")
TOOL_TOO_FAST = code(
    534,
    "tool-too-fast",
    _E,
    "tool {tool} turns at {rpm:g} rpm, {over:g} rpm over its maximum of {allowed:g} rpm",
    "cutting",
)
TOOL_TOO_SLOW = code(
    535, "tool-too-slow", _W, "tool {tool} turns at {rpm:g} rpm, below its minimum of {allowed:g} rpm", "cutting"
)
CUT_BEFORE_SPEED = code(
    536,
    "cut-before-speed",
    _W,
    "a feed move starts as early as {seconds:.2f} s after the spindle start; the spindle needs {needed:g} s",
    "cutting",
)
TURNS_BACKWARDS = code(
    537, "turns-backwards", _N, "feed moves with the spindle turning counter-clockwise (moves: {moves})", "cutting"
)
DRY_TOOL = code(538, "dry-tool", _N, "tool {tool} cuts without coolant; other tools of this job have it", "cutting")
NOT_RETRACTED = code(
    539,
    "not-retracted",
    _W,
    "the job ends with Z down at {reached:.3f} mm, {below:.3f} mm below its rapid height: not retracted",
    "cutting",
)
SPINDLE_LEFT_ON = code(540, "spindle-left-on", _W, "the job ends with the spindle running", "cutting")
END_MISSING = code(541, "end-missing", _N, "the job ends without an end code ({known})", "cutting")
TOOL_NOT_TOLD = code(
    542,
    "tool-not-told",
    _U,
    "tools have their own speeds, and the tool in the spindle is unknown (feed moves: {moves})",
    "cutting",
)
FEED_OVER_TOOL = code(
    545,
    "feed-over-tool",
    _E,
    "feed {feed:g} mm/min exceeds the maximum for tool {tool} ({allowed:g} mm/min) by {over:g} mm/min",
    "feeds",
)
PLUNGE_OVER_TOOL = code(
    546,
    "plunge-over-tool",
    _E,
    "tool {tool} plunges at {feed:g} mm/min, {over:g} mm/min over its maximum of {allowed:g} mm/min",
    "feeds",
)
PLUNGE_NOT_KNOWN = code(
    549,
    "plunge-not-known",
    _U,
    "the plunge angle is unknown, and the feed exceeds the tool's maximum plunge feed (feed moves: {moves})",
    "feeds",
)
FEED_NOT_TOLD = code(547, "feed-not-told", _U, "the feed is unknown (feed moves: {moves})", "feeds")
FEED_TOOL_NOT_TOLD = code(
    548,
    "feed-tool-not-told",
    _U,
    "tools have their own maximum feeds, and the tool in the spindle is unknown (feed moves: {moves})",
    "feeds",
)
