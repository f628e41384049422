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
    "{axis} at {velocity:g} {unit}/s needs {needed:g} steps/s; {allowed:g} allowed",
    "motion",
)
PLAN_NEEDS_NUMBERS = code(503, "plan-needs-numbers", _U, "steps need exact numbers: {cause}", "motion")
NO_MOTOR_DATA = code(504, "no-motor-data", _U, "{axis} moves, but the machine file has no {missing} for it", "motion")
DRILL_SETTING_OPEN = code(512, "drill-setting-open", _W, "{code}: {what}", "motion")
VELOCITY_ZERO = code(505, "velocity-zero", _E, "{code} with a velocity of 0: the controller stops the program", "feeds")
SYNCHRONISED_TOO_FAST = code(
    510,
    "synchronised-too-fast",
    _E,
    "{code}: {pitch:g} mm a revolution at {rpm:g} rpm asks {axis} for {needed:g}/min, {over:g} more than its "
    "{allowed:g}/min",
)
SYNCHRONISED_STREAM = code(
    511, "synchronised-stream", _U, "{what}, which a step stream, fixed in time, can not do", "motion"
)
NOT_STEPPED = code(520, "not-stepped", _U, "{what}, and gproof makes no steps for that", "motion")
HEIGHT_JUMP = code(
    521, "height-jump", _U, "Z would have to jump by {jump:.4f} mm where the height map ends or is switched", "motion"
)
ENDLESS_LOOP = code(506, "endless-loop", _W, "the program comes by here in the same state again: it never ends")
ALIKE_PASSES = code(
    522,
    "alike-passes",
    _N,
    "from pass {done} on one pass of this loop is as the other: as there are too many to follow, it may end behind any",
)
CONTOUR_BREAK = code(513, "contour-break", _N, "{code} ends the contour: the axes stop before it", "motion")
TASK_UNKNOWN = code(
    514,
    "task-unknown",
    _U,
    "{code}: nobody stated what the application does for it (Task 0), so where the axes are behind it is not known",
    "limits",
)
MODULE_END = code(515, "module-end", _U, "{name} ends without M02, M30 or M17: what runs behind it is not documented")
MAINTAINED_OFFSET = code(
    517, "maintained-offset", _W, "axis words alone go on with {code}: they set the zero offset and move nothing"
)
FEED_UNKNOWN = code(518, "feed-unknown", _U, "{code}: the feed depends on {cause}", "feeds")
NO_WAY = code(
    519, "no-way", _W, "{code} leads nowhere: the controller reports a move without a way (status 80, 20 hex)"
)
# 53x, 54x: told where the properties cutting and feeds are asked for (docs/cutting-sense.md)
SPINDLE_AT_REST = code(530, "spindle-at-rest", _E, "feed moves while the spindle stands still: {moves}", "cutting")
SPINDLE_NOT_TOLD = code(
    531, "spindle-not-told", _U, "nothing tells whether a spindle turns; feed moves: {moves}", "cutting"
)
SPINDLE_SPEED_NOT_TOLD = code(
    532, "spindle-speed-not-told", _U, "nobody stated how fast the spindle turns; feed moves: {moves}", "cutting"
)
NO_TOOL = code(533, "no-tool", _E, "feed moves without a tool in the spindle: {moves}", "cutting")
TOOL_TOO_FAST = code(
    534, "tool-too-fast", _E, "tool {tool} turns at {rpm:g} rpm, {over:g} more than its {allowed:g}", "cutting"
)
TOOL_TOO_SLOW = code(
    535, "tool-too-slow", _W, "tool {tool} turns at {rpm:g} rpm, and should at {allowed:g} at the least", "cutting"
)
CUT_BEFORE_SPEED = code(
    536,
    "cut-before-speed",
    _W,
    "a feed move {seconds:.2f} s behind the start of the spindle at the earliest, which needs {needed:g} s",
    "cutting",
)
TURNS_BACKWARDS = code(
    537, "turns-backwards", _N, "feed moves with the spindle turning counter-clockwise: {moves}", "cutting"
)
DRY_TOOL = code(538, "dry-tool", _N, "tool {tool} cuts without coolant, which other tools of this job have", "cutting")
NOT_RETRACTED = code(
    539,
    "not-retracted",
    _W,
    "the job ends with Z at {reached:.4f} mm, {below:.4f} below where it traverses",
    "cutting",
)
SPINDLE_LEFT_ON = code(540, "spindle-left-on", _W, "the job ends while the spindle turns", "cutting")
END_MISSING = code(541, "end-missing", _N, "the job ends without a code that says so ({known})", "cutting")
TOOL_NOT_TOLD = code(
    542,
    "tool-not-told",
    _U,
    "tools have speeds of their own, and nobody stated which one is in the spindle; feed moves: {moves}",
    "cutting",
)
FEED_OVER_TOOL = code(
    545, "feed-over-tool", _E, "feed {feed:g} mm/min is {over:g} more than tool {tool} stands ({allowed:g})", "feeds"
)
PLUNGE_OVER_TOOL = code(
    546,
    "plunge-over-tool",
    _E,
    "tool {tool} goes down at {feed:g} mm/min, {over:g} more than it stands ({allowed:g})",
    "feeds",
)
PLUNGE_NOT_KNOWN = code(
    549,
    "plunge-not-known",
    _U,
    "how steep it goes down is not known, and the feed is over the tool's plunge; feed moves: {moves}",
    "feeds",
)
FEED_NOT_TOLD = code(547, "feed-not-told", _U, "nobody stated the feed; feed moves: {moves}", "feeds")
FEED_TOOL_NOT_TOLD = code(
    548,
    "feed-tool-not-told",
    _U,
    "tools have feeds of their own, and nobody stated which one is in the spindle; feed moves: {moves}",
    "feeds",
)
