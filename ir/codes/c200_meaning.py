"""Finding codes 2xx: meaning."""

from __future__ import annotations

from gproof.ir.codes.declared import code, saying
from gproof.ir.finding import Severity

_E, _U, _W, _N = Severity.ERROR, Severity.UNKNOWN, Severity.WARNING, Severity.NOTE

COMMAND_IGNORED = code(200, "command-ignored", _W, "the controller ignores this: {what}")
AXIS_WORDS_MISSING = code(201, "axis-words-missing", _E, "{code} without axis words")
AXIS_WORDS_UNUSED = code(202, "axis-words-unused", _E, "axis words, but no motion code is active ({why})")
ARC_CENTER_MISSING = code(203, "arc-center-missing", _E, "{code} needs {needed}", "arcs")
FEED_MISSING = code(204, "feed-missing", _E, "{code} without a feed rate (F)")
INVERSE_TIME_FEED_MISSING = code(
    205, "inverse-time-feed-missing", _E, "in inverse time mode (G93) every feed move needs its own F"
)
DWELL_NEGATIVE = code(206, "dwell-negative", _E, "the dwell time of {seconds:g} s is negative")
DWELL_MISSING = code(207, "dwell-missing", _E, "{code} needs a time in P")
COORDINATE_SYSTEM_RANGE = code(
    208, "coordinate-system-range", _E, "G10 P{value:g}: coordinate systems are numbered 1 to 9"
)
G10_KEY = code(209, "g10-key", _E, "G10 needs L2 or L20{given}")
G53_NEEDS_G0_G1 = code(210, "g53-needs-g0-g1", _E, "G53 while {mode} is active; it needs G0 or G1")
G53_WITH_COMPENSATION = code(211, "g53-with-compensation", _E, "G53 while cutter radius compensation is on")
G92_AXIS_MISSING = code(212, "g92-axis-missing", _E, "G92 without axis words")
SPINDLE_SPEED_NEGATIVE = code(213, "spindle-speed-negative", _E, "spindle speed S{value:g} is negative")
TOOL_NUMBER = code(214, "tool-number", _E, "T{value:g}: tool numbers are whole numbers from 0 to {highest}")
CYCLE_AXIS_MISSING = code(215, "cycle-axis-missing", _E, "{code} has no X, Y or Z word")
CYCLE_DEPTH_MISSING = code(
    216, "cycle-depth-missing", _E, "{code} has no {letter} word, and the cycle was not active before"
)
CYCLE_R_BELOW_DEPTH = code(217, "cycle-r-below-depth", _E, "{code}: R{r:.4f} is below the depth {letter}{depth:.4f}")
CYCLE_DWELL_NEGATIVE = code(218, "cycle-dwell-negative", _E, "{code}: the dwell time P{value:g} is negative")
CYCLE_REPEATS = code(219, "cycle-repeats", _E, "{code}: the repeat count L{value:g} must be a positive whole number")
CYCLE_ROTARY_MOTION = code(220, "cycle-rotary-motion", _E, "{code} would move the rotary axis {axis}")
CYCLE_INVERSE_TIME = code(221, "cycle-inverse-time", _E, "{code} in inverse time mode (G93)")
CYCLE_PECK = code(222, "cycle-peck", _E, "{code} needs a positive Q{given}")
CYCLE_R_MISSING = code(223, "cycle-r-missing", _E, "{code} has no R word, and no cycle was active before")
TWO_AXIS_COMMANDS = code(224, "two-axis-commands", _E, "{first} and {second} both use the axis words of this line")
UNKNOWN_VALUE = code(225, "unknown-value", _U, "{word} depends on {cause}, {why}", "limits")
PARAMETER_NUMBER = code(226, "parameter-number", _E, "parameter #{value:g} does not exist; {allowed}")
READ_ONLY_PARAMETER = code(227, "read-only-parameter", _E, "parameter #{number} ({meaning}) is read-only")
ARITHMETIC = code(228, "arithmetic", _E, "the calculation fails: {what}")
NOT_AN_INTEGER = code(229, "not-an-integer", _E, "{word} must be a whole number; it is {value!r}")
PRECEDENCE = code(
    230,
    "precedence",
    _W,
    "the manual does not say which of {operators} is calculated first, and the value depends on it; add brackets",
)
INEXACT_COMPARISON = code(
    231, "inexact-comparison", _W, "{left!r} {operator} {right!r} compares calculated numbers for equality"
)
UNKNOWN_CONDITION = code(232, "unknown-condition", _U, "the condition depends on {cause}, whose value is unknown")
STEP_BUDGET = code(233, "step-budget", _U, "the program did not end within {budget} executed blocks")
UNSET_PARAMETER = code(234, "unset-parameter", _W, "{name} is read before it is set")
STARTUP_COORDINATE_SYSTEM = code(
    235, "startup-coordinate-system", _E, "parameter 5220 is {value!r}; coordinate systems are numbered 1 to 9"
)
TOOL_OFFSET_NUMBER = code(236, "tool-offset-number", _E, "H{value:g}: the tool table has tools 1 to {highest}")
TOOL_OFFSET_UNKNOWN = code(
    237,
    "tool-offset-unknown",
    _U,
    "the tool in the spindle is unknown, so G43 has no known tool length",
    "limits",
)
CYCLE_WITH_COMPENSATION = code(238, "cycle-with-compensation", _E, "{code} while cutter radius compensation is on")
SPINDLE_UNKNOWN = code(
    239, "spindle-unknown", _U, "{code} is feed per revolution, but the spindle speed is unknown", "feeds"
)
FEED_IN_OLD_UNITS = code(
    240, "feed-in-old-units", _W, "F{value:g} is read before {code} on this line, so it is in {units}/min"
)
NEGATIVE_FEED = code(241, "negative-feed", _E, "feed rate F{value:g} is negative")
CYCLE_DWELL_MISSING = code(242, "cycle-dwell-missing", _E, "{code} needs a dwell time in P")
CYCLE_SPINDLE_STOPPED = code(244, "cycle-spindle-stopped", _E, "{code} needs a running spindle")
WORD_MISSING = code(275, "word-missing", _E, "{code} needs {needed}")
TRANSFORM_OPEN = code(276, "transform-open", _U, "the manual leaves this open: {what}", "limits")
ARC_UNEQUAL_SCALING = code(
    277, "arc-unequal-scaling", _E, "arc while X is scaled by {x:g} and Y by {y:g} (G51 X Y)", "arcs"
)
SCALING_ZERO = code(278, "scaling-zero", _E, "{code} with a factor of 0 moves every point to one place")
AXIS_CLAMPED = code(279, "axis-clamped", _E, "{axis} would move while it is clamped (M26)")
HEIGHT_CONTROL = code(
    280,
    "height-control",
    _U,
    "{code}: torch height control may be on from here, and then sets Z itself",
    "limits",
)
DRIVES_WERE_OFF = code(
    281, "drives-were-off", _U, "the drives were off (M81): the positions of the axes are no longer known", "limits"
)
AXIS_RESIZED = code(
    282, "axis-resized", _U, "{code} makes an axis move {factor:g} times as far: its position is unknown", "limits"
)
SYNCHRONISED_PITCH = code(
    284,
    "synchronised-pitch",
    _U,
    "{code} under G51: the manual does not say whether its pitch K is scaled with the path",
)
OUTPUT_VALUE = code(283, "output-value", _E, "wrong value for {code}: {what}")
ERROR_MESSAGE = code(245, "error-message", _W, "the program stops itself here with the error {text!r}")
NOT_ENABLED = code(285, "not-enabled", _E, "{code} needs {device}, but the machine file has no {key}")
STORED_POSITION_MISSING = code(286, "stored-position-missing", _E, "{word}: no position is stored under this number")
STORED_POSITION_COMMAND = code(287, "stored-position-command", _E, "stored position, {code}: {what}")
ABORTED_BY_PROGRAM = code(288, "aborted-by-program", _W, "the program aborts itself here ({code})")
NEXT_LINE_OPEN = code(
    289,
    "next-line-open",
    _U,
    "{code} decides about the next line, and {what}: the manual does not say which line is meant",
)
OVERRIDE_WITH_CODES = code(
    290, "override-with-codes", _E, "{code} calls the subprogram {name!r}: {other} cannot be on the same line"
)
PROBE_TOO_NEAR = code(
    291, "probe-too-near", _E, "the probe move is {distance:.3f} mm long; it must be at least {least:g} mm"
)
PROBE_INVERSE_TIME = code(292, "probe-inverse-time", _E, "probing (G38.2) in inverse time mode (G93)")
PROBE_ROTARY = code(293, "probe-rotary", _E, "the probe move would turn the rotary axis {axis}")
PROBE_AXIS_MISSING = code(294, "probe-axis-missing", _E, "{code} without an X, Y or Z word")
HOMING = code(295, "homing", _N, "{axes} homes here: the path to the home sensor is not checked")
AXIS_NOT_THERE = code(296, "axis-not-there", _E, "the machine has no axis {axis}")
INPUT_CHANNEL = code(297, "input-channel", _E, "no such input: {what}")
OFFSET_IN_USE = code(
    298,
    "offset-in-use",
    _W,
    "{what} is written while it is in use: the manual does not say whether it acts at once",
    "limits",
)
OFFSETS_WITH_COMPENSATION = code(
    246, "offsets-with-compensation", _E, "{code} while cutter radius compensation is on: the work zero must not change"
)
UNITS_WITH_COMPENSATION = code(
    247, "units-with-compensation", _E, "{code} while cutter radius compensation is on: the units must not change"
)
PROBE_WITH_COMPENSATION = code(248, "probe-with-compensation", _E, "{code} while cutter radius compensation is on")
COMPENSATION_PLANE = code(
    249, "compensation-plane", _E, "{code} in the {plane} plane; it works in XY, and in XZ for turning"
)
COMPENSATION_ALREADY_ON = code(
    250, "compensation-already-on", _E, "{code} while cutter radius compensation is already on"
)
PARK_WITH_COMPENSATION = code(251, "park-with-compensation", _E, "{code} while cutter radius compensation is on")
PLANE_WITH_COMPENSATION = code(
    252, "plane-with-compensation", _E, "{code} while cutter radius compensation is on in the {plane} plane"
)
COMPENSATION_TOOL_NEGATIVE = code(253, "compensation-tool-negative", _E, "D{value}: a tool number cannot be negative")
COMPENSATION_TOOL_RANGE = code(
    254, "compensation-tool-range", _E, "D{value}: the tool table has tools 1 to {highest}, and 0 means no radius"
)
COMPENSATION_RADIUS_UNKNOWN = code(
    255,
    "compensation-radius-unknown",
    _U,
    "the compensation radius depends on {cause}, whose value is unknown",
    "limits",
)
COMPENSATION_UNKNOWN = code(256, "compensation-unknown", _U, "the compensated path depends on {cause}", "limits")
COMPENSATION_LATHE_UNKNOWN = code(
    257,
    "compensation-lathe-unknown",
    _U,
    "compensation for turning depends on {cause}, whose value is unknown",
    "limits",
)
COMPENSATION_WITHOUT_TOOL = code(
    258, "compensation-without-tool", _W, "cutter radius compensation without a tool in the spindle: the radius is 0"
)
CYCLE_WORD_IGNORED = code(
    259, "cycle-word-ignored", _W, "{word} is not a word of {code}: it is assumed to have no effect"
)
LOCAL_RESTORED_OVER = code(
    260,
    "local-restored-over",
    _W,
    "{code} restores what it saved, over local coordinates that were set since then",
    "limits",
)
DOUBTFUL_ARITHMETIC = code(
    299,
    "doubtful-arithmetic",
    _U,
    "{operator} has no result for some possible values of {cause}: the program may stop here",
)
OPERATOR_STOP = code(243, "operator-stop", _N, "the program stops and waits for the operator ({code})")
TOOL_CHANGE_STOP = saying(OPERATOR_STOP, "manual tool change: the program stops and waits for Cycle Start ({code})")
# 26x, 27x: the spindle and what follows its turns
THREAD_PLANE = code(261, "thread-plane", _E, "{code} needs the ZX plane (G18)")
THREAD_WORD = code(262, "thread-word", _E, "thread cycle {code}: {what}")
THREAD_PEAK_OPEN = code(
    263,
    "thread-peak-open",
    _U,
    "the thread peak of I{value:g} is at X{position:g} if I is a diameter, at X{offset:g} if it is an offset from "
    "the drive line",
    "limits",
)
TAP_DIRECTION = code(264, "tap-direction", _E, "{code} needs the spindle to turn {needed}; it turns {turns}")
ORIENTED_STOP = code(265, "oriented-stop", _W, "{code} needs a spindle that can stop at a fixed angle")
SPINDLE_STATE_UNKNOWN = code(
    266, "spindle-state-unknown", _U, "{code} needs a running spindle, and it is unknown whether it runs"
)
BACK_BORE_TOP = code(
    267,
    "back-bore-top",
    _E,
    "{code}: the counterbore ends at {letter}{top:.4f}, outside {letter}{depth:.4f} to {letter}{r:.4f}",
)
SURFACE_SPEED_UNBOUNDED = code(
    268, "surface-speed-unbounded", _W, "{code} without D: towards the centre the spindle speed has no limit"
)
SURFACE_SPEED_LIMIT = code(269, "surface-speed-limit", _E, "D{value:g}: the maximum spindle speed must be positive")
OVERRIDE_FACTOR = code(270, "override-factor", _U, "override, {code}: {what}", "feeds")
SPINDLE_RANGE = code(271, "spindle-range", _W, "S{value:g} is outside the spindle's range of {low} to {high} rpm")
HEAD_MOVE = code(272, "head-move", _U, "the position of the head is unknown after {code}: {what}", "limits")
HEAD_OFFSET_OPEN = code(
    273,
    "head-offset-open",
    _W,
    "the {axis} offset of {code}, {value:g} mm, is given without its sign: it counts as unknown",
    "limits",
)
HEAD_WHILE_TURNING = code(
    274, "head-while-turning", _W, "{code} while a spindle turns: the manual does not say whether it keeps turning"
)
